//! A body in space that tumbles on three palms under gravity, with derivatives by differences.

use super::grip::{Grip, grip, palm_frame, rotation};
use super::linear::{
    Square, Vector, apply, axial, cross, difference, dot, product, scaled, solve, transposed,
};
use super::motion::Swing;
use super::spheres::{PalmSphere, grip_on};
use super::{Derivatives, Real, Solid, differentiate};

/// A vector with its first and its second time derivative.
pub type MovingVector = [Vector<3>; 3];

/// A matrix with its first and its second time derivative.
pub type MovingSquare = [Square<3>; 3];

/// How a body and the palms under it move near time zero.
#[derive(Clone, Debug)]
pub struct SolidMotion {
    pub solid: Solid,
    /// The angles of `rotation` that turn the body.
    pub turn: [Swing; 3],
    /// The directions in which the palms rise, see [`palm_frame`]. They stay.
    pub azimuths: [Real; 3],
    /// How steeply they rise.
    pub palms: [Swing; 3],
    /// Palms without a sphere are planes.
    pub spheres: [Option<PalmSphere>; 3],
}

/// What moves at one contact.
#[derive(Clone, Debug)]
pub struct MovingContact {
    /// The contact in the world: `c_i`.
    pub world: MovingVector,
    /// The contact in the body's frame: `beta_i`.
    pub body: MovingVector,
    /// The outward normal in the body's frame: `n_i`.
    pub outward: MovingVector,
    /// The contact in the palm's frame: `s_i`.
    pub sensed: MovingVector,
    /// The palm's frame, by rows: `t_i1`, `t_i2`, `n_i` in the world.
    pub palm: MovingSquare,
}

/// What moves, at time zero.
#[derive(Clone, Debug)]
pub struct Tumbling {
    /// The centre of mass in the world.
    pub centre: MovingVector,
    /// The rotation from the body's frame to the world: `R_0`.
    pub turn: MovingSquare,
    pub contacts: [MovingContact; 3],
    /// How far the derivatives are to be trusted.
    pub error: Real,
}

impl Tumbling {
    /// The palm's normal at a contact, in the world: against the body's own.
    fn normal(&self, i: usize) -> Vector<3> {
        apply(&self.turn[0], &self.contacts[i].outward[0]).map(|x| -x)
    }
}

fn square(found: &Derivatives, begin: usize) -> MovingSquare {
    let rows: [MovingVector; 3] = std::array::from_fn(|row| found.vector(begin + 3 * row));
    std::array::from_fn(|order| rows.each_ref().map(|row| row[order].clone()))
}

/// The vector `w` with `M' = w × M` for the columns of a rotation `M`: its angular velocity in the world.
pub fn angular_velocity(turn: &MovingSquare) -> Vector<3> {
    axial(&product(&turn[1], &transposed(&turn[0])))
}

/// The rate of change of the angular velocity: the axis of `M'' Mᵀ`, whose symmetric part (the centripetal
/// one) does not affect the axis.
pub fn angular_acceleration(turn: &MovingSquare) -> Vector<3> {
    axial(&product(&turn[2], &transposed(&turn[0])))
}

impl SolidMotion {
    /// The rotation of the body and the palms' frames at a time.
    pub fn frames(&self, time: &Real) -> (Square<3>, [Square<3>; 3]) {
        let turn = rotation(&self.turn.each_ref().map(|swing| swing.at(time)));
        (turn, std::array::from_fn(|i| palm_frame(&self.azimuths[i], &self.palms[i].at(time))))
    }

    /// How the body lies at a time.
    pub fn grip(&self, time: &Real) -> Grip {
        let (turn, palms) = self.frames(time);
        self.laid(&turn, &palms)
    }

    fn laid(&self, turn: &Square<3>, palms: &[Square<3>; 3]) -> Grip {
        match self.spheres.iter().all(Option::is_none) {
            true => grip(&self.solid, turn, palms),
            false => grip_on(&self.solid, turn, palms, &self.spheres),
        }
    }

    /// Differentiates the motion.
    pub fn observe(&self) -> Tumbling {
        let quantities = |time: &Real| {
            let (turn, palms) = self.frames(time);
            let Grip { centre, contacts } = self.laid(&turn, &palms);
            let mut all: Vec<Real> = centre.into_iter().chain(turn.into_iter().flatten()).collect();
            for (contact, palm) in contacts.into_iter().zip(palms) {
                let vectors = [contact.world, contact.body, contact.outward, contact.sensed];
                all.extend(vectors.into_iter().flatten().chain(palm.into_iter().flatten()));
            }
            all
        };
        let found = differentiate(quantities, &Real::zero());
        let contacts = std::array::from_fn(|i| {
            let begin = 12 + 21 * i;
            MovingContact {
                world: found.vector(begin),
                body: found.vector(begin + 3),
                outward: found.vector(begin + 6),
                sensed: found.vector(begin + 9),
                palm: square(&found, begin + 12),
            }
        });
        Tumbling { centre: found.vector(0), turn: square(&found, 3), contacts, error: found.error }
    }
}

/// Masses and what else the laws of motion ask for, in SI units.
#[derive(Clone, Debug)]
pub struct SolidInertia {
    pub mass: Real,
    /// The second moments of the mass, the integrals of `x^2`, `y^2`, `z^2` over it, in the body's frame, in
    /// which the mixed ones vanish.
    pub second_moments: [Real; 3],
    /// The palms' moments of inertia about their axes.
    pub palms: [Real; 3],
    /// The acceleration of gravity along the Z axis: negative where it points down.
    pub gravity: Real,
}

/// A motion that obeys Newton's laws at time zero.
#[derive(Clone, Debug)]
pub struct SolidDynamics {
    pub tumbling: Tumbling,
    /// The forces that the palms exert on the body, along their normals.
    pub forces: [Real; 3],
    /// The torques about the palms' axes that the motors have to produce.
    pub torques: [Real; 3],
}

impl SolidInertia {
    /// The rate of change of the angular momentum about the centre of mass.
    ///
    /// The particle at `x` in the body's frame has the angular momentum `R x × R' x` for each unit of its
    /// mass, which changes at the rate `R x × R'' x`. Summed over the body that is twice the axis of `R'' J
    /// Rᵀ`, where `J` holds the second moments. Euler's equation is not used.
    fn angular_momentum_rate(&self, turn: &MovingSquare) -> Vector<3> {
        let weighted =
            turn[2].each_ref().map(|row| std::array::from_fn(|j| &row[j] * &self.second_moments[j]));
        scaled(&Real::whole(2), &axial(&product(&weighted, &transposed(&turn[0]))))
    }
}

/// The motion of a body on three palms, with the accelerations of its three angles found from Newton's laws;
/// those that `motion` names for the body are ignored.
///
/// A body in contact has three degrees of freedom, its orientation. The accelerations of the centre of mass
/// and of the rotation are affine functions of the accelerations of the three angles, found by differencing
/// four motions. The laws for the momentum and the angular momentum are six linear equations for these and
/// the three contact forces.
///
/// Undefined numbers come out where the equations do not determine the motion.
pub fn solid_dynamics(motion: &SolidMotion, inertia: &SolidInertia) -> SolidDynamics {
    let driven = |accelerations: [Real; 3]| {
        let mut motion = motion.clone();
        for (swing, acceleration) in motion.turn.iter_mut().zip(accelerations) {
            swing.acceleration = acceleration;
        }
        motion.observe()
    };
    let momenta = |tumbling: &Tumbling| -> Vector<6> {
        let mut rates = scaled(&inertia.mass, &tumbling.centre[2]).to_vec();
        rates.extend(inertia.angular_momentum_rate(&tumbling.turn));
        std::array::from_fn(|i| rates[i].clone())
    };
    let unit = |k: usize| std::array::from_fn(|i| Real::whole((i == k) as i64));
    let coasting = driven(unit(3));
    let rest = momenta(&coasting);
    // for each palm, the force and the moment about the centre of mass that a unit contact force exerts
    let wrench = |i: usize| -> Vector<6> {
        let contact = &coasting.contacts[i];
        let normal = coasting.normal(i);
        let moment = cross(&difference(&contact.world[0], &coasting.centre[0]), &normal);
        let mut both = normal.into_iter().chain(moment);
        std::array::from_fn(|_| both.next().unwrap_or(Real::UNDEFINED))
    };
    let columns: [Vector<6>; 6] = std::array::from_fn(|k| {
        if k < 3 { difference(&momenta(&driven(unit(k))), &rest) } else { wrench(k - 3).map(|x| -x) }
    });
    let weight = &inertia.mass * &inertia.gravity;
    let missing = std::array::from_fn(|i| if i == 2 { &weight - &rest[i] } else { -&rest[i] });
    let [a, b, c, f1, f2, f3] = solve(transposed(&columns), missing);

    let tumbling = driven([a, b, c]);
    let forces = [f1, f2, f3];
    let torques = std::array::from_fn(|i| {
        let contact = &tumbling.contacts[i];
        let reaction = scaled(&-&forces[i], &tumbling.normal(i));
        let moment = dot(&contact.palm[0][0], &cross(&contact.world[0], &reaction));
        &inertia.palms[i] * &motion.palms[i].acceleration - moment
    });
    SolidDynamics { tumbling, forces, torques }
}
