//! Equations that hold and such that do not, and generic ranks, decided by normal forms alone; random ones are compared with evaluation at states.

use super::super::bound_span::{Asked, is_shown, pole_is_shown};
use super::super::checking::Checking;
use super::super::claim::{BuiltClaim, Subject, sides, statement};
use super::super::doubt::Effort;
use super::super::evaluation::Evaluation;
use super::super::listing::Listing;
use super::super::sources::ProofSources;
use super::super::state::{ExactCoordinate, ExactState, Ratio};
use super::{Equations, follow};
use dashu::rational::RBig;
use palmistry_lang::System;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::path::Path;
use std::sync::atomic::AtomicBool;

const STATES: &str = "system \"by hand\"\nstate x, y, z, phi, psi\nangle phi, psi\n";

fn claimed(head: &str, claim: &str) -> (System, BuiltClaim) {
    let text = format!("{head}claim it: {claim}\n");
    let mut system =
        System::parse("by hand", &text, Path::new(".")).unwrap_or_else(|why| panic!("{text}{why}"));
    let said = statement(&system, "it").expect("the claim is there").clone();
    let claim = BuiltClaim::of(&mut system, &said).unwrap_or_else(|why| panic!("{text}{why}"));
    (system, claim)
}

/// Whether the sides of a claim are shown to be one.
fn is_shown_equal(claim: &str) -> bool {
    let (system, built) = claimed(STATES, claim);
    let Subject::Sides(pairs) = &built.subject else { panic!("{claim}: no sides") };
    let (listed, pairs) =
        built.listed(&system, &Listing::default(), |lowering| sides(lowering, pairs)).unwrap();
    let equations = Equations { sides: &pairs, ..Equations::without_sides(&listed) };
    follow(equations, &Effort::new(1 << 22)).unwrap_or_else(|why| panic!("{claim}: {why}"))
}

#[test]
fn what_holds_is_shown() {
    for claim in [
        "(x + y)^3 = x^3 + 3*x^2*y + 3*x*y^2 + y^3",
        "1/x - 1/(x + 1) = 1/(x*(x + 1))",
        "(x^2 - y^2)/(x - y) = x + y",
        "sin(phi)^2 + cos(phi)^2 = 1",
        "sin(phi + psi) = sin(phi)*cos(psi) + cos(phi)*sin(psi)",
        "cos(3*phi) = 4*cos(phi)^3 - 3*cos(phi)",
        "sin(phi) = 2*sin(phi/2)*cos(phi/2)",
        "tan(phi)*cos(phi) = sin(phi)",
        "sin(phi + pi/2) = cos(phi)",
        "cos(phi + pi) = -cos(phi)",
        "cos(pi/12) = (sqrt(6) + sqrt(2))/4",
        "sin(x*y + z) = sin(x*y)*cos(z) + cos(x*y)*sin(z)",
        "exp(x + y) = exp(x)*exp(y)",
        "exp(x)*exp(-x) = 1",
        "exp(x/2)^2 = exp(x)",
        "exp(2*log(x)) = x^2",
        "sqrt(x)^2 = x",
        "sqrt(8) = 2*sqrt(2)",
        "sqrt(2)*sqrt(3) = sqrt(6)",
        "1/(1 + sqrt(2)) = sqrt(2) - 1",
        "sqrt(4*x/9) = 2*sqrt(x)/3",
        "sqrt(1/x^2)^2 = 1/x^2",
        "sin(asin(x)) = x",
        "cos(atan(x))^2 = 1/(1 + x^2)",
        // under conditions
        "x^3 = y^3 where x = y",
        "x^2*y = 0 where x*y = 0",
        "cos(phi)^2 = 1 where sin(phi) = 0",
        "sin(2*phi) = 0 where cos(phi) = 0",
        "sin(phi) = -sin(psi) where sin(phi + psi) = 0, cos(phi + psi) = 1",
        "x^4 = 4 where x^2 = 2",
        "x^2*z^2 = y^2 where x*z = y",
        "x + y = 3 where x - y = 1, x + 2*y = 4",
        "z = 0 where x*z = 0, x > 0",
        "x = 1 where y = 0, x = 1 + y*z",
    ] {
        assert!(is_shown_equal(claim), "{claim}");
    }
}

/// Each of these fails at some state, or holds for a reason that is not known here.
#[test]
fn what_fails_somewhere_is_not_shown() {
    for claim in [
        "(x + y)^2 = x^2 + y^2",
        "sqrt(x^2) = x",
        // at x = y = -1
        "sqrt(x*y) = sqrt(x)*sqrt(y)",
        "sqrt(y/x) = sqrt(x*y)/x",
        "sqrt(1/(x*y)) = sqrt(x*y)/(x*y^2)*y^2/1 - sqrt(x*y)/(x*y)*2",
        "log(x^2) = 2*log(x)",
        "asin(sin(phi)) = phi",
        "sin(x) = x",
        "exp(x) = x + 1",
        "sin(phi)^2 - cos(phi)^2 = 1",
        "cos(phi/2)^2 = (1 - cos(phi))/2",
        "cos(pi/5) = 4/5",
        // only one of two parts
        "x = 0 where x*y = 0",
        "x = y where x^2 = y^2",
        "cos(phi) = 1 where sin(phi) = 0",
        "sin(phi) = 1 where cos(phi) = 0",
        "phi = 0 where sin(phi) = 0",
        "sin(phi) = -sin(psi) where sin(phi + psi) = 0",
        "x = 1 where y*x = y",
        "z = 0 where x*z = 0",
        "x = 2 where (x - 2)*(x - 3) = 0",
        "x*y = 1 where x >= 0",
    ] {
        assert!(!is_shown_equal(claim), "{claim}");
    }
}

/// A random expression in the language.
fn expression(rng: &mut impl Rng, depth: usize) -> String {
    if depth == 0 {
        let leaves =
            ["x", "y", "z", "2", "3/2", "sin(phi)", "cos(phi)", "cos(phi + psi)", "sin(psi/2)", "sin(2*phi)"];
        return leaves[rng.random_range(0..leaves.len())].to_owned();
    }
    let mut part = || expression(rng, depth - 1);
    let (a, b) = (part(), part());
    match rng.random_range(0..6) {
        0 => format!("({a})*({b})"),
        1 => format!("({a} - ({b}))"),
        2 => format!("({a})/(1 + ({b})^2)"),
        3 => format!("({a})^2"),
        4 => format!("sqrt(1 + ({a})^2)"),
        _ => format!("({a} + {b})"),
    }
}

/// Random equations, half of them with one side rewritten so that they hold: what is shown agrees with evaluation in exact numbers at states, and what was rewritten is shown.
#[test]
fn random_equations_agree_with_evaluation() {
    let mut rng = ChaCha8Rng::seed_from_u64(37);
    let (mut shown, mut refuted) = (0, 0);
    for number in 0..300 {
        let [a, b, c] = [(); 3].map(|()| expression(&mut rng, 2));
        let right = match number % 2 {
            0 => format!("({a})*({c}) - ({b})*({c})"),
            _ => format!("({a})*({c}) + ({b})*({c})"),
        };
        let claim = format!("(({a}) - ({b}))*({c}) = {right}");
        let is_equal = is_shown_equal(&claim);
        assert!(is_equal || number % 2 == 1, "{claim}");
        shown += usize::from(is_equal);
        let (system, built) = claimed(STATES, &claim);
        let Subject::Sides(pairs) = &built.subject else { panic!("no sides") };
        let (listed, pairs) =
            built.listed(&system, &Listing::default(), |lowering| sides(lowering, pairs)).unwrap();
        for _ in 0..3 {
            let number = |rng: &mut ChaCha8Rng| Ratio(RBig::from(rng.random_range(-99..99)) / RBig::from(7));
            let mut state = ExactState::new();
            for name in ["x", "y", "z", "phi", "psi"] {
                state.insert(name.to_owned(), ExactCoordinate::Number(number(&mut rng)));
            }
            let effort = Effort::default();
            let values = Evaluation::new(&listed.listing, &state, &effort).unwrap();
            let differs = pairs[0].hold(&values).ok() == Some(Some(false));
            assert!(!(differs && is_equal), "{claim} at {state:?}");
            refuted += usize::from(differs);
        }
    }
    assert!(shown >= 150 && refuted >= 300, "{shown} {refuted}");
}

/// Whether a generic claim about a rank, or about functions, is shown without any state.
fn is_shown_generic(head: &str, claim: &str) -> bool {
    let (mut system, built) = claimed(head, claim);
    let (sources, effort, interrupt) = (ProofSources::given([]), Effort::default(), AtomicBool::new(false));
    let with = Checking { sources: &sources, seed: 1, effort: &effort, interrupt: &interrupt };
    let rank = match &built.subject {
        Subject::Matrix { claimed, .. } | Subject::System { claimed } => Some(*claimed),
        _ => None,
    };
    let is_observable = claim.starts_with("observable");
    is_shown(&mut system, &built, Asked { rank, given: None, is_generic: false, is_observable }, with)
        .unwrap()
}

#[test]
fn generic_ranks_are_shown_and_wrong_ones_are_not() {
    let scaled = "system \"scaled\"\nstate x, y\nparam k, b unknown\ndrift f\n  x' = k*x*y\n  y' = -k*x*y\noutput b*x\n";
    let turned = "system \"turned\"\nstate x, y, theta\nangle theta\ndrift f\n  x' = cos(theta)\n  y' = sin(theta)\n  theta' = 0\ninput g\n  theta' = 1\n  others' = 0\noutput x^2 + y^2\n";
    let gone = "system \"gone\"\nstate x\nparam c unknown\ndrift f\n  x' = x/c\noutput x/c\n";
    let plain = "system \"plain\"\nstate x, v\nparam k unknown\ndrift f\n  x' = v\n  v' = -k*x\noutput x\n";
    for (head, claim, holds) in [
        (STATES, "rank([x, y; 2*x, 2*y]) = 1", true),
        (STATES, "rank([x, y; 2*x, 2*y]) = 2", false),
        (STATES, "rank([sin(phi), cos(phi); -cos(phi), sin(phi)]) = 2", true),
        (STATES, "rank([x, y; z, x*y]) = 1 where x^2 = z, x = 1, z = 1, y = 1", true),
        // a line beside the surface, on which the rank is another
        (STATES, "rank([y, z]) = 1 where (y^2 + z^2)*x + y^2 + 2*z^2 = 0", false),
        // two parts with two ranks
        (STATES, "rank([x, y]) = 1 where x*y = 0", true),
        (STATES, "rank([x, x*y]) = 1 where x*y = 0", false),
        (STATES, "rank([x, x*y]) = 0 where x*y = 0", false),
        // closed inequalities may admit one state alone
        (STATES, "rank([x]) = 1 where x >= 0, x <= 0", false),
        // a set without states, which no equation says
        (STATES, "rank([x, y; 2*x, 2*y]) = 1 where x > 1, y > x", true),
        (STATES, "rank([x, y; 2*x, 2*y]) = 1 where x > 0, x < 0", false),
        (STATES, "rank([x]) = 1 where x^2 + y^2 < 0", false),
        (scaled, "unobservable(b) where x > 0, x < 0", false),
        // an angle of half turns that is another one as well
        (STATES, "rank([psi]) = 1 where sin(phi) = 0, phi = psi", false),
        (STATES, "rank([psi*x]) = 1 where y*sin(phi) = 0, phi = psi", false),
        // half turns: each value of the angle is one
        (STATES, "rank([phi]) = 1 where sin(phi) = 0", false),
        (STATES, "rank([sin(2*phi)]) = 0 where cos(phi) = 0", true),
        (scaled, "unobservable(b, k, x)", true),
        (scaled, "observable(b*x, k/b)", true),
        (scaled, "observable(k)", false),
        (scaled, "unobservable(k/b)", false),
        (scaled, "rank = 3", true),
        (scaled, "rank = 2", false),
        (scaled, "rank = 4", false),
        (turned, "rank = 2", true),
        (turned, "unobservable(x, theta)", true),
        (turned, "observable(x^2 + y^2, x*cos(theta) + y*sin(theta))", true),
        (turned, "observable(x)", false),
        // nothing exists there, and of no state nothing is generic
        (gone, "rank = 1 where c = 0", false),
        (gone, "unobservable(x) where c = 0", false),
        (gone, "unobservable(x, c)", false),
        (plain, "observable(x, v, k)", true),
        (plain, "unobservable(k)", false),
        // the set is left by the field: forms on it alone say nothing
        (plain, "unobservable(k) where x = 0, v = 0", true),
        (plain, "unobservable(k) where x = 0", false),
    ] {
        assert_eq!(is_shown_generic(head, claim), holds, "{claim}");
    }
}

#[test]
fn orders_of_poles_are_shown_where_no_other_factor_vanishes_too() {
    for (claim, holds) in [
        ("pole(1/x, x) = 1", true),
        ("pole(1/x, x) = 2", false),
        ("pole(x^2, x) = -2", true),
        ("pole(x/(x*y), x) = 0", true),
        ("pole((x^2 - y^2)/(x - y)^3, x - y) = 2", true),
        ("pole(1/sin(phi)^2, sin(phi)) = 2", true),
        // at one of two half turns the numerator vanishes as well
        ("pole((1 - cos(phi))/sin(phi)^2, sin(phi)) = 2", false),
        ("pole(sin(2*phi)/sin(phi)^3, sin(phi)) = 2", true),
        ("pole(phi/sin(phi), sin(phi)) = 1", false),
        ("pole(1/(x^2 - 2*y), x) = 0 where y = 0", false),
        ("pole(1/(x^2 - 2*y), x) = 2 where y = 0", true),
        ("pole(1/(x*y), x*y) = 1", false),
        ("pole(1/sqrt(x), x) = 1", false),
        ("pole((1 - cos(x))/x^2, x) = 2", false),
        ("pole(1/x, x) = 1 where y > 0, y < 0", false),
    ] {
        let (system, built) = claimed(STATES, claim);
        let Subject::Pole { expression, factor, order } = built.subject else { panic!("{claim}: no pole") };
        let (sources, effort, interrupt) =
            (ProofSources::given([]), Effort::default(), AtomicBool::new(false));
        let with = Checking { sources: &sources, seed: 1, effort: &effort, interrupt: &interrupt };
        let shown = pole_is_shown(&system, &built, ((expression, factor), order), with).unwrap();
        assert_eq!(shown, holds, "{claim}");
    }
}

/// What is short in a file and long behind it ends by a count: products of many symbols that are kept often, powers of sums, functions of functions.
#[test]
fn what_is_too_long_is_given_up() {
    let many: String = (0..400).map(|n| format!("param p{n}\n")).collect();
    let product = (0..400).map(|n| format!("p{n}")).collect::<Vec<_>>().join("*");
    let kept: String = (0..20_000).map(|n| format!("let a{} = -a{n}\n", n + 1)).collect();
    let nested: String = (0..400).map(|n| format!("let a{} = sin(a{n}) + x\n", n + 1)).collect();
    let sum = |of: &str| (0..400).map(|n| format!("{of}*p{n}")).collect::<Vec<_>>().join(" + ");
    let slopes = (0..40).fold("x".to_owned(), |inner, n| format!("(p{n}*{inner} + y)"));
    let squared: String = (0..40).map(|n| format!("let a{} = a{n}^2 + y\n", n + 1)).collect();
    for (head, claim) in [
        (format!("{STATES}{many}let a0 = {product}\n{kept}"), "a20000 + x = a19999 + x + 1"),
        (format!("{STATES}let a0 = x\n{nested}"), "a400 = x"),
        (format!("{STATES}let a0 = x\n{squared}"), "a40 = x"),
        // a denominator in each of many terms, slopes of slopes
        (format!("{STATES}{many}let a = sin(({})/({}))\n", sum("x"), sum("(x + y)")), "a = x"),
        (format!("{STATES}{many}let a = {slopes}\n"), "x*y = z where a = 0"),
        (STATES.to_owned(), "(x + y + z + sin(phi) + cos(psi))^1000 = 0"),
    ] {
        let (system, built) = claimed(&head, claim);
        let Subject::Sides(pairs) = &built.subject else { panic!("{claim}: no sides") };
        let (listed, pairs) =
            built.listed(&system, &Listing::default(), |lowering| sides(lowering, pairs)).unwrap();
        let equations = Equations { sides: &pairs, ..Equations::without_sides(&listed) };
        assert!(!matches!(follow(equations, &Effort::new(1 << 22)), Ok(true)), "{claim}");
    }
}
