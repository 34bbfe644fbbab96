//! How many values of each unknown give the same outputs: the question as it is asked of a file.

use super::asked::held_conditions;
use super::paid::paid_for_memory;
use super::question::{RankError, held_parameters, named_unknowns};
use super::{Certainty, RankQuestion};
use crate::observability::{
    Branch, CodistributionError, IdentifiableFunctions, SmoothPart, Solutions, SolutionsAnswer, SolutionsOf,
    SolutionsQuestion, identifiable_functions, smooth_part, solutions_telling, solve_conditions,
};
use dashu::rational::RBig;
use palmistry_lang::System;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// What is known of the values of all unknowns of a file.
#[derive(Clone, Debug)]
pub struct GlobalAnswer {
    /// The file's name.
    pub file: String,
    /// Its title.
    pub title: String,
    /// The initial conditions that the file gives, in words.
    pub conditions: Vec<String>,
    /// Parameters fixed at their values in the file.
    pub held: Vec<(String, RBig)>,
    /// The names of known coordinates.
    pub known: Vec<String>,
    /// What was found.
    pub solutions: SolutionsAnswer,
    /// Generators of all identifiable functions, where they were asked for.
    pub functions: Option<IdentifiableFunctions>,
    /// Whether it was interrupted before the end.
    pub interrupted: bool,
    /// How long it took, in s.
    pub seconds: f64,
}

impl GlobalAnswer {
    /// Whether the number of values of each unknown is known, be it computed or proved, and where generators of the identifiable functions were
    /// asked for, whether they are.
    pub fn is_final(&self) -> bool {
        let is_known = |of_it: &SolutionsOf| !matches!(of_it.solutions, Solutions::Undecided(_));
        self.solutions.unknowns.iter().all(is_known)
            && self.functions.as_ref().is_none_or(IdentifiableFunctions::generate_all)
    }
}

/// What is asked beside the number of values of each unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolutionsWanted {
    /// Nothing.
    Values,
    /// Generators of all identifiable functions.
    Functions,
}

/// How many values of each unknown of a system give the same outputs, at almost all states.
///
/// ```
/// use palmistry_lang::System;
/// use palmistry_rank::{observability::Solutions, sweep::{SolutionsWanted, answer_solutions}};
/// let mut system: System = r#"
///     system "A rate that is the square of a constant"
///     state x
///     param k unknown
///     drift f  x' = -k^2*x
///     output x
/// "#.parse()?;
/// let answer = answer_solutions(&mut system, SolutionsWanted::Functions, 1_000_000, &Default::default())?;
/// let of_k = &answer.solutions.unknowns[1];
/// assert_eq!(of_k.solutions, Solutions::Finite(2));
/// // the one is minus the other: proved
/// assert_eq!(of_k.at_least.as_ref().map(|(_, map)| map.as_str()), Some("k -> -k"));
/// // its square has one value, and with the state it generates all that does
/// let functions = answer.functions.ok_or("asked for")?;
/// assert_eq!(functions.functions.iter().map(|of_it| of_it.text.as_str()).collect::<Vec<_>>(), ["x", "k^2"]);
/// assert!(functions.generate_all());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// No unknowns or no outputs, no drift or input, initial conditions that cannot be solved for.
pub fn answer_solutions(
    system: &mut System,
    wanted: SolutionsWanted,
    work: u64,
    interrupt: &AtomicBool,
) -> Result<GlobalAnswer, RankError> {
    answer_solutions_telling(system, wanted, work, interrupt, &mut |_| ())
}

/// The same, and hands on what is known before the end as soon as it is: as an answer that was interrupted.
///
/// # Errors
/// As for [`answer_solutions`].
pub fn answer_solutions_telling(
    system: &mut System,
    wanted: SolutionsWanted,
    work: u64,
    interrupt: &AtomicBool,
    known: &mut dyn FnMut(GlobalAnswer),
) -> Result<GlobalAnswer, RankError> {
    let begin = Instant::now();
    if system.unknown_count() == 0 || system.outputs.is_empty() {
        return Err(RankError::NothingToSee(system.name.clone()));
    }
    system.require_motion().map_err(CodistributionError::NoMotion)?;
    let equations = system.initial_conditions().to_vec();
    let branches = solve_conditions(system, &equations)?;
    let [branch] = branches.as_slice() else {
        let several = "initial conditions that are given in several ways: of these no values are counted";
        return Err(RankError::Condition(several.to_owned()));
    };
    let conditions = given(system, branch);
    // local answers are those at states where the outputs that are zero vanish
    let branch = &branch.clone().tied_by_outputs(system)?;
    let asked =
        RankQuestion { samples: 0, wanted: Certainty::Computed, interrupt, ..RankQuestion::default() };
    let held = held_parameters(system, &asked, &branch.values, std::iter::empty());
    let conditions_held = held_conditions(system, &asked, branch);
    if let SmoothPart::Thin(why) =
        smooth_part(system, branch, &conditions_held, &[]).map_err(RankError::Condition)?
    {
        return Err(RankError::Condition(why));
    }
    let question =
        SolutionsQuestion { conditions: conditions_held, expressions: Vec::new(), work, interrupt };
    let kinds = named_unknowns(system);
    let blank = GlobalAnswer {
        file: system.name.clone(),
        title: system.title.clone(),
        conditions,
        held,
        known: system.known_names(),
        solutions: SolutionsAnswer::default(),
        functions: None,
        interrupted: true,
        seconds: 0.0,
    };
    let finished = |mut solutions: SolutionsAnswer| {
        // a state that nothing moves is a constant
        for (of_it, (_, kind)) in solutions.unknowns.iter_mut().zip(&kinds) {
            of_it.kind = Some(*kind);
        }
        GlobalAnswer { solutions, seconds: begin.elapsed().as_secs_f64(), ..blank.clone() }
    };
    let (found, functions) = paid_for_memory(system, |system| {
        let found = solutions_telling(system, &question, &mut |so_far| known(finished(so_far)))?;
        let functions = (wanted == SolutionsWanted::Functions).then(|| {
            known(finished(found.clone()));
            identifiable_functions(system, &question, &found)
        });
        Ok((found, functions))
    })?;
    let answer = GlobalAnswer { functions, ..finished(found) };
    // what is final has lost nothing
    let interrupted = interrupt.load(Ordering::Relaxed) && !answer.is_final();
    Ok(GlobalAnswer { interrupted, ..answer })
}

fn given(system: &System, branch: &Branch) -> Vec<String> {
    let mut list: Vec<_> = branch.values.iter().collect();
    list.sort_unstable();
    list.into_iter()
        .map(|(symbol, value)| format!("{} = {}", system.symbol_name(*symbol), system.graph.text(*value)))
        .collect()
}
