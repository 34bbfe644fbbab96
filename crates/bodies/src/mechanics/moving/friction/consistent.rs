//! Which modes of both contacts the laws allow.

use super::laws::Rubbing;
use super::modes::{ContactMode, ModePair};
use crate::mechanics::moving::drive::Drive;
use crate::mechanics::moving::laws::State;
use crate::mechanics::moving::scene::MovingScene;

/// A contact rests where it slides more slowly, in m/s: a hundred times the error of the integration and of the search for the moment.
pub(super) const RESTS: f64 = 1e-10;

/// By how much less than zero an acceleration along the palm may be, relative to the largest of all, to count as the start of a
/// sliding: where friction has just left its cone it is zero.
const ROUNDING: f64 = 1e-9;

/// The pairs of modes that are consistent at a state, other than `left`, in the order in which they are preferred: what sticks
/// before what slides.
pub(super) fn consistent(
    scene: &MovingScene,
    coefficient: f64,
    time: f64,
    state: &State,
    left: Option<ModePair>,
) -> Vec<ModePair> {
    use ContactMode::{Against, Along, Sticks};
    // how fast the contacts slide does not depend on the mode
    let slips = Rubbing::at(scene, coefficient, ModePair([Along, Along]), time, state).slips;
    let rests = slips.map(|slip| slip.abs() < RESTS);
    let candidates = |i: usize| match rests[i] {
        true => vec![Sticks, Along, Against],
        false if slips[i] > 0.0 => vec![Along],
        false => vec![Against],
    };
    let mut found = Vec::new();
    for one in candidates(0) {
        for two in candidates(1) {
            let pair = ModePair([one, two]);
            let possible = pair.0 != [Sticks, Sticks] || turn_as_one(scene, time, state);
            if possible && Some(pair) != left {
                let here = Rubbing::at(scene, coefficient, pair, time, state);
                if holds(&here, pair, rests) {
                    found.push(pair);
                }
            }
        }
    }
    found.sort_by_key(|pair| pair.0.iter().filter(|mode| **mode != Sticks).count());
    found
}

/// Whether both contacts push, what sticks is held, and what rests and is to slide begins to.
fn holds(here: &Rubbing, pair: ModePair, rests: [bool; 2]) -> bool {
    let pushes = here.situation.forces.iter().all(|force| *force > 0.0);
    // friction that has just come to the edge of its cone may begin to slide and to stick; `left` says which it is
    let held = here.slack.is_none_or(|slack| slack > -ROUNDING * here.largest);
    let begins = |i: usize| {
        let sense = pair.0[i].sense();
        !rests[i] || sense == 0.0 || sense * here.slip_rates[i] > -ROUNDING * here.largest
    };
    pushes && held && begins(0) && begins(1)
}

/// Whether the palms turn as one and go on to, as far as that is prescribed: what both contacts can stick to.
fn turn_as_one(scene: &MovingScene, time: f64, state: &State) -> bool {
    match &scene.drive {
        Drive::Prescribed([_, second]) => {
            second.rate == 0.0 && second.swings.iter().all(|swing| swing.amplitude * swing.frequency == 0.0)
        }
        Drive::Torques(_) => {
            let [one, two] = scene.palms_at(time, state);
            (one[1] - two[1]).abs() < RESTS
        }
    }
}
