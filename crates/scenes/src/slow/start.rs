//! The one constant that the measurements leave open, estimated with no prior knowledge.
//!
//! Where the numerator of 3.37 vanishes and the body turns, the denominator vanishes too: the centre of mass passes the centre of rotation, whose height is measured. Each such moment
//! is a vote for the height at the first sample; zeros at which the body rests are scattered votes. Where noise drowns the numerator, closure decides: the same direction touched twice has one radius, so that one closed
//! support function goes through all radii of a track only where the constant is right.

use super::closure::closed;
use super::found::{EXACT, SlowShape};
use super::measurements::SlowMeasurements;
use super::orders::Orders;
use super::quadrature::Quadrature;
use super::together::Together;

/// Votes within this fraction of the mean contact are for the same constant.
const SAME_VOTE: f64 = 2e-3;

/// Closure is evaluated at steps of this fraction of the mean contact.
const SCAN: f64 = 0.02;

/// The number of starts.
const STARTS: usize = 8;

/// The number of starts for a single window.
const BRIEF_STARTS: usize = 3;

/// The number of starts that are gone through by parts.
const PARTED: usize = 2;

/// The order of the closed function for closure.
const ORDER: usize = 8;

/// A constant determined by zeros of 3.37's numerator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vote {
    /// The height of the centre of mass at the first sample, in m.
    pub height: f64,
    /// The number of zeros that agree on it, to a five-hundredth of the mean contact.
    pub votes: usize,
}

/// The constants determined by zeros of the numerator of 3.37, those with most votes first.
pub fn votes(measurements: &SlowMeasurements) -> Vec<Vote> {
    let quadrature = Quadrature::of(measurements);
    let rates = measurements.contact_rates(9);
    let rows = measurements.rows();
    let numerators: Vec<f64> =
        (0..rows).map(|row| measurements.sampled(row).turning([0.0; 2], rates[row])[0]).collect();
    let constant = |row: usize| measurements.sampled(row).rotation_centre()[1] - quadrature.lifted[row];
    let mut told: Vec<f64> = (1..rows)
        .filter(|row| (numerators[row - 1] < 0.0) != (numerators[*row] < 0.0))
        .map(|row| {
            // the zero between, and the constant there, by the cubic through the samples about it
            let part = numerators[row - 1] / (numerators[row - 1] - numerators[row]);
            let first = row.max(2).min(rows.saturating_sub(2).max(2)) - 2;
            if rows < 4 {
                return constant(row - 1) + part * (constant(row) - constant(row - 1));
            }
            let place = (row - 1) as f64 + part;
            let nodes = first..first + 4;
            nodes
                .clone()
                .map(|j| {
                    let others = nodes.clone().filter(|k| *k != j);
                    let basis: f64 = others.map(|k| (place - k as f64) / (j as f64 - k as f64)).product();
                    basis * constant(j)
                })
                .sum()
        })
        .filter(|constant: &f64| constant.is_finite())
        .collect();
    told.sort_by(f64::total_cmp);
    let near = SAME_VOTE * measurements.scale();
    let mut all: Vec<Vote> = Vec::new();
    for group in told.chunk_by(|a, b| b - a <= near) {
        all.push(Vote { height: group[group.len() / 2], votes: group.len() });
    }
    all.sort_by_key(|one| std::cmp::Reverse(one.votes));
    all
}

/// A constant, and the residual of one closed function through the radii that follow from it.
struct Closed {
    height: f64,
    /// The root mean square residual, relative to the mean radius.
    left: f64,
}

/// Initial heights, the best first.
fn starts(measurements: &SlowMeasurements, quadrature: &Quadrature) -> Vec<f64> {
    let scale = measurements.scale();
    let [low, high] = quadrature.heights();
    let low = low.max(-4.0 * scale);
    let high = high.min(low + 4.0 * scale);
    let at = |height: f64| {
        let left = closed(measurements, &quadrature.track(&measurements.times, height), ORDER)?.1;
        Some(Closed { height, left })
    };
    let count = ((high - low) / (SCAN * scale)).ceil().clamp(1.0, 400.0) as usize;
    let grid: Vec<Option<Closed>> =
        (1..count).map(|i| at(low + (high - low) * i as f64 / count as f64)).collect();
    let left = |i: usize| grid.get(i).and_then(Option::as_ref).map_or(f64::INFINITY, |at| at.left);
    let mut all: Vec<Closed> = (0..grid.len())
        .filter(|i| left(*i).is_finite() && left(*i) <= left(i + 1) && (*i == 0 || left(*i) <= left(i - 1)))
        .filter_map(|i| {
            // golden section between the neighbours
            let (mut a, mut b) = (left_height(&grid, i, -1)?, left_height(&grid, i, 1)?);
            let mut best = Closed { height: grid[i].as_ref()?.height, left: left(i) };
            for _ in 0..8 {
                let third = (b - a) / 3.0;
                let (x, y) = (at(a + third)?, at(b - third)?);
                if x.left < y.left {
                    b = y.height
                } else {
                    a = x.height
                }
                best = [best, x, y].into_iter().min_by(|x, y| x.left.total_cmp(&y.left))?;
            }
            Some(best)
        })
        .collect();
    if measurements.sigma == 0.0 {
        all.extend(votes(measurements).into_iter().take(4).filter_map(|vote| at(vote.height)));
    }
    all.sort_by(|a, b| a.left.total_cmp(&b.left));
    all.iter().map(|at| at.height).take(STARTS).collect()
}

fn left_height(grid: &[Option<Closed>], i: usize, by: isize) -> Option<f64> {
    let beside = i.checked_add_signed(by).and_then(|i| grid.get(i)).and_then(Option::as_ref);
    beside.or(grid[i].as_ref()).map(|at| at.height)
}

/// Shape and motion from the measurements alone, with no prior knowledge: several constants by closure, a batch estimate from each, and the residuals of the measurements
/// to decide. None where no start can be followed; whether the measurements are explained says [`SlowShape::explains`].
pub fn from_nothing(measurements: &SlowMeasurements, interrupt: &dyn Fn() -> bool) -> Option<SlowShape> {
    from_nothing_within(measurements, Orders::CHOSEN, interrupt)
}

/// The same with given orders.
pub(super) fn from_nothing_within(
    measurements: &SlowMeasurements,
    orders: Orders,
    interrupt: &dyn Fn() -> bool,
) -> Option<SlowShape> {
    let wholly = Effort { starts: STARTS, orders: &[ORDER, 4, 2], parted: PARTED };
    search(measurements, orders, &wholly, interrupt)
}

/// The same with few starts: for a window of which there are many.
pub(super) fn from_nothing_briefly(
    measurements: &SlowMeasurements,
    orders: Orders,
    interrupt: &dyn Fn() -> bool,
) -> Option<SlowShape> {
    let briefly = Effort { starts: BRIEF_STARTS, orders: &[ORDER, 3], parted: 0 };
    search(measurements, orders, &briefly, interrupt)
}

/// How much is tried.
struct Effort {
    starts: usize,
    /// Of the closed functions that the search starts from.
    orders: &'static [usize],
    /// The number of starts that are gone through by parts.
    parted: usize,
}

fn search(
    measurements: &SlowMeasurements,
    orders: Orders,
    effort: &Effort,
    interrupt: &dyn Fn() -> bool,
) -> Option<SlowShape> {
    let quadrature = Quadrature::of(measurements);
    let together = Together::of(measurements);
    let mut best: Option<SlowShape> = None;
    let better = |best: &mut Option<SlowShape>, found: Option<SlowShape>| {
        if let Some(found) = found
            && best.as_ref().is_none_or(|best| found.rms_residual < best.rms_residual)
        {
            *best = Some(found);
        }
        best.as_ref().is_some_and(|best| best.explains(orders.enough.max(EXACT * 1e-2))) || interrupt()
    };
    let heights = starts(measurements, &quadrature);
    // the whole from every start; then, where nothing explains it, from its first part on
    for (by_parts, count, closed_orders) in
        [(false, effort.starts, effort.orders), (true, effort.parted, &[ORDER][..])]
    {
        for height in heights.iter().take(count) {
            let track = quadrature.track(&measurements.times, *height);
            for order in closed_orders {
                let Some((support, _)) = closed(measurements, &track, *order) else { continue };
                let found = match by_parts {
                    false => together.explain(&support, &track.phi0, orders, interrupt),
                    true => {
                        Together::explain_by_parts(measurements, &support, &track.phi0, orders, interrupt)
                    }
                };
                if better(&mut best, found) {
                    return best;
                }
            }
        }
    }
    best
}
