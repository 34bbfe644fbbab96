//! Multiple shooting by least squares with joints that stiffen.
//!
//! The states at the nodes and the constants minimise `|r|^2 + w^2 |g|^2`, `r` being expected minus measured and `g` the gaps
//! between segments. While `w` is small the measurements pull the nodes to where they have to be, each for itself; as it grows the gaps
//! close, and the result is the motion that explains the measurements best. Continuity as a hard constraint (H. G. Bock, 1983, with its
//! condensed system) would close them in the first step, along sensitivities that mean nothing as long as the nodes are far from a motion: from
//! the middle of a sample box they are. Soft joints that stiffen keep every step small and need no merit function; what remains
//! of a gap at the end is closed by the region of trust on the whole window, so that the answer is a motion of the model.
//!
//! Each step is Levenberg and Marquardt's, by orthogonal factors of one node after the other, with the constants as a border: the work
//! grows as the number of nodes, and nothing is squared.
//!
//! Reference: J. Ye et al., Systematic variational method for statistical nonlinear state and parameter estimation, Phys. Rev. E 92, 052901, 2015.

use super::Lost;
use super::nodes::{Bounds, Nodes, Segment, Segments};
use nalgebra::{DMatrix, DVector};

/// The weights of a gap of one size against a difference of one spread: from the first to the last, each so many times the one before.
const WEIGHTS: (f64, f64, f64) = (0.1, 100.0, 3.0);

/// Steps at one weight, at most; the last weight may take more.
const STEPS: (usize, usize) = (6, 12);

/// A step that lowers the error by less than this part of it is the last one of its weight.
const SETTLED: (f64, f64) = (2e-2, 1e-4);

/// Steps are refused so often at most, one after the other.
const MOST_REFUSED: usize = 12;

/// Where a search came to.
pub(super) struct Found {
    pub nodes: Nodes,
    /// The sum of the squares of expected minus measured, in units of the spreads.
    pub rms_residual: f64,
    /// The sum of the squares of the gaps, in units of the sizes.
    pub gaps: f64,
    pub steps: u64,
    pub refused: usize,
}

/// The nodes that explain the measurements of the segments best, near some nodes and within bounds. A mean square of the differences, in units
/// of the spreads, that is no more than `enough` ends the search where the gaps are narrow: the rest is for the whole window.
///
/// # Errors
/// Where a segment cannot be followed at the first nodes.
pub(super) fn seek(
    segments: &Segments<'_>,
    first: Nodes,
    bounds: &Bounds,
    enough: f64,
    interrupted: &dyn Fn() -> bool,
) -> Result<Found, Lost> {
    let mut here = segments.expand(&first)?;
    let mut found = Found { nodes: first, rms_residual: 0.0, gaps: 0.0, steps: 0, refused: 0 };
    let (mut weight, last, growth) = WEIGHTS;
    let mut lambda = 1e-2;
    while !interrupted() {
        let is_last = weight >= last;
        let (most, settled) = if is_last { (STEPS.1, SETTLED.1) } else { (STEPS.0, SETTLED.0) };
        for _ in 0..most {
            let cost = cost(&here, weight);
            let Some((nodes, there)) =
                step(segments, (&found.nodes, &here), bounds, weight, &mut lambda, &mut found.refused)
            else {
                break;
            };
            found.nodes = nodes;
            here = there;
            found.steps += 1;
            let after = self::cost(&here, weight);
            if cost - after <= settled * cost || interrupted() {
                break;
            }
        }
        if is_last || is_enough(&here, enough) {
            break;
        }
        weight = (weight * growth).min(last);
        // what was refused at one weight may go at the next
        lambda = lambda.clamp(1e-9, 1.0);
    }
    found.rms_residual = here.iter().map(|segment| segment.differences.norm_squared()).sum();
    found.gaps = here.iter().filter_map(|segment| Some(segment.gap.as_ref()?.0.norm_squared())).sum();
    Ok(found)
}

/// The root of the mean square of gaps, in units of the sizes, that a search on the whole window closes.
const NARROW: f64 = 3e-3;

fn is_enough(here: &[Segment], enough: f64) -> bool {
    let mean = |squares: f64, count: usize| squares / count.max(1) as f64;
    let differences = here.iter().map(|segment| segment.differences.len()).sum();
    let gaps = here.iter().filter_map(|segment| Some(&segment.gap.as_ref()?.0));
    let gap_count = gaps.clone().map(|gap| gap.len()).sum();
    mean(here.iter().map(|segment| segment.differences.norm_squared()).sum(), differences) <= enough
        && mean(gaps.map(|gap| gap.norm_squared()).sum(), gap_count) <= NARROW * NARROW
}

fn cost(segments: &[Segment], weight: f64) -> f64 {
    segments.iter().map(|segment| segment.cost(weight)).sum()
}

/// A step that lowers the error, with what is found there; the damping is renewed. None where no step does.
fn step(
    segments: &Segments<'_>,
    (nodes, here): (&Nodes, &[Segment]),
    bounds: &Bounds,
    weight: f64,
    lambda: &mut f64,
    refused: &mut usize,
) -> Option<(Nodes, Vec<Segment>)> {
    let before = cost(here, weight);
    let mut growth = 2.0;
    for _ in 0..MOST_REFUSED {
        let step = damped(here, weight, lambda.sqrt())?;
        let there = segments.stepped(nodes, &step, bounds);
        // what the bounds let through of it
        let step = segments.step_between(nodes, &there);
        if step.longest() < 1e-14 {
            return None;
        }
        if let Ok(expanded) = segments.expand(&there) {
            let gain = before - cost(&expanded, weight);
            let foretold = before - after(here, weight, &step);
            if gain > 0.0 && gain.is_finite() {
                let ratio = if foretold > 0.0 { gain / foretold } else { 0.5 };
                *lambda = (*lambda * (1.0 - (2.0 * ratio - 1.0).powi(3)).clamp(0.1, 2.0)).max(1e-14);
                return Some((there, expanded));
            }
        }
        *refused += 1;
        *lambda *= growth;
        growth *= 2.0;
    }
    None
}

/// The error after a step, by the linear model.
fn after(here: &[Segment], weight: f64, step: &Nodes) -> f64 {
    let one = |(place, segment): (usize, &Segment)| {
        let own = &step.moving[place];
        let differences =
            &segment.differences + &segment.by_moving * own + &segment.by_constant * &step.constant;
        let gap = segment.gap.as_ref().map_or(0.0, |(gap, by_moving, by_constant)| {
            let gap = gap + by_moving * own + by_constant * &step.constant - &step.moving[place + 1];
            weight * weight * gap.norm_squared()
        });
        differences.norm_squared() + gap
    };
    here.iter().enumerate().map(one).sum()
}

/// The step that minimises the linear model's error and `damping^2` times its own length squared, in units of the sizes.
///
/// Node by node: the rows that know of a node (what was carried over, its measurements, its damping, its joint) are made triangular; the first
/// of them give the node by the next one and the constants, and the rest is carried over.
fn damped(here: &[Segment], weight: f64, damping: f64) -> Option<Nodes> {
    let n = here.first()?.by_moving.ncols();
    let c = here.first()?.by_constant.ncols();
    // columns: this node, the next, the constants, the right side
    let width = 2 * n + c + 1;
    let mut carried: DMatrix<f64> = DMatrix::zeros(0, n + c + 1);
    let mut solved: Vec<DMatrix<f64>> = Vec::with_capacity(here.len());
    for segment in here {
        let m = segment.differences.len();
        let joint = segment.gap.as_ref().map_or(0, |_| n);
        let mut rows = DMatrix::zeros(carried.nrows() + m + n + joint, width);
        let mut at = carried.nrows();
        rows.view_mut((0, 0), (at, n)).copy_from(&carried.columns(0, n));
        rows.view_mut((0, 2 * n), (at, c + 1)).copy_from(&carried.columns(n, c + 1));
        rows.view_mut((at, 0), (m, n)).copy_from(&segment.by_moving);
        rows.view_mut((at, 2 * n), (m, c)).copy_from(&segment.by_constant);
        rows.view_mut((at, 2 * n + c), (m, 1)).copy_from(&-&segment.differences);
        at += m;
        for i in 0..n {
            rows[(at + i, i)] = damping;
        }
        at += n;
        if let Some((gap, by_moving, by_constant)) = &segment.gap {
            rows.view_mut((at, 0), (n, n)).copy_from(&(by_moving * weight));
            rows.view_mut((at, 2 * n), (n, c)).copy_from(&(by_constant * weight));
            for i in 0..n {
                rows[(at + i, n + i)] = -weight;
                rows[(at + i, 2 * n + c)] = -weight * gap[i];
            }
        }
        let triangle = rows.qr().unpack_r();
        solved.push(triangle.rows(0, n).into_owned());
        let rest = triangle.nrows() - n;
        carried = triangle.view((n, n), (rest, n + c + 1)).into_owned();
    }
    // behind the last node there is none: its columns are zero
    let rest = carried.columns(n, c + 1).into_owned();
    let mut border = DMatrix::zeros(rest.nrows() + c, c + 1);
    border.view_mut((0, 0), rest.shape()).copy_from(&rest);
    for i in 0..c {
        border[(rest.nrows() + i, i)] = damping;
    }
    let constant = match c {
        0 => DVector::zeros(0),
        _ => {
            let border = border.qr().unpack_r();
            let right = border.view((0, c), (c, 1)).column(0).into_owned();
            border.view((0, 0), (c, c)).into_owned().solve_upper_triangular(&right)?
        }
    };
    let mut moving = vec![DVector::zeros(n); here.len()];
    let mut next = DVector::zeros(n);
    for (place, rows) in solved.iter().enumerate().rev() {
        let right = rows.column(2 * n + c) - rows.columns(n, n) * &next - rows.columns(2 * n, c) * &constant;
        next = rows.columns(0, n).into_owned().solve_upper_triangular(&right)?;
        moving[place].clone_from(&next);
    }
    let step = Nodes { moving, constant };
    let mut entries = step.moving.iter().flatten().chain(step.constant.iter());
    entries.all(|value| value.is_finite()).then_some(step)
}
