//! The rank of one lane's matrices, from entries with bounds on their errors.

use super::certain::Elimination;
use super::equilibrate::Equilibrium;
use super::jacobi::Jacobi;
use crate::observability::{SEPARATED, WEIGHT_OF_ERRORS};
use palmistry_math::number::{Bounded, Lanes, MOST_LANES};

/// What was found in each lane; as many of the places are used as there are lanes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Found {
    /// How many singular values exceed what errors may make of zero.
    pub rank: [f64; MOST_LANES],
    /// The smallest over the largest singular value.
    pub ratio: [f64; MOST_LANES],
    /// The gap on which the rank rests.
    pub gap: [f64; MOST_LANES],
    /// One where all singular values count and the smallest leaves half of the digits.
    pub separated: [f64; MOST_LANES],
    /// Zero where all entries are finite.
    pub finite: [f64; MOST_LANES],
    /// One where elimination with error bounds proves the full rank.
    pub certain: [f64; MOST_LANES],
}

/// Room for deciding matrices of one shape.
pub(super) struct Decider<L> {
    rows: usize,
    columns: usize,
    zero: L,
    entries: Vec<Bounded<L>>,
    equilibrium: Equilibrium<L>,
    jacobi: Jacobi<L>,
    elimination: Elimination<L>,
}

impl<L: Lanes> Decider<L> {
    #[inline(always)]
    pub fn new(rows: usize, columns: usize, zero: L) -> Self {
        Decider {
            rows,
            columns,
            zero,
            entries: vec![Bounded::exact(zero); rows * columns],
            equilibrium: Equilibrium::new(rows, columns, zero),
            jacobi: Jacobi::new(rows, columns, zero),
            elimination: Elimination::new(rows, columns, zero),
        }
    }

    /// How many entries a matrix has.
    #[inline(always)]
    pub fn places(&self) -> usize {
        self.entries.len()
    }

    /// Sets an entry.
    #[inline(always)]
    pub fn set(&mut self, place: usize, entry: Bounded<L>) {
        self.entries[place] = entry;
    }

    /// The singular values of what was decided last, in descending order.
    #[inline(always)]
    pub fn singular_values(&mut self) -> &[L] {
        self.jacobi.sorted()
    }

    /// The factors by which rows were multiplied.
    #[inline(always)]
    pub fn row_factors(&self) -> &[L] {
        self.equilibrium.factors().0
    }

    /// The factors by which columns were multiplied.
    #[inline(always)]
    pub fn column_factors(&self) -> &[L] {
        self.equilibrium.factors().1
    }

    /// Decides. Where an entry or its bound is not finite, nothing is separated and nothing certain; nothing is either
    /// where it is not to `certify`.
    #[inline(always)]
    pub fn decide(&mut self, certify: bool) -> Found {
        let (zero, one) = (self.zero, self.zero.splat(1.0));
        if self.rows == 0 || self.columns == 0 {
            // nothing is left to decide
            let all = [1.0; MOST_LANES];
            return Found {
                ratio: all,
                gap: [f64::INFINITY; MOST_LANES],
                separated: all,
                certain: all,
                ..Found::default()
            };
        }
        let heavy = zero.splat(WEIGHT_OF_ERRORS);
        let (mut spoiled, mut infinite) = (zero, zero);
        for i in 0..self.rows {
            for j in 0..self.columns {
                let entry = self.entries[i * self.columns + j];
                let weight = entry.value.abs() + heavy * entry.error();
                self.equilibrium.set(i, j, weight);
                self.elimination.set(i, j, entry);
                spoiled = spoiled + weight.zero_if_finite();
                infinite = infinite + entry.value.zero_if_finite();
            }
        }
        self.equilibrium.solve();
        let mut noise = zero;
        for i in 0..self.rows {
            let row = self.equilibrium.row_factor(i);
            self.elimination.set_row_weight(i, row);
            for j in 0..self.columns {
                let column = self.equilibrium.column_factor(j);
                let entry = self.entries[i * self.columns + j];
                self.jacobi.set(i, j, entry.value * row * column);
                let error = entry.error() * row * column;
                noise = noise + error * error;
            }
        }
        for j in 0..self.columns {
            self.elimination.set_column_weight(j, self.equilibrium.column_factor(j));
        }
        let certain = if certify { self.elimination.is_full(one) } else { zero };

        let (values, converged) = self.jacobi.singular_values();
        let (mut smallest, mut largest) = (values[0], values[0]);
        for value in &values[1..] {
            smallest = smallest.smaller(*value);
            largest = largest.larger(*value);
        }
        // by H. Weyl no singular value is moved by more than the norm of what the matrix is changed by
        let rounding = zero.splat(self.rows.max(self.columns) as f64 * f64::EPSILON);
        let tolerance = noise.sqrt() + rounding * largest;
        let (mut rank, mut least, mut below) = (zero, zero.splat(f64::INFINITY), tolerance);
        for value in values {
            rank = rank + tolerance.where_less(*value, one, zero);
            least = tolerance.where_less(*value, least.smaller(*value), least);
            below = tolerance.where_less(*value, below, value.larger(below));
        }
        let all = zero.splat(values.len() as f64 - 0.5);
        let unclear = smallest.where_less(zero.splat(SEPARATED) * largest, zero, one);
        // a sum with what is not a number is no less than anything; a lane that did not converge loses its own mark alone
        let separated = all.where_less(rank + spoiled, unclear, zero);
        let separated = zero.where_less(converged, separated, zero);
        let mut found = Found::default();
        rank.store(&mut found.rank);
        (smallest / largest).store(&mut found.ratio);
        (least / below).store(&mut found.gap);
        infinite.store(&mut found.finite);
        separated.store(&mut found.separated);
        zero.where_less(certain + spoiled, certain, zero).store(&mut found.certain);
        found
    }
}

#[cfg(test)]
mod tests;
