//! Rows of residues in echelon form, one row more at a time.

use palmistry_budget as budget;
use palmistry_math::number::{Arithmetic, PrimeField};

/// The span of the rows so far. Each row kept has a one where it begins, and zeros where the others begin.
#[derive(Clone, Debug)]
pub(super) struct Echelon {
    field: PrimeField,
    columns: usize,
    /// The column where each row begins.
    pivots: Vec<usize>,
    rows: Vec<Vec<u64>>,
}

impl Echelon {
    pub fn new(field: PrimeField, columns: usize) -> Self {
        Echelon { field, columns, pivots: Vec::new(), rows: Vec::new() }
    }

    pub fn rank(&self) -> usize {
        self.rows.len()
    }

    /// Whether a row lies outside the span so far; it is taken into it.
    pub fn insert(&mut self, mut row: Vec<u64>) -> bool {
        let field = self.field;
        // from the row, and of the row from the others
        budget::steps(2 * self.rows.len() * row.len());
        for (pivot, other) in self.pivots.iter().zip(&self.rows) {
            let factor = row[*pivot];
            field.subtract_multiple(&mut row, factor, other);
        }
        let Some(pivot) = row.iter().position(|entry| *entry != 0) else { return false };
        let Some(inverse) = field.inverse(row[pivot]) else { return false };
        for entry in &mut row {
            *entry = field.product(*entry, inverse);
        }
        for other in &mut self.rows {
            let factor = other[pivot];
            field.subtract_multiple(other, factor, &row);
        }
        self.pivots.push(pivot);
        self.rows.push(row);
        true
    }

    /// Whether a row lies in the span.
    pub fn contains(&self, mut row: Vec<u64>) -> bool {
        budget::steps(self.rows.len() * row.len());
        for (pivot, other) in self.pivots.iter().zip(&self.rows) {
            let factor = row[*pivot];
            self.field.subtract_multiple(&mut row, factor, other);
        }
        row.iter().all(|entry| *entry == 0)
    }

    /// Whether a row begins at this column.
    pub fn begins_at(&self, column: usize) -> bool {
        self.pivots.contains(&column)
    }

    /// A basis of the vectors that all rows annihilate: a one at a free column each.
    pub fn kernel(&self) -> Vec<Vec<u64>> {
        let one = self.field.one();
        let free = (0..self.columns).filter(|column| !self.pivots.contains(column));
        free.map(|free| {
            let mut vector = vec![0; self.columns];
            vector[free] = one;
            for (pivot, row) in self.pivots.iter().zip(&self.rows) {
                vector[*pivot] = self.field.neg(&row[free]).unwrap_or(0);
            }
            vector
        })
        .collect()
    }

    /// Of each column, whether it is one that a row has to itself: whether the unit row lies in the span.
    pub fn observable(&self) -> Vec<bool> {
        let mut seen = vec![false; self.columns];
        for (pivot, row) in self.pivots.iter().zip(&self.rows) {
            seen[*pivot] = row.iter().enumerate().all(|(column, entry)| column == *pivot || *entry == 0);
        }
        seen
    }
}
