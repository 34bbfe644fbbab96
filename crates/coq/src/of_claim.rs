//! A claim whose theorems are written: what statements on numbers and on ranks have in common.

use crate::definitions::Definitions;
use crate::names::{Names, in_comment};
use crate::place::{Compared, Coordinate, State};
use crate::printer::{Printer, Reason};
use dashu::rational::RBig;
use palmistry_lang::{ClaimSyntax, Statement, System, Value, in_one_line};
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Relation};
use palmistry_math::expression::{Guard, NodeId, Symbol};
use std::collections::{BTreeMap, BTreeSet};

/// A theorem before its definitions are known to be printed.
pub(crate) struct Theorem {
    pub text: String,
    pub uses: BTreeSet<String>,
}

/// A claim, and where its theorems are written.
pub(crate) struct OfClaim<'a> {
    pub system: &'a System,
    pub claim: &'a ClaimSyntax,
    pub definitions: &'a Definitions,
    pub names: &'a mut Names,
    /// A copy of the system.
    pub scratch: &'a mut System,
    /// The variables of Coq.
    pub symbols: &'a BTreeMap<String, Symbol>,
}

impl OfClaim<'_> {
    /// The variables that these names rest on.
    pub fn variables(&self, uses: &BTreeSet<String>) -> BTreeSet<Symbol> {
        let (_, variables) = self.definitions.needed(uses);
        variables.iter().filter_map(|ident| self.symbols.get(ident).copied()).collect()
    }

    pub fn comment(&self, statement: &Statement) -> String {
        let text = in_comment(&in_one_line(&self.system.source, &statement.span));
        format!("(* {}: {text} *)\n", in_comment(&self.claim.id))
    }

    /// A state, by its coordinates.
    pub fn state(&mut self, state: &State) -> String {
        let number = |value: &RBig| match *value < RBig::ZERO {
            true => format!("({}) {}", value.numerator(), value.denominator()),
            false => format!("{} {}", value.numerator(), value.denominator()),
        };
        let coordinate = |(symbol, coordinate): &(Symbol, Coordinate)| {
            let name = self.names.of("value", self.system.symbol_name(*symbol));
            match coordinate {
                Coordinate::Number(value) => format!("({name}, Number {})", number(value)),
                Coordinate::Angle(half) => format!("({name}, Angle {})", number(half)),
            }
        };
        match state.is_empty() {
            true => "anywhere".to_owned(),
            false => format!("[{}]", state.iter().map(coordinate).collect::<Vec<_>>().join("; ")),
        }
    }
}

/// Conditions as an argument.
pub(crate) fn as_argument(conditions: &str) -> String {
    if conditions.is_empty() { "[]".to_owned() } else { format!("({conditions})%condition") }
}

/// What a theorem mentions, with the variables of a state.
pub(crate) fn uses_with(mut uses: BTreeSet<String>, state: &State, of: &mut OfClaim<'_>) -> BTreeSet<String> {
    for (symbol, _) in state {
        uses.insert(of.names.of("value", of.system.symbol_name(*symbol)));
    }
    uses
}

/// What no equation of the library says.
pub(crate) fn refuse(statement: &Statement) -> Result<(), Reason> {
    if statement.carried.is_some() {
        return Err("a number in print".to_owned());
    }
    if statement.except.is_some() {
        return Err("a rank at all states".to_owned());
    }
    Ok(())
}

/// Whether a condition gives a variable, or takes away no dimension.
pub(crate) fn is_solved(system: &System, condition: &Equation) -> bool {
    let is_symbol = |expr: &Expr| match &expr.kind {
        ExprKind::Name(name) => system.find_symbol(name).is_some(),
        _ => false,
    };
    condition.relation != Relation::Equal || is_symbol(&condition.left) || is_symbol(&condition.right)
}

/// The list of some conditions; nothing where there are none.
pub(crate) fn conditions_in(printer: &mut Printer<'_>, conditions: &[Equation]) -> Result<String, Reason> {
    let list: Vec<String> =
        conditions.iter().map(|condition| condition_of(printer, condition)).collect::<Result<_, _>>()?;
    Ok(if list.is_empty() { String::new() } else { format!("[{}]", list.join("; ")) })
}

fn condition_of(printer: &mut Printer<'_>, condition: &Equation) -> Result<String, Reason> {
    if condition.within.is_some() {
        return Err("a condition with a tolerance".to_owned());
    }
    let (left, right) = (printer.scalar(&condition.left)?, printer.scalar(&condition.right)?);
    let sign = match condition.relation {
        Relation::Equal => "=",
        Relation::NotEqual => "<>",
        Relation::Less => "<",
        Relation::AtMost => "<=",
        Relation::Greater => ">",
        Relation::AtLeast => ">=",
    };
    Ok(format!("{} {sign} {}", left.text, right.text))
}

/// The conditions, and nothing that is compared.
pub(crate) fn under(system: &mut System, conditions: &[Equation]) -> Result<Compared, Reason> {
    let mut found =
        Compared { left: Vec::new(), right: Vec::new(), conditions: Vec::new(), guards: Vec::new() };
    for condition in conditions {
        let mut side = |side: &Expr| match entries(system, side, &mut found.guards)?.as_slice() {
            [one] => Ok::<_, Reason>(*one),
            _ => Err("a condition of matrices".to_owned()),
        };
        let given = (side(&condition.left)?, condition.relation, side(&condition.right)?);
        found.conditions.push(given);
    }
    Ok(found)
}

/// The entries of a number or a matrix, by rows; and what has to hold for all of it to have values.
pub(crate) fn entries(
    system: &mut System,
    side: &Expr,
    guards: &mut Vec<Guard>,
) -> Result<Vec<NodeId>, Reason> {
    let (value, needs) = system.elaborate_guarded(side).map_err(|problem| problem.message)?;
    guards.extend(needs);
    match value {
        Value::Scalar(one) => Ok(vec![one]),
        Value::Matrix(matrix) => Ok(matrix.entries),
        other => Err(other.describe()),
    }
}
