//! The extended Kalman filter, the field's usual choice.

use super::filtered::{Filtered, Innovation, measured};
use super::task::{Observer, Task};
use super::track::Track;
use super::{Learned, Lost, Order};
use nalgebra::{Cholesky, DMatrix, DVector};
use serde::Deserialize;

/// The extended Kalman filter with continuous equations and sampled measurements.
///
/// Between two samples the state follows the model and the covariance `P` becomes `F P F^T + Q dt`, `F` being the exact
/// derivative of the flow over the step; at a sample state and covariance are corrected by the gain `P H^T (H P H^T + R)^-1`.
///
/// Reference: A. Gelb (ed.), Applied Optimal Estimation, 1974, table 6.1-1, with the flow's derivative in place of an Euler step.
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
    pub covariance: DMatrix<f64>,
    /// The derivative of the flow from the sample before, and what was predicted; none at the first sample and where the model could not be followed.
    pub predicted: Option<Predicted>,
}

/// What was predicted from the sample before.
#[derive(Clone, Debug)]
pub(super) struct Predicted {
    pub flow: DMatrix<f64>,
    pub state: DVector<f64>,
    pub covariance: DMatrix<f64>,
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
        let n = task.full.states.len();
        if let Some(why) = task.refuses_implicit() {
            return Track { remarks: vec![why], ..Track::default() };
        }
        let sigma = task.sigma.max(self.least_sigma);
        let mut so_far = Filtered::begin(task, self.least_sigma);
        let learned = Learned::before(task);
        let mut state = DVector::from_vec(task.full_state(&learned.belief, 0));
        let deviations = DVector::from_vec(task.prior_deviations(self.prior, sigma));
        let mut covariance = DMatrix::from_diagonal(&deviations.map(|deviation| deviation.powi(2)));
        let drive = |i: usize| task.sizes.get(i).map_or(0.0, |size| (self.process_noise * size).powi(2));
        if let Some((known, spread)) = learned.filter {
            (state, covariance) = (known, spread);
        }
        so_far.believe(times[0], state.as_slice(), &covariance.diagonal(), Vec::new());
        let mut keep = |state: &DVector<f64>, covariance: &DMatrix<f64>, predicted: Option<Predicted>| {
            if let Some(passed) = passed.as_deref_mut() {
                passed.push(Passed { state: state.clone(), covariance: covariance.clone(), predicted });
            }
        };
        keep(&state, &covariance, None);
        for row in 1..times.len() {
            if task.interrupted() {
                break;
            }
            let step = times[row] - times[row - 1];
            let predicted = match predict(task, &state, &times[row - 1..=row]) {
                Ok((there, flow)) => {
                    state = there;
                    covariance = &flow * covariance * flow.transpose();
                    for i in 0..n {
                        covariance[(i, i)] += drive(i) * step;
                    }
                    Predicted { flow, state: state.clone(), covariance: covariance.clone() }
                }
                Err(lost) => {
                    so_far.track.hold(&lost);
                    let belief = state.as_slice()[..task.estimated()].to_vec();
                    state = DVector::from_vec(task.full_state(&belief, row));
                    // a state that is held while the model is lost is no longer known
                    let unknown = DVector::from_element(n, f64::INFINITY);
                    so_far.believe(times[row], state.as_slice(), &unknown, Vec::new());
                    keep(&state, &covariance, None);
                    continue;
                }
            };
            let noise = so_far.measurement_variances();
            let innovation = correct(task, &mut state, &mut covariance, &noise, row);
            innovation.iter().for_each(|own| so_far.compare_white(own));
            so_far.hold(times[row], &mut state, &covariance);
            let residual = innovation.map(|own| own.of_all(noise.len())).unwrap_or_default();
            so_far.believe(times[row], state.as_slice(), &covariance.diagonal(), residual);
            keep(&state, &covariance, Some(predicted));
        }
        let mut track = so_far.end();
        track.hand_on(Learned::of_filter(task, &state, &covariance, &covariance.diagonal()));
        track
    }
}

/// The state after a step, and its derivative by the state before.
fn predict(
    task: &Task<'_>,
    state: &DVector<f64>,
    times: &[f64],
) -> Result<(DVector<f64>, DMatrix<f64>), Lost> {
    let free: Vec<usize> = (0..state.len()).collect();
    let samples = task.full_flow().follow(state.as_slice(), &free, times, Order::First)?;
    let end = samples.into_iter().next_back();
    let end = end.ok_or_else(|| Lost { time: times[0], why: "there is no time to follow".to_owned() })?;
    Ok((DVector::from_vec(end.state), end.slopes))
}

/// Corrects a state by measurements, whose errors have these variances; gives the innovation, or nothing where nothing was measured or no gain exists.
fn correct(
    task: &Task<'_>,
    state: &mut DVector<f64>,
    covariance: &mut DMatrix<f64>,
    variances: &DVector<f64>,
    row: usize,
) -> Option<Innovation> {
    let free: Vec<usize> = (0..state.len()).collect();
    let here = task
        .full_flow()
        .follow(state.as_slice(), &free, &task.signals.times()[row..=row], Order::First)
        .ok()?;
    let here = here.first()?;
    let read = task.measurements(row);
    let measured = measured(&read);
    if measured.is_empty() {
        return None;
    }
    let residual =
        DVector::from_iterator(measured.len(), measured.iter().map(|i| here.outputs[*i] - read[*i]));
    let h = &here.output_slopes.select_rows(&measured);
    let noise = DMatrix::from_diagonal(&variances.select_rows(&measured));
    let innovation = h * &*covariance * h.transpose() + &noise;
    let gain = Cholesky::new(innovation.clone())?.solve(&(h * &*covariance)).transpose();
    *state -= &gain * &residual;
    // Joseph's form: stays symmetric and positive whatever the rounding
    let rest = DMatrix::identity(state.len(), state.len()) - &gain * h;
    let corrected = &rest * &*covariance * rest.transpose() + &gain * noise * gain.transpose();
    *covariance = (&corrected + corrected.transpose()) * 0.5;
    Some(Innovation { residual, covariance: innovation, measured })
}
