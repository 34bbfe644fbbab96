//! Columns in which not each sample was measured, as where sensors have rates of their own.

use super::{EmptyCells, FaultRules, Record};
use crate::{Interpolation, SignalError, Signals};

/// A column with empty cells.
#[derive(Clone, Debug, PartialEq)]
pub struct SparseColumn {
    /// Its name, as models know it.
    pub column: String,
    /// In so many rows it was measured.
    pub measured: usize,
    /// For so many rows a measured value stands in the mean over these rows: itself and the empty ones behind it.
    pub stands_for: f64,
    /// What its empty cells mean.
    pub empty: EmptyCells,
}

impl Record {
    /// The record whose empty cells are settled by the rules: NaN where an output was not measured, and a value in its place where a column drives the model. Rows before the first
    /// and after the last value of such a column go, so many at either end: nobody knows what drove the model there.
    ///
    /// # Errors
    /// The name of a column of which nothing is left.
    pub(super) fn settle(
        mut self,
        rules: &FaultRules,
    ) -> Result<(Record, Vec<SparseColumn>, [usize; 2]), String> {
        let is_sparse = |values: &[f64]| values.iter().any(|value| value.is_nan());
        let mut sparse = Vec::new();
        let (mut first, mut end) = (0, self.times.len());
        for (name, values) in self.names.iter().zip(&self.columns) {
            let Some(empty) = rules.empty.get(name).copied().filter(|_| is_sparse(values)) else { continue };
            let present = |value: &f64| !value.is_nan();
            let measured = values.iter().filter(|value| present(value)).count();
            if let (EmptyCells::Interpolated, Some(begin), Some(last)) =
                (empty, values.iter().position(present), values.iter().rposition(present))
            {
                (first, end) = (first.max(begin), end.min(last + 1));
            }
            if measured == 0 {
                return Err(name.clone());
            }
            let (column, stands_for) = (name.clone(), stands_for(values));
            sparse.push(SparseColumn { column, measured, stands_for, empty });
        }
        if sparse.is_empty() {
            return Ok((self, sparse, [0, 0]));
        }
        for (name, values) in self.names.iter().zip(&mut self.columns) {
            let is_driving = rules.empty.get(name) == Some(&EmptyCells::Interpolated);
            if is_driving && is_sparse(values) {
                *values = filled(&self.times, values, rules.interpolation).ok_or_else(|| name.clone())?;
            }
        }
        let outside = [first, self.times.len() - end];
        if first >= end {
            return Err(sparse.swap_remove(0).column);
        }
        self.times = self.times[first..end].to_vec();
        self.columns.iter_mut().for_each(|column| *column = column[first..end].to_vec());
        // what was measured outside alone is measured nowhere
        match self
            .names
            .iter()
            .zip(&self.columns)
            .find(|(_, values)| values.iter().all(|value| value.is_nan()))
        {
            Some((name, _)) => Err(name.clone()),
            None => Ok((self, sparse, outside)),
        }
    }
}

impl Signals {
    /// The columns of a recording; what was not measured in a sample is NaN there.
    ///
    /// # Errors
    /// As for [`Signals::new`].
    pub fn of_record(record: &Record) -> Result<Signals, SignalError> {
        let column = |name: &String| Some((name.clone(), record.column(name)?.to_vec()));
        Signals::sparse(record.times().to_vec(), record.names().iter().filter_map(column).collect())
    }
}

/// For how many rows a measured value stands, itself and the empty ones behind it, in the mean over these rows.
fn stands_for(values: &[f64]) -> f64 {
    let places: Vec<usize> = (0..values.len()).filter(|place| !values[*place].is_nan()).collect();
    let lengths = places.windows(2).map(|pair| (pair[1] - pair[0]) as f64);
    let (squares, all) = lengths.fold((0.0, 0.0), |(squares, all), own| (squares + own * own, all + own));
    if all > 0.0 { squares / all } else { 1.0 }
}

/// A column with a value in each row, by the curve through those that it has.
fn filled(times: &[f64], values: &[f64], interpolation: Interpolation) -> Option<Vec<f64>> {
    let present = times.iter().zip(values).filter(|(_, value)| !value.is_nan());
    let (known, read): (Vec<f64>, Vec<f64>) = present.map(|(time, value)| (*time, *value)).unzip();
    let curve = Signals::new(known, vec![(String::new(), read)]).ok()?.interpolated(interpolation);
    let fill = |(time, value): (&f64, &f64)| {
        let mut at = [*value];
        if value.is_nan() {
            curve.at(&[0], *time, &mut at);
        }
        at[0]
    };
    Some(times.iter().zip(values).map(fill).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules(interpolation: Interpolation) -> FaultRules {
        let empty = [("u".to_owned(), EmptyCells::Interpolated), ("y".to_owned(), EmptyCells::NotMeasured)];
        FaultRules { empty: empty.into_iter().collect(), interpolation, ..FaultRules::default() }
    }

    fn record(u: [f64; 5], y: [f64; 5]) -> Record {
        let columns = vec![("u".to_owned(), u.to_vec()), ("y".to_owned(), y.to_vec())];
        Record::new(vec![0.0, 1.0, 2.0, 4.0, 5.0], columns).unwrap()
    }

    const NONE: f64 = f64::NAN;

    #[test]
    fn what_drives_is_filled_and_what_is_compared_is_not() {
        let sparse = record([NONE, 1.0, NONE, 4.0, NONE], [7.0, NONE, NONE, 8.0, 9.0]);
        for (interpolation, between) in
            [(Interpolation::Linear, 2.0), (Interpolation::Hold, 1.0), (Interpolation::Polynomial, 2.0)]
        {
            let (record, columns, outside) = sparse.clone().settle(&rules(interpolation)).unwrap();
            assert_eq!((record.times(), outside), (&[1.0, 2.0, 4.0][..], [1, 1]));
            assert_eq!(record.column("u").unwrap(), [1.0, between, 4.0]);
            let y = record.column("y").unwrap();
            assert!(y[0].is_nan() && y[1].is_nan() && y[2] == 8.0);
            assert_eq!(columns.iter().map(|own| own.measured).collect::<Vec<_>>(), [2, 3]);
            // one behind which one is empty; one behind which two are, and one
            assert_eq!(columns.iter().map(|own| own.stands_for).collect::<Vec<_>>(), [2.0, 2.5]);
        }
    }

    #[test]
    fn what_is_whole_stays_and_what_is_empty_is_named() {
        let whole = record([1.0; 5], [2.0; 5]);
        assert_eq!(whole.clone().settle(&rules(Interpolation::Linear)).unwrap(), (whole, Vec::new(), [0, 0]));
        let settle = |u, y| record(u, y).settle(&rules(Interpolation::Linear)).unwrap_err();
        assert_eq!(settle([NONE; 5], [1.0; 5]), "u");
        assert_eq!(settle([1.0; 5], [NONE; 5]), "y");
        assert_eq!(settle([NONE, NONE, 1.0, 1.0, 1.0], [1.0, 1.0, NONE, NONE, NONE]), "y");
    }
}
