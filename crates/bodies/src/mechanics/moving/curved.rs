//! The laws of motion at one moment between palms of any form. For flat ones `laws` has them, with less to solve.
//!
//! A sensor's value `s` says where palm `i` is touched, `p(s)`, and which way its normal points there, hence which point `X`
//! of the body touches, as seen from the centre of mass; both in the world. So `c = p(s_1) - X_1 = p(s_2) - X_2`, two equations for
//! the two values. A palm that turns at the rate `w` carries `p` along, `p' = w Jp + s' T` with the tangent `T` away from the
//! joint; the normal turns at `a = w + k s'` with the palm's curvature `k` (`w - k s'` on palm 2, whose body is on the other
//! side), and the body's point moves over the body by its radius of curvature, `X' = omega0 JX + v (a - omega0) Ju`, `u` the
//! outward normal. Both contacts give one velocity: two linear equations for `s_1'` and `s_2'`. Once more differentiated, and
//! projected on `u`, the unknown `s''` and `v'` drop out:
//!
//! ```text
//! u · c'' = A u · Jp - w^2 u · p -+ 2 w s' - k s'^2 + alpha0 h' + omega0^2 h + v (a - omega0)(a + omega0)
//! ```
//!
//! with the palm's acceleration `A` and `X = h u + h' Ju`. Into this go Newton's and Euler's laws, as for flat palms.

use super::drive::Drive;
use super::laws::{Situation, State};
use super::plane::{Plane, along, cross, dot, left_of, meet, scaled, unit};
use super::scene::MovingScene;
use crate::mechanics::palm::Palm;
use std::f64::consts::FRAC_PI_2;

/// From flat to bent in so many steps: of two bent palms a body may touch both near the joint or far from it, and what is near
/// the joint goes over into what flat palms have.
const BENDS: u32 = 4;
/// Newton's method takes no more steps than this.
const MOST_STEPS: usize = 30;

/// Left of palm 1 and right of palm 2 is the body.
const SIDES: [f64; 2] = [1.0, -1.0];

/// A palm in the world, and how the body is turned.
#[derive(Clone, Copy)]
struct Standing {
    palm: Palm<f64>,
    angle: f64,
    side: f64,
    orientation: f64,
}

/// A contact, in the world.
#[derive(Clone, Copy)]
struct Touch {
    /// The contact, from the joint.
    place: Plane,
    /// Away from the joint.
    tangent: Plane,
    /// The outward normal of the body.
    outward: Plane,
    curvature: f64,
    /// The support function and its derivatives there.
    support: [f64; 3],
}

impl Standing {
    fn touch(&self, scene: &MovingScene, s: f64, part: f64) -> Touch {
        let point = self.palm.flattened(&part).at(&s);
        let ahead = unit(self.angle);
        let across = scaled(self.side, left_of(ahead));
        let world = |own: Plane| along(scaled(own[0], ahead), own[1], across);
        let normal = self.angle + self.side * (point.turned - FRAC_PI_2);
        Touch {
            place: world(point.place),
            tangent: world(point.tangent),
            outward: scaled(-1.0, world(point.normal)),
            curvature: point.curvature,
            support: scene.shape.support(normal - self.orientation),
        }
    }
}

impl Touch {
    /// The contact as seen from the centre of mass.
    fn arm(&self) -> Plane {
        along(scaled(self.support[0], self.outward), self.support[1], left_of(self.outward))
    }

    fn centre(&self) -> Plane {
        along(self.place, -1.0, self.arm())
    }

    fn radius_of_curvature(&self) -> f64 {
        self.support[0] + self.support[2]
    }

    /// How fast the centre of mass moves along the tangent where the sensor's value grows: the contact's own way less the
    /// body's.
    fn gain(&self) -> f64 {
        1.0 - self.curvature * self.radius_of_curvature()
    }
}

/// The sensor values of a body that touches both palms; not finite where none are found.
fn sensed(scene: &MovingScene, palms: &[Standing; 2]) -> [f64; 2] {
    let mut s = [0.0; 2];
    for bend in 0..=BENDS {
        let part = f64::from(bend) / f64::from(BENDS);
        let mut last = f64::INFINITY;
        for step in 0..=MOST_STEPS {
            let [one, two] = [0, 1].map(|i: usize| palms[i].touch(scene, s[i], part));
            let (apart, first, second) = (
                along(two.centre(), -1.0, one.centre()),
                scaled(one.gain(), one.tangent),
                scaled(-two.gain(), two.tangent),
            );
            let by = meet([first[0], second[0]], apart[0], [first[1], second[1]], apart[1]);
            s = [s[0] + by[0], s[1] + by[1]];
            let size = by[0].hypot(by[1]);
            // below a millionth the next step is rounding
            if size <= 1e-14 * s[0].hypot(s[1]) || (last < 1e-6 && size >= last) {
                break;
            }
            if step == MOST_STEPS || !size.is_finite() {
                return [f64::NAN; 2];
            }
            last = size;
        }
    }
    // a palm as hollow as the body would be touched twice
    let single = (0..2).all(|i| palms[i].touch(scene, s[i], 1.0).gain() > 0.0);
    if single { s } else { [f64::NAN; 2] }
}

impl Situation {
    /// The contacts, forces and accelerations of a state between palms of any form. Not finite where the body touches both
    /// nowhere, or the tangents at the contacts are parallel.
    pub(super) fn between_curved(scene: &MovingScene, time: f64, state: &State) -> Situation {
        let [phi0, omega0, ..] = *state;
        let world = scene.palms_at(time, state);
        let [angles, rates] = [0, 1].map(|k: usize| [world[0][k], world[1][k]]);
        let standing = [0, 1].map(|i: usize| Standing {
            palm: scene.palms[i],
            angle: angles[i],
            side: SIDES[i],
            orientation: phi0,
        });
        let s = sensed(scene, &standing);
        let touches = [0, 1].map(|i: usize| standing[i].touch(scene, s[i], 1.0));
        let centre = touches[0].centre();

        // the velocity of the centre but for what the contact's own motion along the palm makes of it
        let carried = [0, 1].map(|i: usize| {
            let (touch, w) = (&touches[i], rates[i]);
            let with_palm = along(scaled(w, left_of(touch.place)), -omega0, left_of(touch.arm()));
            along(with_palm, -touch.radius_of_curvature() * (w - omega0), left_of(touch.outward))
        });
        let ways = [0, 1].map(|i: usize| scaled(touches[i].gain(), touches[i].tangent));
        let apart = along(carried[1], -1.0, carried[0]);
        let s_rates = meet([ways[0][0], -ways[1][0]], apart[0], [ways[0][1], -ways[1][1]], apart[1]);
        let velocity = along(carried[0], s_rates[0], ways[0]);

        let normals = touches.map(|touch| scaled(-1.0, touch.outward));
        let moments = [0, 1].map(|i: usize| cross(touches[i].arm(), normals[i]));
        let levers = [0, 1].map(|i: usize| cross(touches[i].place, normals[i]));
        let (mass, inertia) = (scene.mass, scene.mass * scene.gyration * scene.gyration);
        let gravity = [0.0, scene.gravity];
        let mut rows = [[0.0; 2]; 2];
        let mut right = [0.0; 2];
        for i in 0..2 {
            let (touch, w, s_rate) = (&touches[i], rates[i], s_rates[i]);
            let [h, slope, _] = touch.support;
            for j in 0..2 {
                rows[i][j] = dot(touch.outward, normals[j]) / mass - slope * moments[j] / inertia;
            }
            let turning = w + SIDES[i] * touch.curvature * s_rate;
            right[i] = omega0 * omega0 * h
                + touch.radius_of_curvature() * (turning - omega0) * (turning + omega0)
                - w * w * dot(touch.outward, touch.place)
                - 2.0 * SIDES[i] * w * s_rate
                - touch.curvature * s_rate * s_rate
                - dot(touch.outward, gravity);
            // u · Jp is minus the lever
            match &scene.drive {
                Drive::Prescribed(_) => right[i] -= levers[i] * world[i][2],
                Drive::Torques(palms) => {
                    rows[i][i] -= levers[i] * levers[i] / scene.palm_inertia[i];
                    right[i] -= levers[i] * palms[i].torque_at(time) / scene.palm_inertia[i];
                }
            }
        }
        let forces = meet(rows[0], right[0], rows[1], right[1]);
        let (accelerations, torques) = scene.accelerations_and_torques(time, &world, levers, forces);
        Situation {
            alpha0: dot(forces, moments) / inertia,
            s,
            r: touches.map(|touch| touch.support[0]),
            d: touches.map(|touch| -touch.support[1]),
            opening: cross(normals[1], normals[0]),
            centre,
            velocity,
            angles,
            rates,
            accelerations,
            forces,
            torques,
        }
    }
}
