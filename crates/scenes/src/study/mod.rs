//! An experiment many times over: with other errors of the readings, from other first guesses, and between other palms.
//!
//! Each trial is one of its place alone, so that a study may be cut into stretches of trials ([`StudyPart`]), and comes to the same.

mod basin;
mod curvature;
mod noise;
mod part;
mod part_text;
#[cfg(test)]
mod tests;

pub use basin::{ARRIVED, Basin, basins};
pub use curvature::{CurvatureMap, CurvatureRatio, StudiedMotion, Told, curvature_map};
pub use noise::{NoiseLevel, noise_study};
pub use part::{Studied, Studies, StudyMergeError, StudyPart};
