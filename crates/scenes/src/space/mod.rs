//! Bodies in space on three palms: scenes with `motion = "spatial"`, chapter 5 of the thesis.
//!
//! A [`SpaceScene`] says what is held and how it moves, or what was recorded; a [`SpaceExperiment`] is one with its [`SpaceMeasurements`], the palms' angles, the places of the contacts and the motors' torques;
//! [`SpaceAnswers`] is what these tell with nothing known: state, inertia and mass, the body's poses, and the [`SpaceShape`] that was touched. [`drawn_scenes`] are many, to count on.
//!
//! The estimator ([`solid`](super::solid)) has seen neither body nor motion.

mod advice;
mod answers;
mod drawn;
mod keys;
mod readings;
mod record;
mod run;
mod scene;
mod shape;
mod touched;

pub use advice::{Laying, PlannedRun, RunsAdvice, RunsQuestion, advise_runs};
pub use answers::{PoseError, SpaceUpdate, SpaceVerdict};
pub use drawn::{drawn_scenes, relative_error, true_entries};
pub use readings::{PalmAtSample, SpaceMeasurements, SpaceSensor};
pub use run::{SpaceAnswers, SpaceExperiment, SpaceTruth};
pub use scene::{SpaceBody, SpaceObserver, SpaceScene};
pub use touched::{SpaceShape, directions};
