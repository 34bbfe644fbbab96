//! Repetitions of an experiment: with other errors of the measurements, from other first guesses, and between other palms.
//!
//! Each trial depends on its place alone, so that a study may be cut into stretches of trials ([`StudyPart`]) with the same result.

mod basin;
mod curvature;
mod noise;
mod part;
mod part_text;
#[cfg(test)]
mod tests;

pub use basin::{ARRIVED, Basin, basins};
pub use curvature::{CurvatureMap, CurvatureRatio, StudiedMotion, WindowBound, curvature_map};
pub use noise::{NoiseLevel, noise_study};
pub use part::{Studied, Studies, StudyMergeError, StudyPart};
