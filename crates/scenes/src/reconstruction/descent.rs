//! Levenberg and Marquardt's method with orthogonal factors: coefficients that are undetermined in gaps would cost normal equations half of all digits.

use nalgebra::{DMatrix, DVector};
use std::sync::atomic::{AtomicBool, Ordering};

/// Steps at most, and tries of one step.
const STEPS: usize = 30;
const TRIES: usize = 9;

/// The initial damping relative to the squared sizes of the columns, its factor after a step that helped, and its factor after one that did not.
const DAMPING: f64 = 1e-6;
const CALMER: f64 = 0.01;
const STRONGER: f64 = 20.0;
const LEAST_DAMPING: f64 = 1e-20;

/// A step that lowers the sum of squares by less than this, or by less than this fraction of it, is the last one: it moved nothing by a fraction of its deviation.
const SETTLED: f64 = 1e-3;
const SETTLED_PART: f64 = 1e-7;

/// A sum of squares.
pub(super) trait Squares {
    /// Where it is taken.
    type Point: Clone;
    /// The sum there; none where there is none.
    fn sum(&self, at: &Self::Point) -> Option<f64>;
    /// The triangle of its rows, with the right-hand side as the last column.
    fn triangle(&self, at: &Self::Point) -> Option<DMatrix<f64>>;
    fn moved(&self, at: &Self::Point, step: &DVector<f64>) -> Option<Self::Point>;
}

/// The upper triangle of rows; square, with rows of zeros where there are fewer rows than columns.
pub(super) fn triangle_of(rows: DMatrix<f64>) -> DMatrix<f64> {
    let columns = rows.ncols();
    let triangle = rows.qr().r();
    match triangle.nrows() {
        rows if rows == columns => triangle,
        _ => triangle.resize_vertically(columns, 0.0),
    }
}

/// The rows of a triangle, and below them a diagonal with its right-hand side, as a triangle.
pub(super) fn joined(triangle: &DMatrix<f64>, diagonal: &[f64], lacks: &[f64]) -> DMatrix<f64> {
    let (rows, last) = (triangle.nrows(), triangle.ncols() - 1);
    let mut all = DMatrix::zeros(rows + diagonal.len(), last + 1);
    all.rows_mut(0, rows).copy_from(triangle);
    let first = last - diagonal.len();
    for (i, (weight, lack)) in diagonal.iter().zip(lacks).enumerate() {
        all[(rows + i, first + i)] = *weight;
        all[(rows + i, last)] = *lack;
    }
    triangle_of(all)
}

/// The solution of a triangle with its right-hand side as the last column.
pub(super) fn solved(triangle: &DMatrix<f64>) -> Option<DVector<f64>> {
    let p = triangle.ncols() - 1;
    let corner = triangle.view((0, 0), (p, p));
    let side = triangle.view((0, p), (p, 1)).column(0).into_owned();
    let step = corner.solve_upper_triangular(&side)?;
    step.iter().all(|value| value.is_finite()).then_some(step)
}

/// The inverse of a triangle without its last row and column.
pub(super) fn inverse(triangle: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let p = triangle.ncols() - 1;
    let corner = triangle.view((0, 0), (p, p));
    let inverse = corner.solve_upper_triangular(&DMatrix::identity(p, p))?;
    inverse.iter().all(|value| value.is_finite()).then_some(inverse)
}

/// Where a descent ended.
pub(super) struct Least<P> {
    pub at: P,
    pub sum: f64,
    /// Whether no step lowers the sum significantly: else it was still on its way, as in a long bent valley, and this is no minimum.
    pub is_settled: bool,
}

/// The least sum that is found from a starting point.
pub(super) fn descend<S: Squares>(
    squares: &S,
    start: S::Point,
    interrupt: &AtomicBool,
) -> Option<Least<S::Point>> {
    let (mut x, mut is_settled) = (start, false);
    let mut sum = squares.sum(&x)?;
    let mut damping = DAMPING;
    for _ in 0..STEPS {
        if interrupt.load(Ordering::Relaxed) {
            return None;
        }
        let triangle = squares.triangle(&x)?;
        let sizes: Vec<f64> =
            (0..triangle.ncols() - 1).map(|i| triangle.column(i).norm().max(f64::MIN_POSITIVE)).collect();
        let none = vec![0.0; sizes.len()];
        let mut better = None;
        for _ in 0..TRIES {
            let damped: Vec<f64> = sizes.iter().map(|size| damping.sqrt() * size).collect();
            let there = solved(&joined(&triangle, &damped, &none)).and_then(|step| squares.moved(&x, &step));
            let next = there.and_then(|there| squares.sum(&there).map(|next| (there, next)));
            if let Some((there, next)) = next.filter(|(_, next)| *next < sum) {
                better = Some((there, next));
                break;
            }
            damping = (damping * STRONGER).max(1e-12);
        }
        let Some((there, next)) = better else {
            is_settled = true;
            break;
        };
        is_settled = sum - next <= SETTLED.max(SETTLED_PART * next);
        (x, sum) = (there, next);
        damping = (damping * CALMER).max(LEAST_DAMPING);
        if is_settled {
            break;
        }
    }
    sum.is_finite().then_some(Least { at: x, sum, is_settled })
}
