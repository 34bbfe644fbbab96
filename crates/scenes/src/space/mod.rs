//! Bodies in space on three palms: scenes with `motion = "spatial"`, chapter 5 of the thesis.
//!
//! A [`SpaceScene`] says what is held and how it moves, or what was recorded; a [`SpaceExperiment`] is one with its [`SpaceMeasurements`], the palms' angles, the places of the contacts and the motors' torques;
//! [`SpaceAnswers`] are the estimates from these without prior knowledge: state, inertia and mass, the body's poses, and the [`SpaceShape`] that was touched. [`drawn_scenes`] are random scenes for tests.
//!
//! The estimator ([`solid`](super::solid)) uses neither body nor motion.

mod advice;
mod answers;
mod drawn;
mod keys;
mod measurements;
mod record;
mod run;
mod scene;
mod shape;
mod touched;

pub use advice::{Laying, PlannedRun, RunsAdvice, RunsQuestion, advise_runs};
pub use answers::{PoseError, SpaceUpdate, SpaceVerdict};
pub use drawn::{drawn_scenes, relative_error, true_entries};
pub use measurements::{PalmAtSample, SpaceMeasurements, SpaceSensor};
pub use run::{SpaceAnswers, SpaceExperiment, SpaceTruth};
pub use scene::{SpaceBody, SpaceObserver, SpaceScene};
pub use touched::{SpaceShape, directions};
