//! Random bodies of a study.

use palmistry_bodies::mechanics::moving::{BodyForm, CentreOfMass, FormError, Knots, Shape, SplineDraws};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::Deserialize;
use std::f64::consts::TAU;

/// Random bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// Harmonics `k` from 2 to 6, each coefficient drawn evenly up to `1/k` of the largest that is convex alone.
    Harmonics,
    /// The same, with the centre of mass off the centroid by up to 0.3 of the mean radius.
    OffCentre,
    /// Section 3.4: closed splines through three points, the parameter even.
    Uniform,
    /// The same, the parameter by the root of the points' distances.
    Centripetal,
}

impl Family {
    /// Its name in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Family::Harmonics => "harmonics",
            Family::OffCentre => "off-centre",
            Family::Uniform => "uniform",
            Family::Centripetal => "centripetal",
        }
    }

    /// The knots of a spline.
    fn knots(self) -> Option<Knots> {
        match self {
            Family::Harmonics | Family::OffCentre => None,
            Family::Uniform => Some(Knots::Uniform),
            Family::Centripetal => Some(Knots::Centripetal),
        }
    }

    /// A body of the family, of this mean radius in m.
    pub(super) fn draw(self, size: f64, random: &mut ChaCha8Rng) -> Result<Shape, FormError> {
        if let Some(knots) = self.knots() {
            let drawn = SplineDraws::new(random.random(), knots).until_convex()?;
            // of this mean radius: splines scale with their points
            let BodyForm::Spline { radii, knots } = drawn.form else { return Ok(drawn.shape) };
            let scale = size * TAU / drawn.shape.perimeter();
            return Shape::new(
                &BodyForm::Spline { radii: radii.map(|r| r * scale), knots },
                CentreOfMass::Uniform,
            );
        }
        loop {
            let harmonic = |k: u32, random: &mut ChaCha8Rng| {
                let k = f64::from(k);
                let most = if k < 2.0 { 0.0 } else { size / (k * k - 1.0) / k };
                [(); 2].map(|()| random.random_range(-1.0..=1.0) * most)
            };
            let harmonics: Vec<[f64; 2]> = (1..=6).map(|k| harmonic(k, random)).collect();
            let form = BodyForm::Harmonics { mean: size, harmonics };
            let (angle, part): (f64, f64) = (random.random_range(0.0..TAU), random.random_range(0.05..=0.3));
            let found = match self {
                Family::OffCentre => Shape::new(
                    &form,
                    CentreOfMass::At([part * size * angle.cos(), part * size * angle.sin()]),
                ),
                _ => Shape::new(&form, CentreOfMass::Uniform),
            };
            match found {
                Err(FormError::NotConvex { .. } | FormError::TooClose { .. }) => (),
                found => return found,
            }
        }
    }
}
