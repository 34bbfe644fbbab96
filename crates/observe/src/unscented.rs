//! The unscented Kalman filter: no derivative is taken, points about the estimate are followed instead.

use super::filtered::{Corrected, Filtered, Innovation, compared, deviations, factor, not_finite};
use super::task::{Observer, Task};
use super::track::Track;
use super::{Learned, Lost, Order};
use nalgebra::{DMatrix, DVector};
use serde::Deserialize;

/// The unscented Kalman filter in square-root form, with continuous equations and sampled measurements.
///
/// Points `x`, `x +- sqrt(n + kappa) S_i` about the estimate, `S S^T` being its covariance, are followed from sample to sample; mean and
/// covariance of where they come to are those of the prediction, and of the outputs expected there, of the innovation. The
/// covariance is carried by its factor `S` alone, which orthogonal factors of what adds up to it renew: the deviations of the points with their
/// weights and the noise of the process; behind a measurement the deviations less the gain times those of the outputs, and the gain times
/// the noise of the measurements (Joseph's form). As no weight is negative (`kappa >= 0`), nothing is ever subtracted from it, and it cannot lose its
/// sign; `kappa = 0` is the cubature filter.
///
/// References: S. J. Julier, J. K. Uhlmann, Unscented filtering and nonlinear estimation, Proc. IEEE 92(3), 2004; R. van der Merwe,
/// E. A. Wan, The square-root unscented Kalman filter, ICASSP 2001; I. Arasaratnam, S. Haykin, Cubature Kalman filters, IEEE TAC 54(6), 2009.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Unscented {
    /// The standard deviation of the first guess, relative to the sizes of the estimated states.
    pub prior: f64,
    /// What the equations are believed to miss: standard deviation a second^(1/2), relative to the sizes.
    pub process_noise: f64,
    /// The least standard deviation that a measurement is believed to have, in its unit.
    pub least_sigma: f64,
    /// How far out the points lie, and the weight `kappa/(n + kappa)` of the one in the middle; not negative.
    pub kappa: f64,
}

impl Default for Unscented {
    fn default() -> Self {
        Unscented { prior: 0.5, process_noise: 0.01, least_sigma: 1e-6, kappa: 1.0 }
    }
}

/// Points with the square roots of their weights.
struct Points {
    points: Vec<DVector<f64>>,
    roots: Vec<f64>,
}

impl Points {
    fn about(state: &DVector<f64>, factor: &DMatrix<f64>, kappa: f64) -> Points {
        let n = state.len() as f64;
        let reach = (n + kappa).sqrt();
        let mut points = vec![state.clone()];
        for column in factor.column_iter() {
            points.push(state + column * reach);
            points.push(state - column * reach);
        }
        let mut roots = vec![(1.0 / (2.0 * (n + kappa))).sqrt(); points.len()];
        roots[0] = (kappa / (n + kappa)).sqrt();
        Points { points, roots }
    }

    /// The mean of some values at the points.
    fn mean(&self, values: &[DVector<f64>]) -> DVector<f64> {
        let terms = values.iter().zip(&self.roots).map(|(value, root)| value * (root * root));
        terms.fold(DVector::zeros(values[0].len()), |sum, term| sum + term)
    }

    /// Deviations from a mean times the roots of the weights, a column a point.
    fn deviations(&self, values: &[DVector<f64>], mean: &DVector<f64>) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> =
            values.iter().zip(&self.roots).map(|(value, root)| (value - mean) * *root).collect();
        DMatrix::from_columns(&columns)
    }
}

impl Observer for Unscented {
    fn observe(&self, task: &Task<'_>) -> Track {
        let times = task.signals.times();
        let n = task.full.states.len();
        if let Some(why) = task.refuses_implicit() {
            return Track { remarks: vec![why], ..Track::default() };
        }
        let sigma = task.sigma.max(self.least_sigma);
        let mut so_far = Filtered::begin(task, self.least_sigma);
        let learned = Learned::before(task);
        let mut state = DVector::from_vec(task.full_state(&learned.belief, 0));
        let mut root = DMatrix::from_diagonal(&DVector::from_vec(task.prior_deviations(self.prior, sigma)));
        let drive =
            DVector::from_fn(n, |i, _| task.sizes.get(i).map_or(0.0, |size| self.process_noise * size));
        // what was learned before includes the first sample
        let mut first = 0;
        if let Some((known, spread)) = learned.filter {
            (state, root, first) = (known, spread, 1);
            so_far.believe(times[0], state.as_slice(), &deviations(&root), Vec::new());
        }
        for row in first..times.len() {
            if task.interrupted() {
                break;
            }
            // at the first sample there is nothing to follow, and something measured
            if row > 0 {
                match self.predict(task, &state, &root, &drive, &times[row - 1..=row]) {
                    Ok((there, spread)) => (state, root) = (there, spread),
                    Err(lost) => {
                        so_far.lose(row, &mut state, &lost);
                        continue;
                    }
                }
            }
            let mut residual = Vec::new();
            let noise = so_far.measurement_variances().map(f64::sqrt);
            match self.correct(task, &state, &root, &noise, row) {
                Ok(Some((there, spread, innovation))) => {
                    (state, root) = (there, spread);
                    so_far.compare_white(&innovation);
                    residual = innovation.of_all(noise.len());
                }
                Ok(None) => {}
                Err(lost) => {
                    so_far.lose(row, &mut state, &lost);
                    continue;
                }
            }
            so_far.hold(times[row], &mut state, &(&root * root.transpose()));
            so_far.believe(times[row], state.as_slice(), &deviations(&root), residual);
        }
        let mut track = so_far.end();
        track.hand_on(Learned::of_filter(task, &state, &root, &deviations(&root)));
        track
    }
}

impl Unscented {
    /// Where the points come to: their mean, and the factor of their covariance with the noise of the process.
    fn predict(
        &self,
        task: &Task<'_>,
        state: &DVector<f64>,
        root: &DMatrix<f64>,
        drive: &DVector<f64>,
        times: &[f64],
    ) -> Result<(DVector<f64>, DMatrix<f64>), Lost> {
        let points = Points::about(state, root, self.kappa);
        let mut there = Vec::with_capacity(points.points.len());
        for point in &points.points {
            let samples = task.full_flow().follow(point.as_slice(), &[], times, Order::Value)?;
            let end = samples.into_iter().next_back();
            let end =
                end.ok_or_else(|| Lost { time: times[0], why: "there is no time to follow".to_owned() })?;
            there.push(DVector::from_vec(end.state));
        }
        let mean = points.mean(&there);
        let noise = DMatrix::from_diagonal(&(drive * (times[1] - times[0]).sqrt()));
        let root = factor(&[points.deviations(&there, &mean), noise]);
        Ok((mean, root.ok_or_else(|| Lost { time: times[1], why: "a number is not finite".to_owned() })?))
    }

    /// State and factor after a measurement whose errors have these deviations, and the innovation; none where nothing was measured.
    fn correct(
        &self,
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
        let points = Points::about(state, root, self.kappa);
        let time = &task.signals.times()[row..=row];
        let mut seen = Vec::with_capacity(points.points.len());
        for point in &points.points {
            let samples = task.full_flow().follow(point.as_slice(), &[], time, Order::Value)?;
            let here = samples.into_iter().next().ok_or_else(|| not_finite(task, row))?;
            seen.push(DVector::from_vec(here.outputs).select_rows(&measured));
        }
        let read = DVector::from_vec(task.measurements(row));
        let (read, deviations) = (read.select_rows(&measured), deviations.select_rows(&measured));
        let expected = points.mean(&seen);
        let outputs = points.deviations(&seen, &expected);
        let states = points.deviations(&points.points, state);
        let noise = DMatrix::from_diagonal(&deviations);
        let residual = &expected - &read;
        let corrected = || {
            let innovation = factor(&[outputs.clone(), noise.clone()])?;
            // gain = Pxy (S S^T)^-1, from the right by its two triangles
            let cross = &states * outputs.transpose();
            let half = innovation.solve_lower_triangular(&cross.transpose())?;
            let gain = innovation.transpose().solve_upper_triangular(&half)?.transpose();
            let there = state - &gain * &residual;
            let root = factor(&[&states - &gain * &outputs, &gain * &noise])?;
            there.iter().all(|value| value.is_finite()).then_some((there, root, innovation))
        };
        let (there, spread, innovation) = corrected().ok_or_else(|| not_finite(task, row))?;
        Ok(Some((there, spread, Innovation { residual, root: innovation, measured })))
    }
}
