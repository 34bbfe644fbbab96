//! Inequalities: proved by signs, sums of squares and boxes, refuted by states, and left open where nothing tells. What is
//! right is known from textbooks or a pocket calculation, and said where it is not plain.

use palmistry::checker::{Effort, Evidence, Finding};
use palmistry::claim::{Kept, decide_all_keeping};
use palmistry::{Outcome, RankQuestion, System, Verdict, answer_rank, decide_all};
use std::collections::BTreeMap;
use std::path::Path;

const DECLARED: &str = "system \"inequalities\" state x, y, z, phi, psi\nparam k, m, g = 3\nangle phi, psi
sample x in [-1, 2] y in [1, 3] phi in [-1, 1] avoid x - 1";

fn system(statements: &[&str]) -> System {
    let claims: Vec<String> =
        statements.iter().enumerate().map(|(n, text)| format!("claim {n}: {text}")).collect();
    let text = format!("{DECLARED}\n{}", claims.join("\n"));
    System::parse("inequalities.proof", &text, Path::new("")).unwrap_or_else(|error| panic!("{error:?}"))
}

fn outcomes(statements: &[&str]) -> Vec<Outcome> {
    decide_all(&system(statements), 1, &false.into(), &|_| ())
}

fn all_are(word: &str, statements: &[&str]) {
    let wrong: Vec<_> = outcomes(statements)
        .into_iter()
        .zip(statements)
        .filter(|(outcome, _)| outcome.verdict.word() != word)
        .map(|(outcome, text)| (*text, outcome.verdict))
        .collect();
    assert!(wrong.is_empty(), "expected {word}: {wrong:#?}");
}

#[test]
fn for_all_states_by_signs_and_squares() {
    all_are(
        "proved",
        &[
            "x^2 >= 0",
            "x^2 + 1 > 0",
            "x^2 + y^2 >= 2*x*y",
            "x^2 + x*y + y^2 + 1 > 0",
            "x^4 - x + 1 > 0",
            "x^2 + y^2 + z^2 >= x*y + y*z + z*x",
            "(x^2 - y^2)^2 + 1 > 0",
            // the means of four numbers
            "x^4 + y^4 + z^4 + 1 >= 4*x*y*z",
            "(x^2 + 1)*(y^2 + 1) >= (x*y + 1)^2",
            "0 < k/(k + m) < 1 where k > 0, m > 0",
            "k*x^2 + m*y^2 >= 0 where k >= 0, m >= 0",
            "(x - 1)^2*(x + 2) >= 0 where x >= -2",
            "x^2 > x where x > 1",
            "x < z where x < y, y < z",
            "x > y where x - y > 1",
            "x*y > 0 where x < 0, y < 0",
            "x != 0 where x*y = 1",
            "1/x + x >= 2 where x > 0",
            "cos(phi)^2 <= 1",
            "1 - cos(phi) >= 0",
            "exp(x) > 0",
            "sqrt(x) >= 0",
            "sqrt(x^2 + 1) > x",
            "(x + y)/2 >= sqrt(x*y) where x >= 0, y >= 0",
            "atan(x) < pi/2",
            "-pi/2 <= asin(x) <= pi/2",
            "acos(x) <= pi",
            "x*y <= 1/2 where x^2 + y^2 = 1",
        ],
    );
}

#[test]
fn on_regions_by_boxes() {
    all_are(
        "proved",
        &[
            "x^2 < 4 where -2 < x < 2",
            "x^3 + 1 > 0 where x in [-1/2, 5]",
            "x*y > -4 on sample",
            "x != 1 on sample",
            "cos(phi) > 0 on sample",
            "phi < 1 + 1/1000 on sample",
            "2 - sin(phi) - cos(psi) >= 0",
            "3 - sin(phi) - cos(phi + psi) > 0",
            "sin(z) < z where 0 < z < 1",
            "sin(z) > z - z^3/6 where 0 < z <= 1",
            "exp(x) >= 1 + x",
            "exp(-x) < 1 where x > 0",
            // touches at 1, and at 2
            "log(x) <= x - 1",
            "log(x) <= x/2 + log(2) - 1",
            "sin(x)/x <= 1 where x in [1/10, 3]",
            "x + y < 2 where x^2 + y^2 = 1",
            // Motzkin's polynomial, which is no sum of squares
            "x^2*y^2*(x^2 + y^2 - 3) + 1 >= 0",
            // the means of three numbers, met with equality at a third
            "x*y*z <= 1/27 where x > 0, y > 0, z > 0, x + y + z = 1",
            "333/106 < pi < 355/113",
            "exp(1) > 271828/100000",
            "x + y > 1 where x in [1, 2], y >= 1/4",
        ],
    );
}

#[test]
fn what_fails_fails_at_a_state() {
    let statements = [
        "x^2 > 0",
        "x^2 >= x",
        "x^4 - x + 1/4 > 0",
        "x^2 + y^2 > 2*x*y",
        "x*y > -2 on sample",
        "x < 2 on sample",
        "x != 2",
        "cos(phi) > 3/5",
        "sin(phi) < 1 where phi in [0, 3]",
        "exp(x) >= 1 + x + x^2/2",
        "sqrt(x^2) = x where x > -2",
        "x*y <= 1/4 where x + y = 1, x*y > 0, x > 3/10, y > 1",
        "pi > 22/7",
        "x > 100 where x > 99",
        "x*y != 0 where x + y = 1",
        "x < x",
        "log(x) < x - 1",
        "x^2*y^2*(x^2 + y^2 - 3) + 1 > 0",
        "x < y where y > x - 1",
        "0 < x < 1 where 0 < x",
        "g*x >= x",
        // where a square vanishes a product says nothing of the other factor
        "y >= 0 where x^2*y >= 0",
        "y >= 0 where sin(phi)^2*y >= 0",
        "z >= 0 where x*y*z >= 0, x >= 0, y >= 0",
    ];
    let outcomes = outcomes(&statements);
    for (outcome, text) in outcomes.iter().zip(statements) {
        let is_false = text.starts_with("x*y <= 1/4");
        match &outcome.verdict {
            Verdict::Refuted { witness, .. } => assert!(witness.refutation.is_some() && !is_false, "{text}"),
            // no state meets these conditions: x + y = 1 with both above
            Verdict::Undecided { why } => {
                assert!(is_false && why.contains("is defined nowhere"), "{text}: {why}")
            }
            other => panic!("{text}: {other:?}"),
        }
    }
}

/// In one variable, and of degree two, everything is decided: at irrational places too, which are told by a number that the checker knows or by
/// the polynomial.
#[test]
fn what_is_decided_completely() {
    let cases = [
        ("x^4 - 4*x^2 + 4 > 0", Some(("x", "-sqrt(2)"))),
        ("x^4 - 4*x^2 + 4 >= 0", None),
        ("x^5 - x - 1 != 0", Some(("x", "1.16730397826 (a zero of x^5 - x - 1)"))),
        ("x - 2*sqrt(x) + 1 > 0", Some(("x", "1"))),
        ("2*cos(phi)^2 - 3*cos(phi) + 2 > 0", None),
        ("x^3 - 3*x + 1 < 0 where x > 1/2, x < 3/2", None),
        ("x*y - x + 7 > 0", Some(("x", ""))),
        ("x^2 + y^2 + z^2 - x*y - y*z - z*x >= 0", None),
        ("x^2 + y^2 + z^2 - x*y - y*z - z*x > 0", Some(("x", ""))),
    ];
    let statements = cases.map(|(text, _)| text);
    for (outcome, (text, failing)) in outcomes(&statements).iter().zip(cases) {
        match (&outcome.verdict, failing) {
            (Verdict::Proved { .. }, None) => {}
            (Verdict::Refuted { witness, .. }, Some((name, value))) => {
                let at = witness.state.iter().find(|at| at.name == name).expect("a state");
                assert!(value.is_empty() || at.exact == value, "{text}: {at:?}");
                assert_eq!(witness.refutation.is_some(), !value.contains("a zero of"), "{text}");
            }
            other => panic!("{text}: {other:?}"),
        }
    }
}

/// True or false, but nothing that is known here tells; and what speaks of nothing.
#[test]
fn what_is_not_shown_is_undecided() {
    let statements = [
        ("x > 0 where x > 1, x < 0", "defined nowhere"),
        ("x > 0 where x^2 + 1 = 0", "never met"),
        ("x + y > 100 where x^4 + y^4 + exp(x) = 0", "never met"),
        ("sqrt(-1 - x^2) >= 0", "defined nowhere"),
        ("sin(x*y)*cos(x + y) + exp(-x^2) <= 1 + 1/1000000 where x^3 + y^3 = x*y + 20", ""),
    ];
    for (text, reason) in statements {
        let outcome = outcomes(&[text]).remove(0);
        let Verdict::Undecided { why } = &outcome.verdict else { panic!("{text}: {:?}", outcome.verdict) };
        assert!(why.contains(reason), "{text}: {why}");
    }
    // the part that is open is said, with a place
    let open = outcomes(&["exp(-x)*x <= exp(-1)"]).remove(0);
    let Verdict::Undecided { why } = &open.verdict else { panic!("{:?}", open.verdict) };
    assert!(why.contains("of the region is open") && why.contains("x in ["), "{why}");
}

/// Inequalities are conditions of identities and ranks as well.
#[test]
fn conditions_take_part_everywhere() {
    all_are("proved", &["x/sqrt(x^2 + 1) = x/sqrt(1 + x^2) where x > 2", "x*y = y*x where x != y"]);
    all_are("refuted", &["x = y where x > y", "x = 0 where x >= 0"]);
    let text = "system \"a\" state x, y drift f x' = y y' = 0 output x*x/2 sample x in [-1, 1] y in [-1, 1]";
    let mut system = System::parse("rank.proof", text, Path::new("")).unwrap();
    let question = RankQuestion {
        samples: 200,
        conditions: vec!["x > 1/2".to_owned(), "-1/4 < y < 1/4".to_owned()],
        ..RankQuestion::default()
    };
    let answer = answer_rank(&mut system, &question).unwrap();
    let worst = answer.branches[0].full.worst.as_ref().expect("a worst state");
    let value = |name: &str| worst.0.iter().find(|at| at.name == name).unwrap().value;
    assert!(value("x") > 0.5 && value("y").abs() < 0.25, "{:?}", worst.0);
    assert_eq!(answer.branches[0].full.certified, 200);
}

/// One of each edge: nothing there, ends, poles, equality, turns, products of which a factor may vanish.
#[test]
fn at_the_edges() {
    let found = |word: &str| {
        let all: &[&str] = match word {
            "proved" => &[
                "x >= 1 where x in [1, 1]",
                "x != 1 on sample",
                "1/x > 0 where x >= 0",
                "x/x >= 1",
                "1 < 2",
                "sqrt(2)*sqrt(3) >= sqrt(6)",
                "x^2 > 0 where x != 0",
                "phi >= 0 where phi in [0, 7]",
                "x >= 0 where x^3 >= 0",
                "y >= 0 where y/x^2 >= 0",
                "x > 0 where 1/x > 0",
                "x >= 0 where x*exp(y) >= 0",
            ],
            "refuted" => &[
                "x > 5 where x in [1, 1]",
                "2 < 1",
                "1 != 1",
                "sin(phi) >= 0 where phi in [0, 4]",
                "y > 0 where x*y > 0",
                "x*y >= 0 where x*y > -1",
                "y >= 0 where y*sqrt(x) >= 0",
                "y >= 0 where y*(1 - cos(phi)) >= 0",
                "acos(x) > 0",
                "sqrt(x) > 0",
                "sqrt(2)*sqrt(3) > sqrt(6)",
                "sin(x)^2 + cos(x)^2 < 1",
                // no range says where k is
                "k > 0 on sample",
            ],
            // no state meets the first two; the last is false, and the checker has no rule for it
            _ => &["x > 0 where x in [2, 1]", "0*log(x) >= 0 where x < 0", "exp(2*x) > exp(x)^2"],
        };
        all_are(word, all);
    };
    ["proved", "refuted", "undecided"].into_iter().for_each(found);
}

/// What is kept of each verdict is found again by the checker, and what is changed is not.
#[test]
fn the_checker_finds_them_again() {
    let statements =
        ["x^2 + 1 > 0", "x^2 > 0", "cos(phi) > 3/5", "x*y <= 1/2 where x + y = 1, x > 0", "x < x"];
    let outcomes = decide_all_keeping(Kept::Evidence, &system(&statements), 1, &false.into(), &|_| ());
    let mut seen = BTreeMap::new();
    for record in outcomes.iter().flat_map(|outcome| &outcome.evidence) {
        match &record.evidence {
            Evidence::Refuted(refutation) => {
                assert!(matches!(refutation.check(&Effort::default()), Finding::Confirmed { .. }));
                *seen.entry("refuted").or_insert(0) += 1;
                // the same state refutes no weaker claim
                let text = serde_json::to_string(&record.evidence).unwrap();
                let weaker = text.replace("\"relation\":\">\"", "\"relation\":\">=\"");
                let weaker: Evidence = serde_json::from_str(&weaker).unwrap();
                if let (Evidence::Refuted(weaker), true) = (&weaker, record.statement == "x^2 > 0") {
                    assert!(matches!(weaker.check(&Effort::default()), Finding::NotConfirmed(_)));
                }
            }
            Evidence::Proved(proved) => {
                assert!(matches!(proved.check(1, &Effort::default()), Finding::Consistent { states: 1.. }));
                *seen.entry("proved").or_insert(0) += 1;
            }
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(seen, BTreeMap::from([("proved", 2), ("refuted", 3)]));
}
