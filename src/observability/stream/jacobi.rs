//! Singular values of many small matrices at once, by one-sided Jacobi rotations.
//!
//! Pairs of columns are turned in their plane until all columns are orthogonal; their lengths then are the singular
//! values (M. R. Hestenes, "Inversion of matrices by biorthogonalization and related results", J. SIAM 6, 1958). Small
//! singular values come out as precisely as the matrix determines them, which is why this method and no other stands
//! here (J. Demmel and K. Veselic, "Jacobi's method is more accurate than QR", SIAM J. Matrix Anal. Appl. 13, 1992).
//! All lanes take the same steps, until the last of them is done.

use crate::number::{Lanes, Task};

/// Two columns are orthogonal when the square of the cosine between them is below this. The sweep in which that is seen
/// is the last: convergence is quadratic, and that very sweep squares the cosines once more.
const ORTHOGONAL: f64 = 5.6e-17; // 2^-54

/// After so many sweeps it is given up; six suffice for any ordinary matrix of ten columns.
const MOST_SWEEPS: usize = 40;

/// Room for the singular values of matrices of one shape.
pub struct Jacobi<L> {
    rows: usize,
    columns: usize,
    /// Whether the matrix is handed over transposed, so that there are no more columns than rows.
    transposed: bool,
    /// Pairs of columns, in an order in which neighbours have nothing to do with each other.
    pairs: Vec<(u32, u32)>,
    /// By columns.
    matrix: Vec<L>,
    /// The squares of the columns' lengths.
    squares: Vec<L>,
}

impl<L: Lanes> Jacobi<L> {
    /// Room for matrices of so many rows and columns.
    pub fn new(rows: usize, columns: usize, zero: L) -> Self {
        let transposed = columns > rows;
        let (rows, columns) = (rows.max(columns), rows.min(columns));
        Jacobi {
            rows,
            columns,
            transposed,
            pairs: tournament(columns as u32),
            matrix: vec![zero; rows * columns],
            squares: vec![zero; columns],
        }
    }

    /// Sets an entry of the matrix.
    #[inline(always)]
    pub fn set(&mut self, row: usize, column: usize, value: L) {
        let place = if self.transposed { row * self.rows + column } else { column * self.rows + row };
        self.matrix[place] = value;
    }

    /// The singular values, as many as the smaller side of the matrix, in no order; and whether all lanes have converged.
    /// The matrix is used up. A matrix with an entry that is not finite has values that are not numbers.
    pub fn singular_values(&mut self) -> (&[L], bool) {
        let converged = self.matrix.first().copied().is_none_or(|any| any.apart(Decompose(self)));
        (&self.squares, converged)
    }

    /// The values found last, in descending order in each lane. Where one is not a number, all are.
    #[inline(always)]
    pub fn sorted(&mut self) -> &[L] {
        let values = &mut self.squares;
        for end in (1..values.len()).rev() {
            for place in 0..end {
                let (a, b) = (values[place], values[place + 1]);
                values[place] = a.larger(b);
                values[place + 1] = b.where_less(a, b, a);
            }
        }
        values
    }
}

struct Decompose<'j, L>(&'j mut Jacobi<L>);

impl<L: Lanes> Task for Decompose<'_, L> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let Jacobi { rows, columns, pairs, matrix, squares, .. } = self.0;
        // the common shapes with their sizes known to the compiler
        let converged = match (*rows, *columns) {
            (3, 3) => orthogonalise(&mut matrix[..9], &mut squares[..3], pairs, 3),
            (4, 4) => orthogonalise(&mut matrix[..16], &mut squares[..4], pairs, 4),
            _ => orthogonalise(matrix, squares, pairs, *rows),
        };
        for (value, column) in squares.iter_mut().zip(matrix.chunks(*rows)) {
            *value = dot(column, column).sqrt();
        }
        converged
    }
}

/// Every pair once, in rounds in which nobody meets twice (the circle method).
fn tournament(players: u32) -> Vec<(u32, u32)> {
    let seats = players + players % 2;
    let mut pairs = Vec::new();
    for round in 0..seats.saturating_sub(1) {
        // the last seat stays, all others move on
        let at = |seat: u32| if seat == seats - 1 { seat } else { (seat + round) % (seats - 1) };
        for seat in 0..seats / 2 {
            let (a, b) = (at(seat), at(seats - 1 - seat));
            if a < players && b < players {
                pairs.push((a.min(b), a.max(b)));
            }
        }
    }
    pairs
}

#[inline(always)]
fn dot<L: Lanes>(a: &[L], b: &[L]) -> L {
    let mut sum = a[0] * b[0];
    for i in 1..a.len() {
        sum = sum + a[i] * b[i];
    }
    sum
}

/// Makes the columns orthogonal. Whether that has succeeded in all lanes.
#[inline(always)]
fn orthogonalise<L: Lanes>(matrix: &mut [L], squares: &mut [L], pairs: &[(u32, u32)], rows: usize) -> bool {
    if rows == 0 {
        return true;
    }
    for _ in 0..MOST_SWEEPS {
        let mut rotated = false;
        for (square, column) in squares.iter_mut().zip(matrix.chunks(rows)) {
            *square = dot(column, column);
        }
        for &(p, q) in pairs {
            let (p, q) = (p as usize, q as usize);
            let (left, right) = matrix.split_at_mut(q * rows);
            rotated |= rotate(&mut left[p * rows..][..rows], &mut right[..rows], squares, p, q);
        }
        if !rotated {
            return true;
        }
    }
    false
}

/// Turns two columns so that they become orthogonal. Whether they were not nearly so already.
#[inline(always)]
fn rotate<L: Lanes>(left: &mut [L], right: &mut [L], squares: &mut [L], p: usize, q: usize) -> bool {
    let product = dot(left, right);
    let (a, b) = (squares[p], squares[q]);
    let rotated = (a * b * a.splat(ORTHOGONAL)).any_less(product * product);
    // t = tan of the angle, the smaller root of t^2 + t (b - a)/product - 1 = 0
    let (zero, one) = (a.splat(0.0), a.splat(1.0));
    let difference = b - a;
    let twice = product + product;
    let root = (difference * difference + twice * twice).sqrt();
    let t =
        difference.where_less(zero, -twice, twice) / (difference.abs() + root + a.splat(f64::MIN_POSITIVE));
    let cosine = one / (one + t * t).sqrt();
    let sine = cosine * t;
    for (x, y) in left.iter_mut().zip(right.iter_mut()) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
    squares[p] = a - t * product;
    squares[q] = b + t * product;
    rotated
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::{Instructions, Vectorised};
    use faer::Mat;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// The singular values of eight matrices of one shape, by rows, in descending order.
    struct All<'a>(&'a [Vec<f64>], usize, usize);

    impl Vectorised for All<'_> {
        type Output = (Vec<Vec<f64>>, bool);

        #[inline(always)]
        fn run<L: Lanes>(self, zero: L) -> Self::Output {
            let All(matrices, rows, columns) = self;
            let mut jacobi = Jacobi::new(rows, columns, zero);
            for place in 0..rows * columns {
                let mut entries = [0.0; 8];
                for (entry, matrix) in entries.iter_mut().zip(matrices) {
                    *entry = matrix[place];
                }
                jacobi.set(place / columns, place % columns, zero.load(&entries));
            }
            let (values, converged) = jacobi.singular_values();
            let mut found = vec![Vec::new(); 8];
            for value in values {
                let mut lanes = [0.0; 8];
                value.store(&mut lanes);
                for (found, value) in found.iter_mut().zip(lanes) {
                    found.push(value);
                }
            }
            for values in &mut found {
                values.sort_by(|a, b| b.total_cmp(a));
            }
            (found, converged)
        }
    }

    fn all(matrices: &[Vec<f64>], rows: usize, columns: usize) -> Vec<Vec<f64>> {
        let (portable, converged) = Instructions::Portable.run(All(matrices, rows, columns));
        assert!(converged);
        let (detected, _) = Instructions::detect().run(All(matrices, rows, columns));
        for (a, b) in portable.iter().flatten().zip(detected.iter().flatten()) {
            assert_eq!(a.to_bits(), b.to_bits(), "the same bits on every processor");
        }
        portable
    }

    #[test]
    fn random_matrices_of_all_shapes_agree_with_faer() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for (rows, columns) in
            [(1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (10, 10), (7, 3), (3, 8), (1, 6), (13, 4)]
        {
            for graded in [0, 1, 3] {
                let matrices: Vec<Vec<f64>> = (0..8)
                    .map(|_| {
                        let entry = |place| {
                            rng.random_range(-1.0..1.0) * 10f64.powi(-graded * (place % columns) as i32)
                        };
                        (0..rows * columns).map(entry).collect()
                    })
                    .collect();
                for (matrix, values) in matrices.iter().zip(all(&matrices, rows, columns)) {
                    let other = Mat::from_fn(rows, columns, |i, j| matrix[i * columns + j])
                        .singular_values()
                        .unwrap();
                    assert_eq!(values.len(), other.len());
                    for (a, b) in values.iter().zip(&other) {
                        // faer's values are backward stable: right to within rounding of the largest
                        assert!(
                            (a - b).abs() <= 1e-14 * values[0],
                            "{rows} by {columns}: {values:?}, {other:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn small_singular_values_are_as_good_as_large_ones() {
        // a rotation by atan(3/4), its columns scaled: the singular values are the scales, exactly
        let matrix = vec![0.6, -0.8e-30, 0.8, 0.6e-30];
        let values = &all(&vec![matrix; 8], 2, 2)[0];
        assert!((values[0] - 1.0).abs() < 1e-15 && (values[1] / 1e-30 - 1.0).abs() < 1e-15, "{values:?}");
    }

    #[test]
    fn singular_and_empty_directions_come_out_as_zero() {
        let ones = vec![1.0; 9];
        let zeros = vec![0.0; 9];
        let two = vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]; // rank two
        let values =
            all(&[ones, zeros, two.clone(), two.clone(), two.clone(), two.clone(), two.clone(), two], 3, 3);
        assert!((values[0][0] - 3.0).abs() < 1e-15 && values[0][1] < 1e-15);
        assert_eq!(values[1], [0.0; 3]);
        assert!(values[2][1] > 1.0 && values[2][2] < 1e-14);
    }

    #[test]
    fn what_is_not_a_number_does_not_disturb_its_neighbours() {
        let good = vec![2.0, 0.0, 0.0, 1.0];
        let mut matrices = vec![good; 8];
        matrices[3][1] = f64::NAN;
        let values = all(&matrices, 2, 2);
        assert_eq!(values[2], [2.0, 1.0]);
        assert!(values[3].iter().all(|value| value.is_nan()));
    }

    #[test]
    fn every_pair_meets_once() {
        for players in 0..12 {
            let mut pairs = tournament(players);
            let count = pairs.len() as u32;
            pairs.sort_unstable();
            pairs.dedup();
            assert_eq!((pairs.len() as u32, count), (count, players * players.saturating_sub(1) / 2));
        }
    }
}
