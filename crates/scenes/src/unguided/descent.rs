//! Steps that make the residuals smaller.

use super::carried;
use super::integrals::Integrals;
use super::normal::{self, Look, Normal, Unknowns};

/// Which unknowns are free.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Free {
    /// All, with a prior on `k`, that of a disc, weighted by the residuals.
    Drawn,
    /// All.
    All,
}

/// The indices of the free unknowns.
fn places(all: &Integrals) -> std::ops::Range<usize> {
    if all.log_k.is_some() { 0..5 } else { 0..6 }
}

/// The solution of a part of the normal equations with the diagonal enlarged by a fraction of itself, by Cholesky; the lower triangle is
/// given.
fn solve(normal: &Normal, places: &std::ops::Range<usize>, damping: f64) -> Option<[f64; 6]> {
    let (start, size) = (places.start, places.len());
    let mut l = [[0.0; 6]; 6];
    for i in 0..size {
        for j in 0..=i {
            let mut value = normal.matrix[start + i][start + j];
            if i == j {
                value *= 1.0 + damping;
            }
            value -= l[i][..j].iter().zip(&l[j][..j]).map(|(a, b)| a * b).sum::<f64>();
            l[i][j] = if i != j {
                value / l[j][j]
            } else if value > 0.0 {
                value.sqrt()
            } else {
                return None;
            };
        }
    }
    let mut y = [0.0; 6];
    for i in 0..size {
        let sum: f64 = (0..i).map(|m| l[i][m] * y[m]).sum();
        y[i] = (-normal.gradient[start + i] - sum) / l[i][i];
    }
    let mut step = [0.0; 6];
    for i in (0..size).rev() {
        let sum: f64 = (i + 1..size).map(|m| l[m][i] * step[start + m]).sum();
        step[start + i] = (y[i] - sum) / l[i][i];
    }
    step.iter().all(|value| value.is_finite()).then_some(step)
}

/// The weight of the prior on `k`, relative to the residuals.
const DRAWN: f64 = 0.3;
/// The residual of a contact, relative to its length, below which no further step is taken.
const ROUNDING: f64 = 1e-8;
/// `k` changes by no more than this factor's logarithm in one step.
const LONGEST: f64 = 1.5;

/// Levenberg and Marquardt's method from a start; the unknowns and the sum of the squares that it ends with.
pub(super) fn descend(
    all: &Integrals,
    start: Unknowns,
    free: Free,
    look: Look,
    steps: usize,
) -> (Unknowns, f64) {
    let places = places(all);
    // a start for a descent by all samples need not be more accurate than some of them allow
    let settled = if look.stride > 1 { 1e-2 } else { 1e-6 };
    let nothing = all.samples.len() as f64 * (ROUNDING * all.length).powi(2);
    let mut x = start;
    let mut damping = 1e-3;
    let mut normal = normal::expand(all, &x, look);
    let mut reached = normal.cost;
    for taken in 0..steps {
        let (draw, likely) = match free {
            Free::Drawn if all.log_k.is_none() => (DRAWN * normal.cost, all.likely_log_k([x[0], x[1]])),
            _ => (0.0, 0.0),
        };
        let drawn = |cost: f64, x: &Unknowns| cost + draw * (x[5] - likely) * (x[5] - likely);
        normal.matrix[5][5] += draw;
        normal.gradient[5] += draw * (x[5] - likely);
        let before = drawn(normal.cost, &x);
        let mut better = None;
        for _ in 0..6 {
            if let Some(mut step) = solve(&normal, &places, damping) {
                step[5] = step[5].clamp(-LONGEST, LONGEST);
                let there: Unknowns = std::array::from_fn(|i| x[i] + step[i]);
                let cost = normal::cost(all, &there, look);
                if drawn(cost, &there) < before {
                    better = Some((there, cost));
                    break;
                }
            }
            damping *= 8.0;
        }
        let Some((there, cost)) = better else { break };
        let is_settled = drawn(cost, &there) > before * (1.0 - settled) || cost <= nothing;
        (x, reached) = (there, cost);
        damping *= 0.1;
        // the last step needs no derivatives
        if is_settled || taken + 1 == steps {
            break;
        }
        normal = normal::expand(all, &x, look);
    }
    (x, reached)
}

/// Rates below this fraction of the largest likely one are softened where errors are carried on.
const SOFTENED: f64 = 0.0005;

/// A step that lowers the sum of the squares by no more than this fraction is the last one.
const SETTLED: f64 = 1e-3;

/// The end of a step that the normal equations predict to be the last, and the predicted cost: it is taken without an evaluation there.
fn last_step(all: &Integrals, normal: &Normal, x: &Unknowns, damping: f64) -> Option<(Unknowns, f64)> {
    let step = solve(normal, &places(all), damping)?;
    let gained = -step.iter().zip(&normal.gradient).map(|(step, gradient)| step * gradient).sum::<f64>();
    (gained < SETTLED * normal.cost).then(|| (std::array::from_fn(|i| x[i] + step[i]), normal.cost - gained))
}

/// Where a descent by all samples ends.
pub(super) struct End {
    pub x: Unknowns,
    /// The sum of the squares there.
    pub cost: f64,
    /// The normal equations there, of the whitened residuals, where they are at hand.
    pub carried: Option<Normal>,
}

/// Levenberg and Marquardt's method on the whitened residuals, with all unknowns free.
pub(super) fn refine(all: &Integrals, start: Unknowns, steps: usize) -> End {
    let places = places(all);
    let softened = SOFTENED * all.rate;
    let mut x = start;
    let mut normal = carried::expand(all, &x, softened);
    let mut damping = 1e-6;
    for _ in 0..steps {
        if let Some((there, cost)) = last_step(all, &normal, &x, damping) {
            (x, normal.cost) = (there, cost);
            break;
        }
        let mut better = None;
        for _ in 0..5 {
            if let Some(mut step) = solve(&normal, &places, damping) {
                step[5] = step[5].clamp(-LONGEST, LONGEST);
                let there: Unknowns = std::array::from_fn(|i| x[i] + step[i]);
                let next = carried::expand(all, &there, softened);
                if there[4].abs() <= all.fastest() && next.cost < normal.cost {
                    better = Some((there, next));
                    break;
                }
            }
            damping = (damping * 30.0).max(1e-4);
        }
        let Some((there, next)) = better else { break };
        let is_settled = next.cost > normal.cost * (1.0 - SETTLED);
        (x, normal) = (there, next);
        damping *= 0.03;
        if is_settled {
            break;
        }
    }
    let cost = if normal.cost.is_nan() { f64::INFINITY } else { normal.cost };
    End { x, cost, carried: Some(normal) }
}

/// The least standard deviations of the palms' radii and the rate where a descent ended, for contacts whose errors have the deviation one; infinite where
/// they are not observable.
pub(super) fn deviations(all: &Integrals, end: &End) -> [f64; 3] {
    let places = places(all);
    let normal = end.carried.clone().unwrap_or_else(|| carried::expand(all, &end.x, SOFTENED * all.rate));
    let [first, second] = all.samples[0].palms.map(|palm| palm.normal);
    let sought = [
        [first[0], first[1], 0.0, 0.0, 0.0, 0.0],
        [second[0], second[1], 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
    ];
    sought.map(|direction| {
        let towards = Normal { gradient: direction.map(|value| -value), ..normal.clone() };
        let column = solve(&towards, &places, 0.0);
        let variance = column.map(|column| column.iter().zip(&direction).map(|(a, b)| a * b).sum::<f64>());
        variance.filter(|variance| *variance >= 0.0).map_or(f64::INFINITY, f64::sqrt)
    })
}
