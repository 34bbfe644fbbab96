//! `rank`: directions that are not seen, as vectors at a state; and how well everything else is seen.

use crate::common::{folder, json, write};
use crate::process::{finish, program};
use dashu::rational::RBig;
use palmistry::number::parse_decimal;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

fn rank(text: &str) -> (Value, String) {
    let folder = folder();
    let file = write(&folder, "a.proof", text);
    let run = |more: &[&str]| {
        let output =
            finish(&mut program(&[&["rank", file.to_str().unwrap(), "--samples", "300"], more].concat()));
        assert_eq!(output.status.code(), Some(0), "{}", crate::process::words(&output));
        output
    };
    (json(&run(&["--json"])), String::from_utf8(run(&["--details"]).stdout).unwrap())
}

fn row<'a>(found: &'a Value, state: &str) -> &'a Value {
    let rows = found["standard_deviations"]["of"].as_array().unwrap_or_else(|| panic!("{found}"));
    rows.iter().find(|row| row["state"] == state).unwrap_or_else(|| panic!("{state} in {found}"))
}

/// The scaled matrix has condition one; `k` is a combination of the words with factors of 1e9, by hand:
/// `k = (x + Lf x)/1e-9`, each word known up to about a spread of x.
#[test]
fn a_parameter_that_is_nearly_invisible_is_told() {
    let (found, text) = rank(
        "system \"s\" state x, k drift f x' = -x + 1e-9*k others' = 0 output x sample x in [0, 1] k in [0, 1]",
    );
    assert!(found["worst_conditioned"]["condition"].as_f64().unwrap() < 1.001, "{found}");
    let k = row(&found, "k");
    assert!((k["median"].as_f64().unwrap() / (2.0f64.sqrt() * 1e9) - 1.0).abs() < 0.1, "{k}");
    assert_eq!(k["nearly_invisible"], true);
    assert!((row(&found, "x")["median"].as_f64().unwrap() - 1.0).abs() < 0.1);
    assert!(
        text.lines().any(|line| line.trim_start().starts_with("k ") && line.ends_with("nearly unobservable")),
        "{text}"
    );
    // the same in an output: p = (y + Lf y)/1e-6
    let (found, _) = rank(
        "system \"s\" state x, p drift f x' = -x others' = 0 output x + 1e-6*p sample x in [0, 3] p in [10, 14]",
    );
    // spreads are as 3 to 4, and errors of x and y, each about 3/sqrt(12), add up
    let expected = 2.0f64.sqrt() * 3.0 / 4.0 / 1e-6;
    assert!((row(&found, "p")["median"].as_f64().unwrap() / expected - 1.0).abs() < 0.1, "{found}");
    // what is not seen at all is no number
    let (found, text) =
        rank("system \"s\" state x, p drift f x' = -x others' = 0 output x sample x in [0, 1] p in [0, 1]");
    assert_eq!(
        (&row(&found, "p")["median"], &row(&found, "p")["unobservable_at"]),
        (&Value::Null, &200.into())
    );
    assert!(text.contains("unobservable"), "{text}");
}

/// Monte Carlo: noise of the units that are told is put on the words, and the states are solved for.
#[test]
fn standard_deviations_are_those_of_simulated_noise() {
    let (found, _) = rank(
        "system \"s\" state a, b input g a' = 1 others' = 0 output 3*a + b, a - 2*b sample a in [-1, 4] b in [2, 2.5]",
    );
    let units = &found["standard_deviations"]["units_of_noise"];
    let unit = |word: &str| units[word].as_f64().unwrap_or_else(|| panic!("{units}"));
    let (first, second) = (unit("3*a + b"), unit("a - 2*b"));
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut normal = || (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
    let draws = 100_000;
    let (mut a, mut b) = (0.0, 0.0);
    for _ in 0..draws {
        let (e, f) = (first * normal(), second * normal());
        // the inverse of [3, 1; 1, -2]
        a += ((2.0 * e + f) / 7.0).powi(2);
        b += ((e - 3.0 * f) / 7.0).powi(2);
    }
    for (state, square, width) in [("a", a, 5.0), ("b", b, 0.5)] {
        let simulated = (square / f64::from(draws)).sqrt() / (width / 12.0f64.sqrt());
        let told = row(&found, state)["median"].as_f64().unwrap();
        assert!((told / simulated - 1.0).abs() < 0.02, "{state}: {told}, simulated {simulated}");
    }
}

/// At the state that is told, the differentials of the outputs vanish along the vector that is told, exactly.
#[test]
fn an_unseen_direction_is_a_vector_at_a_state() {
    let (found, text) = rank(
        "system \"s\" state x, y, z drift f x' = y y' = -x z' = 0 output x^2 + y^2 sample x in [1, 2] y in [1, 2] z in [0, 1]",
    );
    let exact = |value: &Value| -> RBig {
        parse_decimal(value["exact"].as_str().unwrap_or("0")).unwrap_or_else(|| panic!("{value}"))
    };
    let unseen = found["unobservable"].as_array().unwrap();
    let states: Vec<&Value> = unseen.iter().map(|direction| &direction["states"]).collect();
    assert_eq!(states, [&serde_json::json!(["x", "y"]), &serde_json::json!(["z"])]);
    for direction in unseen {
        let at = |name: &str| exact(&direction["at"][name]);
        assert!(
            ["x", "y", "z"].into_iter().all(|name| direction["at"][name]["exact"].is_string()),
            "{direction}"
        );
        let along = |name: &str| exact(&direction["vector"][name]);
        let rate = at("x") * along("x") + at("y") * along("y");
        assert_eq!(rate, RBig::ZERO, "{direction}");
        assert!(along("x") != RBig::ZERO || along("z") != RBig::ZERO);
    }
    assert!(text.contains("(x, y) += t (") && text.contains("z += t, that is d/dz"), "{text}");
}

/// One output less than states, the same everywhere: the vector is in small integers.
#[test]
fn a_vector_that_is_the_same_everywhere_is_told_in_small_integers() {
    let (_, text) = rank(
        "system \"s\" state r1, r2 drift f others' = 0 output 2*r1 + r2 sample r1 in [1, 2] r2 in [1, 2]",
    );
    assert!(text.contains("(r1, r2) += t (1, -2), that is d/dr1 - 2 d/dr2"), "{text}");
}

/// What is not zero is not shown as zero, however small it is.
#[test]
fn a_small_part_of_a_direction_is_told() {
    for (factor, part) in [("1e-20", "-1.00000e-20"), ("1e-400", "-1.00000e-400"), ("1e-3", "-0.001")] {
        let (_, text) = rank(&format!(
            "system \"s\" state x, y drift f others' = 0 output {factor}*x + y sample x in [1, 2] y in [1, 2]"
        ));
        let field = format!("(x, y) += t (1, {part}), that is d/dx - {} d/dy", &part[1..]);
        assert!(text.contains(&field), "{field}: {text}");
    }
}
