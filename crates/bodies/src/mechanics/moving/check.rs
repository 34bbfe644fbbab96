//! Whether a motion can be followed from its start.

use super::breach::Breach;
use super::drive::{Drive, Oscillation};
use super::laws::Situation;
use super::scene::{MovingScene, SceneError};
use crate::mechanics::palm::Palm;

/// The tolerances that double precision and the method can serve.
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-14..=1e-3;

/// Radii of palms in m. Beyond, an arc is flat to more digits than a motion has.
const RADII: std::ops::RangeInclusive<f64> = 1e-6..=1e6;

impl MovingScene {
    /// Whether all values can be used and both palms hold the body at the start.
    pub(super) fn check(&self) -> Result<(), SceneError> {
        self.check_values()?;
        let start = Situation::at(self, 0.0, &self.start());
        match start.breach(self) {
            None => Ok(()),
            Some(Breach::Contact { palm }) => {
                Err(SceneError::NotHeld { palm, force: start.forces[palm - 1] })
            }
            Some(breach) => Err(SceneError::Start(breach)),
        }
    }

    /// Whether all values can be used.
    pub(super) fn check_values(&self) -> Result<(), SceneError> {
        let is = |holds: bool, what: &str, value: f64, wanted| match holds {
            true => Ok(()),
            false => Err(SceneError::Value { what: what.to_owned(), value, wanted }),
        };
        let positive = |what: &str, x: f64| is(x > 0.0 && x.is_finite(), what, x, "positive and finite");
        let finite = |what: &str, x: f64| is(x.is_finite(), what, x, "finite");
        positive("the body's mass", self.mass)?;
        positive("the body's radius of gyration", self.gyration)?;
        finite("the body's orientation", self.orientation)?;
        finite("the body's rate", self.rate)?;
        finite("the acceleration of gravity", self.gravity)?;
        let tolerable = TOLERANCES.contains(&self.tolerance);
        is(tolerable, "the tolerance", self.tolerance, "between 1e-14 and 1e-3")?;
        for i in 0..2 {
            let of = |what: &str| format!("palm {}'s {what}", i + 1);
            let (inertia, length) = (self.palm_inertia[i], self.palm_lengths[i]);
            is(length > 0.0, &of("length"), length, "positive, or infinite")?;
            if let Palm::Circular { radius } = self.palms[i] {
                let usable = RADII.contains(&radius.abs());
                is(
                    usable,
                    &of("radius"),
                    radius,
                    "between 1e-6 m and 1e6 m, or minus that; flatter ones are flat",
                )?;
                // a body rolls freely in a circle that is nowhere more curved than itself (Blaschke)
                let curvature = self.shape.greatest_radius_of_curvature();
                if radius > 0.0 && curvature >= radius {
                    return Err(SceneError::TooHollow { palm: i + 1, radius, curvature });
                }
            }
            let swings: &[Oscillation] = match &self.drive {
                Drive::Prescribed(courses) => {
                    // a palm whose motion is prescribed may weigh nothing
                    let usable = inertia >= 0.0 && inertia.is_finite();
                    is(usable, &of("moment of inertia"), inertia, "finite and not negative")?;
                    finite(&of("start angle"), courses[i].start)?;
                    finite(&of("rate"), courses[i].rate)?;
                    &courses[i].swings
                }
                Drive::Torques(palms) => {
                    positive(&of("moment of inertia"), inertia)?;
                    finite(&of("start angle"), palms[i].angle)?;
                    finite(&of("rate"), palms[i].rate)?;
                    finite(&of("torque"), palms[i].torque)?;
                    &palms[i].swings
                }
            };
            for swing in swings {
                finite(&of("swing's amplitude"), swing.amplitude)?;
                finite(&of("swing's frequency"), swing.frequency)?;
                finite(&of("swing's phase"), swing.phase)?;
            }
        }
        Ok(())
    }
}
