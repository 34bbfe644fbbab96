//! A claim about a rank at almost all states: a minor shows that it is no less, and states of the checker's choice are tried
//! for one at which it is more.

use super::doubt::{Doubt, Effort, Finding};
use super::identity::{DRAWN, can_vary, drawn};
use super::minor::CertifiedRank;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// So many states are compared.
const COMPARED: usize = 4;

/// What became of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClaimedWord {
    Proved,
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

impl ClaimedRank {
    /// Checks the minor, and draws states from a seed.
    pub fn check(&self, seed: u64, effort: &Effort) -> Finding {
        self.try_check(seed, effort).unwrap_or_else(Finding::NotConfirmed)
    }

    fn try_check(&self, seed: u64, effort: &Effort) -> Result<Finding, Doubt> {
        self.matrix.shape()?;
        let [state] = self.matrix.states.as_slice() else { return Err(Doubt::Empty) };
        if (state.rank == self.claimed) != (self.word == ClaimedWord::Proved) {
            return Err(Doubt::OtherRank { found: state.rank, claimed: self.claimed });
        }
        self.matrix.is_at_least(0, state, effort)?;
        let largest = self.matrix.columns.len().min(self.matrix.rows.len());
        if state.rank == largest || state.rank > self.claimed {
            // at almost all states the rank is no less than at one, and no more than the matrix allows
            return Ok(Finding::Confirmed { times: 1 });
        }
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut states = 0;
        for attempt in 0..DRAWN {
            if states == COMPARED || !can_vary(&state.state) {
                break;
            }
            match self.matrix.rank_at(&drawn(&state.state, attempt, &mut rng), effort) {
                Ok(rank) if rank > state.rank => {
                    return Err(Doubt::GreaterRank { found: rank, stated: state.rank });
                }
                Ok(_) => states += 1,
                Err(exhausted @ Doubt::NoValue(super::Missing::Effort)) => return Err(exhausted),
                // a state at which an entry does not exist says nothing
                Err(_) => {}
            }
        }
        Ok(Finding::Consistent { states })
    }
}
