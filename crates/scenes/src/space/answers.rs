//! What the samples of a window tell, and how far that is from the truth.

use crate::solid::{SolidPose, SolidState};
use std::ops::Range;

/// What is to be said of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpaceVerdict {
    /// It explains the readings.
    Fits,
    /// The best that was found does not explain them.
    DoesNotFit,
    /// The readings do not tell it: a bound is as large as what is estimated, what seems to be told is mostly noise, or nothing moves.
    Blind,
    /// Another state, far away by the bound, explains them as well.
    Ambiguous,
    /// No start led to a body.
    Lost,
}

impl SpaceVerdict {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            SpaceVerdict::Fits => "converged, fits",
            SpaceVerdict::DoesNotFit => "converged, does not fit",
            SpaceVerdict::Blind => "blind",
            SpaceVerdict::Ambiguous => "ambiguous",
            SpaceVerdict::Lost => "lost",
        }
    }
}

/// What the samples of a window tell.
#[derive(Clone, Debug)]
pub struct SpaceUpdate {
    /// Which samples.
    pub rows: Range<usize>,
    /// What is to be said of it.
    pub verdict: SpaceVerdict,
    /// The state at the first of them.
    pub state: Option<SolidState>,
    /// The body at each of them; its frame is the world's at the first.
    pub poses: Vec<SolidPose>,
    /// How long it took.
    pub seconds: f64,
}

/// How far a pose is from the truth: of the centre of mass in m, of the turn since the first sample of its window in rad, and the largest error of a support radius at a contact in m.
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
