mod mistakes;

use super::*;
use palmistry_bodies::mechanics::moving::{Course, Drive, Knots, Oscillation, PushedPalm};
use palmistry_observe::{HighGain, Kalman, Loss, OnFault, Shooting, Unscented, WhenUnobservable};
use std::collections::BTreeMap;

const WHOLE: &str = r#"title = "Both palms turn at one constant rate"
model = "../proofs/general.proof"
seed = 7
duration = 1.4
samples = 401

[body]
shape = { kind = "harmonics", mean = 1.0, harmonics = [[0, 0], [0.1, 0], [0.02, -0.03]] }
mass = 1.0
radius_of_gyration = 0.7
centre_of_mass = [0.0, 0.1]
orientation = 0.3
rate = 1.0
gravity = -9.8

[palms]
inertia = [0.5, 0.4]
prescribed = [
  { start = 0.8, rate = 0.5, swings = [{ amplitude = 0.1, frequency = 1.0, phase = 0.2 }] },
  { start = 1.6 },
]

[sensor]
noise = 1e-5
resolution = 1e-4
jitter = 0.001

[data]
on_fault = "skip"
spike = 6.0

[observer]
methods = ["newton", "trust-region", "integration", "kalman", "high-gain"]
estimate = ["r1", "r2", "omega0"]
known = { rho = 0.6 }
guess = { r1 = 2.0, r2 = 2.0, omega0 = 0 }
clamp = ["omega0"]
window = 60
steps = 4
when_unobservable = "hold"
unobservable_above = 0.5

[observer.shooting]
starts = 3

[observer.kalman]
prior = 0.2

[observer.unscented]
kappa = 0

[observer.high_gain]
gain = 30

[study.noise]
levels = [1e-5, 1e-4]
seeds = 500

[study.basin]
r1 = [0.5, 3.0]
r2 = [0.5, 3]
points = 21
"#;

const SHORT: &str = r#"title = "A short one"
model = "a.proof"
duration = 1
rate = 100
[body]
shape = { kind = "ellipse", semi_axes = [1.2, 0.9] }
mass = 1
[palms]
inertia = [0.5, 0.5]
torques = [{ angle = 0.8, torque = 10 }, { angle = 1.6, torque = -10 }]
[observer]
methods = ["newton"]
estimate = ["r1"]
guess_off = 0.1
"#;

fn parse(text: &str) -> Scene {
    Scene::parse("scenes/file.toml", text).unwrap_or_else(|e| panic!("{e}: {:?}", e.help))
}

/// The whole scene with a text replaced, which has to be there once.
fn with(from: &str, to: &str) -> String {
    assert_eq!(WHOLE.matches(from).count(), 1, "{from}");
    WHOLE.replace(from, to)
}

/// The error of a text: its message, what it marks and what it says to do.
fn error(text: &str) -> (String, String, String) {
    let error = Scene::parse("file.toml", text).err().unwrap_or_else(|| panic!("no error in\n{text}"));
    let marked = &text[error.span.offset()..][..error.span.len()];
    (error.message.clone(), marked.to_owned(), error.help.unwrap_or_default())
}

/// The error as it is shown on a terminal without colours.
fn shown(text: &str) -> String {
    let error = Scene::parse("file.toml", text).err().unwrap_or_else(|| panic!("no error in\n{text}"));
    let mut out = String::new();
    let handler =
        miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::unicode_nocolor()).with_width(90);
    handler.render_report(&mut out, &error).unwrap();
    out
}

/// Single columns in tables of their own, in either way that TOML has for them.
#[test]
fn columns_have_sensors_of_their_own() {
    let table = SHORT.replace("[observer]", "[sensor.tau1]\nnoise = 0.01\ngain = 1.01\n[observer]");
    let inline = SHORT.replace(
        "[observer]",
        "[sensor]\nnoise = 1e-5\ntau1 = { noise = 0.01, gain = 1.01 }\ns1 = { resolution = 1e-4 }\n[observer]",
    );
    let torque = Channel { noise: Some(0.01), gain: 1.01, ..Channel::default() };
    let scene = Scene::parse("scenes/a.toml", &table).unwrap();
    assert_eq!(scene.channels, [("tau1".to_owned(), torque)].into());
    assert_eq!(scene.sensor, Sensor::default());
    let scene = Scene::parse("scenes/a.toml", &inline).unwrap();
    let contact = Channel { resolution: Some(1e-4), ..Channel::default() };
    assert_eq!(scene.channels, [("tau1".to_owned(), torque), ("s1".to_owned(), contact)].into());
    assert_eq!((scene.sensor.noise, scene.fault_rules().resolution["s1"]), (1e-5, 1e-4));
}

#[test]
fn every_key_arrives_where_it_belongs() {
    let scene = parse(WHOLE);
    assert_eq!(scene.title, "Both palms turn at one constant rate");
    assert_eq!(scene.model, Path::new("scenes/../proofs/general.proof"));
    assert_eq!(scene.seed, 7);
    let Some(Simulated { duration: 1.4, samples: 401, body, palms }) = &scene.simulated else {
        panic!("{:?}", scene.simulated)
    };
    let harmonics = vec![[0.0, 0.0], [0.1, 0.0], [0.02, -0.03]];
    let body_meant = Body {
        shape: SceneOutline::Harmonics { mean: 1.0, harmonics },
        mass: 1.0,
        radius_of_gyration: Some(0.7),
        centre_of_mass: Some([0.0, 0.1]),
        orientation: 0.3,
        rate: 1.0,
        gravity: -9.8,
    };
    assert_eq!(*body, body_meant);
    let swings = vec![Oscillation { amplitude: 0.1, frequency: 1.0, phase: 0.2 }];
    let prescribed =
        [Course { start: 0.8, rate: 0.5, swings }, Course { start: 1.6, rate: 0.0, swings: Vec::new() }];
    assert_eq!(*palms, Palms { inertia: [0.5, 0.4], drive: Drive::Prescribed(prescribed), friction: 0.0 });
    assert_eq!(scene.sensor, Sensor { noise: 1e-5, resolution: 1e-4, jitter: 1e-3 });
    assert_eq!(scene.data, Data { on_fault: OnFault::Skip, spike: 6.0, ..Data::default() });
    let value = |pairs: &[(&str, f64)]| pairs.iter().map(|(name, v)| ((*name).to_owned(), *v)).collect();
    let observer = ObserverSettings {
        methods: vec![
            Method::Newton,
            Method::TrustRegion,
            Method::Integration,
            Method::Kalman,
            Method::HighGain,
        ],
        estimate: ["r1", "r2", "omega0"].map(str::to_owned).to_vec(),
        known: value(&[("rho", 0.6)]),
        inputs: Default::default(),
        guess: Guess::Values(value(&[("r1", 2.0), ("r2", 2.0), ("omega0", 0.0)])),
        clamp: vec!["omega0".to_owned()],
        window: 60,
        steps: 4,
        when_unobservable: WhenUnobservable::Hold,
        unobservable_above: 0.5,
        inherit: true,
        whole: false,
        bounds: BTreeMap::new(),
        loss: Loss::Squares,
        shooting: Shooting { starts: 3, ..Shooting::default() },
        kalman: Kalman { prior: 0.2, ..Kalman::default() },
        unscented: Unscented { kappa: 0.0, ..Unscented::default() },
        high_gain: HighGain { gain: 30.0 },
        library: Vec::new(),
        mode: "the scene's own model".to_owned(),
        modes: Vec::new(),
        switch: None,
    };
    assert_eq!(scene.observer, observer);
    assert_eq!(scene.study.noise, Some(NoiseStudy { levels: vec![1e-5, 1e-4], seeds: 500 }));
    let ranges = [("r1".to_owned(), [0.5, 3.0]), ("r2".to_owned(), [0.5, 3.0])].into();
    assert_eq!(scene.study.basin, Some(BasinStudy { ranges, points: 21 }));
    let rules = scene.fault_rules();
    assert_eq!((rules.on_fault, rules.spike, rules.jitter), (OnFault::Skip, 6.0, 1e-3));
    assert_eq!(rules.resolution, value(&[("s1", 1e-4), ("s2", 1e-4)]));
}

#[test]
fn what_is_not_given_has_its_default() {
    let scene = parse(SHORT);
    let simulated = scene.simulated.unwrap();
    // 100 Hz for a second: 100 steps and the sample at zero
    assert_eq!((simulated.duration, simulated.samples), (1.0, 101));
    assert_eq!((simulated.body.orientation, simulated.body.rate, simulated.body.gravity), (0.0, 0.0, -9.81));
    assert_eq!(simulated.body.centre_of_mass, None);
    let palm = |angle, torque| PushedPalm { angle, rate: 0.0, torque, swings: Vec::new() };
    assert_eq!(simulated.palms.drive, Drive::Torques([palm(0.8, 10.0), palm(1.6, -10.0)]));
    assert_eq!(scene.seed, 1);
    assert_eq!(scene.sensor, Sensor::default());
    assert_eq!(scene.data, Data::default());
    assert_eq!(scene.observer.guess, Guess::Off(0.1));
    assert_eq!(
        (scene.observer.window, scene.observer.steps, scene.observer.unobservable_above),
        (80, 5, 1.0)
    );
    assert_eq!(scene.observer.when_unobservable, WhenUnobservable::Integrate);
    assert_eq!(scene.study, Study::default());
}

#[test]
fn a_scene_of_recorded_data_needs_no_body() {
    let text = "title = \"Recorded\"\nmodel = \"a.proof\"\n[data]\nrecord = \"run.csv\"\n[observer]\n\
                methods = [\"newton\"]\nestimate = [\"r1\"]\nguess = { r1 = 1 }\n";
    let scene = parse(text);
    assert_eq!((scene.simulated, scene.data.record), (None, Some("scenes/run.csv".into())));
    assert!(error(&text.replace("guess = { r1 = 1 }", "guess_off = 0.1")).0.contains("no truth"));
    assert!(error(&format!("{text}[study.noise]\nlevels = [1]\nseeds = 1\n")).0.contains("needs the truth"));
    assert!(error(&text.replace("record = \"run.csv\"", "")).0.contains("nothing is simulated"));
    assert!(error(&text.replace("model", "duration = 1\nmodel")).0.contains("without 'samples' or 'rate'"));
}

#[test]
fn every_shape_can_be_written() {
    let shape = |text: &str| {
        let text = SHORT.replace("{ kind = \"ellipse\", semi_axes = [1.2, 0.9] }", text);
        parse(&text).simulated.unwrap().body.shape
    };
    assert_eq!(
        shape("{ kind = \"superellipse\", semi_axes = [1.2, 0.9], exponent = 4, rounding = 0.1 }"),
        SceneOutline::Superellipse { semi_axes: [1.2, 0.9], exponent: 4, rounding: 0.1 }
    );
    assert_eq!(
        shape("{ kind = \"ellipse\", semi_axes = [1, 2] }"),
        SceneOutline::Ellipse { semi_axes: [1.0, 2.0] }
    );
    assert_eq!(
        shape("{ kind = \"arcs\", corners = [[-1, 0], [1, 0]], radius = 2 }"),
        SceneOutline::Arcs { corners: vec![[-1.0, 0.0], [1.0, 0.0]], radius: 2.0 }
    );
    let radii = [1.2, 1.5, 1.3];
    assert_eq!(
        shape("{ kind = \"spline\", radii = [1.2, 1.5, 1.3] }"),
        SceneOutline::Spline { radii, knots: Knots::Uniform }
    );
    assert_eq!(
        shape("{ kind = \"random-spline\", seed = 3 }"),
        SceneOutline::RandomSpline { seed: 3, knots: Knots::Uniform }
    );
    assert_eq!(
        shape("{ kind = \"harmonics\", mean = 1 }"),
        SceneOutline::Harmonics { mean: 1.0, harmonics: Vec::new() }
    );
}

/// The message, the marked place and the advice of each mistake are as expected.
#[test]
fn mistakes_are_shown_at_their_place() {
    for (name, from, to) in [
        ("unknown_key", "window = 60", "windw = 60"),
        ("unknown_kind", "\"harmonics\"", "\"ellips\""),
        ("negative_mass", "mass = 1.0", "mass = -1.0"),
        ("missing_key", "mass = 1.0\n", ""),
        ("text_for_a_number", "phase = 0.2", "phase = \"none\""),
        ("no_first_guess", "r2 = 2.0, omega0 = 0 }", "omega0 = 0 }"),
        ("no_toml", "[body]", "[body"),
    ] {
        insta::assert_snapshot!(name, shown(&with(from, to)));
    }
}

/// What no method of a scene heeds is named, and nothing else is.
#[test]
fn keys_that_change_nothing_are_named() {
    let own =
        "loss = \"huber\"\nwhole = true\n[observer.shooting]\nstarts = 3\n[observer.kalman]\nprior = 0.2\n";
    let text = SHORT.replace("[observer]", "[sensor]\nnoise = 1e-3\n[observer]") + own;
    let unheeded = |methods: &str| -> Vec<&str> {
        let scene = parse(&text.replace("[\"newton\"]", methods));
        scene.unheeded_keys().into_iter().map(|(key, _)| key).collect()
    };
    assert_eq!(unheeded("[\"kalman\"]"), ["loss", "whole", "shooting"]);
    assert_eq!(unheeded("[\"kalman\", \"newton\"]"), ["shooting"]);
    assert_eq!(unheeded("[\"smoother\", \"multiple-shooting\"]"), [""; 0]);
    assert_eq!(unheeded("[\"integration\"]"), ["loss", "whole", "shooting", "kalman"]);
    assert!(parse(SHORT).unheeded_keys().is_empty());
}

#[test]
fn files_that_a_scene_names_are_looked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let said = Scene::read(&path).unwrap_err();
    assert!(said.message.contains("cannot read"), "{said}");
    std::fs::write(&path, SHORT).unwrap();
    let said = Scene::read(&path).unwrap_err();
    assert!(said.message.contains("there is no file"), "{said}");
    assert_eq!(said.line_and_column(), (2, 9));
    std::fs::write(folder.path().join("a.proof"), "").unwrap();
    assert_eq!(Scene::read(&path).unwrap().model, folder.path().join("a.proof"));
}

#[test]
fn others_can_mark_a_place() {
    let scene = parse(WHOLE);
    let marked = |place: &str| {
        let error = scene.error_at(place, "no such state", "here", "name another");
        WHOLE[error.span.offset()..][..error.span.len()].to_owned()
    };
    assert_eq!(marked("observer.estimate[2]"), "\"omega0\"");
    assert_eq!(marked("palms.prescribed[0].swings[0].frequency"), "1.0");
    assert_eq!(marked("observer.known.rho"), "0.6");
    assert_eq!(marked("observer.estimate[7]"), "[\"r1\", \"r2\", \"omega0\"]");
    assert_eq!(marked("nowhere"), "t");
}

/// Even steps, and steps whose mean and standard deviation are those of figure 3.9b: 0.010 s and 0.0050 s.
#[test]
fn sample_times_are_even_or_have_the_jitter_asked_for() {
    let mut simulated = parse(SHORT).simulated.unwrap();
    (simulated.duration, simulated.samples) = (200.0, 20_001);
    let even = simulated.times(0.0, 1);
    assert!(even.iter().enumerate().all(|(i, t)| (t - 0.01 * i as f64).abs() < 1e-12));
    let times = simulated.times(0.005, 1);
    assert_eq!((times.len(), times[0], times[20_000]), (20_001, 0.0, 200.0));
    let steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    assert!(steps.iter().all(|step| *step > 0.0));
    let variance = steps.iter().map(|step| (step - 0.01).powi(2)).sum::<f64>() / steps.len() as f64;
    // of 20 000 draws from three bands the standard deviation is known to a quarter percent, and it is scaled by a
    // factor as near to one
    assert!((variance.sqrt() / 0.005 - 1.0).abs() < 0.015, "{}", variance.sqrt());
    assert_eq!(times, simulated.times(0.005, 1));
    assert_ne!(times, simulated.times(0.005, 2));
}

/// A record sampled with the jitter of figure 3.9b has no gap for rules that know the jitter, and the removal of one sample at
/// either side of two others is detected.
#[test]
fn the_rules_of_a_scene_cope_with_its_jitter() {
    let text = SHORT.replace("[observer]", "[sensor]\njitter = 0.005\n[observer]");
    let scene = parse(&text);
    let times = scene.simulated.as_ref().unwrap().times(scene.sensor.jitter, scene.seed);
    let values = times.iter().map(|t| (3.0 * t).sin()).collect();
    let record = palmistry_observe::Record::new(times, vec![("s1".to_owned(), values)]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("record.csv");
    record.write(&path).unwrap();
    let faults = |path: &Path| {
        let rows = palmistry_observe::RecordRows::read(path, &[]).unwrap();
        palmistry_observe::faults_of(&rows, &scene.fault_rules())
    };
    assert_eq!(faults(&path), []);
    let lines: Vec<String> = std::fs::read_to_string(&path).unwrap().lines().map(str::to_owned).collect();
    std::fs::write(&path, [&lines[..40], &lines[46..]].concat().join("\n")).unwrap();
    let found = faults(&path);
    assert_eq!(found.iter().map(|fault| fault.row).collect::<Vec<_>>(), [40]);
}
