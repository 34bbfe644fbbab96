//! What the errors of all columns make of the differences in a window: a covariance that is not white, and differences in units in
//! which it is.
//!
//! An output's measurement has an error of its own. A column that drives the model errs too, and its errors reach all later samples through
//! the model: with `S` the derivative of what is expected by the samples of the columns, and `V` the covariance of their errors, the
//! differences of the true state have the covariance `C = R + S V S^T`. Least squares with `W` for which `W C W^T = 1` is as good as an
//! estimate from these measurements can be (A. C. Aitken, On least squares and linear combination of observations, 1935); the true
//! values of the columns are estimated with it, by `V S^T C^-1` of the differences, and `S` is taken there.
//!
//! An implicit output, `0 = y(x, measurement)`, is one whose measurement is zero and has no error of its own: its row of `S` has `dy/dreading` at its
//! own sample, beside what the measurements do through the motion.

use super::chi_square::exceeded;
use super::drift::{Drift, Trend, slow_curves};
use super::fit::{Fit, MeasurementErrors, Noise, NoiseFrom, least_of};
use super::loss::Loss;
use super::sensitivity::Sensitivity;
use super::task::Task;
use super::whitening::{ColumnErrors, Recursion, Whitening};
use super::{Lost, Signals};
use nalgebra::{DMatrix, DVector};

/// No output is believed to be better than this, in its unit.
const LEAST: f64 = 1e-9;

/// The variances on the diagonal are at least this part of the largest: below it nothing is left of them in doubles.
const SMALLEST: f64 = 1e-14;

/// The weights of the differences of a window.
#[derive(Clone, Debug)]
pub(super) struct Weights {
    /// The unit of weighted differences: of an error of this size of one measurement among independent ones nothing changes.
    unit: f64,
    /// `C = L L^T`.
    factor: Whitening,
    /// What is added to the variance of each measurement's own error, for `C` to have a factor in doubles.
    least: f64,
    /// What is added to differences taken with the columns as they are believed to be, to make them those of the
    /// columns as measured.
    pub offset: DVector<f64>,
    sensitivity: Sensitivity,
    /// The errors of each column of the sensitivities; neighbours that rounding has made equal have one error.
    columns: ColumnErrors,
    /// The errors of the outputs.
    outputs: Vec<MeasurementErrors>,
    /// The places of differences that were not measured, in their order: the variance of their error is infinite.
    unmeasured: Vec<usize>,
}

/// The columns that drive the model and have errors.
pub(super) fn noisy_columns(task: &Task<'_>) -> Vec<usize> {
    let names = task.signals.names();
    let erring = |column: &usize| task.errors.get(&names[*column]).is_some_and(|errors| !errors.are_none());
    task.full.columns.iter().copied().filter(erring).collect()
}

/// Whether the differences have to be weighted: a column that drives the model has errors, or an output has others than its fellows.
pub(super) fn are_needed(task: &Task<'_>) -> bool {
    let common = task.common_errors();
    let own = |name: &String| task.errors.get(name).is_some_and(|errors| *errors != common);
    let is_stated = task.noise != Noise::Unstated;
    task.full.outputs.iter().any(own)
        || !noisy_columns(task).is_empty()
        || (is_stated && task.full.has_implicit())
}

impl Weights {
    /// Of a window, from the state at the first of its times and the columns as they are believed to be; `taken_off` is what was taken
    /// off the measurements for that. Of differences at the places `unmeasured`, which increase, nothing is known.
    ///
    /// # Errors
    /// Where the model cannot be followed.
    pub fn of(
        task: &Task<'_>,
        (start, times): (&[f64], &[f64]),
        unmeasured: Vec<usize>,
        taken_off: Option<&DVector<f64>>,
        read: &Signals,
    ) -> Result<Weights, Lost> {
        let columns = noisy_columns(task);
        let names = task.signals.names();
        let errors: Vec<MeasurementErrors> =
            columns.iter().map(|column| task.errors[&names[*column]]).collect();
        let sensitivity = Sensitivity::of(&task.full_flow(), start, times, columns)?;
        let rows = sensitivity.first..sensitivity.first + sensitivity.rows;
        // an implicit output has no error of its own: a contact that creeps through a step of the resolution errs from one half of it to the other,
        // and neighbours with one error would foretell differences that are not there
        let one_by_one = task.full.has_implicit();
        let of = |column: &usize| match one_by_one {
            true => (0..rows.len()).map(|row| row..row + 1).collect(),
            false => runs(&read.column(*column)[rows.clone()]),
        };
        let runs = sensitivity.columns.iter().map(of).collect();
        let outputs: Vec<MeasurementErrors> =
            (0..task.full.outputs.len()).map(|output| task.output_errors(output)).collect();
        let columns = ColumnErrors { errors, runs };
        let offset = match taken_off {
            Some(errors) => sensitivity.times(errors),
            None => DVector::zeros(sensitivity.samples.len() * task.full.outputs.len()),
        };
        let time = times[0];
        let lost =
            || Lost { time, why: "the errors of the measurements have no covariance in doubles".to_owned() };
        let recursion = Recursion { sensitivity: &sensitivity, columns: &columns };
        let mut variances = recursion.variances();
        variances.iter_mut().enumerate().for_each(|(i, variance)| *variance += own_variance(&outputs, i));
        unmeasured.iter().for_each(|place| variances[*place] = 0.0);
        if variances.iter().any(|value| !value.is_finite()) {
            return Err(lost());
        }
        let least = SMALLEST * variances.iter().copied().fold(0.0, f64::max);
        let own = |i: usize| match unmeasured.binary_search(&i) {
            Ok(_) => f64::INFINITY,
            Err(_) => own_variance(&outputs, i) + least,
        };
        let factor = recursion.whitening(&own).ok_or_else(lost)?;
        Ok(Weights { unit: task.sigma, factor, least, offset, sensitivity, columns, outputs, unmeasured })
    }

    fn is_measured(&self, place: usize) -> bool {
        self.unmeasured.binary_search(&place).is_err()
    }

    fn recursion(&self) -> Recursion<'_> {
        Recursion { sensitivity: &self.sensitivity, columns: &self.columns }
    }

    /// Differences in units in which their errors are independent and alike, `unit` each.
    pub fn weighted(&self, differences: &DVector<f64>) -> DVector<f64> {
        self.factor.whitened(&self.recursion(), differences) * self.unit
    }

    /// The same for each column.
    pub fn weighted_slopes(&self, slopes: &DMatrix<f64>) -> DMatrix<f64> {
        each_column(slopes, |column| self.weighted(column))
    }

    /// The derivative of half the square of weighted differences by the differences.
    pub fn back(&self, weighted: &DVector<f64>) -> DVector<f64> {
        self.factor.back(&self.recursion(), weighted) * self.unit
    }

    /// The most likely errors of the columns' samples, from the weighted differences.
    pub fn likely_errors(&self, weighted: &DVector<f64>) -> DVector<f64> {
        let pull = self.sensitivity.transposed_times(&self.back(weighted)) / (self.unit * self.unit);
        let rows = self.sensitivity.rows;
        let mut likely = DVector::zeros(pull.len());
        for (column, errors) in self.columns.errors.iter().enumerate() {
            let first = column * rows;
            for j in first..first + rows {
                likely[j] += errors.normal * errors.normal * pull[j];
            }
            if errors.rounding > 0.0 {
                for run in &self.columns.runs[column] {
                    let places = first + run.start..first + run.end;
                    let sum: f64 = places.clone().map(|j| pull[j]).sum();
                    places.for_each(|j| likely[j] += errors.rounding * errors.rounding / 12.0 * sum);
                }
            }
        }
        likely
    }

    /// The measurements without such errors.
    pub fn without(&self, read: &Signals, errors: &DVector<f64>) -> Signals {
        let Sensitivity { columns, first, rows, .. } = &self.sensitivity;
        let mut signals = read.clone();
        for (place, column) in columns.iter().enumerate() {
            signals.take_off(*column, *first, &errors.as_slice()[place * rows..(place + 1) * rows]);
        }
        signals
    }

    /// Whether the weighted differences at the best state, with their weighted derivatives, are explained; `computed` is what the
    /// computation may add to a difference, `degrees` the number of differences less that of unknowns.
    ///
    /// What rounding and computation add may be correlated in the worst way: that much is taken off before normal errors have to explain
    /// the rest, as where the errors are white. Differences are weighted anew for it, with the computation's part as an
    /// error of each: weights that know of none would make much of it.
    ///
    /// A robust loss leaves out what no normal error reaches; where that is more than a tenth nothing fits.
    pub fn fit(
        &self,
        left: &DVector<f64>,
        slopes: &DMatrix<f64>,
        computed: f64,
        degrees: usize,
        (loss, alarm): (Loss, f64),
    ) -> Fit {
        let (mut left, mut slopes) = (left.clone(), slopes.clone());
        let outliers: Vec<usize> =
            (0..left.len()).filter(|i| loss.is_outlier(left[*i], self.unit, computed)).collect();
        for place in &outliers {
            left[*place] = 0.0;
            slopes.row_mut(*place).fill(0.0);
        }
        let out = outliers.len();
        let degrees = degrees.saturating_sub(out);
        let chi_square = left.norm_squared() / (self.unit * self.unit);
        let (rest, drift) = self.unexplained(&left, &slopes, computed).unwrap_or((f64::NAN, None));
        let large = match rest {
            rest if rest <= 0.0 => 1.0,
            rest => exceeded(rest * rest, degrees as f64),
        };
        let probability = least_of([Some(large), drift.map(|own| own.probability)]);
        let (sigma, from, measurements) = (self.unit, NoiseFrom::Stated, left.len() - self.unmeasured.len());
        let fit = Fit {
            chi_square,
            degrees,
            probability,
            outliers: out,
            measurements,
            squares: Some(large),
            neighbours: None,
            drift,
            sigma,
            from,
            fits: false,
        };
        Fit { fits: degrees > 0 && !fit.has_outliers() && probability >= alarm, ..fit }
    }

    /// How long what normal errors have to explain is, and how far it drifts.
    fn unexplained(
        &self,
        left: &DVector<f64>,
        slopes: &DMatrix<f64>,
        computed: f64,
    ) -> Option<(f64, Option<Drift>)> {
        let recursion = self.recursion();
        let own = |i: usize| match self.is_measured(i) {
            true => own_variance(&self.outputs, i) + self.least + computed * computed,
            false => f64::INFINITY,
        };
        let factor = recursion.whitening(&own)?;
        let again = |column: &DVector<f64>| {
            factor.whitened(&recursion, &self.factor.coloured(&recursion, &(column / self.unit)))
        };
        let left = again(left);
        // the best state by these weights is another, a little
        let directions = each_column(slopes, again).qr().q();
        let left = &left - &directions * directions.tr_mul(&left);
        let (diagonal, runs) = factor.norms(&recursion);
        let own: f64 = (0..left.len())
            .filter(|i| self.is_measured(*i))
            .map(|i| {
                let errors = self.outputs[i % self.outputs.len()];
                if errors.are_none() {
                    // of an output without errors of its own: by those that reach it
                    return diagonal[i] * computed * computed;
                }
                let variance = own_variance(&self.outputs, i) + computed * computed;
                (errors.rounding / 2.0 + computed).powi(2) / variance
            })
            .sum();
        let mut allowed = own.sqrt();
        for (errors, runs) in self.columns.errors.iter().zip(&runs).filter(|(own, _)| own.rounding > 0.0) {
            let together: f64 = runs.iter().map(|norm| errors.rounding / 2.0 * norm).sum();
            allowed += together.min((3.0 * runs.len() as f64).sqrt());
        }
        let rest = left.norm() - allowed;
        let outputs = self.outputs.len();
        let curves = |output: usize| {
            let curves = slow_curves(left.len(), (outputs, output, 0), |place| self.is_measured(place))?;
            Some(each_column(&curves, |column| factor.whitened(&recursion, column)))
        };
        let trend = Trend { residuals: &left, followed: &directions, outputs, coherent: allowed };
        rest.is_finite().then(|| (rest, trend.drift(curves)))
    }
}

/// The variance of a measurement's own error, by its place among the differences.
fn own_variance(outputs: &[MeasurementErrors], place: usize) -> f64 {
    outputs[place % outputs.len()].variance().max(LEAST * LEAST)
}

fn each_column(matrix: &DMatrix<f64>, of: impl Fn(&DVector<f64>) -> DVector<f64>) -> DMatrix<f64> {
    let mut all = matrix.clone();
    for mut column in all.column_iter_mut() {
        let found = of(&column.clone_owned());
        column.copy_from(&found);
    }
    all
}

/// The stretches of equal neighbours.
fn runs(values: &[f64]) -> Vec<std::ops::Range<usize>> {
    let mut runs = Vec::new();
    let mut first = 0;
    for i in 1..=values.len() {
        if values.get(i) != values.get(first) {
            runs.push(first..i);
            first = i;
        }
    }
    runs
}

#[cfg(test)]
mod tests;
