//! What the errors of all columns make of the differences in a window: a covariance that is not white, and differences in units in
//! which it is.
//!
//! An output's reading has an error of its own. A column that drives the model errs too, and its errors reach all later samples through
//! the model: with `S` the derivative of what is expected by the samples of the columns, and `V` the covariance of their errors, the
//! differences of the true state have the covariance `C = R + S V S^T`. Least squares with `W` for which `W C W^T = 1` is as good as an
//! estimate from these readings can be (A. C. Aitken, On least squares and linear combination of observations, 1935); the true
//! values of the columns are estimated with it, by `V S^T C^-1` of the differences, and `S` is taken there.
//!
//! An implicit output, `0 = y(x, reading)`, is one whose reading is zero and has no error of its own: its row of `S` has `dy/dreading` at its
//! own sample, beside what the readings do through the motion.

use super::chi_square::exceeded;
use super::fit::{Fit, Noise, NoiseFrom, ReadingErrors};
use super::loss::Loss;
use super::sensitivity::Sensitivity;
use super::task::Task;
use super::{Lost, Signals};
use nalgebra::{Cholesky, DMatrix, DVector};

/// No output is believed to be better than this, in its unit.
const LEAST: f64 = 1e-9;

/// The variances on the diagonal are at least this part of the largest: below it nothing is left of them in doubles.
const SMALLEST: f64 = 1e-14;

/// The weights of the differences of a window.
#[derive(Clone, Debug)]
pub(super) struct Weights {
    /// The unit of weighted differences: of an error of this size of one reading among independent ones nothing changes.
    unit: f64,
    /// `C = L L^T`.
    root: DMatrix<f64>,
    /// `unit L^-1`.
    inverse: DMatrix<f64>,
    /// What is added to differences that are taken with the columns as they are believed to be, for them to be those of the
    /// columns as they are read.
    pub offset: DVector<f64>,
    sensitivity: Sensitivity,
    /// The errors of each column of the sensitivities.
    errors: Vec<ReadingErrors>,
    /// For each column the rows that are one reading: neighbours that rounding has made equal have one error.
    runs: Vec<Vec<std::ops::Range<usize>>>,
    /// The errors of the outputs.
    outputs: Vec<ReadingErrors>,
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
    /// off the readings for that.
    ///
    /// # Errors
    /// Where the model cannot be followed.
    pub fn of(
        task: &Task<'_>,
        start: &[f64],
        times: &[f64],
        taken_off: Option<&DVector<f64>>,
        read: &Signals,
    ) -> Result<Weights, Lost> {
        let columns = noisy_columns(task);
        let names = task.signals.names();
        let errors: Vec<ReadingErrors> = columns.iter().map(|column| task.errors[&names[*column]]).collect();
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
        let outputs = (0..task.full.outputs.len()).map(|output| task.output_errors(output)).collect();
        let offset = match taken_off {
            Some(errors) => sensitivity.times(errors),
            None => DVector::zeros(sensitivity.slopes.nrows()),
        };
        let (root, inverse) = (DMatrix::zeros(0, 0), DMatrix::zeros(0, 0));
        let mut weights =
            Weights { unit: task.sigma, root, inverse, offset, sensitivity, errors, runs, outputs };
        let time = times[0];
        let lost =
            || Lost { time, why: "the errors of the readings have no covariance in doubles".to_owned() };
        let mut covariance = weights.covariance();
        let least = SMALLEST * covariance.diagonal().max();
        for i in 0..covariance.nrows() {
            covariance[(i, i)] += least;
        }
        if covariance.iter().any(|value| !value.is_finite()) {
            return Err(lost());
        }
        weights.root = Cholesky::new(covariance).ok_or_else(lost)?.unpack();
        let unit = DMatrix::identity(weights.root.nrows(), weights.root.nrows()) * weights.unit;
        weights.inverse = weights.root.solve_lower_triangular(&unit).ok_or_else(lost)?;
        Ok(weights)
    }

    fn covariance(&self) -> DMatrix<f64> {
        let Sensitivity { slopes, rows, .. } = &self.sensitivity;
        let mut scaled = slopes.clone();
        let mut rounded: Vec<DVector<f64>> = Vec::new();
        for (column, errors) in self.errors.iter().enumerate() {
            let mut own = scaled.columns_mut(column * rows, *rows);
            own *= errors.normal;
            if errors.rounding > 0.0 {
                let size = errors.rounding / 12f64.sqrt();
                rounded.extend(self.run_slopes(column).map(|slope| slope * size));
            }
        }
        let mut covariance = &scaled * scaled.transpose();
        if !rounded.is_empty() {
            let rounded = DMatrix::from_columns(&rounded);
            covariance += &rounded * rounded.transpose();
        }
        for i in 0..covariance.nrows() {
            covariance[(i, i)] += self.own_variance(i);
        }
        covariance
    }

    /// The variance of a reading's own error, by its place among the differences.
    fn own_variance(&self, place: usize) -> f64 {
        self.outputs[place % self.outputs.len()].variance().max(LEAST * LEAST)
    }

    /// What one error of each run of equal readings of a column changes.
    fn run_slopes(&self, column: usize) -> impl Iterator<Item = DVector<f64>> + '_ {
        let first = column * self.sensitivity.rows;
        self.runs[column].iter().map(move |run| {
            let own = self.sensitivity.slopes.columns(first + run.start, run.len());
            own.column_sum()
        })
    }

    /// Differences in units in which their errors are independent and alike, `unit` each.
    pub fn weighted(&self, differences: &DVector<f64>) -> DVector<f64> {
        &self.inverse * differences
    }

    /// The same for each column.
    pub fn weighted_slopes(&self, slopes: &DMatrix<f64>) -> DMatrix<f64> {
        &self.inverse * slopes
    }

    /// The derivative of half the square of weighted differences by the differences.
    pub fn back(&self, weighted: &DVector<f64>) -> DVector<f64> {
        self.inverse.tr_mul(weighted)
    }

    /// The most likely errors of the columns' samples, from the weighted differences.
    pub fn likely_errors(&self, weighted: &DVector<f64>) -> DVector<f64> {
        let pull = self.sensitivity.slopes.tr_mul(&self.back(weighted)) / (self.unit * self.unit);
        let rows = self.sensitivity.rows;
        let mut likely = DVector::zeros(pull.len());
        for (column, errors) in self.errors.iter().enumerate() {
            let first = column * rows;
            for j in first..first + rows {
                likely[j] += errors.normal * errors.normal * pull[j];
            }
            if errors.rounding > 0.0 {
                for run in &self.runs[column] {
                    let places = first + run.start..first + run.end;
                    let sum: f64 = places.clone().map(|j| pull[j]).sum();
                    places.for_each(|j| likely[j] += errors.rounding * errors.rounding / 12.0 * sum);
                }
            }
        }
        likely
    }

    /// The readings without such errors.
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
    /// What rounding and computation add may hang together in the worst way: that much is taken off before normal errors have to explain
    /// the rest, as where the errors are white. Differences are weighted anew for it, with the computation's part as an
    /// error of each: weights that know of none would make much of it.
    ///
    /// A robust loss leaves out what no normal error reaches; more of it than a tenth is no fit.
    pub fn fit(
        &self,
        left: &DVector<f64>,
        slopes: &DMatrix<f64>,
        computed: f64,
        degrees: usize,
        (loss, alarm): (Loss, f64),
    ) -> Fit {
        let mut left = left.clone();
        let is_out = |value: &&mut f64| loss.is_outlier(**value, self.unit, computed);
        let out = left.iter_mut().filter(is_out).map(|value| *value = 0.0).count();
        let degrees = degrees.saturating_sub(out);
        let chi_square = left.norm_squared() / (self.unit * self.unit);
        let rest = self.unexplained(&left, slopes, computed).unwrap_or(f64::NAN);
        let probability = match rest {
            rest if rest <= 0.0 => 1.0,
            rest => exceeded(rest * rest, degrees as f64),
        };
        let (sigma, from, readings) = (self.unit, NoiseFrom::Stated, left.len());
        let fit = Fit {
            chi_square,
            degrees,
            probability,
            outliers: out,
            readings,
            neighbours: None,
            sigma,
            from,
            fits: false,
        };
        Fit { fits: degrees > 0 && !fit.has_outliers() && probability >= alarm, ..fit }
    }

    fn unexplained(&self, left: &DVector<f64>, slopes: &DMatrix<f64>, computed: f64) -> Option<f64> {
        let mut covariance = &self.root * self.root.transpose();
        for i in 0..covariance.nrows() {
            covariance[(i, i)] += computed * computed;
        }
        let root = Cholesky::new(covariance)?.unpack();
        let back = |matrix: DMatrix<f64>| root.solve_lower_triangular(&(&self.root * matrix / self.unit));
        let left = back(DMatrix::from_column_slice(left.len(), 1, left.as_slice()))?;
        // the best state by these weights is another, a little
        let directions = back(slopes.clone())?.qr().q();
        let left = &left - &directions * directions.tr_mul(&left);
        let n = left.len();
        let inverse = root.solve_lower_triangular(&DMatrix::identity(n, n))?;
        let own: f64 = (0..n)
            .map(|i| {
                let errors = self.outputs[i % self.outputs.len()];
                if errors.are_none() {
                    // of an output without errors of its own: by those that reach it
                    return inverse.column(i).norm_squared() * computed * computed;
                }
                (errors.rounding / 2.0 + computed).powi(2) / (self.own_variance(i) + computed * computed)
            })
            .sum();
        let mut allowed = own.sqrt();
        for (column, errors) in self.errors.iter().enumerate().filter(|(_, errors)| errors.rounding > 0.0) {
            let mut together = 0.0;
            for slope in self.run_slopes(column) {
                together += errors.rounding / 2.0 * root.solve_lower_triangular(&slope)?.norm();
            }
            allowed += together.min((3.0 * self.runs[column].len() as f64).sqrt());
        }
        Some(left.norm() - allowed)
    }
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
mod tests {
    use super::*;
    use crate::observer::{EstimateQuestion, Noise};
    use crate::system::System;
    use std::path::Path;
    use std::sync::atomic::AtomicBool;

    static NEVER: AtomicBool = AtomicBool::new(false);

    /// A point that is driven at a speed that is read: `x(t_i) = x(0) + sum of the steps`. With errors of the speed alone and two readings
    /// of x the covariance is by hand; steps are of length one and the curves of two samples are straight, so that the second
    /// reading errs by the mean of both speeds' errors.
    #[test]
    fn errors_of_a_speed_add_up_in_the_place() {
        let text =
            "system \"A driven point\"\nstate x\nparam u\ndrift f\n  x' = 0\ninput g\n  x' = 1\noutput x\n";
        let system = System::parse("point.proof", text, Path::new("")).unwrap();
        let columns = vec![("x".to_owned(), vec![0.0, 3.0]), ("u".to_owned(), vec![2.0, 2.0])];
        let signals = Signals::new(vec![0.0, 1.0], columns).unwrap();
        let question = EstimateQuestion {
            guess: vec![("x".to_owned(), 0.5)],
            inputs: vec![("g".to_owned(), "u".to_owned())],
            ..EstimateQuestion::default()
        };
        let mut task = Task::new(&system, &question, &signals, &NEVER).unwrap();
        (task.exact, task.sigma) = (false, 0.1);
        task.noise = Noise::Stated { normal: 0.1, rounding: 0.0 };
        assert!(!are_needed(&task));
        for (errors, variance) in [
            (ReadingErrors { normal: 0.2, rounding: 0.0 }, 0.2 * 0.2 / 2.0),
            // both samples are equal after rounding: they have one error
            (ReadingErrors { normal: 0.0, rounding: 0.6 }, 0.6 * 0.6 / 12.0),
        ] {
            task.errors.insert("u".to_owned(), errors);
            assert!(are_needed(&task));
            let weights = Weights::of(&task, &[0.5], signals.times(), None, &signals).unwrap();
            let covariance = &weights.root * weights.root.transpose();
            let by_hand = DMatrix::from_row_slice(2, 2, &[0.01, 0.0, 0.0, 0.01 + variance]);
            assert!((&covariance - by_hand).amax() < 1e-9, "{covariance}");
            // differences of (0, 1): the likely errors of the speed are those that regression gives
            let differences = DVector::from_vec(vec![0.0, 1.0]);
            let likely = weights.likely_errors(&weights.weighted(&differences));
            let expected = variance / (0.01 + variance);
            let mean = (likely[0] + likely[1]) / 2.0;
            assert!((mean - expected).abs() < 1e-9, "{likely}");
            assert!(
                (weights.back(&weights.weighted(&differences))[1] - 0.01 / (0.01 + variance)).abs() < 1e-9
            );
        }
    }
}
