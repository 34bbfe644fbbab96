//! Equations as theorems: that both sides are equal, where a state is found at which they have values, and what differs at one.

use crate::foreseen::foreseen;
use crate::of_claim::{
    OfClaim, Theorem, as_argument, conditions_in, entries, is_solved, refuse, under, uses_with,
};
use crate::place::{Compared, DEEPEST, extent, place};
use crate::printer::{Kind, Printed, Reason};
use palmistry_lang::{Assignment, Statement, System};
use palmistry_math::expression::NodeId;
use palmistry_math::expression::syntax::{Equation, Relation};
use std::collections::BTreeSet;

/// Both sides of an equation, and what it is claimed under.
struct Said {
    left: Printed,
    right: Printed,
    conditions: String,
}

impl OfClaim<'_> {
    /// That the sides are equal, and that there is a state at which they have values, where one is found.
    pub fn identities(&mut self, statement: &Statement, to_be_proved: bool) -> Result<Vec<Theorem>, Reason> {
        refuse(statement)?;
        let count = 1 + statement.further.len();
        let mut found = Vec::new();
        for (equation, number) in statement.relations().zip(1..) {
            let name = match count {
                1 => self.claim.id.clone(),
                _ => format!("{} part {number}", self.claim.id),
            };
            let ident = self.names.of("claim", &name);
            let (said, uses) = self.said(equation, &statement.conditions)?;
            let sign = if said.left.kind == Kind::Number { "==" } else { "===" };
            let under = if said.conditions.is_empty() {
                String::new()
            } else {
                format!("\n  where {}", said.conditions)
            };
            let text = format!(
                "{}Theorem {ident} : {}\n  {sign} {}{under}.\nProof. identity. Qed.\n",
                self.comment(statement),
                said.left.text,
                said.right.text
            );
            found.push(Theorem { text, uses: uses.clone() });
            if !to_be_proved {
                continue;
            }
            let compared = compared(self.scratch, equation, &statement.conditions)?;
            for (left, right) in with_given(self.scratch, &compared) {
                refuse_depth(self.scratch, &[left, right])?;
                foreseen(&self.scratch.graph, left, right)?;
            }
            if let Some(place) = place(self.scratch, &compared, &self.variables(&uses), false) {
                let ident = self.names.of("claim", &format!("{name} somewhere"));
                let word = match said.left.kind {
                    Kind::Number => "is_about_something",
                    Kind::Matrix(..) => "matrices_are_about_something",
                };
                let text = format!(
                    "Theorem {ident} : {word} {} {} {}.\nProof. defined_at {}. Qed.\n",
                    said.listed(),
                    said.left.argument(),
                    said.right.argument(),
                    self.state(&place.state)
                );
                found.push(Theorem { text, uses: uses_with(uses, &place.state, self) });
            }
        }
        Ok(found)
    }

    /// That the sides differ at a state.
    pub fn difference(&mut self, statement: &Statement) -> Result<Theorem, Reason> {
        refuse(statement)?;
        if !statement.further.is_empty() {
            return Err("several equations in one".to_owned());
        }
        let (said, uses) = self.said(&statement.equation, &statement.conditions)?;
        let compared = compared(self.scratch, &statement.equation, &statement.conditions)?;
        let found = place(self.scratch, &compared, &self.variables(&uses), true);
        let Some((found, entry)) = found.and_then(|found| found.differs.map(|entry| (found, entry))) else {
            return Err("it is refuted, and no state in rational numbers was found".to_owned());
        };
        let side = |side: &Printed| match side.kind {
            Kind::Number => side.argument(),
            Kind::Matrix(_, columns) => {
                format!("(entry_at {} {} {})", entry / columns, entry % columns, side.argument())
            }
        };
        let ident = self.names.of("claim", &format!("{} refuted", self.claim.id));
        let text = format!(
            "{}Theorem {ident} : refuted {}\n  {}\n  {}.\nProof. differs_at {}. Qed.\n",
            self.comment(statement),
            said.listed(),
            side(&said.left),
            side(&said.right),
            self.state(&found.state)
        );
        Ok(Theorem { text, uses: uses_with(uses, &found.state, self) })
    }

    fn said(
        &mut self,
        equation: &Equation,
        conditions: &[Equation],
    ) -> Result<(Said, BTreeSet<String>), Reason> {
        if equation.relation != Relation::Equal {
            return Err("an inequality".to_owned());
        }
        if equation.within.is_some() {
            return Err("a number with a tolerance".to_owned());
        }
        let mut printer = self.definitions.outermost(self.system, self.names);
        let (left, right) = (printer.print(&equation.left)?, printer.print(&equation.right)?);
        if left.kind != right.kind {
            return Err("sides of two shapes".to_owned());
        }
        if !conditions.iter().all(|condition| is_solved(self.system, condition)) {
            return Err("a condition that is not solved for a variable".to_owned());
        }
        let conditions = conditions_in(&mut printer, conditions)?;
        Ok((Said { left, right, conditions }, printer.used))
    }
}

impl Said {
    /// The conditions as an argument.
    fn listed(&self) -> String {
        as_argument(&self.conditions)
    }
}

/// Coq goes down into terms, and so does what foresees it.
fn refuse_depth(system: &System, nodes: &[NodeId]) -> Result<(), Reason> {
    match extent(&system.graph, nodes).depth > DEEPEST {
        true => Err(format!("it is nested more than {DEEPEST} deep")),
        false => Ok(()),
    }
}

/// Both sides, entry by entry, and the conditions.
fn compared(system: &mut System, equation: &Equation, conditions: &[Equation]) -> Result<Compared, Reason> {
    let mut found = under(system, conditions)?;
    found.left = entries(system, &equation.left, &mut found.guards)?;
    found.right = entries(system, &equation.right, &mut found.guards)?;
    Ok(found)
}

/// Left and right sides with what conditions give put in, as often as the library does: of two variables the first is given.
fn with_given(system: &mut System, compared: &Compared) -> Vec<(NodeId, NodeId)> {
    let graph = &mut system.graph;
    let mut given = Assignment::new();
    for (left, relation, right) in compared.conditions.iter().rev() {
        let sides = [(*left, *right), (*right, *left)];
        let found = sides.into_iter().find_map(|(name, value)| Some((graph.as_symbol(name)?, value)));
        if let Some((symbol, value)) = found.filter(|_| *relation == Relation::Equal) {
            given.insert(symbol, value);
        }
    }
    let (mut left, mut right) = (compared.left.clone(), compared.right.clone());
    for _ in 0..given.len() {
        left = graph.substitute(&left, &given);
        right = graph.substitute(&right, &given);
    }
    left.into_iter().zip(right).collect()
}
