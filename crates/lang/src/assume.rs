//! What a file assumes of its parameters and states: inequalities under which each of its claims is made.

use super::codes::Code;
use super::error::Problem;
use super::model::System;
use super::syntax::{ClaimBody, Statement};
use super::written::in_one_line;
use palmistry_math::expression::syntax::{Equation, ExprKind, Relation};

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
    matches!(&statement.equation.left.kind, ExprKind::Call(name, _) if name == "solutions")
}
