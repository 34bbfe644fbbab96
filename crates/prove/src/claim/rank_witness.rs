//! A state in exact numbers at which a matrix does not have the claimed rank.

use super::claimed_ranks::ClaimedRanks;
use super::terms::{OnBranch, Point, Values};
use super::verdict::{Verdict, Witness};
use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::number::{Enclosure, Enclosures, PrimeField, Rationals, rational_to_f64};
use palmistry_rank::observability::{Coordinate, Defined, Probe, WrittenState, certain_rank, rank};
use rand::Rng;

/// The bits of the elimination in enclosures.
const BITS: usize = 400;
/// How many states are tried.
const ATTEMPTS: usize = 60;

/// The rank at almost all states, and the claim about it, which it does not meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ranks {
    pub generic: usize,
    pub claimed: ClaimedRanks,
}

impl Ranks {
    /// The verdict at a state that shows it; without one nothing is refuted.
    pub fn refuted(self, engine: String, witness: Option<Witness>) -> Verdict {
        match witness {
            Some(witness) => Verdict::Refuted { engine, witness },
            None => Verdict::undecided(format!(
                "the rank is generically {} around it, but no state in exact numbers was found that shows that it is not {}",
                self.generic, self.claimed
            )),
        }
    }

    fn at(self, state: WrittenState) -> Witness {
        Witness {
            state,
            left: self.generic.to_string(),
            right: self.claimed.to_string(),
            entry: None,
            refutation: None,
        }
    }
}

/// A state of the branch at which the codistribution has its generic rank, by power series that begin there.
pub(super) fn series_witness(
    system: &mut System,
    on: &OnBranch,
    ranks: Ranks,
    rng: &mut impl Rng,
) -> Option<Witness> {
    let probe = Probe::new(system, &on.branch.values);
    let field = PrimeField::random(rng);
    let unknowns = system.unknown_count();
    let guards = system.smooth_guards(&system.moving_fields());
    let defined = Defined::new(system, &guards);
    for attempt in 0..ATTEMPTS {
        let point = on.draw(system, attempt, rng);
        // what no row mentions is met in the series
        let mut state = point.state.clone();
        for symbol in system.states.clone() {
            let any = match system.is_angle(symbol) {
                true => Coordinate::from_half_tangent(&RBig::from_parts(1.into(), 3u8.into())),
                false => Coordinate::Number(RBig::from(attempt as i64 % 7 + 1)),
            };
            state.values.entry(symbol).or_insert(any);
        }
        if on.sides(&point).is_none() || !point.terms.is_empty() || !defined.holds(&state) {
            continue;
        }
        // modulo a prime it is no more than the rank there, which is nowhere more than at almost all states
        if probe.rank_at(&state, field, attempt as u64, unknowns) == Some(ranks.generic) {
            return Some(ranks.at(state.describe(system)));
        }
    }
    None
}

/// The state of the branch, of those that are drawn, at which the rows have the greatest rank for certain, and that rank; the first
/// one at which it is `most` ends the search. `None` where no state was found at which they exist.
pub(super) fn best_state(
    system: &mut System,
    on: &OnBranch,
    columns: usize,
    most: usize,
    rng: &mut impl Rng,
) -> Option<(usize, WrittenState)> {
    let mut best = None;
    for attempt in 0..ATTEMPTS {
        let point = on.draw(system, attempt, rng);
        let Some(found) = rank_at(on, &point, columns) else { continue };
        if best.as_ref().is_none_or(|(known, _)| found > *known) {
            best = Some((found, on.describe(system, &point)));
        }
        if found >= most {
            break;
        }
    }
    best
}

/// The rank of the rows at a point by exact numbers, or what enclosures show it to be at the least.
fn rank_at(on: &OnBranch, point: &Point, columns: usize) -> Option<usize> {
    match on.sides(point)? {
        Values::Exact(entries) => {
            let rows = entries.chunks(columns.max(1)).map(<[_]>::to_vec).collect();
            rank(&Rationals::default(), rows).ok()
        }
        Values::Enclosed(entries) => {
            let rows = entries.chunks(columns.max(1)).map(<[_]>::to_vec).collect();
            certain_rank(&Enclosures::new(BITS), rows, significance).ok()
        }
    }
}

/// A state of the branch at which everything exists and the rows, of so many columns, have their generic rank, found by
/// elimination over the rationals, or in enclosures where there are no exact values. `None` where no such state was drawn.
pub(crate) fn rank_witness(
    system: &mut System,
    on: &OnBranch,
    columns: usize,
    ranks: Ranks,
    rng: &mut impl Rng,
) -> Option<Witness> {
    for attempt in 0..ATTEMPTS {
        let point = on.draw(system, attempt, rng);
        // no state has a higher rank than almost all have, and enclosures show that it is not lower
        let found = rank_at(on, &point, columns);
        if found == Some(ranks.generic) {
            return Some(ranks.at(on.describe(system, &point)));
        }
    }
    None
}

/// How far an enclosed number lies from zero in units of its uncertainty.
fn significance(value: &Enclosure) -> f64 {
    let (low, high) = (value.low(), value.high());
    let width = rational_to_f64(&(&high - &low));
    value.midpoint().abs() / width.max(f64::MIN_POSITIVE)
}
