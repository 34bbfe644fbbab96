//! Sets that inequalities and domains make thinner than they look, and parts of sets that are thinner than the rest: by hand, each.

use palmistry::{Outcome, RankQuestion, System, Verdict, answer_rank, prove};
use std::path::Path;

const MODEL: &str = "system \"thin\"\nstate x, y, z, phi\nparam k\nangle phi\ndrift f\n  others' = 0\noutput x*y, y, z, sin(phi)\n";

fn outcomes(claims: &[(&str, String)]) -> Vec<Outcome> {
    let claims: Vec<String> = claims.iter().map(|(id, claim)| format!("claim {id}: {claim}\n")).collect();
    let text = format!("{MODEL}{}", claims.concat());
    let system = System::parse("thin.proof", &text, Path::new("")).unwrap_or_else(|why| panic!("{why:?}"));
    prove(&system)
}

fn outcome(claim: &str) -> Outcome {
    outcomes(&[("c", claim.to_owned())]).remove(0)
}

/// What is refuted has a state, and that it is refuted at; of a number there is none to give.
#[test]
fn a_claim_is_asked_of_each_part_of_its_set() {
    for (claim, expected) in [
        // one point of a line
        ("rank([x]) = 1 where x >= 0, x <= 0", "refuted"),
        ("rank([x]) = 0 where x >= 0, x <= 0", "proved"),
        ("rank = 4 where y in [0, 0]", "refuted"),
        ("rank = 3 where y in [0, 0]", "proved"),
        ("observable(x) where y in [0, 0]", "refuted"),
        ("observable(x) where y in [0, 1]", "proved"),
        ("rank([x]) = 1 where 0 <= x <= 0", "refuted"),
        ("rank([x]) = 1 where x^2 <= 0", "refuted"),
        ("rank([x]) = 1 where x^2 + y^2 <= 0", "refuted"),
        ("rank([x]) = 1 where abs(x) <= 0", "refuted"),
        ("rank([x]) = 1 where x^2 + 2*x*y + 2*y^2 = 0", "refuted"),
        ("rank([x - 1; y]) = 1 where x >= 1, x <= 1, y^2 <= 0", "refuted"),
        // domains
        ("rank([x; 0*sqrt(x); 0*sqrt(-x)]) = 1", "refuted"),
        ("rank([x - 1; sqrt(x - 1)*sqrt(1 - x)]) = 1", "refuted"),
        ("rank([x - 1]) = 1 where asin(x) >= 0, x >= 1", "refuted"),
        ("rank([x; acos(x^2 + 1)]) = 1", "refuted"),
        // angles
        ("rank([cos(phi) - 1; sin(phi)]) = 1 where cos(phi) >= 1", "refuted"),
        ("rank([cos(phi)]) = 1 where sin(phi)^2 >= 1", "refuted"),
        ("rank([cos(phi)]) = 1 where cos(phi)^2 <= 0", "refuted"),
        ("rank([x]) = 1 where exp(x) <= 1, x >= 0", "refuted"),
        // an equation on what inequalities make thin
        ("x = 0 where x >= 0, x <= 0", "proved"),
        ("x = y where (x - y)^2 <= 0", "proved"),
        // a point beside a half-line
        ("rank([x]) = 1 where x^2*(x - 1) >= 0", "undecided"),
        ("rank([x - 1]) = 1 where (x - 1)^2*x <= 0", "undecided"),
        // what is closed and has no thin part
        ("rank([x]) = 1 where abs(x) <= 1", "proved"),
        ("rank([x; y]) = 1 where x^2 + y^2 <= 1, x + y >= 0", "proved"),
        ("rank([x]) = 1 where x*y >= 0", "proved"),
        ("rank([x]) = 1 where x^2 + y^2 >= 1", "proved"),
        // Whitney's umbrella has a stick
        ("x != 7 where (y^2 + z^2)*x + y^2 + 2*z^2 = 0", "refuted"),
        ("rank([y]) = 1 where (y^2 + z^2)*x + y^2 + 2*z^2 = 0", "undecided"),
        ("x != 7 where x^2 - 14*x + 49 = 0", "refuted"),
        ("x*y = 0 where x^2 + y^2 = 0", "proved"),
        // nothing
        ("rank = 3 where 0 > 0", "undecided"),
        ("rank = 3 where x >= 1, x <= 0", "undecided"),
        ("x = 0 where x^2 + 1 <= 0", "undecided"),
        // numbers
        ("0 = 0 within -1", "refuted"),
        ("1 = 0 within -1", "refuted"),
        ("x*(2^1000)^100 = 0", "refuted"),
        // absolute values to a power have their derivative at zero, by themselves they have none
        ("d(x*abs(x), x) at {x = 0} = 0", "proved"),
        ("d(x*abs(x), x) = 2*abs(x)", "proved"),
        ("d(abs(x)^3, x) at {x = 0} = 0", "proved"),
        ("d(abs(x)^3*abs(y)*y, y) = 2*abs(y)*abs(x)^3", "proved"),
        ("d(abs(x), x) at {x = 0} = 0", "undecided"),
    ] {
        let found = outcome(claim);
        assert_eq!(found.word(), expected, "{claim}: {:?}", found.verdict);
        if let Verdict::Refuted { witness, .. } = &found.verdict {
            assert!(!witness.state.is_empty() || claim.contains("within"), "{claim}: no state");
        }
    }
}

/// Central differences, of numbers that share nothing with derivatives.
#[test]
fn derivatives_of_absolute_values_are_slopes() {
    type Case = (&'static str, fn(f64) -> f64);
    let cases: [Case; 5] = [
        ("x*abs(x)", |x| x * x.abs()),
        ("x^2*abs(x)", |x| x * x * x.abs()),
        ("abs(x)^3", |x| x.abs().powi(3)),
        ("(x - 1)*abs(x - 1)*x", |x| (x - 1.0) * (x - 1.0).abs() * x),
        ("sin(x*abs(x))", |x| (x * x.abs()).sin()),
    ];
    for (text, value) in cases {
        for at in [-2, -1, 0, 1, 3] {
            let (x, step) = (f64::from(at), 1e-4);
            let slope = (value(x + step) - value(x - step)) / (2.0 * step);
            let claim = format!("d({text}, x) at {{x = {at}}} = ({slope:.8}) within 0.001");
            assert_eq!(outcome(&claim).word(), "proved", "{claim}");
        }
    }
}

/// The random numbers of a claim are those of what it says.
#[test]
fn a_name_and_a_place_change_no_verdict() {
    let claims =
        ["x*y = 0", "rank([x, y; y, x]) = 1", "x^2 + y^2 >= 2*x*z", "rank = 2", "x != 7 where x*y = z"];
    let named = |names: [&'static str; 5], reversed: bool| {
        let mut all: Vec<_> = names.into_iter().zip(claims.map(str::to_owned)).collect();
        if reversed {
            all.reverse();
        }
        let mut found: Vec<(String, Verdict)> =
            outcomes(&all).into_iter().map(|one| (one.statement, one.verdict)).collect();
        found.sort_by(|a, b| a.0.cmp(&b.0));
        found
    };
    let first = named(["a", "b", "c", "d", "e"], false);
    assert_eq!(first, named(["p1", "p2", "p3", "p4", "p5"], false));
    assert_eq!(first, named(["v", "u", "t", "s", "r"], true));
}

/// Of nothing there is no rank.
#[test]
fn an_empty_set_has_no_rank() {
    for (conditions, rank) in [
        ("0 > 0", None),
        ("x > 0, x < 0", None),
        ("x >= 1, x <= 0", None),
        ("y >= 0, y <= 0", Some(3)),
        ("y > 0", Some(4)),
    ] {
        let mut system = System::parse("thin.proof", MODEL, Path::new("")).unwrap();
        let question =
            RankQuestion { samples: 0, conditions: vec![conditions.to_owned()], ..RankQuestion::default() };
        let found = answer_rank(&mut system, &question).map(|answer| answer.branches[0].generic_rank);
        assert_eq!(found.as_ref().ok().copied(), rank, "{conditions}: {found:?}");
    }
}

/// A root is zero where its radicand is, also where signs divide the claim into parts: by hand, at the edge. Each of the first was proved, with the root
/// as a power, which does not exist at zero.
#[test]
fn roots_are_zero_at_the_ends_of_their_domains() {
    for (claim, expected) in [
        ("sqrt(x) + abs(y) > 0", "refuted"),
        ("sqrt(x) + abs(y) > 0 where y = 0", "refuted"),
        ("sqrt(abs(y)) != 0", "refuted"),
        ("sqrt(abs(y)) = 0 where y = 0", "proved"),
        ("sqrt(x)*(2 + abs(y)) > 0", "refuted"),
        ("min(sqrt(x), 1) > 0", "refuted"),
        ("max(sqrt(x), y) > 0", "refuted"),
        ("sqrt(max(y, z)) > 0", "refuted"),
        ("abs(y)^(3/2) > 0", "refuted"),
        ("1/(1 + sqrt(abs(y))) < 1", "refuted"),
        ("sqrt(abs(y)) > 0 where -1 <= y <= 1", "refuted"),
        ("k*sqrt(x) + abs(y) > 0 where k > 0", "refuted"),
        ("sqrt(x) + abs(y) >= 0", "proved"),
        ("sqrt(x) + abs(y) + 1 > 0", "proved"),
        ("sqrt(x^2)*abs(y) = abs(x*y)", "proved"),
    ] {
        let found = outcome(claim);
        assert_eq!(found.word(), expected, "{claim}: {:?}", found.verdict);
    }
}

/// The verdicts of some claims about a system of their own.
fn words(model: &str, claims: &[(&str, &str)]) {
    let lines: Vec<String> =
        claims.iter().enumerate().map(|(place, (claim, _))| format!("claim {place}: {claim}\n")).collect();
    let text = format!("system \"s\"\n{model}\n{}", lines.concat());
    let system =
        System::parse("s.proof", &text, Path::new("")).unwrap_or_else(|why| panic!("{why:?}\n{text}"));
    for (outcome, (claim, expected)) in prove(&system).iter().zip(claims) {
        assert_eq!(outcome.word(), *expected, "{model}: {claim}: {:?}", outcome.verdict);
    }
}

/// Where the rank is zero, what is constant or measured is still observable and has one value: its differential is zero, or that of nothing unknown.
#[test]
fn at_rank_zero_constants_are_observable() {
    words(
        "state x\nparam a unknown\nparam m\ndrift f x' = x*m + a\noutput m",
        &[
            ("observable(x/x)", "proved"),
            ("unobservable(x/x)", "refuted"),
            ("observable(m*x/x)", "proved"),
            ("unobservable(sin(x)^2 + cos(x)^2)", "refuted"),
            ("unidentifiable(a/a)", "refuted"),
            ("solutions(x/x) = 1", "proved"),
            ("solutions(x/x) = infinity", "refuted"),
            ("observable(x)", "refuted"),
            ("unobservable(a)", "proved"),
            ("solutions(a) = infinity", "proved"),
            ("rank = 0", "proved"),
        ],
    );
    words(
        "state x\nknown u(t)\ndrift f x' = x*u\noutput u",
        &[
            ("unobservable(x*u/x)", "refuted"),
            ("solutions(x*u/x) = infinity", "refuted"),
            ("solutions(x/x) >= 5", "refuted"),
            ("unobservable(x)", "proved"),
        ],
    );
    words(
        "state x, y\ndrift f others' = 0\noutput x^2*y",
        &[("observable(y/y) where x = 0", "proved"), ("unobservable(y) where x = 0", "proved")],
    );
    words(
        "state x\nparam a unknown\ndrift f x' = x\noutput x\ninitial x known",
        &[
            ("solutions(x) = infinity", "refuted"),
            ("solutions(x^2) = 1", "proved"),
            ("observable(x + 1)", "proved"),
            ("solutions(a) = infinity", "proved"),
        ],
    );
}

/// Solutions are counted at almost all states at which all is smooth: where there is no open set of these nothing is counted. By hand: at m = 0 every `a` has the same
/// outputs, and with m = n there is one `b`.
#[test]
fn nothing_is_counted_on_thin_and_empty_domains() {
    for (model, claims) in [
        (
            "state x\nparam a unknown\nparam m\ndrift f x' = a*m*x\noutput x, sqrt(m) + sqrt(-m)",
            &["solutions(a) < infinity", "solutions(a) = infinity"][..],
        ),
        (
            "state x, y\nparam k, a unknown\ndrift f x' = k + a*(x - y) y' = k\noutput x, y, sqrt(x - y) + sqrt(y - x)",
            &["solutions(a) < infinity"],
        ),
        (
            "state x\nparam a, b, c unknown\nparam m, n\ndrift f x' = a*(m - n)*x + b + sqrt(m - n)*c + sqrt(n - m)*c^2\noutput x",
            &["solutions(b) = 1", "solutions(b) = infinity"],
        ),
        (
            "state x\nparam a, b unknown\ndrift f x' = a*x\noutput x",
            &["solutions(log(-1 - b^2)) = infinity", "solutions(log(-1 - a^2)) = 1"],
        ),
        ("state x\nparam a, b unknown\ndrift f x' = a*x + log(-1 - b^2)\noutput x", &["solutions(a) = 1"]),
        ("state x, y\ndrift f x' = 0 y' = y\noutput y\ninitial x = 0", &["solutions(y/x) >= 1"]),
    ] {
        let undecided: Vec<(&str, &str)> = claims.iter().map(|claim| (*claim, "undecided")).collect();
        words(model, &undecided);
    }
    // an open domain is none of these
    words(
        "state x\nparam a, m unknown\ndrift f x' = a*sqrt(m)*x\noutput x, m\nassume m > 0",
        &[("solutions(a) = 1", "proved"), ("solutions(sqrt(m)) < infinity", "proved")],
    );
    for text in [
        "state x param a unknown param m drift f x' = a*m*x output x, sqrt(m) + sqrt(-m)",
        "state x param a, b unknown drift f x' = a*b*x + log(-1 - x^2) output x",
    ] {
        let mut system: System = format!("system \"s\" {text}").parse().unwrap();
        let why = answer_rank(&mut system, &RankQuestion { samples: 0, ..RankQuestion::default() });
        let why = why.map(|answer| answer.branches.len()).unwrap_err().to_string();
        assert!(why.contains("outputs and rates"), "{why}");
        let counted = palmistry::answer_solutions(
            &mut system,
            palmistry::sweep::SolutionsWanted::Values,
            1_000_000,
            &Default::default(),
        );
        let why = counted.map(|answer| answer.is_final()).unwrap_err().to_string();
        assert!(why.contains("outputs and rates"), "{why}");
    }
}
