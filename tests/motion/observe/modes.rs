//! Systems side by side: of which mode each window is.
//!
//! Oracles: a point whose place is written down; a body that sticks and slips by Newton's laws and Coulomb's, which knows when its modes change.

use crate::common::{folder, json, palmistry, write};
use crate::observe::{NEVER, experiment};
use palmistry::experiment::{Experiment, Scene};
use std::path::Path;

const POINT: &str = "system \"A point that moves on\" state x, v drift f x' = v v' = 0 output x sample x in [-5, 5] v in [-5, 5]";
const FALL: &str = "system \"A point that falls\" state x, v param g unknown drift f x' = v v' = -g output x \
                    sample x in [-5, 5] v in [-5, 5] g in [0.5, 20]";

/// A point that moves on for 41 samples and then falls for 60; windows are of 20 steps.
fn point(folder: &Path) -> String {
    let mut measurements = String::from("time,x\n");
    for i in 0..101 {
        let t = 0.05 * f64::from(i);
        let fallen = (t - 2.5).max(0.0);
        measurements += &format!("{t:?},{:?}\n", 1.0 + 0.5 * t - 9.81 * fallen * fallen / 2.0);
    }
    for (name, text) in [("moves.proof", POINT), ("falls.proof", FALL), ("point.csv", &measurements)] {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let folder = folder.display();
    format!(
        "title = \"A point\"\nmodel = \"{folder}/moves.proof\"\n[data]\nrecord = \"{folder}/point.csv\"\n[sensor]\nnoise = 1e-3\n\
         [observer]\nmethods = [\"trust-region\"]\nmode = \"moves on\"\nestimate = [\"x\", \"v\"]\nguess = \"sample\"\n\
         window = 20\nsteps = 30\n[[observer.modes]]\nname = \"falls\"\nmodel = \"{folder}/falls.proof\"\nestimate = [\"x\", \"v\", \"g\"]\n\
         bounds = {{ g = [1.0, 20.0] }}\n"
    )
}

#[test]
fn each_window_has_its_mode_and_one_across_has_none() {
    let folder = folder();
    let experiment = experiment(&point(folder.path()));
    let windows = experiment.run_modes(&NEVER, &|| ()).unwrap();
    let chosen: Vec<Option<usize>> = windows.iter().map(|window| window.chosen).collect();
    // the third is from 2 s to 3 s, and the fall begins at 2.5 s
    assert_eq!(chosen, [Some(0), Some(0), None, Some(1), Some(1)]);
    for window in &windows[3..] {
        let update = window.estimates[1].update.as_ref().unwrap();
        assert_eq!(window.estimates[1].estimated, ["x", "v", "g"]);
        assert!((update.estimate[2] - 9.81).abs() < 1e-6, "{:?}", update.estimate);
        assert!((update.estimate[1] - 0.5 + 9.81 * (window.from - 2.5)).abs() < 1e-6);
    }
}

/// The middle of the sample box may be asked for by its word, as of a scene; that there is no guess may not.
#[test]
fn a_mode_may_begin_in_the_middle_of_its_sample_box() {
    let folder = folder();
    let text = point(folder.path());
    let own = text.replace("bounds = {", "guess = \"sample\"\nbounds = {");
    let of = |text: &str| {
        let windows = experiment(text).run_modes(&NEVER, &|| ()).unwrap();
        windows.iter().map(|window| window.chosen).collect::<Vec<_>>()
    };
    assert_eq!(of(&own), of(&text));
    let none = text.replace("bounds = {", "guess = \"none\"\nbounds = {");
    let error = Scene::parse("scene.toml", &none).unwrap_err().to_string();
    assert!(error.contains("'none' is no first guess of a mode"), "{error}");
}

/// The same by the program: fields, status, and what modes do not go with.
#[test]
fn the_program_tells_modes() {
    let folder = folder();
    let text = point(folder.path());
    let scene = write(&folder, "scene.toml", &text);
    let scene = scene.to_str().unwrap();
    let output = palmistry(&["observe", scene, "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let found = json(&output);
    assert_eq!(found["windows"][3]["mode"], "falls");
    assert!(found["windows"][2]["mode"].is_null());
    assert_eq!(found["windows"][0]["modes"][0]["name"], "moves on");
    let refused = palmistry(&["observe", scene, "--out", folder.path().join("out").to_str().unwrap()]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("with --out"));
    // records of no window, and of more than windows
    let record = folder.path().join("whole.csv");
    palmistry(&["observe", scene, "--record", record.to_str().unwrap()]);
    let table = std::fs::read_to_string(&record).unwrap();
    let first = |rows: usize| {
        let lines: Vec<&str> = table.lines().take(1 + rows).collect();
        write(&folder, "first.csv", lines.join("\n") + "\n").to_str().unwrap().to_owned()
    };
    let output = palmistry(&["observe", scene, "--json", "--data", &first(1)]);
    assert_eq!(output.status.code(), Some(2));
    assert!(json(&output)["error"]["message"].as_str().is_some_and(|message| !message.contains("panic")));
    let windows = found["windows"].as_array().unwrap().len();
    let rows = (found["samples"].as_u64().unwrap() as usize - 1) / windows + 4;
    let short = json(&palmistry(&["observe", scene, "--json", "--data", &first(rows)]));
    assert_eq!((short["windows"].as_array().unwrap().len(), &short["samples_after_windows"]), (1, &3.into()));
}

/// The shipped scene: wherever one pair of modes holds for a whole window, and the window fits at all, it is the mode that is chosen, the
/// coefficient comes with the sign of the sliding and to 1e-5, and 1/m beside it; a window with a change of modes fits none.
#[test]
fn friction_is_found_between_changes_of_modes() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002/scenes/friction.toml");
    let experiment = Experiment::new(Scene::read(&scene).unwrap(), None).unwrap();
    let windows = experiment.run_modes(&NEVER, &|| ()).unwrap();
    let mut right = 0;
    for window in &windows {
        let Some(chosen) = window.chosen else { continue };
        let estimate = &window.estimates[chosen];
        let [truth] = &window.true_modes[..] else {
            panic!("{} fits across {:?}", estimate.name, window.true_modes)
        };
        let (name, sign) = match truth.as_str() {
            "slides along the tangent of palm 1, along that of palm 2" => ("both slide, the same way", 1.0),
            "slides against the tangent of palm 1, against that of palm 2" => {
                ("both slide, the same way", -1.0)
            }
            "slides along the tangent of palm 1, against that of palm 2" => {
                ("both slide, opposite ways", 1.0)
            }
            "slides against the tangent of palm 1, along that of palm 2" => {
                ("both slide, opposite ways", -1.0)
            }
            "rolls on palm 1, slides along the tangent of palm 2" => ("rolls on palm 1", 1.0),
            "rolls on palm 1, slides against the tangent of palm 2" => ("rolls on palm 1", -1.0),
            "slides along the tangent of palm 1, rolls on palm 2" => ("rolls on palm 2", 1.0),
            "slides against the tangent of palm 1, rolls on palm 2" => ("rolls on palm 2", -1.0),
            other => panic!("{other}"),
        };
        assert_eq!(estimate.name, name, "{window:?}");
        let update = estimate.update.as_ref().unwrap();
        let found =
            |name: &str| update.estimate[estimate.estimated.iter().position(|own| own == name).unwrap()];
        println!("{} {} mu {} 1/m {}", window.from, name, found("mu"), found("one_over_m"));
        assert!((found("mu") - sign * 0.135).abs() < 1e-5, "{}", found("mu"));
        assert!((found("one_over_m") - 1.0).abs() < 1e-5);
        right += 1;
    }
    assert!(right >= 4, "{right}");
}
