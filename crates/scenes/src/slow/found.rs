//! What all readings at once tell: a shape, its track, and whether they are explained.

use super::outline::Kink;
use super::quadrature::SlowTrack;
use palmistry_bodies::shape::ShapeEstimate;

/// So many deviations of chi-square are not chance.
pub(super) const CERTAIN: f64 = 5.0;

/// Exact readings are explained to this part of the mean radius.
pub(super) const EXACT: f64 = 1e-4;

/// Shape and motion that explain all readings.
#[derive(Clone, Debug)]
pub struct SlowShape {
    /// The support function with its covariance, by the readings' deviation: Cramér and Rao's bound.
    pub shape: ShapeEstimate,
    /// The harmonics that were free; those beyond are the kinks'.
    pub order: usize,
    /// Kinks of the curvature, where they explain more than harmonics do.
    pub kinks: Vec<Kink>,
    /// Radii, orientations, heights at the samples. The orientation is in the frame of the shape.
    pub track: SlowTrack,
    /// The root of the mean square of what is left of a contact, in m.
    pub rms_residual: f64,
    /// The deviation of a reading with which it was held against, in m.
    pub sigma: f64,
    /// The least of the potential's second derivatives at the samples, in parts of the mean radius.
    pub stiffness: f64,
}

/// Residuals above this many deviations of the readings are no noise.
const IS_NOISE: f64 = 1.5;

impl SlowShape {
    /// By what factor a deviation by the covariance is to be taken: errors of readings average out over all of them, and what an order of harmonics leaves does not.
    pub(super) fn caution(&self) -> f64 {
        if self.shape.widened > IS_NOISE { (self.shape.samples as f64).sqrt() } else { 1.0 }
    }

    /// Whether the readings are explained: what is left is what errors of their deviation leave, by chi-square within five deviations of its own; exact ones to a part of the mean radius. A shape
    /// that is another leaves more, if only a quarter more: a body that is nearly its own mirror image does.
    pub fn explains(&self, part: f64) -> bool {
        let (degrees, samples) = (self.shape.degrees as f64, self.shape.samples as f64);
        // each coefficient takes a deviation from the residuals
        let most = ((degrees + CERTAIN * (2.0 * degrees).sqrt()) / samples).sqrt();
        self.rms_residual <= (most * self.sigma).max(part * self.shape.support.mean())
    }
}
