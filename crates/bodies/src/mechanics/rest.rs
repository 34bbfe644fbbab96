//! How a body in space lies at rest on three palms.

use super::grip::{Grip, grip, rotation_about};
use super::linear::{Square, Vector, difference, dot, product, solve};
use super::{Real, Solid, differentiate};

/// A step below this size is the last.
const LAST_STEP: isize = -150;

/// More steps than this are not taken: the method has then lost its way.
const MOST_STEPS: usize = 24;

/// The rotation, after which the body is turned on by small angles about the axes of the world.
fn turned_on(turn: &Square<3>, by: &Vector<3>) -> Square<3> {
    (0..3).fold(turn.clone(), |turn, axis| product(&rotation_about(axis, &by[axis]), &turn))
}

/// A pose near a given one in which the potential energy of a body that touches three palms is stationary: an
/// equilibrium without friction, stable or not. `start` and the result are rotations; the palms are given by
/// their frames, see [`palm_frame`](super::palm_frame). `None` where Newton's method does not arrive.
pub fn resting_pose(solid: &Solid, palms: &[Square<3>; 3], start: &Square<3>) -> Option<(Square<3>, Grip)> {
    // one axis alone: the other two angles are zero
    let only = |axis: usize, angle: &Real| -> Vector<3> {
        std::array::from_fn(|i| if i == axis { angle.clone() } else { Real::zero() })
    };
    let slope = |turn: &Square<3>| -> Vector<3> {
        std::array::from_fn(|k| {
            let height =
                |angle: &Real| vec![grip(solid, &turned_on(turn, &only(k, angle)), palms).centre[2].clone()];
            differentiate(height, &Real::zero()).all[0].first.clone()
        })
    };
    let nearby = Real::power_of_two(-64);
    let mut turn = start.clone();
    for _ in 0..MOST_STEPS {
        let here = slope(&turn);
        // forward differences: near the solution each step is smaller than the one before by about this
        // factor
        let rows = std::array::from_fn(|k| {
            difference(&slope(&turned_on(&turn, &only(k, &nearby))), &here).map(|x| x / &nearby)
        });
        let step = solve(rows, here);
        turn = turned_on(&turn, &step.each_ref().map(|x| -x));
        let size = dot(&step, &step).sqrt();
        if !size.is_defined() {
            return None;
        }
        if size < Real::power_of_two(LAST_STEP) {
            let grip = grip(solid, &turn, palms);
            return Some((turn, grip));
        }
    }
    None
}
