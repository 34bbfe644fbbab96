//! Ranks at states where the argument of an absolute value vanishes: by the Lie derivatives that are continuously differentiable there.

use super::branches::{Asked, DecidedBranch};
use super::claimed_ranks::ClaimedRanks;
use super::identity::OnOneBranch;
use super::question::Question;
use super::ranks::decide_rank;
use super::terms::{OnBranch, Terms};
use super::verdict::Verdict;
use palmistry_checker::Evidence;
use palmistry_lang::System;
use palmistry_math::expression::{Node, NodeId};
use palmistry_rank::observability::{Branch, rows_at_kinks};
use rand_chacha::ChaCha8Rng;

/// Whether functions exist everywhere, since they divide by nothing and have no roots or logarithms.
fn are_polynomials(system: &System, functions: &[NodeId]) -> bool {
    let reachable = system.graph.reachable(functions.iter().copied());
    reachable.into_iter().all(|id| match system.graph.node(id) {
        Node::Apply(..) | Node::Div(..) => false,
        Node::Power(_, exponent) => exponent >= 0,
        _ => true,
    })
}

impl Asked<'_> {
    /// The verdict on a branch on which not all Lie derivatives have a differential, part by part: that a rank is so high, up to the full one, follows from those
    /// that have one; that it is no higher does not. None where there is no kink.
    pub(super) fn on_kinks(
        &self,
        system: &mut System,
        branch: &Branch,
        rng: &mut ChaCha8Rng,
    ) -> Result<Option<Vec<DecidedBranch>>, String> {
        let full = system.unknown_count();
        let claimed = match self.question {
            Question::Codistribution { claimed } => *claimed,
            // where the rank is full all functions are observable that exist there
            Question::Visible { functions, is_observable: true } if are_polynomials(system, functions) => {
                ClaimedRanks::exactly(full)
            }
            _ => return Ok(None),
        };
        let guards = self.all_guards(system, branch);
        let Some(parts) = rows_at_kinks(system, branch, &guards)? else { return Ok(None) };
        let mut found = Vec::new();
        for part in parts {
            let mut guards = part.guards;
            guards.extend(
                part.branch
                    .assumed
                    .iter()
                    .filter(|guard| !guards.contains(guard))
                    .copied()
                    .collect::<Vec<_>>(),
            );
            let terms = Terms {
                sides: part.entries,
                guards,
                conditions: self.conditions.to_vec(),
                ..Terms::default()
            };
            let on = OnBranch::new(system, &part.branch, &terms)?;
            // what is not differentiable there may add to the rank
            let at_least = ClaimedRanks { least: claimed.least, most: usize::MAX, are_bounds: true };
            let verdict = match decide_rank(system, &on, full, at_least, rng) {
                OnOneBranch::Verdict(Verdict::Proved { engine, log2_error }, existence)
                    if claimed.most >= full =>
                {
                    let engine = format!(
                        "{engine}; of the Lie derivatives that are continuously differentiable at the kink"
                    );
                    OnOneBranch::Verdict(Verdict::Proved { engine, log2_error }, existence)
                }
                OnOneBranch::Verdict(_, existence) => {
                    let why = match &part.missing {
                        Some(missing) => format!(
                            "it lies in a kink: {missing} has no continuous differential there, and what the outputs determine beyond those that have one is not decided"
                        ),
                        None => {
                            "it lies in a kink, and the first Lie derivatives do not decide it".to_owned()
                        }
                    };
                    OnOneBranch::Verdict(Verdict::undecided(why), existence)
                }
                empty @ OnOneBranch::Empty(_) => empty,
            };
            let kept =
                Evidence::Unchecked("differentials at a kink are not evaluated by the checker".to_owned());
            found.push((part.branch, verdict, vec![kept]));
        }
        Ok(Some(found))
    }
}
