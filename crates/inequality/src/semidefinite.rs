//! Matrices that are positive semidefinite, in a space of symmetric matrices: the one whose least eigenvalue is greatest,
//! to the precision of doubles. What is found here is a guess that exact arithmetic has to confirm; nothing rests on it.
//!
//! The path of analytic centres is followed by Newton's method (Boyd and Vandenberghe, Convex Optimization, 2004,
//! section 11.6): the logarithms of the determinants of `G(y) - t I` keep the eigenvalues above `t`, which is pushed up.

use nalgebra::{Cholesky, DMatrix, DVector};
use palmistry_budget as budget;
use palmistry_math::number::MOST_ITERATIONS;

/// A symmetric block `start + sum_k y_k directions[k]`; a direction is a list of entries, each with its mirror image.
#[derive(Clone, Debug)]
pub struct Block {
    pub start: DMatrix<f64>,
    /// Row, column and value of what each unknown adds.
    pub directions: Vec<Vec<(usize, usize, f64)>>,
}

/// How the search ended.
#[derive(Clone, Debug)]
pub struct Centre {
    pub unknowns: Vec<f64>,
    /// The least eigenvalue that was reached.
    pub least: f64,
}

/// Newton steps.
const STEPS: usize = 120;
/// An eigenvalue of this part of the largest entry is clear of zero.
const CLEAR: f64 = 1e-3;

impl Block {
    fn at(&self, unknowns: &[f64]) -> DMatrix<f64> {
        let mut sum = self.start.clone();
        for (value, direction) in unknowns.iter().zip(&self.directions) {
            for (row, column, entry) in direction {
                sum[(*row, *column)] += value * entry;
            }
        }
        sum
    }
}

/// The unknowns for which the least eigenvalue of all blocks is greatest, or clear of zero; `None` where doubles do not
/// suffice.
pub fn centre(blocks: &[Block], unknowns: usize) -> Option<Centre> {
    let scale = blocks.iter().flat_map(|block| block.start.iter()).fold(1.0, |a: f64, b| a.max(b.abs()));
    let mut y = vec![0.0; unknowns];
    let least = |y: &[f64]| {
        let of = |block: &Block| block.at(y).try_symmetric_eigen(f64::EPSILON, MOST_ITERATIONS);
        let eigenvalues = blocks.iter().map(|block| of(block).map(|eigen| eigen.eigenvalues.min()));
        eigenvalues.map(|value| value.unwrap_or(f64::NEG_INFINITY)).fold(f64::INFINITY, f64::min)
    };
    let mut t = least(&y) - 0.1 * scale;
    let size: usize = blocks.iter().map(|block| block.start.nrows()).sum();
    let mut push = size as f64 / scale;
    for _ in 0..STEPS {
        let Some((gradient, hessian)) = derivatives(blocks, &y, t, push) else { break };
        let damping = DMatrix::identity(unknowns + 1, unknowns + 1) * 1e-12 * hessian.amax().max(1e-300);
        let step = -Cholesky::new(hessian + damping)?.solve(&gradient);
        let decrement = -gradient.dot(&step);
        if !decrement.is_finite() {
            break;
        }
        // damped, so that all eigenvalues stay above t
        let mut length = if decrement > 0.25 { 1.0 / (1.0 + decrement.max(0.0).sqrt()) } else { 1.0 };
        let moved = |length: f64| -> (Vec<f64>, f64) {
            let next = y.iter().zip(step.iter()).map(|(a, b)| a + length * b).collect();
            (next, t + length * step[unknowns])
        };
        let mut next = moved(length);
        while !is_inside(blocks, &next.0, next.1) {
            length /= 2.0;
            if length < 1e-10 {
                let least = least(&y);
                return Some(Centre { unknowns: y, least });
            }
            next = moved(length);
        }
        (y, t) = next;
        if decrement < 1e-3 {
            if t > CLEAR * scale || size as f64 / push < 1e-11 * scale {
                break;
            }
            push *= 4.0;
        }
    }
    let least = least(&y);
    least.is_finite().then_some(Centre { unknowns: y, least })
}

fn is_inside(blocks: &[Block], y: &[f64], t: f64) -> bool {
    blocks.iter().all(|block| Cholesky::new(shifted(block, y, t)).is_some())
}

fn shifted(block: &Block, y: &[f64], t: f64) -> DMatrix<f64> {
    let mut matrix = block.at(y);
    (0..matrix.nrows()).for_each(|i| matrix[(i, i)] -= t);
    matrix
}

/// Gradient and Hessian of `-push t - sum log det(G(y) - t I)` in the unknowns and in `t`, which comes last.
fn derivatives(blocks: &[Block], y: &[f64], t: f64, push: f64) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let n = y.len();
    let mut gradient = DVector::zeros(n + 1);
    let mut hessian = DMatrix::zeros(n + 1, n + 1);
    gradient[n] = -push;
    for block in blocks {
        let terms: usize = block.directions.iter().map(Vec::len).sum();
        budget::steps(block.start.nrows().pow(3) + terms * terms);
        let inverse = Cholesky::new(shifted(block, y, t))?.inverse();
        let square = &inverse * &inverse;
        gradient[n] += inverse.trace();
        hessian[(n, n)] += square.trace();
        for (k, direction) in block.directions.iter().enumerate() {
            for (i, j, a) in direction {
                gradient[k] -= a * inverse[(*j, *i)];
                hessian[(k, n)] -= a * square[(*j, *i)];
            }
            if direction.is_empty() {
                continue;
            }
            for (l, other) in block.directions.iter().enumerate().take(k + 1) {
                let mut sum = 0.0;
                for (i, j, a) in direction {
                    for (p, q, b) in other {
                        sum += a * b * inverse[(*j, *p)] * inverse[(*q, *i)];
                    }
                }
                hessian[(k, l)] += sum;
            }
        }
    }
    for k in 0..=n {
        for l in 0..k {
            let value = if k == n { hessian[(l, n)] } else { hessian[(k, l)] };
            hessian[(k, l)] = value;
            hessian[(l, k)] = value;
        }
    }
    Some((gradient, hessian))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `[[1, y], [y, 1]]` is best at zero; `[[-1, y], [y, 1]]` is never semidefinite.
    #[test]
    fn the_least_eigenvalue_is_made_great() {
        let block = |corner: f64| Block {
            start: DMatrix::from_row_slice(2, 2, &[corner, 0.7, 0.7, 1.0]),
            directions: vec![vec![(0, 1, 1.0), (1, 0, 1.0)]],
        };
        let found = centre(&[block(1.0)], 1).unwrap();
        assert!(found.least > 0.2, "{found:?}");
        assert!(centre(&[block(-1.0)], 1).unwrap().least < -0.9);
    }
}
