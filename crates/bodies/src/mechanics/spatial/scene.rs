//! Everything that a motion in space follows from.

use super::orientation::Orientation;
use super::solid::ConvexSolid;
use crate::mechanics::moving::{Course, PushedPalm};
use crate::mechanics::pace::longest_step;
use nalgebra::{Matrix3, Vector3};

/// A palm that turns about a horizontal hinge, and rises from there in a direction that stays: a plane, or a sphere that is fixed to
/// it and touches that plane at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpatialPalm {
    /// The direction in which it rises, an angle from the X axis in radians.
    pub azimuth: f64,
    /// A point of the hinge, in metres.
    pub hinge: [f64; 3],
    /// The moment of inertia about the hinge.
    pub inertia: f64,
    /// In 1/m: 0 for a plane, above it for a sphere that bulges towards the body, below it for a hollow one.
    pub curvature: f64,
    /// Where a sphere touches the plane: along the hinge and up the palm, from the point of the hinge, in metres. Its centre is on the plane's normal there.
    pub touch: [f64; 2],
}

impl SpatialPalm {
    /// Whether it is a plane.
    pub fn is_flat(&self) -> bool {
        self.curvature == 0.0
    }
}

/// What moves the palms. Angles are those from the horizontal to the palm, positive where it rises.
#[derive(Clone, Debug, PartialEq)]
pub enum SpatialDrive {
    /// The angles are prescribed; contact forces and motor torques are results.
    Prescribed([Course; 3]),
    /// The torques about the hinges are prescribed; the palms' angles are results as well.
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
    /// A sphere in which the body cannot be shown to roll.
    #[error(
        "palm {palm} is hollow with a radius of {radius} m, in which the body cannot be shown to roll: where its outward normal is \
         ({x:.4}, {y:.4}, {z:.4}) it may have a radius of curvature of {own:.4} m; a hollow palm has to be flatter than all of the \
         body, its curvature be above {least:.4} 1/m"
    )]
    Hollow { palm: usize, radius: f64, x: f64, y: f64, z: f64, own: f64, least: f64 },
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
    /// There is no pose.
    #[error(
        "at the start there is no place where the body touches all three palms, each on the half of its sphere that faces the plane's \
         normal; make curvatures smaller, or move the points where spheres touch their planes"
    )]
    NoContact,
}

impl SpatialScene {
    /// The longest step of the integrator, in s, in a motion that goes on until `last`.
    pub(super) fn longest_step(&self, last: f64) -> f64 {
        let length = |all: [f64; 3]| Vector3::from(all).norm();
        // the trace is twice the mean square of the distance from the centre
        let size = (self.inertia_over_mass.trace() / 2.0).sqrt();
        longest_step(last, size, length(self.rate), length(self.gravity))
    }

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
}
