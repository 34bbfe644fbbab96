//! Shape from touch with slow palms: chapter 3 of the thesis.
//!
//! [`SlowMeasurements`] are what two slow flat palms read. [`by_thesis`] integrates the thesis's equations from radii that are known, [`by_quadrature`] needs one constant and no derivative of a reading,
//! [`from_nothing`] needs neither: it explains all readings at once by one closed support function. [`votes`] are the constants that the readings tell by themselves.
//!
//! Nothing here has seen the body: what a simulation knows comes in through readings alone.

mod closure;
mod families;
mod found;
mod keys;
mod kinks;
mod ladder;
mod local;
mod lost;
mod outline;
mod patches;
mod quadrature;
mod readings;
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
pub use outline::Kink;
pub use patches::Arrangement;
pub use quadrature::{SlowTrack, by_quadrature};
pub use readings::SlowMeasurements;
pub use run::{SlowAnswers, SlowExperiment, SlowTruth, TrackError};
pub use scene::{SlowPalms, SlowScene, SlowStudy};
pub use segments::{FoundJump, found_jumps, from_segments};
pub use start::{Vote, from_nothing, votes};
pub use study::{JumpTally, StudyRow, WayTally, median_and_worst, slow_study};
pub use thesis::{ThesisMethod, ThesisTrack, by_thesis};
