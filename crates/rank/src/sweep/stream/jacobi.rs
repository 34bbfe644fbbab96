//! Singular values of many small matrices at once, by one-sided Jacobi rotations.
//!
//! Pairs of columns are turned in their plane until all columns are orthogonal; their lengths then are the singular
//! values (M. R. Hestenes, "Inversion of matrices by biorthogonalization and related results", J. SIAM 6, 1958). Small
//! singular values come out as precisely as the matrix determines them, which is why this method and no other stands
//! here (J. Demmel and K. Veselic, "Jacobi's method is more accurate than QR", SIAM J. Matrix Anal. Appl. 13, 1992).
//! All lanes take the same steps until the last of them is done, but one that is done turns by the angle zero from then
//! on, which changes no bit: what comes out depends on the lane's own matrix alone.
//!
//! A rotation of two columns of `m` rows takes `8m + 20` operations, two roots and two divisions, and a 4x4 matrix some five
//! sweeps of six rotations: 1700 operations, 60 roots and 60 divisions. Where a division and a root take two cycles a
//! double, whatever the width of the vectors, that is 240 cycles, against 105 for the operations with vectors of eight: roots
//! and divisions are the limit, and a matrix takes less than twice as long (`cargo bench --bench sweep`).

use palmistry_math::number::{LaneTask, Lanes};

/// Two columns are orthogonal when the square of the cosine between them is below this. The sweep in which that is found
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
    /// What kind of number there is, where there is no column.
    zero: L,
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
            zero,
        }
    }

    /// Sets an entry of the matrix.
    #[inline(always)]
    pub fn set(&mut self, row: usize, column: usize, value: L) {
        let place = if self.transposed { row * self.rows + column } else { column * self.rows + row };
        self.matrix[place] = value;
    }

    /// The singular values, as many as the smaller side of the matrix, in no order; and one in each lane that has converged,
    /// else zero. The matrix is used up. A matrix with an entry that is not finite has values that are not numbers.
    pub fn singular_values(&mut self) -> (&[L], L) {
        let converged = self.zero.apart(Decompose(self));
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

impl<L: Lanes> LaneTask for Decompose<'_, L> {
    type Output = L;

    #[inline(always)]
    fn call(self) -> L {
        let Jacobi { rows, columns, pairs, matrix, squares, zero, .. } = self.0;
        if squares.is_empty() {
            return zero.splat(1.0); // nothing to turn
        }
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

/// Makes the columns orthogonal. One in each lane in which that has succeeded, else zero.
#[inline(always)]
fn orthogonalise<L: Lanes>(matrix: &mut [L], squares: &mut [L], pairs: &[(u32, u32)], rows: usize) -> L {
    let Some(&any) = matrix.first() else { return squares[0].splat(1.0) };
    let (zero, one, infinite) = (any.splat(0.0), any.splat(1.0), any.splat(f64::INFINITY));
    // infinite in a lane that is done: divided by it, every tangent is zero
    let mut least = any.splat(f64::MIN_POSITIVE);
    for _ in 0..MOST_SWEEPS {
        for (square, column) in squares.iter_mut().zip(matrix.chunks(rows)) {
            *square = dot(column, column);
        }
        let mut turned = zero;
        for &(p, q) in pairs {
            let (p, q) = (p as usize, q as usize);
            let (left, right) = matrix.split_at_mut(q * rows);
            let pair = Pair {
                left: &mut left[p * rows..][..rows],
                right: &mut right[..rows],
                squares: (squares[p], squares[q]),
            };
            let found = pair.rotate(least, turned);
            (squares[p], squares[q]) = found.squares;
            turned = found.turned;
        }
        least = zero.where_less(turned, least, infinite);
        if !least.any_less(infinite) {
            break;
        }
    }
    least.where_less(infinite, zero, one)
}

/// Two columns, and the squares of their lengths.
struct Pair<'m, L> {
    left: &'m mut [L],
    right: &'m mut [L],
    squares: (L, L),
}

/// What a rotation results in.
struct Rotated<L> {
    squares: (L, L),
    /// One in each lane in which these columns or earlier ones were not nearly orthogonal before.
    turned: L,
}

impl<L: Lanes> Pair<'_, L> {
    /// Turns the columns so that they become orthogonal; `least` is added to what the tangent is divided by.
    #[inline(always)]
    fn rotate(self, least: L, turned: L) -> Rotated<L> {
        let Pair { left, right, squares: (a, b) } = self;
        let product = dot(left, right);
        let (zero, one) = (a.splat(0.0), a.splat(1.0));
        let turned = (a * b * a.splat(ORTHOGONAL)).where_less(product * product, one, turned);
        // t = tan of the angle, the smaller root of t^2 + t (b - a)/product - 1 = 0
        let (difference, twice) = (b - a, product + product);
        let root = (difference * difference + twice * twice).sqrt();
        let t = difference.where_less(zero, -twice, twice) / (difference.abs() + root + least);
        let cosine = one / (one + t * t).sqrt();
        let sine = cosine * t;
        for (x, y) in left.iter_mut().zip(right.iter_mut()) {
            (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
        }
        Rotated { squares: (a - t * product, b + t * product), turned }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;
    use palmistry_math::number::{Instructions, MOST_LANES, Vectorised};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// The singular values of matrices of one shape, by rows, in descending order, and which of them have converged.
    struct All<'a>(&'a [Vec<f64>], usize, usize);

    impl Vectorised for All<'_> {
        type Output = Vec<(Vec<f64>, bool)>;

        #[inline(always)]
        fn run<L: Lanes>(self, zero: L) -> Self::Output {
            let All(matrices, rows, columns) = self;
            let mut jacobi = Jacobi::new(rows, columns, zero);
            let mut found = Vec::new();
            for some in matrices.chunks(L::COUNT) {
                for place in 0..rows * columns {
                    let mut entries = [0.0; MOST_LANES];
                    for (entry, matrix) in entries.iter_mut().zip(some) {
                        *entry = matrix[place];
                    }
                    jacobi.set(place / columns, place % columns, zero.load(&entries));
                }
                let (values, converged) = jacobi.singular_values();
                let mut marks = [0.0; MOST_LANES];
                converged.store(&mut marks);
                let mut lanes = vec![Vec::new(); some.len()];
                for value in values {
                    let mut room = [0.0; MOST_LANES];
                    value.store(&mut room);
                    lanes.iter_mut().zip(room).for_each(|(values, value)| values.push(value));
                }
                lanes.iter_mut().for_each(|values| values.sort_by(|a, b| b.total_cmp(a)));
                found.extend(lanes.into_iter().zip(marks.map(|mark| mark == 1.0)));
            }
            found
        }
    }

    /// The same bits in whatever lanes, on every processor.
    fn all(matrices: &[Vec<f64>], rows: usize, columns: usize) -> Vec<Vec<f64>> {
        let alone: Vec<_> = matrices
            .iter()
            .flat_map(|one| All(std::slice::from_ref(one), rows, columns).run(0.0f64))
            .collect();
        let bits = |value: f64| if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() };
        for instructions in Instructions::ALL {
            let together = instructions.run(All(matrices, rows, columns));
            assert_eq!(together.len(), alone.len());
            for ((a, converged), (b, other)) in alone.iter().zip(together) {
                assert_eq!(*converged, other);
                assert!(a.iter().zip(b).all(|(a, b)| bits(*a) == bits(b)), "{instructions:?}");
            }
        }
        assert!(alone.iter().all(|(_, converged)| *converged));
        alone.into_iter().map(|(values, _)| values).collect()
    }

    #[test]
    fn a_matrix_that_is_slow_holds_nobody_up() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut matrices: Vec<Vec<f64>> = Vec::new();
        for case in 0..203 {
            // from nearly diagonal, two sweeps, to far from it, six
            let far = 10f64.powi(-(case % 12));
            let entry =
                |place: usize| if place.is_multiple_of(7) { 1.0 } else { far * rng.random_range(-1.0..1.0) };
            matrices.push((0..36).map(entry).collect());
        }
        matrices[17][3] = f64::NAN;
        matrices[60] = vec![0.0; 36];
        let values = all(&matrices, 6, 6);
        assert_eq!(values.len(), 203);
        assert!(values[17].iter().all(|value| value.is_nan()) && values[60] == [0.0; 6]);
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
