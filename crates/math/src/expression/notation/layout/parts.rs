//! Formulas put together: in brackets, with scripts, side by side; and numbers.

use super::Binding;
use crate::expression::notation::{Fence, Formula, FormulaSign};

pub(super) fn round(inner: Formula) -> Formula {
    Formula::Fence(Fence::Round, Box::new(inner))
}

pub(super) fn scripts(base: Formula, below: Option<Formula>, above: Option<Formula>) -> Formula {
    Formula::Scripts { base: Box::new(base), below: below.map(Box::new), above: above.map(Box::new) }
}

pub(super) fn commas(parts: Vec<Formula>) -> Formula {
    let mut row = Vec::new();
    for part in parts {
        if !row.is_empty() {
            row.push(Formula::Sign(FormulaSign::Comma));
        }
        row.push(part);
    }
    Formula::Row(row)
}

/// Factors one after the other, with a sign or some room where they would run together.
pub(super) fn joined(factors: Vec<Formula>) -> Formula {
    let mut row: Vec<Formula> = Vec::new();
    for factor in factors {
        let (first, last) = (first_of(&factor), row.last().map(last_of));
        let sign = match (last, first) {
            (None, _) => None,
            (Some(_), Formula::Number(_)) => Some(FormulaSign::Dot),
            (Some(Formula::Number(_)), Formula::Fraction(..)) => Some(FormulaSign::Dot),
            (Some(last), first) if is_wide(last) || is_wide(first) => Some(FormulaSign::Thin),
            _ => None,
        };
        row.extend(sign.map(Formula::Sign));
        match factor {
            Formula::Row(parts) => row.extend(parts),
            other => row.push(other),
        }
    }
    Formula::Row(row)
}

fn first_of(formula: &Formula) -> &Formula {
    match formula {
        Formula::Row(parts) => parts.first().map_or(formula, first_of),
        Formula::Scripts { base, .. } => first_of(base),
        other => other,
    }
}

fn last_of(formula: &Formula) -> &Formula {
    match formula {
        Formula::Row(parts) => parts.last().map_or(formula, last_of),
        other => other,
    }
}

fn is_wide(formula: &Formula) -> bool {
    match formula {
        Formula::Word(_) | Formula::Literal(_) => true,
        Formula::Name(name) => name.is_wide(),
        Formula::Scripts { base, .. } => is_wide(base),
        _ => false,
    }
}

/// A decimal as it is written, its exponent as a power of ten.
pub(super) fn number(written: &str) -> (Formula, Binding) {
    let Some((digits, exponent)) = written.split_once(['e', 'E']) else {
        return (Formula::Number(written.to_owned()), Binding::Atom);
    };
    let exponent = exponent.trim_start_matches('+');
    let above = match exponent.strip_prefix('-') {
        Some(size) => {
            Formula::Row(vec![Formula::Sign(FormulaSign::Negative), Formula::Number(size.to_owned())])
        }
        None => Formula::Number(exponent.to_owned()),
    };
    let power = scripts(Formula::Number("10".to_owned()), None, Some(above));
    match digits {
        "1" => (power, Binding::Power),
        _ => {
            let row = vec![Formula::Number(digits.to_owned()), Formula::Sign(FormulaSign::Dot), power];
            (Formula::Row(row), Binding::Product)
        }
    }
}

/// A number that stands nowhere in the text.
pub(super) fn rational(value: &dashu::rational::RBig) -> (Formula, Binding) {
    let (top, bottom) = (value.numerator(), value.denominator());
    let number = |text: String| Formula::Number(text);
    let size = number(top.to_string().trim_start_matches('-').to_owned());
    let formula = match bottom.to_string().as_str() {
        "1" => size,
        bottom => Formula::Fraction(Box::new(size), Box::new(number(bottom.to_owned()))),
    };
    match (top.to_string().starts_with('-'), &formula) {
        (true, _) => (Formula::Row(vec![Formula::Sign(FormulaSign::Negative), formula]), Binding::Sum),
        (false, Formula::Number(_)) => (formula, Binding::Atom),
        (false, _) => (formula, Binding::Product),
    }
}
