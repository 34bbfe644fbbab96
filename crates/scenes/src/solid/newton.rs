//! Newton's method on the likelihood of the state alone, the measurements' errors being the likeliest for each.
//!
//! Gauss and Newton's matrix is made of derivatives at measurements that still have half of their errors (a constraint determines one of the two coordinates of its contact), and squares of errors do not cancel: it
//! contains information that is noise, and more of it the longer a record is. With contacts measured to a millimetre over a second or two that is most of it, along the least observable directions: steps then diverge, and
//! a bound by this matrix may be a hundred times too good. The Hessian is free of that part: the residuals, times second derivatives, remove it (as in total least squares, where the inverted matrix is
//! `X^T X - s^2 1`: G. H. Golub and C. F. Van Loan, SIAM Journal on Numerical Analysis 17, 1980). It is taken by differences of the gradient, which is exact where errors are the likeliest.

use super::UNKNOWNS;
use super::change::{Change, Normal, Scale, shortened};
use super::flow::Start;
use super::linear::solved;
use super::linearised::Linear;
use super::whiten::ERRORS;
use nalgebra::SMatrix;
use palmistry_math::number::MOST_ITERATIONS;

type Errors = Vec<[f64; ERRORS]>;
/// A covariance of changes.
pub(super) type Spread = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
pub(super) type Square = [[f64; UNKNOWNS]; UNKNOWNS];

/// A state with its likeliest errors.
pub(super) struct Settled {
    pub start: Start,
    pub linear: Linear,
}

/// Errors count as the likeliest where another pass changes none of them by this fraction of its deviation; the number of passes.
const SETTLED: f64 = 1e-4;
const PASSES: usize = 6;

/// The number of steps. The gain of a step, in units of the deviations squared, below which none is taken, and below which the state counts as a minimum: it is half a deviation away at most, where a valley is bent and
/// steps are short.
const STEPS: usize = 10;
const GAINED: [f64; 2] = [1e-3, 0.25];

/// The distance from a minimum, in deviations, at which chi-square is compared with its parabola.
const DEVIATIONS: f64 = 3.0;

/// The step of the gradient's differences, relative to the scale of each unknown.
const DIFFERENCED: f64 = 1e-5;

pub(super) type About<'a> = dyn Fn(&Start, &[[f64; ERRORS]]) -> Option<Linear> + 'a;

impl Settled {
    /// With measurements as they are.
    pub fn begun(about: &About<'_>, start: Start) -> Option<Settled> {
        let all = about(&start, &[])?;
        Some(Settled { start, linear: all })
    }

    /// After a step, with the errors that are the likeliest by the linearisation before it.
    pub fn next(&self, about: &About<'_>, step: &Change) -> Option<Settled> {
        let start = self.start.changed(step)?;
        let linear = about(&start, &self.linear.errors(step))?;
        Some(Settled { start, linear })
    }

    /// The likeliest errors, starting from likely ones.
    pub fn of(about: &About<'_>, start: Start, from: Errors) -> Option<Settled> {
        let mut errors = from;
        let mut linear = about(&start, &errors)?;
        for _ in 0..PASSES {
            let next = linear.errors(&[0.0; UNKNOWNS]);
            let pairs = next.iter().flatten().zip(errors.iter().flatten());
            let change = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            errors = next;
            linear = about(&start, &errors)?;
            if change < SETTLED {
                break;
            }
        }
        Some(Settled { start, linear })
    }

    pub fn chi_square(&self) -> f64 {
        self.linear.normal.cost
    }

    /// Half the Hessian of chi-square by changes about this state.
    pub fn curvature(&self, about: &About<'_>, scale: &Scale) -> Option<Square> {
        let mut found = [[0.0; UNKNOWNS]; UNKNOWNS];
        for j in 0..UNKNOWNS {
            let size = DIFFERENCED * scale.of(j);
            let gradient = |by: f64| -> Option<Change> {
                let mut step = [0.0; UNKNOWNS];
                step[j] = by;
                let there = self.start.changed(&step)?;
                let mut near = about(&there, &self.linear.errors(&step))?;
                near = about(&there, &near.errors(&[0.0; UNKNOWNS]))?;
                Some(near.normal.gradient)
            };
            let (above, below) = (gradient(size)?, gradient(-size)?);
            for i in 0..UNKNOWNS {
                found[i][j] = (above[i] - below[i]) / (2.0 * size);
            }
        }
        for i in 0..UNKNOWNS {
            for j in 0..i {
                let mean = (found[i][j] + found[j][i]) / 2.0;
                (found[i][j], found[j][i]) = (mean, mean);
            }
        }
        found.iter().flatten().all(|value| value.is_finite()).then_some(found)
    }

    /// The state after a step, if there is one.
    fn after(&self, about: &About<'_>, step: &Change) -> Option<Settled> {
        Settled::of(about, self.start.changed(step)?, self.linear.errors(step))
    }

    /// The largest factor between the growth of chi-square and that of its parabola, three deviations along the two least observable directions, to both sides: 1 where it is a parabola, and no bound is valid
    /// far from that. Infinite where it falls. `spread` is the covariance of changes.
    pub fn bent(&self, about: &About<'_>, scale: &Scale, spread: &Spread, curvature: &Square) -> f64 {
        let sizes = Spread::from_fn(|i, j| scale.of(i) * scale.of(j));
        let scaled = spread.component_div(&sizes);
        let Some(eigen) = scaled.try_symmetric_eigen(f64::EPSILON, MOST_ITERATIONS) else {
            return f64::INFINITY;
        };
        let mut order: Vec<usize> = (0..UNKNOWNS).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let grown = |place: usize, side: f64| -> Option<f64> {
            let deviation = eigen.eigenvalues[place].max(0.0).sqrt();
            let step: Change = std::array::from_fn(|i| {
                side * DEVIATIONS * deviation * scale.of(i) * eigen.eigenvectors[(i, place)]
            });
            let mut foreseen = 0.0;
            for i in 0..UNKNOWNS {
                for j in 0..UNKNOWNS {
                    foreseen += step[i] * curvature[i][j] * step[j];
                }
                foreseen += 2.0 * step[i] * self.linear.normal.gradient[i];
            }
            let grown = self.after(about, &step)?.chi_square() - self.chi_square();
            let times = grown / foreseen;
            (times > 0.0).then(|| times.max(1.0 / times))
        };
        let places = order[..2].iter().flat_map(|place| [(*place, -1.0), (*place, 1.0)]);
        places.map(|(place, side)| grown(place, side).unwrap_or(f64::INFINITY)).fold(1.0, f64::max)
    }

    /// Towards a minimum: the last state with its curvature, and whether it is one.
    pub fn descended(self, about: &About<'_>, scale: &Scale) -> Option<(Settled, Square, bool)> {
        let errors = self.linear.errors(&[0.0; UNKNOWNS]);
        let mut here = Settled::of(about, self.start, errors)?;
        let mut curvature = here.curvature(about, scale)?;
        let mut damping = 0.0;
        let mut gain = f64::INFINITY;
        for _ in 0..STEPS {
            let Normal { gradient, matrix: told, .. } = &here.linear.normal;
            let step = |damping: f64| -> Option<Change> {
                let mut matrix = curvature;
                for i in 0..UNKNOWNS {
                    matrix[i][i] += damping * told[i][i];
                }
                solved(&matrix, UNKNOWNS, &gradient.map(|value| -value))
            };
            // none where it is not convex
            gain = step(0.0)
                .map_or(f64::INFINITY, |whole| -whole.iter().zip(gradient).map(|(a, b)| a * b).sum::<f64>());
            if gain < GAINED[0] {
                break;
            }
            let mut next = None;
            for _ in 0..12 {
                next = step(damping)
                    .and_then(|step| here.after(about, &shortened(&step, scale)))
                    .filter(|there| there.chi_square() < here.chi_square());
                if next.is_some() {
                    break;
                }
                damping = f64::max(damping * 4.0, 1e-4);
            }
            let Some(next) = next else { break };
            here = next;
            damping = if damping < 1e-3 { 0.0 } else { damping * 0.2 };
            curvature = here.curvature(about, scale)?;
        }
        Some((here, curvature, gain < GAINED[1]))
    }
}
