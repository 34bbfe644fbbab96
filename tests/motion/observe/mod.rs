//! Story 4: can shape and motion be recovered from where the contacts lie?
//!
//! The motions come from `palmistry::mechanics`, which knows no equation of the thesis; the observers know only measurements and
//! the equations of `general.proof`. What is recovered is held against the body itself, never against another run.

mod advice;
mod advice_space;
mod bars;
mod broken;
mod channels;
mod choice;
mod circular;
mod coefficients;
mod columns;
mod control_points;
mod coverage;
mod ends;
mod fitting;
mod inherited;
mod library;
mod modes;
mod noise;
mod options;
mod piped;
mod random;
mod recorded;
mod recovered;
mod refused;
mod robot;
mod shape;
mod sparse;
mod stream;
mod switch;
mod systems;
mod touchpad;
mod witness;
mod wrong;

use crate::common::palmistry;
use palmistry::experiment::{Answer, Experiment, Scene};
use serde_json::Value;
use std::path::Path;
use std::process::Output;
use std::sync::atomic::AtomicBool;

static NEVER: AtomicBool = AtomicBool::new(false);

/// The scenes of the thesis's four regimes: sections 4.3 (both palms, palm 1 fixed), 4.4 and 4.2.
const REGIMES: [&str; 4] = ["same_rate", "one_palm_fixed", "fixed_palms", "general"];

/// The text of a scene of the project, without its studies, that can be read from anywhere.
fn text(name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text =
        std::fs::read_to_string(root.join("proofs/moll2002/scenes").join(format!("{name}.toml"))).unwrap();
    let proofs = format!("\"{}/", root.join("proofs/moll2002").display());
    let whole = text.replace("\"../", &proofs);
    whole.split("[study.").next().unwrap().to_owned()
}

/// A text with a part replaced, which has to be there once.
fn with(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "{from}");
    text.replace(from, to)
}

/// The experiment of a scene's text.
fn experiment(text: &str) -> Experiment {
    let scene = Scene::parse("scene.toml", text).unwrap_or_else(|error| panic!("{error}"));
    Experiment::new(scene, None).unwrap_or_else(|error| panic!("{error}"))
}

fn answers(experiment: &Experiment) -> Vec<Answer> {
    experiment.run(&NEVER, &|_| ()).unwrap()
}

/// What `palmistry observe` makes of a scene, with one JSON object on standard output whatever happens.
fn observe(scene: &Path, more: &[&str]) -> (Output, Value) {
    let output = palmistry(&[&["observe", scene.to_str().unwrap(), "--json"], more].concat());
    // exactly one: anything before or after it would be an error of the reader
    let found = crate::common::json(&output);
    assert!(found.is_object(), "{found}");
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!words.contains("panicked"), "{words}");
    (output, found)
}

/// The message and the advice of a refusal, which names a line of the scene.
fn refusal(output: &Output, found: &Value) -> (String, String) {
    assert_eq!(output.status.code(), Some(2), "{found}");
    let word = |key: &str| found["error"][key].as_str().unwrap_or_default().to_owned();
    assert!(found["error"]["line"].as_u64().is_some_and(|line| line > 0), "{found}");
    (word("message"), word("help"))
}
