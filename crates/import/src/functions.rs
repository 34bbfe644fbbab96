//! The functions of other programs in our language: the same by another name, or made of ours.

use super::expression::{FUNCTIONS, ForeignExpr, ForeignKind, ForeignOrder, Span};
use dashu::rational::RBig;
use palmistry_lang::{Code, Problem};

/// What a foreign function is.
enum Made {
    /// One of ours.
    Ours(&'static str),
    /// Made of ours, of one argument.
    Of(fn(ForeignExpr) -> ForeignExpr),
    /// Made of ours, of two.
    OfTwo(fn(ForeignExpr, ForeignExpr) -> ForeignExpr),
}

fn one(like: &ForeignExpr) -> ForeignExpr {
    ForeignExpr::integer(1, &like.span)
}

fn inverted(x: ForeignExpr) -> ForeignExpr {
    one(&x).over(x)
}

/// `log(x)/log(base)`
fn log_to(x: ForeignExpr, base: i64) -> ForeignExpr {
    let base = ForeignExpr::integer(base, &x.span).under("log");
    x.under("log").over(base)
}

fn to_half(x: ForeignExpr, above: i64) -> ForeignExpr {
    let two = ForeignExpr::integer(2, &x.span);
    x.clone().plus(x.clone().to(two).plus(ForeignExpr::integer(above, &x.span)).under("sqrt")).under("log")
}

/// All names by which some program calls a function, in lower case.
const NAMES: &[(&str, Made)] = &[
    ("ln", Made::Ours("log")),
    ("fabs", Made::Ours("abs")),
    ("fmin", Made::Ours("min")),
    ("fmax", Made::Ours("max")),
    ("arcsin", Made::Ours("asin")),
    ("arccos", Made::Ours("acos")),
    ("arctan", Made::Ours("atan")),
    ("arctan2", Made::Ours("atan2")),
    ("log10", Made::Of(|x| log_to(x, 10))),
    ("log2", Made::Of(|x| log_to(x, 2))),
    ("log1p", Made::Of(|x| one(&x).plus(x).under("log"))),
    (
        "expm1",
        Made::Of(|x| {
            let below = one(&x);
            x.under("exp").minus(below)
        }),
    ),
    (
        "sq",
        Made::Of(|x| {
            let two = ForeignExpr::integer(2, &x.span);
            x.to(two)
        }),
    ),
    (
        "cbrt",
        Made::Of(|x| {
            let third = one(&x).over(ForeignExpr::integer(3, &x.span));
            x.to(third)
        }),
    ),
    ("inv", Made::Of(inverted)),
    ("sech", Made::Of(|x| inverted(x.under("cosh")))),
    ("csch", Made::Of(|x| inverted(x.under("sinh")))),
    ("coth", Made::Of(|x| inverted(x.under("tanh")))),
    ("asec", Made::Of(|x| inverted(x).under("acos"))),
    ("acsc", Made::Of(|x| inverted(x).under("asin"))),
    ("acot", Made::Of(|x| inverted(x).under("atan"))),
    ("arcsec", Made::Of(|x| inverted(x).under("acos"))),
    ("arccsc", Made::Of(|x| inverted(x).under("asin"))),
    ("arccot", Made::Of(|x| inverted(x).under("atan"))),
    ("asinh", Made::Of(|x| to_half(x, 1))),
    ("arcsinh", Made::Of(|x| to_half(x, 1))),
    ("acosh", Made::Of(|x| to_half(x, -1))),
    ("arccosh", Made::Of(|x| to_half(x, -1))),
    ("atanh", Made::Of(area_tangent)),
    ("arctanh", Made::Of(area_tangent)),
    (
        "heaviside",
        Made::Of(|x| {
            let (zero, high, low) =
                (ForeignExpr::integer(0, &x.span), one(&x), ForeignExpr::integer(0, &x.span));
            case(x, ForeignOrder::Greater, zero, high, low)
        }),
    ),
    (
        "hypot",
        Made::OfTwo(|x, y| {
            let two = ForeignExpr::integer(2, &x.span);
            x.to(two.clone()).plus(y.to(two)).under("sqrt")
        }),
    ),
    ("pow", Made::OfTwo(ForeignExpr::to)),
    ("power", Made::OfTwo(ForeignExpr::to)),
    ("times", Made::OfTwo(ForeignExpr::times)),
    ("mtimes", Made::OfTwo(ForeignExpr::times)),
    ("rdivide", Made::OfTwo(ForeignExpr::over)),
    ("plus", Made::OfTwo(ForeignExpr::plus)),
    ("minus", Made::OfTwo(ForeignExpr::minus)),
    ("rational", Made::OfTwo(ForeignExpr::over)),
];

/// `log((1 + x)/(1 - x))/2`
fn area_tangent(x: ForeignExpr) -> ForeignExpr {
    let ratio = one(&x).plus(x.clone()).over(one(&x).minus(x.clone()));
    ratio.under("log").over(ForeignExpr::integer(2, &x.span))
}

/// One of two expressions, by how two others compare.
pub(super) fn case(
    left: ForeignExpr,
    order: ForeignOrder,
    right: ForeignExpr,
    then: ForeignExpr,
    otherwise: ForeignExpr,
) -> ForeignExpr {
    let span = left.span.start.min(then.span.start)..otherwise.span.end.max(right.span.end);
    let values = Box::new((then, otherwise));
    ForeignExpr::new(ForeignKind::Case { sides: Box::new((left, right)), order, values }, &span)
}

/// Whether a name is that of a function that can be read.
pub(super) fn is_function(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    FUNCTIONS.iter().any(|(own, ..)| *own == name) || NAMES.iter().any(|(own, _)| *own == name)
}

/// Whether a name is that of a function of one argument, as programs write it: in small letters, or with a capital in front. In capitals it may
/// be any name.
pub(super) fn takes_one(name: &str) -> bool {
    if name.len() > 1 && name.chars().filter(|c| c.is_uppercase()).count() > 1 {
        return false;
    }
    let name = name.to_ascii_lowercase();
    match NAMES.iter().find(|(own, _)| *own == name) {
        Some((_, Made::Ours(ours))) => FUNCTIONS.iter().any(|(own, least, _)| own == ours && *least == 1),
        Some((_, made)) => matches!(made, Made::Of(_)),
        None => FUNCTIONS.iter().any(|(own, least, _)| *own == name && *least == 1),
    }
}

/// Whether a name by itself is that of a function that everybody knows: a plain `exp` is no parameter.
pub(super) fn names_a_function(name: &str) -> bool {
    const OF_TWO: [&str; 12] =
        ["min", "max", "Min", "Max", "fmin", "fmax", "atan2", "arctan2", "hypot", "pow", "Pow", "Piecewise"];
    takes_one(name) || OF_TWO.contains(&name)
}

/// A function of another program, by its name in whichever case, of its arguments.
pub(super) fn call(name: &str, mut arguments: Vec<ForeignExpr>, span: &Span) -> Result<ForeignExpr, Problem> {
    let small = name.to_ascii_lowercase();
    let count = arguments.len();
    let wrong = |expected: &str| {
        Problem::new(
            Code::Foreign,
            span,
            format!("'{name}' takes {expected}, and has {count} here"),
            "this call",
        )
    };
    // a logarithm to another base is written with two arguments
    if small == "log" && count == 2 {
        let (base, x) = (arguments.pop(), arguments.pop());
        return match (x, base) {
            (Some(x), Some(base)) => Ok(x.under("log").over(base.under("log"))),
            _ => Err(wrong("one argument or two")),
        };
    }
    let made = NAMES.iter().find(|(own, _)| *own == small).map(|(_, made)| made);
    let ours = match made {
        Some(Made::Ours(ours)) => Some(*ours),
        Some(_) => None,
        None => FUNCTIONS.iter().find(|(own, ..)| *own == small).map(|(own, ..)| *own),
    };
    let mut result = match (ours, made) {
        (Some(ours), _) => {
            let (least, most) = FUNCTIONS
                .iter()
                .find(|(own, ..)| *own == ours)
                .map_or((1, 1), |(_, least, most)| (*least, *most));
            match count {
                // the greatest of one thing is that thing
                1 if most > 2 => return arguments.pop().ok_or_else(|| wrong("an argument")),
                _ if count < least || count > most => {
                    let expected = match (least, most) {
                        (1, _) => "one argument",
                        (_, 2) => "two arguments",
                        _ => "two arguments or more",
                    };
                    return Err(wrong(expected));
                }
                _ => ForeignExpr::new(ForeignKind::Call(ours, arguments), span),
            }
        }
        (None, Some(Made::Of(made))) => match (arguments.pop(), count) {
            (Some(x), 1) => made(x),
            _ => return Err(wrong("one argument")),
        },
        (None, Some(Made::OfTwo(made))) => match (arguments.pop(), arguments.pop(), count) {
            (Some(y), Some(x), 2) => made(x, y),
            _ => return Err(wrong("two arguments")),
        },
        (None, _) => {
            let message = format!("the function '{name}' has no counterpart in proof files");
            return Err(Problem::new(Code::Foreign, span, message, "this function").help(
                "what can be read: powers, roots, exp, log, trigonometric and hyperbolic functions and their inverses, abs, sign, min, max",
            ));
        }
    };
    result.span = span.clone();
    Ok(result)
}

/// The numbers that have names in some programs.
pub(super) fn constant(name: &str, span: &Span) -> Option<ForeignExpr> {
    match name {
        "pi" | "π" => Some(ForeignExpr::new(ForeignKind::Pi, span)),
        "E" | "exponentiale" => Some(ForeignExpr::integer(1, span).under("exp")),
        _ => None,
    }
}

/// A fraction, where the denominator is a number other than zero.
pub(super) fn fraction(top: &RBig, bottom: &RBig, span: &Span) -> Option<ForeignExpr> {
    (*bottom != RBig::ZERO).then(|| ForeignExpr::new(ForeignKind::Number(top / bottom), span))
}
