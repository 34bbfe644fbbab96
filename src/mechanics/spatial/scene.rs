//! Everything that a motion in space follows from.

use super::laws::Situation;
use super::orientation::Orientation;
use super::solid::ConvexSolid;
use crate::mechanics::moving::{Course, Oscillation, PushedPalm};
use nalgebra::{Matrix3, Vector3};

/// A plane palm that turns about a horizontal hinge, and rises from there in a direction that stays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpatialPalm {
    /// The direction in which it rises, an angle from the X axis in radians.
    pub azimuth: f64,
    /// A point of the hinge, in metres.
    pub hinge: [f64; 3],
    /// The moment of inertia about the hinge.
    pub inertia: f64,
}

/// What moves the palms. Angles are those from the horizontal to the palm, positive where it rises.
#[derive(Clone, Debug, PartialEq)]
pub enum SpatialDrive {
    /// The angles are told; contact forces and motor torques are results.
    Prescribed([Course; 3]),
    /// The torques about the hinges are told; the palms' angles are results as well.
    Torques([PushedPalm; 3]),
}

/// A body on three palms at time zero, and what acts on it. SI units, angles in radians.
#[derive(Clone, Debug)]
pub struct SpatialScene {
    pub solid: ConvexSolid,
    pub mass: f64,
    /// The inertia matrix about the centre of mass in the body's frame, for each kilogram: that of a uniform body is
    /// [`ConvexSolid::uniform_inertia`].
    pub inertia_over_mass: Matrix3<f64>,
    pub orientation: Orientation,
    /// The body's angular velocity in the world.
    pub rate: [f64; 3],
    /// The acceleration of gravity, any vector. It acts on the body alone.
    pub gravity: [f64; 3],
    pub palms: [SpatialPalm; 3],
    pub drive: SpatialDrive,
    /// The error that a step of the integrator may make, relative to what is integrated or, where that is below 1 in its SI unit,
    /// absolute.
    pub tolerance: f64,
}

/// Why a motion cannot be followed from its start.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpatialSceneError {
    /// A number that cannot be used.
    #[error("{what} is {value}; it has to be {wanted}")]
    Value { what: String, value: f64, wanted: &'static str },
    /// Not that of a body.
    #[error(
        "the inertia matrix is that of no body: it has to be symmetric and positive, and no principal moment greater than the \
         other two together"
    )]
    Inertia,
    /// No times were asked for.
    #[error("there are no sample times; give at least one")]
    NoTimes,
    /// Times have to increase.
    #[error("sample time {index} (counted from 1) is {time} s; times are finite, not negative and increase")]
    Time { index: usize, time: f64 },
    /// Contact is lost at once.
    #[error(
        "palm {palm} would have to pull: its contact force is {force:.4} N at the start; start in balance, turn the palm, slow it, \
         or give the body another orientation or rate"
    )]
    NotHeld { palm: usize, force: f64 },
    /// Three contacts do not hold the body.
    #[error("the palms' normals lie in one plane at the start; give other azimuths or angles")]
    Flat,
}

/// The tolerances that double precision and the method can serve.
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-14..=1e-3;

impl SpatialScene {
    /// Each palm's angle, rate and acceleration at a time; those of palms that are pushed as they are integrated, without the
    /// acceleration.
    pub(super) fn palms_at(&self, time: f64, pushed: &[[f64; 2]; 3]) -> [[f64; 3]; 3] {
        match &self.drive {
            SpatialDrive::Prescribed(courses) => std::array::from_fn(|i| courses[i].at(time)),
            SpatialDrive::Torques(_) => pushed.map(|[angle, rate]| [angle, rate, 0.0]),
        }
    }

    /// Angle and rate of each palm at the start.
    pub(super) fn start_of_palms(&self) -> [[f64; 2]; 3] {
        match &self.drive {
            SpatialDrive::Prescribed(courses) => {
                std::array::from_fn(|i| [courses[i].at(0.0)[0], courses[i].at(0.0)[1]])
            }
            SpatialDrive::Torques(palms) => std::array::from_fn(|i| [palms[i].angle, palms[i].rate]),
        }
    }

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
            let SpatialPalm { azimuth, hinge, inertia } = self.palms[i];
            finite(&of("azimuth"), azimuth)?;
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

    fn check_inertia(&self) -> Result<(), SpatialSceneError> {
        let inertia = &self.inertia_over_mass;
        let size = inertia.amax();
        let symmetric = (inertia - inertia.transpose()).amax() <= 1e-12 * size;
        if !(size.is_finite() && symmetric) {
            return Err(SpatialSceneError::Inertia);
        }
        let mut moments = inertia.symmetric_eigenvalues();
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
        );
        if start.is_flat() {
            return Err(SpatialSceneError::Flat);
        }
        match start.pulling() {
            None => Ok(()),
            Some(palm) => Err(SpatialSceneError::NotHeld { palm, force: start.forces[palm - 1] }),
        }
    }
}
