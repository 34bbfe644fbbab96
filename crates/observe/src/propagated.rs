//! How well a window's state is known at all of its samples: its covariance carried along the flow.
//!
//! With `F` the derivative of the state at a sample by the unknowns of the first one, the state there has the covariance `F P F^T` (A. H. Jazwinski, Stochastic
//! Processes and Filtering Theory, 1970, section 5.3): the Cramér-Rao bound for what is a function of the unknowns.

use super::filtered;
use super::flow::Sample;
use super::learned::Spread;
use super::task::Task;
use nalgebra::{Cholesky, DMatrix};

/// The deviations of the estimated states at a sample, from the covariance of the unknowns: by a factor of it, where it has one in doubles, since sums of squares cannot
/// be rounded to below nothing; a variance that is, or that is no number, says that nothing is known.
pub(super) fn deviations(sample: &Sample, covariance: &DMatrix<f64>, sought: usize) -> Vec<f64> {
    let all = match Cholesky::new(covariance.clone()) {
        Some(root) => filtered::deviations(&(&sample.slopes * root.l())),
        None => filtered::of_variances(&(&sample.slopes * covariance * sample.slopes.transpose()).diagonal()),
    };
    all.iter().take(sought).map(|own| if own.is_nan() { f64::INFINITY } else { *own }).collect()
}

/// How well the whole state is known at the sample of a `row`, from so many `measurements`.
pub(super) fn spread(
    task: &Task<'_>,
    (sample, row): (&Sample, usize),
    covariance: &DMatrix<f64>,
    measurements: usize,
    is_tested: bool,
) -> Spread {
    let carried = &sample.slopes * covariance;
    let mut by_measurement = &carried * sample.output_slopes.transpose();
    let read = task.measurements(row);
    let unmeasured = read.iter().enumerate().filter(|(_, value)| value.is_nan());
    unmeasured.for_each(|(output, _)| by_measurement.column_mut(output).fill(0.0));
    Spread {
        state: sample.state.clone(),
        covariance: &carried * sample.slopes.transpose(),
        by_measurement,
        coherent: coherent(task, sample, measurements),
        is_tested,
    }
}

/// By how many deviations rounding and computation may move an estimate from so many measurements: each by no more than half a resolution, however they are
/// correlated.
fn coherent(task: &Task<'_>, sample: &Sample, measurements: usize) -> f64 {
    let one = |(output, value): (usize, &f64)| {
        let errors = task.output_errors(output);
        let own = errors.rounding / 2.0 + task.timing + super::fit::COMPUTED * value.abs();
        if errors.are_none() { 0.0 } else { own / errors.variance().sqrt() }
    };
    sample.outputs.iter().enumerate().map(one).fold(0.0, f64::max) * (measurements as f64).sqrt()
}

impl Spread {
    /// The covariance with which samples are followed from here where outputs are taken as measured: they err as their measurements do.
    pub(super) fn as_read(&self, task: &Task<'_>) -> DMatrix<f64> {
        let mut covariance = self.covariance.clone();
        let sought = task.estimated();
        for place in sought..task.full.states.len() {
            let own = task.full.outputs.iter().position(|name| *name == task.full.states[place]);
            for other in 0..task.full.states.len() {
                let together = match own {
                    Some(output) if other < sought => self.by_measurement[(other, output)],
                    Some(output) if other == place => task.output_errors(output).variance(),
                    _ => 0.0,
                };
                (covariance[(place, other)], covariance[(other, place)]) = (together, together);
            }
        }
        covariance
    }
}
