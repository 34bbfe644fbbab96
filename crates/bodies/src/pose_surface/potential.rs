//! The height of the centre of mass of a body that touches both palms, as a function of its orientation.
//!
//! With `A = sin(phi1 + phi2)`, `B = sin phi1`, and `r1`, `r2` the support function at the normals that face the palms,
//! `U = (A r1 + B r2)/sin phi2`: the two tangents that are the palms, solved for the height over their meeting point. Nothing of
//! the thesis is used but what its angles mean.

use super::body::PoseBody;
use std::f64::consts::{FRAC_PI_2, PI};

/// How two palms stand: palm 1 by `phi1` over the horizontal, palm 2 by `phi2` from palm 1, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PalmPair {
    /// `phi1`.
    pub phi1: f64,
    /// `phi2`.
    pub phi2: f64,
}

impl PalmPair {
    /// Both angles.
    pub const fn new(phi1: f64, phi2: f64) -> PalmPair {
        PalmPair { phi1, phi2 }
    }

    /// How far the palms are from being parallel to each other or to the ground, rad: the least of `phi1`, `phi2` and
    /// `pi - phi1 - phi2`. Both palms push only where it is positive.
    pub fn margin(self) -> f64 {
        self.phi1.min(self.phi2).min(PI - self.phi1 - self.phi2)
    }

    /// The point at a part of the straight way to another pair.
    pub fn toward(self, other: PalmPair, part: f64) -> PalmPair {
        if part == 1.0 {
            return other; // and not what rounding makes of it
        }
        PalmPair {
            phi1: self.phi1 + part * (other.phi1 - self.phi1),
            phi2: self.phi2 + part * (other.phi2 - self.phi2),
        }
    }

    /// The length of that way, `hypot` of both differences, rad.
    pub fn distance(self, other: PalmPair) -> f64 {
        (self.phi1 - other.phi1).hypot(self.phi2 - other.phi2)
    }

    /// The normals' angles in the body's frame at both contacts where the body is turned by `phi0`, rad; not reduced.
    pub fn normals(self, phi0: f64) -> [f64; 2] {
        [self.phi1 - FRAC_PI_2 - phi0, self.phi1 + self.phi2 + FRAC_PI_2 - phi0]
    }
}

/// `[U, U', U'']` by `phi0`, in m, at resting palms.
pub fn potential(body: &PoseBody, palms: PalmPair, phi0: f64) -> [f64; 3] {
    let weights = [(palms.phi1 + palms.phi2).sin(), palms.phi1.sin()];
    let [first, second] = palms.normals(phi0).map(|angle| body.support(angle));
    let sum = |i: usize| (weights[0] * first[i] + weights[1] * second[i]) / palms.phi2.sin();
    // the normals turn against the body
    [sum(0), -sum(1), sum(2)]
}

/// Where the contacts lie along the palms, `[s1, s2]` from the line in which the palms meet, in m.
pub fn measurements(body: &PoseBody, palms: PalmPair, phi0: f64) -> [f64; 2] {
    let [[r1, slope1, _], [r2, slope2, _]] = palms.normals(phi0).map(|angle| body.support(angle));
    let (sine, cosine) = palms.phi2.sin_cos();
    // the centre of mass is r1 from palm 1, and as far along it as its distance from palm 2 says; the contact is r' from its foot
    [(r2 + r1 * cosine) / sine + slope1, (r1 + r2 * cosine) / sine - slope2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose_surface::body::tests::{egg, off_centre};

    /// The body itself laid down: both palms touch its outline and nothing of it is below either, the centre of mass is at the height
    /// that the potential says, and the touching points lie where the measurements say. The outline is all that is asked.
    #[test]
    fn heights_and_readings_are_those_of_the_outline() {
        for body in [egg(), off_centre()] {
            for (phi1, phi2, phi0) in [(0.4, 1.7, 0.3), (1.2, 0.6, 2.9), (0.1, 2.6, -1.4)] {
                let palms = PalmPair::new(phi1, phi2);
                let turned = |[x, y]: [f64; 2]| -> [f64; 2] {
                    let (s, c) = f64::sin_cos(phi0);
                    [c * x - s * y, s * x + c * y]
                };
                let outline: Vec<[f64; 2]> = body.outline(200_000).into_iter().map(turned).collect();
                let normals = [[-phi1.sin(), phi1.cos()], [(phi1 + phi2).sin(), -(phi1 + phi2).cos()]];
                let lowest = normals.map(|n| {
                    let depth = |p: &[f64; 2]| n[0] * p[0] + n[1] * p[1];
                    outline.iter().copied().min_by(|a, b| depth(a).total_cmp(&depth(b))).unwrap()
                });
                // centre c with n_i . (c + lowest_i) = 0
                let right =
                    [0, 1].map(|i: usize| -(normals[i][0] * lowest[i][0] + normals[i][1] * lowest[i][1]));
                let determinant = normals[0][0] * normals[1][1] - normals[0][1] * normals[1][0];
                let centre = [
                    (right[0] * normals[1][1] - right[1] * normals[0][1]) / determinant,
                    (normals[0][0] * right[1] - normals[1][0] * right[0]) / determinant,
                ];
                assert!((centre[1] - potential(&body, palms, phi0)[0]).abs() < 1e-8);
                let found = measurements(&body, palms, phi0);
                for i in 0..2 {
                    let contact = [centre[0] + lowest[i][0], centre[1] + lowest[i][1]];
                    let angle = if i == 0 { phi1 } else { phi1 + phi2 };
                    let along = contact[0] * angle.cos() + contact[1] * angle.sin();
                    assert!((along - found[i]).abs() < 1e-4, "{along} {}", found[i]);
                }
            }
        }
    }

    /// Differences of the height, whose errors are `1e-10` of its third and fourth derivative.
    #[test]
    fn slopes_are_those_of_the_height() {
        let (body, palms) = (off_centre(), PalmPair::new(0.7, 1.1));
        for i in 0..50 {
            let phi0 = 0.13 * f64::from(i);
            let [before, here, after] = [-1e-5, 0.0, 1e-5].map(|step| potential(&body, palms, phi0 + step));
            assert!(((after[0] - before[0]) / 2e-5 - here[1]).abs() < 1e-8);
            assert!(((after[1] - before[1]) / 2e-5 - here[2]).abs() < 1e-3);
        }
    }
}
