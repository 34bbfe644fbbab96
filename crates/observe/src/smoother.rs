//! The fixed-interval smoother: what an extended Kalman filter believes, corrected backwards by all that was measured later.
//!
//! H. E. Rauch, F. Tung, C. T. Striebel, Maximum likelihood estimates of linear dynamic systems, AIAA Journal 3, 1965: with `F` the derivative of the flow from one sample to the next, `P`
//! the covariance after the measurements of a sample and `P'` the one that is predicted for the next, the estimate is moved by `P F^T P'^-1` of what the next one was moved by.

use super::kalman::Kalman;
use super::task::{Observer, Task};
use super::track::Track;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use palmistry_math::number::MOST_ITERATIONS;

/// A direction of a predicted covariance, in units of the deviations, counts as known exactly below this.
const KNOWN: f64 = 1e-14;

/// The smoother, with the settings of its filter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Smoother {
    /// The filter that goes before it.
    pub filter: Kalman,
}

impl Observer for Smoother {
    fn observe(&self, task: &Task<'_>) -> Track {
        let mut passed = Vec::new();
        let mut track = self.filter.pass(task, Some(&mut passed));
        let sought = task.estimated();
        let mut later: Option<(DVector<f64>, DMatrix<f64>)> = None;
        for (place, own) in passed.iter().enumerate().rev() {
            let next = passed.get(place + 1).and_then(|next| next.predicted.as_ref());
            let (state, covariance) = match (later, next) {
                (Some((there, spread)), Some(next)) => {
                    // a covariance without an inverse in doubles is not corrected by later samples
                    let gain = inverse(&next.covariance).map_or_else(
                        || DMatrix::zeros(there.len(), there.len()),
                        |inverse| &own.covariance * next.flow.transpose() * inverse,
                    );
                    let state = &own.state + &gain * (there - &next.state);
                    let covariance = &own.covariance + &gain * (spread - &next.covariance) * gain.transpose();
                    (state, (&covariance + covariance.transpose()) * 0.5)
                }
                _ => (own.state.clone(), own.covariance.clone()),
            };
            if let Some(told) = track.estimates.get_mut(place)
                && told.deviations.iter().all(|deviation| deviation.is_finite())
            {
                told.state = task.within_bounds(state.as_slice().to_vec())[..sought].to_vec();
                told.deviations = (0..sought).map(|i| covariance[(i, i)].max(0.0).sqrt()).collect();
            }
            later = Some((state, covariance));
        }
        track
    }
}

/// The inverse of a covariance. None where it is singular, since what is known exactly is not corrected, or where a number is not finite.
fn inverse(covariance: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let sizes = covariance.diagonal().map(|variance| if variance > 0.0 { variance.sqrt() } else { 1.0 });
    let scaled = DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| {
        covariance[(i, j)] / (sizes[i] * sizes[j])
    });
    if scaled.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let eigen = SymmetricEigen::try_new(scaled, f64::EPSILON, MOST_ITERATIONS)?;
    let parts = eigen.eigenvalues.map(|value| if value > KNOWN { 1.0 / value } else { 0.0 });
    let inverse = &eigen.eigenvectors * DMatrix::from_diagonal(&parts) * eigen.eigenvectors.transpose();
    Some(DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| {
        inverse[(i, j)] / (sizes[i] * sizes[j])
    }))
}
