//! The branches of a question, taken apart by the signs on which roots of squares depend.

use super::question::{RankQuestion, held_conditions};
use crate::expression::{Guard, NodeId, add_guard};
use crate::observability::{Branch, Edges, Locus, LocusError, SignCell, sign_cells};
use crate::system::System;

/// The parts of the branches by signs; and, in words, those of which no state was found in the sample box.
///
/// # Errors
/// Where no state of any part was found, as [`Locus::draw`].
pub(super) fn by_signs(
    system: &mut System,
    question: &RankQuestion<'_>,
    branches: Vec<Branch>,
    own: &[NodeId],
) -> Result<(Vec<(Branch, SignCell)>, Vec<String>), LocusError> {
    let mut nodes: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
    for field in system.moving_fields() {
        nodes.extend(system.fields[field].components.iter().map(|(_, node)| *node));
    }
    nodes.extend(own);
    let smooth = system.smooth_guards(&system.moving_fields());
    let (mut found, mut left_out, mut trouble) = (Vec::new(), Vec::new(), None);
    for branch in branches {
        let held = held_conditions(system, question, &branch);
        let there = system.graph.substitute(&nodes, &held);
        let guards: Vec<Guard> = branch.guards.iter().chain(&smooth).copied().collect();
        let guards = system.substitute_guards(&guards, &held);
        let cells = match sign_cells(system, &there, &guards, Edges::LeftOut) {
            Ok(cells) => cells,
            // too many to be told apart: the states are looked at as they are
            Err(_) => vec![SignCell::default()],
        };
        let several = cells.len() > 1;
        for cell in cells {
            let mut part = branch.clone();
            for guard in &cell.guards {
                add_guard(&system.graph, &mut part.guards, *guard);
                add_guard(&system.graph, &mut part.assumed, *guard);
            }
            if several && question.samples > 0 {
                let operands = smooth.iter().map(|guard| guard.node);
                let mentioned: Vec<NodeId> = nodes.iter().copied().chain(operands).collect();
                let drawn = Locus::new(system, &part, &question.fixed, &mentioned)
                    .and_then(|locus| locus.draw(question.seed, 0));
                if let Err(error) = drawn {
                    left_out.push(cell.words.join(", "));
                    trouble = Some(error);
                    continue;
                }
            }
            found.push((part, cell));
        }
    }
    match trouble {
        Some(error) if found.is_empty() => Err(error),
        _ => Ok((found, left_out)),
    }
}
