//! Everything that a motion follows from, checked.

use super::drive::{Drive, Oscillation};
use super::laws::{Breach, Situation};
use super::shape::Shape;

/// The relative error that a step of the integrator may make, unless the scene says otherwise.
pub const DEFAULT_TOLERANCE: f64 = 1e-12;

/// The tolerances that double precision and the method can serve.
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-14..=1e-3;

/// A body between two palms at time zero, and what acts on it. SI units, angles in radians.
///
/// The palms are lines through the world's origin. Palm 1 makes the angle `phi1` with the X axis, palm 2 the angle
/// `phi2` with palm 1; the body lies between them, above both (`0 < phi2 < pi`), and is turned by `phi0`.
#[derive(Clone, Debug)]
pub struct Scene {
    pub shape: Shape,
    pub mass: f64,
    /// The body's radius of gyration about its centre of mass; that of a uniform body is [`Shape::gyration`].
    pub gyration: f64,
    /// The body's orientation at the start, `phi0`.
    pub orientation: f64,
    /// Its rate at the start, `omega0`.
    pub rate: f64,
    /// The acceleration of gravity along the Y axis, negative where it points down. It acts on the body alone.
    pub gravity: f64,
    /// The palms' moments of inertia about the origin.
    pub palm_inertia: [f64; 2],
    /// How far the palms reach from the origin; infinite where it does not matter.
    pub palm_lengths: [f64; 2],
    pub drive: Drive,
    /// The relative error (and, for quantities below 1 in their SI unit, the absolute one) that a step of the
    /// integrator may make; see [`DEFAULT_TOLERANCE`].
    pub tolerance: f64,
}

/// Why a motion cannot be followed from its start.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    #[error("{what} is {value}; it has to be {wanted}")]
    Value { what: String, value: f64, wanted: &'static str },
    #[error("there are no sample times; give at least one")]
    NoTimes,
    #[error("sample time {index} (counted from 1) is {time} s; times are finite, not negative and increase")]
    Time { index: usize, time: f64 },
    #[error(
        "palm {palm} would have to pull: its contact force is {force:.4} N at the start; turn the palm, slow it, \
         or give the body another orientation or rate"
    )]
    NotHeld { palm: usize, force: f64 },
    #[error("{0} at the start; give other palm angles or another orientation")]
    Start(Breach),
}

impl Scene {
    /// Whether all values can be used and both palms hold the body at the start.
    pub(super) fn check(&self) -> Result<(), SceneError> {
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
            let swings: &[Oscillation] = match &self.drive {
                Drive::Prescribed(courses) => {
                    // a palm that is told how to move may weigh nothing
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
        let start = Situation::at(self, 0.0, &self.start());
        match start.breach(self) {
            None => Ok(()),
            Some(Breach::Contact { palm }) => {
                Err(SceneError::NotHeld { palm, force: start.forces[palm - 1] })
            }
            Some(breach) => Err(SceneError::Start(breach)),
        }
    }
}
