//! How a column goes from one of its samples to the next.

use serde::Deserialize;

/// How a column goes from one of its samples to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// `polynomial`: by the polynomial through the nearest eight samples, as what was sampled much faster than it changes.
    #[default]
    Polynomial,
    /// `linear`: by a straight line, as what changes between samples in ways that nobody knows.
    Linear,
    /// `hold`: it keeps its value until the next sample, as a command does.
    Hold,
}

impl Interpolation {
    /// So many samples carry the curve at a time; `most` of a polynomial.
    pub(super) fn points(self, most: usize) -> usize {
        match self {
            Interpolation::Polynomial => most,
            Interpolation::Linear => 2,
            Interpolation::Hold => 1,
        }
    }
}
