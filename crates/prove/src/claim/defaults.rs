//! A claim at the values that its file gives to parameters.
//!
//! A value in a file is what `eval`, `rank` and pictures take where nothing else is said. A claim is about all values: what
//! is proved of `k` need not hold at `param k = 0`, since a rank is that of almost all values and an identity holds where
//! both sides exist. Where the two verdicts differ the outcome says so.

use super::verdict::{AtFilesValues, Verdict};
use dashu::rational::RBig;
use palmistry_lang::{Kind, Statement, System, Value};
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Relation};
use palmistry_math::expression::{NodeId, Symbol};

/// Decides a statement once more with the file's values as conditions in front of its own. `None` where it depends on no
/// such value, or where the verdict is the same.
pub(crate) fn at_the_files_values(
    system: &mut System,
    statement: &Statement,
    verdict: &Verdict,
    decide: impl FnOnce(&mut System, &Statement) -> Verdict,
) -> Option<AtFilesValues> {
    // numbers have nothing to depend on, and what is left out is said for all values
    if statement.equation.within.is_some() || statement.except.is_some() {
        return None;
    }
    let values = values_for(system, statement);
    if values.is_empty() {
        return None;
    }
    let mut special = statement.clone();
    let given = values.iter().map(|(symbol, value)| Equation {
        left: part(statement, ExprKind::Name(system.symbol_name(*symbol).to_owned())),
        relation: Relation::Equal,
        right: part(statement, ExprKind::Number(value.clone())),
        within: None,
        span: statement.span.clone(),
    });
    special.conditions.splice(0..0, given);
    let word = decide(system, &special).word();
    let named =
        values.into_iter().map(|(symbol, value)| (system.symbol_name(symbol).to_owned(), value)).collect();
    // with the values put in a condition may have lost the symbol that it was solved for: that says nothing of the claim
    let unsolved = word == "undecided" && !statement.conditions.is_empty();
    (word != verdict.word() && !unsolved).then_some(AtFilesValues { values: named, word })
}

fn part(statement: &Statement, kind: ExprKind) -> Expr {
    Expr { kind, span: statement.span.clone() }
}

/// The parameters of this file with a value that a statement depends on. Those that its own conditions fix are left out,
/// and angles other than zero, whose sines have no exact value.
fn values_for(system: &mut System, statement: &Statement) -> Vec<(Symbol, RBig)> {
    let mut nodes: Vec<NodeId> = Vec::new();
    let mut fixed: Vec<Symbol> = Vec::new();
    for side in statement.relations().flat_map(|relation| [&relation.left, &relation.right]) {
        match system.elaborate(side) {
            Ok(Value::Scalar(id)) => nodes.push(id),
            Ok(Value::Matrix(m) | Value::Rank(m)) => nodes.extend(m.entries),
            Ok(Value::Pole { expression, factor }) => {
                nodes.push(expression);
                // the order of a pole is asked where these move
                fixed.extend(system.graph.symbols_of([factor]));
            }
            Ok(value @ (Value::CodistributionRank | Value::Visible { .. })) => {
                if let Value::Visible { functions, .. } = value {
                    nodes.extend(functions);
                }
                nodes.extend(system.outputs.iter().map(|(_, node)| *node));
                for field in system.moving_fields() {
                    nodes.extend(system.fields[field].components.iter().map(|(_, node)| *node));
                }
            }
            // a number of solutions is that at almost all values
            Ok(Value::Solutions(_) | Value::Infinity) | Err(_) => return Vec::new(),
        }
    }
    for condition in &statement.conditions {
        for side in [&condition.left, &condition.right] {
            if let Ok(node) = system.scalar(side) {
                if condition.relation == Relation::Equal {
                    fixed.extend(system.graph.as_symbol(node));
                }
                nodes.push(node);
            }
        }
    }
    let mentioned = system.graph.symbols_of(nodes);
    let value = |(symbol, info): (Symbol, &palmistry_lang::SymbolInfo)| {
        let value = info.default.clone().filter(|value| !info.is_angle || value.is_zero())?;
        let counts = info.kind == Kind::Parameter && mentioned.contains(&symbol) && !fixed.contains(&symbol);
        counts.then_some((symbol, value))
    };
    system.symbols().filter_map(value).collect()
}
