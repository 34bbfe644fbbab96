//! Real powers, absolute values, extremes, hyperbolic functions and angles of points: what handbooks say of them, what dimensions
//! they have, how they are written, and that nothing panics on them.

use palmistry::{System, decide_all};
use proptest::prelude::*;
use std::path::Path;

const DECLARED: &str =
    "system \"functions\"\nstate x, y, z\nparam k, n, K, E, R, T\ndrift f x' = y y' = -x z' = 0\noutput x\n";

fn outcomes(claims: &[&str]) -> Vec<palmistry::Outcome> {
    let claims: Vec<String> =
        claims.iter().enumerate().map(|(place, claim)| format!("claim c{place}: {claim}\n")).collect();
    let text = format!("{DECLARED}{}", claims.concat());
    let system = System::parse("f.proof", &text, Path::new("")).unwrap_or_else(|error| panic!("{error}"));
    decide_all(&system, 1, &false.into(), &|_| ())
}

fn all_are(word: &str, claims: &[&str]) {
    for outcome in outcomes(claims) {
        assert_eq!(outcome.word(), word, "{}", outcome.statement);
    }
}

#[test]
fn laws_are_proved() {
    all_are(
        "proved",
        &[
            "abs(x)^2 = x^2",
            "abs(x*y) = abs(x)*abs(y)",
            "sign(x)*abs(x) = x",
            "min(x, y) + max(x, y) = x + y",
            "max(x, y) = x where x > y",
            "max(x,y) >= x",
            "min(x,y,z) = min(x, min(y,z))",
            "tanh(x) = sinh(x)/cosh(x)",
            "cosh(x)^2 - sinh(x)^2 = 1",
            "d(tanh(x), x) = 1 - tanh(x)^2",
            "tanh(2*x) = 2*tanh(x)/(1+tanh(x)^2)",
            "tanh(x) < 1",
            "x^n*x^k = x^(n+k)",
            "(x*y)^n = x^n*y^n where y > 0",
            "x^(1/2) = sqrt(x)",
            "(x^(1/3))^3 = x",
            "x^0.5*x^1.5 = x^2",
            "d(x^n, x) = n*x^(n-1)",
            "x^n/(K^n + x^n) = 1/(1 + (K/x)^n)",
            "(x^n)^k = x^(n*k)",
            "exp(-E/(R*T))^2 = exp(-2*E/(R*T))",
            "tan(atan2(y,x)) = y/x",
            "sin(atan2(y,x)) = y/sqrt(x^2+y^2)",
            "cos(atan2(y,x)) = x/sqrt(x^2+y^2)",
            "d(atan2(y,x), x, y) = [-y, x]/(x^2+y^2)",
            "atan2(y,x) = atan(y/x) where x > 0",
            "atan2(y, x) at {x = 1, y = 1} = pi/4",
            "atan2(y, x) at {x = -1, y = 1} = 3*pi/4",
            "d(abs(x), x) = sign(x)",
            "d(max(x,y), x) = 1 where x > y",
            "L(f, abs(x)) = y*sign(x)",
            "sign(x) = 1 where x > 0",
        ],
    );
}

#[test]
fn near_misses_are_refuted() {
    all_are(
        "refuted",
        &[
            "abs(x) = x",
            "tanh(x) = x",
            "x^n = x",
            "max(x,y) = x",
            "atan2(y,x) = atan(y/x)",
            "x^n*y^n = x*y^n",
            "abs(x + y) = abs(x) + abs(y)",
            "min(x, y) = max(x, y)",
            "sign(x*y) = sign(x)",
            "cosh(x)^2 + sinh(x)^2 = 1",
            "tanh(x) > 0",
            "x^(1/3)*x^(1/3) = x",
        ],
    );
}

/// By hand.
#[test]
fn values_are_right() {
    all_are(
        "proved",
        &[
            "8^(1/3) = 2",
            "4^(3/2) = 8",
            "4^(-0.5) = 1/2",
            "abs(-3) + sign(-2) + min(3, 1, 2) + max(1, 5, 2) = 8",
            "atan2(1, -1) = 3*pi/4",
            "atan2(-1, 0) = -pi/2",
            "tanh(log(2)) = 3/5",
            "x^2.0 = x^2",
            "(x^n at {x = 2, n = 5}) = 32",
            "(tanh(x) at {x = 1}) = 0.76159415595576 within 0.00000000000001",
            "(x^n at {x = 2, n = 1/3}) = 1.25992104989487 within 0.00000000000001",
        ],
    );
}

/// What does not exist has no value: it proves nothing.
#[test]
fn domains_are_kept() {
    all_are("undecided", &["sign(0) = 0", "(-8)^(1/3) = -2", "0^(-0.5) = 1", "atan2(0, -1) = pi", "0^n = 0"]);
    let found = outcomes(&["x^n = exp(n*log(x))", "sign(x)^2 = 1"]);
    assert_eq!(
        found.iter().map(|outcome| outcome.domain.join(", ")).collect::<Vec<_>>(),
        ["x > 0", "x != 0"]
    );
}

#[test]
fn messages_write_what_was_written() {
    for text in
        ["abs(x)", "sign(x)", "min(x, y)", "max(x, y)", "sinh(x)", "cosh(x)", "tanh(x)", "atan2(y, x)", "x^n"]
    {
        let found = outcomes(&[&format!("1/({text} - k) = 1/({text} - k)")]);
        assert_eq!(found[0].domain.last().map(String::as_str), Some(format!("{text} - k != 0").as_str()));
    }
}

fn dimensions(claim: &str) -> Result<System, palmistry::ReadError> {
    let text = format!(
        "system \"dimensions\"\nstate x : length, v : velocity\nparam K : length, n : 1, V : length/time, c : length^(1/3)\n\
         drift f x' = V*x^n/(K^n + x^n) v' = 0\noutput x\nclaim 1: {claim}\n"
    );
    System::parse("d.proof", &text, Path::new(""))
}

#[test]
fn dimensions_are_checked() {
    for right in [
        "x^(1/3) + c = c + x^(1/3)",
        "atan2(x, K) + tanh(x/K) = tanh(x/K) + atan2(x, K)",
        "min(x, K) + abs(x) = abs(x) + min(x, K)",
        "x^0.5*x^0.5 = x",
        "x*x^n = K^(n+1)",
        "x^(2*n) = K^n*x^n",
        "(x/K)^n = 1 + (x/K)^n",
        "x^(n/2)*x^(n/2) = K^n",
    ] {
        assert!(dimensions(right).is_ok(), "{right}");
    }
    for (wrong, message) in [
        ("x^x = 1", "an exponent is a number without dimension, not length"),
        ("tanh(x) = 1", "'tanh' takes a number without dimension, not length"),
        ("min(x, v) = x", "'min' of two dimensions: length and length/time"),
        ("atan2(x, v) = 1", "'atan2' of two dimensions: length and length/time"),
        ("x^n + x = x", "terms of two dimensions: length^n + length"),
        ("abs(x) = v", "two sides of two dimensions: length = length/time"),
        ("x^(1/3) = x", "two sides of two dimensions: length^(1/3) = length"),
        ("x^n = K^(n+1)", "two sides of two dimensions: length^n = length*length^n"),
        ("x^n = v^n", "two sides of two dimensions: length^n = length^n/time^n"),
    ] {
        match dimensions(wrong) {
            Ok(_) => panic!("{wrong} is taken"),
            Err(error) => assert!(error.to_string().contains(message), "{wrong}: {error}"),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 120, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever is made of these words is read, or refused with a message.
    #[test]
    fn nothing_panics(parts in proptest::collection::vec(
        proptest::sample::select(vec![
            "abs(", "min(", "max(", "sign(", "tanh(", "sinh(", "cosh(", "atan2(", "x", "y", "n", "^", "^(", "^-", ")", ",", "+", "-",
            "*", "/", "0", "1", "2", "0.5", "1/3", "1001", "(", "=", "[", "]", "exp(", "log(", "sqrt(", "where x > 0", "0^", "d(",
        ]), 1..12)) {
        let text = format!("{DECLARED}claim 1: {}\n", parts.concat());
        if let Ok(system) = System::parse("f.proof", &text, Path::new("")) {
            let _ = decide_all(&system, 1, &false.into(), &|_| ());
        }
    }
}
