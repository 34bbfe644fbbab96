//! The branches of a question, divided by the signs on which roots of squares depend.

use super::asked::{RankQuestion, held_conditions};
use super::question::RankError;
use crate::observability::{Branch, Edges, Locus, SignCell, sign_cells};
use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::expression::{Guard, NodeId, add_guard};

/// A part of a branch.
pub(super) struct BranchPart {
    pub branch: Branch,
    pub cell: SignCell,
    /// In words, where no state of it was found in the sample box.
    pub without_states: Option<String>,
}

/// The parts of the branches by signs.
///
/// # Errors
/// Where all of them lie in kinks.
pub(super) fn by_signs(
    system: &mut System,
    question: &RankQuestion<'_>,
    branches: Vec<Branch>,
    own: &[NodeId],
) -> Result<Vec<BranchPart>, RankError> {
    let mut nodes: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
    for field in system.moving_fields() {
        nodes.extend(system.fields[field].components.iter().map(|(_, node)| *node));
    }
    nodes.extend(own);
    let smooth = system.smooth_guards(&system.moving_fields());
    let mut found = Vec::new();
    let mut is_in_kinks = false;
    for branch in branches {
        // outputs are differentiated by the states before these have the values that the conditions give
        let mut held = held_conditions(system, question, &branch);
        held.retain(|symbol, _| !system.states.contains(symbol));
        let there = system.graph.substitute(&nodes, &held);
        let guards: Vec<Guard> = branch.guards.iter().chain(&smooth).copied().collect();
        let guards = system.substitute_guards(&guards, &held);
        let cells = match sign_cells(system, &there, &guards, Edges::LeftOut) {
            Ok(cells) => cells,
            // too many to be distinguished: the states are looked at as they are
            Err(_) => vec![SignCell::default()],
        };
        let several = cells.len() > 1;
        for cell in cells {
            // with what the conditions give it may be empty
            let given = system.substitute_guards(&cell.guards, &branch.values);
            if given.iter().any(|guard| guard.is_obvious(&system.graph) == Some(false)) {
                let is_zero =
                    |guard: &Guard| system.graph.constant_value(guard.node).is_some_and(RBig::is_zero);
                is_in_kinks |= given.iter().any(is_zero);
                continue;
            }
            let mut part = branch.clone();
            for guard in &cell.guards {
                add_guard(&system.graph, &mut part.guards, *guard);
                add_guard(&system.graph, &mut part.assumed, *guard);
            }
            let mut without_states = None;
            if several && question.samples > 0 {
                let operands = smooth.iter().map(|guard| guard.node);
                let mentioned: Vec<NodeId> = nodes.iter().copied().chain(operands).collect();
                let drawn = Locus::new(system, &part, &question.fixed, &mentioned)
                    .and_then(|locus| locus.draw(question.seed, 0));
                if drawn.is_err() {
                    without_states = Some(cell.words.join(", "));
                }
            }
            found.push(BranchPart { branch: part, cell, without_states });
        }
    }
    if found.is_empty() && is_in_kinks {
        return Err(RankError::InAKink);
    }
    Ok(found)
}
