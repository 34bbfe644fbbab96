//! What is known of exponentials, sines, roots, logarithms and inverse functions: laws that any handbook has are proved, near misses
//! are not, and what holds on part of a domain is proved only where that part is said.
//!
//! Laws: M. Abramowitz and I. Stegun, *Handbook of Mathematical Functions*, chapters 4.1 to 4.4; values at parts of pi from
//! table 4.3.46; J. Machin's sum of 1706; Gauss's cosine of a seventeenth of a turn.

use palmistry::{Outcome, System, decide_all};
use std::path::Path;

/// `x`, `y`, `z` are numbers, `phi` and `psi` angles.
const DECLARED: &str = "system \"functions\"\nstate x, y, z, phi, psi\nparam k\nangle phi, psi\n";

fn outcomes(statements: &[&str], seed: u64) -> Vec<Outcome> {
    let mut text = DECLARED.to_owned();
    for (place, statement) in statements.iter().enumerate() {
        text.push_str(&format!("claim c{place}: {statement}\n"));
    }
    let system = System::parse("functions.proof", &text, Path::new("")).expect("the statements are read");
    decide_all(&system, seed, &false.into(), &|_| ())
}

fn all_are(words: &[&str], statements: &[&str]) {
    assert!(!statements.is_empty());
    for seed in [1, 2] {
        let found = outcomes(statements, seed);
        assert_eq!(found.len(), statements.len());
        let wrong: Vec<_> = found
            .iter()
            .filter(|outcome| !words.contains(&outcome.verdict.word()))
            .map(|outcome| (&outcome.statement, &outcome.verdict))
            .collect();
        assert!(wrong.is_empty(), "expected one of {words:?}: {wrong:#?}");
    }
}

#[test]
fn laws_are_proved() {
    all_are(
        &["proved"],
        &[
            "sin(x)^2 + cos(x)^2 = 1",
            "sin(pi/6) = 1/2",
            "asin(x) + acos(x) = pi/2",
            "sqrt(z)*k*sqrt(z) = k*z",
            "exp(x+y) = exp(x)*exp(y)",
            "log(x^2) = 2*log(x)",
            "sin(x/2)^2 = (1-cos(x))/2",
            "sin(phi/2)^2 = (1-cos(phi))/2",
            "cos(pi/4) = sqrt(2)/2",
            "cos(pi/5) = (1+sqrt(5))/4",
            "sqrt(2)*sqrt(3) = sqrt(6)",
            "sqrt(8) = 2*sqrt(2)",
            "sqrt(3+2*sqrt(2)) = 1+sqrt(2)",
            "log(x*y) = log(x)+log(y)",
            "sqrt(x*y) = sqrt(x)*sqrt(y)",
            "sin(asin(x)) = x",
            "cos(asin(x)) = sqrt(1-x^2)",
            "exp(log(x)) = x",
            "log(exp(x)) = x",
            "sqrt(exp(2*x)) = exp(x)",
            "tan(x) = sin(x)/cos(x)",
            "sin(3*x) = 3*sin(x) - 4*sin(x)^3",
            "sin(x+pi/3) = sin(x)/2 + sqrt(3)/2*cos(x)",
            "cos(pi/7)*cos(2*pi/7)*cos(3*pi/7) = 1/8",
            "4*atan(1/5) - atan(1/239) = pi/4",
            "atan(1) = pi/4",
            "asin(sqrt(2)/2) = pi/4",
            "acos(-1/2) = 2*pi/3",
            "exp(x/2)*exp(x/3) = exp(5*x/6)",
            "exp(log(x)/2) = sqrt(x)",
            "sqrt(x^4) = x^2",
            "tan(atan(x)) = x",
            "cos(atan(x)) = 1/sqrt(1+x^2)",
            "asin(x) = atan(x/sqrt(1-x^2))",
            "atan(x) + atan(1/x) - pi/2 = 0*sqrt(x)",
            "2*atan(x) = asin(2*x/(1+x^2)) + 0*asin(x)",
            "sqrt(1-x)*sqrt(1+x) = sqrt(1-x^2)",
            "x*sin(x)^2 + x*cos(x)^2 = x",
            "phi*sin(phi)^2 + phi*cos(phi)^2 = phi",
            "(sin(1)^2+cos(1)^2)*x = x",
            "((exp(x)+exp(-x))/2)^2 - ((exp(x)-exp(-x))/2)^2 = 1",
            "log(8) = 3*log(2)",
            "log(6) = log(2)+log(3)",
            "log(sqrt(x)) = log(x)/2",
            "exp(2*log(x)) = x^2",
            "exp(exp(x/2)) = exp(exp(x/4)^2)",
            "sin(2*x*y) = 2*sin(y*x)*cos(x*y)",
            "sin((x+1)^2) = sin(x^2+2*x+1)",
            "sqrt(sqrt(x)) = exp(log(x)/4)",
            "sqrt(5+2*sqrt(6)) = sqrt(2)+sqrt(3)",
            "cos(pi/8) = sqrt(2+sqrt(2))/2",
            "sin(pi/12) = (sqrt(6)-sqrt(2))/4",
            "sin(pi/5)*sin(2*pi/5) = sqrt(5)/4",
            "sin(acos(x)) = sqrt(1-x^2)",
            "acos(x) + acos(-x) = pi",
            "atan(-x) = -atan(x)",
            "16*atan(1/5) - 4*atan(1/239) = pi",
            "log(x/y) = log(x)-log(y)",
            "sqrt(x/y) = sqrt(x)/sqrt(y)",
            "sqrt(x^2+2*x*y+y^2) = x+y + 0*sqrt(x+y)",
            "tan(pi/8) = sqrt(2)-1",
            "sin(pi/10) = (sqrt(5)-1)/4",
            "cos(2*pi/17)*0+cos(pi/3) = 1/2",
            "atan(1/2)+atan(1/3) = pi/4",
            "sqrt(x+sqrt(x)) * sqrt(x+sqrt(x)) * z = z*(x+sqrt(x))",
            "exp(1)*exp(x) = exp(x+1)",
            "exp(1/2)^2 = exp(1)",
            "cos(x)*cos(y) = (cos(x-y)+cos(x+y))/2",
        ],
    );
}

#[test]
fn laws_of_several_functions_are_proved() {
    all_are(
        &["proved"],
        &[
            "sqrt(x^2+y^2)*sqrt(x^2+y^2) = x^2+y^2",
            "sqrt(x)/x = 1/sqrt(x)",
            "exp(log(x)/3)^3 = x",
            "log((x+1)*(x+2)) = log(x+1)+log(x+2)",
            "log(x^2+2*x+1) = 2*log(x+1)",
            "asin(1/3) + acos(1/3) = pi/2",
            "sin(2*asin(x)) = 2*x*sqrt(1-x^2)",
            "sin(asin(x)/2)^2 = (1-sqrt(1-x^2))/2",
            "tan(atan(x)/2) = x/(1+sqrt(1+x^2))",
            "atan(x) - atan(y) = asin((x-y)/sqrt((1+x^2)*(1+y^2))) + 0*sqrt(x) + 0*sqrt(y)",
            "acos(x) = 2*asin(sqrt((1-x)/2))",
            "acos(x) = 2*atan(sqrt((1-x)/(1+x)))",
            "asin(x) = 2*atan(x/(1+sqrt(1-x^2)))",
            "sin(pi*x + pi) = -sin(pi*x)",
            "sin(x*sqrt(2))^2+cos(sqrt(2)*x)^2 = 1",
            "cos(pi/17)*cos(2*pi/17)*cos(4*pi/17)*cos(8*pi/17) = sin(16*pi/17)/(16*sin(pi/17))",
            "sqrt(2+sqrt(2+sqrt(2))) = 2*cos(pi/16)",
            "1/(sqrt(2)+sqrt(3)) = sqrt(3)-sqrt(2)",
            "log(4)/log(2) = 2",
            "sqrt(exp(x)) = exp(x/2)",
            "sqrt(x)^3 = x*sqrt(x)",
            "sqrt(pi)^2 = pi",
            "log(pi^2) = 2*log(pi)",
            "sqrt(2*pi)/sqrt(pi) = sqrt(2)",
            "atan(exp(x)) + atan(exp(-x)) = pi/2",
            "log(cos(x)^2) = 2*log(cos(x))",
            "log(sqrt(x^2+1)+x) = -log(sqrt(x^2+1)-x)",
            "log((1+x)/(1-x)) = log(1+x)-log(1-x)",
            "sqrt(12) + sqrt(27) = 5*sqrt(3)",
            "sqrt(4+2*sqrt(3))*x = x+sqrt(3)*x",
            "cos(pi/24)*x = x*sqrt(2+sqrt(2+sqrt(3)))/2",
            "sin(pi/7)*x*sin(2*pi/7)*sin(3*pi/7) = x*sqrt(7)/8",
            "sin(10*x)^2+cos(10*x)^2 = 1",
            "cos(100*x) = 2*cos(50*x)^2-1",
            "exp(100*x) = exp(50*x)^2",
            "sqrt(1-sin(x)^2)*sqrt(1-sin(x)^2) = cos(x)^2",
            "sqrt(exp(x)+2+exp(-x)) = exp(x/2)+exp(-x/2)",
            "sqrt(x^4+2*x^2+1) = x^2+1",
        ],
    );
}

#[test]
fn roots_of_sums_are_taken_apart() {
    all_are(
        &["proved"],
        &[
            "sqrt(x+sqrt(x^2-1)) = sqrt((x+1)/2)+sqrt((x-1)/2)",
            "sqrt((x*(1-y))^3) = (x*(1-y))*sqrt((x*(1-y)))",
            "sqrt((x*(1-y))^6) = (x*(1-y))^3 + 0*sqrt((x*(1-y)))",
            "sqrt(x+2*sqrt(x*y)+y) = sqrt(x)+sqrt(y)",
            "sqrt(sin(x)^3)*log(sqrt(sin(x))) = sin(x)*sqrt(sin(x))*log(sin(x))/2",
        ],
    );
}

#[test]
fn near_misses_are_refuted() {
    all_are(
        &["refuted"],
        &[
            "sqrt(x^2) = x",
            "asin(sin(x)) = x",
            "atan(tan(x)) = x",
            "acos(cos(x)) = x",
            "2*atan(x) = asin(2*x/(1+x^2))",
            "atan(x) + atan(1/x) = pi/2",
            "sqrt(1-sin(x)^2) = cos(x)",
            "log(x^2) = 2*log(x) + 1/1000000",
            "sin(x)^2 + cos(x)^2 = 1 + x/1000000",
            "exp(x+y) = exp(x)+exp(y)",
            "sin(pi/6) = 1/3",
            "cos(pi/5) = (1-sqrt(5))/4",
            "sqrt(2)*sqrt(3) = sqrt(5)",
            "sqrt(3+2*sqrt(2)) = 1-sqrt(2)",
            "sqrt(3-2*sqrt(2)) = 1-sqrt(2)",
            "log(x+y) = log(x)+log(y)",
            "4*atan(1/5) - atan(1/239) = pi/3",
            "4*atan(1/5) - atan(1/238) = pi/4",
            "atan(2)+atan(3) = -pi/4",
            "atan(1)+atan(2)+atan(3) = 0",
            "x/sqrt(x^2) = 1",
            "sqrt(x)*sqrt(x) = x + 1/1000",
            "sqrt(x^2*y) = x*sqrt(y)",
            "sqrt(x^6) = x^3",
            "exp(log(x^2)/2) = x",
            "sqrt(x+sqrt(x)) = -sqrt(x+sqrt(x)) ",
            "sqrt(x+1)*sqrt(x+1) = -(x+1)",
            "sqrt(5-2*sqrt(6)) = sqrt(2)-sqrt(3)",
            "tan(x/2) = (1-cos(x))/sin(x) + 1/1000",
            "log(6) = log(2)+log(5)",
            "exp(pi*sqrt(163)) = 262537412640768744",
            "pi = 355/113",
            "atan(x)+atan(y) = atan((x+y)/(1-x*y))",
            "asin(2*x) = 2*asin(x)",
            "2*acos(x) = acos(2*x^2-1)",
            "sqrt(sin(x)^2) = sin(x)",
            "sqrt((x-1)^2) = x - 1 + 0*sqrt(x)",
            "log(exp(x)^2) = x",
            "sqrt(x^2+1) = x",
        ],
    );
}

/// The first two fail where x = 0 and y < 0 alone, the third beyond half a turn.
#[test]
fn what_fails_on_few_states_is_not_proved() {
    all_are(
        &["undecided", "refuted"],
        &[
            "sqrt(y^2) + 0*sqrt(x) + 0*sqrt(x*y) = y",
            "sqrt(y^2) + 0*sqrt(x^2*y) = y",
            "cos(x/2) = sqrt((1+cos(x))/2)",
        ],
    );
}

#[test]
fn a_tolerance_may_be_met_with_equality() {
    all_are(
        &["proved"],
        &[
            "1/2 = 1/3 within 1/6",
            "sqrt(2) = 0 within sqrt(2)",
            "pi = 3 within pi - 3",
            "sqrt(2)*sqrt(3) = sqrt(6) within 0",
            "sin(1)^2 + cos(1)^2 = 1 within 0",
            "exp(1) = 2 within exp(1) - 2",
            "0 = sqrt(3) within sqrt(12)/2",
            "(sin(x) at {x = 1}) = 0 within sin(1)",
        ],
    );
}

#[test]
fn a_tolerance_that_is_missed_is_not_met() {
    all_are(
        &["refuted"],
        &[
            "1/2 = 1/3 within 1/7",
            "sqrt(2) = 0 within sqrt(3)-1",
            "pi = 3 within pi - 31/10",
            "sin(1)^2+cos(1)^2 = 1 + 1/10^40 within 0",
            "sqrt(2) = 0 within -sqrt(2)",
        ],
    );
}

#[test]
fn conditions_on_sines_are_solved() {
    all_are(
        &["proved"],
        &[
            "cos(phi)^2 = 1/2 where cos(2*phi) = 0",
            "sin(phi)^2 = 1/4 where sin(phi) = 1/2",
            "cos(phi)^2 = 3/4 where sin(phi) = 1/2",
            "cos(phi) = 0 where cos(phi/2)^2 = 1/2",
            "sin(phi) = 0 where sin(phi/2) = 0",
            "sin(3*phi) = 1 where sin(phi) = 1/2",
            "sin(2*phi+psi)^2 = 1 where cos(2*phi+psi) = 0",
            "sin(phi)^2 = 8/9 where cos(phi) = 1/3",
            "cos(2*phi) = -7/9 where cos(phi) = 1/3",
            "x = 2 where exp(x) = exp(2)",
            "x = log(3) where exp(x) = 3",
            "x = exp(2) where log(x) = 2",
            "y = 1 where (x^2+1)*y = x^2+1",
            "y = 2 where sin(x)^2*y + cos(x)^2*y = 2",
            "x*y = y*x where sqrt(2)*sqrt(3) = sqrt(6)",
            "sin(phi)*(2*sin(phi) - 1) = 0 where 2*sin(phi)^2 = sin(phi)",
            "sin(4*phi) = 0 where sin(2*phi)^2 = 1",
        ],
    );
}

#[test]
fn all_branches_of_a_sine_count() {
    all_are(
        &["refuted"],
        &[
            "cos(phi) = sqrt(3)/2 where sin(phi) = 1/2",
            "sin(phi) = 1 where cos(2*phi) = 0",
            "sin(phi) = sqrt(2)/2 where cos(2*phi) = 0",
            "sin(phi) = sqrt(8)/3 where cos(phi) = 1/3",
            "cos(phi) = 1 where sin(phi/2)^2 = 1",
            "x = 0 where sin(x)^2 + cos(x)^2 = 1",
            "cos(phi) = 1 where cos(3*phi) = 1",
            "sin(phi+psi) = 1 where sin(2*phi+2*psi) = 0",
        ],
    );
}

/// Or of what is met nowhere.
#[test]
fn what_turns_tell_apart_is_not_said() {
    all_are(
        &["undecided"],
        &[
            "cos(phi/2) = 1 where cos(phi) = 1",
            "phi = 0 where sin(phi) = 0",
            "x = 0 where sin(phi/2) = 0, x = phi",
            "x = 0 where sqrt(2)*sqrt(3) = sqrt(5)",
            "x = 0 where cos(phi) = sqrt(2)",
            "x = 0 where cos(phi/2) = 1, cos(phi/3) = 1",
            "x = 0 where cos(phi) = 1/2, cos(phi/2) = 1",
        ],
    );
}

#[test]
fn what_holds_on_a_part_of_the_domain_is_proved_there() {
    all_are(
        &["proved"],
        &[
            "atan(x) + atan(1/x) = pi/2 where x > 0",
            "atan(x) + atan(1/x) = -pi/2 where x < 0",
            "sqrt(x^2) = x where x >= 0",
            "sqrt(x^2) = -x where x <= 0",
            "log(x^2) = 2*log(-x) where x < 0",
            "2*atan(x) = asin(2*x/(1+x^2)) where x >= -1, x <= 1",
            "log(x^2) = 2*log(x) where x > 0",
            "sqrt((x-y)^2) = x-y where x >= y",
            "exp(log(x^2)/2) = x where x > 0",
            "2*asin(x) = acos(1-2*x^2) where x >= 0",
            "acos(2*x^2-1) = 2*acos(x) where x >= 0",
            "atan(x)+atan(y) = atan((x+y)/(1-x*y)) where x*y < 1, x > 0, y > 0",
            "sqrt(x^2*y) = x*sqrt(y) where x > 0",
            "sqrt(x^2*y) = -x*sqrt(y) where x < 0",
            "sqrt(1-sin(x)^2) = cos(x) where cos(x) >= 0",
        ],
    );
    all_are(
        &["undecided", "refuted"],
        &[
            "atan(x) + atan(1/x) = pi/2 where x < 0",
            "sqrt(x^2) = x where x <= 0",
            "2*atan(x) = asin(2*x/(1+x^2)) where x >= 1/2",
            "2*asin(x) = acos(1-2*x^2) where x <= 1/2",
            "sqrt(x^2*y) = x*sqrt(y) where x^2*y >= 0",
            "atan(x)+atan(y) = atan((x+y)/(1-x*y)) where x*y > 1",
        ],
    );
}
