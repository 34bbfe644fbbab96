//! Names and functions of other languages, and how they are written here.

use super::elaborate::Wanted;
use super::error::nearest;
use super::model::System;
use super::vocabulary::functions;
use palmistry_math::expression::syntax::{Expr, ExprKind};

/// What other languages call functions, and what to write.
#[rustfmt::skip]
const FUNCTIONS: &[(&str, &str)] = &[
    ("ln loge", "it is called 'log'"),
    ("log10 lg", "'log' is the natural logarithm: that to base 10 is log(x)/log(10)"),
    ("log2 log_2 ld", "'log' is the natural logarithm: that to base 2 is log(x)/log(2)"),
    ("arcsin", "it is called 'asin'"),
    ("arccos", "it is called 'acos'"),
    ("arctan", "it is called 'atan'"),
    ("arctan2", "it is called 'atan2'"),
    ("sgn signum", "it is called 'sign'"),
    ("fabs", "it is called 'abs'"),
    ("tg", "it is called 'tan'"),
    ("ctg cotan", "it is called 'cot'"),
    ("cosec", "it is called 'csc'"),
    ("sind cosd tand", "angles are in radians: write sin(x*pi/180)"),
    ("pow power", "a power is written with '^', as in x^2"),
    ("sqr square", "a square is written x^2, a root sqrt(x)"),
    ("cbrt root nthroot", "a root is a power, as in x^(1/3)"),
    ("asinh arsinh arcsinh", "it is written log(x + sqrt(x^2 + 1))"),
    ("acosh arcosh arccosh", "it is written log(x + sqrt(x^2 - 1))"),
    ("atanh artanh arctanh", "it is written log((1 + x)/(1 - x))/2"),
    ("heaviside step piecewise ifelse where iif", "there is no 'if': write max(a, b), min(a, b), abs(a) or sign(a), or a claim for each case with 'where'"),
    ("sat saturate clip clamp limit", "limits are written max(0, min(1, x))"),
    ("arg angle phase", "the angle of the point (x, y) is atan2(y, x)"),
    ("norm hypot", "a norm is written sqrt(dot(v, v))"),
    ("int integral integrate", "an integral is a state of its own, as in z' = x"),
    ("diff derivative grad gradient jacobian der D", "a differential is written d(e, x), the row of all derivatives d(e), a derivative along the drift L(f, x)"),
    ("prod", "it is called 'product', as in product(i in 1..3, x[i])"),
    ("inv", "an inverse is written inverse(M)"),
    ("subs eval", "the value at a point is written x at {x = 1, y = 2}"),
    ("ad lie lie_bracket liebracket", "the Lie bracket is written bracket(f, g)"),
    ("Lf L_f L_g Lg lie_derivative", "a Lie derivative is written L(f, x), the second one L(f, f, x)"),
    ("trace eye eig eigenvalues zeros ones diag Matrix matrix I", "there is no such function of matrices: write the matrix, as in [1, 0; 0, 1]; there are det, rank, inverse, transpose, dot and cross"),
    ("O Obs obsv", "the rank of the system is rank = 4, of its first Lie derivatives rank(codistribution(2)) = 4"),
    ("mod floor ceil round erf gamma factorial delta", NONE_SUCH),
];

const NONE_SUCH: &str = "there is no such function; there are sqrt, exp, log, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, abs, sign, min, max and atan2";

/// How functions of the language are called, those that are no functions of one number.
#[rustfmt::skip]
const CALLS: &[(&str, &str)] = &[
    ("L", "L(f, x), the second Lie derivative as in L(f, f, x)"),
    ("bracket", "bracket(f, g)"),
    ("d", "d(e), or d(e, x)"),
    ("det", "det([a, b; c, d])"),
    ("rank", "rank([d(x); d(L(f, x))]) = 2; the rank of the system is rank = 4"),
    ("transpose", "transpose([a, b; c, d])"),
    ("inverse", "inverse([a, b; c, d])"),
    ("dot", "dot([a; b], [c; d])"),
    ("cross", "cross([a; b; c], [d; e; f])"),
    ("sum", "sum(i in 1..3, x[i])"),
    ("product", "product(i in 1..3, x[i])"),
    ("pole", "pole(1/x, x) = 1"),
    ("solutions", "solutions(a) = 1"),
    ("codistribution", "rank(codistribution(2)) = 4"),
    ("observable", "observable(x, y)"),
    ("unobservable", "unobservable(x)"),
    ("identifiable", "identifiable(a, b)"),
    ("unidentifiable", "unidentifiable(a)"),
    ("min", "min(x, 0)"),
    ("max", "max(x, 0)"),
    ("atan2", "atan2(y, x), the angle of the point (x, y)"),
    ("atan", "atan(x); the angle of the point (x, y) is atan2(y, x)"),
    ("log", "log(x), the natural logarithm; that to base 10 is log(x)/log(10)"),
];

fn of<'t>(table: &[(&str, &'t str)], name: &str) -> Option<&'t str> {
    table.iter().find(|(names, _)| names.split(' ').any(|one| one == name)).map(|(_, advice)| *advice)
}

/// How a function of the language is called.
pub(super) fn call_of(name: &str) -> String {
    match of(CALLS, name) {
        Some(call) => format!("as in {call}"),
        None => format!("as in {name}(x)"),
    }
}

impl System {
    /// What to write for a function that is none.
    pub(super) fn advice_for_function(&self, name: &str, arguments: &[Expr]) -> String {
        let known = |wanted: &str| functions().find(|function| *function == wanted);
        if let Some(own) = name.rsplit_once('.').and_then(|(_, own)| known(own)) {
            return format!("it is called '{own}' alone");
        }
        if let Some(own) = known(&name.to_lowercase()).filter(|own| *own != name) {
            return format!("it is written in small letters, '{own}'");
        }
        let is_value = self.find_symbol(name).is_some() || self.definitions.contains_key(name);
        if let [Expr { kind: ExprKind::Name(time), .. }] = arguments
            && time == "t"
            && self.find_symbol("t").is_none()
        {
            return match is_value {
                true => format!("it is written {name} where it is used, without (t)"),
                false => format!(
                    "a signal is declared, 'known {name}(t)' or 'unknown {name}(t)', and written {name} where it is used"
                ),
            };
        }
        if self.field(name).is_some() {
            return format!("'{name}' is a field: its component of x is the Lie derivative L({name}, x)");
        }
        if is_value {
            return format!("'{name}' is no function: a product is written with '*', as in {name}*(...)");
        }
        if let Some(advice) = of(FUNCTIONS, name) {
            return advice.to_owned();
        }
        match nearest(name, functions().filter(|function| function.len() > 1)) {
            Some(near) => format!("perhaps you meant '{near}'"),
            None => format!(
                "functions are not defined: an expression has a name by let {name} = ..., and is written {name} alone; a product is written with '*'"
            ),
        }
    }

    /// What a name means in other languages, and how that is written here.
    pub(super) fn habit(&self, name: &str, wanted: Wanted) -> Option<String> {
        let is_function = functions().any(|function| function == name);
        let base = name.split(['\'', '@']).next().unwrap_or(name);
        match (name, wanted) {
            (_, Wanted::State) if name.contains('\'') => {
                Some(format!("a second derivative needs a state of its own, as in {base}' = v and v' = ..."))
            }
            (_, Wanted::Name | Wanted::Symbol) if base != name && self.find_symbol(base).is_some() => {
                Some(match name.contains('@') {
                    true => format!(
                        "the state in the second experiment is {base}@2, below 'experiments 2'; constants are the same in all"
                    ),
                    false => format!(
                        "perhaps you meant '{base}': a derivative of a state along the drift f is L(f, {base})"
                    ),
                })
            }
            ("dt" | "Dt", Wanted::Name) => {
                Some("a derivative along the drift f is L(f, x), as in let v = L(f, x)".to_owned())
            }
            (_, Wanted::Name) if rate_of(name).is_some_and(|state| self.find_symbol(state).is_some()) => {
                let state = rate_of(name).unwrap_or_default();
                Some(format!("the rate of '{state}' has no name: below the drift f it is L(f, {state})"))
            }
            ("e", Wanted::Name) => Some("Euler's number to a power is written exp(x)".to_owned()),
            ("i" | "j", Wanted::Name) => Some(format!(
                "'{name}' has no value: numbers are real, and an index has its range behind 'for'"
            )),
            ("inf" | "Inf" | "oo", Wanted::Name) => Some("it is called 'infinity'".to_owned()),
            ("t" | "time", Wanted::Name) => Some(
                "time has no name: what depends on it is a signal, known u(t), or a state with the rate 1"
                    .to_owned(),
            ),
            ("full", Wanted::Name) => Some("full rank is the number of unknowns, as in rank = 3".to_owned()),
            ("all", Wanted::Name) => Some("name the unknowns, as in observable(x, y)".to_owned()),
            ("known" | "unknown", Wanted::Name) => {
                Some(format!("the word stands behind a constant, as in param k {name}"))
            }
            ("sin" | "cos" | "tan", Wanted::Name) => Some(format!(
                "a function has its argument in brackets at once, as in {name}(x)^2; its inverse is a{name}(x)"
            )),
            (_, Wanted::Name) if of(CALLS, name).is_some() => Some(call_of(name)),
            (_, Wanted::Name) if is_function => {
                Some(format!("a function has its argument in brackets at once, as in {name}(x)^2"))
            }
            _ => None,
        }
    }
}

/// The state of a name such as `omega_dot`.
fn rate_of(name: &str) -> Option<&str> {
    name.strip_suffix("_dot").or_else(|| name.strip_suffix("dot")).filter(|state| !state.is_empty())
}
