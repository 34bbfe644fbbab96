//! Shape from touch with slow palms: chapter 3 of the thesis.
//!
//! [`SlowMeasurements`] are those of two slow flat palms. [`by_thesis`] integrates the thesis's equations from radii that are known, [`by_quadrature`] needs one constant and no derivative of a measurement,
//! [`from_nothing`] needs neither: it fits one closed support function to all measurements at once. [`votes`] are the constants that the measurements determine by themselves.
//!
//! Nothing here knows the body: a simulation enters through measurements alone.

mod closure;
mod families;
mod found;
mod keys;
mod kinks;
mod local;
mod lost;
mod measurements;
mod orders;
mod outline;
mod patches;
mod quadrature;
mod run;
mod scene;
mod segments;
mod sequence;
mod start;
mod stopwatch;
mod study;
mod thesis;
mod together;

pub use families::Family;
pub use found::SlowShape;
pub(crate) use local::derivative;
pub use measurements::SlowMeasurements;
pub use outline::Kink;
pub use patches::Arrangement;
pub use quadrature::{SlowTrack, by_quadrature};
pub use run::{SlowAnswers, SlowExperiment, SlowTruth, TrackError};
pub use scene::{SlowPalms, SlowScene, SlowStudy};
pub use segments::{FoundJump, found_jumps, from_segments};
pub use start::{Vote, from_nothing, votes};
pub use study::{JumpTally, StudyRow, WayTally, median_and_worst, slow_study};
pub use thesis::{ThesisMethod, ThesisTrack, by_thesis};
