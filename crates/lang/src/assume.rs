//! What a file assumes of its parameters and states: inequalities under which each of its claims is made.

use super::codes::Code;
use super::error::Problem;
use super::model::{Assignment, System};
use super::syntax::{ClaimBody, Statement};
use super::written::in_one_line;
use dashu::rational::RBig;
use palmistry_math::expression::Symbol;
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Relation};
use std::collections::BTreeMap;

/// So many conditions are written under claims at most: each assumption stands under each claim.
const MOST_CONDITIONS: usize = 400_000;

impl System {
    /// Takes inequalities down, once it is known that they can be read.
    pub(super) fn assume(&mut self, relations: &[Equation]) -> Result<(), Problem> {
        for relation in relations {
            if relation.relation == Relation::Equal {
                let message = "an equation is no assumption about a range of values";
                return Err(Problem::new(Code::Assumption, &relation.span, message, "this equation").help(
                    "give a constant its value with 'param' or 'let', a state its initial condition with 'initial', or state it with 'where' in a claim",
                ));
            }
            for side in [&relation.left, &relation.right] {
                self.apart(|system| system.scalar(side))?;
            }
        }
        self.assumed.extend(relations.iter().cloned());
        Ok(())
    }

    /// Makes each claim one about the states at which the assumptions hold. How many solutions there are is asked of all values.
    pub(super) fn claim_what_is_assumed(&mut self) {
        if self.claims.len().saturating_mul(self.assumed.len()) > MOST_CONDITIONS {
            return;
        }
        let assumed = std::mem::take(&mut self.assumed);
        for claim in &mut self.claims {
            let statements: Vec<&mut Statement> = match &mut claim.body {
                ClaimBody::Claim { statement, .. } => vec![statement],
                ClaimBody::Erratum { printed, corrected, .. } => vec![printed, corrected],
                ClaimBody::Scan { repaired, .. } => vec![repaired],
                ClaimBody::Definition { .. } | ClaimBody::Open { .. } => Vec::new(),
            };
            for statement in statements.into_iter().filter(|statement| !counts_solutions(statement)) {
                statement.conditions.extend(assumed.iter().cloned());
            }
        }
        self.assumed = assumed;
    }

    /// Assumptions that no values meet: those that constants have in this file, or any at all. Claims under them would be true of
    /// nothing.
    pub(super) fn assumptions_that_cannot_hold(&mut self) -> Vec<Problem> {
        let defaults: Assignment = (self.symbols.iter())
            .filter_map(|(symbol, info)| Some((*symbol, info.default.clone()?)))
            .collect::<Vec<_>>()
            .into_iter()
            .map(|(symbol, value)| (symbol, self.graph.rational(value)))
            .collect();
        let (mut bounds, mut found) = (BTreeMap::<Symbol, Bounds>::new(), Vec::new());
        if let Some(last) = self.assumed.last()
            && self.claims.len().saturating_mul(self.assumed.len()) > MOST_CONDITIONS
        {
            let (assumed, claims) = (self.assumed.len(), self.claims.len());
            let message = format!("{assumed} assumptions under each of {claims} claims are too many");
            let problem = Problem::new(Code::Assumption, &last.span, message, "the last one");
            found
                .push(problem.help("put claims into several files, or assume what they need behind 'where'"));
            return found;
        }
        for one in self.assumed.clone() {
            let sides = [&one.left, &one.right].map(|side| self.apart(|system| system.scalar(side)));
            let [Ok((left, _)), Ok((right, _))] = sides else { continue };
            let values = self.graph.substitute(&[left, right], &defaults);
            let difference = self.graph.sub(values[0], values[1]);
            if self
                .graph
                .constant_value(difference)
                .is_some_and(|value| !one.relation.holds(value.cmp(&RBig::ZERO)))
            {
                let text = in_one_line(&self.source, &one.span);
                let message = format!("the values that the file gives do not meet {text}");
                let problem = Problem::new(Code::Assumption, &one.span, message, "not met");
                found.push(problem.help("give the constants other values, or leave their values out"));
                continue;
            }
            let [number, other_number] = [left, right].map(|side| self.graph.constant_value(side).cloned());
            let [symbol, other_symbol] = [left, right].map(|side| self.graph.as_symbol(side));
            let (symbol, relation, number) = match (symbol, other_number, number, other_symbol) {
                (Some(symbol), Some(number), ..) => (symbol, one.relation, number),
                (.., Some(number), Some(symbol)) => (symbol, one.relation.turned(), number),
                _ => continue,
            };
            let known = bounds.entry(symbol).or_default();
            let could_be = !known.is_empty();
            known.add(relation, number);
            if could_be && known.is_empty() {
                let message =
                    format!("no value of '{}' meets all that is assumed of it", self.symbol_name(symbol));
                let problem = Problem::new(Code::Assumption, &one.span, message, "with what stands above");
                found.push(problem.help("leave one of the assumptions out: what holds in one case alone stands behind 'where' in a claim"));
            }
        }
        found
    }

    /// The assumptions as they stand in the file: `m > 0`.
    pub fn assumptions(&self) -> Vec<String> {
        let mut texts: Vec<String> =
            self.assumed.iter().map(|relation| in_one_line(&self.source, &relation.span)).collect();
        // a chain is one text of several relations
        texts.dedup();
        texts
    }
}

fn counts_solutions(statement: &Statement) -> bool {
    let counts = |side: &Expr| matches!(&side.kind, ExprKind::Call(name, _) if name == "solutions");
    counts(&statement.equation.left) || counts(&statement.equation.right)
}

/// The ends of the values that a symbol may have, each with whether the end itself is left out.
#[derive(Default)]
struct Bounds {
    low: Option<(RBig, bool)>,
    high: Option<(RBig, bool)>,
}

impl Bounds {
    /// Takes one more inequality down: the symbol lies above a number or below it.
    fn add(&mut self, relation: Relation, number: RBig) {
        let end = (number, matches!(relation, Relation::Less | Relation::Greater));
        match relation {
            Relation::Less | Relation::AtMost
                if self.high.as_ref().is_none_or(|high| end.0 < high.0 || end.0 == high.0 && end.1) =>
            {
                self.high = Some(end);
            }
            Relation::Greater | Relation::AtLeast if self.low.as_ref().is_none_or(|low| end > *low) => {
                self.low = Some(end);
            }
            _ => {}
        }
    }

    fn is_empty(&self) -> bool {
        let ends = self.low.as_ref().zip(self.high.as_ref());
        ends.is_some_and(|(low, high)| low.0 > high.0 || low.0 == high.0 && (low.1 || high.1))
    }
}
