//! Singular values of many small matrices at once, by one-sided Jacobi rotations.
//!
//! Pairs of columns are turned in their plane until all columns are orthogonal; their lengths then are the singular
//! values (M. R. Hestenes, "Inversion of matrices by biorthogonalization and related results", J. SIAM 6, 1958). Small
//! singular values come out as precisely as the matrix determines them, which is why this method and no other stands
//! here (J. Demmel and K. Veselic, "Jacobi's method is more accurate than QR", SIAM J. Matrix Anal. Appl. 13, 1992).
//! All lanes take the same steps, until the last of them is done.

use crate::number::Lanes;

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
    #[inline(always)]
    pub fn singular_values(&mut self) -> (&[L], bool) {
        // the common shapes with their sizes known to the compiler
        let converged = match (self.rows, self.columns) {
            (3, 3) => orthogonalise(&mut self.matrix, &mut self.squares, &self.pairs, 3),
            (4, 4) => orthogonalise(&mut self.matrix, &mut self.squares, &self.pairs, 4),
            _ => orthogonalise(&mut self.matrix, &mut self.squares, &self.pairs, self.rows),
        };
        for (value, column) in self.squares.iter_mut().zip(self.matrix.chunks(self.rows.max(1))) {
            *value = dot(column, column).sqrt();
        }
        (&self.squares, converged)
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
