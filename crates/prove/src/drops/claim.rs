//! That a rank is what is claimed at all states, but for some sets that are named.

use super::algebra::{Algebra, Reach, with_angles};
use super::case::Case;
use super::cover::{NamedSet, off_sets};
use super::explore::{Explored, FullCase, Search};
use super::merge::merged;
use super::real::{exact_values, irrational_state, state_on};
use super::rows::Rows;
use super::sets::{Asked, initial_values, mentioned_in_words, prepared};
use super::shown::Shown;
use dashu::rational::RBig;
use palmistry_lang::{Matrix, System, determinant};
use palmistry_math::expression::{Guard, Need, NodeId};
use palmistry_math::number::Rationals;
use palmistry_rank::observability::{
    Codistribution, GenericRank, Length, State, WrittenState, generic_rank, rank,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

/// The claim, read.
#[derive(Clone, Debug)]
pub(crate) struct ClaimedEverywhere {
    /// A matrix of the file by rows, and its columns; nothing for the observability codistribution.
    pub matrix: Option<(Vec<NodeId>, usize)>,
    pub rank: usize,
    /// Whether the claim is that it is no less.
    pub may_be_greater: bool,
    /// What has to hold for all terms to exist.
    pub guards: Vec<Guard>,
    /// What vanishes at all states that are spoken of.
    pub conditions: Vec<NodeId>,
    /// The sets that are left out.
    pub except: Vec<NamedSet>,
    /// Whether states of all cases are asked for.
    pub with_examples: bool,
}

impl ClaimedEverywhere {
    /// The rank that is claimed, in words.
    pub fn in_words(&self) -> String {
        format!("{}{}", if self.may_be_greater { "at least " } else { "" }, self.rank)
    }
}

/// A minor as a product, both in symbols of their own.
#[derive(Clone, Debug)]
pub(crate) struct MinorIdentity {
    pub minor: NodeId,
    pub product: NodeId,
    /// What must not vanish for both to exist.
    pub guards: Vec<Guard>,
}

/// The rows that show the rank, and a state of each case on which they do, as far as one was found.
#[derive(Clone, Debug, Default)]
pub(crate) struct StatesOfCases {
    /// What the rows are of.
    pub row_names: Vec<String>,
    /// Their entries, one row after the other, as the file has them.
    pub entries: Vec<NodeId>,
    pub states: Vec<State>,
}

/// What became of a claim.
#[derive(Clone, Debug)]
pub(crate) enum Everywhere {
    /// The rank is what is claimed wherever it is claimed to be.
    Proved {
        /// In how many cases, and how many of them are empty.
        cases: (usize, usize),
        minors: Vec<MinorIdentity>,
        examples: StatesOfCases,
        /// What the rank is on the sets that are left out, in words.
        beside: Vec<String>,
        log2_error: f64,
    },
    /// At a state where it is claimed to be so the rank is another one.
    Refuted { state: State, found: usize, set: Vec<String>, log2_error: f64 },
    /// At a state of which one number is irrational the rank is lower than claimed: at most this.
    RefutedAt { state: WrittenState, at_most: usize, set: Vec<String>, log2_error: f64 },
    /// Neither, in words.
    Open(String),
}

/// Decides a claim about a rank at all states.
///
/// # Errors
/// In words, where it is out of reach.
pub(crate) fn decide_everywhere(
    system: &mut System,
    claim: &ClaimedEverywhere,
    seed: u64,
    interrupt: &AtomicBool,
) -> Result<Everywhere, String> {
    let mut mentioned = match &claim.matrix {
        Some((entries, _)) => entries.clone(),
        None => mentioned_in_words(system),
    };
    mentioned.extend(claim.guards.iter().map(|guard| guard.node));
    mentioned
        .extend(claim.conditions.iter().copied().chain(claim.except.iter().flat_map(NamedSet::mentioned)));
    with_angles(system, &mentioned, |system| decided(system, claim, seed, interrupt))
}

fn decided(
    system: &mut System,
    claim: &ClaimedEverywhere,
    seed: u64,
    interrupt: &AtomicBool,
) -> Result<Everywhere, String> {
    if claim.matrix.is_none() {
        super::sets::on_all_states(system)?;
    }
    let columns = claim.matrix.as_ref().map_or(system.unknown_count(), |(_, columns)| *columns);
    let height =
        claim.matrix.as_ref().map_or(usize::MAX, |(entries, columns)| entries.len() / (*columns).max(1));
    let mut log2_error = f64::NEG_INFINITY;
    let mut greatest = columns.min(height);
    let is_too_high = claim.rank > greatest;
    if is_too_high && claim.matrix.is_none() {
        return Err(format!("no rank there exceeds {greatest}"));
    }
    if claim.rank < greatest && !claim.may_be_greater {
        // no state has a higher rank than almost all have
        (greatest, log2_error) = at_almost_all(system, claim, seed)?;
    }
    let rows = |system: &mut System| match &claim.matrix {
        None => Rows::of_lie_derivatives(system),
        Some((entries, columns)) => Rows::of_matrix(&system.graph, entries, *columns),
    };
    let mentioned: Vec<NodeId> = claim.except.iter().flat_map(NamedSet::mentioned).collect();
    let asked = Asked {
        rank: claim.rank.min(greatest),
        guards: claim.guards.clone(),
        conditions: claim.conditions.clone(),
        // where one equation describes a set, its left side does not vanish off it
        nonzero: claim.except.iter().filter_map(NamedSet::single).collect(),
        mentioned,
    };
    if is_too_high || greatest > claim.rank && !claim.may_be_greater {
        let all_rows = rows(system);
        return prepared(system, all_rows, &asked, seed, interrupt, |algebra, search| {
            Ok(another(algebra, search, claim, greatest))
        });
    }
    let all_rows = rows(system);
    let mut first = prepared(system, all_rows, &asked, seed, interrupt, |algebra, search| {
        let explored = search.run(algebra)?;
        off_the_sets(algebra, search, &explored, claim)
    })?;
    if let Everywhere::Proved { beside, log2_error: error, .. } = &mut first {
        *error = error.max(log2_error);
        for set in &claim.except {
            let place = &set.written;
            let asked = Asked {
                nonzero: Vec::new(),
                conditions: [claim.conditions.as_slice(), set.vanishing.as_slice()].concat(),
                guards: [claim.guards.as_slice(), set.guards.as_slice()].concat(),
                ..asked.clone()
            };
            let all_rows = rows(system);
            let told = prepared(system, all_rows, &asked, seed, interrupt, |algebra, search| {
                let explored = search.run(algebra)?;
                Ok(on_a_set(algebra, search, &explored))
            });
            beside.push(match told {
                Ok(told) => format!("where {place} {told}"),
                Err(why) => format!("where {place} the rank is not decided: {why}"),
            });
        }
    }
    Ok(first)
}

/// The rank at almost all states with the file's initial values, or without them where that rank is not known to be final, and a
/// bound on the probability of an error, as a power of two.
fn at_almost_all(system: &mut System, claim: &ClaimedEverywhere, seed: u64) -> Result<(usize, f64), String> {
    let Some((entries, columns)) = &claim.matrix else {
        let initial = initial_values(system)?;
        for values in [initial, Default::default()] {
            let words = Codistribution::new(system, &values, Length::UntilItStops)?;
            if words.is_final() {
                return Ok((words.generic_rank(), words.generic.log2_error));
            }
        }
        return Err("it is not known that higher Lie derivatives do not raise the rank".to_owned());
    };
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let is_angle = system.angle_test();
    match generic_rank(&mut system.graph, entries, *columns, is_angle, &mut rng) {
        GenericRank::Rank { rank, log2_error, .. } => Ok((rank, log2_error)),
        GenericRank::Pole(_) => Err("there is a singularity at every state".to_owned()),
        GenericRank::Functions => Err("functions are met that are not rational".to_owned()),
        GenericRank::Unknown(why) => Err(why),
    }
}

/// A state at which the rank is greater than claimed, as it is at almost all of them; or any state, where no matrix of this size has the rank.
fn another(
    algebra: &mut Algebra<'_>,
    search: &mut Search<'_>,
    claim: &ClaimedEverywhere,
    greatest: usize,
) -> Everywhere {
    while search.rows.order < MOST_FIELDS && search.rows.extend(algebra) {}
    let cases = search.all_cases(algebra).unwrap_or_default();
    let found = cases.iter().find_map(|case| {
        let state = state_on(algebra, search, case, &claim.except)?;
        let is_another =
            |found: &usize| if claim.rank > greatest { *found <= greatest } else { *found > claim.rank };
        let found = rank_at(algebra, search, &state).filter(is_another)?;
        Some((state, found))
    });
    match found {
        Some((state, found)) => {
            Everywhere::Refuted { state, found, set: Vec::new(), log2_error: f64::NEG_INFINITY }
        }
        None if claim.rank > greatest => Everywhere::Open(format!("no rank exceeds {greatest}")),
        None => Everywhere::Open(format!("the generic rank is {greatest}")),
    }
}

/// Lie derivatives up to this order are taken to look for a rank that is greater than claimed.
const MOST_FIELDS: usize = 3;

/// What the cases say of the states off the sets that are left out.
fn off_the_sets(
    algebra: &mut Algebra<'_>,
    search: &mut Search<'_>,
    explored: &Explored,
    claim: &ClaimedEverywhere,
) -> Reach<Everywhere> {
    let mut open: Vec<String> = explored.stopped.iter().cloned().collect();
    let mut left = Vec::new();
    for short in &explored.short {
        let pieces = match off_sets(algebra, search, &short.case, &claim.except) {
            Ok(pieces) => pieces,
            Err(_) => vec![short.case.clone()],
        };
        // all rows of a matrix are known, whatever is known of the case
        let certain = match &short.lower {
            Ok(log2_error) => Some(*log2_error),
            Err(_) => (!search.rows.is_of_lie_derivatives()).then_some(f64::NEG_INFINITY),
        };
        let found =
            certain.and_then(|log2_error| Some((log2_error, lower_at(algebra, search, &pieces, claim)?)));
        if let Some((log2_error, (state, found))) = found {
            let shown = merged(algebra, search, std::slice::from_ref(short));
            let set = shown.iter().flat_map(|shown| shown.place(algebra)).collect();
            return Ok(Everywhere::Refuted { state, found, set, log2_error });
        }
        // what has no rational state may have a real one
        if let (Some(log2_error), true) = (certain, claim.except.is_empty() && short.rank < claim.rank)
            && let Some(state) = irrational_state(algebra, search, &short.case)
        {
            let shown = merged(algebra, search, std::slice::from_ref(short));
            let set = shown.iter().flat_map(|shown| shown.place(algebra)).collect();
            return Ok(Everywhere::RefutedAt { state, at_most: short.rank, set, log2_error });
        }
        if !pieces.is_empty() {
            left.push(short.clone());
        }
    }
    for shown in merged(algebra, search, &left) {
        let texts = shown.place(algebra);
        let place =
            if texts.is_empty() { "everywhere".to_owned() } else { format!("where {}", texts.join(", ")) };
        open.push(match &shown.lower {
            Err(why) => format!("{place} no minor was found that is not zero: {why}"),
            Ok(_) => {
                format!(
                    "{place} the rank is {}, and no state of it was found off the sets",
                    shown.rank_in_words()
                )
            }
        });
    }
    if !open.is_empty() {
        return Ok(Everywhere::Open(open.join("; ")));
    }
    if explored.full.is_empty() {
        return Ok(Everywhere::Open("no state was found at which all of it is defined".to_owned()));
    }
    let states = explored.full.iter().filter_map(|full| state_on(algebra, search, &full.case, &claim.except));
    let states: Vec<State> = states.take(if claim.with_examples { MOST_EXAMPLES } else { 1 }).collect();
    if states.is_empty() {
        return Ok(Everywhere::Open("no state was found at which all of it is defined".to_owned()));
    }
    let minors = explored.full.iter().map(|full| identity(algebra, full)).collect();
    let cases = (explored.cases, explored.empty);
    let used: BTreeSet<usize> = explored.full.iter().flat_map(|full| full.chosen.rows.clone()).collect();
    let examples = StatesOfCases {
        row_names: used.iter().map(|row| search.rows.names[*row].clone()).collect(),
        entries: search.rows.as_written(used.iter().copied()),
        states,
    };
    let log2_error = f64::NEG_INFINITY;
    Ok(Everywhere::Proved { cases, minors, examples, beside: Vec::new(), log2_error })
}

/// States of so many cases are written down.
const MOST_EXAMPLES: usize = 40;

/// A state of some cases, off the sets that are left out, with a lower rank than claimed, and that rank.
fn lower_at(
    algebra: &mut Algebra<'_>,
    search: &Search<'_>,
    cases: &[Case],
    claim: &ClaimedEverywhere,
) -> Option<(State, usize)> {
    cases.iter().find_map(|case| {
        let state = state_on(algebra, search, case, &claim.except)?;
        let found = rank_at(algebra, search, &state).filter(|found| *found < claim.rank)?;
        Some((state, found))
    })
}

/// The rank of all rows that were taken, at a state, by exact elimination.
fn rank_at(algebra: &mut Algebra<'_>, search: &Search<'_>, state: &State) -> Option<usize> {
    let entries = search.rows.as_written(0..search.rows.rows.len());
    let values = exact_values(algebra, &entries, state)?;
    let rows: Vec<Vec<RBig>> = values.chunks(search.rows.columns.max(1)).map(<[RBig]>::to_vec).collect();
    rank(&Rationals::default(), rows).ok()
}

/// What the rank is on a set that is left out, in words.
fn on_a_set(algebra: &mut Algebra<'_>, search: &mut Search<'_>, explored: &Explored) -> String {
    let shown = merged(algebra, search, &explored.short);
    let open: Vec<&Shown> = shown.iter().filter(|shown| shown.lower.is_err()).collect();
    let lower: Vec<&Shown> = shown.iter().filter(|shown| shown.lower.is_ok()).collect();
    let mut lowered: Vec<String> = Vec::new();
    let mut some = false;
    for shown in lower {
        some = some || shown.cases.iter().any(|case| state_on(algebra, search, case, &[]).is_some());
        let place = shown.place(algebra);
        lowered.push(format!("{} where {}", shown.rank_in_words(), place.join(", ")));
    }
    let lowered = (!lowered.is_empty()).then(|| lowered.join("; "));
    let full = explored.full.iter().any(|full| state_on(algebra, search, &full.case, &[]).is_some());
    match (lowered, explored.full.is_empty() && open.is_empty()) {
        (None, true) => "there are no states".to_owned(),
        (None, false) if full && open.is_empty() => "the rank is not deficient".to_owned(),
        (None, false) => "it is not decided whether the rank is deficient".to_owned(),
        (Some(lowered), true) if some => format!("the rank is deficient at all states: {lowered}"),
        (Some(lowered), true) => {
            format!("the rank is deficient at all states, of which none was found: {lowered}")
        }
        (Some(lowered), false) => {
            format!("the rank is not deficient everywhere, or that is not decided; it is {lowered}")
        }
    }
}

/// A minor and its product of factors as two expressions that are equal.
fn identity(algebra: &mut Algebra<'_>, full: &FullCase) -> MinorIdentity {
    let n = full.chosen.rows.len();
    let matrix = Matrix { rows: n, columns: n, entries: full.entries.clone() };
    let minor = determinant(&mut algebra.system.graph, &matrix);
    let mut product = algebra.system.graph.rational(full.minor.unit.clone());
    let mut guards = Vec::new();
    for (factor, power) in &full.minor.powers {
        let node = algebra.exactly(factor);
        let power = i32::try_from(*power).unwrap_or(0);
        let raised = algebra.system.graph.power(node, power);
        product = algebra.system.graph.mul(product, raised);
        if algebra.system.graph.constant_value(node).is_none() {
            guards.push(Guard { node, need: Need::NotZero });
        }
    }
    MinorIdentity { minor, product, guards }
}
