//! The batch estimate from all measurements: a shape, its track, and whether they are explained.

use super::outline::Kink;
use super::quadrature::SlowTrack;
use palmistry_bodies::shape::ShapeEstimate;

/// A chi-square that exceeds its mean by this many standard deviations is not chance.
pub(super) const CERTAIN: f64 = 5.0;

/// Exact measurements are explained up to this fraction of the mean radius.
pub(super) const EXACT: f64 = 1e-4;

/// Shape and motion that explain all measurements.
#[derive(Clone, Debug)]
pub struct SlowShape {
    /// The support function with its covariance, by the measurements' deviation: the Cramér-Rao bound.
    pub shape: ShapeEstimate,
    /// The order of the free harmonics; higher ones are those of the kinks.
    pub order: usize,
    /// Kinks of the curvature, where they explain more than harmonics do.
    pub kinks: Vec<Kink>,
    /// Radii, orientations, heights at the samples. The orientation is in the frame of the shape.
    pub track: SlowTrack,
    /// The root mean square residual of a contact, in m.
    pub rms_residual: f64,
    /// The standard deviation of a measurement in the test of fit, in m.
    pub sigma: f64,
    /// The least of the potential's second derivatives at the samples, relative to the mean radius.
    pub stiffness: f64,
}

/// Residuals above this many deviations of the measurements are not noise.
const IS_NOISE: f64 = 1.5;

impl SlowShape {
    /// The factor for deviations from the covariance: errors of measurements average out over all of them, and the truncation error of harmonics does not.
    pub(super) fn caution(&self) -> f64 {
        if self.shape.widened > IS_NOISE { (self.shape.samples as f64).sqrt() } else { 1.0 }
    }

    /// Whether the measurements are explained: chi-square within five deviations of its mean; for exact measurements, the residual below a fraction of the mean radius. A wrong shape
    /// has a larger residual, if only by a quarter: a body that is nearly its own mirror image does.
    pub fn explains(&self, part: f64) -> bool {
        let (degrees, samples) = (self.shape.degrees as f64, self.shape.samples as f64);
        // each coefficient takes one degree of freedom from the residuals
        let most = ((degrees + CERTAIN * (2.0 * degrees).sqrt()) / samples).sqrt();
        self.rms_residual <= (most * self.sigma).max(part * self.shape.support.mean())
    }
}
