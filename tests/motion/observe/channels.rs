//! Errors of every column: bounds that hold, sensors that are wrong, and what is found out about them.

use crate::common::{folder, write};
use crate::observe::{NEVER, REGIMES, experiment, observe, refusal, text};
use palmistry::experiment::{Experiment, NoiseLevel, NoiseStudy, noise_study};
use palmistry::observer::{MovingWindow, Update, WindowSearch};

/// The standard deviation of the contacts, in m.
const CONTACTS: f64 = 1e-5;

/// A regime whose contacts have noise, with more about its sensors.
fn with_sensors(name: &str, more: &str) -> String {
    format!("{}\n[sensor]\nnoise = {CONTACTS:e}\n{more}", text(name))
}

/// The same, where something is sought beside the states.
fn seeking(name: &str, sought: &str, more: &str) -> String {
    with_sensors(name, more).replace("\"omega0\"", &format!("\"omega0\", \"{sought}\""))
}

/// The first window.
fn first(experiment: &Experiment) -> Update {
    let observer = MovingWindow { steps: 100, ..experiment.window(WindowSearch::TrustRegion) };
    let task = experiment.task(&NEVER).unwrap();
    observer.update(&task, &task.guess, &(0..observer.window + 1), &[])
}

fn study(name: &str, column: &str, noise: f64, seeds: usize) -> NoiseLevel {
    let experiment = experiment(&with_sensors(name, &format!("[sensor.{column}]\nnoise = {noise:e}\n")));
    let simulation = experiment.simulation.as_ref().unwrap();
    let settings = NoiseStudy { levels: vec![CONTACTS], seeds };
    noise_study(&experiment, simulation, &settings, &NEVER, &|| ()).unwrap().remove(0)
}

/// One column a regime: a torque, a rate, an angle, a contact. The errors of a state over its bound have a mean square of one; that of 4 x 10
/// normal numbers has the standard deviation sqrt(2/40), its root half of that. All columns and 200 seeds: `benches/channels`.
#[test]
fn bounds_count_the_errors_of_all_columns() {
    const SEEDS: usize = 10;
    let mut squares = [0.0; 3];
    for (name, (column, noise)) in
        REGIMES.iter().zip([("tau1", 1e-2), ("omega2", 1e-3), ("phi1", 1e-4), ("s2", 1e-4)])
    {
        let level = study(name, column, noise, SEEDS);
        assert_eq!((level.converged, level.unfit), (SEEDS, 0), "{name}, {column}");
        for ((square, error), bound) in squares.iter_mut().zip(&level.errors).zip(&level.bounds) {
            *square += (error / bound).powi(2) / REGIMES.len() as f64;
        }
        // and it is this column that errs: alone the contacts would tell more
        let alone = study(name, "alpha1", 0.0, 1);
        let is_worse = level.bounds.iter().zip(&alone.bounds).all(|(erring, alone)| erring > alone);
        assert!(is_worse, "{name}, {column}: {level:?} {alone:?}");
    }
    let spread = 4.0 / (2.0 * (SEEDS * REGIMES.len()) as f64).sqrt();
    for square in squares {
        assert!((square.sqrt() - 1.0).abs() < spread, "{squares:?}");
    }
}

/// A torque that errs and is not said to does not fit, and one that is said to does.
#[test]
fn an_error_that_is_not_stated_is_noticed() {
    let text = with_sensors("same_rate", "[sensor.tau1]\nnoise = 0.1\n");
    let experiment = experiment(&text);
    let update = first(&experiment);
    assert!(update.is_borne_out(), "{update:?}");
    let mut task = experiment.task(&NEVER).unwrap();
    assert!(task.errors.remove("tau1").is_some());
    let observer = MovingWindow { steps: 100, ..experiment.window(WindowSearch::TrustRegion) };
    let update = observer.update(&task, &task.guess, &(0..81), &[]);
    assert!(!update.is_borne_out(), "{update:?}");
}

/// What is sought of a sensor is found within its bound, and without it nothing fits; what is known of it is undone.
#[test]
fn gains_biases_and_delays_of_sensors_are_found_or_undone() {
    for (sensor, sought, truth) in [
        ("[sensor.tau1]\ngain = 1.01\n", Some("tau1.gain"), 1.01),
        ("[sensor.tau2]\nbias = 0.05\n", Some("tau2.bias"), 0.05),
        ("[sensor.s1]\nbias = 2e-3\n", Some("s1.bias"), 2e-3),
        ("[sensor.s1]\ndelay = 1e-3\n[sensor.s2]\ndelay = 1e-3\n", None, 0.0),
    ] {
        let unknowing = first(&experiment(&with_sensors("general", sensor)));
        assert!(!unknowing.is_borne_out(), "{sensor}: {unknowing:?}");
        let Some(sought) = sought else {
            let text = with_sensors("general", sensor);
            let knows = "inputs = { g1 = \"tau1\", g2 = \"tau2\" }\nknown = { \"s1.delay\" = 1e-3, \"s2.delay\" = 1e-3 }";
            let knowing =
                first(&experiment(&text.replace("inputs = { g1 = \"tau1\", g2 = \"tau2\" }", knows)));
            assert!(knowing.is_borne_out(), "{sensor}: {knowing:?}");
            continue;
        };
        let seeker = experiment(&seeking("general", sought, sensor));
        let place = seeker.names().iter().position(|name| *name == sought).unwrap();
        assert_eq!(seeker.truth_at(0.0).unwrap()[place], truth);
        let update = first(&seeker);
        assert!(update.is_borne_out(), "{sensor}: {update:?}");
        let (error, bound) = (update.estimate[place] - truth, update.deviations[place]);
        assert!(error.abs() < 4.0 * bound, "{sought}: {error:e} for {bound:e}");
        assert!(update.suspects.iter().all(|suspect| suspect.to_string() != format!("the gain of {sought}")));
    }
}

/// Delays of the contacts, alike and not, are found beside the state within four of their bounds in each regime, and the bound is a small part of them. What is
/// late was made so by the simulation, from the motion itself.
#[test]
fn delays_of_contacts_are_found() {
    for name in REGIMES {
        for delays in [[1e-3, 0.0], [1e-3, 1e-3], [0.0, 5e-3]] {
            let sensor =
                format!("[sensor.s1]\ndelay = {:e}\n[sensor.s2]\ndelay = {:e}\n", delays[0], delays[1]);
            let seeker = experiment(&seeking(name, "s1.delay\", \"s2.delay", &sensor));
            let truth = seeker.truth_at(0.0).unwrap();
            assert_eq!(truth[3..5], delays, "{name}");
            let update = first(&seeker);
            assert!(update.is_borne_out(), "{name}, {delays:?}: {update:?}");
            for ((found, truth), bound) in update.estimate.iter().zip(&truth).zip(&update.deviations) {
                assert!((found - truth).abs() < 4.0 * bound, "{name}, {delays:?}: {update:?}");
            }
            assert!(update.deviations[3..5].iter().all(|bound| *bound < 2e-4), "{name}: {update:?}");
            let told = |what: &str| update.suspects.iter().any(|suspect| suspect.to_string().contains(what));
            assert!(!told("delay"), "what is sought is under no suspicion");
        }
    }
}

/// Of a spring that swings freely no measurement of its place tells the gain from the amplitude; where gravity pulls, they do.
#[test]
fn what_the_rank_does_not_tell_is_refused_in_words() {
    let folder = folder();
    let rows: Vec<String> = (0..41)
        .map(|i| 0.05 * f64::from(i))
        .map(|t| format!("{t},{},{}", 1.01 * (2.0 * t).cos(), -(0.5 * t).sin()))
        .collect();
    write(&folder, "run.csv", format!("time,x,u\n{}\n", rows.join("\n")));
    let model = |pull: &str| {
        format!(
            "system \"A mass on a spring\"\nstate x, v\nparam u\ndrift f\n  x' = v\n  v' = -4*x{pull}\n\
             input g\n  v' = 0\n  others' = 0\noutput x\n"
        )
    };
    write(&folder, "free.proof", model(""));
    write(&folder, "hung.proof", model(" - 9.81"));
    let scene = |model: &str, sought: &str| {
        let text = format!(
            "title = \"A spring\"\nmodel = \"{model}.proof\"\n[data]\nrecord = \"run.csv\"\n[sensor]\nnoise = 1e-4\n\
             [observer]\nmethods = [\"trust-region\"]\nestimate = [\"v\", \"{sought}\"]\nguess = {{ v = 0.1 }}\n\
             inputs = {{ g = \"u\" }}\nwindow = 40\nsteps = 50\n"
        );
        write(&folder, "scene.toml", text)
    };
    let (output, found) = observe(&scene("free", "x.gain"), &[]);
    let (message, help) = refusal(&output, &found);
    assert_eq!(message, "no measurements distinguish 'x.gain' from v: the rank is short of them");
    assert!(help.contains("leave it out of 'estimate'"), "{help}");
    let (output, found) = observe(&scene("free", "u.gain"), &[]);
    assert!(refusal(&output, &found).0.starts_with("no measurements determine 'u.gain'"), "{found}");
    let (output, found) = observe(&scene("free", "w.gain"), &[]);
    assert!(refusal(&output, &found).0.contains("'w.gain' is no state"), "{found}");
    // what is late of a free motion is another one of it; what drives it and is on time tells the delay
    let (output, found) = observe(&scene("free", "x.delay"), &[]);
    assert_eq!(
        refusal(&output, &found).0,
        "no measurements distinguish 'x.delay' from v: the rank is short of them"
    );
    write(&folder, "driven.proof", model("").replace("v' = 0", "v' = 1"));
    let (output, found) = observe(&scene("driven", "x.delay"), &[]);
    assert_ne!(output.status.code(), Some(2), "{found}");
    let (output, found) = observe(&scene("driven", "u.delay"), &[]);
    assert!(refusal(&output, &found).0.starts_with("the delay of 'u' cannot be estimated"), "{found}");
    // it is told from the amplitude by gravity, and the measurements then contradict a model that has it
    let (output, _) = observe(&scene("hung", "x.gain"), &[]);
    assert_eq!(output.status.code(), Some(1));
    let (_, found) = observe(&scene("free", "x.bias"), &[]);
    let bias = &found["observers"][0]["updates"][0]["states"]["x.bias"];
    assert!(bias["recovered"].as_f64().is_some_and(|bias| bias.abs() < 1e-3), "{found}");
}

#[test]
fn what_cannot_be_said_of_a_sensor_is_refused() {
    let folder = folder();
    for (more, message) in [
        ("[sensor.tau3]\nnoise = 1.0\n", "there is no column 'tau3'"),
        ("[sensor.r1]\nnoise = 1.0\n", "there is no column 'r1'"),
    ] {
        let scene = write(&folder, "scene.toml", with_sensors("same_rate", more));
        let (output, found) = observe(&scene, &[]);
        assert_eq!(refusal(&output, &found).0, message);
    }
    for (known, message) in [
        ("\"tau1.gain\" = 0.0", "a gain of zero of 'tau1' cannot be undone"),
        ("\"tau3.gain\" = 1.0", "there is no column 'tau3'"),
    ] {
        let inputs = "inputs = { g1 = \"tau1\", g2 = \"tau2\" }";
        let text = with_sensors("same_rate", "").replace(inputs, &format!("{inputs}\nknown = {{ {known} }}"));
        let scene = write(&folder, "scene.toml", text);
        let (output, found) = observe(&scene, &[]);
        assert_eq!(refusal(&output, &found).0, message);
    }
}
