//! The result, in the file's own symbols.

use super::algebra::{Algebra, Reach, with_angles};
use super::case::Case;
use super::choice;
use super::explore::{FullCase, Search, ShortCase};
use super::merge::merged;
use super::minor::Product;
use super::on_box::{BoxShare, share_of_the_box};
use super::real::{has_real_points, state_on};
use super::rows::Rows;
use super::shown::Shown;
use palmistry_budget::{Allowance, Budget, OF_A_QUESTION, Spent};
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{Guard, NodeId, add_guard};
use palmistry_rank::observability::{Codistribution, Length, WrittenState, solve_conditions};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// A set on which the rank drops, or may.
#[derive(Clone, Debug)]
pub struct DropSet {
    /// Its equations, as `omega0 = 0`.
    pub equations: Vec<String>,
    /// What does not vanish on it, as `x != 0`: the rest of what the equations describe is another set, or none.
    pub unless: Vec<String>,
    /// A rank that none of its states exceeds.
    pub rank: usize,
    /// Whether all of its states have it: else smaller sets within it may have a lower one.
    pub exactly: bool,
    /// Why it is not known that the rank is lower at all of its states; `None` where it is.
    pub open: Option<String>,
    /// A bound on the probability that the rank is not lower, as a power of two.
    pub log2_error: f64,
    /// A state of it in exact numbers, where one was found.
    pub state: Option<WrittenState>,
    /// Whether it is known to have states: equations in real numbers may have no solution.
    pub exists: bool,
}

/// A minor as a product of factors.
#[derive(Clone, Debug)]
pub struct UsedMinor {
    /// The equations of the set on which it was used; none where it is that of almost all states.
    pub equations: Vec<String>,
    /// Its rows.
    pub rows: Vec<String>,
    /// The states of its columns.
    pub columns: Vec<String>,
    /// Factors and their powers.
    pub factors: Vec<(String, i64)>,
}

/// Where the rank of the observability codistribution drops.
#[derive(Clone, Debug)]
pub struct DropAnswer {
    /// The name of the file.
    pub file: String,
    /// Its title.
    pub title: String,
    /// How many states there are.
    pub dimension: usize,
    /// The rank at almost all states.
    pub rank: usize,
    /// Whether higher Lie derivatives cannot raise it.
    pub is_final: bool,
    /// The initial conditions of the file: only states that meet them are considered.
    pub initial: Vec<String>,
    /// What has to hold for all Lie derivatives to exist.
    pub domain: Vec<String>,
    /// Where the rank is proved to be lower.
    pub sets: Vec<DropSet>,
    /// Where it may be lower.
    pub open: Vec<DropSet>,
    /// The minors by which it is proved to be no lower anywhere else.
    pub minors: Vec<UsedMinor>,
    /// How many sets were looked at, and how many of them are empty.
    pub cases: (usize, usize),
    /// Why the set was not found; `None` where it was.
    pub out_of_reach: Option<String>,
    /// Whether the search was interrupted: sets may be missing then, and may not be merged.
    pub interrupted: bool,
    /// If the sets are not known to be all: the share of the sample box on which interval certificates prove full rank, or why
    /// that is not known; `None` if they are.
    pub on_the_box: Option<Result<BoxShare, String>>,
    /// How long it took.
    pub seconds: f64,
}

impl DropAnswer {
    /// Whether the sets are all: off them the rank is proved to be what it is at almost all states.
    pub fn is_exact(&self) -> bool {
        self.is_final && self.open.is_empty() && self.out_of_reach.is_none()
    }
}

/// Finds where the rank of the observability codistribution drops.
///
/// # Errors
/// In words, where there is no codistribution.
pub fn where_it_drops(system: &mut System, seed: u64, interrupt: &AtomicBool) -> Result<DropAnswer, String> {
    where_it_drops_telling(system, seed, interrupt, &mut |_| ())
}

/// The same, and reports what is known on the way: the rank at almost all states, then each set as it is found, not yet merged.
///
/// # Errors
/// In words, where there is no codistribution.
pub fn where_it_drops_telling(
    system: &mut System,
    seed: u64,
    interrupt: &AtomicBool,
    tell: &mut dyn FnMut(DropAnswer),
) -> Result<DropAnswer, String> {
    let (found, last) = drops_within(system, seed, OF_A_QUESTION, interrupt, tell);
    let mut answer = match (found, last) {
        (Ok(answer), _) => answer?,
        (Err(spent), Some(last)) => {
            DropAnswer { out_of_reach: Some(format!("cut off: {spent}")), interrupted: false, ..last }
        }
        (Err(spent), None) => return Err(format!("cut off: {spent}")),
    };
    if !answer.is_exact() && answer.rank == answer.dimension {
        let begin = Instant::now();
        answer.on_the_box = Some(share_of_the_box(system, interrupt));
        answer.seconds += begin.elapsed().as_secs_f64();
    }
    Ok(answer)
}

/// What [`singular_set_at_once`] may take: some tenths of a second.
const OF_A_MOMENT: Allowance = Allowance { bytes: 1 << 28, nodes: 1 << 20, steps: 1 << 24 };

/// The same with a small budget, and without interval certificates: `None` where the search takes more. The work is counted and not timed, so that the
/// answer is the same on every machine.
///
/// # Errors
/// In words, where there is no codistribution.
pub fn singular_set_at_once(
    system: &mut System,
    seed: u64,
    interrupt: &AtomicBool,
) -> Result<Option<DropAnswer>, String> {
    let (found, _) = drops_within(system, seed, OF_A_MOMENT, interrupt, &mut |_| ());
    found.map_or(Ok(None), |answer| answer.map(Some)).map(|found| found.filter(|answer| !answer.interrupted))
}

/// An answer or why there is none, where the budget suffices; and the last thing that was told.
type WithinBudget = (Result<Result<DropAnswer, String>, Spent>, Option<DropAnswer>);

/// Finds where the rank drops with an allowance; a system whose budget is used up is left as it was.
fn drops_within(
    system: &mut System,
    seed: u64,
    allowed: Allowance,
    interrupt: &AtomicBool,
    tell: &mut dyn FnMut(DropAnswer),
) -> WithinBudget {
    let mentioned = mentioned_in_words(system);
    let budget = Arc::new(Budget::new(allowed));
    // what was being changed when the budget came to its end is not met again
    let (mut copy, mut last) = (system.clone(), None);
    let found = budget.within(|| {
        with_angles(&mut copy, &mentioned, |system| {
            drops_of(system, seed, interrupt, &mut |answer: DropAnswer| {
                last = Some(answer.clone());
                tell(answer);
            })
        })
    });
    if found.is_ok() {
        *system = copy;
    }
    (found, last)
}

/// All that Lie derivatives depend on: the outputs' differentials, the fields and where they exist.
pub(super) fn mentioned_in_words(system: &mut System) -> Vec<NodeId> {
    let outputs: Vec<NodeId> = system.outputs.iter().map(|(_, output)| *output).collect();
    let mut found: Vec<NodeId> = outputs.into_iter().flat_map(|output| system.differential(output)).collect();
    for field in system.moving_fields() {
        found.extend(system.fields[field].components.iter().map(|(_, rate)| *rate));
    }
    found.extend(system.smooth_guards(&system.moving_fields()).iter().map(|guard| guard.node));
    found
}

/// The initial conditions of the file.
#[derive(Default)]
struct Initial {
    vanishing: Vec<NodeId>,
    guards: Vec<Guard>,
    texts: Vec<String>,
}

/// The initial conditions of the file, as expressions that vanish and what these need to exist.
///
/// # Errors
/// In words, where a side is not a number.
fn initial_equations(system: &mut System) -> Result<Initial, String> {
    let mut found = Initial::default();
    for equation in system.initial_conditions().to_vec() {
        let mut sides = Vec::new();
        for side in [&equation.left, &equation.right] {
            let (value, needed) = system.elaborate_guarded(side).map_err(|problem| problem.message)?;
            found.guards.extend(needed);
            sides.push(value.as_number().ok_or("an initial condition is a number")?);
        }
        found.texts.push(format!("{} = {}", system.graph.text(sides[0]), system.graph.text(sides[1])));
        found.vanishing.push(system.graph.sub(sides[0], sides[1]));
    }
    Ok(found)
}

/// The same solved: values for states.
///
/// # Errors
/// In words, where they have no solution or several.
pub(super) fn initial_values(system: &mut System) -> Result<Assignment, String> {
    let equations = system.initial_conditions().to_vec();
    let mut branches = solve_conditions(system, &equations).map_err(|why| why.to_string())?;
    match (branches.pop(), branches.is_empty()) {
        (Some(only), true) => Ok(only.values),
        _ => Err("initial conditions are given in several ways".to_owned()),
    }
}

/// `Ok` where the rank is asked for at every state, and Lie derivatives are taken along fields.
///
/// # Errors
/// In words.
pub(super) fn on_all_states(system: &System) -> Result<(), String> {
    system.require_continuous("the singular set is found by Lie derivatives")?;
    if !system.zero_outputs().is_empty() {
        return Err(
            "outputs that are zero tie the states to signals: no rank is asked for at all of them".to_owned()
        );
    }
    Ok(())
}

fn drops_of(
    system: &mut System,
    seed: u64,
    interrupt: &AtomicBool,
    tell: &mut dyn FnMut(DropAnswer),
) -> Result<DropAnswer, String> {
    let begin = Instant::now();
    on_all_states(system)?;
    let initial = initial_values(system)?;
    let words = Codistribution::new(system, &initial, Length::UntilItStops)?;
    let (rank, is_final) = (words.generic_rank(), words.is_final());
    let Initial { vanishing: conditions, guards: needed, texts } = initial_equations(system)?;
    let guards: Vec<Guard> = {
        let mut guards = system.smooth_guards(&system.moving_fields());
        needed.into_iter().for_each(|guard| add_guard(&system.graph, &mut guards, guard));
        guards.retain(|guard| guard.is_obvious(&system.graph) != Some(true));
        guards
    };
    let mut answer = DropAnswer {
        file: system.name.clone(),
        title: system.title.clone(),
        dimension: system.unknown_count(),
        rank,
        is_final,
        initial: texts,
        domain: guards.iter().map(|guard| guard.text(&system.graph)).collect(),
        sets: Vec::new(),
        open: Vec::new(),
        minors: Vec::new(),
        cases: (0, 0),
        out_of_reach: None,
        interrupted: false,
        on_the_box: None,
        seconds: 0.0,
    };
    let mut so_far = answer.clone();
    (so_far.out_of_reach, so_far.interrupted) = (Some("it was interrupted".to_owned()), true);
    tell(so_far.clone());
    let rows = Rows::of_lie_derivatives(system);
    let asked = Asked { rank, guards, conditions, ..Asked::default() };
    let found = prepared(system, rows, &asked, seed, interrupt, |algebra, search| {
        let explored = &search.run_telling(algebra, &mut |algebra, search, short| {
            let alone = Shown::alone(algebra, short);
            so_far.sets.push(described(algebra, search, alone));
            so_far.seconds = begin.elapsed().as_secs_f64();
            tell(so_far.clone());
        })?;
        answer.out_of_reach.clone_from(&explored.stopped);
        if explored.full.is_empty() && explored.short.is_empty() {
            answer.out_of_reach = Some("there is no state at which all terms are defined".to_owned());
        }
        answer.cases = (explored.cases, explored.empty);
        answer.minors = explored.full.iter().map(|full| used(algebra, &search.rows, full)).collect();
        let (sets, open): (Vec<_>, Vec<_>) =
            merged(algebra, search, &explored.short).into_iter().partition(|shown| shown.lower.is_ok());
        let mut described = |shown: Vec<Shown>| -> Vec<DropSet> {
            shown.into_iter().map(|shown| described(algebra, search, shown)).collect()
        };
        answer.sets = described(sets);
        answer.open = described(open);
        Ok(())
    });
    if let Err(why) = found {
        answer.out_of_reach = Some(why);
    }
    answer.interrupted = answer.out_of_reach.is_some() && interrupt.load(Ordering::Relaxed);
    answer.seconds = begin.elapsed().as_secs_f64();
    Ok(answer)
}

/// What is asked of rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Asked {
    pub rank: usize,
    /// What has to hold for the rows to exist, and for whatever else is said.
    pub guards: Vec<Guard>,
    /// What vanishes.
    pub conditions: Vec<NodeId>,
    /// What does not.
    pub nonzero: Vec<NodeId>,
    /// What else is asked about, and so may stand for a coordinate of its own.
    pub mentioned: Vec<NodeId>,
}

/// Gets ready to follow all states, and has that done while the algebra lasts.
pub(super) fn prepared<T>(
    system: &mut System,
    rows: Rows,
    asked: &Asked,
    seed: u64,
    interrupt: &AtomicBool,
    work: impl FnOnce(&mut Algebra<'_>, &mut Search<'_>) -> Reach<T>,
) -> Reach<T> {
    let mut mentioned: Vec<NodeId> = rows.rows.iter().flatten().copied().collect();
    if rows.is_of_lie_derivatives() {
        for field in system.moving_fields() {
            mentioned.extend(system.fields[field].components.iter().map(|(_, rate)| *rate));
        }
    }
    mentioned.extend(asked.guards.iter().map(|guard| guard.node));
    mentioned.extend(asked.conditions.iter().chain(&asked.nonzero).chain(&asked.mentioned));
    let of_lie_derivatives = rows.is_of_lie_derivatives();
    let mut algebra = Algebra::new(system, &mentioned);
    let mut search = Search {
        rows,
        rank: asked.rank,
        guards: asked.guards.clone(),
        conditions: asked.conditions.clone(),
        nonzero: asked.nonzero.clone(),
        interrupt,
        rng: ChaCha8Rng::seed_from_u64(seed),
        known: Vec::new(),
    };
    if of_lie_derivatives {
        search.rows.extend(&mut algebra);
        choice::choose(&mut algebra, &mut search)?;
    }
    work(&mut algebra, &mut search)
}

/// The equations of a case, one after the other, as texts.
fn equations(algebra: &mut Algebra<'_>, case: &Case) -> Vec<String> {
    let shown = Shown::around(&ShortCase { case: case.clone(), rank: 0, lower: Ok(0.0) });
    shown.texts(algebra)
}

fn used(algebra: &mut Algebra<'_>, rows: &Rows, full: &FullCase) -> UsedMinor {
    let states = algebra.system.column_names();
    let columns = full.chosen.columns.iter();
    UsedMinor {
        equations: equations(algebra, &full.case),
        rows: full.chosen.rows.iter().map(|row| rows.names[*row].clone()).collect(),
        columns: match rows.is_of_lie_derivatives() {
            true => columns.filter_map(|column| states.get(*column).cloned()).collect(),
            false => columns.map(|column| format!("column {}", column + 1)).collect(),
        },
        factors: shown_factors(algebra, &full.minor),
    }
}

/// The factors that say something, as texts.
fn shown_factors(algebra: &mut Algebra<'_>, minor: &Product) -> Vec<(String, i64)> {
    let mut found = Vec::new();
    for (factor, power) in &minor.powers {
        let node = algebra.shown(factor);
        // the square of the secant of half an angle
        if algebra.system.graph.constant_value(node).is_none() {
            found.push((algebra.system.graph.text(node), *power));
        }
    }
    found
}

fn described(algebra: &mut Algebra<'_>, search: &mut Search<'_>, shown: Shown) -> DropSet {
    let state = shown.cases.iter().find_map(|case| state_on(algebra, search, case, &[]));
    let exists = state.is_some() || shown.cases.iter().any(|case| has_real_points(algebra, search, case));
    DropSet {
        equations: shown.texts(algebra),
        unless: shown.unless(algebra),
        rank: shown.rank,
        exactly: shown.exactly,
        log2_error: *shown.lower.as_ref().unwrap_or(&0.0),
        open: shown.lower.err(),
        state: state.map(|state| state.describe(algebra.system)),
        exists,
    }
}
