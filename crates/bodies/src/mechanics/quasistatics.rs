//! Where a body comes to rest between two palms.

use super::contact::{Angles, place};
use super::motion::{PalmMotion, PlanarMotion, observe};
use super::{Palm, Placement, PlanarBody, Real, differentiate};

/// How many orientations are tried to find the lowest one.
const TRIED: i64 = 48;

/// A Newton step below this size is the last: the next would be its square.
const LAST_STEP: isize = -150;

/// More steps than this are not taken.
const MOST_STEPS: usize = 60;

/// An orientation near a given one at which the height of the centre of mass is stationary, with the second
/// derivative of the height there: positive at a stable pose. Undefined numbers where Newton's method did not
/// get there.
fn stationary(body: &PlanarBody, phi1: &Real, phi2: &Real, start: &Real) -> (Real, Real) {
    let height = |phi0: &Real| {
        let angles = Angles { phi0: phi0.clone(), phi1: phi1.clone(), phi2: phi2.clone() };
        vec![place(body, &angles).centre[1].clone()]
    };
    let mut phi0 = start.clone();
    for _ in 0..MOST_STEPS {
        let found = differentiate(height, &phi0);
        let step = &found.all[0].first / &found.all[0].second;
        if !step.is_defined() {
            break;
        }
        phi0 = phi0 - &step;
        if step.abs() < Real::power_of_two(LAST_STEP) {
            return (phi0, found.all[0].second.clone());
        }
    }
    (Real::UNDEFINED, Real::UNDEFINED)
}

/// A stable pose with a low centre of mass: the orientation, in radians, at which the potential energy of a body
/// that touches both palms has a local minimum. The search begins at the lowest of 48 orientations, which is the
/// lowest pose of all unless two lie very close in height. `None` where it did not end at a minimum.
pub fn lowest_pose(body: &PlanarBody, phi1: &Real, phi2: &Real) -> Option<Real> {
    let height = |phi0: &Real| {
        let angles = Angles { phi0: phi0.clone(), phi1: phi1.clone(), phi2: phi2.clone() };
        place(body, &angles).centre[1].clone()
    };
    let candidates = (0..TRIED).map(|k| Real::whole(44 * k) / Real::whole(7 * TRIED));
    let start = candidates.map(|phi0| (height(&phi0), phi0)).reduce(|a, b| if b.0 < a.0 { b } else { a })?.1;
    let (phi0, stiffness) = stationary(body, phi1, phi2, &start);
    stiffness.is_positive().then_some(phi0)
}

/// The motion of a body that is at rest on the palms at every moment while they move slowly, from a stable
/// pose `phi0` at time zero.
pub fn follow(body: &PlanarBody, palms: &PalmMotion, phi0: &Real) -> Option<(Placement, PlanarMotion)> {
    let forms = [Palm::Flat, Palm::Flat];
    observe(body, palms, &forms, |time| stationary(body, &palms.phi1.at(time), &palms.phi2.at(time), phi0).0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::linear::solve;
    use palmistry_math::number::parse_decimal;

    /// At the lowest pose the two contact forces that carry the weight exert no torque about the centre of
    /// mass: statics, which the search for the least energy does not use.
    #[test]
    fn at_the_lowest_pose_forces_and_torques_balance() {
        let q = |text: &str| parse_decimal(text).unwrap();
        let harmonics = [(q("0.1"), q("-0.07")), (q("0.08"), q("0.03")), (q("0.02"), q("0.01"))];
        let body = PlanarBody::new(&q("1"), &harmonics).unwrap();
        let (phi1, phi2) = (Real::from_rational(&q("0.6")), Real::from_rational(&q("1.7")));
        let phi0 = lowest_pose(&body, &phi1, &phi2).unwrap();
        let placement = place(&body, &Angles { phi0, phi1, phi2 });
        let [n1, n2] = [0, 1].map(|i: usize| placement.contacts[i].normal.clone());
        let [f1, f2] = solve(
            [[n1[0].clone(), n2[0].clone()], [n1[1].clone(), n2[1].clone()]],
            [Real::zero(), Real::one()],
        );
        assert!(f1.is_positive() && f2.is_positive());
        let torque = &f1 * placement.moment(0) + &f2 * placement.moment(1);
        assert!(torque.abs() < Real::power_of_two(-150));
    }
}
