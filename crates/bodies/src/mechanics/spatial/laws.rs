//! The laws of motion at one moment.
//!
//! The body touches palm `i` with the boundary point `X_i`, as seen from the centre of mass `c`, whose outward normal is minus the
//! palm's `n`. On flat palms contact is `n . (c - o) = h(u)`, with a point `o` of the hinge, the support function `h` and `u = -R^T n` in the body's
//! frame. These three linear equations are where `c` comes from, so that no contact drifts (`contact` solves them for spheres, where
//! `n` depends on `c`). The palm turns at `w`, the body at
//! `omega`, so that `R u' = -(w - omega) x n`. Differentiated once, with the gradient of `h`,
//!
//! ```text
//! n . c' + n' . (c - o) = -X . ((w - omega) x n),      n' = w x n
//! ```
//!
//! and once more, with its second derivatives `H`,
//!
//! ```text
//! n . c'' + 2 n' . c' + n'' . (c - o) = u' . H u' - X . (w' x n - omega' x n + (w - omega) x (w x n) - omega x ((w - omega) x n))
//! ```
//!
//! On a palm with the curvature `k` the normal is `N`, whose rate in the palm is `k` times that of the contact, `tau`: `N' = w x N + k tau`. What is
//! left of `N . (c' + omega x X - w x (c + X - o)) = 0`, whose bracket is how the body slides, `g`, is its derivative
//!
//! ```text
//! N . c'' + N . (omega' x X) = N . (w' x (c + X - o)) + N . (w x (w x (c + X - o))) - N . (omega x X') - g . N' - tau . (w x N),
//! (1 + k H) tau = g - H (w - omega) x N,      X' = omega x X - H ((w - omega) x N + k tau),
//! ```
//!
//! `H` in the world; the radius itself, which a plane has not, is in none of these.
//!
//! Into this go Newton's and Euler's laws, `m c'' = m g + sum f n` and `J omega' + omega x J omega = sum f X x n`, and that of a palm
//! which is pushed, `I w' = torque - f a . ((X + c - o) x n)` about its hinge `a`. They are linear in the forces `f`: three equations.

use super::contact::{Contacts, FLAT, Places};
use super::scene::{SpatialDrive, SpatialScene};
use nalgebra::{Matrix3, Vector3};

/// What holds at one moment, in the world. SI units.
#[derive(Clone, Debug)]
pub(super) struct Situation {
    pub centre: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub acceleration: Vector3<f64>,
    /// The rate of the angular velocity.
    pub turning: Vector3<f64>,
    /// The angular momentum about the centre of mass.
    pub spin: Vector3<f64>,
    /// From the centre of mass to the contacts.
    pub arms: [Vector3<f64>; 3],
    /// The palms' normals at the contacts.
    pub normals: [Vector3<f64>; 3],
    /// The contacts on their palms: along the hinge and up the palm, from the point of the hinge.
    pub sensed: [[f64; 2]; 3],
    pub angles: [f64; 3],
    pub rates: [f64; 3],
    pub accelerations: [f64; 3],
    pub forces: [f64; 3],
    pub torques: [f64; 3],
    /// The volume that the three normals span.
    opening: f64,
    /// Where contacts were found on spheres; none where there is no place where the body touches all palms.
    pub touched: Option<Places>,
}

impl Situation {
    /// What holds where the body is turned so, turns at a rate, and pushed palms have these angles and rates. Not finite where the
    /// palms' normals lie in one plane. On spheres contacts are searched for near some places, if they are known.
    pub fn at(
        scene: &SpatialScene,
        time: f64,
        turn: &Matrix3<f64>,
        omega: &Vector3<f64>,
        pushed: &[[f64; 2]; 3],
        near: Option<Places>,
    ) -> Situation {
        let told = scene.palms_at(time, pushed);
        let each = |k: usize| told.map(|palm| palm[k]);
        let (angles, rates) = (each(0), each(1));
        let hinges = scene.palms.map(|palm| Vector3::from(palm.hinge));
        let Contacts { frames, normals, supports, arms, reaches, places: touched } =
            Contacts::of(scene, angles, turn, near);

        let by_normals = Matrix3::from_columns(&normals).transpose();
        let back = by_normals.try_inverse().unwrap_or_else(|| Matrix3::repeat(f64::NAN));
        let centre = back * Vector3::from(reaches);
        let axes = frames.map(|frame| frame.column(0).into_owned());
        let palm_rates: [Vector3<f64>; 3] = std::array::from_fn(|i| axes[i] * rates[i]);
        let normal_rates: [Vector3<f64>; 3] = std::array::from_fn(|i| palm_rates[i].cross(&normals[i]));
        // how the normal moves for the body
        let passing: [Vector3<f64>; 3] = std::array::from_fn(|i| (palm_rates[i] - omega).cross(&normals[i]));
        let approach = |i: usize| -arms[i].dot(&passing[i]) - normal_rates[i].dot(&(centre - hinges[i]));
        let velocity = back * Vector3::from_fn(|i, _| approach(i));

        let places: [Vector3<f64>; 3] = std::array::from_fn(|i| centre + arms[i] - hinges[i]);
        // a force along the normal has these moments about hinge and centre of mass
        let levers: [f64; 3] = std::array::from_fn(|i| axes[i].dot(&places[i].cross(&normals[i])));
        let moments: [Vector3<f64>; 3] = std::array::from_fn(|i| arms[i].cross(&normals[i]));

        let inertia = turn * (scene.inertia_over_mass * scene.mass) * turn.transpose();
        let spin = inertia * omega;
        let inverse = inertia.try_inverse().unwrap_or_else(|| Matrix3::repeat(f64::NAN));
        let coasting = -inverse * omega.cross(&spin);
        let gravity = Vector3::from(scene.gravity);
        // n . c'' + moment . omega' = wanted + lever w'
        let wanted = |i: usize| {
            let (w, n) = (palm_rates[i], normals[i]);
            if !scene.palms[i].is_flat() {
                let bend = turn * supports[i].bend * turn.transpose();
                let k = scene.palms[i].curvature;
                let sliding = velocity + omega.cross(&arms[i]) - w.cross(&places[i]);
                let back = (Matrix3::identity() + bend * k).try_inverse();
                let back = back.unwrap_or_else(|| Matrix3::repeat(f64::NAN));
                // how fast the contact moves on the palm, and on the body
                let along = back * (sliding - bend * passing[i]);
                let arm_rate = omega.cross(&arms[i]) - bend * (passing[i] + along * k);
                return n.dot(&w.cross(&w.cross(&places[i])))
                    - n.dot(&omega.cross(&arm_rate))
                    - sliding.dot(&(normal_rates[i] + along * k))
                    - along.dot(&normal_rates[i]);
            }
            let turned = turn.transpose() * passing[i];
            let bend = turned.dot(&(supports[i].bend * turned));
            let fictitious = (w - omega).cross(&normal_rates[i]) - omega.cross(&passing[i]);
            bend - arms[i].dot(&fictitious)
                - 2.0 * normal_rates[i].dot(&velocity)
                - w.cross(&w.cross(&n)).dot(&(centre - hinges[i]))
        };
        let mut rows = Matrix3::from_fn(|i, j| {
            normals[i].dot(&normals[j]) / scene.mass + moments[i].dot(&(inverse * moments[j]))
        });
        let mut right =
            Vector3::from_fn(|i, _| wanted(i) - normals[i].dot(&gravity) - moments[i].dot(&coasting));
        for i in 0..3 {
            match &scene.drive {
                SpatialDrive::Prescribed(_) => right[i] += levers[i] * told[i][2],
                SpatialDrive::Torques(palms) => {
                    let own = scene.palms[i].inertia;
                    rows[(i, i)] += levers[i] * levers[i] / own;
                    right[i] += levers[i] * palms[i].torque_at(time) / own;
                }
            }
        }
        let forces = rows.try_inverse().unwrap_or_else(|| Matrix3::repeat(f64::NAN)) * right;
        let forces: [f64; 3] = forces.into();
        let sum = |vectors: &[Vector3<f64>; 3]| {
            (0..3).fold(Vector3::zeros(), |total: Vector3<f64>, i| total + vectors[i] * forces[i])
        };
        let (accelerations, torques) = match &scene.drive {
            SpatialDrive::Prescribed(_) => {
                let torque = |i: usize| scene.palms[i].inertia * told[i][2] + levers[i] * forces[i];
                (each(2), std::array::from_fn(torque))
            }
            SpatialDrive::Torques(palms) => {
                let torques: [f64; 3] = std::array::from_fn(|i| palms[i].torque_at(time));
                let of = |i: usize| (torques[i] - levers[i] * forces[i]) / scene.palms[i].inertia;
                (std::array::from_fn(of), torques)
            }
        };
        Situation {
            centre,
            velocity,
            acceleration: gravity + sum(&normals) / scene.mass,
            turning: coasting + inverse * sum(&moments),
            spin,
            sensed: std::array::from_fn(|i| [0, 1].map(|k: usize| frames[i].column(k).dot(&places[i]))),
            arms,
            normals,
            angles,
            rates,
            accelerations,
            forces,
            torques,
            opening: by_normals.determinant(),
            touched,
        }
    }

    /// Whether the palms hold the body no more in three directions.
    pub fn is_flat(&self) -> bool {
        // false for what is no number
        let open = self.opening.abs() > FLAT;
        !open
    }

    /// The first palm, counted from 1, whose force is not positive.
    pub fn pulling(&self) -> Option<usize> {
        self.forces.iter().position(|force| force.is_nan() || *force <= 0.0).map(|i| i + 1)
    }
}
