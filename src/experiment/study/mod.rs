//! An experiment many times over: with other errors of the readings, and from other first guesses.
//!
//! Each trial is one of its place alone, so that a study may be cut into stretches of trials ([`StudyPart`]), and comes to the same.

mod basin;
mod noise;
mod part;
mod part_text;

pub use basin::{ARRIVED, Basin, basins};
pub use noise::{NoiseLevel, noise_study};
pub use part::{Studies, StudyMergeError, StudyPart};
