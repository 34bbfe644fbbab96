//! Branches divided by the signs of the arguments of absolute values.

use super::question::Question;
use super::terms::{OnBranch, Terms};
use palmistry_lang::System;
use palmistry_math::expression::{Guard, NodeId, add_guard, without_signs};
use palmistry_rank::observability::{Branch, Edges, SignCell, sign_cells};
use rand_chacha::ChaCha8Rng;

/// A part of a branch on which certain signs are known.
pub(super) struct BranchCell {
    /// The branch, with these signs among its conditions.
    pub branch: Branch,
    pub cell: SignCell,
}

/// The parts of a branch, one without signs where nothing depends on them.
///
/// # Errors
/// In words, where there are too many, or a term distinguishes values that the conditions leave open.
pub(super) fn cells(
    system: &mut System,
    question: &Question,
    branch: &Branch,
    guards: &[Guard],
    edges: Edges,
) -> Result<Vec<BranchCell>, String> {
    let operands: Vec<NodeId> = guards.iter().map(|guard| guard.node).collect();
    let (nodes, operands) = match question {
        Question::Codistribution { .. } | Question::Visible { .. } => {
            let mut nodes: Vec<NodeId> = question.sides().to_vec();
            nodes.extend(system.outputs.iter().map(|(_, node)| *node));
            for field in system.moving_fields() {
                nodes.extend(system.fields[field].components.iter().map(|(_, node)| *node));
            }
            // they are differentiated by the states before these have the values that the conditions give
            let mut held = branch.values.clone();
            held.retain(|symbol, _| !system.states.contains(symbol));
            (system.graph.substitute(&nodes, &held), system.graph.substitute(&operands, &held))
        }
        _ => (branch.put_in(system, question.sides())?, branch.put_in(system, &operands)?),
    };
    let guards: Vec<Guard> =
        guards.iter().zip(operands).map(|(guard, node)| Guard { node, need: guard.need }).collect();
    let found = sign_cells(system, &nodes, &guards, edges)?;
    let one = |cell: SignCell| {
        let mut branch = branch.clone();
        for guard in &cell.guards {
            add_guard(&system.graph, &mut branch.guards, *guard);
            add_guard(&system.graph, &mut branch.assumed, *guard);
        }
        branch.steps.extend(cell.words.iter().cloned());
        BranchCell { branch, cell }
    };
    Ok(found.into_iter().map(one).collect())
}

/// The terms with roots of squares written without the root, where the signs are known; nothing where there are none.
///
/// # Errors
/// As [`OnBranch::new`].
pub(super) fn on_resolved(
    system: &mut System,
    on: &OnBranch,
    cell: &SignCell,
    rng: &mut ChaCha8Rng,
) -> Result<Option<OnBranch>, String> {
    if cell.guards.is_empty() {
        return Ok(None); // it is one with the branch
    }
    let sides = without_signs(&mut system.graph, &on.statement.sides, &on.statement.guards, rng);
    let terms = Terms { sides, ..on.statement.clone() };
    OnBranch::new(system, &on.branch, &terms).map(Some)
}
