//! A state in exact numbers at which a matrix has not the rank that was claimed.

use super::terms::{OnBranch, Values};
use super::verdict::Witness;
use crate::number::Rationals;
use crate::observability::rank;
use crate::system::System;
use rand::Rng;

/// How many states are tried.
const ATTEMPTS: usize = 60;

/// Two ranks: that at almost all states, and another that was claimed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ranks {
    pub generic: usize,
    pub claimed: usize,
}

/// A state of the branch at which everything exists and the rows, of so many columns, have their generic rank, found by
/// elimination over the rationals. `None` where no such state was drawn, or where the rows have no exact values.
pub(crate) fn rank_witness(
    system: &mut System,
    on: &OnBranch,
    columns: usize,
    ranks: Ranks,
    rng: &mut impl Rng,
) -> Option<Witness> {
    for attempt in 0..ATTEMPTS {
        let point = on.draw(system, attempt, rng);
        let Some(Values::Exact(entries)) = on.sides(&point) else { continue };
        let rows = entries.chunks(columns.max(1)).map(<[_]>::to_vec).collect();
        if rank(&Rationals::default(), rows).is_ok_and(|found| found == ranks.generic) {
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
