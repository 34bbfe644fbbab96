//! Motions whose contact breaks: they end there, say so, and what there is of them is observed.

use crate::common::{folder, write};
use crate::observe::{observe, text, with};
use palmistry::experiment::{Experiment, Scene};
use palmistry::mechanics::moving::Ended;
use serde_json::Value;

/// Both palms open: palm 1 would have to pull from 0.7276 s on.
fn opening() -> String {
    with(&text("same_rate"), "{ start = 1.8 }", "{ start = 1.8, rate = 1.0 }")
}

fn lost_at(text: &str) -> (usize, f64, Experiment) {
    let experiment = Experiment::new(Scene::parse("scene.toml", text).unwrap(), None).unwrap();
    let Ended::ContactLost { palm, time } = *experiment.simulation.as_ref().unwrap().ended() else {
        panic!("{:?}", experiment.simulation.as_ref().unwrap().ended())
    };
    (palm, time, experiment)
}

#[test]
fn a_motion_ends_where_a_contact_breaks_and_the_rest_is_observed() {
    let folder = folder();
    let scene = write(&folder, "scene.toml", opening());
    let (output, found) = observe(&scene, &[]);
    assert_eq!(output.status.code(), Some(0), "{found}");
    let (palm, time, experiment) = lost_at(&opening());
    let ended = found["simulation"]["ended"].as_str().unwrap();
    assert_eq!(ended, format!("contact with palm {palm} lost at {time:.6} s: its force is zero"));
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(words.contains(&format!("the motion ended early: {ended}")), "{words}");
    // every sample before the end is kept, and nothing after it: 401 samples over 1.4 s were asked for
    let before = (0..401).filter(|i| 1.4 * f64::from(*i) / 400.0 <= time).count();
    assert_eq!(found["samples"], before);
    // the force falls to zero and has not yet: Newton's third law has the last word on what is kept
    let moments = &experiment.simulation.as_ref().unwrap().trajectory.moments;
    assert!(moments.iter().all(|moment| moment.palms.iter().all(|palm| palm.force > 0.0)));
    assert!(moments[before - 1].palms[palm - 1].force < 0.05 * moments[0].palms[palm - 1].force);
    for observer in found["observers"].as_array().unwrap().iter().take(2) {
        let updates = observer["updates"].as_array().unwrap();
        assert_eq!(updates.len(), (before - 1) / 80);
        for update in updates {
            assert_eq!(update["status"], "converged", "{update}");
            for state in update["states"].as_object().unwrap().values() {
                assert!(state["error"].as_f64().unwrap() < 1e-8, "{update}");
            }
        }
        assert_eq!(observer["end"]["time"], moments[before - 1].time);
    }
}

/// A sample close before the end: no curve runs through two measurements a picosecond apart, so the end itself is no measurement.
#[test]
fn a_sample_next_to_the_end_spoils_nothing() {
    let (_, time, _) = lost_at(&opening());
    let duration = format!("duration = {:?}", (time - 1e-12) * 400.0 / 240.0);
    let (_, _, experiment) = lost_at(&with(&opening(), "duration = 1.4", &duration));
    let times = experiment.signals.times();
    assert_eq!(times.len(), 241);
    assert!(time - times[240] < 2e-12);
    let answers = crate::observe::answers(&experiment);
    for update in answers.iter().flat_map(|answer| &answer.track.updates) {
        let truth = experiment.truth_at(update.from).unwrap();
        for (found, truth) in update.estimate.iter().zip(&truth) {
            assert!((found / truth - 1.0).abs() < 1e-8, "{update:?}");
        }
    }
}

/// Samples so far apart that only the first is before the end: nothing to compare, and no one pretends to.
#[test]
fn a_single_sample_is_no_answer() {
    let folder = folder();
    let rare = with(&with(&opening(), "samples = 401", "samples = 2"), "window = 80", "window = 2");
    let scene = write(&folder, "scene.toml", rare);
    let (output, found) = observe(&scene, &[]);
    assert_eq!(found["samples"], 1, "{found}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("ended early"));
    for observer in found["observers"].as_array().unwrap() {
        assert_eq!(observer["updates"].as_array().map(Vec::len), Some(0));
        let end = &observer["end"];
        assert!(*end == Value::Null || end["time"] == 0.0, "{end}");
    }
}
