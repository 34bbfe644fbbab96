//! Numbers in print beside the values of their formulas: how many digits agree, and whether rounding in the digits that the
//! author's system carried explains the rest.

use crate::tradeoff::{RoundingStudy, study_rounding};
use dashu::rational::RBig;
use palmistry_lang::{Assignment, Statement, System, in_one_line};
use palmistry_math::expression::syntax::{Expr, ExprKind, Name};
use palmistry_math::expression::{Expansion, NodeId, Symbol, expand};
use palmistry_math::number::{parse_decimal, rational_to_f64, round_to_decimal};
use palmistry_prove::claim::{PointValue, certified_value};
use std::collections::HashMap;

/// One number in print: the right side of a statement that says `carrying ... digits`.
#[derive(Clone, Debug)]
pub struct PrintedValue {
    /// The entry that it belongs to.
    pub id: String,
    /// The point, as the file writes it.
    pub point: String,
    /// As printed.
    pub printed: String,
    /// The digits that the author's system carried.
    pub carried: usize,
    /// The value of the formula to forty certified digits.
    pub certified: PointValue,
    /// The digits to which both, when rounded, are the same.
    pub digits_that_agree: usize,
    /// Printed minus true.
    pub error: f64,
    /// What so few digits do to the expanded formula; why that is not known, where the formula cannot be expanded.
    pub study: Result<RoundingStudy, String>,
}

/// A formula of which values are printed.
#[derive(Clone, Debug)]
pub struct PrintedExpression {
    /// As the file writes it.
    pub text: String,
    /// What it is when it is multiplied out; nothing where it cannot be.
    pub expanded: Option<ExpandedText>,
    /// Its values, in the order of the file.
    pub values: Vec<PrintedValue>,
}

/// A formula multiplied out, as text.
#[derive(Clone, Debug)]
pub struct ExpandedText {
    /// The number of monomials of the numerator.
    pub monomials: usize,
    /// The factor in front.
    pub front: String,
    /// The factors of the common denominator, with their powers.
    pub denominator: Vec<(String, u32)>,
    /// The first monomials.
    pub beginning: String,
}

/// The orders in which the monomials are added up.
const ORDERS: u64 = 400;
/// The digits that are certified.
const CERTIFIED_DIGITS: usize = 40;

/// The parts of a statement about a number in print.
struct Print<'a> {
    id: &'a str,
    formula: &'a Expr,
    point: &'a [(Name, Expr)],
    number: &'a Expr,
    carried: usize,
}

impl<'a> Print<'a> {
    fn of(id: &'a str, statement: &'a Statement) -> Option<Print<'a>> {
        let (left, number) = (&statement.equation.left, &statement.equation.right);
        let (formula, point) = match &left.kind {
            ExprKind::At(inner, list) => (&**inner, list.as_slice()),
            _ => (left, &[][..]),
        };
        Some(Print { id, formula, point, number, carried: statement.carried? })
    }
}

/// Examines every number of a file that is said to be in print, formula by formula.
///
/// # Errors
/// In words, where a formula has no value at its point.
pub fn printed_values(system: &System, seed: u64) -> Result<Vec<PrintedExpression>, String> {
    let claims = &system.claims;
    let statements = claims.iter().flat_map(|claim| {
        claim.body.statements().into_iter().filter_map(|statement| Print::of(&claim.id, statement))
    });
    let mut system = system.clone();
    let is_angle = &system.angle_test();
    let mut expansions: HashMap<NodeId, Result<Expansion, String>> = HashMap::new();
    let mut found: Vec<PrintedExpression> = Vec::new();
    for print in statements {
        let text = in_one_line(&system.source, &print.formula.span);
        let value = system.elaborate(print.formula).map_err(|problem| problem.message)?;
        let node =
            value.as_number().ok_or_else(|| format!("{}: {text} is {}", print.id, value.describe()))?;
        let expansion = expansions.entry(node).or_insert_with(|| expand(&mut system.graph, node, is_angle));
        let expansion = expansion.clone();
        let value = print.examine(&mut system, node, &expansion, seed)?;
        match found.iter_mut().find(|known| known.text == text) {
            Some(known) => known.values.push(value),
            None => {
                let expanded = expansion.as_ref().ok().map(|expansion| in_words(&system, expansion));
                found.push(PrintedExpression { text, expanded, values: vec![value] });
            }
        }
    }
    Ok(found)
}

fn in_words(system: &System, expansion: &Expansion) -> ExpandedText {
    let name = |polynomial| expansion.text(&system.graph, polynomial, 6);
    ExpandedText {
        monomials: expansion.numerator.len(),
        front: expansion.front.to_string(),
        denominator: expansion.denominator.iter().map(|(factor, power)| (name(factor), *power)).collect(),
        beginning: expansion.text(&system.graph, &expansion.numerator, 8),
    }
}

impl Print<'_> {
    fn examine(
        &self,
        system: &mut System,
        formula: NodeId,
        expansion: &Result<Expansion, String>,
        seed: u64,
    ) -> Result<PrintedValue, String> {
        let id = self.id;
        let assignment: Assignment = system.assignment(self.point).map_err(|problem| problem.message)?;
        let rational = |(symbol, node): (Symbol, NodeId)| {
            let value = system.graph.constant_value(node).cloned();
            Ok((symbol, value.ok_or_else(|| format!("{id}: a value that is not rational"))?))
        };
        let point: HashMap<Symbol, RBig> =
            assignment.into_iter().map(rational).collect::<Result<_, String>>()?;
        let certified = certified_value(&system.graph, formula, &point, CERTIFIED_DIGITS)
            .map_err(|why| format!("{id}: {why}"))?;
        let truth = parse_decimal(&certified.decimal)
            .ok_or_else(|| format!("{id}: {} is no decimal", certified.decimal))?;
        let text: String = in_one_line(&system.source, &self.number.span).split_whitespace().collect();
        let printed = parse_decimal(&text).ok_or_else(|| format!("{id}: {text} is no decimal"))?;
        let study = expansion.as_ref().map_err(String::clone).and_then(|expansion| {
            study_rounding(expansion, &point, &truth, self.carried, ORDERS, seed).map_err(|e| e.to_string())
        });
        let in_words = |(name, value): &(Name, Expr)| {
            format!("{} = {}", name.text, in_one_line(&system.source, &value.span))
        };
        Ok(PrintedValue {
            id: id.to_owned(),
            point: self.point.iter().map(in_words).collect::<Vec<_>>().join(", "),
            carried: self.carried,
            digits_that_agree: agreeing_digits(&printed, &truth),
            error: rational_to_f64(&(&printed - &truth)),
            printed: text,
            certified,
            study,
        })
    }
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
