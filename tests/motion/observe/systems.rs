//! Systems without palms: simulated by their own equations, recorded, and recovered from the middle of their sample boxes.

use crate::common::{folder, palmistry, without_times, write};
use crate::observe::{answers, experiment, observe, refusal};
use palmistry::experiment::Method;
use palmistry::observer::UpdateEnd;
use serde_json::Value;
use std::path::Path;

const SYSTEMS: [&str; 6] = ["van_der_pol", "lorenz", "two_tanks", "beacons", "motor", "epidemic"];

/// A scene of the project's systems, that can be read from anywhere.
fn scene(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/systems");
    let text = std::fs::read_to_string(folder.join(format!("{name}.toml"))).unwrap();
    text.replace("model = \"", &format!("model = \"{}/", folder.display()))
}

fn with_line(text: &str, begins: &str, line: &str) -> String {
    assert_eq!(text.lines().filter(|old| old.starts_with(begins)).count(), 1, "{begins}");
    let lines = text.lines().map(|old| if old.starts_with(begins) { line } else { old });
    lines.collect::<Vec<_>>().join("\n") + "\n"
}

/// From the middle of the sample box every state and constant is found: without noise to nine digits, as far as
/// the bound for measurements good to 1e-9 lets one tell them; with noise within five deviations, which one of two million passes.
#[test]
fn multiple_shooting_arrives_from_the_middle_of_the_sample_box() {
    for name in SYSTEMS {
        let text = with_line(&scene(name), "methods", "methods = [\"multiple-shooting\"]");
        for noisy in [false, true] {
            let text = if noisy { text.clone() } else { with_line(&text, "noise", "noise = 0") };
            let experiment = experiment(&text);
            let answers = answers(&experiment);
            let track = &answers[0].track;
            let update = &track.updates[0];
            assert_eq!(update.end, UpdateEnd::Converged, "{name}: {update:?}");
            assert!(update.is_borne_out() && track.is_sound(), "{name}: {update:?}");
            assert!(track.others.is_empty(), "{name}: {:?}", track.others);
            let truth = experiment.truth_at(0.0).unwrap();
            for (i, truth) in truth.iter().enumerate() {
                let off = (update.estimate[i] - truth).abs();
                let room = 5.0 * update.deviations[i] + if noisy { 0.0 } else { 1e-9 * truth.abs() };
                assert!(off <= room, "{name} {i}: {off:e} is more than {room:e}");
            }
        }
    }
}

/// `x^2` of an oscillator is the same for `x` and `-x`: by hand, both states fit and no other does.
#[test]
fn a_mirror_image_is_named() {
    let folder = folder();
    write(
        &folder,
        "mirror.proof",
        "system \"An oscillator whose square is seen\" state x, v param k unknown drift f x' = v v' = -k*x output x^2 \
         sample x in [-2, 2] v in [-2, 2] k in [1, 5]",
    );
    let scene = "title = \"Its square\"\nmodel = \"mirror.proof\"\nduration = 4\nsamples = 81\n[start]\nx = 0.7\nv = -0.9\nk = 2.3\n\
                 [sensor]\nnoise = 0.001\n[observer]\nmethods = [\"multiple-shooting\"]\nestimate = [\"x\", \"v\", \"k\"]\n";
    let (output, found) = observe(&write(&folder, "mirror.toml", scene), &[]);
    assert_eq!(output.status.code(), Some(0), "{found}");
    let observer = &found["observers"][0];
    let others = observer["fits_as_well"].as_array().unwrap();
    assert_eq!(others.len(), 1, "{observer}");
    let of = |update: &Value, name: &str| update["states"][name]["recovered"].as_f64().unwrap();
    let update = &observer["updates"][0];
    for (name, sign, truth) in [("x", -1.0, 0.7), ("v", -1.0, -0.9), ("k", 1.0, 2.3)] {
        assert!((of(update, name) - sign * of(&others[0], name)).abs() < 1e-6, "{name}");
        assert!((of(update, name).abs() - f64::abs(truth)).abs() < 0.01, "{name}");
    }
    // where the box has only one of them, the other is none
    let model = std::fs::read_to_string(folder.path().join("mirror.proof")).unwrap();
    write(&folder, "mirror.proof", model.replace("x in [-2, 2]", "x in [1/10, 2]"));
    let (_, found) = observe(&folder.path().join("mirror.toml"), &[]);
    let observer = &found["observers"][0];
    assert_eq!(observer["fits_as_well"], Value::Array(Vec::new()));
    assert!((of(&observer["updates"][0], "x") - 0.7).abs() < 0.01);
    // a filter, which has no windows, names the image of what it believes at the end
    let filter = scene
        .replace("methods = [\"multiple-shooting\"]", "methods = [\"kalman\"]\nguess_off = 0.05")
        .replace("mirror.proof", "both.proof");
    write(&folder, "both.proof", model);
    let (output, found) = observe(&write(&folder, "filter.toml", filter), &[]);
    assert_eq!(output.status.code(), Some(0), "{found}");
    let remarks = found["observers"][0]["remarks"].to_string();
    assert!(
        remarks.contains("at 4.000 s x = ") && remarks.contains("explains the same measurements"),
        "{remarks}"
    );
}

/// Half of the starts begin along the model's motion. Here it has none from most of the box, since what is not measured is infinite within a second from
/// above one, and a window may be a single segment, and cells may be empty: the truth is found all the same.
#[test]
fn starts_from_which_there_is_no_motion_harm_nothing() {
    let folder = folder();
    write(
        &folder,
        "escape.proof",
        "system \"A growth that is measured through a lag\" state x, y param k unknown drift f x' = y - x y' = k*y^2 output x \
         sample x in [-2, 2] y in [-2, 4] k in [1/2, 2]",
    );
    let scene = "title = \"Escape\"\nmodel = \"escape.proof\"\nduration = 4\nsamples = 81\n[start]\nx = 0.7\ny = -1.1\nk = 1.3\n\
                 [sensor]\nnoise = 0.001\n[observer]\nmethods = [\"multiple-shooting\"]\nestimate = [\"x\", \"y\", \"k\"]\n";
    let mut found = Vec::new();
    for shooting in ["", "shooting = { segments = 1 }\n", "shooting = { starts = 4 }\n"] {
        let file = write(&folder, "escape.toml", format!("{scene}{shooting}"));
        let (output, answer) = observe(&file, &[]);
        assert_eq!(output.status.code(), Some(0), "{shooting}{answer}");
        found.push(answer);
    }
    // most cells are empty, those of the nodes among them
    let (output, _) = observe(
        &folder.path().join("escape.toml"),
        &["--record", folder.path().join("all.csv").to_str().unwrap()],
    );
    assert_eq!(output.status.code(), Some(0));
    let all = std::fs::read_to_string(folder.path().join("all.csv")).unwrap();
    let sparse = all.lines().enumerate().map(|(row, line)| match (row, line.split_once(',')) {
        (0, _) | (_, None) => line.to_owned(),
        (_, Some((time, rest))) if row % 4 != 2 => {
            format!("{time},{}", ",".repeat(rest.matches(',').count()))
        }
        _ => line.to_owned(),
    });
    let sparse = write(&folder, "sparse.csv", sparse.collect::<Vec<_>>().join("\n") + "\n");
    let (output, answer) = observe(&folder.path().join("escape.toml"), &["--data", sparse.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{answer}");
    found.push(answer);
    for answer in found {
        let states = &answer["observers"][0]["updates"][0]["states"];
        for (name, truth) in [("x", 0.7), ("y", -1.1), ("k", 1.3)] {
            let [value, bound] = ["recovered", "bound"].map(|of| states[name][of].as_f64().unwrap());
            assert!((value - truth).abs() <= 5.0 * bound, "{name}: {value} of {truth}, {bound}");
        }
    }
}

/// What was recorded gives what was simulated, to the last digit, whatever the first guess; and no page speaks of palms.
#[test]
fn a_recording_of_any_system_gives_the_same_answer() {
    fn without_truth(value: &mut Value) {
        match value {
            Value::Object(map) => {
                map.retain(|key, _| {
                    !["true", "error", "relative_error", "simulation"].contains(&key.as_str())
                });
                map.values_mut().for_each(without_truth);
            }
            Value::Array(list) => list.iter_mut().for_each(without_truth),
            _ => {}
        }
    }
    let folder = folder();
    for (name, guess) in [
        ("two_tanks", "guess = \"sample\""),
        ("beacons", "guess_off = 0.1"),
        ("epidemic", "guess_off = -0.05"),
    ] {
        let text = scene(name).replace("window =", &format!("{guess}\nwindow ="));
        let text = with_line(&text, "methods", "methods = [\"trust-region\", \"unscented\", \"kalman\"]");
        let scene = write(&folder, "scene.toml", text);
        for file in ["x.csv", "x.parquet"] {
            let file = folder.path().join(file);
            let file = file.to_str().unwrap();
            let out = folder.path().join("out");
            let (first, mut simulated) = observe(&scene, &["--record", file, "--out", out.to_str().unwrap()]);
            let (second, mut replayed) = observe(&scene, &["--data", file]);
            assert_eq!(first.status.code(), second.status.code(), "{name}");
            assert!(
                simulated["observers"][0]["updates"][0]["states"]
                    .as_object()
                    .is_some_and(|states| !states.is_empty())
            );
            without_truth(&mut simulated);
            without_truth(&mut replayed);
            without_times(&mut simulated);
            without_times(&mut replayed);
            assert_eq!(simulated, replayed, "{name}");
            let page = std::fs::read_to_string(out.join("index.html")).unwrap();
            let words = palmistry(&["observe", scene.to_str().unwrap()]);
            let words = String::from_utf8_lossy(&words.stdout).into_owned();
            let body = page.split("<body").nth(1).unwrap();
            for word in ["palm ", "palms", "contact", "torque", "The body"] {
                assert!(!body.contains(word) && !words.contains(word), "{name} speaks of {word}");
            }
        }
    }
}

/// `x' = -k x` is `x0 e^(-k t)`; the unscented filter finds both within five of its noise's own bound, by the bound of Cramer and Rao.
#[test]
fn the_unscented_filter_finds_a_decay() {
    let folder = folder();
    write(
        &folder,
        "decay.proof",
        "system \"Decay\" state x : m param k unknown drift f x' = -k*x output x sample x in [1/2, 2] k in [1/2, 2]",
    );
    let text = "title = \"Decay\"\nmodel = \"decay.proof\"\nduration = 2\nsamples = 201\n[start]\nx = 1.5\nk = 0.8\n[sensor]\nnoise = 0.001\n\
                [observer]\nmethods = [\"unscented\", \"trust-region\"]\nestimate = [\"x\", \"k\"]\nunscented = { process_noise = 0 }\nwindow = 200\nsteps = 20\n";
    let scene = write(&folder, "decay.toml", text);
    let (_, found) = observe(&scene, &[]);
    let k = &found["observers"][0]["end"]["states"]["k"];
    let off = k["recovered"].as_f64().unwrap() - 0.8;
    let bound = found["observers"][1]["updates"][0]["states"]["k"]["bound"].as_f64().unwrap();
    assert!(off.abs() < 5.0 * bound && bound < 1e-3, "{off} and {bound}");
    // states carry their units, where the file says them
    let out = folder.path().join("out");
    let words = palmistry(&["observe", scene.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert!(String::from_utf8_lossy(&words.stdout).contains("x, m"));
    assert_eq!(found["units"]["x"], "m");
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    assert!(page.contains("<th>x, m<") && page.contains("<td>x, m<"));
}

/// What is wrong with [start] and [inputs], with the line that is named.
const MISTAKES: [(&str, &str, &str, &str); 8] = [
    ("h1 = 1.2", "", "nothing gives the initial condition of 'h1'", "[start]"),
    ("h1 = 1.2", "h1 = -1.2", "has no value", "[start]"),
    ("h1 = 1.2", "h1 = 1.2\nh3 = 1", "declares no 'h3'", "h3 = 1"),
    ("u = \"0.2 + 0.1*sin(0.5*t)\"", "u = \"0.2 + \"", "u = 0.2 + :", "u = "),
    ("u = \"0.2 + 0.1*sin(0.5*t)\"", "u = \"h1\"", "depends on 'h1'", "u = "),
    ("u = \"0.2 + 0.1*sin(0.5*t)\"", "h1 = \"t\"", "has a value and a function of time", "h1 = \"t\""),
    ("u = \"0.2 + 0.1*sin(0.5*t)\"", "", "nothing says what drives 'u'", "[start]"),
    ("duration = 40\n", "", "without 'duration'", "samples"),
];

#[test]
fn mistakes_in_a_system_are_shown_at_their_place() {
    let folder = folder();
    let whole = scene("two_tanks");
    for (from, to, says, place) in MISTAKES {
        assert!(whole.contains(from), "{from}");
        let text = whole.replace(from, to);
        let path = write(&folder, "scene.toml", &text);
        let (output, found) = observe(&path, &[]);
        let (message, help) = refusal(&output, &found);
        assert!(message.contains(says) && !help.is_empty(), "{from} to {to}: {message}; {help}");
        let line = found["error"]["line"].as_u64().unwrap() as usize;
        assert!(text.lines().nth(line - 1).unwrap().starts_with(place), "{to}: line {line}");
    }
    // studies are refused where a scene has none
    let path = write(&folder, "scene.toml", &whole);
    let (output, found) = observe(&path, &["--studies"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(found["error"]["message"].as_str().unwrap().contains("the scene has no studies"), "{found}");
}

/// A study of any system: the error over noise lies at the bound, and a map of first guesses tells where each method arrives.
#[test]
fn studies_need_no_palms() {
    let folder = folder();
    let text = with_line(&scene("beacons"), "methods", "methods = [\"trust-region\"]");
    let study = "[study.noise]\nlevels = [1e-3]\nseeds = 24\n[study.basin]\npx = [1.4, 1.6]\npy = [-1.1, -0.9]\npoints = 2\n";
    let path = write(&folder, "scene.toml", text.replace("window =", "guess_off = 0.01\nwindow =") + study);
    let (output, found) = observe(&path, &["--studies"]);
    assert_eq!(output.status.code(), Some(0), "{found}");
    let level = &found["noise"][0];
    assert_eq!(level["converged"], 24);
    for name in ["px", "py", "theta"] {
        let of = |key: &str| level[key][name].as_f64().unwrap();
        let ratio = of("root_mean_square_error") / of("bound");
        // 24 seeds tell a deviation to one part in seven
        assert!((0.5..1.6).contains(&ratio), "{name}: {ratio}");
    }
    assert_eq!(found["basins"][0]["fraction"], 1.0);
    assert_eq!(experiment(&scene("beacons")).scene.observer.methods[0], Method::MultipleShooting);
}

/// Lie derivatives of the outputs, inverted on what was read, lead to the state of the motor where the guess leads elsewhere. The guesses are three of fourteen
/// draws from the sample box; whole turns of the angle are the same motor.
#[test]
fn inverted_derivatives_are_a_start() {
    let folder = folder();
    let text = with_line(&scene("motor"), "methods", "methods = [\"multiple-shooting\"]");
    let text = with_line(&text, "noise", "noise = 0");
    let off = |guess: &str, derivatives: bool| {
        let told = format!(
            "guess = {{ {guess} }}\nshooting = {{ starts = 1, derivatives = {derivatives} }}\nwindow ="
        );
        let scene = write(&folder, "scene.toml", text.replace("window =", &told));
        let (_, found) = observe(&scene, &[]);
        let states = found["observers"][0]["updates"][0]["states"].as_object().unwrap().clone();
        let off = |(name, state): (&String, &Value)| {
            let off = state["recovered"].as_f64().unwrap() - state["true"].as_f64().unwrap();
            let turns = if name == "th" { (off / std::f64::consts::TAU).round() } else { 0.0 };
            (off - turns * std::f64::consts::TAU).abs()
        };
        states.iter().map(off).fold(0.0, f64::max)
    };
    for guess in [
        "ia = 0.74, ib = -4.87, w = -7, th = -1.32, load = 0.17",
        "ia = 2.66, ib = -3.4, w = 27.83, th = -2.17, load = 0.05",
        "ia = 3.94, ib = -2.01, w = 1.67, th = -2, load = -0.14",
    ] {
        let (with, without) = (off(guess, true), off(guess, false));
        assert!(with < 1e-9 && without > 1.0, "{guess}: {with:e} and without {without:e}");
    }
}

/// Absorption and elimination of a drug that is measured in the blood alone. By hand: `y'' + (ka + ke) y' + ka ke y = 0` is the same where both rates are exchanged, and
/// `gut = (y' + ke y)/ka` is another then; no symmetry of single unknowns says so. Where the gut is measured too there is one value of each.
#[test]
fn values_that_are_no_mirror_images_are_counted() {
    let folder = folder();
    let model = "system \"A drug\" state gut, blood param ka, ke unknown drift f gut' = -ka*gut blood' = ka*gut - ke*blood \
                 output blood sample gut in [1, 9] blood in [0, 1] ka in [1/10, 3] ke in [1/10, 3]";
    write(&folder, "drug.proof", model);
    let scene = "title = \"A drug\"\nmodel = \"drug.proof\"\nduration = 8\nsamples = 81\n[start]\ngut = 2\nblood = 0.1\nka = 1.3\nke = 0.4\n\
                 [sensor]\nnoise = 0.001\n[observer]\nmethods = [\"trust-region\", \"kalman\"]\nestimate = [\"gut\", \"blood\", \"ka\", \"ke\"]\nguess_off = 0.02\nsteps = 50\n";
    let remarks = |scene: &str| {
        let (output, found) = observe(&write(&folder, "drug.toml", scene), &[]);
        assert_eq!(output.status.code(), Some(0), "{found}");
        let of = |k: usize| found["observers"][k]["remarks"].to_string();
        (of(0), of(1))
    };
    let counted = "of gut (2), ka (2), ke (2); the estimate is one of them";
    let (window, filter) = remarks(scene);
    assert!(window.contains(counted) && filter.contains(counted), "{window} {filter}");
    // with one rate known, or both amounts measured, nothing can be exchanged
    let known = scene.replace("\"ka\", \"ke\"]", "\"ka\"]\nknown = { ke = 0.4 }");
    let (window, _) = remarks(&known);
    assert!(!window.contains("several values"), "{window}");
    write(&folder, "drug.proof", model.replace("output blood", "output blood output gut"));
    let (window, _) = remarks(scene);
    assert!(!window.contains("several values"), "{window}");
}

/// A bias and a delay of what a known signal drives: neither is refused, and both are found.
#[test]
fn sensors_beside_a_known_signal() {
    for (sensor, sought, truth) in [("bias = 0.3", "x.bias", 0.3), ("delay = 0.1", "x.delay", 0.1)] {
        let folder = folder();
        write(
            &folder,
            "first.proof",
            "system \"first order\" state x param k, b unknown known u(t) drift f x' = -k*x + b*u output x sample x in [-2, 2] k in [0.5, 5] b in [0.5, 5]",
        );
        let text = format!(
            "title = \"a sensor beside a known signal\"\nmodel = \"first.proof\"\nduration = 8\nsamples = 161\n[start]\nx = 0.5\nk = 2\nb = 1.2\n\
             [inputs]\nu = \"sin(1.3*t) + 0.5*cos(3*t)\"\n[sensor]\nnoise = 0.01\n[sensor.x]\nnoise = 0.01\n{sensor}\n\
             [observer]\nmethods = [\"trust-region\"]\nestimate = [\"x\", \"k\", \"b\", \"{sought}\"]\nguess = {{ x = 0.7, k = 1.5, b = 1 }}\nwindow = 160\nsteps = 30\n"
        );
        let scene = write(&folder, "s.toml", text);
        let (output, found) = observe(&scene, &[]);
        assert_eq!(output.status.code(), Some(0), "{found} {}", String::from_utf8_lossy(&output.stderr));
        let state = &found["observers"][0]["updates"][0]["states"][sought];
        let (value, bound) = (state["recovered"].as_f64().unwrap(), state["bound"].as_f64().unwrap());
        assert!((value - truth).abs() < 5.0 * bound && bound < 0.1 * truth, "{state}");
    }
}

/// A command that is held between samples, read without saying so: the answer is told to be doubted.
#[test]
fn a_stepped_input_is_remarked() {
    let folder = folder();
    write(
        &folder,
        "first.proof",
        "system \"first order\" state x param k, b unknown known u(t) drift f x' = -k*x + b*u output x sample x in [-2, 2] k in [0.5, 5] b in [0.5, 5]",
    );
    let (k, b, step) = (2.0f64, 1.2f64, 0.1f64);
    let (mut x, mut rows) = (0.0f64, "time,x,u\n".to_owned());
    for i in 0..200u32 {
        let u = if i / 5 % 2 == 0 { 1.0 } else { -1.0 };
        rows += &format!("{:.1},{:.6},{u}\n", f64::from(i) * step, x + 0.01 * (7.7 * f64::from(i)).sin());
        x = b * u / k + (x - b * u / k) * (-k * step).exp();
    }
    write(&folder, "run.csv", rows);
    for (data, is_remarked) in
        [("", true), ("interpolation = \"linear\"\n", true), ("interpolation = \"hold\"\n", false)]
    {
        let text = format!(
            "title = \"a command\"\nmodel = \"first.proof\"\n[data]\nrecord = \"run.csv\"\n{data}[sensor]\nnoise = 0.01\n\
             [observer]\nmethods = [\"trust-region\"]\nestimate = [\"x\", \"k\", \"b\"]\nguess = {{ x = 0.1, k = 1.5, b = 1 }}\nwindow = 199\nsteps = 30\n"
        );
        let scene = write(&folder, "s.toml", text);
        let (_, found) = observe(&scene, &[]);
        let told = found["observers"][0]["remarks"].to_string();
        assert_eq!(told.contains("'u' changes in steps"), is_remarked, "{told}");
        if !is_remarked {
            let state = &found["observers"][0]["updates"][0]["states"]["k"];
            assert!((state["recovered"].as_f64().unwrap() - k).abs() < 0.05, "{state}");
        }
    }
}
