//! Scenes of several experiments: mistakes are reported at their place, and valid scenes agree with a closed form.

use super::*;
use palmistry_fit::Exactness;
use std::path::Path;

const MODEL: &str = "system \"growth\"\nstate x, y\nparam k unknown\nparam r = 2\nparam s\ndrift f\n  x' = -k*x\n  y' = r*k*x\nlet both = x + s*y\noutput both\n";

const SCENE: &str = r#"title = "Growth in two vessels"
model = "m.proof"
measurements = "m.csv"

[initial]
x = "2*a"
y = "x/4"

[errors]
both = { size = "e*q", on = "log10" }

[parameters]
k = { bounds = [1e-3, 1e2], nominal = 0.5 }
a = { bounds = [-5, 5], nominal = 1.5 }
e = { bounds = [1e-3, 1], nominal = 0.1, prior = { law = "log-normal", centre = -2.0, spread = 0.5 } }

[known]
s = 3

[experiments.one]
[experiments.two]
set = { k = "2*k", x = 4, s = "r/2" }

[search]
starts = 0
"#;

const ROWS: &str =
    "experiment,output,time,value,set\none,both,0,3,q = 1\none,both,2,4,q = 2\ntwo,both,1,5,q = 1\n";

/// The problem of a scene beside its model and measurements.
fn experiments(scene: &str, model: &str, rows: &str) -> Result<JointExperiments, palmistry_lang::ReadError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("s.toml", scene), ("m.proof", model), ("m.csv", rows)] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let scene = JointScene::read(&folder.path().join("s.toml")).expect("several experiments")?;
    JointExperiments::new(scene, None)
}

#[test]
fn settings_starts_and_errors_are_put_in() {
    let own = experiments(SCENE, MODEL, ROWS).unwrap();
    let (k, a, e) = (0.5f64, 1.5f64, 0.1f64);
    let place = own.problem().nominal().unwrap();
    let names: Vec<&str> = own.problem().parameters.iter().map(|one| one.name.as_str()).collect();
    assert_eq!(names, ["a", "e", "k"]);
    assert!((place[0] - a).abs() < 1e-12 && (place[1] + 1.0).abs() < 1e-12);
    let found = own.likelihood.at(&place, Exactness::Answer, &|| false).unwrap();
    let at = |k: f64, x: f64, s: f64, t: f64| {
        let x_there = x * (-k * t).exp();
        x_there + s * (x / 4.0 + 2.0 * (x - x_there))
    };
    let expected = [at(k, 2.0 * a, 3.0, 0.0), at(k, 2.0 * a, 3.0, 2.0), at(2.0 * k, 4.0, 1.0, 1.0)];
    let sizes = [e, 2.0 * e, e];
    let mut objective = 0.0;
    for (((own, known), size), value) in
        found.expected.iter().zip(expected).zip(sizes).zip([3.0f64, 4.0, 5.0])
    {
        assert!((own - known).abs() < 1e-8, "{own} {known}");
        let residual = (known.log10() - value.log10()) / size;
        objective += 0.5 * residual * residual
            + 0.5 * (std::f64::consts::TAU * (size * value * std::f64::consts::LN_10).powi(2)).ln();
    }
    assert!((found.log_likelihood + objective).abs() < 1e-8);
    let prior = 0.5 * ((e.ln() + 2.0) / 0.5).powi(2) + (e * 0.5 * std::f64::consts::TAU.sqrt()).ln();
    assert!((found.objective - objective - prior).abs() < 1e-8);
}

#[test]
fn mistakes_are_named_where_they_are() {
    for (from, to, message) in [
        ("[known]\ns = 3", "", "nothing says what 's' is"),
        ("s = 3", "s = inf", "inf is no finite number"),
        ("s = 3", "k = 3", "'k' is estimated, and cannot be known"),
        ("s = 3", "both = 3", "'both' is defined by the model, and no parameter"),
        ("y = \"x/4\"", "", "nothing says what 'y' is at the start"),
        ("x = \"2*a\"", "x = \"y\"", "the start of 'x' depends on itself"),
        ("x = \"2*a\"", "x = \"2*b\"", "unknown name 'b'"),
        ("x = \"2*a\"", "x = \"2*a\"\nz = 1", "'z' is no state of the model"),
        ("[1e-3, 1e2]", "[1e2, 1e-3]", "[100, 0.001] is no range"),
        (
            "[-5, 5], nominal = 1.5",
            "[-5, 5], scale = \"log\"",
            "-5 has no logarithm, and 'a' is estimated by it",
        ),
        ("nominal = 0.5", "nominal = -0.5", "-0.5 is no value on this scale"),
        ("nominal = 0.5", "starts = [1e-4, 1]", "[0.0001, 1] is no range within the bounds"),
        ("spread = 0.5", "spread = 0", "a prior about -2 with the spread 0 is none"),
        ("spread = 0.5", "spread = 0.5, on = \"scale\"", "the prior is one of a logarithm"),
        ("k = \"2*k\"", "q2 = 1", "the model knows no 'q2'"),
        ("k = \"2*k\"", "r = \"1/(1-1)\"", "divide"),
        ("both = {", "x = {", "the scene says nothing of the errors of 'both'"),
        ("[experiments.two]", "[experiments.too]", "the scene has no experiment 'two'"),
        ("starts = 0", "starts = 1000000", "at most 100000 starts"),
        ("starts = 0", "starts = 2\nsteps = 0", "a search without steps finds nothing"),
        ("1e2], nominal = 0.5", "1e2]", "only nominal values are simulated, and 'k' has none"),
        ("x = 4, s = \"r/2\" }", "x = \"y/2\" }\nbefore = {}", "goes on from what was before"),
        ("title", "titel", "unknown key 'titel'"),
        ("m.csv", "n.csv", "there is no file"),
        ("law = \"log-normal\"", "law = \"cauchy\"", "'cauchy' is not known"),
        ("s = 3", "s = 3\nqq = 1", "'qq' is no parameter of the model, and stands in no formula"),
        (
            "k = { b",
            "kk = { b",
            "'kk' is no parameter of the model, and stands in no formula perhaps you meant 'k'",
        ),
        ("both = {", "bot = {", "'bot' is no output of the model perhaps you meant 'both'"),
        ("both = {", "z = { size = 1 }\nboth = {", "'z' is no output of the model there are both"),
        ("\"e*q\"", "-1", "the size of errors has to be positive, and is -1"),
        (
            "[experiments.two]",
            "[experiments.three]\n[experiments.two]",
            "nothing was measured in the experiment 'three'",
        ),
    ] {
        assert!(SCENE.contains(from), "{from}");
        let why =
            experiments(&SCENE.replacen(from, to, 1), MODEL, ROWS).err().unwrap_or_else(|| panic!("{to}"));
        let told = format!("{} {}", why.message, why.help.clone().unwrap_or_default());
        assert!(told.contains(message), "{message}: {told}");
    }
    for (from, to, message) in [
        ("q = 2", "q", "'q' sets nothing"),
        ("q = 2", "x = 2", "'x' is a state that moves"),
        ("q = 2", "q = (", "expected"),
        ("4,q", "-4,q", "-4 has no logarithm, and 'both' is compared by it"),
        ("one,both,2", "one,bot,2", "the scene says nothing of the errors of 'bot'"),
        ("one,both,2,4", "one,both,2,0,4", "the row has 6 cells, and the header 5"),
        ("q = 2", "", "nothing says what 'q' is"),
        ("q = 2", "q = 2; k = 3", "'k' is a part of the motion"),
        ("q = 2", "q = 2; r = 3", "'r' is a part of the motion"),
        ("q = 2", "q = 2; a = 3", "'a' is a part of the motion"),
        ("q = 2", "q = 2; zzz = 3", "'zzz' is set, and neither 'both' nor its error has it"),
    ] {
        let why =
            experiments(SCENE, MODEL, &ROWS.replacen(from, to, 1)).err().unwrap_or_else(|| panic!("{to}"));
        assert!(why.message.contains(message), "{message}: {}", why.message);
    }
    let still = MODEL.replace("drift f\n  x' = -k*x\n  y' = r*k*x\n", "field f\n  x' = -k*x\n  y' = r*k*x\n");
    assert!(experiments(SCENE, &still, ROWS).err().unwrap().message.contains("no drift"));
}

/// Of two factors only the product is identifiable: the chi-square test counts identifiable directions, and each factor is non-identifiable.
#[test]
fn what_is_not_identifiable_explains_nothing() {
    let scene = SCENE
        .replace("[experiments.two]\nset = { k = \"2*k\", x = 4, s = \"r/2\" }\n", "")
        .replace("x = \"2*a\"", "x = \"a*b\"")
        .replace("{ size = \"e*q\", on = \"log10\" }", "{ size = 0.1 }")
        .replace(
            "a = { bounds = [-5, 5], nominal = 1.5 }\n",
            "a = { bounds = [0.1, 10] }\nb = { bounds = [0.1, 10] }\n",
        )
        .replace("starts = 0", "starts = 4");
    let scene: String =
        scene.lines().filter(|line| !line.starts_with("e = ")).map(|line| format!("{line}\n")).collect();
    let rows = "experiment,output,time,value\none,both,0,3\none,both,1,6\none,both,2,9\none,both,4,13\none,both,8,16\n";
    let own = experiments(&scene, MODEL, rows).unwrap();
    let answer = own.run(None, &|| false, &|| ());
    let fit = answer.fit.unwrap().unwrap();
    assert_eq!(fit.best().end, palmistry_fit::StartEnd::Converged);
    // k, and the product
    assert_eq!(answer.goodness.unwrap().degrees, 3);
    let deviations = answer.information.unwrap().deviations;
    assert!(deviations[0].unwrap().is_infinite() && deviations[1].unwrap().is_infinite());
    assert!(deviations[2].unwrap() < 1.0);
}

/// Other scenes are left to others.
#[test]
fn other_scenes_are_none_of_these() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../proofs/moll2002/scenes/general.toml");
    assert!(scene.is_file() && JointScene::read(&scene).is_none());
}
