//! What a stream of states came to, in a memory that does not grow with it.

use super::decide::Found;
use crate::sweep::Certainty;
use std::collections::BTreeMap;

/// Powers of ten of the condition that are distinguished; all beyond are counted with the last.
pub const DECADES: usize = 18;

/// What a stream of states came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StreamReport {
    /// States that were looked at.
    pub states: u64,
    /// Rows that were eliminated with as many columns, because they are unit vectors.
    pub eliminated: usize,
    /// Rows and columns of what remains; the singular values are its, after equilibration.
    pub remaining: (usize, usize),
    /// States whose rank is proved to be full, by elimination with bounds on all errors.
    pub certified: u64,
    /// How many of them have singular values that suggest a lower rank.
    pub denied: u64,
    /// Further states whose singular values say so, with half of the digits to spare.
    pub computed: u64,
    /// States that were left for slower numbers: all others, and where certainty is wanted, those that are merely
    /// computed.
    pub left: u64,
    /// Those of them at which something is infinite or not a number.
    pub not_finite: u64,
    /// How often the singular values suggest which rank, unit rows included. States that are not finite do not count.
    pub ranks: BTreeMap<usize, u64>,
    /// How often the ratio of the largest to the smallest singular value lies between which powers of ten. States at
    /// which the rank is not full do not count.
    pub conditions: [u64; DECADES],
    /// The state of full rank with the largest ratio: its index and the ratio.
    pub worst: Option<(u64, f64)>,
    /// The smallest gap on which a rank rests.
    pub smallest_gap: Option<f64>,
    /// Whether it was stopped early.
    pub interrupted: bool,
}

impl StreamReport {
    /// The largest rank that the shape of the matrix allows; *full* is meant so.
    pub fn full(&self) -> usize {
        self.eliminated + self.remaining.0.min(self.remaining.1)
    }

    /// Adds one state. Whether it is left for slower numbers.
    pub(super) fn add(
        &mut self,
        index: u64,
        found: &Found,
        lane: usize,
        finite: bool,
        wanted: Certainty,
    ) -> bool {
        self.states += 1;
        if !finite {
            self.not_finite += 1;
            self.left += 1;
            return true;
        }
        let rank = found.rank[lane] as usize;
        *self.ranks.entry(self.eliminated + rank).or_insert(0) += 1;
        let gap = if rank == 0 && self.full() > self.eliminated { 0.0 } else { found.gap[lane] };
        self.smallest_gap = Some(self.smallest_gap.map_or(gap, |least| least.min(gap)));
        if self.eliminated + rank == self.full() {
            let condition = 1.0 / found.ratio[lane];
            self.conditions[decade(condition)] += 1;
            if self.worst.is_none_or(|(_, worst)| condition > worst) {
                self.worst = Some((index, condition));
            }
        }
        if found.certain[lane] > 0.0 {
            self.certified += 1;
            self.denied += u64::from(self.eliminated + rank != self.full());
            return false;
        }
        let computed = found.separated[lane] > 0.0;
        self.computed += u64::from(computed);
        let left = !computed || wanted == Certainty::Certified;
        self.left += u64::from(left);
        left
    }

    /// Adds what came after.
    pub(super) fn append(&mut self, later: &StreamReport) {
        self.states += later.states;
        self.certified += later.certified;
        self.computed += later.computed;
        self.denied += later.denied;
        self.left += later.left;
        self.not_finite += later.not_finite;
        for (rank, count) in &later.ranks {
            *self.ranks.entry(*rank).or_insert(0) += count;
        }
        for (mine, theirs) in self.conditions.iter_mut().zip(later.conditions) {
            *mine += theirs;
        }
        // the earlier one where they are equal
        if let Some((index, condition)) = later.worst
            && self.worst.is_none_or(|(_, worst)| condition > worst)
        {
            self.worst = Some((index, condition));
        }
        self.smallest_gap = match (self.smallest_gap, later.smallest_gap) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
    }
}

/// Which powers of ten a number of at least one lies between.
fn decade(condition: f64) -> usize {
    let mut power = 10.0;
    for decade in 0..DECADES - 1 {
        if condition < power {
            return decade;
        }
        power *= 10.0; // exact up to 1e22
    }
    DECADES - 1
}
