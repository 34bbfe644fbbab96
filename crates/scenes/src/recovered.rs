//! What was recovered of a body's shape and motion, as structures.

use super::scene::Method;
use palmistry_bodies::mechanics::Palm;
use palmistry_bodies::shape::{Coverage, Measured, ShapeEstimate, SupportSample};

/// What was made out of the shape of a body.
#[derive(Clone, Debug)]
pub struct Reconstruction {
    /// What the observer shown recovered of the outline.
    pub track: TouchTrack,
    /// The shape; none where nothing was seen.
    pub shape: Option<ShapeEstimate>,
    /// The normals that were touched while the body was seen.
    pub coverage: Coverage,
    /// Shape and motion batch estimate of all measurements, where that is where the shape comes from.
    pub whole: Option<WholeMotion>,
    /// Where neither a motion that explains all readings at once nor windows that fit are an answer, because they contradict each other: then there is no shape.
    pub contradiction: Option<Contradiction>,
    /// Where the shape that was found is none, because its band is wider than the body, its errors are not linear, its search has not ended, or its motion leaves more than the stated noise.
    pub too_wide: Option<TooWide>,
    /// Where no motion was sought that explains all readings at once, because its samples are too far apart.
    pub apart: Option<Apart>,
}

/// A band that is too wide for what it is about: the deviations are those of a linear model, which holds for small ones only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TooWide {
    /// Half the width of the band where it is widest and was touched, two standard deviations, in m.
    pub band: f64,
    /// The mean radius that was found, in m.
    pub mean: f64,
}

/// Samples between which more happens than is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// The mean time between two, in s.
    pub between: f64,
    /// In which gravity moves a body of this size: the root of its mean radius over gravity's acceleration, in s.
    pub scale: f64,
}

/// What a window says of a state, and all readings at once.
#[derive(Clone, Debug)]
pub struct Contradiction {
    /// The window's first sample, in s.
    pub time: f64,
    /// The state.
    pub name: String,
    /// What the window says.
    pub by_window: Measured,
    /// What all readings say.
    pub of_all: Measured,
}

/// A motion that explains all readings at once.
#[derive(Clone, Debug)]
pub struct WholeMotion {
    /// Sample by sample.
    pub samples: Vec<WholeSample>,
    /// The radius of gyration, where it was sought.
    pub gyration: Option<Measured>,
    /// The root of the mean square of what is left of a contact, in m.
    pub rms_residual: f64,
    /// The standard deviation of a contact by which it is measured, in m: the stated one, or what is left where none is stated.
    pub sigma: f64,
    /// Whether it is the stated one.
    pub stated: bool,
}

/// One sample of it.
#[derive(Clone, Copy, Debug)]
pub struct WholeSample {
    /// In s.
    pub time: f64,
    /// The orientation, in rad; without error at the first sample, where it says what the frame of the body is.
    pub phi0: Measured,
    /// The body's rate, in rad/s.
    pub omega0: Measured,
    /// The support radii at both contacts, in m.
    pub radii: [Measured; 2],
    /// The centre of mass, in m.
    pub centre: [f64; 2],
}

/// The palms, and what was recovered between them, at one sample.
#[derive(Clone, Copy, Debug)]
pub struct TouchInstant {
    /// In s.
    pub time: f64,
    /// Directions of the palms in the world, in rad; at the joint.
    pub palms: [f64; 2],
    /// The contacts by what is read: along the palms from the joint, in m.
    pub sensed: [f64; 2],
    /// The contacts in the world, as they are read, in m.
    pub contacts: [[f64; 2]; 2],
    /// The recovered centre of mass in the world, in m.
    pub centre: [f64; 2],
    /// The recovered orientation, in rad.
    pub orientation: f64,
    /// The recovered points of the outline in the frame of the body, in m.
    pub points: [[f64; 2]; 2],
    /// The recovered support radii and the angles of their outward normals in the frame of the body; weights are zero where the observer could not see.
    pub samples: [SupportSample; 2],
    /// Whether the observer compared its belief with readings here, and did not hold or integrate blindly.
    pub seen: bool,
}

/// What one observer recovered of the outline.
#[derive(Clone, Debug)]
pub struct TouchTrack {
    /// The observer.
    pub method: Method,
    /// The palms' forms.
    pub forms: [Palm<f64>; 2],
    /// Sample by sample; at least one.
    pub instants: Vec<TouchInstant>,
}
