//! Random bodies of four kinds, each drawn from a seed and a number of its own, so that they do not depend on who draws first.

use super::body::PoseBody;
use crate::mechanics::moving::{BodyForm, CentreOfMass, Knots, Shape};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// A kind of bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum BodyFamily {
    /// Closed splines of section 3.4 with uniform knots, of one material.
    Splines,
    /// Splines through the same points with centripetal knots.
    Centripetal,
    /// Support functions of the harmonics 2 to 6, of one material: amplitudes `1/k^2` times a normal number, scaled so that the least radius of
    /// curvature is a part of the mean radius that is drawn between 0.05 and 0.9.
    Harmonics,
    /// A body of one of these three with its mass moved from the centroid by a part, drawn up to 0.7, of the way to the outline.
    OffCentre,
}

impl BodyFamily {
    /// All of them.
    pub const ALL: [BodyFamily; 4] =
        [BodyFamily::Splines, BodyFamily::Centripetal, BodyFamily::Harmonics, BodyFamily::OffCentre];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            BodyFamily::Splines => "splines",
            BodyFamily::Centripetal => "centripetal",
            BodyFamily::Harmonics => "harmonics",
            BodyFamily::OffCentre => "off-centre",
        }
    }

    /// The body of a number under a seed.
    pub fn draw(self, seed: u64, number: u64) -> PoseBody {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(number * BodyFamily::ALL.len() as u64 + self as u64);
        loop {
            // what is not convex is drawn again
            let kind = match self {
                BodyFamily::OffCentre => BodyFamily::ALL[random.random_range(0..3_usize)],
                kind => kind,
            };
            let form = kind.form(&mut random);
            let Ok(even) = Shape::new(&form, CentreOfMass::Uniform) else { continue };
            let centre = if self == BodyFamily::OffCentre {
                let (angle, part) = (random.random_range(0.0..TAU), random.random_range(0.0..0.7));
                let ([x, y], [a, b]) = (even.centre_of_mass(), even.point(angle));
                CentreOfMass::At([x + part * a, y + part * b])
            } else {
                CentreOfMass::Uniform
            };
            if let Ok(body) = PoseBody::new(form, centre) {
                return body;
            }
        }
    }

    fn form(self, random: &mut ChaCha8Rng) -> BodyForm {
        if self != BodyFamily::Harmonics {
            let knots = if self == BodyFamily::Centripetal { Knots::Centripetal } else { Knots::Uniform };
            // the radii of section 3.4
            return BodyForm::Spline { radii: [(); 3].map(|()| random.random_range(0.1..=2.5)), knots };
        }
        let mut normal = || {
            let (u, v): (f64, f64) =
                (random.random_range(f64::MIN_POSITIVE..1.0), random.random_range(0.0..1.0));
            (-2.0 * u.ln()).sqrt() * (TAU * v).cos()
        };
        let pairs: Vec<[f64; 2]> = (2..=6).map(|k| [(); 2].map(|()| normal() / f64::from(k * k))).collect();
        let bend = |angle: f64| -> f64 {
            let term = |(k, [p, q]): (i32, &[f64; 2])| {
                let (s, c) = (f64::from(k) * angle).sin_cos();
                f64::from(k * k - 1) * (p * c + q * s)
            };
            (2..).zip(&pairs).map(term).sum()
        };
        let most = (0..720).map(|i| bend(TAU * f64::from(i) / 720.0)).fold(f64::MIN_POSITIVE, f64::max);
        let least = random.random_range(0.05..0.9);
        let scale = (1.0 - least) / most;
        let pairs = pairs.into_iter().map(|[p, q]| [scale * p, scale * q]);
        BodyForm::Harmonics { mean: 1.0, harmonics: std::iter::once([0.0; 2]).chain(pairs).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same number gives the same body; the scaled harmonics have the least radius of curvature that was drawn.
    #[test]
    fn bodies_are_their_numbers() {
        for family in BodyFamily::ALL {
            let (first, again, other) = (family.draw(7, 3), family.draw(7, 3), family.draw(7, 4));
            assert_eq!(first.text(), again.text());
            assert_ne!(first.text(), other.text());
        }
        for number in 0..20 {
            let body = BodyFamily::Harmonics.draw(1, number);
            let radius = |i: i32| {
                let [r, _, second] = body.support(TAU * f64::from(i) / 2880.0);
                r + second
            };
            let least = (0..2880).map(radius).fold(f64::INFINITY, f64::min);
            assert!((0.045..0.91).contains(&least), "{least}");
        }
    }
}
