//! Foreign expressions in our language, exactly, with no more brackets than it takes.

use super::expression::{ForeignExpr, ForeignKind, ForeignOrder};
use super::names::ForeignNames;
use dashu::base::Sign;
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};

/// How strongly what is written holds together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Sum,
    Product,
    Power,
    Primary,
}

/// The text of an expression without cases.
pub(super) fn text(
    expression: &ForeignExpr,
    names: &ForeignNames,
    budget: &Budget,
) -> Result<String, Problem> {
    if expression.depth() > super::expression::DEEPEST * 2 {
        let problem = Problem::new(Code::Foreign, &expression.span, "this is nested too deeply", "this");
        return Err(problem.help("give inner parts names of their own"));
    }
    let text = written(expression, names)?.0;
    budget.bytes(text.len()).map_err(|spent| super::too_much(&expression.span, spent))?;
    Ok(text)
}

fn written(expression: &ForeignExpr, names: &ForeignNames) -> Result<(String, Binding), Problem> {
    Ok(match &expression.kind {
        ForeignKind::Number(value) => number(value),
        ForeignKind::Pi => ("pi".to_owned(), Binding::Primary),
        ForeignKind::Name(name) => (names.ours(name).to_owned(), Binding::Primary),
        // a sum of one is that one
        ForeignKind::Sum(terms) if matches!(terms.as_slice(), [(false, _)]) => written(&terms[0].1, names)?,
        ForeignKind::Sum(terms) => {
            let mut out = String::new();
            for (at, (subtracted, term)) in terms.iter().enumerate() {
                let (text, binding) = written(term, names)?;
                // a minus in front of a term is the sign of the term
                let (text, negative) = match text.strip_prefix('-') {
                    Some(rest) if binding >= Binding::Product => (rest.to_owned(), !*subtracted),
                    // adding to a sum changes nothing in it
                    _ if binding == Binding::Sum && (at > 0 || *subtracted) => {
                        (format!("({text})"), *subtracted)
                    }
                    _ => (text, *subtracted),
                };
                match (at, negative) {
                    (0, false) => {}
                    (0, true) => out.push('-'),
                    (_, false) => out.push_str(" + "),
                    (_, true) => out.push_str(" - "),
                }
                out.push_str(&text);
            }
            // one term with a minus is a product, as far as brackets are concerned
            let binding = if terms.len() == 1 { Binding::Product } else { Binding::Sum };
            (out, binding)
        }
        ForeignKind::Product(factors) => {
            let (mut out, mut negative) = (String::new(), false);
            // where the last factor begins, if it is a power
            let mut power = None;
            let is_one = |factor: &ForeignExpr| {
                factor.as_number().is_some_and(|n| *n == RBig::ONE || *n == RBig::from(-1))
            };
            for (divided, factor) in factors {
                // a factor of minus one is a sign
                if is_one(factor) && factors.iter().any(|(divided, other)| !divided && !is_one(other)) {
                    negative ^= factor.as_number().is_some_and(|n| *n != RBig::ONE);
                    continue;
                }
                let at = out.len();
                let (text, binding) = written(factor, names)?;
                let (text, binding) = match text.strip_prefix('-') {
                    Some(rest) if binding == Binding::Product => {
                        negative = !negative;
                        (rest.to_owned(), binding)
                    }
                    _ => (text, binding),
                };
                // what is divided by holds together; a product in front or behind a factor is one with it
                let brackets = binding == Binding::Sum || *divided && binding <= Binding::Product;
                let text = if brackets { format!("({text})") } else { text };
                // a^1/2 would be read as the power one half by some, and is refused
                if let Some(from) =
                    power.take().filter(|_| *divided && text.starts_with(|c: char| c.is_ascii_digit()))
                {
                    out.insert(from, '(');
                    out.push(')');
                }
                match (at, divided) {
                    (0, false) => {}
                    (0, true) => out.push_str("1/"),
                    (_, false) => out.push('*'),
                    (_, true) => out.push('/'),
                }
                power = (binding == Binding::Power).then_some(out.len());
                out.push_str(&text);
            }
            (format!("{}{out}", if negative { "-" } else { "" }), Binding::Product)
        }
        ForeignKind::Power(base, exponent) => {
            let (base, holds) = written(base, names)?;
            // a power of ten in a number is not told from a name behind a number there
            let is_plain = |text: &str, holds| {
                holds == Binding::Primary
                    && !(text.starts_with(|c: char| c.is_ascii_digit()) && text.contains('e'))
            };
            let base = if is_plain(&base, holds) { base } else { format!("({base})") };
            let (exponent, holds) = written(exponent, names)?;
            let exponent = if is_plain(&exponent, holds) { exponent } else { format!("({exponent})") };
            (format!("{base}^{exponent}"), Binding::Power)
        }
        ForeignKind::Call(name, arguments) => {
            let list = arguments
                .iter()
                .map(|one| Ok(written(one, names)?.0))
                .collect::<Result<Vec<_>, Problem>>()?;
            (format!("{name}({})", list.join(", ")), Binding::Primary)
        }
        ForeignKind::Case { .. } => {
            return Err(Problem::new(
                Code::Foreign,
                &expression.span,
                "these cases cannot be written",
                "this",
            ));
        }
    })
}

/// An exact number: a decimal where it is a short one, else a fraction.
fn number(value: &RBig) -> (String, Binding) {
    let negative = value.sign() == Sign::Negative;
    let size = if negative { -value } else { value.clone() };
    let (text, binding) = match decimal(&size) {
        Some(text) => (text, Binding::Primary),
        None => (format!("{}/{}", size.numerator(), size.denominator()), Binding::Product),
    };
    if negative { (format!("-{text}"), Binding::Product) } else { (text, binding) }
}

/// A number that is not negative in digits, with a point or a power of ten, if it has no more than some.
fn decimal(value: &RBig) -> Option<String> {
    if value.is_int() {
        let digits = value.numerator().to_string();
        let significant = digits.trim_end_matches('0');
        return Some(match digits.len() - significant.len() {
            zeros if zeros > 6 && significant.len() < 20 => format!("{significant}e{zeros}"),
            _ => digits,
        });
    }
    // the denominator is 2^a 5^b
    let (mut rest, mut twos, mut fives) = (value.denominator().clone(), 0_usize, 0_usize);
    let (two, five) = (UBig::from(2_u8), UBig::from(5_u8));
    while (&rest % &two) == UBig::ZERO && twos < 4096 {
        rest /= &two;
        twos += 1;
    }
    while (&rest % &five) == UBig::ZERO && fives < 4096 {
        rest /= &five;
        fives += 1;
    }
    if rest != UBig::ONE {
        return None;
    }
    let places = twos.max(fives);
    let scaled = value * RBig::from(IBig::from(10).pow(places));
    let digits = scaled.numerator().to_string();
    Some(if digits.len() > places {
        format!("{}.{}", &digits[..digits.len() - places], &digits[digits.len() - places..])
    } else if places <= 6 {
        format!("0.{}{digits}", "0".repeat(places - digits.len()))
    } else {
        // the point behind the first digit
        let (first, rest) = digits.split_at(1);
        let point = if rest.is_empty() { "" } else { "." };
        format!("{first}{point}{rest}e-{}", places + 1 - digits.len())
    })
}

/// Whether two expressions are written alike.
pub(super) fn same(one: &ForeignExpr, other: &ForeignExpr) -> bool {
    let parts = |list: &[(bool, ForeignExpr)], others: &[(bool, ForeignExpr)]| {
        list.len() == others.len() && list.iter().zip(others).all(|((a, x), (b, y))| a == b && same(x, y))
    };
    match (&one.kind, &other.kind) {
        (ForeignKind::Sum(a), ForeignKind::Sum(b)) | (ForeignKind::Product(a), ForeignKind::Product(b)) => {
            parts(a, b)
        }
        (ForeignKind::Power(a, x), ForeignKind::Power(b, y)) => same(a, b) && same(x, y),
        (ForeignKind::Call(f, a), ForeignKind::Call(g, b)) => {
            f == g && a.len() == b.len() && a.iter().zip(b).all(|(x, y)| same(x, y))
        }
        (ForeignKind::Number(a), ForeignKind::Number(b)) => a == b,
        (ForeignKind::Name(a), ForeignKind::Name(b)) => a == b,
        (ForeignKind::Pi, ForeignKind::Pi) => true,
        _ => false,
    }
}

/// Whether one expression is the other with a minus.
fn opposite(one: &ForeignExpr, other: &ForeignExpr) -> bool {
    let negated = |a: &ForeignExpr, b: &ForeignExpr| match &a.kind {
        ForeignKind::Sum(terms) => matches!(terms.as_slice(), [(true, only)] if same(only, b)),
        ForeignKind::Product(factors) => {
            matches!(factors.as_slice(), [(false, minus), (false, only)]
                if minus.as_number() == Some(&RBig::from(-1)) && same(only, b))
        }
        _ => false,
    };
    negated(one, other) || negated(other, one)
}

/// The sides of a comparison, the one first that is greater where it holds.
fn high_and_low(sides: &(ForeignExpr, ForeignExpr), order: ForeignOrder) -> (&ForeignExpr, &ForeignExpr) {
    match order {
        ForeignOrder::Greater | ForeignOrder::AtLeast => (&sides.0, &sides.1),
        ForeignOrder::Less | ForeignOrder::AtMost => (&sides.1, &sides.0),
    }
}

fn is_zero(one: &ForeignExpr) -> bool {
    one.as_number() == Some(&RBig::ZERO)
}

/// A case by `abs`, `min` or `max`, in which each value stands once; none where it is not one of these. `whole` is where it stands. Nothing is
/// copied where there is none: it is asked of each case in nested ones.
pub(super) fn by_one_function(
    whole: &ForeignExpr,
    sides: &(ForeignExpr, ForeignExpr),
    order: ForeignOrder,
    values: &(ForeignExpr, ForeignExpr),
) -> Option<ForeignExpr> {
    let span = &whole.span;
    let (then, otherwise) = values;
    let (high, low) = high_and_low(sides, order);
    let of_two = |name: &'static str| {
        Some(ForeignExpr::new(ForeignKind::Call(name, vec![then.clone(), otherwise.clone()]), span))
    };
    if same(then, high) && same(otherwise, low) {
        return of_two("max");
    }
    if same(then, low) && same(otherwise, high) {
        return of_two("min");
    }
    let absolute = |of: &ForeignExpr| of.clone().under("abs");
    if opposite(then, otherwise) {
        if is_zero(low) && same(then, high) || is_zero(high) && same(otherwise, low) {
            return Some(absolute(if is_zero(low) { then } else { low }));
        }
        // where x is less than zero x, and else -x
        if is_zero(high) && same(then, low) || is_zero(low) && same(otherwise, high) {
            return Some(absolute(if is_zero(high) { low } else { high }).negative());
        }
    }
    None
}

/// A case by `sign`: both values stand in it twice. It is right where both exist everywhere and the sides are equal on a thin set alone, which
/// who asks for it has to see to: off that set it is the same. `whole` is where it stands.
pub(super) fn by_sign(
    whole: &ForeignExpr,
    sides: &(ForeignExpr, ForeignExpr),
    order: ForeignOrder,
    values: &(ForeignExpr, ForeignExpr),
) -> ForeignExpr {
    let span = &whole.span;
    let (then, otherwise) = values;
    let (high, low) = high_and_low(sides, order);
    // then where high > low: (then + otherwise)/2 + sign(high - low)*(then - otherwise)/2
    let two = || ForeignExpr::integer(2, span);
    let distance = if is_zero(low) { high.clone() } else { high.clone().minus(low.clone()) };
    let sign = distance.under("sign");
    let (middle, half) = match (is_zero(then), is_zero(otherwise)) {
        (true, _) => (otherwise.clone(), otherwise.clone().negative()),
        (_, true) => (then.clone(), then.clone()),
        _ => (then.clone().plus(otherwise.clone()), then.clone().minus(otherwise.clone())),
    };
    middle.over(two()).plus(sign.times(half).over(two()))
}
