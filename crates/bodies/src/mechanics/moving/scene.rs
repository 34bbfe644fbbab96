//! Everything that a motion follows from.

use super::breach::Breach;
use super::drive::Drive;
use super::shape::Shape;
use crate::mechanics::palm::Palm;

/// The relative error that a step of the integrator may make, unless the scene says otherwise.
pub const DEFAULT_TOLERANCE: f64 = 1e-12;

/// A body between two palms at time zero, and what acts on it. SI units, angles in radians.
///
/// The palms are lines, or arcs of circles, from the world's origin. Palm 1 makes the angle `phi1` with the X axis, palm 2 the angle
/// `phi2` with palm 1, arcs by their tangents at the origin; the body lies between them, above both (`0 < phi2 < pi`), and is turned by `phi0`.
#[derive(Clone, Debug)]
pub struct MovingScene {
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
    /// Their forms.
    pub palms: [Palm<f64>; 2],
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
    #[error(
        "palm {palm} is hollow with a radius of {radius} m, and the body has a radius of curvature of {curvature:.4} m: it \
         would touch the palm twice; give a greater radius"
    )]
    TooHollow { palm: usize, radius: f64, curvature: f64 },
    #[error("there are no sample times; give at least one")]
    NoTimes,
    #[error("sample time {index} (counted from 1) is {time} s; times are finite, not negative and increase")]
    Time { index: usize, time: f64 },
    #[error(
        "palm {palm} would have to pull: its contact force is {force:.4} N at the start; turn the palm, slow it, \
         or give the body another orientation or rate"
    )]
    NotHeld { palm: usize, force: f64 },
    #[error(
        "at the start no way to slide, roll or stick is consistent with friction and contact: a palm would have to pull, or \
         it is Painleve's paradox; turn the palm, or give the body another orientation or rate, or less friction"
    )]
    NoModes,
    #[error("slow motion: {0}")]
    NotSlow(&'static str),
    #[error("{0} at the start; give other palm angles or another orientation")]
    Start(Breach),
}
