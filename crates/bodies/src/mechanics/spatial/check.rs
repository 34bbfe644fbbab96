//! Whether a motion in space can be followed from its start.

use super::laws::Situation;
use super::scene::{SpatialDrive, SpatialPalm, SpatialScene, SpatialSceneError};
use crate::mechanics::moving::Oscillation;
use nalgebra::Vector3;
use palmistry_math::number::MOST_ITERATIONS;

/// The tolerances that double precision and the method can serve.
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-14..=1e-3;

impl SpatialScene {
    /// Whether all values can be used.
    pub(super) fn check_values(&self) -> Result<(), SpatialSceneError> {
        let is = |holds: bool, what: &str, value: f64, wanted| match holds {
            true => Ok(()),
            false => Err(SpatialSceneError::Value { what: what.to_owned(), value, wanted }),
        };
        let finite = |what: &str, x: f64| is(x.is_finite(), what, x, "finite");
        is(self.mass > 0.0 && self.mass.is_finite(), "the body's mass", self.mass, "positive and finite")?;
        for (what, vector) in [("the body's rate", self.rate), ("the acceleration of gravity", self.gravity)]
        {
            vector.iter().try_for_each(|x| finite(what, *x))?;
        }
        self.orientation.quaternion().iter().try_for_each(|x| finite("the body's orientation", *x))?;
        let usable = TOLERANCES.contains(&self.tolerance);
        is(usable, "the tolerance", self.tolerance, "between 1e-14 and 1e-3")?;
        self.check_inertia()?;
        for i in 0..3 {
            let of = |what: &str| format!("palm {}'s {what}", i + 1);
            let SpatialPalm { azimuth, hinge, inertia, curvature, touch } = self.palms[i];
            finite(&of("azimuth"), azimuth)?;
            finite(&of("curvature"), curvature)?;
            touch.iter().try_for_each(|x| finite(&of("point of contact with its plane"), *x))?;
            self.check_hollow(i)?;
            hinge.iter().try_for_each(|x| finite(&of("hinge"), *x))?;
            let swings: &[Oscillation] = match &self.drive {
                SpatialDrive::Prescribed(courses) => {
                    let usable = inertia >= 0.0 && inertia.is_finite();
                    is(usable, &of("moment of inertia"), inertia, "finite and not negative")?;
                    finite(&of("start angle"), courses[i].start)?;
                    finite(&of("rate"), courses[i].rate)?;
                    &courses[i].swings
                }
                SpatialDrive::Torques(palms) => {
                    let usable = inertia > 0.0 && inertia.is_finite();
                    is(usable, &of("moment of inertia"), inertia, "positive and finite")?;
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

    /// A body that is everywhere more curved than a hollow palm rolls in it and touches it at one point (W. Blaschke, Kreis und Kugel, 1916, section 24).
    fn check_hollow(&self, i: usize) -> Result<(), SpatialSceneError> {
        let curvature = self.palms[i].curvature;
        if curvature >= 0.0 {
            return Ok(());
        }
        let radius = -1.0 / curvature;
        self.solid.rolls_in(radius).map_err(|(normal, own)| SpatialSceneError::Hollow {
            palm: i + 1,
            radius,
            x: normal.x,
            y: normal.y,
            z: normal.z,
            own,
            least: -1.0 / own,
        })
    }

    fn check_inertia(&self) -> Result<(), SpatialSceneError> {
        let inertia = &self.inertia_over_mass;
        let size = inertia.amax();
        let symmetric = (inertia - inertia.transpose()).amax() <= 1e-12 * size;
        if !(size.is_finite() && symmetric) {
            return Err(SpatialSceneError::Inertia);
        }
        let Some(eigen) = inertia.try_symmetric_eigen(f64::EPSILON, MOST_ITERATIONS) else {
            return Err(SpatialSceneError::Inertia);
        };
        let mut moments = eigen.eigenvalues;
        moments.as_mut_slice().sort_by(f64::total_cmp);
        let [a, b, c] = moments.into();
        // a flat body has c = a + b, but for rounding
        if a > 0.0 && c <= (a + b) * (1.0 + 1e-12) { Ok(()) } else { Err(SpatialSceneError::Inertia) }
    }

    /// Whether all values can be used and all three palms hold the body at the start.
    pub(super) fn check(&self) -> Result<(), SpatialSceneError> {
        self.check_values()?;
        let start = Situation::at(
            self,
            0.0,
            &self.orientation.matrix(),
            &Vector3::from(self.rate),
            &self.start_of_palms(),
            None,
        );
        if start.touched.is_none() {
            return Err(SpatialSceneError::NoContact);
        }
        if start.is_flat() {
            return Err(SpatialSceneError::Flat);
        }
        match start.pulling() {
            None => Ok(()),
            Some(palm) => Err(SpatialSceneError::NotHeld { palm, force: start.forces[palm - 1] }),
        }
    }
}
