//! A state in exact numbers at which a matrix has not the rank that was claimed.

use super::terms::{OnBranch, Values};
use super::verdict::Witness;
use crate::number::{Enclosure, Enclosures, Rationals, rational_to_f64};
use crate::observability::{certain_rank, rank};
use crate::system::System;
use rand::Rng;

/// The bits of the elimination in enclosures.
const BITS: usize = 400;
/// How many states are tried.
const ATTEMPTS: usize = 60;

/// Two ranks: that at almost all states, and another that was claimed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ranks {
    pub generic: usize,
    pub claimed: usize,
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
        let found = match on.sides(&point) {
            Some(Values::Exact(entries)) => {
                let rows = entries.chunks(columns.max(1)).map(<[_]>::to_vec).collect();
                rank(&Rationals::default(), rows).ok()
            }
            // no state has a higher rank than almost all have, and enclosures show that it is not lower
            Some(Values::Enclosed(entries)) => {
                let rows = entries.chunks(columns.max(1)).map(<[_]>::to_vec).collect();
                certain_rank(&Enclosures::new(BITS), rows, significance).ok()
            }
            None => continue,
        };
        if found == Some(ranks.generic) {
            return Some(Witness {
                state: on.describe(system, &point),
                left: ranks.generic.to_string(),
                right: ranks.claimed.to_string(),
                entry: None,
                refutation: None,
            });
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
