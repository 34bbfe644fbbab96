//! The observer that `--accuracy` and `--within` choose.

use crate::common::{folder, palmistry, write};
use crate::observe::observe;
use serde_json::Value;
use std::path::{Path, PathBuf};

const SCENE: &str = r#"
title = "A van der Pol oscillator"
model = "MODEL"
duration = 16
samples = 641

[start]
x = 1.2
y = -0.5
mu = 1.4

[sensor]
noise = 0.01

[observer]
estimate = ["x", "y", "mu"]
"#;

fn scene(folder: &tempfile::TempDir, text: &str) -> PathBuf {
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/systems/van_der_pol.proof");
    write(folder, "scene.toml", text.replace("MODEL", model.to_str().unwrap()))
}

/// The largest deviation at the end in units of the largest value of the state, from what `--track` writes.
fn accuracy_of(track: &Path) -> f64 {
    let text = std::fs::read_to_string(track).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    let of = |state: &str| {
        let place = names.iter().position(|name| *name == state).unwrap();
        let bound = names.iter().position(|name| *name == format!("{state}_bound")).unwrap();
        let size = rows.iter().fold(0.0f64, |size, row| size.max(row[place].abs()));
        rows.last().unwrap()[bound] / size
    };
    ["x", "y", "mu"].map(of).into_iter().fold(0.0, f64::max)
}

/// The coarser the accuracy, the earlier in the order of costs is what suffices; what is chosen answers, and is as accurate as it says.
#[test]
fn an_accuracy_takes_the_first_that_suffices() {
    let folder = folder();
    let scene = scene(&folder, SCENE);
    let mut places = Vec::new();
    for asked in ["1e-1", "1e-3", "4e-4"] {
        let track = folder.path().join(format!("{asked}.csv"));
        let (output, found) = observe(&scene, &["--accuracy", asked, "--track", track.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(0), "{found}");
        let choice = &found["choice"];
        let place = choice["chosen"].as_u64().unwrap() as usize;
        let tried = choice["tried"].as_array().unwrap();
        let own = tried[place]["accuracy"].as_f64().unwrap();
        assert!(choice["suffices"] == true && own <= asked.parse().unwrap(), "{choice}");
        // nothing before it suffices, and one more was tried
        let accuracy = |one: &Value| one["accuracy"].as_f64().unwrap_or(f64::INFINITY);
        assert!(tried[..place].iter().all(|one| accuracy(one) > asked.parse().unwrap()), "{choice}");
        assert!(tried.len() <= place + 2, "{choice}");
        assert_eq!(found["observers"].as_array().unwrap().len(), 1);
        assert_eq!(found["observers"][0]["method"], tried[place]["method"]);
        let by_track = accuracy_of(&track);
        assert!((by_track / own - 1.0).abs() < 1e-3, "{by_track} {own}");
        places.push(place);
    }
    assert!(places.is_sorted() && places[0] < places[2], "{places:?}");
}

/// What cannot be had is said, with what it would take; the nearest answers.
#[test]
fn an_accuracy_that_no_observer_reaches() {
    let folder = folder();
    let scene = scene(&folder, SCENE);
    let (output, found) = observe(&scene, &["--accuracy", "1e-6"]);
    assert_eq!(output.status.code(), Some(1));
    let choice = &found["choice"];
    assert_eq!(choice["suffices"], false);
    let tried = choice["tried"].as_array().unwrap();
    let accuracies: Vec<f64> = tried.iter().filter_map(|one| one["accuracy"].as_f64()).collect();
    let best = accuracies.iter().copied().fold(f64::INFINITY, f64::min);
    assert_eq!(tried[choice["chosen"].as_u64().unwrap() as usize]["accuracy"], best);
    // all of them were tried: all samples, and windows of which each is half as long as the one before
    let windows: Vec<u64> = tried.iter().filter_map(|one| one["window"].as_u64()).collect();
    assert!(windows.windows(2).all(|pair| pair[0] == 2 * pair[1]) && windows.len() > 3, "{windows:?}");
    let words = palmistry(&["observe", scene.to_str().unwrap(), "--accuracy", "1e-6"]);
    let words = String::from_utf8_lossy(&words.stdout).replace('\n', " ");
    assert!(words.contains("none of them suffices") && words.contains("times as many"), "{words}");
}

/// Any observer is quick enough for an hour, and then the most accurate is taken; none for a nanosecond.
#[test]
fn a_time() {
    let folder = folder();
    let scene = scene(&folder, SCENE);
    let (output, found) = observe(&scene, &["--within", "3600 s"]);
    assert_eq!(output.status.code(), Some(0), "{found}");
    let choice = &found["choice"];
    let tried = choice["tried"].as_array().unwrap();
    let accuracy = |one: &Value| one["accuracy"].as_f64().unwrap_or(f64::INFINITY);
    let best = tried.iter().map(accuracy).fold(f64::INFINITY, f64::min);
    assert_eq!(accuracy(&tried[choice["chosen"].as_u64().unwrap() as usize]), best);
    assert_eq!(choice["better"], Value::Null);
    let (output, found) = observe(&scene, &["--within", "0.000001ms"]);
    assert_eq!(
        (output.status.code(), &found["choice"]["suffices"]),
        (Some(1), &Value::Bool(false)),
        "{found}"
    );
    assert_eq!(found["choice"]["tried"].as_array().unwrap().len(), 2);
}

/// An accuracy chooses the same on any number of threads, to the last byte where no times are asked for.
#[test]
fn an_accuracy_chooses_the_same_on_any_number_of_threads() {
    let folder = folder();
    let scene = scene(&folder, SCENE);
    let run = |threads: &str| {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_palmistry"))
            .args(["observe", scene.to_str().unwrap(), "--accuracy", "2e-3", "--no-times", "--json"])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(0));
        output.stdout
    };
    assert!(run("1") == run("2"));
}

/// Where there is nothing to choose, or two things are asked for at once, it is said.
#[test]
fn what_cannot_be_chosen_is_refused() {
    let folder = folder();
    let own = scene(&folder, SCENE);
    for (scene, options, needle) in [
        (own.to_str().unwrap(), &["--accuracy", "0"][..], "above 0 and below 1"),
        (own.to_str().unwrap(), &["--within", "soon"], "a time with its unit"),
        (own.to_str().unwrap(), &["--within", "1s", "--accuracy", "1e-3"], "cannot be used with"),
        (own.to_str().unwrap(), &["--accuracy", "1e-3", "--data", "-"], "needs all measurements"),
        ("proofs/moll2002/scenes/figure_5_3.toml", &["--accuracy", "1e-3"], "in one way"),
        ("proofs/moll2002/scenes/slow_jump.toml", &["--within", "1s"], "in one way"),
        ("proofs/moll2002/scenes/friction.toml", &["--accuracy", "1e-3"], "modes are reported"),
    ] {
        let mut all = vec!["observe", scene];
        all.extend(options);
        let output = palmistry(&all);
        let words = String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(output.status.code() == Some(2) && words.contains(needle), "{options:?}: {words}");
    }
}
