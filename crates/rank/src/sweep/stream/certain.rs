//! Whether a matrix, known to within bounds, has full rank for certain: elimination with the bounds carried along.

use palmistry_math::number::{Bounded, LaneTask, Lanes};

/// Room for matrices of one shape.
pub struct Elimination<L> {
    rows: usize,
    columns: usize,
    transposed: bool,
    /// By rows.
    matrix: Vec<Bounded<L>>,
    /// A pivot's size is judged after multiplication by its row's weight, so that units do not matter.
    weights: Vec<L>,
}

impl<L: Lanes> Elimination<L> {
    /// Room for matrices of so many rows and columns.
    pub fn new(rows: usize, columns: usize, zero: L) -> Self {
        let transposed = columns > rows;
        let (rows, columns) = (rows.max(columns), rows.min(columns));
        let matrix = vec![Bounded::exact(zero); rows * columns];
        Elimination { rows, columns, transposed, matrix, weights: vec![zero; rows] }
    }

    /// Sets an entry.
    #[inline(always)]
    pub fn set(&mut self, row: usize, column: usize, value: Bounded<L>) {
        let (row, column) = if self.transposed { (column, row) } else { (row, column) };
        self.matrix[row * self.columns + column] = value;
    }

    /// Sets the weight of a row; it counts where rows are the longer side.
    #[inline(always)]
    pub fn set_row_weight(&mut self, row: usize, weight: L) {
        if !self.transposed {
            self.weights[row] = weight;
        }
    }

    /// Sets the weight of a column; it counts where columns are the longer side.
    #[inline(always)]
    pub fn set_column_weight(&mut self, column: usize, weight: L) {
        if self.transposed {
            self.weights[column] = weight;
        }
    }

    /// One in each lane where the rank is certainly as large as the smaller side, else zero. The matrix is used up.
    pub fn is_full(&mut self, one: L) -> L {
        one.apart(Eliminate(self, one))
    }

    #[inline(always)]
    fn eliminate(&mut self, rows: usize, columns: usize, one: L) -> L {
        let zero = one.splat(0.0);
        let mut certain = one;
        let matrix = &mut self.matrix[..rows * columns];
        let weights = &mut self.weights[..rows];
        for k in 0..columns {
            for i in k + 1..rows {
                bring_up(matrix, weights, columns, k, i);
            }
            let pivot = matrix[k * columns + k];
            certain = pivot.where_not_zero(certain, zero);
            if k + 1 == columns {
                break;
            }
            let inverse = Bounded::exact(one) / pivot;
            for i in k + 1..rows {
                let factor = matrix[i * columns + k] * inverse;
                for j in k + 1..columns {
                    matrix[i * columns + j] = matrix[i * columns + j] - factor * matrix[k * columns + j];
                }
            }
        }
        certain
    }
}

struct Eliminate<'e, L>(&'e mut Elimination<L>, L);

impl<L: Lanes> LaneTask for Eliminate<'_, L> {
    type Output = L;

    #[inline(always)]
    fn call(self) -> L {
        let Eliminate(room, one) = self;
        match (room.rows, room.columns) {
            (3, 3) => room.eliminate(3, 3, one),
            (4, 4) => room.eliminate(4, 4, one),
            (rows, columns) => room.eliminate(rows, columns, one),
        }
    }
}

/// Exchanges rows `k` and `i` in the lanes where row `i` has the larger pivot.
#[inline(always)]
fn bring_up<L: Lanes>(matrix: &mut [Bounded<L>], weights: &mut [L], columns: usize, k: usize, i: usize) {
    let here = matrix[k * columns + k].value.abs() * weights[k];
    let there = matrix[i * columns + k].value.abs() * weights[i];
    for j in k..columns {
        let (a, b) = (matrix[k * columns + j], matrix[i * columns + j]);
        matrix[k * columns + j] = chosen(here, there, b, a);
        matrix[i * columns + j] = chosen(here, there, a, b);
    }
    let (a, b) = (weights[k], weights[i]);
    weights[k] = here.where_less(there, b, a);
    weights[i] = here.where_less(there, a, b);
}

#[inline(always)]
fn chosen<L: Lanes>(a: L, b: L, then: Bounded<L>, otherwise: Bounded<L>) -> Bounded<L> {
    Bounded {
        value: a.where_less(b, then.value, otherwise.value),
        units: a.where_less(b, then.units, otherwise.units),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observability::rank;
    use dashu::rational::RBig;
    use palmistry_math::number::Rationals;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn is_full(entries: &[Bounded<f64>], rows: usize, columns: usize) -> bool {
        let mut room = Elimination::new(rows, columns, 0.0);
        for (place, entry) in entries.iter().enumerate() {
            room.set(place / columns, place % columns, *entry);
        }
        (0..rows).for_each(|row| room.set_row_weight(row, 1.0));
        (0..columns).for_each(|column| room.set_column_weight(column, 1.0));
        room.is_full(1.0) == 1.0
    }

    #[test]
    fn full_rank_is_claimed_where_it_is_and_never_where_it_is_not() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let (mut proved, mut full, mut singular) = (0, 0, 0);
        for _ in 0..4000 {
            let (rows, columns) = (rng.random_range(1..=5), rng.random_range(1..=5));
            // small integers, divided by what no double holds; every other time the last row is made the sum of the
            // others, so that many are singular
            let mut numbers: Vec<i64> = (0..rows * columns).map(|_| rng.random_range(-2..=2)).collect();
            if rng.random_range(0..2) == 0 {
                for column in 0..columns {
                    let sum = (0..rows - 1).map(|row| numbers[row * columns + column]).sum();
                    numbers[(rows - 1) * columns + column] = sum;
                }
            }
            let exact =
                numbers.chunks(columns).map(|row| row.iter().map(|x| RBig::from(*x)).collect()).collect();
            let is_full_rank = rank(&Rationals::default(), exact) == Ok(rows.min(columns));
            let third = Bounded::exact(1.0) / Bounded::exact(3.0);
            let entries: Vec<_> = numbers.iter().map(|x| Bounded::exact(*x as f64) * third).collect();
            let claimed = is_full(&entries, rows, columns);
            assert!(is_full_rank || !claimed, "{numbers:?}, {rows} by {columns}");
            full += u32::from(is_full_rank);
            singular += u32::from(!is_full_rank);
            proved += u32::from(claimed);
        }
        assert!(singular > 500 && full > 1000 && proved == full, "{proved} of {full}, {singular} singular");
    }

    #[test]
    fn an_entry_that_is_not_known_proves_nothing() {
        let unknown = Bounded { value: 1.0, units: f64::NAN };
        assert!(!is_full(&[unknown], 1, 1));
        assert!(!is_full(&[Bounded::exact(f64::NAN)], 1, 1));
        assert!(is_full(&[Bounded::exact(1e-300)], 1, 1));
    }
}
