//! A statement on the branches of its conditions: the verdict on each, and what they come to together.

use super::cells::{cells, on_resolved};
use super::evidence::Kept;
use super::existence::Existence;
use super::identity::{OnOneBranch, decide_identity};
use super::inequality::decide_relations;
use super::irreducible::follows;
use super::question::Question;
use super::ranks::{decide_codistribution, decide_rank};
use super::terms::{OnBranch, Terms};
use super::verdict::Verdict;
use super::visible::decide_visible;
use palmistry_checker::Evidence;
use palmistry_lang::System;
use palmistry_math::expression::{Guard, NodeId, add_guard};
use palmistry_rank::observability::{Branch, Edges, SignCell, UnsolvedBranch, in_sign_cell, vanishes};
use rand_chacha::ChaCha8Rng;

/// What is asked of every branch.
pub(super) struct Asked<'a> {
    pub question: &'a Question,
    pub guards: &'a [Guard],
    pub sampled: &'a [Guard],
    pub conditions: &'a [NodeId],
    pub unsolved: &'a [NodeId],
    pub one_thing_twice: bool,
    /// Whether a proof was found on all parts of the largest dimension, which are as many dimensions smaller as there are conditions.
    pub parts_are_proved: bool,
}

/// A branch, or a part of one, with its verdict and what that rests on.
pub(super) type DecidedBranch = (Branch, OnOneBranch, Vec<Evidence>);

impl Asked<'_> {
    /// The verdict on a branch: of a rank on each part on which the signs under roots of squares are known, of anything else only
    /// where it is not decided as a whole.
    pub fn on_branch(
        &self,
        system: &mut System,
        branch: &Branch,
        kept: Kept,
        rng: &mut ChaCha8Rng,
    ) -> Result<Vec<DecidedBranch>, String> {
        let guards = self.all_guards(system, branch);
        if self.question.is_of_a_rank() {
            let mut found = Vec::new();
            for part in cells(system, self.question, branch, &guards, Edges::LeftOut)? {
                let work = |system: &mut System| self.on_part(system, &part.branch, &part.cell, kept, rng);
                let (verdict, evidence) = in_sign_cell(system, &part.cell, work)?;
                found.push((part.branch, verdict, evidence));
            }
            let is_empty = |(_, verdict, _): &DecidedBranch| matches!(verdict, OnOneBranch::Empty(_));
            if found.iter().all(is_empty)
                && let Some(on_kinks) = self.on_kinks(system, branch, rng)?
            {
                return Ok(on_kinks);
            }
            return Ok(found);
        }
        // boxes are slow where they cannot decide
        let by_boxes = matches!(self.question, Question::Relations { .. });
        if by_boxes && let Some(found) = self.proved_by_signs(system, branch, &guards, kept, rng)? {
            return Ok(found);
        }
        let (verdict, evidence) = self.on_part(system, branch, &SignCell::default(), kept, rng)?;
        let is_open = matches!(verdict, OnOneBranch::Verdict(Verdict::Undecided { .. }, _));
        if is_open
            && !by_boxes
            && let Some(found) = self.proved_by_signs(system, branch, &guards, kept, rng)?
        {
            return Ok(found);
        }
        Ok(vec![(branch.clone(), verdict, evidence)])
    }

    /// The verdicts on the parts of a branch by signs, where there are several and it is proved on all of them. A state at which
    /// it fails is looked for on the whole branch.
    fn proved_by_signs(
        &self,
        system: &mut System,
        branch: &Branch,
        guards: &[Guard],
        kept: Kept,
        rng: &mut ChaCha8Rng,
    ) -> Result<Option<Vec<DecidedBranch>>, String> {
        let Ok(parts) = cells(system, self.question, branch, guards, Edges::Counted) else { return Ok(None) };
        let mut found = Vec::new();
        for part in parts.iter().filter(|_| parts.len() > 1) {
            let (verdict, evidence) = self.on_part(system, &part.branch, &part.cell, kept, rng)?;
            match verdict {
                OnOneBranch::Verdict(Verdict::Proved { .. }, _) | OnOneBranch::Empty(_) => {
                    found.push((part.branch.clone(), verdict, evidence));
                }
                OnOneBranch::Verdict(..) => return Ok(None),
            }
        }
        Ok(if found.is_empty() { None } else { Some(found) })
    }

    /// Whether an equation holds wherever what was solved does, or follows from the conditions as a whole.
    fn follows(
        &self,
        system: &mut System,
        part: &UnsolvedBranch,
        entries: &[NodeId],
    ) -> Result<bool, String> {
        let (left, right) = entries.split_at(entries.len() / 2);
        let differences: Vec<NodeId> =
            left.iter().zip(right).map(|(left, right)| system.graph.sub(*left, *right)).collect();
        let there = part.branch.put_in(system, &differences)?;
        if there.iter().all(|difference| vanishes(system, *difference)) {
            return Ok(true);
        }
        Ok(self.parts_are_proved && follows(system, &differences, self.conditions, self.guards))
    }

    /// What a part of the set comes to some conditions of which could not be solved: a claim about all states is proved there where it holds
    /// wherever those hold that were solved.
    pub fn on_unsolved(
        &self,
        system: &mut System,
        part: &UnsolvedBranch,
        rng: &mut ChaCha8Rng,
    ) -> Result<Vec<(Size, Branch, OnOneBranch)>, String> {
        let holds = match self.question {
            Question::Identity { entries, .. } => self.follows(system, part, entries)?,
            _ => {
                let asked = Asked { unsolved: &part.open, ..*self };
                let decided = asked.on_branch(system, &part.branch, Kept::Verdicts, rng);
                let proved = |verdict: &OnOneBranch| {
                    matches!(verdict, OnOneBranch::Empty(_) | OnOneBranch::Verdict(Verdict::Proved { .. }, _))
                };
                decided.is_ok_and(|decided| decided.iter().all(|(_, verdict, _)| proved(verdict)))
            }
        };
        if holds {
            return Ok(Vec::new());
        }
        let why = format!("a part of the set, thinner than the rest, was not looked at: {}", part.text);
        let verdict = OnOneBranch::Verdict(Verdict::undecided(why), Existence::Shown);
        Ok(vec![(Size::Thinner, Branch::default(), verdict)])
    }

    pub fn all_guards(&self, system: &System, branch: &Branch) -> Vec<Guard> {
        let mut all = branch.guards.clone();
        self.sampled.iter().chain(self.guards).for_each(|guard| add_guard(&system.graph, &mut all, *guard));
        all
    }

    fn on_part(
        &self,
        system: &mut System,
        branch: &Branch,
        cell: &SignCell,
        kept: Kept,
        rng: &mut ChaCha8Rng,
    ) -> Result<(OnOneBranch, Vec<Evidence>), String> {
        let question = self.question;
        let all = self.all_guards(system, branch);
        let is_assumed: Vec<bool> =
            all.iter().map(|guard| branch.assumed.contains(guard) || self.sampled.contains(guard)).collect();
        let terms = Terms {
            sides: question.sides().to_vec(),
            relations: question.all_relations().to_vec(),
            guards: all,
            conditions: self.conditions.to_vec(),
            one_thing_twice: self.one_thing_twice,
        };
        let on = OnBranch::new(system, branch, &terms)?;
        let verdict = match question {
            Question::Identity { columns, .. } => decide_identity(system, &on, *columns, rng),
            Question::Relations { .. } => {
                let resolved = on_resolved(system, &on, cell, rng)?;
                decide_relations(system, resolved.as_ref().unwrap_or(&on), &is_assumed, self.unsolved, rng)
            }
            Question::Rank { columns, claimed, .. } => {
                let resolved = on_resolved(system, &on, cell, rng)?;
                decide_rank(system, resolved.as_ref().unwrap_or(&on), *columns, *claimed, rng)
            }
            Question::Codistribution { claimed } => {
                decide_codistribution(system, &on, branch, *claimed, rng)?
            }
            Question::Visible { is_observable, .. } => {
                let resolved = on_resolved(system, &on, cell, rng)?;
                return decide_visible(system, resolved.as_ref().unwrap_or(&on), *is_observable, kept, rng);
            }
        };
        let mut evidence = Vec::new();
        if let (OnOneBranch::Verdict(verdict, _), Kept::Evidence) = (&verdict, kept) {
            // random numbers of its own: what is kept changes no verdict
            evidence.extend(question.evidence(system, &on, verdict, &mut rng.clone()));
        }
        Ok((verdict, evidence))
    }
}

/// How a branch stands to the set of all states that meet the conditions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Size {
    /// It has the dimension of the set.
    Part,
    /// It has fewer dimensions, and may be a part of its own.
    Smaller,
    /// It has too few dimensions for that over the complex numbers: an edge of others, or a part of its own of the real states.
    Thinner,
    /// There an inequality holds with equality.
    Edge,
}

/// What the verdicts on all branches come to together.
pub(super) fn together(question: &Question, found: Vec<(Size, Branch, OnOneBranch)>) -> Verdict {
    let of_rank = question.is_of_a_rank();
    let several = found.len() > 1;
    // where all others are empty one piece is the whole set
    let is_alone = found.iter().filter(|(.., on_one)| !matches!(on_one, OnOneBranch::Empty(_))).count() == 1;
    let (mut verdicts, mut shown, mut needs) = (Vec::new(), false, Vec::new());
    for (size, branch, on_one) in found {
        let place = if several && !branch.steps.is_empty() {
            format!("where {}: ", branch.steps.join(", "))
        } else {
            String::new()
        };
        match on_one {
            OnOneBranch::Empty(guard) => needs.push(format!("{place}{guard}")),
            OnOneBranch::Verdict(verdict, existence) => {
                match existence {
                    Existence::Shown => shown = true,
                    Existence::Nowhere(guard) | Existence::NotShown(guard) => {
                        needs.push(format!("{place}{guard}"));
                    }
                }
                verdicts.push(match verdict {
                    // of a rank at almost all states this is no counterexample
                    Verdict::Refuted { witness, .. } if size != Size::Part && of_rank && !is_alone => {
                        let the_rank =
                            if matches!(question, Question::Visible { .. }) { "it" } else { "the rank" };
                        Verdict::undecided(format!(
                            "{place}{the_rank} is {} there, on a branch of fewer dimensions than the set",
                            witness.left
                        ))
                    }
                    Verdict::Undecided { why } => Verdict::undecided(format!("{place}{why}")),
                    verdict => verdict,
                });
            }
        }
    }
    let proved = verdicts.iter().all(|verdict| matches!(verdict, Verdict::Proved { .. }));
    if proved && !shown {
        needs.dedup();
        let needs = needs.join("; ");
        return Verdict::undecided(if verdicts.is_empty() {
            // a derivative may exist where the formula of the rules has no value, as that of an absolute value squared at zero
            format!(
                "its formula is defined nowhere (derivatives are taken by the rules, term by term): it needs {needs}"
            )
        } else {
            format!("no state was found at which all of it is defined: it needs {needs}")
        });
    }
    Verdict::all(verdicts)
}
