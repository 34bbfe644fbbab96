//! A proved equation, evaluated at the state at which both sides are said to exist and at states of the checker's choice.
//!
//! Evaluation cannot prove an identity: what it finds is *consistent*, or a state at which the proof is wrong. Only two
//! numbers that are near each other are *confirmed*.

use super::doubt::{Doubt, Effort, Finding};
use super::evaluation::Evaluation;
use super::listing::Listing;
use super::state::{ExactCoordinate, ExactState, Ratio};
use super::witness::{Requirement, Sides, holds, is_within};
use dashu::rational::RBig;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// How many states are drawn, and at how many of them both sides are compared.
pub(super) const DRAWN: usize = 60;
const COMPARED: usize = 6;

/// An equation that was proved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StatedIdentity {
    /// Sides, conditions and requirements, as they were read.
    pub listing: Listing,
    /// A state at which both sides exist. What the conditions are solved for is given by operations of the listing, so that
    /// any values of the other symbols meet the conditions too.
    pub state: ExactState,
    /// The two sides; of matrices, those of all entries.
    pub sides: Vec<Sides>,
    /// Where sides are claimed to be near each other: the tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<usize>,
    /// Equations that are assumed.
    pub conditions: Vec<Sides>,
    /// What has to hold besides: domains and inequalities.
    pub requirements: Vec<Requirement>,
    /// What the proof rests on: the engine.
    pub engine: String,
    /// A bound on the probability that it errs, as a power of two; nothing where it cannot err.
    pub log2_error: Option<f64>,
    /// The bound on the degree from which that probability follows, where there is one.
    pub degree: Option<f64>,
}

impl StatedIdentity {
    /// Evaluates it at its own state, and at others that are drawn from a seed.
    pub fn check(&self, seed: u64, effort: &Effort) -> Finding {
        let mut found = if self.sides.is_empty() { Err(Doubt::Empty) } else { self.at(&self.state, effort) };
        if let (Ok(()), Some(_)) = (&found, self.within) {
            return Finding::Confirmed { times: 1 };
        }
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut states = 0;
        for attempt in 0..DRAWN {
            if found.is_err() || states == COMPARED || !can_vary(&self.state) {
                break;
            }
            match self.at(&drawn(&self.state, attempt, &mut rng), effort) {
                Ok(()) => states += 1,
                Err(differ @ (Doubt::Differ | Doubt::NoValue(super::Missing::Effort))) => found = Err(differ),
                // a state at which a side does not exist, or a condition is not met, says nothing
                Err(_) => {}
            }
        }
        match found {
            Ok(()) => Finding::Consistent { states },
            Err(doubt) => Finding::NotConfirmed(doubt),
        }
    }

    fn at(&self, state: &ExactState, effort: &Effort) -> Result<(), Doubt> {
        let values = Evaluation::new(&self.listing, state, effort)?;
        holds(&values, &self.conditions, &self.requirements)?;
        for sides in &self.sides {
            match self.within {
                None => {
                    if sides.hold(&values)? == Some(false) {
                        return Err(Doubt::Differ);
                    }
                }
                Some(tolerance) => match is_within(&values, *sides, tolerance)? {
                    Some(true) => {}
                    Some(false) => return Err(Doubt::Differ),
                    None => return Err(Doubt::ToleranceNotTold),
                },
            }
        }
        Ok(())
    }
}

/// Whether there is another state to be drawn.
pub(super) fn can_vary(state: &ExactState) -> bool {
    state.values().any(|value| !matches!(value, ExactCoordinate::Step(_)))
}

/// A state like another one, with other numbers: the first half of the attempts positive, so that roots exist.
pub(super) fn drawn(state: &ExactState, attempt: usize, rng: &mut impl Rng) -> ExactState {
    let mut number =
        |lowest: i64| RBig::from(rng.random_range(lowest..=999)) / RBig::from(rng.random_range(7i64..=97));
    let lowest = if attempt < DRAWN / 2 { 1 } else { -999 };
    let mut other = |value: &ExactCoordinate| match value {
        ExactCoordinate::Number(_) => ExactCoordinate::Number(Ratio(number(lowest))),
        ExactCoordinate::Angle { .. } => {
            // the angle whose half has the tangent t
            let t = number(-99);
            let (square, twice) = (&t * &t, &t + &t);
            let bottom = RBig::ONE + &square;
            ExactCoordinate::Angle { sin: Ratio(twice / &bottom), cos: Ratio((RBig::ONE - square) / bottom) }
        }
        ExactCoordinate::Step(place) => ExactCoordinate::Step(*place),
    };
    state.iter().map(|(name, value)| (name.clone(), other(value))).collect()
}
