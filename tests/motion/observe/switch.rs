//! Several observers of one motion, of which the rank says who may answer.
//!
//! Oracles: a point whose place, poles and uninformative stretch are written down; a body between palms by Newton's laws, whose rate says when it turns with
//! a palm.

use crate::common::{folder, json, palmistry, write};
use crate::observe::{NEVER, experiment};
use palmistry::experiment::{Experiment, Scene};
use std::path::Path;

/// A point at `x = 1 + 0.5 t`, read through `a`, which is zero from 4 s on.
const PLAIN: &str = "system \"By its place\" state x, v known a(t) drift f x' = v v' = 0 output a*x \
                     sample x in [-5, 5] v in [-5, 5] a in [0, 1]";
/// The same by `s = x/c`, where `c = t - 2.53` with the rate `b = 1`: there is a pole at 2.53 s.
const DIVIDED: &str = "system \"By a quotient\" state s, v known b(t), c(t) drift f s' = (v - b*s)/c v' = 0 output c*s \
                       sample s in [-5, 5] v in [-5, 5] b in [-1, 1] c in [1, 2]";

fn scene(folder: &Path, first: &str, switch: &str) -> String {
    let mut measurements = String::from("time,a,b,c,\"a*x\",\"c*s\"\n");
    for i in 0..101 {
        let t = 0.05 * f64::from(i);
        let (x, a) = (1.0 + 0.5 * t, f64::from(u8::from(t < 3.99)));
        measurements += &format!("{t:?},{a:?},1.0,{:?},{:?},{x:?}\n", t - 2.53, a * x);
    }
    for (name, text) in [("place.proof", PLAIN), ("quotient.proof", DIVIDED), ("point.csv", &measurements)] {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let second = if first == "place" { "quotient" } else { "place" };
    let sought = |name: &str| if name == "place" { "\"x\", \"v\"" } else { "\"s\", \"v\"" };
    let folder = folder.display();
    format!(
        "title = \"A point\"\nmodel = \"{folder}/{first}.proof\"\n[data]\nrecord = \"{folder}/point.csv\"\n[sensor]\nnoise = 1e-3\n\
         [observer]\nmethods = [\"trust-region\"]\nmode = \"{first}\"\nestimate = [{}]\nguess = \"sample\"\nwindow = 20\nsteps = 30\n\
         switch = {switch}\n[[observer.modes]]\nname = \"{second}\"\nmodel = \"{folder}/{second}.proof\"\nestimate = [{}]\n",
        sought(first),
        sought(second)
    )
}

/// In the order of the scene, but for the window in which the first has a pole or is uninformative; and the answer is the point's own, whoever gives it.
#[test]
fn the_rank_says_who_answers() {
    let folder = folder();
    for (first, answered) in [
        ("quotient", ["quotient", "quotient", "place", "quotient", "quotient"]),
        // the sample at 4 s belongs to both windows beside it
        ("place", ["place", "place", "place", "quotient", "quotient"]),
    ] {
        let windows = experiment(&scene(folder.path(), first, "{}")).run_switched(&NEVER, &|| ()).unwrap();
        let chosen = windows.iter().map(|own| own.estimates[own.chosen.unwrap()].name.as_str());
        assert_eq!(chosen.collect::<Vec<_>>(), answered, "{windows:#?}");
        for window in &windows {
            let estimate = &window.estimates[window.chosen.unwrap()];
            let found = &estimate.update.as_ref().unwrap().estimate;
            let x = if estimate.name == "place" { found[0] } else { found[0] * (window.from - 2.53) };
            assert!((x - 1.0 - 0.5 * window.from).abs() < 1e-6 && (found[1] - 0.5).abs() < 1e-6, "{found:?}");
            let rank = estimate.rank.as_ref().unwrap();
            assert_eq!((rank.rank, rank.of, rank.pole.is_none()), (2, 2, true));
        }
        // what was not asked, and why
        let other = &windows[if first == "place" { 4 } else { 2 }].estimates[0];
        let (rank, why) = (other.rank.as_ref().unwrap(), other.objection.as_ref().unwrap());
        assert!(other.update.is_none());
        if first == "place" {
            assert_eq!((rank.rank, rank.of, why.word()), (0, 2, "rank"));
        } else {
            let pole = rank.pole.as_ref().unwrap();
            assert_eq!((pole.divisor.as_str(), why.word()), ("c", "singularity"));
            assert!((pole.time - 2.53).abs() < 1e-5, "{}", pole.time);
        }
    }
}

/// `d(c s) = (c, 0)`, `d((c s)') = (0, 1)`: nothing is left to decide of the place, and of the quotient neither, so that any condition will do; one
/// below one lets nobody answer.
#[test]
fn a_limit_of_the_condition_silences() {
    let folder = folder();
    let windows = experiment(&scene(folder.path(), "quotient", "{ condition = 0.5 }"));
    let windows = windows.run_switched(&NEVER, &|| ()).unwrap();
    assert!(windows.iter().all(|window| window.chosen.is_none()));
    let words: Vec<&str> =
        windows.iter().map(|own| own.estimates[0].objection.as_ref().unwrap().word()).collect();
    assert_eq!(words, ["condition", "condition", "singularity", "condition", "condition"]);
}

/// The same by the program: text, fields, status, and what a switch asks for.
#[test]
fn the_program_says_who_answered_and_why() {
    let folder = folder();
    let text = scene(folder.path(), "quotient", "{}");
    let file = write(&folder, "scene.toml", &text);
    let output = palmistry(&["observe", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0));
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(told.contains("quotient: not asked: a singularity, c = 0 at 2.5300 s"), "{told}");
    assert!(told.contains("place: answers: rank 2 of 2 at 21 samples, certified"), "{told}");
    let found = json(&palmistry(&["observe", file.to_str().unwrap(), "--json"]));
    let asked = &found["windows"][2]["modes"];
    assert_eq!(found["windows"][2]["mode"], "place");
    assert_eq!(asked[0]["rank"]["objection"], "singularity");
    assert_eq!(asked[0]["rank"]["singularity"]["divisor"], "c");
    assert_eq!(
        (&asked[1]["rank"]["rank"], &asked[1]["rank"]["objection"]),
        (&2.into(), &serde_json::Value::Null)
    );
    assert_eq!(found["windows"][0]["modes"].as_array().unwrap().len(), 1);
    let alone = text.split("[[observer.modes]]").next().unwrap();
    let file = write(&folder, "alone.toml", alone);
    let refused = palmistry(&["observe", file.to_str().unwrap()]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("nothing to switch to"));
}

/// What the program carries is what is proved: the same states, rates and outputs.
#[test]
fn the_equations_are_those_of_the_proof_file() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002/constraint/palms.proof");
    let proved = std::fs::read_to_string(file).unwrap();
    let from = |text: &str| text[text.find("\nstate ").unwrap()..].to_owned();
    let proved = from(&proved);
    let equations = proved.split("claim ").next().unwrap().trim_end();
    assert!(equations.contains("drift time") && equations.contains("output 0"));
    assert_eq!(from(palmistry::experiment::EQUATIONS).trim_end(), equations);
}

/// Interrupted before any state was asked about, nothing is certified, and nobody answers.
#[test]
fn a_rank_at_no_sample_is_none() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002/scenes/touchpad_switch.toml");
    let experiment = Experiment::new(Scene::read(&scene).unwrap(), None).unwrap();
    let windows = experiment.run_switched(&std::sync::atomic::AtomicBool::new(true), &|| ()).unwrap();
    for window in &windows {
        assert_eq!(window.chosen, None);
        for rank in window.estimates.iter().filter_map(|estimate| estimate.rank.as_ref()) {
            assert_eq!((rank.asked, rank.decided, rank.rank, rank.certified), (0, 0, 0, false));
            assert!(rank.objection(f64::INFINITY).is_some());
        }
    }
}

/// The shipped scene: a touchpad (100 Hz, 0.1 mm) under a body of the size of a hand. All seven windows are answered, four of them by the thesis's state, and whoever
/// answers, rate and distances at the window's beginning are within five and a half bounds of the body's own.
#[test]
fn a_touchpad_is_answered_in_every_window() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002/scenes/touchpad_switch.toml");
    let experiment = Experiment::new(Scene::read(&scene).unwrap(), None).unwrap();
    let windows = experiment.run_switched(&NEVER, &|| ()).unwrap();
    let truth = &experiment.simulation.as_ref().unwrap().trajectory.moments;
    let mut by_the_first = 0;
    for window in &windows {
        let chosen = window.chosen.unwrap_or_else(|| panic!("nobody answers from {} s", window.from));
        let update = window.estimates[chosen].update.as_ref().unwrap();
        let at = truth.iter().find(|moment| moment.time == window.from).unwrap();
        for (place, own) in [at.palms[0].r, at.palms[1].r, at.omega0].into_iter().enumerate() {
            let off = (update.estimate[place] - own).abs() / update.deviations[place];
            assert!(off < 5.5, "{} s: {off} bounds", window.from);
        }
        by_the_first += u32::from(chosen == 0);
    }
    assert_eq!((windows.len(), by_the_first), (7, 4));
}
