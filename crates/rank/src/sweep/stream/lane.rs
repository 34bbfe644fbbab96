//! What a program has computed for one lane, decided: the same for states that are drawn and for states that are handed over.

use super::decide::{Decider, Found};
use palmistry_math::expression::{BlockProgram, Machine};
use palmistry_math::number::{Bounded, Lanes, MOST_LANES};

/// What was found in one lane.
pub(super) struct LaneFound {
    pub found: Found,
    /// Whether a state has entries at all: no divisor is zero, and everything is finite.
    pub finite: [bool; MOST_LANES],
}

/// Decides the matrices of one lane, of which the program's first results are the entries.
#[inline(always)]
pub(super) fn decide_lane<N: Entry<L>, L: Lanes>(
    program: &BlockProgram,
    machine: &Machine<'_, N>,
    lane: usize,
    decider: &mut Decider<L>,
    certify: bool,
) -> LaneFound {
    for place in 0..decider.places() {
        decider.set(place, machine.output(place, lane).bounded());
    }
    let mut found = decider.decide(certify);
    let health = machine.health(lane).bounded();
    let (mut spoiled, mut bounds) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
    health.value.store(&mut spoiled);
    health.error().store(&mut bounds);
    let mut finite = [false; MOST_LANES];
    for i in 0..L::COUNT {
        // a divisor that is not known well enough is no ground to stand on
        if !bounds[i].is_finite() {
            found.certain[i] = 0.0;
        }
        finite[i] = spoiled[i] == 0.0 && found.finite[i] == 0.0 && !program.is_undefined();
    }
    LaneFound { found, finite }
}

/// A number in which entries are computed.
pub(super) trait Entry<L>: Lanes {
    /// With the bound on its error, as far as one is known.
    fn bounded(self) -> Bounded<L>;
}

impl<L: Lanes> Entry<L> for L {
    #[inline(always)]
    fn bounded(self) -> Bounded<L> {
        Bounded::exact(self)
    }
}

impl<L: Lanes> Entry<L> for Bounded<L> {
    #[inline(always)]
    fn bounded(self) -> Bounded<L> {
        self
    }
}
