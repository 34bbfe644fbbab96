//! Claims about ranks: of a matrix, or of the observability codistribution, at almost all states of a set.

use super::claimed_ranks::ClaimedRanks;
use super::existence::{Existence, existence};
use super::identity::{OnOneBranch, RANDOM_PRIMES};
use super::rank_bounds::{Limits, Rows, by_bounds};
use super::rank_witness::{Ranks, rank_witness, series_witness};
use super::terms::{OnBranch, Terms};
use super::verdict::{Verdict, Witness};
use palmistry_lang::System;
use palmistry_rank::observability::{Branch, Codistribution, Frame, GenericRank, Length, Stop, generic_rank};
use rand::Rng;

/// A nonzero minor, the certain half of a statement about a rank.
const MINOR: &str = "a minor that is not zero modulo a prime";

/// The same for the differentials of derivatives along a trajectory; [`SERIES`] is the other half.
pub(super) const MINOR_OF_SERIES: &str =
    "a minor of the differentials of power series that is not zero modulo a prime";
pub(super) const SERIES: &str = "power series at random points of random prime fields";

/// Decides `rank(M) = claimed`, or a bound of it, on a branch; the entries are the sides of the terms.
pub(crate) fn decide_rank(
    system: &mut System,
    on: &OnBranch,
    columns: usize,
    claimed: ClaimedRanks,
    rng: &mut impl Rng,
) -> OnOneBranch {
    let entries = on.terms.sides.clone();
    let exists = existence(system, on, rng);
    let rows = Rows { entries: &entries, columns, scope: "", on };
    let limits = Limits { most: columns, log2_error: f64::NEG_INFINITY, settled: true };
    on_one_branch(exists, || decide(system, &rows, limits, claimed, rng))
}

/// Decides `rank = claimed`, or a bound of it, for the codistribution, on the states of a branch.
///
/// # Errors
/// In words: there is no codistribution, or it distinguishes values that the conditions leave open.
pub(crate) fn decide_codistribution(
    system: &mut System,
    on: &OnBranch,
    branch: &Branch,
    claimed: ClaimedRanks,
    rng: &mut impl Rng,
) -> Result<OnOneBranch, String> {
    if system.outputs.is_empty() || system.unknown_count() == 0 {
        return Err("there is no codistribution: the file declares no states or no outputs".to_owned());
    }
    branch.check_codistribution(system)?;
    let exists = existence(system, on, rng);
    if let Existence::Nowhere(guard) = exists {
        return Ok(OnOneBranch::Empty(guard));
    }
    let frame = Frame::new(system, &branch.values)?;
    if let Some(rank) = frame.generic.rank()
        && !frame.lie_derivatives_are_short(system)
    {
        let log2_error = frame.generic.log2_error;
        // the Lie derivatives are too long to be written down
        let witness = |ranks| series_witness(system, on, ranks, rng);
        return Ok(on_one_branch(exists, || by_series(rank, claimed, log2_error, witness)));
    }
    let words = Codistribution::within(system, &branch.values, Length::UntilItStops, frame)?;
    let found = words.generic_rank();
    let columns = system.unknown_count();
    // the rows that give the rank at almost all states: no other row adds to it anywhere
    let terms = Terms { sides: words.needed_entries(), guards: on.terms.guards.clone(), ..Terms::default() };
    let needed = OnBranch::new(system, branch, &terms)?;
    if let Some(rank) = words.generic.rank()
        && (words.guessed || rank > found)
    {
        // the Lie derivatives that were written down do not show it, or are not known to: the series are used
        let log2_error = words.generic.log2_error;
        let witness = |ranks| {
            let found = rank_witness(system, &needed, columns, ranks, rng);
            found.or_else(|| series_witness(system, on, ranks, rng))
        };
        return Ok(on_one_branch(exists, || by_series(rank, claimed, log2_error, witness)));
    }
    let entries = system.graph.substitute(&words.entries(), &branch.values);
    if !words.is_final() && !words.guessed && !claimed.stays(found..=columns) {
        return Err(format!(
            "Lie derivatives up to order {} give the rank {found}; the fields leave these states, so that higher ones may add \
             to it (to claim a rank for some Lie derivatives, write rank([d(...); ...]))",
            words.order
        ));
    }
    let scope = match words.stop {
        Stop::Full => "",
        // a bound from below may be known without that
        _ if !words.is_final() => "",
        _ => ", and higher Lie derivatives do not raise it",
    };
    let rows = Rows { entries: &entries, columns, scope, on: &needed };
    let limits = Limits {
        most: words.generic.at_most,
        log2_error: words.generic.log2_error,
        settled: words.stop == Stop::NoGrowth && words.invariant,
    };
    Ok(on_one_branch(exists, || decide(system, &rows, limits, claimed, rng)))
}

pub(super) fn on_one_branch(exists: Existence, verdict: impl FnOnce() -> Verdict) -> OnOneBranch {
    match exists {
        Existence::Nowhere(guard) => OnOneBranch::Empty(guard),
        Existence::NotShown(guard) => {
            let why = format!("no state was found at which all of it is defined; it needs {guard}");
            OnOneBranch::Verdict(Verdict::undecided(why), Existence::NotShown(guard))
        }
        Existence::Shown => OnOneBranch::Verdict(verdict(), exists),
    }
}

/// The rank by power series alone; if it is not the claimed one, a state at which it is shown, if one is found.
fn by_series(
    rank: usize,
    claimed: ClaimedRanks,
    log2_error: f64,
    witness: impl FnOnce(Ranks) -> Option<Witness>,
) -> Verdict {
    let engine = if log2_error == f64::NEG_INFINITY { MINOR_OF_SERIES } else { SERIES }.to_owned();
    if claimed.holds(rank) {
        return Verdict::Proved { engine, log2_error };
    }
    let ranks = Ranks { generic: rank, claimed };
    ranks.refuted(engine, witness(ranks))
}

/// Decides a rank of rows on a branch.
pub(super) fn decide(
    system: &mut System,
    rows: &Rows<'_>,
    limits: Limits,
    claimed: ClaimedRanks,
    rng: &mut impl Rng,
) -> Verdict {
    let is_angle = &system.angle_test();
    match generic_rank(&mut system.graph, rows.entries, rows.columns, is_angle, rng) {
        GenericRank::Rank { rank, log2_error, .. } if claimed.holds(rank) => {
            // a minor shows that a rank is no less
            let log2_error = if claimed.stays(rank..=usize::MAX) { f64::NEG_INFINITY } else { log2_error };
            let engine = if log2_error == f64::NEG_INFINITY { MINOR } else { RANDOM_PRIMES };
            Verdict::Proved { engine: format!("{engine}{}", rows.scope), log2_error }
        }
        GenericRank::Rank { rank, .. } => {
            let ranks = Ranks { generic: rank, claimed };
            let witness = rank_witness(system, rows.on, rows.columns, ranks, rng);
            ranks.refuted(format!("{RANDOM_PRIMES}{}", rows.scope), witness)
        }
        GenericRank::Pole(divisor) => {
            let text = system.graph.text(divisor);
            Verdict::undecided(format!("undefined at every state there: a division by {text} = 0"))
        }
        GenericRank::Functions => by_bounds(system, rows, limits, claimed, rng),
        GenericRank::Unknown(why) => Verdict::undecided(why),
    }
}
