//! Parts of a sweep: what was found at some of its states, with all that merging needs, and what they add up to.

use super::counts::SweepCounts;
use palmistry_io::parts::{NoCover, in_order};
use std::ops::Range;

/// What a sweep over some states of a question has found.
#[derive(Clone, Debug, PartialEq)]
pub struct RankPart {
    /// What was asked, and what was made ready for it, as numbers.
    pub(super) asked: u64,
    pub(super) prepared: u64,
    /// How many states the whole question has.
    pub(super) states: u64,
    /// The first of those that were looked at, and the one after the last.
    pub(super) first: u64,
    pub(super) last: u64,
    pub(super) branches: Vec<BranchCounts>,
}

/// What was found on one branch of the conditions.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BranchCounts {
    pub full: SweepCounts,
    /// By the file's own rows.
    pub rows: Option<SweepCounts>,
}

/// Why parts cannot be merged. They are called by the names that the caller gave them.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)] // names and messages say it
pub enum MergeError {
    #[error("there are no parts")]
    NoParts,
    #[error(
        "{0} belongs to another question: another file, other options, or another version of this program"
    )]
    OtherQuestion(String),
    #[error(
        "the parts were swept by rows that this program does not find: another version of it, or other branches of the conditions"
    )]
    PreparedOtherwise,
    #[error("{0} and {1} were swept by other rows or branches: by two versions of this program")]
    Unlike(String, String),
    #[error("no part has the states {} to {}", .0.start, .0.end.saturating_sub(1))]
    Gap(Range<u64>),
    #[error("{one} and {other} both have the states {} to {}", .states.start, .states.end.saturating_sub(1))]
    Overlap { one: String, other: String, states: Range<u64> },
}

impl From<NoCover> for MergeError {
    fn from(why: NoCover) -> MergeError {
        match why {
            NoCover::Gap(states) => MergeError::Gap(states),
            NoCover::Overlap { one, other, both } => MergeError::Overlap { one, other, states: both },
        }
    }
}

/// The states of shard `number` of `of`, counted from one: the numbers of states in two shards differ by at most one.
///
/// ```
/// use palmistry_rank::sweep::shard_of;
/// assert_eq!([1, 2, 3].map(|number| shard_of(10, number, 3)), [0..3, 3..6, 6..10]);
/// ```
pub fn shard_of(states: u64, number: u64, of: u64) -> Range<u64> {
    // in 128 bits, since the product of two counts may not fit into 64
    let end = |number: u64| {
        let number = number.min(of);
        (u128::from(states) * u128::from(number) / u128::from(of.max(1))) as u64
    };
    end(number.saturating_sub(1))..end(number)
}

impl RankPart {
    /// The indices of its states.
    pub fn range(&self) -> Range<u64> {
        self.first..self.last
    }

    /// What was asked, as [`RankPreparation::fingerprint`](super::RankPreparation::fingerprint) computes it.
    pub fn fingerprint(&self) -> u64 {
        self.asked
    }

    /// Whether all of its states were looked at.
    pub fn is_whole(&self) -> bool {
        let interrupted = |counts: &SweepCounts| counts.interrupted;
        !self
            .branches
            .iter()
            .any(|branch| interrupted(&branch.full) || branch.rows.as_ref().is_some_and(interrupted))
    }

    /// The sum of parts that together are all states, each once, in any order.
    ///
    /// # Errors
    /// Parts with gaps or overlaps, or of another question.
    pub(super) fn merge(
        parts: Vec<(String, RankPart)>,
        asked: u64,
        states: u64,
    ) -> Result<RankPart, MergeError> {
        for (name, part) in &parts {
            if part.asked != asked || part.states != states {
                return Err(MergeError::OtherQuestion(name.clone()));
            }
        }
        if parts.is_empty() {
            return Err(MergeError::NoParts);
        }
        let mut parts = in_order(parts, RankPart::range, states)?.into_iter();
        let (mut name, mut whole) = parts.next().ok_or(MergeError::NoParts)?;
        for (next_name, next) in parts {
            let rows = |part: &RankPart| -> Vec<bool> {
                part.branches.iter().map(|branch| branch.rows.is_some()).collect()
            };
            if next.prepared != whole.prepared || rows(&next) != rows(&whole) {
                return Err(MergeError::Unlike(name, next_name));
            }
            for (mine, theirs) in whole.branches.iter_mut().zip(next.branches) {
                mine.full.append(theirs.full);
                if let Some((mine, theirs)) = mine.rows.as_mut().zip(theirs.rows) {
                    mine.append(theirs);
                }
            }
            // an empty part begins anywhere
            if next.last > whole.last {
                (name, whole.last) = (next_name, next.last);
            }
        }
        Ok(whole)
    }
}
