//! Names, derivatives, vectors and equations, however they are printed.

use crate::functions::takes_one;
use crate::script::{Syntax, SyntaxKind, named_function};

/// The name of time where nothing is called so.
pub(super) const TIME: &str = "t";

/// Its other name, as a symbol by itself: `sin(2*pi*time)`.
pub(super) const LONG_TIME: &str = "time";

/// The name of `x(t)`, even where a function is called so.
pub(super) fn signal(syntax: &Syntax) -> Option<String> {
    let SyntaxKind::Call(callee, arguments) = &syntax.kind else { return None };
    let [time] = arguments.as_slice() else { return None };
    symbol(time).filter(|time| time == TIME).and_then(|_| callee.as_name().map(str::to_owned))
}

/// The name of `x`, `x(t)`, `x[1]`, `Symbol('x')` or `Function('x')(Symbol('t'))`.
pub(super) fn symbol(syntax: &Syntax) -> Option<String> {
    match &syntax.kind {
        SyntaxKind::Name(name) => Some(name.clone()),
        SyntaxKind::Index(inner, index) => {
            let inner = inner.as_name()?;
            let index = index.iter().map(|one| match &one.kind {
                SyntaxKind::Number(value) => Some(value.to_string()),
                _ => None,
            });
            Some(format!("{inner}[{}]", index.collect::<Option<Vec<_>>>()?.join(",")))
        }
        SyntaxKind::Call(callee, arguments) => {
            if let (
                Some("Symbol" | "Function" | "Dummy"),
                [Syntax { kind: SyntaxKind::Text(text), .. }, ..],
            ) = (callee.as_name(), arguments.as_slice())
            {
                return Some(text.clone());
            }
            let [time] = arguments.as_slice() else { return None };
            let is_time = symbol(time).is_some_and(|time| time == TIME);
            match &callee.kind {
                // sin(t) is a function of time that everybody knows
                SyntaxKind::Name(name) if is_time && !takes_one(name) => Some(name.clone()),
                SyntaxKind::Call(..) if is_time => symbol(callee),
                _ => None,
            }
        }
        _ => None,
    }
}

/// The state of which this is the rate: `x'`, `dx/dt`, `Derivative(x(t), t)`.
pub(super) fn differentiated(syntax: &Syntax) -> Option<String> {
    match &syntax.kind {
        SyntaxKind::Prime(inner) => symbol(inner),
        // x'(t)
        SyntaxKind::Call(callee, arguments)
            if matches!(callee.kind, SyntaxKind::Prime(_))
                && arguments.len() == 1
                && symbol(&arguments[0])? == TIME =>
        {
            differentiated(callee)
        }
        SyntaxKind::Product(factors) => match factors.as_slice() {
            [(false, above), (true, below)] if below.as_name() == Some("dt") => match &above.kind {
                SyntaxKind::Name(name) => {
                    name.strip_prefix('d').filter(|name| !name.is_empty()).map(str::to_owned)
                }
                SyntaxKind::Index(..) => symbol(above)?.strip_prefix('d').map(str::to_owned),
                _ => None,
            },
            _ => None,
        },
        SyntaxKind::Call(..) => match named_function(syntax)? {
            ("Derivative" | "diff", [inner, time]) => {
                let time = match &time.kind {
                    SyntaxKind::List(pair) => match pair.as_slice() {
                        [time] => time,
                        [time, one] if is_one(one) => time,
                        _ => return None,
                    },
                    _ => match named_function(time) {
                        Some(("Tuple", [time, one])) if is_one(one) => time,
                        _ => time,
                    },
                };
                (symbol(time)? == TIME).then(|| symbol(inner).or_else(|| signal(inner)))?
            }
            _ => None,
        },
        _ => None,
    }
}

/// Whether a left side is a derivative of a higher order, however it is written.
pub(super) fn is_higher_derivative(syntax: &Syntax) -> bool {
    match &syntax.kind {
        SyntaxKind::Prime(inner) => matches!(inner.kind, SyntaxKind::Prime(_)),
        SyntaxKind::Call(callee, _) if matches!(callee.kind, SyntaxKind::Prime(_)) => {
            is_higher_derivative(callee)
        }
        SyntaxKind::Call(_, arguments) => {
            let is_derivative = matches!(named_function(syntax), Some(("Derivative" | "diff", _)));
            let by_pair = || {
                arguments.get(1).is_some_and(|second| {
                    matches!(second.kind, SyntaxKind::List(_) | SyntaxKind::Number(_))
                        || matches!(named_function(second), Some(("Tuple", _)))
                })
            };
            is_derivative && (arguments.len() > 2 || by_pair())
        }
        // d^2x/dt^2, d2x/dt2
        SyntaxKind::Product(factors) => match factors.as_slice() {
            [.., (true, below)] => match &below.kind {
                SyntaxKind::Power(base, _) => base.as_name() == Some("dt"),
                SyntaxKind::Name(name) => {
                    name.strip_prefix("dt").is_some_and(|rest| rest.parse::<u32>().is_ok())
                }
                _ => false,
            },
            _ => false,
        },
        _ => false,
    }
}

fn is_one(syntax: &Syntax) -> bool {
    match &syntax.kind {
        SyntaxKind::Number(value) => value.is_one(),
        SyntaxKind::Call(..) => matches!(named_function(syntax), Some(("Integer", [one])) if is_one(one)),
        _ => false,
    }
}

/// What a list is wrapped in.
const WRAPPERS: [&str; 8] =
    ["Matrix", "ImmutableMatrix", "ImmutableDenseMatrix", "MutableDenseMatrix", "SX", "MX", "DM", "array"];

/// The elements of a vector, however it is printed; none where it is no vector.
pub(super) fn vector(syntax: &Syntax) -> Option<Vec<&Syntax>> {
    match &syntax.kind {
        SyntaxKind::List(list) => {
            Some(list.iter().flat_map(|one| vector(one).unwrap_or_else(|| vec![one])).collect())
        }
        SyntaxKind::Call(..) => match named_function(syntax)? {
            ("vertcat" | "Tuple", list) => {
                Some(list.iter().flat_map(|one| vector(one).unwrap_or_else(|| vec![one])).collect())
            }
            (name, [list, ..]) if WRAPPERS.contains(&name) => vector(list),
            _ => None,
        },
        _ => None,
    }
}

pub(super) fn is_equation(syntax: &Syntax) -> bool {
    matches!(named_function(syntax), Some(("Eq" | "Equality", _)))
        || matches!(syntax.kind, SyntaxKind::Equation(..))
}
