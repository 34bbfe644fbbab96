//! Runs of a body in space that widen what is certain of it.

use crate::common::{folder, json, palmistry, with_threads, write};
use serde_json::Value;

const SCENE: &str = "proofs/moll2002/scenes/figure_5_3.toml";

/// Figure 5.3's scene, shorter.
fn text() -> String {
    let text = std::fs::read_to_string(SCENE).unwrap();
    text.replacen("duration = 4.4", "duration = 2.2", 1).replacen("samples = 177", "samples = 89", 1)
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// What is printed goes into the scene. Oracle: the hull of the contacts that `observe` recovers from the measurements of that scene alone, in a frame of its own, has the volume that was told.
#[test]
fn a_run_that_is_advised_touches_what_was_told() {
    let folder = folder();
    let scene = write(&folder, "scene.toml", text());
    let search = ["advise", scene.to_str().unwrap(), "--runs", "2", "--trials", "6", "--seed", "3"];
    let output = palmistry(&[&search[..], &["--json"]].concat());
    let found = json(&output);
    assert_eq!(output.status.code(), Some(0), "{found}");
    let runs = found["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 2);
    let hulls: Vec<f64> = runs.iter().map(|run| run["hull"].as_f64().unwrap()).collect();
    assert!(0.0 < hulls[0] && hulls[0] < hulls[1] && hulls[1] < found["volume"].as_f64().unwrap(), "{found}");
    assert!((found["volume"].as_f64().unwrap() - 4.0 / 3.0 * std::f64::consts::PI * 5.0).abs() < 1e-6);
    for run in runs {
        assert!(run["outer"].is_null() || run["outer"].as_f64() > found["volume"].as_f64(), "{found}");
        let rate = numbers(&run["rate"]);
        assert!(rate.iter().map(|x| x * x).sum::<f64>().sqrt() <= 0.5, "{found}");
    }
    // the first run is the best of its own random trials at least
    assert!(hulls[0] >= runs[0]["random"]["median"].as_f64().unwrap());

    let printed = String::from_utf8(palmistry(&search).stdout).unwrap();
    let block = printed.split_once("how it lies\n").unwrap().1;
    let lines: Vec<&str> = block.lines().take(3).collect();
    let kept: String = text()
        .lines()
        .filter(|line| !["orientation", "balanced", "rate"].iter().any(|key| line.starts_with(key)))
        .map(|line| match line {
            "[body]" => format!("[body]\n{}\n", lines.join("\n")),
            line => format!("{line}\n"),
        })
        .collect();
    let pasted = write(&folder, "pasted.toml", kept);
    let observed = json(&palmistry(&["observe", pasted.to_str().unwrap(), "--json"]));
    let bounds = observed["shape"]["bounds"].as_array().unwrap();
    let hull = bounds.iter().find(|bound| bound["what"].as_str().unwrap().starts_with("hull")).unwrap();
    let recovered = hull["volume"].as_f64().unwrap();
    assert!((recovered - hulls[0]).abs() < 1e-6 * hulls[0], "{recovered} {found}");
}

/// The same seed gives the same answer with any number of threads, and another seed another one.
#[test]
fn runs_are_those_of_their_seed() {
    let folder = folder();
    let scene = write(&folder, "scene.toml", text().replacen("samples = 89", "samples = 24", 1));
    let run = |threads: &str, seed: &str| {
        let arguments =
            ["advise", scene.to_str().unwrap(), "--runs", "2", "--trials", "4", "--seed", seed, "--json"];
        String::from_utf8(with_threads(&arguments, Some(threads)).stdout).unwrap()
    };
    let one = run("1", "4");
    assert_eq!(one, run("3", "4"));
    assert_ne!(one, run("2", "5"));
}

/// A body that is laid and not set turning touches three points: a plane, which holds nothing; and that is not "no run was found".
#[test]
fn a_body_that_lies_still_holds_nothing() {
    let folder = folder();
    let scene = write(&folder, "scene.toml", text().replacen("samples = 89", "samples = 24", 1));
    let search = ["advise", scene.to_str().unwrap(), "--runs", "1", "--trials", "2", "--rate", "0"];
    let output = palmistry(&[&search[..], &["--json"]].concat());
    let found = json(&output);
    assert_eq!(output.status.code(), Some(0), "{found}");
    assert!(found["held"].as_u64().unwrap() > 0, "{found}");
    // rounding moves the points by a last bit, and may give them a volume of that size
    assert!(found["runs"][0]["hull"].as_f64().unwrap() < 1e-9, "{found}");
    assert!(found["runs"][0]["outer"].is_null() && found["runs"][0]["why"].is_string(), "{found}");
}

/// Options that are not for such a scene, and scenes that have no body.
#[test]
fn runs_that_are_none_are_refused() {
    let recorded = "title = \"Read\"\nmotion = \"spatial\"\n[palms]\nazimuth = [0, 2, 4]\n[data]\nrecord = \"none.csv\"\n";
    let folder = folder();
    let recorded = write(&folder, "recorded.toml", recorded);
    for (scene, arguments, word) in [
        (SCENE, &["--angle1", "0.3,0.9"][..], "--angle1 is not for bodies in space"),
        (SCENE, &["--rate", "nan"], "--rate: no body is set turning at NaN rad/s"),
        (recorded.to_str().unwrap(), &[], "the scene has no body"),
        ("proofs/moll2002/scenes/general.toml", &["--runs", "2"], "--runs is for bodies in space"),
    ] {
        let output = palmistry(&[&["advise", scene, "--json"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert_eq!(json(&output)["error"]["message"], word);
    }
}
