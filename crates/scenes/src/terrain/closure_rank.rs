//! A rank by singular values: it is computed, and proves nothing.

use nalgebra::DMatrix;
use palmistry_math::number::MOST_ITERATIONS;

/// A singular value below this fraction of the largest one is not counted. Rows are differentiated to rounding, so that those that should be zero are about 1e-15 of it.
const COUNTED: f64 = 1e-9;

/// An unknown is observable where the component of its unit vector in the unobservable space is less than this.
const OBSERVABLE: f64 = 1e-6;

/// The rank of rows of derivatives, and the unknowns that they determine.
#[derive(Clone, Debug, PartialEq)]
pub struct ComputedRank {
    /// How many singular values were counted.
    pub rank: usize,
    /// All of them, from the largest on: as many as unknowns.
    pub singular_values: Vec<f64>,
    /// For each unknown whether it is observable.
    pub observable: Vec<bool>,
}

impl ComputedRank {
    /// Of rows, each with a derivative by each of `unknowns` unknowns.
    pub(super) fn of(rows: &[Vec<f64>], unknowns: usize) -> ComputedRank {
        // zero rows change nothing, and with them the decomposition has all directions
        let filled = rows.len().max(unknowns);
        let matrix = DMatrix::from_fn(filled, unknowns, |i, j| rows.get(i).map_or(0.0, |row| row[j]));
        let Some(svd) = matrix.try_svd(false, true, f64::EPSILON, MOST_ITERATIONS) else {
            // without a decomposition nothing is known
            let nothing = vec![f64::NAN; unknowns];
            return ComputedRank { rank: 0, singular_values: nothing, observable: vec![false; unknowns] };
        };
        let mut order: Vec<usize> = (0..unknowns).collect();
        order.sort_by(|a, b| svd.singular_values[*b].total_cmp(&svd.singular_values[*a]));
        let singular_values: Vec<f64> = order.iter().map(|place| svd.singular_values[*place]).collect();
        let largest = singular_values.first().copied().unwrap_or(0.0);
        let rank = singular_values.iter().filter(|value| **value > COUNTED * largest).count();
        let unobserved = |unknown: usize| {
            let part = |place: &usize| svd.v_t.as_ref().map_or(1.0, |v| v[(*place, unknown)].powi(2));
            order[rank..].iter().map(part).sum::<f64>().sqrt()
        };
        let told = (0..unknowns).map(|unknown| unobserved(unknown) < OBSERVABLE).collect();
        ComputedRank { rank, singular_values, observable: told }
    }

    /// The least singular value that was counted.
    pub fn least(&self) -> Option<f64> {
        self.singular_values[..self.rank].last().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: (1, 1, 0) and its double determine the sum of two unknowns, and neither of them; a row for the third determines it.
    #[test]
    fn what_rows_tell() {
        let rows = [vec![1.0, 1.0, 0.0], vec![2.0, 2.0, 0.0], vec![0.0, 0.0, 3.0]];
        let found = ComputedRank::of(&rows, 3);
        assert_eq!((found.rank, &found.observable[..]), (2, &[false, false, true][..]));
        assert!((found.singular_values[0] - 10.0_f64.sqrt()).abs() < 1e-14);
        assert!((found.least().unwrap() - 3.0).abs() < 1e-14 && found.singular_values[2] < 1e-15);
        let none = ComputedRank::of(&[], 2);
        assert_eq!((none.rank, none.least(), &none.observable[..]), (0, None, &[false, false][..]));
        assert_eq!(ComputedRank::of(&[vec![0.5, 0.0]], 2).observable, [true, false]);
    }
}
