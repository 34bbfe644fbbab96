//! The fixed-interval smoother: what an extended Kalman filter believes, corrected backwards by all that was measured later.
//!
//! H. E. Rauch, F. Tung, C. T. Striebel, Maximum likelihood estimates of linear dynamic systems, AIAA Journal 3, 1965: with `F` the derivative of the flow from one sample to the next, `P`
//! the covariance after the measurements of a sample and `P'` the one that is predicted for the next, the estimate is moved by `G = P F^T P'^-1` of what the next one was moved by.
//!
//! The covariance is that of what of the filter's error is not told by the next state, and `G` times the next one's: a sum, and no difference, of two factors (as Joseph's
//! form is of a correction).

use super::filtered::{deviations, factor};
use super::kalman::{Kalman, Passed, Predicted};
use super::task::{Observer, Task};
use super::track::Track;
use nalgebra::{DMatrix, DVector};

/// A direction of a predicted state is known exactly where its deviation is this part of the state's, or less.
const KNOWN: f64 = 1e-13;

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
            let smoothed = later.as_ref().zip(next).and_then(|(later, next)| back(own, next, later));
            let (state, root) = smoothed.unwrap_or_else(|| (own.state.clone(), own.root.clone()));
            if let Some(told) = track.estimates.get_mut(place)
                && told.deviations.iter().all(|deviation| deviation.is_finite())
            {
                told.state = task.within_bounds(state.as_slice().to_vec())[..sought].to_vec();
                told.deviations = deviations(&root).iter().take(sought).copied().collect();
            }
            later = Some((state, root));
        }
        track
    }
}

/// State and factor at a sample, corrected by those at the next one. None where a number is not finite: then later samples correct nothing.
///
/// The triangle of `[F S, N; S, 0]`, `N` being the factor of the noise of the process, has the factor of the predicted covariance in its first rows, below it `G` times
/// that, and on its diagonal the factor of what the next state does not tell.
fn back(
    own: &Passed,
    next: &Predicted,
    (state, root): &(DVector<f64>, DMatrix<f64>),
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let n = own.state.len();
    let mut both = DMatrix::zeros(2 * n, 2 * n);
    both.view_mut((0, 0), (n, n)).copy_from(&(&next.flow * &own.root));
    both.view_mut((0, n), (n, n)).copy_from(&next.noise);
    both.view_mut((n, 0), (n, n)).copy_from(&own.root);
    let triangle = factor(&[both])?;
    let part = |row: usize, column: usize| triangle.view((row, column), (n, n)).into_owned();
    let gain = divided(&part(n, 0), &part(0, 0));
    let there = &own.state + &gain * (state - &next.state);
    let spread = factor(&[part(n, n), gain * root])?;
    there.iter().all(|value| value.is_finite()).then_some((there, spread))
}

/// `X L^-1` with a lower triangular `L`; nothing along what `L` has no direction of its own for, since what is known exactly is not corrected.
fn divided(x: &DMatrix<f64>, triangle: &DMatrix<f64>) -> DMatrix<f64> {
    let (n, sizes) = (triangle.nrows(), deviations(triangle));
    let mut quotient = DMatrix::zeros(x.nrows(), n);
    for j in (0..n).rev() {
        let pivot = triangle[(j, j)];
        if pivot <= KNOWN * sizes[j] {
            continue;
        }
        let later: DVector<f64> =
            quotient.columns(j + 1, n - j - 1) * triangle.view((j + 1, j), (n - j - 1, 1)).column(0);
        quotient.set_column(j, &((x.column(j) - later) / pivot));
    }
    quotient
}
