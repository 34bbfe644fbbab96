//! Numbers in print beside the values of their formulas: how many digits agree, and whether rounding in few digits
//! explains the rest.

use crate::claim::{PointValue, certified_value};
use crate::expression::syntax::{Expr, ExprKind};
use crate::expression::{Expansion, NodeId, Symbol, expand};
use crate::number::{parse_decimal, rational_to_f64, round_to_decimal};
use crate::system::{ClaimBody, System, Value, in_one_line};
use crate::tradeoff::{RoundingStudy, study_rounding};
use dashu::rational::RBig;
use std::collections::HashMap;

/// One number in print.
#[derive(Clone, Debug)]
pub struct PrintedValue {
    /// The erratum that it belongs to.
    pub id: String,
    /// The point, in the words of the file.
    pub point: String,
    /// As printed.
    pub printed: String,
    /// The value of the formula to forty certified digits.
    pub certified: PointValue,
    /// The digits to which both, when rounded, are the same.
    pub digits_that_agree: usize,
    /// Printed minus true.
    pub error: f64,
    /// What ten digits do to the expanded formula.
    pub study: RoundingStudy,
}

/// The expanded determinant and the numbers in print.
#[derive(Clone, Debug)]
pub struct Appendix {
    /// The number of monomials of the numerator.
    pub monomials: usize,
    /// The factor in front.
    pub front: String,
    /// The factors of the common denominator, with their powers.
    pub denominator: Vec<(String, u32)>,
    /// The first monomials.
    pub beginning: String,
    pub values: Vec<PrintedValue>,
}

/// The determinant of appendix A.2, as the file writes it.
pub const DETERMINANT: &str = "det(A)";
/// The digits that a computer-algebra system carries by default.
const PRINTED_DIGITS: usize = 10;
/// The orders in which the monomials are added up.
const ORDERS: u64 = 400;
/// The digits that are certified.
const CERTIFIED_DIGITS: usize = 40;

/// Examines every erratum of the file whose printed form is the value of `det(A)` at a point.
///
/// # Errors
/// In words, where the file has no such matrix or a value cannot be computed.
pub fn printed_values(system: &System, seed: u64) -> Result<Appendix, String> {
    let mut system = system.clone();
    let determinant = match system.evaluate_text(DETERMINANT).map_err(|error| error.to_string())? {
        Value::Scalar(node) => node,
        other => return Err(format!("{DETERMINANT} is {}", other.describe())),
    };
    let angles = system.angles();
    let expansion = expand(&mut system.graph, determinant, |symbol| angles.contains(&symbol))?;
    let mut values = Vec::new();
    for claim in system.claims.clone() {
        let ClaimBody::Erratum { printed, .. } = &claim.body else { continue };
        let ExprKind::At(inner, _) = &printed.equation.left.kind else { continue };
        let ExprKind::Number(_) = &printed.equation.right.kind else { continue };
        if in_one_line(&system.source, &inner.span) == DETERMINANT {
            let (left, right) = (&printed.equation.left, &printed.equation.right);
            values.push(examine(&mut system, &claim.id, determinant, &expansion, left, right, seed)?);
        }
    }
    let name = |polynomial| expansion.text(&system.graph, polynomial, 6);
    Ok(Appendix {
        monomials: expansion.numerator.len(),
        front: expansion.front.to_string(),
        denominator: expansion.denominator.iter().map(|(factor, power)| (name(factor), *power)).collect(),
        beginning: expansion.text(&system.graph, &expansion.numerator, 8),
        values,
    })
}

fn examine(
    system: &mut System,
    id: &str,
    determinant: NodeId,
    expansion: &Expansion,
    left: &Expr,
    right: &Expr,
    seed: u64,
) -> Result<PrintedValue, String> {
    let ExprKind::At(_, list) = &left.kind else { return Err(format!("{id} is no value at a point")) };
    let point: HashMap<Symbol, RBig> = system
        .assignment(list)
        .map_err(|problem| problem.message)?
        .into_iter()
        .map(|(symbol, node)| {
            let value = system.graph.constant_value(node).cloned();
            Ok((symbol, value.ok_or_else(|| format!("{id}: a value that is not rational"))?))
        })
        .collect::<Result<_, String>>()?;
    let certified =
        certified_value(&system.graph, determinant, &point, CERTIFIED_DIGITS).map_err(|e| e.to_string())?;
    let truth = parse_decimal(&certified.decimal)
        .ok_or_else(|| format!("{id}: {} is no decimal", certified.decimal))?;
    let printed_text = in_one_line(&system.source, &right.span);
    let printed =
        parse_decimal(&printed_text).ok_or_else(|| format!("{id}: {printed_text} is no decimal"))?;
    let study =
        study_rounding(expansion, &point, &truth, PRINTED_DIGITS, ORDERS, seed).map_err(|e| e.to_string())?;
    Ok(PrintedValue {
        id: id.to_owned(),
        point: list
            .iter()
            .map(|(name, value)| format!("{} = {}", name.text, in_one_line(&system.source, &value.span)))
            .collect::<Vec<_>>()
            .join(", "),
        digits_that_agree: agreeing_digits(&printed, &truth),
        error: rational_to_f64(&(&printed - &truth)),
        printed: printed_text,
        certified,
        study,
    })
}

/// The most significant digits to which two numbers, both rounded, are the same.
fn agreeing_digits(a: &RBig, b: &RBig) -> usize {
    (1..=CERTIFIED_DIGITS).rev().find(|n| round_to_decimal(a, *n) == round_to_decimal(b, *n)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_counted_after_rounding() {
        let digits =
            |a: &str, b: &str| agreeing_digits(&parse_decimal(a).unwrap(), &parse_decimal(b).unwrap());
        assert_eq!(digits("25.67009841", "25.66837164143751"), 4); // both are 25.67
        assert_eq!(digits("1647.940473", "1647.937602"), 6); // both are 1647.94
        assert_eq!(digits("16.4", "164"), 0);
    }
}
