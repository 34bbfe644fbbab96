//! Verdicts at the edges: terms that exist on few states or none, conditions with several branches, ranks over no rows.
//! Each case was once proved, refuted or certified, and false; what is right is said beside it, from a pocket calculation.

use palmistry::claim::{ValueError, certified_value, exists_at};
use palmistry::system::Value;
use palmistry::{Outcome, RankQuestion, System, Verdict, answer_rank, decide_all};
use std::collections::BTreeMap;
use std::path::Path;

/// States, a parameter, two angles.
const DECLARED: &str = "system \"edges\" state x, y, z, phi, psi\nparam k\nangle phi, psi";

fn outcome(statement: &str) -> Outcome {
    let text = format!("{DECLARED}\nclaim 1: {statement}");
    let system = System::parse("edges.proof", &text, Path::new("")).expect(statement);
    decide_all(&system, 1, &false.into(), &|_| ()).remove(0)
}

fn words(statements: &[&str]) -> Vec<(String, &'static str)> {
    statements.iter().map(|text| ((*text).to_owned(), outcome(text).verdict.word())).collect()
}

fn all_are(word: &str, statements: &[&str]) {
    assert!(!statements.is_empty());
    let found = words(statements);
    let wrong: Vec<_> = found.iter().filter(|(_, other)| *other != word).collect();
    assert!(wrong.is_empty(), "expected {word}: {wrong:#?}");
}

#[test]
fn every_branch_of_the_conditions_counts() {
    // phi = pi meets both conditions of the first, and its cosine is -1; x = 2 pi meets both of the fourth
    all_are(
        "refuted",
        &[
            "cos(phi) = 1 where sin(phi) = 0, (pi+1)*(1-cos(phi)) = pi*(1-cos(phi)) + (1-cos(phi))",
            "x = 0 where x*y = 0",
            "x^2 = 0 where x*y - z = 0, x*y = 0, z/(z^2 - z - 1) = 0",
            "cos(y) = 1 where x*(z - 1) = 0, z = 1",
            "x = 1 where x*sin(phi) = sin(phi)",
        ],
    );
    all_are(
        "proved",
        &[
            "z = 0 where x*y - z = 0, y = 0",
            "x*y = 0 where x*y = 0",
            "cos(phi)^2 = 1 where sin(phi) = 0",
            "sin(phi) = 0 where cos(phi) = 1",
            "x = 0 where x*exp(y) = 0",
            "x*y*z = 0 where x*z = 0, x*y = 0",
        ],
    );
    all_are(
        "undecided",
        &[
            "y = 0 where atan(tan(y)) = 0",
            "z^3 = 0 where atan(tan(z)) = 0",
            "x*(x - pi) = 0 where sin(phi) = 0, x = phi",
            "x = 0 where x = -3, 0*log(x) = 0",
            "z^2 = 0 where z*(y + z) = 1, z = 0, cos(z) = 1",
            "cos(phi) = -1 where y = -3, 0*log(y) = 0",
            "x = 0 where x^2 + 1 = 0",
        ],
    );
}

#[test]
fn the_order_of_conditions_changes_nothing() {
    let cases: [(&str, &[&str]); 8] = [
        ("z = 0", &["x*y - z = 0", "y = 0"]),
        ("x*(x - pi) = 0", &["sin(phi) = 0", "x = phi"]),
        ("z*y = 0", &["sqrt(y) = y", "y/(z - 1) = 0"]),
        ("z^2 = 0", &["z*(y + z) = 1", "z = 0", "cos(z) = 1"]),
        ("x*z = 0", &["x*y - z = 0", "y = phi"]),
        ("cos(y) = 1", &["x*(z - 1) = 0", "z = 1"]),
        ("x^2 = 0", &["x*y - z = 0", "x*y = 0", "z/(z^2 - z - 1) = 0"]),
        ("rank([x, y; z, x*y]) = 1", &["x*x*y - y*z = 0", "y = 0", "x = z"]),
    ];
    for (claimed, conditions) in cases {
        let mut found = Vec::new();
        for order in orders(conditions.len()) {
            let list: Vec<&str> = order.iter().map(|place| conditions[*place]).collect();
            let statement = format!("{claimed} where {}", list.join(", "));
            found.push((outcome(&statement).verdict.word(), statement));
        }
        assert!(found.iter().all(|(word, _)| *word == found[0].0), "{found:#?}");
    }
}

/// All orders of so many places.
fn orders(count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    let mut found = Vec::new();
    for order in orders(count - 1) {
        for place in 0..count {
            let mut longer = order.clone();
            longer.insert(place, count - 1);
            found.push(longer);
        }
    }
    found
}

#[test]
fn what_exists_nowhere_is_not_proved() {
    all_are(
        "undecided",
        &[
            "0/((x+1)^2 - x^2 - 2*x - 1) = 0",
            "sqrt(-1-x^2)^2 = -1-x^2",
            "sqrt(-1-x^2)^2 = 0",
            "(0*log(x)) at {x=-5} = 0",
            "(1/(x-x))^0 = 1",
            "0*acos(2 + x^2) = 0",
            "x/log(-exp(y))*0 = 0",
            "rank([x/(y - y)]) = 1",
            "[0*log(-1)] = [0]",
        ],
    );
    for statement in ["x/x = 1", "sqrt(x)^2 = x", "1/(1/x) = x", "0*log(x) = 0", "asin(x)*0 + y = y"] {
        let found = outcome(statement);
        assert_eq!(found.verdict.word(), "proved", "{statement}");
        assert!(!found.domain.is_empty(), "{statement} holds where it exists, and that is said");
    }
    assert_eq!(outcome("1/(1/x) = x").domain, ["x != 0", "1/x != 0"]);
    assert!(outcome("x + y = y + x").domain.is_empty());
}

#[test]
fn a_law_is_not_refuted_where_a_side_does_not_exist() {
    // sqrt(y) sqrt(y) has no value at y = -3
    for statement in ["sqrt(y*y) = sqrt(y)*sqrt(y)", "0*log(x) = 0*log(y)", "x^0*sqrt(y)^2 = y"] {
        assert_ne!(outcome(statement).verdict.word(), "refuted", "{statement}");
    }
    let Verdict::Refuted { witness, .. } = outcome("sqrt(x^2) = x").verdict else {
        panic!("false below zero")
    };
    assert!(witness.state.iter().any(|at| at.name == "x" && at.value < 0.0), "{witness:?}");
}

#[test]
fn a_witness_on_a_set_names_all_of_its_state() {
    let Verdict::Refuted { witness, .. } = outcome("x = 0 where y = x + 1, z = 2*y").verdict else {
        panic!("false but at one point")
    };
    let value = |name: &str| witness.state.iter().find(|at| at.name == name).unwrap().value;
    assert_eq!((value("y"), value("z")), (value("x") + 1.0, 2.0 * (value("x") + 1.0)));
}

#[test]
fn values_exist_where_their_terms_do() {
    let mut system = System::parse("edges.proof", DECLARED, Path::new("")).unwrap();
    let x = system.find_symbol("x").unwrap();
    let mut at = |text: &str, value: i64| {
        let (term, guards) = system.evaluate_text_guarded(text).unwrap();
        let Value::Scalar(term) = term else { panic!("{text} is a number") };
        let point = [(x, dashu::rational::RBig::from(value))].into_iter().collect();
        exists_at(&system.graph, &guards, &point)?;
        certified_value(&system.graph, term, &point, 10).map(|value| value.decimal)
    };
    assert!(matches!(at("1/(1/x)", 0), Err(ValueError::Outside(_) | ValueError::Pole(_))));
    assert!(matches!(at("sqrt(x)^2", -1), Err(ValueError::Outside(_))));
    assert!(matches!(at("0*log(x)", -5), Err(ValueError::Outside(_))));
    assert!(matches!(at("(x/x)^0", 0), Err(ValueError::Pole(_))));
    assert_eq!(at("sqrt(x)^2", 3).as_deref(), Ok("3.000000000"));
    assert_eq!(at("1/(1/x)", -2).as_deref(), Ok("-2.000000000"));
}

/// The ranks at one state.
fn ranks(text: &str, fixed: &[(&str, i64)]) -> BTreeMap<usize, u64> {
    let mut system = System::parse("edges.proof", text, Path::new("")).unwrap();
    let fixed =
        fixed.iter().map(|(name, value)| (system.find_symbol(name).unwrap(), (*value).into())).collect();
    let question = RankQuestion { samples: 1, fixed, ..RankQuestion::default() };
    let answer = answer_rank(&mut system, &question).unwrap();
    answer.branches[0].full.rank_histogram.clone()
}

#[test]
fn no_rows_have_rank_zero() {
    // d(xy) = [y, x], and x' = y, y' = x: all words vanish at the origin
    let swap = "system \"s\" state x, y drift f x' = y y' = x output x*y sample x in [1,2] y in [1,2]";
    assert_eq!(ranks(swap, &[("x", 0), ("y", 0)]), BTreeMap::from([(0, 1)]));
    let constant = "system \"s\" state x, y drift f x' = y y' = x output 3 sample x in [1,2] y in [1,2]";
    assert_eq!(ranks(constant, &[]), BTreeMap::from([(0, 1)]));
    let one = "system \"s\" state x drift f x' = 1 output x^2 sample x in [1,2]";
    assert_eq!(ranks(one, &[("x", 1)]), BTreeMap::from([(1, 1)]));
}

#[test]
fn there_is_no_rank_where_a_field_is_not_defined() {
    let root = "system \"s\" state x drift f x' = sqrt(x) output x sample x in [1,2]";
    assert!(ranks(root, &[("x", -1)]).is_empty());
    assert_eq!(ranks(root, &[("x", 4)]), BTreeMap::from([(1, 1)]));
    let pole = "system \"s\" state x, y drift f x' = 1 y' = x input g x' = 0 y' = (y^2-2)/y output x, x*3 sample x in [1,2] y in [1,2]";
    assert!(ranks(pole, &[("y", 0)]).is_empty());
    let hidden = "system \"s\" state x drift f x' = x*x/x output x + 0*log(x) sample x in [1,2]";
    assert!(ranks(hidden, &[("x", -1)]).is_empty());
    // in a stream of states, too: half of this box lies outside of the domain
    let half = "system \"s\" state x drift f x' = 1 output sqrt(x)^2 sample x in [-1,1]";
    let mut system = System::parse("edges.proof", half, Path::new("")).unwrap();
    let question = RankQuestion { samples: 4000, ..RankQuestion::default() };
    let answer = answer_rank(&mut system, &question).unwrap();
    let full = answer.branches[0].full.rank_histogram.get(&1).copied().unwrap_or(0);
    assert!((1500..2500).contains(&full), "{full} of 4000 states lie above zero");
}

#[test]
fn a_trade_over_no_rows_is_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("constant.proof");
    let text = "system \"s\" state x, y drift f x' = y y' = x output 3 sample x in [1,2] y in [1,2]";
    std::fs::write(&file, text).unwrap();
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_palmistry"))
        .args(["trade", "--json"])
        .arg(&file)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stdout).contains("there are no rows"));
}
