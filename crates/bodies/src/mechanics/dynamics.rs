//! A planar body that moves under gravity and the forces of two frictionless palms.

use super::contact::Placement;
use super::linear::{Vector, cross_planar, scaled, solve};
use super::motion::{PalmMotion, PlanarMotion, Swing, observe};
use super::{Palm, PlanarBody, Real};

/// Masses and what else the laws of motion ask for, in SI units.
#[derive(Clone, Debug)]
pub struct Inertia {
    /// The body's mass.
    pub mass: Real,
    /// The body's radius of gyration about its centre of mass.
    pub gyration: Real,
    /// The palms' moments of inertia about the origin.
    pub palms: [Real; 2],
    /// The acceleration of gravity along the Y axis: negative where it points down.
    pub gravity: Real,
}

/// A motion that obeys Newton's laws at time zero.
#[derive(Clone, Debug)]
pub struct PlanarDynamics {
    /// How the body lies.
    pub placement: Placement,
    /// Its motion, with the angular acceleration that the laws ask for.
    pub motion: PlanarMotion,
    /// The forces that the palms exert on the body, along their normals.
    pub forces: [Real; 2],
    /// The torques about the origin that the palms' motors have to produce.
    pub torques: [Real; 2],
}

/// The motion of a body that is turned by `phi0` and turns at the rate `omega0`, while the palms move as
/// prescribed.
///
/// A body in contact with both palms has one degree of freedom, its orientation. The acceleration of the
/// centre of mass is an affine function of the angular acceleration `a`, found by differencing the motions
/// with `a = 0` and `a = 1`. Newton's law for the centre (two equations) and Euler's for the rotation then
/// are three linear equations for `a` and the two contact forces. Each palm's torque follows from its own
/// law, with the opposite of the contact force acting on it where the contact is.
///
/// Undefined numbers come out where the equations do not determine the motion.
pub fn planar_dynamics(
    body: &PlanarBody,
    palms: &PalmMotion,
    phi0: &Real,
    omega0: &Real,
    inertia: &Inertia,
) -> Option<PlanarDynamics> {
    planar_dynamics_on(body, palms, &[Palm::Flat, Palm::Flat], [phi0, omega0], inertia)
}

/// The same between palms of any form; `start` is the body's angle and its rate.
pub fn planar_dynamics_on(
    body: &PlanarBody,
    palms: &PalmMotion,
    forms: &[Palm<Real>; 2],
    start: [&Real; 2],
    inertia: &Inertia,
) -> Option<PlanarDynamics> {
    let turning = |acceleration: Real| {
        let swing = Swing { value: start[0].clone(), rate: start[1].clone(), acceleration };
        observe(body, palms, forms, |time| swing.at(time))
    };
    let (placement, coasting) = turning(Real::zero())?;
    let (_, driven) = turning(Real::one())?;

    let mass = &inertia.mass;
    let normals = [0, 1].map(|i: usize| &placement.contacts[i].normal);
    // mass * (coasting + a * response) = mass * gravity + f1 n1 + f2 n2;   mass * gyration^2 * a = f1 m1 + f2
    // m2
    let response = [0, 1].map(|i: usize| &driven.centre[i].second - &coasting.centre[i].second);
    let gravity = [Real::zero(), inertia.gravity.clone()];
    let row = |i: usize| [mass * &response[i], -&normals[0][i], -&normals[1][i]];
    let moment_of_inertia = mass * &inertia.gyration * &inertia.gyration;
    let left = [row(0), row(1), [moment_of_inertia, -placement.moment(0), -placement.moment(1)]];
    let missing = |i: usize| mass * (&gravity[i] - &coasting.centre[i].second);
    let [acceleration, f1, f2] = solve(left, [missing(0), missing(1), Real::zero()]);

    let (placement, motion) = turning(acceleration)?;
    let forces = [f1, f2];
    let alpha = [palms.phi1.acceleration.clone(), &palms.phi1.acceleration + &palms.phi2.acceleration];
    let torques = [0, 1].map(|i: usize| {
        let contact = &placement.contacts[i];
        let reaction: Vector<2> = scaled(&-&forces[i], &contact.normal);
        &inertia.palms[i] * &alpha[i] - cross_planar(&contact.world, &reaction)
    });
    Some(PlanarDynamics { placement, motion, forces, torques })
}
