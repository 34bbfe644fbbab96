//! A closed outline through the radii of a track: the same direction touched twice has one radius.

use super::measurements::SlowMeasurements;
use super::quadrature::SlowTrack;
use palmistry_bodies::shape::{SupportSample, SupportSeries, SupportWeights, fit_support};

/// The normals that a track touched, with their radii.
pub(super) fn touched(measurements: &SlowMeasurements, track: &SlowTrack) -> Vec<SupportSample> {
    let half = std::f64::consts::FRAC_PI_2;
    let rows = measurements.palms.iter().zip(&track.phi0).zip(&track.radii);
    rows.flat_map(|((palms, phi0), radii)| {
        let angles = [palms[0] - phi0 - half, palms[0] + palms[1] - phi0 - 3.0 * half];
        [0, 1].map(|i: usize| SupportSample { angle: angles[i], radius: radii[i], weight: 1.0 })
    })
    .collect()
}

/// The closed function of an order through a track, and the residual relative to the mean radius.
pub(super) fn closed(
    measurements: &SlowMeasurements,
    track: &SlowTrack,
    order: usize,
) -> Option<(SupportSeries, f64)> {
    let shape = fit_support(&touched(measurements, track), SupportWeights::Relative, Some(order))?;
    // tracks that belong to no body can close, too: a lack of convexity is added to the residual
    let dent = (0..180)
        .map(|i| -shape.support.radius_of_curvature(std::f64::consts::TAU * f64::from(i) / 180.0))
        .fold(0.0, f64::max);
    let samples = touched(measurements, track);
    let off = |sample: &SupportSample| (sample.radius - shape.support.support(sample.angle)[0]).powi(2);
    let left = (samples.iter().map(off).sum::<f64>() / samples.len() as f64).sqrt();
    let left = (left + 0.02 * dent) / shape.support.mean();
    left.is_finite().then(|| (SupportSeries::of_coefficients(&shape.support.coefficients()), left))
}
