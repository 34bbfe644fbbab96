//! What is known over time: columns of measurements, and the curves that run through them.

use super::Interpolation;
use num_dual::{Dual64, DualNum};

/// So many samples carry the curve at a time at most: its error is of this order in the time between two samples.
const POINTS: usize = 8;

/// Why a table is no set of signals.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs)] // names and messages say it
pub enum SignalError {
    /// There are no rows.
    #[error("there are no samples")]
    Empty,
    /// A column is shorter or longer than the times.
    #[error("column {name} has {found} values for {times} times")]
    Length { name: String, found: usize, times: usize },
    /// A number is infinite or none.
    #[error("column {name} holds {value} in row {row}")]
    NotFinite { name: String, row: usize, value: f64 },
    /// A time does not follow the one before.
    #[error("the time in row {row} does not follow the one before")]
    Order { row: usize },
}

/// Columns of numbers over one column of times (s), and between the times the curves through the nearest samples.
///
/// A column in which a sample was not measured, which is NaN there, has no curve: it is one of outputs, which are compared sample by sample.
#[derive(Clone, Debug)]
pub struct Signals {
    times: Vec<f64>,
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
    /// For each run of neighbouring samples the weights of Lagrange's polynomials, `1/prod (t_i - t_j)`, in a unit of time
    /// that keeps them near one.
    weights: Vec<Vec<f64>>,
    points: usize,
    interpolation: Interpolation,
    unit: f64,
    /// The samples that are shown; those beside them carry the curves alone.
    shown: std::ops::Range<usize>,
}

impl Signals {
    /// Of times and named columns.
    ///
    /// # Errors
    /// Where the times do not increase, a number is not finite, or a column's length differs.
    pub fn new(times: Vec<f64>, columns: Vec<(String, Vec<f64>)>) -> Result<Signals, SignalError> {
        for (name, column) in &columns {
            if let Some(row) = column.iter().position(|value| !value.is_finite()) {
                return Err(SignalError::NotFinite { name: name.clone(), row: row + 1, value: column[row] });
            }
        }
        Signals::sparse(times, columns)
    }

    /// The same of columns in which a sample that was not measured is NaN.
    ///
    /// # Errors
    /// As for [`Signals::new`], but for NaN.
    pub fn sparse(times: Vec<f64>, columns: Vec<(String, Vec<f64>)>) -> Result<Signals, SignalError> {
        if times.is_empty() {
            return Err(SignalError::Empty);
        }
        if let Some(row) = times.iter().position(|time| !time.is_finite()) {
            return Err(SignalError::NotFinite { name: "time".to_owned(), row: row + 1, value: times[row] });
        }
        if let Some(row) = times.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(SignalError::Order { row: row + 2 });
        }
        for (name, column) in &columns {
            if column.len() != times.len() {
                return Err(SignalError::Length {
                    name: name.clone(),
                    found: column.len(),
                    times: times.len(),
                });
            }
            if let Some(row) = column.iter().position(|value| value.is_infinite()) {
                return Err(SignalError::NotFinite { name: name.clone(), row: row + 1, value: column[row] });
            }
        }
        let spread = times[times.len() - 1] - times[0];
        let unit = if spread > 0.0 { spread / (times.len() - 1) as f64 } else { 1.0 };
        let (names, columns) = columns.into_iter().unzip();
        let shown = 0..times.len();
        let interpolation = Interpolation::default();
        let bare =
            Signals { times, names, columns, weights: Vec::new(), points: 0, interpolation, unit, shown };
        Ok(bare.interpolated(interpolation))
    }

    /// The same with another interpolation between samples.
    pub fn interpolated(self, interpolation: Interpolation) -> Signals {
        let points = interpolation.points(POINTS).min(self.times.len());
        let weight = |run: &[f64], i: usize| -> f64 {
            let others = run.iter().enumerate().filter(|(j, _)| *j != i);
            1.0 / others.map(|(_, other)| (run[i] - other) / self.unit).product::<f64>()
        };
        let runs = self.times.windows(points);
        let weights = runs.map(|run| (0..points).map(|i| weight(run, i)).collect()).collect();
        Signals { weights, points, interpolation, ..self }
    }

    /// How columns go from one sample to the next.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// Whether columns jump at samples, so that what is followed has to be so from one to the next.
    pub(super) fn jump(&self) -> bool {
        self.interpolation == Interpolation::Hold
    }

    /// Whether columns have no kinks at samples.
    pub(super) fn is_smooth(&self) -> bool {
        self.interpolation == Interpolation::Polynomial
    }

    /// Whether each sample of a column was measured.
    pub fn is_whole(&self, place: usize) -> bool {
        self.column(place).iter().all(|value| !value.is_nan())
    }

    /// The same with some samples shown; the others only carry the curves beside them: a part of a longer recording.
    ///
    /// # Panics
    /// When there are no such samples.
    pub fn showing(self, shown: std::ops::Range<usize>) -> Signals {
        assert!(shown.start < shown.end && shown.end <= self.times.len(), "{shown:?}");
        Signals { shown, ..self }
    }

    /// The times of the samples, in s.
    pub fn times(&self) -> &[f64] {
        &self.times[self.shown.clone()]
    }

    /// The mean time between two samples, in s; one where there is a single one.
    pub(super) fn between(&self) -> f64 {
        self.unit
    }

    /// The place of a column.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|other| other == name)
    }

    /// The names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The samples of a column.
    pub fn column(&self, place: usize) -> &[f64] {
        &self.columns[place][self.shown.clone()]
    }

    /// The same with a column multiplied by a factor.
    pub(super) fn scaled(&self, place: usize, factor: f64) -> Signals {
        let mut scaled = self.clone();
        scaled.columns[place].iter_mut().for_each(|value| *value *= factor);
        scaled
    }

    /// The same with something taken off a column, from a row on.
    pub(super) fn take_off(&mut self, place: usize, first: usize, errors: &[f64]) {
        for (value, error) in self.columns[place][first..].iter_mut().zip(errors) {
            *value -= error;
        }
    }

    /// The place of a row among all samples, those that are not shown included.
    pub(super) fn sample(&self, row: usize) -> usize {
        self.shown.start + row
    }

    /// How many samples carry the curve at a time.
    pub(super) fn carriers(&self) -> usize {
        self.points
    }

    /// The first of the samples that carry the curves just after a time.
    pub(super) fn first_carrier(&self, time: f64) -> usize {
        let last = self.times.len() - self.points;
        let after = self.times.partition_point(|other| *other <= time);
        after.saturating_sub(self.points.div_ceil(2)).min(last)
    }

    /// The weight of each of the samples from `start` on in the value of their curve at a time.
    pub(super) fn weights_from(&self, start: usize, time: f64) -> Vec<f64> {
        let mut basis = [0.0; POINTS];
        self.basis_from(start, time, &mut basis);
        basis[..self.points].to_vec()
    }

    /// The values of some columns at a time; outside the samples, of the polynomials at the nearest end.
    pub fn at(&self, places: &[usize], time: f64, values: &mut [f64]) {
        let mut basis = [0.0; POINTS];
        let start = self.basis(time, &mut basis);
        for (value, place) in values.iter_mut().zip(places) {
            let samples = &self.columns[*place][start..start + self.points];
            *value = samples.iter().zip(&basis).map(|(sample, weight)| sample * weight).sum();
        }
    }

    /// The values of some columns at a time that carries derivatives, with theirs.
    pub(super) fn along<T: DualNum<Primitive = f64> + Copy>(&self, places: &[usize], time: T) -> Vec<T> {
        let mut basis = [T::from(0.0); POINTS];
        let start = self.basis(time, &mut basis);
        let value = |place: &usize| {
            let samples = &self.columns[*place][start..start + self.points];
            samples.iter().zip(&basis).fold(T::from(0.0), |sum, (sample, weight)| sum + *weight * *sample)
        };
        places.iter().map(value).collect()
    }

    /// The rates of change of some columns at a time, per s.
    pub fn rates_at(&self, places: &[usize], time: f64, rates: &mut [f64]) {
        let mut basis = [Dual64::from(0.0); POINTS];
        let start = self.basis(Dual64::from(time).derivative(), &mut basis);
        for (rate, place) in rates.iter_mut().zip(places) {
            let samples = &self.columns[*place][start..start + self.points];
            *rate = samples.iter().zip(&basis).map(|(sample, weight)| sample * weight.eps).sum();
        }
    }

    /// The values of Lagrange's polynomials at a time, and the first of the samples that they belong to.
    fn basis<T: DualNum<Primitive = f64> + Copy>(&self, time: T, basis: &mut [T; POINTS]) -> usize {
        let start = self.first_carrier(time.re());
        self.basis_from(start, time, basis);
        start
    }

    fn basis_from<T: DualNum<Primitive = f64> + Copy>(&self, start: usize, time: T, basis: &mut [T; POINTS]) {
        let nodes = &self.times[start..start + self.points];
        for (i, value) in basis.iter_mut().enumerate().take(self.points) {
            let mut product = T::from(self.weights[start][i]);
            for (j, node) in nodes.iter().enumerate() {
                if j != i {
                    product *= (time - *node) / self.unit;
                }
            }
            *value = product;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight points determine a polynomial of degree seven: between them it is met to rounding, its derivative as well.
    #[test]
    fn a_polynomial_of_degree_seven_is_its_own_curve() {
        let curve = |t: f64| 1.0 + t - 3.0 * t.powi(2) + 0.5 * t.powi(7);
        let slope = |t: f64| 1.0 - 6.0 * t + 3.5 * t.powi(6);
        // irregular times
        let times: Vec<f64> = (0..30).map(|i| f64::from(i) / 20.0 + 0.01 * f64::from(i * i % 7)).collect();
        let values = times.iter().map(|t| curve(*t)).collect();
        let signals = Signals::new(times, vec![("x".to_owned(), values)]).unwrap();
        for i in 0..100 {
            let t = 1.5 * f64::from(i) / 100.0;
            let (mut value, mut rate) = ([0.0], [0.0]);
            signals.at(&[0], t, &mut value);
            signals.rates_at(&[0], t, &mut rate);
            assert!((value[0] - curve(t)).abs() < 1e-12, "{t}: {} and {}", value[0], curve(t));
            assert!((rate[0] - slope(t)).abs() < 1e-9, "{t}: {} and {}", rate[0], slope(t));
        }
    }

    #[test]
    fn what_is_no_signal_is_refused() {
        let refused = |times: &[f64], values: &[f64]| {
            Signals::new(times.to_vec(), vec![("s1".to_owned(), values.to_vec())]).unwrap_err().to_string()
        };
        assert_eq!(refused(&[], &[]), "there are no samples");
        assert_eq!(refused(&[0.0, 1.0], &[1.0]), "column s1 has 1 values for 2 times");
        assert_eq!(refused(&[0.0, 1.0], &[1.0, f64::NAN]), "column s1 holds NaN in row 2");
        assert_eq!(refused(&[0.0, 1.0, 1.0], &[1.0; 3]), "the time in row 3 does not follow the one before");
    }

    #[test]
    fn a_line_and_a_step() {
        let columns =
            vec![("x".to_owned(), vec![1.0, 3.0, -1.0]), ("y".to_owned(), vec![f64::NAN, 0.0, f64::NAN])];
        let signals = Signals::sparse(vec![0.0, 1.0, 3.0], columns).unwrap();
        assert!(signals.is_whole(0) && !signals.is_whole(1));
        let at = |interpolation: Interpolation, time: f64| {
            let mut value = [0.0];
            signals.clone().interpolated(interpolation).at(&[0], time, &mut value);
            value[0]
        };
        let line = |time| at(Interpolation::Linear, time);
        assert_eq!([0.0, 0.25, 1.0, 2.0, 3.0].map(line), [1.0, 1.5, 3.0, 1.0, -1.0]);
        let step = |time| at(Interpolation::Hold, time);
        assert_eq!([0.0, 0.9, 1.0, 2.9, 3.0].map(step), [1.0, 1.0, 3.0, 3.0, -1.0]);
    }

    #[test]
    fn few_samples_make_a_curve_of_low_degree() {
        let signals = Signals::new(vec![0.0, 2.0], vec![("x".to_owned(), vec![1.0, 5.0])]).unwrap();
        let mut value = [0.0];
        signals.at(&[0], 0.5, &mut value);
        assert_eq!(value[0], 2.0);
    }
}
