//! Equilibration of many matrices at once, lane by lane.
//!
//! Wanted are positive numbers `r_i`, `c_j` with
//!
//! `sum_j (r_i w_ij c_j)^2 = columns/rows` for every row and `sum_i (r_i w_ij c_j)^2 = 1` for every column,
//!
//! where `w_ij` is the magnitude of an entry, raised by a multiple of the bound on its error; `r_i a_ij c_j` is then
//! decomposed. It is the scaling of [`equilibrate`](crate::observability::equilibrate), whose page says why, reached by
//! the same iteration on the squares, with overrelaxation (A. Thibault and others, "Overrelaxed Sinkhorn-Knopp algorithm
//! for regularized optimal transport", Algorithms 14, 2021) and to fewer digits: lengths agree to half a percent. A lane
//! that has come so far keeps its factors while others go on, so that they depend on its own matrix alone.
//!
//! A round over `m` by `n` entries takes `4mn + 10(m + n)` operations. A 4x4 matrix of the general regime needs seven
//! rounds, and twelve to fifteen go by until the slowest of eight or sixteen lanes is done: the limit is that wait.

use palmistry_math::number::{LaneTask, Lanes};

/// Scaling has converged when the squares of all lengths are as wanted to this part.
const CONVERGED: f64 = 1e-2;

/// Matrices whose scaled form does not exist (some zero patterns) come as near to it as this many rounds take them.
const MOST_ROUNDS: usize = 60;

/// Rounds without overrelaxation at the start, which bring all sums to the right size.
const PLAIN_ROUNDS: usize = 2;

/// A step goes this many times as far as would make the sums right by itself.
const OVERRELAXATION: f64 = 1.5;

/// No factor shrinks by more than this in one step, so that it stays positive.
const LEAST_STEP: f64 = 0.25;

/// Room for the scaling of matrices of one shape, with at least one row and one column.
pub struct Equilibrium<L> {
    rows: usize,
    columns: usize,
    /// The weights, and later their squares.
    squares: Vec<L>,
    r: Vec<L>,
    c: Vec<L>,
    row_factors: Vec<L>,
    column_factors: Vec<L>,
}

impl<L: Lanes> Equilibrium<L> {
    /// Room for matrices of so many rows and columns.
    pub fn new(rows: usize, columns: usize, zero: L) -> Self {
        Equilibrium {
            rows,
            columns,
            squares: vec![zero; rows * columns],
            r: vec![zero; rows],
            c: vec![zero; columns],
            row_factors: vec![zero; rows],
            column_factors: vec![zero; columns],
        }
    }

    /// Sets a weight, which must not be negative.
    #[inline(always)]
    pub fn set(&mut self, row: usize, column: usize, weight: L) {
        self.squares[row * self.columns + column] = weight;
    }

    /// `r_i`
    #[inline(always)]
    pub fn row_factor(&self, row: usize) -> L {
        self.row_factors[row]
    }

    /// `c_j`
    #[inline(always)]
    pub fn column_factor(&self, column: usize) -> L {
        self.column_factors[column]
    }

    /// All `r_i`, and all `c_j`.
    #[inline(always)]
    pub fn factors(&self) -> (&[L], &[L]) {
        (&self.row_factors, &self.column_factors)
    }

    /// Finds the factors. A row or a column of zeros has the factor one.
    pub fn solve(&mut self) {
        if let Some(any) = self.squares.first().copied() {
            any.apart(Solve(self));
        }
    }

    #[inline(always)]
    fn solve_for(&mut self, rows: usize, columns: usize) {
        let Some(&any) = self.squares.first() else { return };
        let one = any.splat(1.0);
        let squares = &mut self.squares[..rows * columns];
        let (r, c) = (&mut self.r[..rows], &mut self.c[..columns]);
        let (row_factors, column_factors) =
            (&mut self.row_factors[..rows], &mut self.column_factors[..columns]);
        // by the largest weights first, so that no square overflows or vanishes
        for i in 0..rows {
            let row = &mut squares[i * columns..][..columns];
            let mut largest = row[0];
            for weight in &row[1..] {
                largest = largest.larger(*weight);
            }
            row_factors[i] = inverse(largest, one);
            for weight in row {
                *weight = *weight * row_factors[i];
            }
            r[i] = one;
        }
        for j in 0..columns {
            let mut largest = squares[j];
            for i in 1..rows {
                largest = largest.larger(squares[i * columns + j]);
            }
            column_factors[j] = inverse(largest, one);
            for i in 0..rows {
                let weight = squares[i * columns + j] * column_factors[j];
                squares[i * columns + j] = weight * weight;
            }
        }
        let share = any.splat(columns as f64 / rows as f64);
        let unshare = any.splat(rows as f64 / columns as f64);
        let (zero, infinite, near) = (any.splat(0.0), any.splat(f64::INFINITY), any.splat(CONVERGED));
        // infinite in a lane that has converged: none of its sums exceeds that
        let mut least = zero;
        for round in 0..MOST_ROUNDS {
            let mut farthest = zero;
            for j in 0..columns {
                let mut sum = r[0] * squares[j];
                for i in 1..rows {
                    sum = sum + r[i] * squares[i * columns + j];
                }
                if round < PLAIN_ROUNDS {
                    c[j] = inverse(sum, one);
                } else {
                    farthest = step(&mut c[j], sum, least).larger(farthest);
                }
            }
            for i in 0..rows {
                let mut sum = c[0] * squares[i * columns];
                for j in 1..columns {
                    sum = sum + c[j] * squares[i * columns + j];
                }
                if round < PLAIN_ROUNDS {
                    r[i] = share * inverse(sum, one);
                } else {
                    farthest = step(&mut r[i], sum * unshare, least).larger(farthest);
                }
            }
            if round >= PLAIN_ROUNDS {
                least = near.where_less(farthest, least, infinite);
                if !least.any_less(infinite) {
                    break;
                }
            }
        }
        for i in 0..rows {
            row_factors[i] = row_factors[i] * r[i].sqrt();
        }
        for j in 0..columns {
            column_factors[j] = column_factors[j] * c[j].sqrt();
        }
    }
}

struct Solve<'e, L>(&'e mut Equilibrium<L>);

impl<L: Lanes> LaneTask for Solve<'_, L> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        // common shapes with their sizes known to the compiler
        match (self.0.rows, self.0.columns) {
            (3, 3) => self.0.solve_for(3, 3),
            (4, 4) => self.0.solve_for(4, 4),
            (rows, columns) => self.0.solve_for(rows, columns),
        }
    }
}

/// Moves a factor so that it times the sum comes nearer to one, where the sum exceeds `least`. How far it was from that,
/// zero where it stays.
#[inline(always)]
fn step<L: Lanes>(factor: &mut L, sum: L, least: L) -> L {
    let (zero, one) = (sum.splat(0.0), sum.splat(1.0));
    let excess = least.where_less(sum, one - sum * *factor, zero);
    *factor = *factor * (one + sum.splat(OVERRELAXATION) * excess).larger(sum.splat(LEAST_STEP));
    excess.abs()
}

/// One over a positive number; one over zero is one.
#[inline(always)]
fn inverse<L: Lanes>(x: L, one: L) -> L {
    one / x.splat(0.0).where_less(x, x, one)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn scaled(entries: &[f64], rows: usize, columns: usize) -> Vec<f64> {
        let mut room = Equilibrium::new(rows, columns, 0.0);
        for (place, entry) in entries.iter().enumerate() {
            room.set(place / columns, place % columns, entry.abs());
        }
        room.solve();
        let factor = |place: usize| room.row_factor(place / columns) * room.column_factor(place % columns);
        entries.iter().enumerate().map(|(place, entry)| entry * factor(place)).collect()
    }

    #[test]
    fn rows_and_columns_come_to_equal_lengths_whatever_the_units() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for (rows, columns) in [(2, 2), (3, 3), (4, 4), (4, 7), (6, 3)] {
            for _ in 0..100 {
                let entries: Vec<f64> = (0..rows * columns).map(|_| rng.random_range(0.1..1.0)).collect();
                let units: Vec<f64> =
                    (0..rows + columns).map(|_| 10f64.powf(rng.random_range(-70.0..70.0))).collect();
                let other: Vec<f64> = entries
                    .iter()
                    .enumerate()
                    .map(|(place, entry)| entry * units[place / columns] * units[rows + place % columns])
                    .collect();
                let (first, second) = (scaled(&entries, rows, columns), scaled(&other, rows, columns));
                for row in first.chunks(columns) {
                    let square: f64 = row.iter().map(|x| x * x).sum();
                    assert!((square * rows as f64 / columns as f64 - 1.0).abs() < 2.0 * CONVERGED);
                }
                for column in 0..columns {
                    let square: f64 = first.iter().skip(column).step_by(columns).map(|x| x * x).sum();
                    assert!((square - 1.0).abs() < 2.0 * CONVERGED);
                }
                for (a, b) in first.iter().zip(&second) {
                    assert!((a - b).abs() < 4.0 * CONVERGED, "{first:?}, {second:?}");
                }
            }
        }
    }

    #[test]
    fn it_is_the_scaling_that_single_states_get() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for _ in 0..100 {
            let entries: Vec<f64> = (0..16).map(|_| 10f64.powf(rng.random_range(-1.0..1.0))).collect();
            let mut other = entries.clone();
            crate::observability::equilibrate(&mut other, &mut [0.0; 16], 4);
            for (a, b) in scaled(&entries, 4, 4).iter().zip(&other) {
                assert!((a - b).abs() < 5.0 * CONVERGED, "{a} and {b}");
            }
        }
    }

    #[test]
    fn zeros_stay_and_nothing_else_suffers() {
        assert_eq!(scaled(&[0.0, 0.0, 0.0, 0.0], 2, 2), [0.0; 4]);
        let found = scaled(&[0.0, 5.0, 0.0, 0.0], 2, 2);
        assert!((found[1] - 1.0).abs() < 0.01, "{found:?}");
        // a triangular matrix has no equilibrium; what is reached is finite
        assert!(scaled(&[1.0, 1.0, 0.0, 1.0], 2, 2).iter().all(|x| x.is_finite() && x.abs() < 1.1));
    }
}
