//! The least model of a system and of a scene, as a user asks for it.

use crate::common::{folder, json, palmistry, write};
use std::path::Path;

const GENERAL: &str = "proofs/moll2002/general.proof";

/// Both palms at rest: the file that comes out is the one that was written by hand for section 4.4, and proves by itself.
#[test]
fn the_thesis_s_resting_palms_come_out_of_the_general_case() {
    let folder = folder();
    let out = folder.path().join("fixed.proof");
    let out = out.to_str().unwrap();
    let conditions = "omega1 = 0, omega2 = 0, alpha1 = 0, alpha2 = 0";
    let output =
        palmistry(&["reduce", GENERAL, "--fix", conditions, "--known", "rho=0.5", "--out", out, "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found = json(&output);
    assert_eq!(found["unknowns"], serde_json::json!({ "before": 10, "after": 5 }));
    assert_eq!(found["rank"], serde_json::json!({ "at_least": 5, "at_most": 5, "of": 5 }));
    assert_eq!(found["written"], out);
    assert!(found["proof"].as_str().unwrap().contains("param rho : length = 1/2"));
    let why: Vec<(&str, &str)> = found["left_out"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| (one["name"].as_str().unwrap(), one["why"].as_str().unwrap()))
        .collect();
    let expected = [
        ("phi1", "measured_constant"),
        ("omega1", "fixed"),
        ("phi2", "measured_constant"),
        ("omega2", "fixed"),
        ("rho", "known_constant"),
    ];
    assert_eq!(why, expected);
    assert!(found["claims"].as_array().unwrap().iter().all(|claim| claim["verdict"] == "proved"));
    assert!(palmistry(&["prove", out, "-q"]).status.success());
    // by its author's own file, which was written by hand: the same rates at the same states
    let both = "system \"both\" use a = \"FIXED\" use b = \"HAND\" \
                state r1, r2, omega0, s1, s2 param phi1, phi2, g, m, rho angle phi1, phi2 drift f r1' = 0 others' = 0 \
                claim f: L(a.f, [r1, r2, omega0, s1, s2]) = L(b.f, [r1, r2, omega0, s1, s2]) \
                claim g1: L(a.g1, [r1, r2, omega0, s1, s2]) = L(b.g1, [r1, r2, omega0, s1, s2]) \
                claim g2: L(a.g2, [r1, r2, omega0, s1, s2]) = L(b.g2, [r1, r2, omega0, s1, s2])";
    let by_hand = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002/fixed_palms.proof");
    let both = both.replace("FIXED", out).replace("HAND", by_hand.to_str().unwrap());
    let file = write(&folder, "both.proof", &both);
    let proved = palmistry(&["prove", file.to_str().unwrap(), "--json"]);
    assert!(proved.status.success(), "{}", String::from_utf8_lossy(&proved.stdout));
}

/// Without a file to write to the proof file is printed, and what was done is told beside it.
#[test]
fn a_least_model_is_printed_and_mistakes_are_named() {
    let output = palmistry(&["reduce", "proofs/benchmarks/seir_quarantine.proof"]);
    assert!(output.status.success());
    let (text, told) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(
        text.starts_with("# The least model") && text.contains("\nstate ") && text.contains("\nclaim "),
        "{text}"
    );
    assert!(
        told.contains("R: no output depends on it") && told.contains("claims that it is the larger system"),
        "{told}"
    );
    for (options, words) in [
        (&["--fix", "omega2 = 0"][..], "is not shown to stay met"),
        (&["--fix", "sin(phi2) = 0"], "2 ways"),
        (&["--fix", "omega1 > 0"], "inequality"),
        (&["--fix", "omega1 ="], "column"),
        (&["--known", "rhoo"], "no state"),
        (&["--known", "rho=x"], "number"),
        (&["--undriven", "g3"], "no input"),
        (&["--drive", "g1"], "missing"),
        (&["--drive", "g1=s1"], "no parameter"),
    ] {
        let output = palmistry(&[&["reduce", GENERAL][..], options].concat());
        let error = String::from_utf8_lossy(&output.stderr).replace("\n  │ ", " ");
        assert_eq!(output.status.code(), Some(2), "{options:?}: {error}");
        assert!(error.contains(words) && output.stdout.is_empty(), "{options:?}: {error}");
    }
}

/// A scene's plan: what never changes is constant, its least model is proved with the torques in it, and the rank is told before anything is estimated.
#[test]
fn plans_of_scenes() {
    let folder = folder();
    let out = folder.path().join("least.proof");
    let out = out.to_str().unwrap();
    let scene = "proofs/moll2002/scenes/fixed_palms.toml";
    let output = palmistry(&["plan", scene, "--no-times", "--out", out, "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found = json(&output);
    let constants: Vec<&str> =
        found["constants"].as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    for name in ["phi1", "phi2", "omega1", "omega2", "alpha1", "alpha2"] {
        assert!(constants.contains(&name), "{constants:?}");
    }
    assert_eq!(found["driving"], serde_json::json!(["tau1", "tau2"]));
    assert_eq!(found["rank"]["at_least"], 6);
    assert_eq!(
        (&found["rank_along_motion"]["rank"], &found["rank_along_motion"]["of"]),
        (&6.into(), &6.into())
    );
    let operations = |which: &str| found["operations"][which].as_u64().unwrap();
    assert!(operations("with_constants") < operations("with_all_columns"));
    let text = std::fs::read_to_string(out).unwrap();
    assert!(text.contains("+ tau1*L(larger.g1, ") && text.contains("known tau1(t) : "), "{text}");
    assert!(palmistry(&["prove", out, "-q"]).status.success());
    // rho is not to be told of resting palms whose torques are not in the model
    let blind = std::fs::read_to_string(scene).unwrap();
    let blind = blind
        .replace("inputs = { g1 = \"tau1\", g2 = \"tau2\" }", "")
        .replace("../general.proof", Path::new(env!("CARGO_MANIFEST_DIR")).join(GENERAL).to_str().unwrap());
    let file = write(&folder, "blind.toml", &blind);
    let output = palmistry(&["plan", file.to_str().unwrap(), "--no-times", "--json"]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    let found = json(&output);
    let unobservable: Vec<&str> =
        found["rank"]["unobservable"].as_array().unwrap().iter().map(|one| one.as_str().unwrap()).collect();
    assert!(unobservable.contains(&"rho"), "{unobservable:?}");
    // kinds of scenes that have no such model
    for scene in [
        "proofs/moll2002/scenes/slow_jump.toml",
        "proofs/moll2002/scenes/figure_5_3.toml",
        "examples/experiments/vessels.toml",
    ] {
        let output = palmistry(&["plan", scene]);
        assert_eq!(output.status.code(), Some(2), "{scene}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("least model"), "{scene}");
    }
}

/// What reads one value because it is rounded is no constant, neither all along nor for a while.
#[test]
fn a_rounded_reading_is_no_constant() {
    let folder = folder();
    write(
        &folder,
        "s.proof",
        "system \"s\" state x, k drift f x' = -k*x k' = 0 output x, k sample x in [0, 2] k in [0, 2]",
    );
    let rows: String = (0..40)
        .map(|row| format!("{},{},1\n", f64::from(row) * 0.1, (-0.1 * f64::from(row)).exp()))
        .collect();
    write(&folder, "d.csv", format!("time,x,k\n{rows}"));
    let plan = |sensor: &str| {
        let text = format!(
            "title = \"s\"\nmodel = \"s.proof\"\n[data]\nrecord = \"d.csv\"\n[observer]\nestimate = [\"x\"]\nwindow = 39\n{sensor}"
        );
        let scene = write(&folder, "s.toml", &text);
        let output = palmistry(&["plan", scene.to_str().unwrap(), "--json", "--no-times"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        json(&output)["constants"].as_array().unwrap().len()
    };
    assert_eq!(plan(""), 1, "k, which is read without error and does not move");
    assert_eq!(plan("[sensor]\nresolution = 0.5\n"), 0);
    assert_eq!(plan("[sensor.k]\nnoise = 0.1\n[sensor.x]\nnoise = 0.1\n"), 0);
}

/// Palms that stop half way: the part at rest is told.
#[test]
fn a_part_that_rests_is_told() {
    let folder = folder();
    write(
        &folder,
        "s.proof",
        "system \"s\" state x param k unknown known u(t) drift f x' = u - k*x output x sample x in [0, 2] k in [0, 2] u in [-1, 1]",
    );
    let mut rows = "time,x,u\n".to_owned();
    let (mut x, step) = (1.0f64, 0.05);
    for row in 0..40 {
        let u = if row < 20 { (f64::from(row) * step).sin() } else { 0.5 };
        rows += &format!("{},{x},{u}\n", f64::from(row) * step);
        x += step * (u - 0.7 * x);
    }
    write(&folder, "d.csv", &rows);
    let scene = write(
        &folder,
        "s.toml",
        "title = \"s\"\nmodel = \"s.proof\"\n[data]\nrecord = \"d.csv\"\n[observer]\nestimate = [\"x\", \"k\"]\nwindow = 39\n[sensor]\nnoise = 0.1\n",
    );
    let output = palmistry(&["plan", scene.to_str().unwrap(), "--json", "--no-times"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found = json(&output);
    let steady = &found["steady_for_a_while"];
    assert_eq!((&steady[0]["name"], &steady[0]["value"]), (&"u".into(), &0.5.into()), "{steady}");
    assert_eq!(found["rank_along_motion"]["from"], "guess");
}

/// Small terms: of a file over its ranges and of a scene over those of its measurements, each with its bound, proved; what is no part of anything is refused.
#[test]
fn small_terms_go_with_a_bound() {
    let scene = "proofs/moll2002/scenes/fixed_palms.toml";
    let output = palmistry(&["plan", scene, "--tolerance", "0.3", "--no-times", "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found = json(&output);
    let least = &found["least_model"];
    let small = least["small_terms"].as_array().unwrap();
    assert!(!small.is_empty());
    for one in small {
        let (most, median) = (one["at_most"].as_str().unwrap(), one["median_of_rate"].as_f64().unwrap());
        assert!(most.parse::<f64>().unwrap() <= 0.3 * median, "{one}");
    }
    assert!(least["claims"].as_array().unwrap().iter().all(|claim| claim["verdict"] == "proved"), "{least}");
    let plain = json(&palmistry(&["plan", scene, "--no-times", "--json"]));
    assert_eq!(plain["least_model"]["small_terms"], serde_json::json!([]));
    for wrong in ["0", "1", "nan", "much"] {
        let output = palmistry(&["reduce", GENERAL, "--tolerance", wrong]);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && told.contains("above 0 and below 1"), "{wrong}: {told}");
    }
}
