//! The estimated shape and motion of a body, as structures.

use super::scene::Method;
use palmistry_bodies::mechanics::Palm;
use palmistry_bodies::shape::{Coverage, Measured, ShapeEstimate, SupportSample};

/// The estimated shape of a body.
#[derive(Clone, Debug)]
pub struct Reconstruction {
    /// The outline by the shown observer.
    pub track: TouchTrack,
    /// The shape; none where the body was not observed.
    pub shape: Option<ShapeEstimate>,
    /// The normals that were touched while the body was observed.
    pub coverage: Coverage,
    /// The motion of the batch estimate of all measurements, where the shape comes from it.
    pub whole: Option<WholeMotion>,
    /// The contradiction between the batch estimate and windows that fit, where neither is accepted because of it: then there is no shape.
    pub contradiction: Option<Contradiction>,
    /// Why the estimated shape is rejected: its band is wider than the body, its errors are not linear, its search has not converged, or its residual exceeds the stated noise.
    pub too_wide: Option<TooWide>,
    /// Why no batch estimate of all measurements was made: its samples are too far apart in time.
    pub apart: Option<Apart>,
}

/// A band that is too wide: the deviations are those of a linear model, which holds for small ones only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TooWide {
    /// Half the width of the band where it is widest and was touched, two standard deviations, in m.
    pub band: f64,
    /// The mean radius that was found, in m.
    pub mean: f64,
}

/// Samples that are too far apart in time to follow the motion between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// The mean time between two, in s.
    pub between: f64,
    /// The time scale of a body of this size under gravity: the root of its mean radius over gravity's acceleration, in s.
    pub scale: f64,
}

/// A state by a window and by the batch estimate of all measurements, where they differ.
#[derive(Clone, Debug)]
pub struct Contradiction {
    /// The window's first sample, in s.
    pub time: f64,
    /// The state.
    pub name: String,
    /// Its value by the window.
    pub by_window: Measured,
    /// Its value by the batch estimate.
    pub of_all: Measured,
}

/// A motion estimated from all measurements at once.
#[derive(Clone, Debug)]
pub struct WholeMotion {
    /// Sample by sample.
    pub samples: Vec<WholeSample>,
    /// The radius of gyration, where it was estimated.
    pub gyration: Option<Measured>,
    /// The root mean square residual of a contact, in m.
    pub rms_residual: f64,
    /// The standard deviation of a contact, in m: the stated one, or that of the residuals where none is stated.
    pub sigma: f64,
    /// Whether it is the stated one.
    pub stated: bool,
}

/// One sample of it.
#[derive(Clone, Copy, Debug)]
pub struct WholeSample {
    /// In s.
    pub time: f64,
    /// The orientation, in rad; without error at the first sample, where it defines the frame of the body.
    pub phi0: Measured,
    /// The body's rate, in rad/s.
    pub omega0: Measured,
    /// The support radii at both contacts, in m.
    pub radii: [Measured; 2],
    /// The centre of mass, in m.
    pub centre: [f64; 2],
}

/// The palms and the estimates at one sample.
#[derive(Clone, Copy, Debug)]
pub struct TouchInstant {
    /// In s.
    pub time: f64,
    /// Directions of the palms in the world, in rad; at the joint.
    pub palms: [f64; 2],
    /// The measured contacts: along the palms from the joint, in m.
    pub sensed: [f64; 2],
    /// The measured contacts in the world, in m.
    pub contacts: [[f64; 2]; 2],
    /// The estimated centre of mass in the world, in m.
    pub centre: [f64; 2],
    /// The estimated orientation, in rad.
    pub orientation: f64,
    /// The estimated points of the outline in the frame of the body, in m.
    pub points: [[f64; 2]; 2],
    /// The estimated support radii and the angles of their outward normals in the frame of the body; weights are zero where the body was not observable.
    pub samples: [SupportSample; 2],
    /// Whether the observer used measurements here, and did not hold its state or integrate without them.
    pub is_observed: bool,
}

/// The outline by one observer.
#[derive(Clone, Debug)]
pub struct TouchTrack {
    /// The observer.
    pub method: Method,
    /// The palms' forms.
    pub forms: [Palm<f64>; 2],
    /// Sample by sample; at least one.
    pub instants: Vec<TouchInstant>,
}
