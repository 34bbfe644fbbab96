//! The extended Kalman filter, the field's usual choice.

use super::filtered::{Corrected, Filtered, Innovation, compared, deviations, factor, not_finite};
use super::task::{Observer, Task};
use super::track::Track;
use super::{Learned, Lost, Order};
use nalgebra::{DMatrix, DVector};
use serde::Deserialize;

/// The extended Kalman filter with continuous equations and sampled measurements.
///
/// Between two samples the state follows the model and the covariance `P` becomes `F P F^T + Q dt`, `F` being the exact
/// derivative of the flow over the step; at a sample state and covariance are corrected by the gain `P H^T (H P H^T + R)^-1`. The guess is what is known
/// before the first sample, whose measurements correct it as all later ones do.
///
/// The covariance is carried by a factor `S`, `P = S S^T`, which orthogonal factors renew: of a first guess that is known a billion times worse than a
/// measurement the covariance itself would keep no digit, and lose its sign.
///
/// References: A. Gelb (ed.), Applied Optimal Estimation, 1974, table 6.1-1, with the flow's derivative in place of an Euler step; G. J. Bierman,
/// Factorization Methods for Discrete Sequential Estimation, 1977, for the factor.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Kalman {
    /// The standard deviation of the first guess, relative to the sizes of the estimated states.
    pub prior: f64,
    /// What the equations are believed to miss: standard deviation a second^(1/2), relative to the sizes.
    pub process_noise: f64,
    /// The least standard deviation that a measurement is believed to have, in its unit: linearised as it is, the filter must
    /// not believe that anything is exact.
    pub least_sigma: f64,
}

impl Default for Kalman {
    fn default() -> Self {
        Kalman { prior: 0.5, process_noise: 0.01, least_sigma: 1e-6 }
    }
}

/// What a filter believed at a sample, and how it came there.
#[derive(Clone, Debug)]
pub(super) struct Passed {
    /// After the measurements of the sample.
    pub state: DVector<f64>,
    /// The factor of its covariance.
    pub root: DMatrix<f64>,
    /// The derivative of the flow from the sample before, and what was predicted; none at the first sample and where the filter was lost.
    pub predicted: Option<Predicted>,
}

/// What was predicted from the sample before.
#[derive(Clone, Debug)]
pub(super) struct Predicted {
    pub flow: DMatrix<f64>,
    pub state: DVector<f64>,
    /// The factor of what the equations are believed to miss over the step.
    pub noise: DMatrix<f64>,
}

impl Observer for Kalman {
    fn observe(&self, task: &Task<'_>) -> Track {
        self.pass(task, None)
    }
}

impl Kalman {
    /// Goes through all samples; whoever goes back has what was `passed`, one a sample.
    pub(super) fn pass(&self, task: &Task<'_>, mut passed: Option<&mut Vec<Passed>>) -> Track {
        let times = task.signals.times();
        if let Some(why) = task.refuses_implicit() {
            return Track { remarks: vec![why], ..Track::default() };
        }
        let sigma = task.sigma.max(self.least_sigma);
        let mut so_far = Filtered::begin(task, self.least_sigma);
        let learned = Learned::before(task);
        let mut state = DVector::from_vec(task.full_state(&learned.belief, 0));
        let mut root = DMatrix::from_diagonal(&DVector::from_vec(task.prior_deviations(self.prior, sigma)));
        let mut keep = |state: &DVector<f64>, root: &DMatrix<f64>, predicted: Option<Predicted>| {
            if let Some(passed) = passed.as_deref_mut() {
                passed.push(Passed { state: state.clone(), root: root.clone(), predicted });
            }
        };
        // what was learned before includes the first sample
        let mut first = 0;
        if let Some((known, spread)) = learned.filter {
            (state, root, first) = (known, spread, 1);
            so_far.believe(times[0], state.as_slice(), &deviations(&root), Vec::new());
            keep(&state, &root, None);
        }
        for (row, time) in times.iter().enumerate().skip(first) {
            if task.interrupted() {
                break;
            }
            let noise = so_far.measurement_variances().map(f64::sqrt);
            let (predicted, innovation) = match self.step(task, &mut state, &mut root, &noise, row) {
                Ok(step) => step,
                Err(lost) => {
                    so_far.lose(row, &mut state, &lost);
                    keep(&state, &root, None);
                    continue;
                }
            };
            innovation.iter().for_each(|own| so_far.compare_white(own));
            so_far.hold(*time, &mut state, &(&root * root.transpose()));
            let residual = innovation.map(|own| own.of_all(noise.len())).unwrap_or_default();
            so_far.believe(*time, state.as_slice(), &deviations(&root), residual);
            keep(&state, &root, predicted);
        }
        let mut track = so_far.end();
        track.hand_on(Learned::of_filter(task, &state, &root, &deviations(&root)));
        track
    }

    /// Predicts a sample from the one before it, where there is one, and corrects it by what was measured, with errors of these deviations. A state to which the
    /// model cannot be followed, and one that cannot be corrected, stay as they are.
    fn step(
        &self,
        task: &Task<'_>,
        state: &mut DVector<f64>,
        root: &mut DMatrix<f64>,
        noise: &DVector<f64>,
        row: usize,
    ) -> Result<(Option<Predicted>, Option<Innovation>), Lost> {
        let mut predicted = None;
        if row > 0 {
            let own = self.predict(task, state, row)?;
            *root = factor(&[&own.flow * &*root, own.noise.clone()]).ok_or_else(|| not_finite(task, row))?;
            state.copy_from(&own.state);
            predicted = Some(own);
        }
        let corrected = correct(task, state, root, noise, row)?;
        let innovation = corrected.map(|(there, spread, innovation)| {
            (*state, *root) = (there, spread);
            innovation
        });
        Ok((predicted, innovation))
    }

    /// The state at a sample from the one before it, with its derivative by that, and what the equations may have missed.
    fn predict(&self, task: &Task<'_>, state: &DVector<f64>, row: usize) -> Result<Predicted, Lost> {
        let times = &task.signals.times()[row - 1..=row];
        let free: Vec<usize> = (0..state.len()).collect();
        let samples = task.full_flow().follow(state.as_slice(), &free, times, Order::First)?;
        let end = samples.into_iter().next_back();
        let end = end.ok_or_else(|| Lost { time: times[0], why: "there is no time to follow".to_owned() })?;
        let drive = |i: usize| task.sizes.get(i).map_or(0.0, |size| self.process_noise * size);
        let missed = DVector::from_fn(state.len(), |i, _| drive(i) * (times[1] - times[0]).sqrt());
        let noise = DMatrix::from_diagonal(&missed);
        Ok(Predicted { flow: end.slopes, state: DVector::from_vec(end.state), noise })
    }
}

/// State and factor after measurements, whose errors have these deviations, and the innovation; nothing where nothing was measured.
///
/// Joseph's form: the part of the error that stays, and that of the measurements. Neither is a difference.
fn correct(
    task: &Task<'_>,
    state: &DVector<f64>,
    root: &DMatrix<f64>,
    deviations: &DVector<f64>,
    row: usize,
) -> Result<Option<Corrected>, Lost> {
    let measured = compared(task, row);
    if measured.is_empty() {
        return Ok(None);
    }
    let free: Vec<usize> = (0..state.len()).collect();
    let time = &task.signals.times()[row..=row];
    let here = task.full_flow().follow(state.as_slice(), &free, time, Order::First)?;
    let here = here.first().ok_or_else(|| not_finite(task, row))?;
    let read = task.measurements(row);
    let off = measured.iter().map(|i| here.outputs[*i] - read[*i]);
    let residual = DVector::from_iterator(measured.len(), off);
    let h = &here.output_slopes.select_rows(&measured);
    let noise = DMatrix::from_diagonal(&deviations.select_rows(&measured));
    let corrected = || {
        let seen = h * root;
        let innovation = factor(&[seen.clone(), noise.clone()])?;
        // gain = P H^T (N N^T)^-1, from the right by its two triangles
        let half = innovation.solve_lower_triangular(&(seen * root.transpose()))?;
        let gain = innovation.transpose().solve_upper_triangular(&half)?.transpose();
        let there = state - &gain * &residual;
        let rest = DMatrix::identity(state.len(), state.len()) - &gain * h;
        let root = factor(&[rest * root, gain * noise])?;
        there.iter().all(|value| value.is_finite()).then_some((there, root, innovation))
    };
    let (there, spread, innovation) = corrected().ok_or_else(|| not_finite(task, row))?;
    Ok(Some((there, spread, Innovation { residual, root: innovation, measured })))
}

#[cfg(test)]
mod tests;
