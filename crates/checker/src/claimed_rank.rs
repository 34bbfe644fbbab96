//! A claim about a rank at almost all states: a minor shows that it is no less, and states of the checker's choice are tried
//! for one at which it is more.

use super::doubt::{Doubt, Effort, Finding, Half};
use super::identity::{DRAWN, can_vary, drawn};
use super::minor::CertifiedRank;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// So many states are compared.
const COMPARED: usize = 4;
/// The work on them.
const TRIED: u64 = 1 << 26;

/// The verdict on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClaimedWord {
    /// The claim is said to hold.
    Proved,
    /// The claim is said to fail.
    Refuted,
}

/// A rank that was claimed, and what it was found to be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClaimedRank {
    /// The matrix, with one state and a minor of the rank that was found; a kernel is not needed.
    pub matrix: CertifiedRank,
    /// The rank that is claimed.
    pub claimed: usize,
    /// Proved where it is the one that was found, else refuted.
    pub word: ClaimedWord,
    /// What the verdict rests on: the engine.
    pub engine: String,
    /// A bound on the probability that it errs, as a power of two; nothing where it cannot err.
    pub log2_error: Option<f64>,
}

/// What is known of the matrix beside its entries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tried<'m> {
    /// Whether its rows are all that there are.
    pub is_whole: bool,
    /// Whether a minor that is not zero at one state is not zero at almost all that are meant.
    pub is_generic: bool,
    /// Whether the state gives more values by operations than there are equations to give them.
    pub assumes_more: bool,
    /// The same with further rows, at whose states a greater rank is looked for.
    pub longer: Option<&'m CertifiedRank>,
}

impl ClaimedRank {
    /// Checks the minor, and draws states from a seed. Nothing is known of rows that may have been left out.
    pub fn check(&self, seed: u64, effort: &Effort) -> Finding {
        let alone = Tried { is_whole: false, is_generic: true, assumes_more: false, longer: None };
        self.check_as(alone, seed, effort).unwrap_or_else(Finding::NotConfirmed)
    }

    /// The same with another matrix.
    pub(super) fn with_matrix(&self, matrix: CertifiedRank) -> ClaimedRank {
        ClaimedRank { matrix, engine: self.engine.clone(), ..*self }
    }

    /// The same of a matrix of which more is known.
    pub(super) fn check_as(&self, known: Tried<'_>, seed: u64, effort: &Effort) -> Result<Finding, Doubt> {
        self.matrix.shape()?;
        let [state] = self.matrix.states.as_slice() else { return Err(Doubt::Empty) };
        if (state.rank == self.claimed) != (self.word == ClaimedWord::Proved) {
            return Err(Doubt::OtherRank { found: state.rank, claimed: self.claimed });
        }
        self.matrix.is_at_least(0, state, effort)?;
        if state.rank > self.claimed {
            // near the state the rank is no less
            return Ok(Finding::Confirmed { times: 1 });
        }
        let columns = self.matrix.columns.len();
        let largest = if known.is_whole { columns.min(self.matrix.rows.len()) } else { columns };
        if state.rank == largest && largest > 0 {
            // no more than the matrix allows
            return Ok(match known.is_generic {
                true => Finding::Confirmed { times: 1 },
                false => Finding::HalfConfirmed(Half::PartOfTheSet),
            });
        }
        let tried = known.longer.unwrap_or(&self.matrix);
        // what takes too much work was not tried
        let own = Effort::new(TRIED);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut states = 0;
        for attempt in 0..DRAWN {
            if states == COMPARED || attempt > 0 && !can_vary(&state.state) {
                break;
            }
            let other = match attempt {
                0 => state.state.clone(),
                _ => drawn(&state.state, attempt, &mut rng),
            };
            match tried.rank_at(&other, &own) {
                Ok(rank) if rank > state.rank => {
                    return Err(Doubt::GreaterRank { found: rank, stated: state.rank });
                }
                Ok(_) => states += usize::from(attempt > 0),
                Err(Doubt::NoValue(super::Missing::Effort)) => break,
                // a state at which an entry does not exist says nothing
                Err(_) => {}
            }
        }
        Ok(match (self.word, known.is_generic) {
            // that a rank is no less than zero is nothing, and that it is no greater has to be tried where it might be
            _ if state.rank == 0 || states == 0 || known.assumes_more => Finding::Consistent { states },
            (ClaimedWord::Refuted, _) => Finding::Consistent { states },
            (ClaimedWord::Proved, true) => Finding::HalfConfirmed(Half::GenericallyNoLess { states }),
            (ClaimedWord::Proved, false) => Finding::HalfConfirmed(Half::PartNoLess { states }),
        })
    }
}
