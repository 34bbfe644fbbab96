//! The whole question of accessibility, from a system and some conditions to sweeps of every branch.

use super::asked::{RankQuestion, held_conditions};
use super::certainty::Certainty;
use super::left::left_by_inequalities;
use super::paid::paid_on_a_copy;
use super::prepared::sweep;
use super::question::{RankError, guarded, held_parameters};
use super::states::{SweepOptions, SweepReport};
use crate::observability::{
    Accessibility, BracketsSoFar, CodistributionError, Locus, RankBounds, Stop, parse_condition,
    solve_conditions,
};
use dashu::rational::RBig;
use palmistry_lang::{FieldRole, System};
use palmistry_math::expression::{NodeId, Symbol};
use std::sync::atomic::Ordering;

/// At so many states at the most a rank is shown that rests on functions.
const STATES_OF_A_MINOR: u64 = 5;

/// What was found on one branch of the conditions.
#[derive(Clone)]
pub struct AccessibilityBranch {
    /// The conditions, solved, in words.
    pub conditions: Vec<String>,
    /// The parameters that the file gives a value to: they were fixed at it.
    pub held: Vec<(String, RBig)>,
    /// The brackets that raised the rank.
    pub brackets: Vec<String>,
    /// The most fields in a bracket that was taken.
    pub order: usize,
    /// Why no longer brackets were taken.
    pub stop: Stop,
    /// The rank of the accessibility distribution at almost all states of the branch.
    pub whole: RankBounds,
    /// That of the strong accessibility distribution.
    pub strong: RankBounds,
    /// The rank of the brackets that were taken at the sampled states, the drift among them; none where it did not come to that.
    pub sampled: Option<SweepReport>,
}

/// What was found.
#[derive(Clone)]
pub struct AccessibilityAnswer {
    /// The file.
    pub file: String,
    /// The title of the system.
    pub title: String,
    /// The fields of which brackets are made.
    pub fields: Vec<FieldRole>,
    /// The seed of the drawn states.
    pub seed: u64,
    /// The coordinates that can be moved at all: their number is the rank that allows all directions.
    pub coordinates: Vec<String>,
    /// An answer for each branch of the conditions; one where there are none.
    pub branches: Vec<AccessibilityBranch>,
}

impl AccessibilityAnswer {
    /// Whether it was stopped early.
    pub fn interrupted(&self) -> bool {
        self.branches.iter().any(|branch| branch.sampled.as_ref().is_none_or(|sampled| sampled.interrupted))
    }

    /// Whether the ranks at almost all states are known on every branch.
    pub fn is_final(&self) -> bool {
        self.branches.iter().all(|branch| branch.whole.rank().is_some() && branch.strong.rank().is_some())
    }
}

/// Answers a question about the rank of a system's accessibility distribution. Of the question's options those that concern
/// outputs and singular values are not used.
///
/// ```
/// use palmistry_lang::System;
/// use palmistry_rank::sweep::{RankQuestion, answer_accessibility};
/// let mut system: System = r#"
///     system "A point that is moved sideways by turning alone"
///     state x, y, z
///     input g  x' = 1  z' = -y  others' = 0
///     input h  y' = 1  z' = x   others' = 0
///     sample x in [-1, 1] y in [-1, 1] z in [-1, 1]
/// "#.parse()?;
/// let answer = answer_accessibility(&mut system, &RankQuestion::default())?;
/// let branch = &answer.branches[0];
/// assert_eq!(branch.strong.rank(), Some(3));
/// assert_eq!(branch.brackets, ["g", "h", "[g, h]"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// No drift or input, conditions that cannot be solved, a pole everywhere, an empty sample box.
pub fn answer_accessibility(
    system: &mut System,
    question: &RankQuestion<'_>,
) -> Result<AccessibilityAnswer, RankError> {
    answer_accessibility_telling(system, question, &mut |_| ())
}

/// The same; `tell` is called with what is known before the end, each time more than before.
///
/// # Errors
/// As [`answer_accessibility`].
pub fn answer_accessibility_telling(
    system: &mut System,
    question: &RankQuestion<'_>,
    tell: &mut dyn FnMut(AccessibilityAnswer),
) -> Result<AccessibilityAnswer, RankError> {
    if system.states.is_empty() {
        return Err(RankError::NothingToSee(system.name.clone()));
    }
    system.require_motion().map_err(CodistributionError::NoMotion)?;
    let brackets = "accessibility by brackets is of continuous time";
    system.require_continuous(brackets).map_err(CodistributionError::NoMotion)?;
    if !system.zero_outputs().is_empty() {
        let tied = "an output is zero and ties known signals to states, so that nothing drives these at will: accessibility is not decided";
        return Err(RankError::Condition(tied.to_owned()));
    }
    let system = &mut without_outputs(system);
    let mut equations = Vec::new();
    for text in system.assumptions().iter().chain(&question.conditions) {
        equations.extend(parse_condition(text).map_err(RankError::Condition)?);
    }
    let branches = solve_conditions(system, &equations)?;
    let branches = left_by_inequalities(system, question, branches)?;
    let columns = Accessibility::columns_of(system);
    let mut answer = AccessibilityAnswer {
        file: system.name.clone(),
        title: system.title.clone(),
        fields: system.roles(),
        seed: question.seed,
        coordinates: columns.into_iter().map(|symbol| system.symbol_name(symbol).to_owned()).collect(),
        branches: Vec::new(),
    };
    let known = system.known.clone();
    for branch in branches {
        for symbol in question.fixed.keys() {
            if branch.values.contains_key(symbol) {
                return Err(RankError::HeldAndSolved(system.symbol_name(*symbol).to_owned()));
            }
        }
        branch.check_codistribution(system).map_err(RankError::Condition)?;
        let conditions = held_conditions(system, question, &branch);
        let held = held_parameters(system, question, &branch.values, std::iter::empty());
        let in_words = branch.in_words(system);
        let mut tell_of = |found: BracketsSoFar| {
            let mut so_far = answer.clone();
            so_far.branches.push(AccessibilityBranch {
                conditions: in_words.clone(),
                held: held.clone(),
                brackets: found.needed,
                order: found.order,
                stop: Stop::Interrupted,
                whole: found.whole,
                strong: found.strong,
                sampled: None,
            });
            tell(so_far);
        };
        let found = paid_on_a_copy(system, |system| {
            Ok(Accessibility::new(system, &conditions, question.order, &mut tell_of)?)
        })?;
        let leave = |system: &mut System, columns: &[Symbol]| {
            system.known = system.states.iter().copied().filter(|state| !columns.contains(state)).collect();
        };
        // the rows have a column for each of these, as those of codistributions have for unknowns
        leave(system, &found.columns);
        let (quick, all) = (found.needed_entries(), found.entries());
        let mut mentioned: Vec<NodeId> = all.clone();
        mentioned.extend(guarded(system));
        let locus = Locus::new(system, &branch, &question.fixed, &mentioned)?;
        let options = SweepOptions {
            samples: question.samples,
            seed: question.seed,
            most: None,
            guards: &[],
            wanted: question.wanted,
            digits: None,
            recorded: 0,
            interrupt: question.interrupt,
            progress: question.progress,
        };
        let sampled = sweep(system, &locus, &quick, &all, options)?;
        // where functions are met, a true state has to show that the rank is no less
        let shown =
            |system: &mut System, bounds: RankBounds, strong: bool| -> Result<RankBounds, RankError> {
                if bounds.at_least > 0 || bounds.at_most == 0 || question.interrupt.load(Ordering::Relaxed) {
                    return Ok(bounds);
                }
                system.known = known.clone();
                let minor = paid_on_a_copy(system, |system| Ok(found.minor(system, &conditions, strong)?))?;
                leave(system, &minor.columns);
                let few = SweepOptions {
                    samples: question.samples.min(STATES_OF_A_MINOR),
                    wanted: Certainty::Certified,
                    progress: &|_| (),
                    ..options
                };
                let report = sweep(system, &locus, &minor.entries, &minor.entries, few)?;
                // the least of them: where signs part the domain the rank of one part says nothing of another
                let sure = report.certified == report.samples;
                let rank = if sure { report.rank_histogram.keys().next().copied().unwrap_or(0) } else { 0 };
                Ok(RankBounds { at_least: rank.min(bounds.at_most), from_a_state: true, ..bounds })
            };
        let (whole, strong) = (shown(system, found.whole, false)?, shown(system, found.strong, true)?);
        system.known = known.clone();
        answer.branches.push(AccessibilityBranch {
            conditions: locus.conditions.clone(),
            held,
            brackets: found.needed.iter().map(|place| found.names[*place].clone()).collect(),
            order: found.order,
            stop: found.stop,
            whole,
            strong,
            sampled: Some(sampled),
        });
    }
    Ok(answer)
}

/// The system as far as its motion goes: what its outputs need to exist is nothing that matters here.
fn without_outputs(system: &System) -> System {
    let mut system = system.clone();
    system.outputs.clear();
    system.output_guards.clear();
    system
}
