//! The estimate from the samples of a window, and its error.

use crate::solid::{SolidPose, SolidState};
use std::ops::Range;

/// The verdict on an estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpaceVerdict {
    /// It explains the measurements.
    Fits,
    /// The best fit does not explain them.
    DoesNotFit,
    /// The state is not observable from them: a bound is as large as its estimate, the information is mostly noise, or nothing moves.
    Unobservable,
    /// Another state, outside of the bound, explains them as well.
    Ambiguous,
    /// No start led to a body.
    Lost,
}

impl SpaceVerdict {
    /// As text.
    pub fn name(self) -> &'static str {
        match self {
            SpaceVerdict::Fits => "converged, fits",
            SpaceVerdict::DoesNotFit => "converged, does not fit",
            SpaceVerdict::Unobservable => "not observable",
            SpaceVerdict::Ambiguous => "ambiguous",
            SpaceVerdict::Lost => "lost",
        }
    }
}

/// The estimate from the samples of a window.
#[derive(Clone, Debug)]
pub struct SpaceUpdate {
    /// The samples.
    pub rows: Range<usize>,
    /// The verdict.
    pub verdict: SpaceVerdict,
    /// The state at the first of them.
    pub state: Option<SolidState>,
    /// The body at each of them; its frame is the world's at the first.
    pub poses: Vec<SolidPose>,
    /// The computing time in s.
    pub seconds: f64,
}

/// The error of a pose: of the centre of mass in m, of the turn since the first sample of its window in rad, and the largest error of a support radius at a contact in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseError {
    /// In s.
    pub time: f64,
    /// In m.
    pub centre: f64,
    /// In rad.
    pub turn: f64,
    /// In m.
    pub radius: f64,
}
