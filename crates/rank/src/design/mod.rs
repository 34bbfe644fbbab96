//! What to measure or to know besides, so that given unknowns become observable or identifiable: all minimal sets of further outputs,
//! known parameters, known initial conditions, inputs and experiments.
//!
//! What is added is written as lines of the file, so that a set that is found is a system as a person would write it. Which sets suffice follows from
//! the rows at one random point: those of an output are the same whatever else is measured. What is found so is then decided anew as the question of
//! any file, and that nothing of it can be left out as well.
//!
//! Reference: A. F. Villaverde, *Observability and structural identifiability of nonlinear biological systems*, Complexity 2019, section 4, for what is asked.

mod search;
mod variant;

use crate::observability::{
    CodistributionError, Frame, Observability, SOLUTIONS_WORK, SmoothPart, Solutions, SolutionsQuestion,
    parse_condition, smooth_part, solutions, solve_conditions,
};
use crate::sweep::{RankQuestion, held_conditions, held_parameters, named_unknowns};
use dashu::rational::RBig;
use palmistry_budget::{Allowance, OF_A_QUESTION, paid};
use palmistry_lang::{Assignment, System, Time, UnknownKind};
use palmistry_math::expression::Guard;
use search::{Search, Sets};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use variant::Additions;

/// Something that can be added to an experiment.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Addition {
    /// A further output, in the notation of the language.
    Output(String),
    /// A parameter is known.
    Known(String),
    /// The initial condition of a state is known.
    Initial(String),
    /// A known input moves a state: it is added to its rate.
    Input(String),
    /// A further experiment with the system, from other initial conditions.
    Experiment,
}

/// Kinds of what can be added.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AdditionKind {
    /// Outputs.
    Outputs,
    /// Known parameters.
    Known,
    /// Known initial conditions.
    Initial,
    /// Inputs.
    Inputs,
    /// Experiments.
    Experiments,
}

/// What is asked.
pub struct DesignQuestion<'a> {
    /// The unknowns that are to be identified; all of them where none is named.
    pub targets: Vec<String>,
    /// What may be added.
    pub kinds: Vec<AdditionKind>,
    /// What can be measured, in the notation of the language; each state where nothing is said.
    pub measurable: Option<Vec<String>>,
    /// Sets of no more additions are looked for.
    pub at_most: usize,
    /// Whether one value is asked for (globally), and not finitely many (locally).
    pub globally: bool,
    /// With `globally`: how much work may be done, in products of residues.
    pub work: u64,
    /// The folder of the file, from which what it imports is read.
    pub folder: &'a Path,
    /// Set from outside to stop early.
    pub interrupt: &'a AtomicBool,
    /// Called with the number of sets that were looked at.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

impl<'a> DesignQuestion<'a> {
    /// A question about a file of a folder: all unknowns, locally, by up to three outputs, parameters, inputs or experiments.
    pub fn of(folder: &'a Path, interrupt: &'a AtomicBool) -> DesignQuestion<'a> {
        use AdditionKind::{Experiments, Inputs, Known, Outputs};
        DesignQuestion {
            targets: Vec::new(),
            kinds: vec![Outputs, Known, Inputs, Experiments],
            measurable: None,
            at_most: 3,
            globally: false,
            work: SOLUTIONS_WORK,
            folder,
            interrupt,
            progress: &|_| (),
        }
    }
}

/// An unknown that is to be identified.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignTarget {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: UnknownKind,
    /// Whether it is locally observable without additions.
    pub observability: Observability,
    /// How many values it has without additions, where a single one is asked for.
    pub solutions: Option<Solutions>,
}

/// A set of additions that suffices, and of which nothing can be left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// What is added.
    pub additions: Vec<Addition>,
    /// That it suffices, and that nothing can be left out, errs with a probability below two to this power, minus infinity where it is certain; nothing where one of
    /// the two was computed at random points and no more.
    pub log2_error: Option<f64>,
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignAnswer {
    /// The file's name.
    pub file: String,
    /// Its title.
    pub title: String,
    /// What is to be identified, and what is known of it without additions.
    pub targets: Vec<DesignTarget>,
    /// Whether one value was asked for.
    pub globally: bool,
    /// Parameters fixed at their values in the file.
    pub held: Vec<(String, RBig)>,
    /// Whether nothing needs to be added.
    pub is_met: bool,
    /// How many single additions there are to choose from.
    pub candidates: usize,
    /// All minimal sets, smallest first.
    pub designs: Vec<Design>,
    /// Sets that sufficed at the random point of the search and, decided anew, do not: they are not among the designs.
    pub contradicted: usize,
    /// All sets of up to so many additions were looked at.
    pub looked_at: usize,
    /// Candidates that could not be used, and why.
    pub left_out: Vec<(Addition, String)>,
    /// Why larger sets, or some of these, were not looked at.
    pub open: Option<String>,
}

/// No more additions are looked for at once.
const MOST_ADDITIONS: usize = 8;

/// Why there is no answer.
#[derive(Clone, Debug)]
pub enum DesignError {
    /// The file has no unknowns or no outputs, or is of a kind for which no designs are made, or a name is none of its unknowns.
    Question(String),
    /// As for the rank.
    Rank(CodistributionError),
    /// Memory beyond what a question may take.
    CutOff(String),
}

impl std::fmt::Display for DesignError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            DesignError::Question(why) | DesignError::CutOff(why) => f.write_str(why),
            DesignError::Rank(why) => why.fmt(f),
        }
    }
}

impl std::error::Error for DesignError {}

impl From<CodistributionError> for DesignError {
    fn from(why: CodistributionError) -> DesignError {
        DesignError::Rank(why)
    }
}

/// All minimal sets of additions by which given unknowns become identifiable.
///
/// ```
/// use palmistry_lang::System;
/// use palmistry_rank::design::{Addition, DesignQuestion, design};
/// let system: System = r#"
///     system "An amount that leaves, seen in a unit that nobody knows"
///     state x
///     param k, scale unknown
///     drift f  x' = -k*x
///     output scale*x
/// "#.parse()?;
/// let never = Default::default();
/// let question = DesignQuestion { targets: vec!["scale".into()], ..DesignQuestion::of("".as_ref(), &never) };
/// let answer = design(&system, &question)?;
/// // the rate is known as things stand; the scale is by the amount itself, or by an input of known size
/// let sets: Vec<_> = answer.designs.iter().map(|design| design.additions.clone()).collect();
/// assert_eq!(sets, [vec![Addition::Output("x".into())], vec![Addition::Input("x".into())]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Names that are no unknowns, no outputs, no drift or input, more memory than a question may take.
pub fn design(system: &System, question: &DesignQuestion<'_>) -> Result<DesignAnswer, DesignError> {
    let found = paid(Allowance { steps: u64::MAX, ..OF_A_QUESTION }, || answered(system, question));
    found.unwrap_or_else(|spent| Err(DesignError::CutOff(spent.to_string())))
}

fn answered(system: &System, question: &DesignQuestion<'_>) -> Result<DesignAnswer, DesignError> {
    system.require_motion().map_err(CodistributionError::NoMotion)?;
    if system.outputs.is_empty() || system.unknown_count() == 0 {
        return Err(DesignError::Question(format!("{} has no unknowns or no outputs", system.name)));
    }
    let refused = |why: &str| Err(DesignError::Question(why.to_owned()));
    // which sets suffice is looked for along flows
    if system.time == Time::Discrete {
        return refused("designs are made in continuous time alone, and this system goes in steps");
    }
    if !system.zero_outputs().is_empty() || system.highest_lie_order().is_some() {
        return refused(
            "outputs that are zero tie known signals to states, and of these no designs are made",
        );
    }
    if !(1..=MOST_ADDITIONS).contains(&question.at_most) {
        return refused(&format!("sets of 1 to {MOST_ADDITIONS} additions are looked for"));
    }
    let names = system.column_names();
    for name in &question.targets {
        if !names.contains(name) {
            let all = names.join(", ");
            return Err(DesignError::Question(format!(
                "'{name}' is no unknown of {}; these are: {all}",
                system.name
            )));
        }
    }
    // what is added is written as a line of the file
    let is_broken = |text: &&String| text.chars().any(char::is_control);
    if let Some(text) = question.measurable.iter().flatten().find(is_broken) {
        return Err(DesignError::Question(format!("{text:?} is no expression in one line")));
    }
    let wanted: Vec<String> = match question.targets.is_empty() {
        true => names,
        false => question.targets.clone(),
    };
    let mut judge = Judge { question, wanted: &wanted, work: 0 };
    let now = judge.judged(system.clone())?;
    let held = held_parameters(system, &RankQuestion::default(), &Assignment::new(), std::iter::empty());
    let kinds = named_unknowns(system);
    let targets =
        wanted.iter().zip(now.seen.iter().zip(&now.solutions)).filter_map(|(name, (seen, solutions))| {
            let (_, kind) = kinds.iter().find(|(known, _)| known == name)?;
            Some(DesignTarget {
                name: name.clone(),
                kind: *kind,
                observability: *seen,
                solutions: solutions.clone(),
            })
        });
    let mut answer = DesignAnswer {
        file: system.name.clone(),
        title: system.title.clone(),
        targets: targets.collect(),
        globally: question.globally,
        held,
        is_met: now.is_met(),
        candidates: 0,
        designs: Vec::new(),
        contradicted: 0,
        looked_at: 0,
        left_out: Vec::new(),
        open: None,
    };
    if answer.is_met {
        return Ok(answer);
    }
    let additions = Additions::of(system, question, &wanted);
    answer.candidates = additions.count();
    let mut search = Search::new(system, question, &wanted, additions);
    let mut undecided = (0, None);
    for size in 1..=question.at_most {
        let mut proofs = Vec::new();
        // what is decided anew counts, and not the one random point: where a set does not suffice a larger one may
        let mut is_enough = |set: &[Addition]| match judge.proof(system, set) {
            Proof::Proved(log2_error) => {
                proofs.push(Some(log2_error));
                true
            }
            Proof::Computed => {
                proofs.push(None);
                true
            }
            Proof::NotMet { is_local } => {
                answer.contradicted += usize::from(is_local);
                false
            }
            Proof::Undecided(why) => {
                undecided.0 += 1;
                undecided.1.get_or_insert(why);
                false
            }
        };
        let Sets { sets, open } = search.of_size(size, &mut is_enough);
        let designs = sets.into_iter().zip(proofs);
        answer.designs.extend(designs.map(|(additions, log2_error)| Design { additions, log2_error }));
        if open.is_some() {
            answer.open = open;
            break;
        }
        answer.looked_at = size;
    }
    answer.left_out = search.left_out();
    if let (sets, Some(why)) = &undecided
        && answer.open.is_none()
    {
        answer.open = Some(format!("of {sets} among them it is undecided whether they suffice: {why}"));
    }
    if question.interrupt.load(Ordering::Relaxed) && answer.looked_at < question.at_most {
        answer.open = Some("it was interrupted".to_owned());
    }
    Ok(answer)
}

/// How the targets stand in one system.
struct Judged {
    seen: Vec<Observability>,
    /// Where one value is asked for.
    solutions: Vec<Option<Solutions>>,
    /// Why something of the rank is open.
    open: Option<String>,
    /// The error probability of what is found observable or unobservable, as a power of two.
    log2_error: f64,
    /// That there is one value each, where it is proved.
    one: Option<f64>,
    /// Whether a symmetry shows that one of them has several values.
    has_several: bool,
}

/// What is known of a set that sufficed at a random point.
enum Proof {
    /// It suffices, and nothing of it can be left out, but for this probability of an error.
    Proved(f64),
    /// One of the two is computed.
    Computed,
    /// It is undecided whether it suffices, and why.
    Undecided(String),
    /// It does not suffice: not even locally, or several values remain.
    NotMet { is_local: bool },
}

impl Judged {
    fn is_met(&self) -> bool {
        self.seen.iter().all(|seen| *seen == Observability::Yes)
            && self.solutions.iter().flatten().all(|solutions| *solutions == Solutions::Finite(1))
    }

    /// Why it is not known whether all of them are identifiable, where none is shown not to be.
    fn undecided(&self) -> Option<String> {
        if self.seen.contains(&Observability::No) {
            return None;
        }
        let of_rank = self
            .seen
            .contains(&Observability::Undecided)
            .then(|| self.open.clone().unwrap_or_else(|| "the rank is not known".to_owned()));
        let of_values = || {
            self.solutions.iter().flatten().find_map(|solutions| match solutions {
                Solutions::Undecided(why) => Some(why.clone()),
                _ => None,
            })
        };
        of_rank.or_else(of_values)
    }

    /// Whether it is shown that one of them is not identifiable.
    fn is_refuted(&self) -> bool {
        self.seen.contains(&Observability::No) || self.has_several
    }
}

/// Asks the question of any file of one with additions.
struct Judge<'a> {
    question: &'a DesignQuestion<'a>,
    wanted: &'a [String],
    work: u64,
}

impl Judge<'_> {
    fn judged(&mut self, mut system: System) -> Result<Judged, DesignError> {
        let equations = system.initial_conditions().to_vec();
        let branches = solve_conditions(&mut system, &equations)
            .map_err(|why| DesignError::Question(why.to_string()))?;
        let [branch] = branches.as_slice() else {
            let why = "initial conditions are given in several ways: of these no design is made";
            return Err(DesignError::Question(why.to_owned()));
        };
        // parameters have the values that they have for the rank
        let conditions = held_conditions(&mut system, &RankQuestion::default(), branch);
        // what is assumed has to leave an open set of states, since all that is said is of almost all states
        let mut assumed = Vec::new();
        for text in system.assumptions() {
            assumed.extend(parse_condition(&text).map_err(DesignError::Question)?);
        }
        let assumed: Vec<Guard> = solve_conditions(&mut system, &assumed)
            .map_err(|why| DesignError::Question(why.to_string()))?
            .into_iter()
            .flat_map(|branch| branch.guards)
            .collect();
        if let SmoothPart::Thin(why) =
            smooth_part(&mut system, branch, &conditions, &assumed).map_err(DesignError::Question)?
        {
            return Err(DesignError::Question(why));
        }
        let generic = Frame::new(&mut system, &conditions)?.generic;
        let seen = |name: &String| {
            let of_it = generic.unknowns.iter().find(|(symbol, _)| system.symbol_name(*symbol) == name);
            of_it.map_or(Observability::Undecided, |(_, seen)| *seen)
        };
        let seen: Vec<Observability> = self.wanted.iter().map(seen).collect();
        let mut judged = Judged {
            solutions: vec![None; seen.len()],
            open: generic.open.clone(),
            log2_error: generic.log2_error,
            one: None,
            has_several: false,
            seen,
        };
        if !self.question.globally {
            return Ok(judged);
        }
        if judged.seen.iter().any(|seen| *seen != Observability::Yes) {
            let of = |seen: &Observability| match seen {
                Observability::No => Some(Solutions::Infinite),
                _ => None,
            };
            judged.solutions = judged.seen.iter().map(of).collect();
            return Ok(judged);
        }
        let work = self.question.work.saturating_sub(self.work);
        let asked = SolutionsQuestion {
            conditions,
            expressions: Vec::new(),
            work,
            interrupt: self.question.interrupt,
        };
        let found = solutions(&mut system, &asked)?;
        self.work += found.work;
        let of = |name: &String| found.unknowns.iter().find(|of_it| of_it.name == *name);
        judged.solutions =
            self.wanted.iter().map(|name| of(name).map(|of_it| of_it.solutions.clone())).collect();
        judged.has_several = self.wanted.iter().filter_map(of).any(|of_it| of_it.at_least.is_some());
        judged.one = self.wanted.iter().try_fold(f64::NEG_INFINITY, |worst, name| {
            let (most, log2_error) = of(name)?.at_most?;
            (most == 1).then_some(worst.max(log2_error))
        });
        Ok(judged)
    }

    /// What proves that a set suffices and that nothing of it can be left out.
    fn proof(&mut self, system: &System, set: &[Addition]) -> Proof {
        let question = self.question;
        let mut with = |set: &[Addition]| {
            self.judged(variant::with(system, question, set)?).map_err(|why| why.to_string())
        };
        let whole = match with(set) {
            Ok(whole) => whole,
            Err(why) => return Proof::Undecided(why),
        };
        if let Some(why) = whole.undecided() {
            return Proof::Undecided(why);
        }
        let is_local = whole.seen.contains(&Observability::No);
        if is_local || (question.globally && !whole.is_met()) {
            return Proof::NotMet { is_local };
        }
        let mut errors = vec![whole.log2_error];
        match whole.one {
            Some(log2_error) => errors.push(log2_error),
            None if question.globally => return Proof::Computed,
            None => {}
        }
        for place in 0..set.len() {
            let others = set.iter().enumerate().filter(|(other, _)| *other != place);
            let fewer: Vec<Addition> = others.map(|(_, one)| one.clone()).collect();
            match with(&fewer) {
                Ok(fewer) if fewer.has_several => {} // certain
                Ok(fewer) if fewer.is_refuted() => errors.push(fewer.log2_error),
                _ => return Proof::Computed,
            }
        }
        let worst = errors.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // no more than so many of them
        let sum = worst + (errors.len() as f64).log2();
        Proof::Proved(if worst == f64::NEG_INFINITY { worst } else { sum })
    }
}
