//! The laws of motion at one moment, between flat palms (`curved` has the others): geometry of contact, Newton's and Euler's laws, two linear equations for the
//! contact forces.
//!
//! Palm `i` has the world angle `psi_i`, the rate `w_i` and the normal `n_i` towards the body; the body's outward
//! normal at the contact is at the angle `a_i` in the body's frame, and `a_i' = w_i - omega0`. That the palm touches
//! the body is `n_i · c = h(a_i)` for the centre of mass `c`, and once and twice differentiated
//!
//! ```text
//! n · c'  + w Jn · c                            = h' a'
//! n · c'' + 2 w Jn · c' + A Jn · c - w^2 n · c  = h'' a'^2 + h' (A - alpha0)
//! ```
//!
//! with the quarter turn `J` and the palm's acceleration `A`. Into the second go Newton's law `c'' = g + sum f_j n_j /
//! m`, Euler's `m rho^2 alpha0 = sum f_j M_j`, where `M_j`, the moment of a unit contact force about the centre of
//! mass, and `l_j`, that about the origin, are cross products with `n_j`, and, where torques drive the palms, `I A =
//! tau - l f`. Left are two equations for the two forces.

use super::breach::Breach;
use super::drive::Drive;
use super::plane::{Plane, along, cross, dot, left_of, meet, scaled, unit};
use super::scene::MovingScene;
use crate::mechanics::pace::longest_step;
use crate::mechanics::palm::Palm;
use std::f64::consts::FRAC_PI_2;

/// What is integrated: `phi0`, `omega0`, `phi1`, `omega1`, `phi2`, `omega2` (these four stay as they are where the
/// palms' angles are prescribed) and the work done by the motors.
pub(super) type State = [f64; 7];

/// A state at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimedState {
    /// In s.
    pub time: f64,
    pub state: State,
}

/// Palms count as parallel where the sine of the angle between them is below this. The forces follow from equations
/// whose determinant falls with the square of the sine, so that half of their digits are lost there.
const PARALLEL: f64 = 1e-4;

/// All that is known at one moment. Palms are in the world's frame here: both angles, rates and accelerations are
/// against the X axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Situation {
    pub alpha0: f64,
    pub centre: Plane,
    pub velocity: Plane,
    pub angles: [f64; 2],
    pub rates: [f64; 2],
    pub accelerations: [f64; 2],
    pub s: [f64; 2],
    pub r: [f64; 2],
    pub d: [f64; 2],
    pub forces: [f64; 2],
    pub torques: [f64; 2],
    /// The sine of the angle between the palms' tangents at the contacts.
    pub opening: f64,
}

/// How a body lies between flat palms, and how it moves: what follows from its orientation and rate and those of the palms.
pub(super) struct Touching {
    /// Of the palms, against the X axis.
    pub angles: [f64; 2],
    pub rates: [f64; 2],
    /// Towards the body.
    pub normals: [Plane; 2],
    /// The support function and its derivatives at the contacts.
    pub support: [[f64; 3]; 2],
    /// How fast the contacts' normals turn in the body's frame.
    pub swept: [f64; 2],
    pub centre: Plane,
    pub velocity: Plane,
    /// The contacts, from the centre of mass and from the origin.
    pub arms: [Plane; 2],
    pub contacts: [Plane; 2],
}

impl Touching {
    /// Not finite where the palms are parallel.
    pub(super) fn of(scene: &MovingScene, world: &[[f64; 3]; 2], [phi0, omega0]: [f64; 2]) -> Touching {
        let [angles, rates] = [0, 1].map(|k: usize| [world[0][k], world[1][k]]);
        let normals = [left_of(unit(angles[0])), scaled(-1.0, left_of(unit(angles[1])))];
        let outward = [angles[0] - FRAC_PI_2 - phi0, angles[1] + FRAC_PI_2 - phi0];
        let support = outward.map(|angle| scene.shape.support(angle));
        let swept = rates.map(|rate| rate - omega0);
        let turned = normals.map(left_of);
        let centre = meet(normals[0], support[0][0], normals[1], support[1][0]);
        let closing = |i: usize| support[i][1] * swept[i] - rates[i] * dot(turned[i], centre);
        let velocity = meet(normals[0], closing(0), normals[1], closing(1));
        // the outward normal is -n
        let arms =
            [0, 1].map(|i: usize| along(scaled(-support[i][0], normals[i]), -support[i][1], turned[i]));
        let contacts = arms.map(|arm| along(centre, 1.0, arm));
        Touching { angles, rates, normals, support, swept, centre, velocity, arms, contacts }
    }
}

impl MovingScene {
    /// The longest step of the integrator, in s, in a motion that goes on until `last`.
    pub(super) fn longest_step(&self, last: f64) -> f64 {
        longest_step(last, self.gyration, self.rate, self.gravity)
    }

    /// The state at time zero.
    pub(super) fn start(&self) -> State {
        let mut state = [self.orientation, self.rate, 0.0, 0.0, 0.0, 0.0, 0.0];
        if let Drive::Torques(palms) = &self.drive {
            for (i, palm) in palms.iter().enumerate() {
                (state[2 + 2 * i], state[3 + 2 * i]) = (palm.angle, palm.rate);
            }
        }
        state
    }

    /// Angle, rate and, where it is prescribed, acceleration of both palms against the X axis.
    pub(super) fn palms_at(&self, time: f64, state: &State) -> [[f64; 3]; 2] {
        let own: [[f64; 3]; 2] = match &self.drive {
            Drive::Prescribed(courses) => [courses[0].at(time), courses[1].at(time)],
            Drive::Torques(_) => [[state[2], state[3], 0.0], [state[4], state[5], 0.0]],
        };
        [own[0], std::array::from_fn(|k| own[0][k] + own[1][k])]
    }

    /// The palms' accelerations and the motors' torques, by the palms' own law: one of the two is prescribed.
    pub(super) fn accelerations_and_torques(
        &self,
        time: f64,
        world: &[[f64; 3]; 2],
        levers: [f64; 2],
        forces: [f64; 2],
    ) -> ([f64; 2], [f64; 2]) {
        match &self.drive {
            Drive::Prescribed(_) => {
                let told = [world[0][2], world[1][2]];
                let torque = |i: usize| self.palm_inertia[i] * told[i] + levers[i] * forces[i];
                (told, [torque(0), torque(1)])
            }
            Drive::Torques(palms) => {
                let torques = [0, 1].map(|i: usize| palms[i].torque_at(time));
                let found = |i: usize| (torques[i] - levers[i] * forces[i]) / self.palm_inertia[i];
                ([found(0), found(1)], torques)
            }
        }
    }
}

impl Situation {
    /// The contacts, forces and accelerations that a state has at a time. Not finite where the palms are parallel.
    pub(super) fn at(scene: &MovingScene, time: f64, state: &State) -> Situation {
        if scene.palms.iter().any(|palm| *palm != Palm::Flat) {
            return Situation::between_curved(scene, time, state);
        }
        let world = scene.palms_at(time, state);
        let Touching { angles, rates, normals, support, swept, centre, velocity, arms, contacts } =
            Touching::of(scene, &world, [state[0], state[1]]);
        let turned = normals.map(left_of);
        let moments = [0, 1].map(|i: usize| cross(arms[i], normals[i]));
        let levers = [0, 1].map(|i: usize| cross(contacts[i], normals[i]));

        let (mass, inertia) = (scene.mass, scene.mass * scene.gyration * scene.gyration);
        let gravity = [0.0, scene.gravity];
        let mut rows = [[0.0; 2]; 2];
        let mut right = [0.0; 2];
        for i in 0..2 {
            for j in 0..2 {
                rows[i][j] = dot(normals[i], normals[j]) / mass + support[i][1] * moments[j] / inertia;
            }
            // what stands beside the palm's acceleration
            let share = dot(turned[i], centre) - support[i][1];
            right[i] = support[i][2] * swept[i] * swept[i] + rates[i] * rates[i] * support[i][0]
                - dot(normals[i], gravity)
                - 2.0 * rates[i] * dot(turned[i], velocity);
            match &scene.drive {
                Drive::Prescribed(_) => right[i] -= share * world[i][2],
                Drive::Torques(palms) => {
                    rows[i][i] -= share * levers[i] / scene.palm_inertia[i];
                    right[i] -= share * palms[i].torque_at(time) / scene.palm_inertia[i];
                }
            }
        }
        let forces = meet(rows[0], right[0], rows[1], right[1]);
        let (accelerations, torques) = scene.accelerations_and_torques(time, &world, levers, forces);
        Situation {
            alpha0: dot(forces, moments) / inertia,
            s: [0, 1].map(|i: usize| dot(contacts[i], unit(angles[i]))),
            r: [support[0][0], support[1][0]],
            // the thesis's tangent is a quarter turn clockwise from the outward normal
            d: [-support[0][1], -support[1][1]],
            opening: (angles[1] - angles[0]).sin(),
            centre,
            velocity,
            angles,
            rates,
            accelerations,
            forces,
            torques,
        }
    }

    /// How fast the state changes.
    pub(super) fn rates(&self, state: &State, drive: &Drive) -> State {
        let power = dot(self.torques, self.rates);
        let [a1, a12] = self.accelerations;
        match drive {
            Drive::Prescribed(_) => [state[1], self.alpha0, 0.0, 0.0, 0.0, 0.0, power],
            Drive::Torques(_) => [state[1], self.alpha0, state[3], a1, state[5], a12 - a1, power],
        }
    }

    /// What is wrong with the contacts, if anything is.
    pub(super) fn breach(&self, scene: &MovingScene) -> Option<Breach> {
        let positive = |x: f64| x > 0.0;
        if !positive(self.opening - PARALLEL) {
            return Some(Breach::Parallel);
        }
        let each = |holds: &dyn Fn(usize) -> bool| (0..2).find(|&i| !holds(i)).map(|i| i + 1);
        let on_palm = |i: usize| {
            // a flat palm's contact lies on the body's side of the other one; an arc ends where it has turned by half a turn
            let reach = scene.palms[i].reach();
            positive(scene.palm_lengths[i].min(reach) - self.s[i])
                && (reach.is_infinite() || positive(self.s[i]))
        };
        let beyond = each(&on_palm).map(|palm| Breach::Beyond { palm });
        let contact = each(&|i| positive(self.forces[i])).map(|palm| Breach::Contact { palm });
        beyond.or(contact)
    }
}
