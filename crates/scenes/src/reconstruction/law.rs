//! A convex body that slides between two flat palms with measured motion: one degree of freedom, no contact force and no torque in it.
//!
//! The palms run through the origin. Palm `i` at the angle `w_i` has the direction `e_i` and the normal `n_i` towards the body, which turns against
//! `e_i` by a right angle on palm 1 and back by one on palm 2. With the support function `h` about the centre of mass and the body's angle `phi`,
//!
//! ```text
//! n_i · c = h(a_i),   a_i = w_i - pi/2 - phi  or  w_i + pi/2 - phi,   s_i = e_i · c + h'(a_i)  or  e_i · c - h'(a_i),
//! ```
//!
//! so that `c` is a function of `phi` and the time. Forces without friction do no work in a turn of the body between palms that stand still, and d'Alembert's
//! principle gives `(|c_phi|^2 + rho^2) phi'' = c_phi · (g - a)`, where `a` is what `c''` is without `phi''`. The mass is not in it.

use num_dual::DualNum;
use std::f64::consts::FRAC_PI_2;

/// Both palms at a time, in the world.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PalmsAt {
    /// In rad.
    pub angles: [f64; 2],
    /// In rad/s.
    pub rates: [f64; 2],
    /// In rad/s^2.
    pub accelerations: [f64; 2],
}

/// On which side of a palm the body is.
const SIDES: [f64; 2] = [1.0, -1.0];

impl PalmsAt {
    /// The angles of the body's outward normals at the contacts, in its frame.
    pub fn normals(&self, phi: f64) -> [f64; 2] {
        [0, 1].map(|i| self.angles[i] - SIDES[i] * FRAC_PI_2 - phi)
    }
}

/// What follows from a pose.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose<D> {
    /// `phi''`, in rad/s^2.
    pub acceleration: D,
    /// `s_1` and `s_2`, in m.
    pub contacts: [D; 2],
    /// The centre of mass in the world, in m.
    pub centre: [D; 2],
}

/// The pose and acceleration from `[h, h', h'']` at both contacts, the body's rate, its radius of gyration, and gravity's acceleration along the Y axis.
pub(super) fn pose<D: DualNum<Primitive = f64> + Copy>(
    palms: &PalmsAt,
    support: &[[D; 3]; 2],
    rate: D,
    gyration: D,
    gravity: f64,
) -> Pose<D> {
    let along = palms.angles.map(|angle| {
        let (sine, cosine) = angle.sin_cos();
        [cosine, sine]
    });
    let normals = [0, 1].map(|i| [-SIDES[i] * along[i][1], SIDES[i] * along[i][0]]);
    let determinant = normals[0][0] * normals[1][1] - normals[0][1] * normals[1][0];
    // the vector whose products with both normals are known
    let solve = |right: [D; 2]| -> [D; 2] {
        [
            (right[0] * normals[1][1] - right[1] * normals[0][1]) / determinant,
            (right[1] * normals[0][0] - right[0] * normals[1][0]) / determinant,
        ]
    };
    let dot = |v: [D; 2], fixed: [f64; 2]| v[0] * fixed[0] + v[1] * fixed[1];
    let turned = [0, 1].map(|i| -rate + palms.rates[i]);
    // the normals' rates are -w e, those again -w' e - w^2 n
    let slopes = [0, 1].map(|i| along[i].map(|x| -SIDES[i] * palms.rates[i] * x));
    let bends = [0, 1].map(|i| {
        [0, 1].map(|x| {
            -SIDES[i] * palms.accelerations[i] * along[i][x] - palms.rates[i].powi(2) * normals[i][x]
        })
    });
    let centre = solve([0, 1].map(|i| support[i][0]));
    let velocity = solve([0, 1].map(|i| support[i][1] * turned[i] - dot(centre, slopes[i])));
    let drift = solve([0, 1].map(|i| {
        let own = support[i][2] * turned[i] * turned[i] + support[i][1] * palms.accelerations[i];
        own - dot(velocity, slopes[i]) * 2.0 - dot(centre, bends[i])
    }));
    let by_angle = solve([0, 1].map(|i| -support[i][1]));
    let inertia = by_angle[0] * by_angle[0] + by_angle[1] * by_angle[1] + gyration * gyration;
    let work = by_angle[1] * gravity - by_angle[0] * drift[0] - by_angle[1] * drift[1];
    Pose {
        acceleration: work / inertia,
        contacts: [0, 1].map(|i| dot(centre, along[i]) + support[i][1] * SIDES[i]),
        centre,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palmistry_bodies::mechanics::moving::Shape;

    /// Against the simulation by Newton's laws, which has forces and knows no reduction to one angle: the acceleration of the body, its place and the
    /// contacts, in all regimes.
    #[test]
    fn the_law_is_newtons() {
        let text = include_str!("../../../../proofs/moll2002/scenes/general.toml");
        for drive in [
            "",
            "prescribed = [{ start = 0.7 }, { start = 1.7 }]",
            "prescribed = [{ start = 0.8 }, { start = 1.8, rate = -0.3 }]",
        ] {
            let text = match drive {
                "" => text.to_owned(),
                drive => {
                    let (head, tail) = text.split_once("prescribed = [").unwrap();
                    let (_, tail) = tail.split_once("\n]").unwrap();
                    format!("{head}{drive}{tail}")
                }
            };
            let scene = crate::Scene::parse("../../proofs/moll2002/scenes/general.toml", &text).unwrap();
            let simulation = crate::Simulation::of(&scene, scene.simulated.as_ref().unwrap()).unwrap();
            let (shape, constants): (&Shape, _) = (&simulation.shape, &simulation.constants);
            for moment in simulation.trajectory.moments.iter().step_by(40) {
                let palms = PalmsAt {
                    angles: [moment.palms[0].angle, moment.palms[0].angle + moment.palms[1].angle],
                    rates: [moment.palms[0].rate, moment.palms[0].rate + moment.palms[1].rate],
                    accelerations: [
                        moment.palms[0].acceleration,
                        moment.palms[0].acceleration + moment.palms[1].acceleration,
                    ],
                };
                let support = palms.normals(moment.phi0).map(|angle| shape.support(angle));
                let pose = pose(&palms, &support, moment.omega0, constants["rho"], constants["g"]);
                assert!((pose.acceleration - moment.alpha0).abs() < 1e-9, "{} s: {pose:?}", moment.time);
                for i in 0..2 {
                    assert!((pose.contacts[i] - moment.palms[i].s).abs() < 1e-11);
                    assert!((pose.centre[i] - moment.centre[i]).abs() < 1e-11);
                }
            }
        }
    }
}
