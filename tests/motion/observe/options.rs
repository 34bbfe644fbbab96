//! What the command's options do.

use crate::common::{folder, json, palmistry, without_times, write};
use crate::observe::{observe, text, with};
use serde_json::Value;

/// The file that is written is what is printed, but for the time that it took.
#[test]
fn a_folder_gets_a_page_and_the_json_that_is_printed() {
    let folder = folder();
    let scene = write(&folder, "scene.toml", text("same_rate"));
    let out = folder.path().join("deep/down/out");
    let (output, mut printed) = observe(&scene, &["--out", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{printed}");
    let mut written: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("observe.json")).unwrap()).unwrap();
    assert_eq!(written, printed);
    without_times(&mut written);
    without_times(&mut printed);
    assert!(written["observers"][0].get("seconds").is_none());
    assert!(std::fs::read_to_string(out.join("index.html")).unwrap().starts_with("<!DOCTYPE html>"));
    // words instead of JSON say the same: every state that is sought, each method, how each window ended
    let words = palmistry(&["observe", scene.to_str().unwrap()]);
    let words = String::from_utf8_lossy(&words.stdout).into_owned();
    for observer in printed["observers"].as_array().unwrap() {
        assert!(words.contains(&format!("\n{}: ", observer["method"].as_str().unwrap())), "{words}");
    }
    assert!(words.contains("converged after 8 steps") && words.contains("omega0"), "{words}");
}

#[test]
fn a_seed_gives_its_errors_and_no_others() {
    let folder = folder();
    let noisy = with(&text("same_rate"), "[observer]\n", "[sensor]\nnoise = 1e-5\n[observer]\n");
    let noisy = with(&noisy, ", \"trust-region\", \"integration\", \"kalman\", \"high-gain\"", "");
    let scene = write(&folder, "scene.toml", noisy);
    let run = |seed: &[&str]| {
        let (output, mut found) = observe(&scene, seed);
        assert_eq!(output.status.code(), Some(0), "{found}");
        without_times(&mut found);
        found
    };
    let (own, one, two) = (run(&[]), run(&["--seed", "1"]), run(&["--seed", "2"]));
    assert_eq!(own, one, "a scene that names no seed has the seed 1");
    assert_eq!((&one["seed"], &two["seed"]), (&1.into(), &2.into()));
    let r1 = |found: &Value| found["observers"][0]["updates"][0]["states"]["r1"].clone();
    assert_ne!(r1(&one)["recovered"], r1(&two)["recovered"]);
    // both are as near as the bound lets one hope: farther than five of it is one in a million
    for found in [one, two] {
        let (error, truth, bound) = (&r1(&found)["error"], &r1(&found)["true"], &r1(&found)["bound"]);
        let off = error.as_f64().unwrap() * truth.as_f64().unwrap() / bound.as_f64().unwrap();
        assert!(off > 1e-3 && off < 5.0, "{off}");
    }
}

#[test]
fn studies_run_where_there_is_a_truth_and_are_refused_where_not() {
    let folder = folder();
    let study = "\n[study.noise]\nlevels = [1e-5]\nseeds = 3\n[study.basin]\nr1 = [1.0, 1.6]\nr2 = [1.0, 1.6]\npoints = 3\n";
    let guess = with(&text("same_rate"), "guess_off = 0.1", "guess = { r1 = 1.3, r2 = 1.3, omega0 = -0.9 }");
    let scene = write(&folder, "scene.toml", format!("{guess}{study}"));
    let data = folder.path().join("x.csv");
    let (output, found) = observe(&scene, &["--studies", "--record", data.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{found}");
    let level = &found["noise"][0];
    assert_eq!((&level["seeds"], &level["converged"], &level["noise"]), (&3.into(), &3.into(), &1e-5.into()));
    let basins = found["basins"].as_array().unwrap();
    assert_eq!(basins.len(), 5, "one a method");
    for basin in basins {
        let arrives = basin["arrives"].as_array().unwrap();
        assert_eq!(arrives.len(), 9);
        let part = arrives.iter().filter(|arrives| **arrives == Value::Bool(true)).count() as f64 / 9.0;
        assert_eq!(basin["fraction"].as_f64(), Some(part));
        let expected = match basin["method"].as_str().unwrap() {
            "newton" | "trust-region" => part > 0.5,
            // with no measurement to correct it, only a guess that is right stays right
            "integration" => part == 0.0,
            _ => true,
        };
        assert!(expected, "{basin}");
    }
    // without being asked for, they do not run
    let (_, found) = observe(&scene, &[]);
    assert!(found.get("noise").is_none() && found.get("basins").is_none());
    let output = palmistry(&[
        "observe",
        scene.to_str().unwrap(),
        "--studies",
        "--json",
        "--data",
        data.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(2));
    assert!(json(&output)["error"]["message"].as_str().unwrap().contains("a study needs the true states"));
}
