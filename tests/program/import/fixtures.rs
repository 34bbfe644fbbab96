//! The files of `tests/imports`: what they mean, by hand, and what is decided of them.

use super::round_trip::{Both, close, compare};
use super::{Draws, imported};
use crate::common::{folder, json, palmistry};
use palmistry::import::{ForeignUnknowns, ImportQuestion};

fn model(name: &str) -> ImportQuestion {
    ImportQuestion { model: Some(name.to_owned()), ..ImportQuestion::default() }
}

/// The fixtures, each with its question.
fn all() -> Vec<(&'static str, ImportQuestion)> {
    let plain = ImportQuestion::default;
    let held = ImportQuestion { unknowns: ForeignUnknowns::None, ..plain() };
    vec![
        ("cholera.jl", model("siwr")),
        ("cholera.jl", model("2")),
        ("covid.jl", plain()),
        ("mitosis.xml", plain()),
        ("mitosis.xml", held),
        ("uptake.xml", plain()),
        ("latent.py", plain()),
        ("vehicle.m", plain()),
        ("predator.txt", plain()),
        ("tank.txt", plain()),
    ]
}

#[test]
fn what_is_read_back_is_what_the_foreign_tree_says() {
    for (name, question) in all() {
        let imported = imported(name, &question);
        let each = imported.model.states.len() + imported.model.outputs.len();
        assert_eq!(compare(&imported, 20), 20 * each, "{name}");
    }
}

/// Values by name, of a state.
type At<'a> = &'a dyn Fn(&str) -> f64;

/// The rates of a fixture as they stand in its paper, and its outputs.
type ByHand = fn(At<'_>) -> (Vec<(&'static str, f64)>, Vec<f64>);

fn cholera(v: At<'_>) -> (Vec<(&'static str, f64)>, Vec<f64>) {
    let [s, i, w, r] = ["S", "I", "W", "R"].map(v);
    let [mu, bi, bw, alpha, gamma, xi] = ["μ", "β_I", "β_W", "α", "γ", "ξ"].map(v);
    let infected = bi * s * i + bw * s * w;
    let rates = vec![
        ("S", mu * (1.0 - s) - infected + alpha * r),
        ("I", infected - (gamma + mu) * i),
        ("W", xi * (i - w)),
        ("R", gamma * i - (mu + alpha) * r),
    ];
    (rates, vec![v("κ") * i])
}

fn counted(v: At<'_>) -> (Vec<(&'static str, f64)>, Vec<f64>) {
    let (mut rates, outputs) = cholera(v);
    let u = v("u");
    rates[1].1 += 0.5 * u.powi(2) / (0.25 + 2.0 * u.powi(2));
    (rates, vec![outputs[0], v("S") + v("I") + v("R")])
}

fn covid(v: At<'_>) -> (Vec<(&'static str, f64)>, Vec<f64>) {
    let [s, e, a, i, j] = ["S", "E", "A", "I", "J"].map(v);
    let [b, q, n, k, r, alpha, g1, g2] = ["b", "q", "N_inv", "k", "r", "α", "g₁", "g₂"].map(v);
    let infected = b * s * (i + j + q * a) * n;
    let rates = vec![
        ("S", -infected),
        ("E", infected - k * e),
        ("A", k * (1.0 - r) * e - g1 * a),
        ("I", k * r * e - (alpha + g1) * i),
        ("J", alpha * i - g2 * j),
        ("C", alpha * i),
    ];
    (rates, vec![v("C"), n])
}

/// Goldbeter 1991, equations 1 and 2, in a cell of any size.
fn mitosis(v: At<'_>) -> (Vec<(&'static str, f64)>, Vec<f64>) {
    let [c, m, x] = ["C", "M", "X"].map(v);
    let v1 = v("VM1") * c / (v("Kc") + c);
    let v3 = v("VM3") * m;
    let [k1, k2, k3, k4] = [
        "K_activation_of_cdc2",
        "K_deactivation_of_cdc2",
        "K_activation_of_protease",
        "K_deactivation_of_protease",
    ]
    .map(v);
    let rates = vec![
        ("C", v("vi") - v("vd") * x * c / (v("Kd") + c) - v("kd") * c),
        ("M", v1 * (1.0 - m) / (k1 + 1.0 - m) - v("V2") * m / (k2 + m)),
        ("X", v3 * (1.0 - x) / (k3 + 1.0 - x) - v("V4") * x / (k4 + x)),
    ];
    (rates, vec![c, m, x])
}

/// The amounts move by the laws; P is the amount in the cell by its size, which grows.
fn uptake(v: At<'_>) -> (Vec<(&'static str, f64)>, Vec<f64>) {
    let [s, p, q, cell, time] = ["S", "P", "Q", "cell", "time"].map(v);
    let [growth, n, medium] = ["growth", "n", "medium"].map(v);
    let half = 0.15 * (n + 1.0 / 3.0);
    let into = v("v_import_S") * v("E") * medium * s.powf(n) / (half.powf(n) + s.powf(n));
    let stored = cell * (v("v_storage") * p.max(0.0) - v("back") * (-time).exp() * q);
    let rates = vec![
        ("S", -into / medium),
        ("P", (2.0 * into - stored) / cell - p * growth),
        ("Q", stored),
        ("cell", growth * cell),
        ("time", 1.0),
    ];
    (rates, vec![p * cell + q + (1.0 + s).log10() * 2.0 * s, time])
}

fn latent(v: At<'_>) -> (Vec<(&'static str, f64)>, Vec<f64>) {
    let [x1, x2, x3, x4] = ["x1", "x2", "x3", "x4"].map(v);
    let infected = v("b") * x1 * x4;
    let rates = vec![
        ("x1", v("s") - v("d") * x1 - infected),
        ("x2", v("q1") * infected - (v("k1") + v("w1")) * x2),
        ("x3", v("q2") * infected + v("k1") * x2 - v("w2") * x3),
        ("x4", v("k2") * x3 - v("c") * x4),
    ];
    (rates, vec![x1, x4])
}

fn vehicle(v: At<'_>) -> (Vec<(&'static str, f64)>, Vec<f64>) {
    let [zs, vs, zt, vt] = ["zs", "vs", "zt", "vt"].map(v);
    let spring = v("ks") * zs + v("bs") * (vs - vt);
    let rates = vec![
        ("zs", vs - vt),
        ("vs", (v("F") - spring - vs.abs() * vs / 2.0) / v("ms")),
        ("zt", vt - v("road")),
        ("vt", (spring - v("kt") * zt - v("F")) / v("mu")),
    ];
    (rates, vec![zs, zt, vs / 2.0])
}

fn predator(v: At<'_>) -> (Vec<(&'static str, f64)>, Vec<f64>) {
    let [n, p] = ["N", "P"].map(v);
    let eaten = v("a") * n * p / (1.0 + v("a") * v("h") * n);
    (vec![("N", v("r") * n * (1.0 - n / v("K")) - eaten), ("P", v("e") * eaten - v("m") * p)], vec![n])
}

fn tank(v: At<'_>) -> (Vec<(&'static str, f64)>, Vec<f64>) {
    let out = v("a1") * (2.0 * v("g") * v("h1")).sqrt();
    let rates = vec![
        ("h1", (v("q") - out) / v("A")),
        ("h2", (out - v("a2") * (2.0 * v("g") * v("h2")).sqrt()) / v("A")),
    ];
    (rates, vec![v("h2")])
}

#[test]
fn what_is_read_is_what_the_papers_say() {
    let by_hand: [(&str, ImportQuestion, ByHand); 9] = [
        ("cholera.jl", model("1"), cholera),
        ("cholera.jl", model("counted"), counted),
        ("covid.jl", ImportQuestion::default(), covid),
        ("mitosis.xml", ImportQuestion::default(), mitosis),
        ("uptake.xml", ImportQuestion::default(), uptake),
        ("latent.py", ImportQuestion::default(), latent),
        ("vehicle.m", ImportQuestion::default(), vehicle),
        ("predator.txt", ImportQuestion::default(), predator),
        ("tank.txt", ImportQuestion::default(), tank),
    ];
    for (name, question, formulas) in by_hand {
        let imported = imported(name, &question);
        let mut both = Both::new(&imported);
        let mut draws = Draws(3);
        for _ in 0..10 {
            let state = both.state(&mut draws);
            let (rates, outputs) = formulas(&|foreign| {
                both.given(&state, foreign).unwrap_or_else(|| panic!("{name} has no {foreign}"))
            });
            assert_eq!(rates.len(), imported.model.states.len(), "{name}");
            for (state_name, by_hand) in rates {
                let ours = both.rate(&state, state_name).expect("a value");
                assert!(close(by_hand, ours), "{name}, {state_name}: {by_hand} by hand, {ours}");
            }
            assert_eq!(outputs.len(), both.system.outputs.len(), "{name}");
            for (at, by_hand) in outputs.into_iter().enumerate() {
                let ours = both.output(&state, at).expect("a value");
                assert!(close(by_hand, ours), "{name}, output {at}: {by_hand} by hand, {ours}");
            }
        }
    }
}

/// A fixture, options, its format, the rank, the number of unknowns, and those that are not seen.
type Decided<'a> = (&'a str, &'a [&'a str], &'a str, u64, u64, &'a [&'a str]);

/// Five formats imported and decided, by the program as its users run it. The ranks of the first three are the published ones
/// (`tests/models/expected.toml`: siwr, seaijrc, hiv_latent). The predator's numbers have one scale that its prey does not tell:
/// P, 1/a, 1/e and h go with it. Goldbeter's model has sixteen unknowns, all seen where all three states are.
#[test]
fn five_formats_are_imported_and_decided() {
    let folder = folder();
    let decided: [Decided<'_>; 6] = [
        ("cholera.jl", &["--model", "siwr"], "julia", 11, 11, &[]),
        ("covid.jl", &[], "julia", 13, 14, &["S", "E", "A", "q", "r"]),
        ("latent.py", &[], "strikepy", 12, 14, &["x2", "x3", "q1", "q2", "k1", "k2", "w1"]),
        ("mitosis.xml", &[], "sbml", 16, 16, &[]),
        ("vehicle.m", &[], "strike-goldd", 10, 10, &[]),
        ("predator.txt", &[], "formulas", 7, 8, &["P", "a", "e", "h"]),
    ];
    for (name, options, format, rank, dimension, not_seen) in decided {
        let out = folder.path().join(format!("{name}.proof"));
        let out = out.to_str().expect("a path");
        let file = format!("tests/imports/{name}");
        let run = palmistry(&[&["import", &file, "--out", out, "--json"], options].concat());
        let found = json(&run);
        assert_eq!((run.status.code(), &found["format"]), (Some(0), &format.into()), "{name}: {found}");
        assert_eq!(found["written"], out, "{name}");
        assert_eq!(found["proof"].as_str(), std::fs::read_to_string(out).ok().as_deref(), "{name}");
        let answer = json(&palmistry(&["rank", out, "--samples", "0", "--json"]));
        let answer = if answer["branches"].is_array() { &answer["branches"][0] } else { &answer };
        let shown = serde_json::to_string(answer).expect("a text");
        // a model with cases has one answer for each part
        assert!(shown.contains("\"generic\""), "{name}: {shown}");
        let mut generic = Vec::new();
        collect(answer, "generic", &mut generic);
        assert!(generic.iter().all(|one| one["rank"] == rank), "{name}: {generic:?}");
        let mut unknowns = Vec::new();
        collect(answer, "unknowns", &mut unknowns);
        for list in unknowns {
            let list = list.as_array().expect("a list");
            assert_eq!(list.len() as u64, dimension, "{name}");
            let is_unseen = |one: &serde_json::Value| {
                one["verdict"] == "unobservable" || one["verdict"] == "non-identifiable"
            };
            let unseen = list.iter().filter(|one| is_unseen(one));
            let mut unseen: Vec<&str> = unseen.filter_map(|one| one["name"].as_str()).collect();
            let mut expected = not_seen.to_vec();
            unseen.sort_unstable();
            expected.sort_unstable();
            assert_eq!(unseen, expected, "{name}");
        }
    }
}

/// All values of a key, wherever it stands.
fn collect<'a>(value: &'a serde_json::Value, key: &str, found: &mut Vec<&'a serde_json::Value>) {
    match value {
        serde_json::Value::Object(map) => {
            found.extend(map.get(key).filter(|one| !one.is_null()));
            map.values().for_each(|one| collect(one, key, found));
        }
        serde_json::Value::Array(list) => list.iter().for_each(|one| collect(one, key, found)),
        _ => {}
    }
}

#[test]
fn what_is_asked_for_beside_the_file_is_done_and_said() {
    let question = ImportQuestion {
        outputs: vec!["C".to_owned(), "V1".to_owned()],
        unknowns: ForeignUnknowns::These(vec!["VM1".to_owned(), "Kc".to_owned()]),
        known_inputs: vec!["vi".to_owned()],
        unknown_inputs: vec!["kd".to_owned()],
        ..ImportQuestion::default()
    };
    let imported = imported("mitosis.xml", &question);
    for line in [
        "param VM1 = 3 unknown",
        "param Kc = 0.5 unknown",
        "param VM3 = 1",
        "known vi(t)",
        "unknown kd(t)",
        "output C, V1",
        "# outputs as they were asked for: C, V1",
    ] {
        assert!(imported.text.lines().any(|own| own == line), "{line}\n{}", imported.text);
    }
    assert_eq!(imported.text.matches(" unknown\n").count(), 2, "{}", imported.text);
}
