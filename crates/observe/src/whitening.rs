//! Differences in units in which their errors are independent and alike, one sample after the other.
//!
//! Errors of the columns that drive a model reach all later samples, so that the covariance `C` of the differences is full; its factor is taken
//! without it. The error of the state, and those of the samples that carry the curves at a time, are the state of a linear system that is driven by the errors
//! of the samples that come in: a Kalman filter's innovations, each by its own deviation, are `L^-1` of the differences, `C = L L^T`
//! (T. Kailath, An innovations approach to least-squares estimation, 1968), and its recursion run backwards is `L^-T`. The work grows as the number of
//! samples. The filter keeps a root of its covariance (J. E. Potter, in G. J. Bierman, Factorization Methods for Discrete Sequential
//! Estimation, 1977, section II.8).
//!
//! Neighbours that rounding has made equal have one error: the last one of each column is kept in the state until the measurement changes.

use super::fit::MeasurementErrors;
use super::sensitivity::Sensitivity;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// The errors of the samples of the columns.
#[derive(Clone, Debug)]
pub(super) struct ColumnErrors {
    /// Of each column.
    pub errors: Vec<MeasurementErrors>,
    /// For each column the rows that are one measurement.
    pub runs: Vec<Vec<Range<usize>>>,
}

impl ColumnErrors {
    /// The deviation of what rounding does to a measurement.
    fn rounding(&self, column: usize) -> f64 {
        self.errors[column].rounding / 12f64.sqrt()
    }

    /// The run of a row.
    fn run(&self, column: usize, row: usize) -> usize {
        self.runs[column].partition_point(|run| run.end <= row)
    }

    /// Whether a row is the same measurement as the one before.
    fn goes_on(&self, column: usize, row: usize) -> bool {
        self.runs[column].get(self.run(column, row)).is_some_and(|run| run.start < row)
    }
}

/// A difference in the recursion: its innovation's variance, and what of it the state takes.
#[derive(Clone, Debug)]
struct Innovation {
    variance: f64,
    gain: DVector<f64>,
}

/// The factor of a covariance, as a recursion.
#[derive(Clone, Debug)]
pub(super) struct Whitening {
    innovations: Vec<Innovation>,
    outputs: usize,
}

/// The recursion of the errors: the state's, then of each column those of the samples that carry its curve, then of each column that of its last run.
pub(super) struct Recursion<'a> {
    pub sensitivity: &'a Sensitivity,
    pub columns: &'a ColumnErrors,
}

impl Recursion<'_> {
    fn size(&self) -> usize {
        let k = self.columns.errors.len();
        self.sensitivity.states + k * self.sensitivity.points + k
    }

    fn place(&self, column: usize, carrier: usize) -> usize {
        self.sensitivity.states + column * self.sensitivity.points + carrier
    }

    fn run_place(&self, column: usize) -> usize {
        self.place(self.columns.errors.len(), 0) + column
    }

    fn outputs(&self) -> usize {
        self.sensitivity.samples.first().map_or(0, |seen| seen.by_states.nrows())
    }

    /// The derivative of a difference by the state.
    fn seen(&self, sample: usize, output: usize) -> DVector<f64> {
        let seen = &self.sensitivity.samples[sample];
        let mut row = DVector::zeros(self.size());
        row.rows_mut(0, self.sensitivity.states).copy_from(&seen.by_states.row(output).transpose());
        for column in 0..self.columns.errors.len() {
            row[self.place(column, seen.own - seen.start)] += seen.by_columns[(output, column)];
        }
        row
    }

    /// The rows that come in between a sample and the next.
    fn coming(&self, sample: usize) -> Range<usize> {
        let start = |sample: usize| self.sensitivity.samples[sample].start + self.sensitivity.points;
        start(sample)..start(sample + 1)
    }

    /// Columns of states at a sample, as they are at the next: without what comes in.
    fn advance(&self, sample: usize, states: &mut DMatrix<f64>) {
        let (n, points) = (self.sensitivity.states, self.sensitivity.points);
        let response = &self.sensitivity.steps[sample].response;
        let next = response * states.rows(0, response.ncols());
        states.rows_mut(0, n).copy_from(&next);
        for row in self.coming(sample) {
            for column in 0..self.columns.errors.len() {
                for j in 1..points {
                    let moved = states.row(self.place(column, j)).into_owned();
                    states.set_row(self.place(column, j - 1), &moved);
                }
                let run = self.run_place(column);
                if !self.columns.goes_on(column, row) {
                    states.row_mut(run).fill(0.0);
                }
                let last = states.row(run).into_owned();
                states.set_row(self.place(column, points - 1), &last);
            }
        }
    }

    /// The transposed of it, on columns.
    fn back(&self, sample: usize, pulls: &mut DMatrix<f64>) {
        let (n, points) = (self.sensitivity.states, self.sensitivity.points);
        for row in self.coming(sample).rev() {
            for column in 0..self.columns.errors.len() {
                let run = self.run_place(column);
                let last = pulls.row(self.place(column, points - 1)).into_owned();
                let mut kept = pulls.row_mut(run);
                kept += last;
                if !self.columns.goes_on(column, row) {
                    kept.fill(0.0);
                }
                for j in (1..points).rev() {
                    let moved = pulls.row(self.place(column, j - 1)).into_owned();
                    pulls.set_row(self.place(column, j), &moved);
                }
                pulls.row_mut(self.place(column, 0)).fill(0.0);
            }
        }
        let response = &self.sensitivity.steps[sample].response;
        let mut before = response.tr_mul(&pulls.rows(0, n));
        let mut carried = before.rows_mut(n, response.ncols() - n);
        carried += pulls.rows(n, response.ncols() - n);
        pulls.rows_mut(0, response.ncols()).copy_from(&before);
    }

    /// Where the errors of some new rows of a column enter: independent ones of each row, and one for each run that begins there.
    fn entering(&self, rows: &Range<usize>, end: usize) -> Vec<DVector<f64>> {
        let points = self.sensitivity.points;
        let mut all = Vec::new();
        for (column, errors) in self.columns.errors.iter().enumerate() {
            let at = |row: usize| self.place(column, row + points - end);
            let unit = |place: usize, size: f64| {
                let mut own = DVector::zeros(self.size());
                own[place] = size;
                own
            };
            if errors.normal > 0.0 {
                all.extend(rows.clone().map(|row| unit(at(row), errors.normal)));
            }
            if errors.rounding > 0.0 {
                let new = self.new_runs(column, rows, end);
                all.extend(new.into_iter().map(|(_, own)| own * self.columns.rounding(column)));
            }
        }
        all
    }

    /// The runs of a column that begin among some new rows, each with what an error of it of one changes in the state.
    fn new_runs(&self, column: usize, rows: &Range<usize>, end: usize) -> Vec<(usize, DVector<f64>)> {
        let points = self.sensitivity.points;
        let begins = |row: &usize| !self.columns.goes_on(column, *row);
        let one = |row: usize| {
            let run = self.columns.run(column, row);
            let mut own = DVector::zeros(self.size());
            for other in row..self.columns.runs[column][run].end.min(rows.end) {
                own[self.place(column, other + points - end)] = 1.0;
            }
            if self.columns.runs[column][run].end >= rows.end {
                own[self.run_place(column)] = 1.0;
            }
            (run, own)
        };
        rows.clone().filter(begins).map(one).collect()
    }

    /// The rows that are new at a sample.
    fn new_at(&self, sample: usize) -> Range<usize> {
        match sample {
            0 => 0..self.sensitivity.points,
            _ => self.coming(sample - 1),
        }
    }

    /// The variances of the differences, but for their own errors.
    pub fn variances(&self) -> Vec<f64> {
        let mut covariance = DMatrix::zeros(self.size(), self.size());
        let mut variances = Vec::new();
        for sample in 0..self.sensitivity.samples.len() {
            if sample > 0 {
                self.advance(sample - 1, &mut covariance);
                covariance.transpose_mut();
                self.advance(sample - 1, &mut covariance);
            }
            let new = self.new_at(sample);
            for own in self.entering(&new, new.end) {
                covariance.ger(1.0, &own, &own, 1.0);
            }
            for output in 0..self.outputs() {
                let seen = self.seen(sample, output);
                variances.push(seen.dot(&(&covariance * &seen)));
            }
        }
        variances
    }

    /// The factor of the covariance of the differences, their own errors having these variances, infinite ones where nothing was measured; none where a number is not
    /// finite. What is whitened is zero there.
    pub fn whitening(&self, own: &dyn Fn(usize) -> f64) -> Option<Whitening> {
        let (size, outputs) = (self.size(), self.outputs());
        let mut root: DMatrix<f64> = DMatrix::zeros(size, 0);
        let mut innovations = Vec::new();
        for sample in 0..self.sensitivity.samples.len() {
            if sample > 0 {
                self.advance(sample - 1, &mut root);
            }
            let new = self.new_at(sample);
            let entering = self.entering(&new, new.end);
            let kept = root.ncols();
            root = root.resize_horizontally(kept + entering.len(), 0.0);
            for (column, entering) in entering.iter().enumerate() {
                root.set_column(kept + column, entering);
            }
            if root.ncols() > size {
                root = root.transpose().qr().unpack_r().transpose();
            }
            for output in 0..outputs {
                let seen = self.seen(sample, output);
                let variance = own(innovations.len());
                if variance == f64::INFINITY {
                    // nothing was measured: the state takes nothing of it
                    innovations.push(Innovation { variance, gain: DVector::zeros(size) });
                    continue;
                }
                let part = root.tr_mul(&seen);
                let whole = variance + part.norm_squared();
                let gain = &root * &part / whole;
                root.ger(-1.0 / (1.0 + (variance / whole).sqrt()), &gain, &part, 1.0);
                if !(whole > 0.0 && whole.is_finite()) {
                    return None;
                }
                innovations.push(Innovation { variance: whole, gain });
            }
        }
        Some(Whitening { innovations, outputs })
    }
}

impl Whitening {
    /// The recursion over all differences: `of` is given the place of each and what is expected of it, and says how far it is off that.
    fn forwards(&self, recursion: &Recursion<'_>, mut of: impl FnMut(usize, f64) -> f64) {
        let mut state = DMatrix::zeros(recursion.size(), 1);
        for (place, innovation) in self.innovations.iter().enumerate() {
            let (sample, output) = (place / self.outputs, place % self.outputs);
            if output == 0 && sample > 0 {
                recursion.advance(sample - 1, &mut state);
            }
            let off = of(place, recursion.seen(sample, output).dot(&state.column(0)));
            state.column_mut(0).axpy(off, &innovation.gain, 1.0);
        }
    }

    /// `L^-1` of differences.
    pub fn whitened(&self, recursion: &Recursion<'_>, differences: &DVector<f64>) -> DVector<f64> {
        let mut whitened = DVector::zeros(differences.len());
        self.forwards(recursion, |place, expected| {
            let off = differences[place] - expected;
            whitened[place] = off / self.innovations[place].variance.sqrt();
            off
        });
        whitened
    }

    /// `L` of what is white.
    pub fn coloured(&self, recursion: &Recursion<'_>, white: &DVector<f64>) -> DVector<f64> {
        let mut differences = DVector::zeros(white.len());
        self.forwards(recursion, |place, expected| {
            let variance = self.innovations[place].variance;
            if variance == f64::INFINITY {
                return 0.0;
            }
            let off = white[place] * variance.sqrt();
            differences[place] = expected + off;
            off
        });
        differences
    }

    /// `L^-T` of something.
    pub fn back(&self, recursion: &Recursion<'_>, white: &DVector<f64>) -> DVector<f64> {
        let mut pulls = DVector::zeros(white.len());
        let mut state = DMatrix::zeros(recursion.size(), 1);
        for (place, innovation) in self.innovations.iter().enumerate().rev() {
            let (sample, output) = (place / self.outputs, place % self.outputs);
            let pull = white[place] / innovation.variance.sqrt() + innovation.gain.dot(&state.column(0));
            pulls[place] = pull;
            state.column_mut(0).axpy(-pull, &recursion.seen(sample, output), 1.0);
            if output == 0 && sample > 0 {
                recursion.back(sample - 1, &mut state);
            }
        }
        pulls
    }

    /// The diagonal of `C^-1`; and of each column and run how large `L^-1` of what an error of one of it changes is.
    pub fn norms(&self, recursion: &Recursion<'_>) -> (DVector<f64>, Vec<Vec<f64>>) {
        let size = recursion.size();
        let mut diagonal = DVector::zeros(self.innovations.len());
        let mut runs: Vec<Vec<f64>> =
            recursion.columns.runs.iter().map(|runs| vec![0.0; runs.len()]).collect();
        // how much the squares of all later innovations make of an error of the state
        let mut later: DMatrix<f64> = DMatrix::zeros(size, size);
        for (place, innovation) in self.innovations.iter().enumerate().rev() {
            let (sample, output) = (place / self.outputs, place % self.outputs);
            let taken = &later * &innovation.gain;
            let square = innovation.gain.dot(&taken);
            diagonal[place] = 1.0 / innovation.variance + square;
            let seen = recursion.seen(sample, output);
            later.ger(-1.0, &seen, &taken, 1.0);
            later.ger(-1.0, &taken, &seen, 1.0);
            later.ger(diagonal[place], &seen, &seen, 1.0);
            if output > 0 {
                continue;
            }
            let new = recursion.new_at(sample);
            for (column, runs) in runs.iter_mut().enumerate() {
                for (run, own) in recursion.new_runs(column, &new, new.end) {
                    runs[run] = own.dot(&(&later * &own)).max(0.0).sqrt();
                }
            }
            if sample > 0 {
                recursion.back(sample - 1, &mut later);
                later.transpose_mut();
                recursion.back(sample - 1, &mut later);
            }
        }
        (diagonal, runs)
    }
}
