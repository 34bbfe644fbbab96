//! The whole question of a rank in two steps, from a system and some conditions to sweeps of every branch: preparing, which is done
//! once, and sweeping, which may be done in parts, in any order and anywhere. A single run is the merge of one part.

use super::asked::RankQuestion;
use super::cells::by_signs;
use super::fingerprint::{Fingerprint, of_question};
use super::given_states::GivenStates;
use super::left::left_by_inequalities;
use super::paid::paid_on_a_copy;
use super::part::{BranchCounts, MergeError, RankPart};
use super::prepared_branch::{Extent, PreparedBranch};
use super::question::{GenericOnBranch, RankAnswer, RankError};
use super::states::Stretch;
use super::table::{StateTable, TableOf};
use crate::observability::{CodistributionError, OWN_ROWS, in_sign_cell, parse_condition, solve_conditions};
use palmistry_lang::{System, Value};
use palmistry_math::expression::{NodeId, Symbol};
use std::ops::Range;

/// A question about a rank with all that is done once, before states are looked at: conditions are solved, Lie derivatives taken,
/// rows made ready. What is found at the state of an index depends on the question and the index alone.
///
/// ```
/// use palmistry_lang::System;
/// use palmistry_rank::sweep::{RankPreparation, RankQuestion};
/// let mut system: System = r#"
///     system "A pendulum whose angle is measured"
///     state phi, omega
///     param k = 2
///     angle phi
///     drift f  phi' = omega  omega' = -k*sin(phi)
///     output phi
///     sample phi in [-3, 3] omega in [-2, 2]
/// "#.parse()?;
/// let question = RankQuestion::default();
/// let prepared = RankPreparation::new(&mut system, &question)?;
/// // elsewhere, and in any order
/// let late = prepared.sweep(&system, 400..1000)?;
/// let early = prepared.sweep(&system, 0..400)?;
/// let parts = [("late".to_owned(), late), ("early".to_owned(), early)];
/// let answer = prepared.answer(&mut system, parts)?;
/// assert_eq!(answer.branches[0].full.rank_histogram[&2], 1000);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct RankPreparation<'q> {
    question: &'q RankQuestion<'q>,
    branches: Vec<PreparedBranch>,
    own: Option<Vec<NodeId>>,
    left_out: Vec<String>,
    asked: u64,
    prepared: u64,
}

impl<'q> RankPreparation<'q> {
    /// Prepares a question.
    ///
    /// # Errors
    /// No states or outputs, no drift or input, conditions that cannot be solved, a pole everywhere, an empty sample box.
    pub fn new(system: &mut System, question: &'q RankQuestion<'q>) -> Result<Self, RankError> {
        RankPreparation::telling(system, question, false, &mut |_| ())
    }

    /// The same, but states are drawn only where the Lie derivatives that decide observability are short enough to be written down
    /// in a moment.
    ///
    /// # Errors
    /// As for [`RankPreparation::new`].
    pub fn at_once(system: &mut System, question: &'q RankQuestion<'q>) -> Result<Self, RankError> {
        RankPreparation::telling(system, question, true, &mut |_| ())
    }

    /// A question as a number, without anything being prepared: two that differ in what is found at any state have
    /// different numbers, but for one chance in 2^64.
    pub fn fingerprint(system: &System, question: &RankQuestion<'_>, at_once: bool) -> u64 {
        of_question(system, question, at_once)
    }

    /// The one or the other; `known` is called for each branch with what holds at almost all of its states, as soon as that is
    /// known.
    ///
    /// # Errors
    /// As for [`RankPreparation::new`], and where it takes more than a question may.
    pub fn telling(
        system: &mut System,
        question: &'q RankQuestion<'q>,
        only_if_short: bool,
        known: &mut dyn FnMut(GenericOnBranch),
    ) -> Result<Self, RankError> {
        paid_on_a_copy(system, |system| RankPreparation::prepared(system, question, only_if_short, known))
    }

    fn prepared(
        system: &mut System,
        question: &'q RankQuestion<'q>,
        only_if_short: bool,
        known: &mut dyn FnMut(GenericOnBranch),
    ) -> Result<Self, RankError> {
        let asked = of_question(system, question, only_if_short);
        if system.unknown_count() == 0 || system.outputs.is_empty() {
            return Err(RankError::NothingToSee(system.name.clone()));
        }
        system.require_motion().map_err(CodistributionError::NoMotion)?;
        let mut equations = Vec::new();
        for text in system.assumptions().iter().chain(&question.conditions) {
            equations.extend(parse_condition(text).map_err(RankError::Condition)?);
        }
        equations.extend(system.initial_conditions().iter().cloned());
        let mut branches = Vec::new();
        for branch in solve_conditions(system, &equations)? {
            branches.push(branch.tied_by_outputs(system)?);
        }
        let mut branches = left_by_inequalities(system, question, branches)?;
        for branch in &mut branches {
            for symbol in question.fixed.keys() {
                if branch.values.contains_key(symbol) {
                    return Err(RankError::HeldAndSolved(system.symbol_name(*symbol).to_owned()));
                }
            }
        }
        let own = match system.definition(OWN_ROWS) {
            Some(Value::Matrix(matrix)) if matrix.columns == system.unknown_count() => {
                Some(matrix.entries.clone())
            }
            _ => None,
        };
        let own_guards = system.definition_guards(OWN_ROWS);
        let (mut prepared, mut left_out) = (Vec::new(), Vec::new());
        let mut fingerprint = Fingerprint::default();
        let parts = by_signs(system, question, branches, own.as_deref().unwrap_or_default())?;
        for part in parts {
            let samples = if part.without_states.is_some() { 0 } else { question.samples };
            left_out.extend(part.without_states);
            let work = |system: &mut System| {
                let own = own.as_deref().map(|rows| (rows, own_guards.as_slice()));
                let extent = Extent { samples, only_if_short };
                PreparedBranch::new(system, question, &part.branch, (extent, own), known)
            };
            let mut branch = in_sign_cell(system, &part.cell, work)?;
            branch.cell = part.cell;
            fingerprint.text(&format!("{:?} {}", branch.locus.conditions, branch.samples));
            fingerprint.text(&branch.fingerprint(&system.graph));
            prepared.push(branch);
        }
        let (branches, prepared) = (prepared, fingerprint.value());
        Ok(RankPreparation { question, branches, own, left_out, asked, prepared })
    }

    /// Looks at the states of these indices on every branch of the conditions.
    ///
    /// # Errors
    /// Where states cannot be drawn.
    pub fn sweep(&self, system: &System, states: Range<u64>) -> Result<RankPart, RankError> {
        self.sweep_with(system, states, None)
    }

    /// The same, and hands on a row for each state.
    ///
    /// # Errors
    /// As for [`RankPreparation::sweep`].
    pub fn sweep_with(
        &self,
        system: &System,
        states: Range<u64>,
        mut table: Option<&mut StateTable<'_>>,
    ) -> Result<RankPart, RankError> {
        let RankQuestion { samples, interrupt, progress, .. } = *self.question;
        let states = states.start.min(samples)..states.end.min(samples);
        let mut branches = Vec::new();
        for (place, branch) in self.branches.iter().enumerate() {
            // on a branch without states no index is one
            let range = if branch.samples > 0 { states.clone() } else { 0..0 };
            let stretch = Stretch { range, interrupt, progress };
            let mut table = TableOf(table.as_deref_mut().map(|table| (place, table)));
            let full = branch.full.over(system, &stretch, &mut table)?;
            let silent = Stretch { progress: &|_| (), ..stretch };
            let rows = branch.rows.as_ref().map(|rows| rows.over(system, &silent, &mut TableOf::nobody()));
            branches.push(BranchCounts { full, rows: rows.transpose()? });
        }
        let RankPreparation { asked, prepared, .. } = *self;
        let (first, last) = (states.start, states.end.max(states.start));
        Ok(RankPart { asked, prepared, states: samples, first, last, branches })
    }

    /// The coordinates that every state has, in the order of the file: what is drawn, and what the conditions give.
    pub fn coordinates(&self) -> Vec<Symbol> {
        let Some(branch) = self.branches.first() else { return Vec::new() };
        let mut symbols: Vec<Symbol> =
            branch.locus.sources.keys().chain(branch.locus.values.keys()).copied().collect();
        symbols.sort_unstable();
        symbols.dedup();
        symbols
    }

    /// Decides states that are handed over instead of drawn, also outside of the sample box.
    ///
    /// # Errors
    /// Conditions with several branches, roots whose sign depends on where the state lies (what holds on one side does not on the
    /// other), and Lie derivatives too long to be written down.
    pub fn at_given_states(mut self, system: &mut System) -> Result<GivenStates, RankError> {
        let no = |why: &str| RankError::NotAtGivenStates(why.to_owned());
        let branch = self.branches.pop().filter(|_| self.branches.is_empty());
        let branch = branch.ok_or_else(|| {
            no("the conditions, or the signs on which roots depend, have several branches, and states of any may be handed over")
        })?;
        if !branch.cell.guards.is_empty() {
            return Err(no(
                "what the outputs determine depends on signs, and states of all signs may be handed over",
            ));
        }
        let found = branch.into_given_states(system, self.question.wanted);
        found.ok_or_else(|| no("the Lie derivatives are too long to be written down"))
    }

    /// How many branches of the conditions there are.
    pub fn branches(&self) -> usize {
        self.branches.len()
    }

    /// The answer, from parts that together are all states, each once, by their names, in any order.
    ///
    /// # Errors
    /// Parts with gaps or overlaps, or of another question; states that cannot be drawn.
    pub fn answer(
        self,
        system: &mut System,
        parts: impl IntoIterator<Item = (String, RankPart)>,
    ) -> Result<RankAnswer, RankError> {
        let whole = RankPart::merge(parts.into_iter().collect(), self.asked, self.question.samples)?;
        let expected: Vec<bool> = self.branches.iter().map(|branch| branch.rows.is_some()).collect();
        let counted: Vec<bool> = whole.branches.iter().map(|branch| branch.rows.is_some()).collect();
        if whole.prepared != self.prepared || expected != counted {
            return Err(MergeError::PreparedOtherwise.into());
        }
        let (question, own) = (self.question, self.own);
        let mut branches = Vec::new();
        for (branch, counts) in self.branches.into_iter().zip(whole.branches) {
            let cell = branch.cell.clone();
            let work = |system: &mut System| branch.answer(system, question, own.as_deref(), counts);
            branches.push(paid_on_a_copy(system, |system| in_sign_cell(system, &cell, work))?);
        }
        Ok(RankAnswer {
            file: system.name.clone(),
            title: system.title.clone(),
            outputs: system.outputs.len(),
            fields: system.roles(),
            seed: question.seed,
            dimension: system.unknown_count(),
            known: system.known_names(),
            assumed: system.assumed_of_signals(),
            branches,
            left_out: self.left_out,
        })
    }
}

/// Answers a question about the rank of a system's observability codistribution.
///
/// # Errors
/// No states or outputs, no drift or input, conditions that cannot be solved, a pole everywhere, an empty sample box.
pub fn answer_rank(system: &mut System, question: &RankQuestion<'_>) -> Result<RankAnswer, RankError> {
    let prepared = RankPreparation::new(system, question)?;
    in_one_part(system, prepared)
}

/// The same, but states are drawn only where the Lie derivatives that decide observability are short enough to be written down in a
/// moment.
///
/// # Errors
/// As for [`answer_rank`].
pub fn answer_rank_at_once(
    system: &mut System,
    question: &RankQuestion<'_>,
) -> Result<RankAnswer, RankError> {
    let prepared = RankPreparation::at_once(system, question)?;
    in_one_part(system, prepared)
}

fn in_one_part(system: &mut System, prepared: RankPreparation<'_>) -> Result<RankAnswer, RankError> {
    let part = prepared.sweep(system, 0..prepared.question.samples)?;
    prepared.answer(system, [(String::new(), part)])
}
