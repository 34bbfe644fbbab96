//! Small terms that are left out: which, how large they are, and that the bound is one, by rates that are evaluated at drawn states.

use palmistry_lang::System;
use palmistry_math::expression::Program;
use palmistry_math::number::Floats;
use palmistry_prove::claim::prove;
use palmistry_reduce::{LeastModel, ReduceQuestion, SmallTerms, WhyLeftOut, reduce};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// The least model of a text with a tolerance, and both systems; all its claims are proved.
fn least(text: &str, tolerance: f64) -> (LeastModel, System, System) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("whole.proof"), text).unwrap();
    let system = System::parse("whole.proof", text, folder.path()).unwrap();
    let asked = ReduceQuestion { tolerance: Some(tolerance), ..ReduceQuestion::default() };
    let found = reduce(&system, &asked, "whole.proof").unwrap();
    let small = System::parse("least.proof", &found.text, folder.path());
    let small = small.unwrap_or_else(|error| panic!("{error}\n{}", found.text));
    for outcome in prove(&small) {
        assert!(outcome.ok, "{} {}: {}\n{}", outcome.word(), outcome.id, outcome.statement, found.text);
    }
    (found, system, small)
}

/// The rates of a system's drift at a state given by names, by name.
fn rates(system: &System, state: &BTreeMap<String, f64>) -> BTreeMap<String, f64> {
    let field = system.fields.iter().find(|field| field.name == "f").unwrap();
    let nodes: Vec<_> = field.components.iter().map(|(_, node)| *node).collect();
    let program = Program::plain(&system.graph, &nodes);
    let inputs: Vec<f64> =
        program.inputs().iter().map(|input| state[system.symbol_name(input.symbol().unwrap())]).collect();
    let values = program.load(Floats).unwrap().run(&inputs, &mut Vec::new()).unwrap();
    let names = field.components.iter().map(|(symbol, _)| system.symbol_name(*symbol).to_owned());
    names.zip(values).collect()
}

/// The largest difference of each rate that small terms were left out of, at states drawn from the ranges, in units of its bound.
fn tightness(found: &LeastModel, whole: &System, small: &System, seed: u64) -> BTreeMap<String, f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let number = |value: &dashu::rational::RBig| value.to_f64().value();
    let mut most: BTreeMap<String, f64> = BTreeMap::new();
    for _ in 0..2000 {
        let state = whole.symbols().map(|(symbol, info)| {
            let value = match (&info.range, &info.default) {
                (Some(range), _) => {
                    let part: f64 = rng.random();
                    // the ends are among them
                    let part = ((1.4 * part) - 0.2).clamp(0.0, 1.0);
                    number(&range.low) + part * (number(&range.high) - number(&range.low))
                }
                (None, Some(value)) => number(value),
                (None, None) => f64::NAN,
            };
            (whole.symbol_name(symbol).to_owned(), value)
        });
        let state: BTreeMap<String, f64> = state.collect();
        let (more, less) = (rates(whole, &state), rates(small, &state));
        for SmallTerms { state, bound, .. } in
            found.small_terms.iter().filter(|own| less.contains_key(&own.state))
        {
            let off = (more[state] - less[state]).abs() / bound.parse::<f64>().unwrap();
            let own = most.entry(state.clone()).or_insert(0.0);
            *own = own.max(off);
        }
    }
    most
}

const SPIN: &str = r#"
system "A body that spins fast between two palms, one of which hardly turns"
state r1, s1, omega0, omega1
param phi : angle = 1
param g = -9.81
drift f
  r1' = -s1*(omega1 - omega0)
  s1' = (omega0^2*r1 + g*cos(phi))/(omega1 - omega0) - (omega1 + omega0)*s1
  omega0' = 0
  omega1' = 0
output s1, r1
sample
  r1 in [0.5, 3]
  s1 in [0.5, 3]
  omega0 in [3000, 5000]
  omega1 in [-1/1000, 1/1000]
"#;

/// A fast spin: gravity and the rate of the palm go, each out of a quotient, and the palm's rate out of the state.
#[test]
fn gravity_of_a_fast_spin_and_a_rate() {
    let (found, whole, small) = least(SPIN, 1e-5);
    assert_eq!(small.state_names(), ["r1", "s1", "omega0"], "{}", found.text);
    let gone: Vec<_> = found.left_out.iter().map(|one| (one.name.as_str(), &one.why)).collect();
    assert!(matches!(gone[..], [("omega1", WhyLeftOut::InSmallTermsAlone)]), "{gone:?}");
    let terms = &found.small_terms[1].terms;
    assert!(
        terms.iter().any(|term| term.contains("cos(phi)")) && terms.contains(&"omega1".to_owned()),
        "{terms:?}"
    );
    // of the larger system at its limit: s1' = -omega0*(r1 + s1), by hand
    let state: BTreeMap<String, f64> =
        [("r1", 2.0), ("s1", 1.5), ("omega0", 4000.0), ("omega1", 0.0), ("phi", 1.0), ("g", -9.81)]
            .map(|(name, value)| (name.to_owned(), value))
            .into();
    assert!((rates(&small, &state)["s1"] + 4000.0 * 3.5).abs() < 1e-9, "{}", found.text);
    let tight = tightness(&found, &whole, &small, 1);
    assert!(tight.values().all(|part| (0.5..=1.0).contains(part)), "{tight:?}");
    // a finer tolerance keeps what a coarser one leaves out
    let (finer, ..) = least(SPIN, 2e-7);
    let left: Vec<_> = finer.small_terms.iter().map(|own| (own.state.as_str(), &own.terms[..])).collect();
    assert!(matches!(left[..], [("s1", [gravity])] if gravity == "g*cos(phi)"), "{left:?}");
    let (none, ..) = least(SPIN, 1e-12);
    assert!(none.small_terms.is_empty());
}

/// Below roots, in exponents, in logarithms, sines, powers and divisors.
#[test]
fn in_functions() {
    for (rate, term) in [
        ("sqrt(1 + e*z)*x", "e*z"),
        ("exp(e*z - x)", "e*z"),
        ("log(2 + e*z)", "e*z"),
        ("sin(x + e*z)*y", "e*z"),
        ("cos(x - e*z)", "e*z"),
        ("(x + e*z)^4", "e*z"),
        ("y/(x + e*z)^3", "e*z"),
        ("x/(1 + e*z) - y", "e*z"),
        ("atan(x + e*z)", "e*z"),
        ("(x + e)*(y - e*z)/(1 + e)", "e*z"),
    ] {
        let text = format!(
            "system \"s\"\nstate x, y, z\nparam e unknown\ndrift f\n  x' = {rate}\n  y' = -x\n  z' = 0\noutput x, y, z\nsample\n  x in [1, 2]\n  y in [1, 2]\n  z in [1, 2]\n  e in [-1/1000000, 1/1000000]\n"
        );
        let (found, whole, small) = least(&text, 1e-4);
        let own: Vec<_> = found.small_terms.iter().map(|own| own.terms.clone()).collect();
        assert!(own.len() == 1 && own[0].contains(&term.to_owned()), "{rate}: {own:?}\n{}", found.text);
        let tight = tightness(&found, &whole, &small, 2);
        assert!(tight["x"] <= 1.0 + 1e-6 && tight["x"] > 0.1, "{rate}: {tight:?}");
    }
}

/// What has no range, and what grows near a zero of a divisor, stays.
#[test]
fn what_has_no_bound_stays() {
    let text = |ranges: &str| {
        format!(
            "system \"s\"\nstate x, y\nparam e = 1/1000000\ndrift f\n  x' = -x + e/y\n  y' = -y + e*x\noutput x, y\nsample\n{ranges}"
        )
    };
    let states = |found: &LeastModel| -> Vec<String> {
        found.small_terms.iter().map(|own| own.state.clone()).collect()
    };
    let (found, ..) = least(&text("  x in [1, 2]\n  y in [1, 2]\n"), 1e-4);
    assert_eq!(states(&found), ["x", "y"]);
    let (found, ..) = least(&text("  x in [1, 2]\n  y in [-1, 2]\n"), 1e-4);
    assert_eq!(states(&found), ["y"]);
    let (found, ..) = least(&text("  x in [1, 2]\n"), 1e-4);
    assert_eq!(states(&found), [""; 0]);
}

/// Random rates with small coefficients: every bound is one at all drawn states, and every claim is proved.
#[test]
fn bounds_of_random_rates() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut with = 0;
    for seed in 0..25 {
        let names = ["x", "y", "z"];
        let mut term = |small: bool| {
            let coefficient =
                if small { rng.random_range(1..90) as f64 * 1e-8 } else { rng.random_range(1..9) as f64 };
            let (a, b) = (names[rng.random_range(0..3)], names[rng.random_range(0..3)]);
            match rng.random_range(0..5) {
                0 => format!("{coefficient}*{a}"),
                1 => format!("{coefficient}*{a}*{b}"),
                2 => format!("{coefficient}*{a}/({b} + 1)"),
                3 => format!("{coefficient}*sqrt({a} + {b})"),
                _ => format!("{coefficient}*exp(-{a})"),
            }
        };
        let rate: Vec<String> = (0..3)
            .map(|_| {
                format!(
                    "-{} + ({} - {})/({} + {})",
                    term(false),
                    term(false),
                    term(true),
                    term(false),
                    term(true)
                )
            })
            .collect();
        let text = format!(
            "system \"s\"\nstate x, y, z\ndrift f\n  x' = {}\n  y' = {}\n  z' = {}\noutput x, y\nsample\n  x in [1, 2]\n  y in [1, 3]\n  z in [1/2, 2]\n",
            rate[0], rate[1], rate[2]
        );
        let (found, whole, small) = least(&text, 1e-6);
        with += found.small_terms.len();
        let tight = tightness(&found, &whole, &small, seed);
        assert!(tight.values().all(|part| *part <= 1.0 + 1e-6), "{tight:?}\n{text}");
    }
    assert!(with > 30, "of {with} rates something is left out");
}
