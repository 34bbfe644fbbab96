//! The inputs of a check against a proof file.

use super::binding::ClaimSense;
use super::doubt::Effort;
use super::listing::Listing;
use super::sources::ProofSources;
use super::state::{ExactCoordinate, ExactState};
use std::sync::atomic::AtomicBool;

/// The inputs of a check.
#[derive(Clone, Copy, Debug)]
pub struct Checking<'c> {
    /// Where the proof files are.
    pub sources: &'c ProofSources,
    /// The seed of the states that the checker chooses.
    pub seed: u64,
    /// The work that it may take.
    pub effort: &'c Effort,
    /// Whether to stop.
    pub interrupt: &'c AtomicBool,
}

/// The operations by which a state gives values; none where it gives numbers alone.
pub(super) fn operations(listing: &Listing, state: &ExactState) -> Listing {
    match state.values().any(|value| matches!(value, ExactCoordinate::Step(_))) {
        true => listing.clone(),
        false => Listing::default(),
    }
}

impl ClaimSense {
    /// Whether one state at which it fails refutes it.
    pub(super) fn is_of_each_state(self) -> bool {
        matches!(self, ClaimSense::Always | ClaimSense::Everywhere | ClaimSense::Except)
    }
}
