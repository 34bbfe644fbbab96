//! Whether a matrix, known to within bounds, has full rank for certain: elimination with the bounds carried along.

use crate::number::{Bounded, Lanes};

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

    /// Sets the weights of a row or of a column; the weight of the longer side counts.
    #[inline(always)]
    pub fn set_weight(&mut self, is_row: bool, place: usize, weight: L) {
        if is_row != self.transposed {
            self.weights[place] = weight;
        }
    }

    /// One in each lane where the rank is certainly as large as the smaller side, else zero. The matrix is used up.
    #[inline(always)]
    pub fn is_full(&mut self, one: L) -> L {
        match (self.rows, self.columns) {
            (3, 3) => self.eliminate(3, 3, one),
            (4, 4) => self.eliminate(4, 4, one),
            (rows, columns) => self.eliminate(rows, columns, one),
        }
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
