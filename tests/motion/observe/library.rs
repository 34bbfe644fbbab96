//! A known body among several, recognised from touch: the right one, none, and bodies that no touch tells apart. What is read comes from bodies moved by Newton's laws.

use super::*;
use palmistry::experiment::{Recognition, RecognitionVerdict};

/// The body of `general.toml`, as a support function's harmonics.
const PEBBLE: [[f64; 2]; 3] = [[0.0, 0.0], [0.1, 0.0], [0.03, -0.04]];

/// Turned counterclockwise: `h(a - angle)` by the theorems of addition.
fn turned(harmonics: [[f64; 2]; 3], angle: f64) -> [[f64; 2]; 3] {
    std::array::from_fn(|i| {
        let ([p, q], (sine, cosine)) = (harmonics[i], ((i + 1) as f64 * angle).sin_cos());
        [p * cosine - q * sine, p * sine + q * cosine]
    })
}

/// Seen in a mirror: `h(-a)`.
fn mirrored(harmonics: [[f64; 2]; 3]) -> [[f64; 2]; 3] {
    harmonics.map(|[p, q]| [p, -q])
}

fn entry(name: &str, mean: f64, harmonics: [[f64; 2]; 3]) -> String {
    let shape = format!("{{ kind = \"harmonics\", mean = {mean:?}, harmonics = {harmonics:?} }}");
    format!("\n[[observer.library]]\nname = \"{name}\"\nshape = {shape}\n")
}

/// A scene of the thesis with 101 samples, one fast method, measurements with errors of a tenth of a millimetre, and a library.
fn scene(name: &str, library: &str) -> String {
    let own = text(name);
    let (head, _) = own.split_once("[observer]").unwrap();
    let observer = "methods = [\"integration\"]\ninputs = { g1 = \"tau1\", g2 = \"tau2\" }\nestimate = [\"r1\", \"r2\", \"omega0\"]\nguess_off = 0.1\n";
    let head = with(head, "samples = 401", "samples = 101");
    format!("{head}[sensor]\nnoise = 1e-4\n\n[observer]\n{observer}{library}")
}

fn recognise(text: &str) -> Recognition {
    experiment(text).recognise(&NEVER).unwrap_or_else(|error| panic!("{error}")).expect("a library")
}

fn library() -> String {
    [
        entry("its mirror image", 1.2, mirrored(PEBBLE)),
        entry("the pebble", 1.2, PEBBLE),
        entry("one percent larger", 1.212, PEBBLE.map(|pair| pair.map(|x| 1.01 * x))),
        "\n[[observer.library]]\nname = \"an ellipse\"\nshape = { kind = \"ellipse\", semi_axes = [1.3, 1.1] }\n".to_owned(),
    ]
    .concat()
}

/// In three regimes the body is recognised among its mirror image, one that is one percent larger, and an ellipse; its angle and its rate at the first sample are those of the simulation within four deviations, and
/// what is left of the contacts is their noise: the root of chi-square over its degrees is within four of its own deviations of one.
#[test]
fn the_right_body_is_recognised() {
    for name in ["general", "one_palm_fixed", "same_rate"] {
        let text = scene(name, &library());
        let experiment = experiment(&text);
        let found = experiment.recognise(&NEVER).unwrap().unwrap();
        assert_eq!(
            (&found.verdict, found.names()),
            (&RecognitionVerdict::Recognised(1), vec!["the pebble"]),
            "{name}"
        );
        let body = &found.bodies[1];
        let first = &experiment.simulation.as_ref().unwrap().trajectory.moments[0];
        let turn = std::f64::consts::TAU;
        let off = (body.orientation.value - first.phi0 + 0.5 * turn).rem_euclid(turn) - 0.5 * turn;
        assert!(
            off.abs() < 4.0 * body.orientation.deviation && body.orientation.deviation < 1e-3,
            "{name}: {off:e}"
        );
        let off = body.rate.value - first.omega0;
        assert!(off.abs() < 4.0 * body.rate.deviation && body.rate.deviation < 1e-2, "{name}: {off:e}");
        let fit = body.fit.unwrap();
        assert_eq!(fit.degrees, 200);
        assert!(((fit.chi_square / 200.0).sqrt() - 1.0).abs() < 4.0 / 20.0, "{name}: {fit:?}");
        assert!((body.rms_residual / 1e-4 - 1.0).abs() < 0.2, "{name}");
        // the others are far off, and not by a little
        for other in [0, 2, 3] {
            let fit = found.bodies[other].fit.unwrap();
            assert!(!fit.fits && fit.chi_square > 1000.0, "{name}: {:?}", found.bodies[other]);
        }
    }
}

/// Where the body is not among them it is none of them, and the status is 1: by the program, as text, as JSON and on the page. A recording is answered as the simulation is.
#[test]
fn a_body_that_is_not_there_is_none_of_them() {
    let folder = crate::common::folder();
    let others = library().replace(&entry("the pebble", 1.2, PEBBLE), "");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let none = write("none.toml", &scene("general", &others));
    let output = palmistry(&["observe", &none, "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let recognition = &found["recognition"];
    assert_eq!(
        (&recognition["verdict"], &recognition["names"]),
        (&"none of them".into(), &Value::Array(vec![]))
    );
    assert_eq!(recognition["bodies"].as_array().unwrap().len(), 3);
    let whole = write("whole.toml", &scene("general", &library()));
    let (page, record) = (folder.path().join("page"), folder.path().join("run.csv"));
    let (page, record) = (page.to_str().unwrap(), record.to_str().unwrap());
    let output = palmistry(&["observe", &whole, "--out", page, "--record", record]);
    assert_eq!(output.status.code(), Some(0));
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(
        told.contains("recognition among 4 known bodies, from all measurements: it is the pebble\n"),
        "{told}"
    );
    let page = std::fs::read_to_string(format!("{page}/index.html")).unwrap();
    assert!(page.contains("Which body it is") && page.contains("it is the pebble"));
    let from = |arguments: &[&str]| -> Value {
        let found: Value = serde_json::from_slice(&palmistry(arguments).stdout).unwrap();
        found["recognition"].clone()
    };
    let recorded = from(&["observe", &whole, "--json", "--data", record]);
    assert_eq!(recorded["verdict"], "recognised");
    assert_eq!(recorded, from(&["observe", &whole, "--json"]));
}

/// Congruent bodies in frames that are turned against each other explain the same measurements, at angles that differ by just that turn; nobody is taken. The mirror image of such a body is another one.
#[test]
fn congruent_bodies_cannot_be_told_apart() {
    let both = [
        entry("the pebble", 1.2, PEBBLE),
        entry("its mirror image", 1.2, mirrored(PEBBLE)),
        entry("the pebble, turned", 1.2, turned(PEBBLE, 0.7)),
    ];
    let found = recognise(&scene("general", &both.concat()));
    let RecognitionVerdict::Alike(places) = &found.verdict else { panic!("{:?}", found.verdict) };
    let mut places = places.clone();
    places.sort_unstable();
    assert_eq!(places, [0, 2]);
    let [one, other] = [0, 2].map(|place: usize| &found.bodies[place]);
    let turn = (one.orientation.value - other.orientation.value).rem_euclid(std::f64::consts::TAU);
    assert!((turn - 0.7).abs() < 1e-6, "{turn}");
    assert!((one.rate.value - other.rate.value).abs() < 1e-6);
    assert!((one.fit.unwrap().chi_square - other.fit.unwrap().chi_square).abs() < 1e-3);
}

/// Of a right library so many seeds say that it is none of them as are allowed, one in a thousand: of 40 none or one (two by chance in 1300 such tests). Chi-square over its degrees is one in the mean, its
/// deviation being that of 40 times 200 squares.
#[test]
fn false_alarms_are_as_rare_as_stated() {
    let text = scene("general", &entry("the pebble", 1.2, PEBBLE));
    let (mut alarms, mut sum) = (0, 0.0);
    for seed in 1..=40 {
        let found = recognise(&format!("seed = {seed}\n{text}"));
        alarms += usize::from(found.verdict != RecognitionVerdict::Recognised(0));
        sum += found.bodies[0].fit.unwrap().chi_square / 200.0;
    }
    assert!(alarms <= 1, "{alarms}");
    let spread = (2.0_f64 / (40.0 * 200.0)).sqrt();
    assert!((sum / 40.0 - 1.0).abs() < 4.0 * spread, "{}", sum / 40.0);
}

/// What a library cannot be, with its place; and a body that is none.
#[test]
fn libraries_that_cannot_be_are_refused() {
    let text = scene("general", &library());
    for (from, to, message) in [
        ("noise = 1e-4", "noise = 0", "none are stated"),
        ("noise = 1e-4", "noise = 1e-4\ntau1 = { noise = 1e-3 }", "as of 'tau1'"),
        ("\"an ellipse\"", "\"the pebble\"", "'the pebble' is there twice"),
        ("\"an ellipse\"", "\"\"", "a name is empty"),
        ("semi_axes = [1.3, 1.1]", "semi_axes = [1.3, -1.1]", "has to be positive"),
        ("semi_axes = [1.3, 1.1]", "semi_axis = [1.3, 1.1]", "unknown key"),
    ] {
        let refused = Scene::parse("scene.toml", &with(&text, from, to)).unwrap_err().to_string();
        assert!(refused.contains(message), "{to}: {refused}");
    }
    let hollow = with(
        &text,
        "{ kind = \"ellipse\", semi_axes = [1.3, 1.1] }",
        "{ kind = \"harmonics\", mean = 1.0, harmonics = [[0, 0], [0.5, 0]] }",
    );
    let refused = experiment(&hollow).recognise(&NEVER).unwrap_err().to_string();
    assert!(refused.contains("convex"), "{refused}");
    let round = with(&text, "inertia = [0.5, 0.6]", "inertia = [0.5, 0.6]\nradii = [4.0, inf]");
    let refused = experiment(&round.replace("../general.proof", "../constraint/circular_palms.proof"));
    let refused = refused.recognise(&NEVER).unwrap_err().to_string();
    assert!(refused.contains("flat palms"), "{refused}");
    let streamed = crate::common::folder();
    let path = streamed.path().join("scene.toml");
    std::fs::write(&path, &text).unwrap();
    let output = palmistry(&["observe", path.to_str().unwrap(), "--data", "-"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("[[observer.library]]"));
}
