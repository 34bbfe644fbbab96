//! The minima of the potential over a turn, and the descent to one.
//!
//! The slope of the potential is followed over cells of half a degree. Where its own slope changes sign within a cell the extremum is found first, so that two equilibria
//! that lie in one cell (as they do near a fold) are both found. What can be missed are two extrema of the slope in one cell: detail of the outline finer than that.

use super::potential::ConvexBody;
use std::f64::consts::TAU;

/// Cells of a turn.
const CELLS: usize = 720;

/// More steps than this no bracket needs: bisection alone takes fifty.
const MOST_STEPS: usize = 80;

/// A pose in which forces and torques balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BalancedPose {
    /// In radians.
    pub phi0: f64,
    /// The second derivative of the potential there, in metres per square radian: positive in a stable pose.
    pub stiffness: f64,
}

/// First and second derivative of the potential by `phi0`.
pub(super) fn slope<B: ConvexBody + ?Sized>(body: &B, phi0: f64, palms: [f64; 2]) -> [f64; 2] {
    let all = super::potential::normals(phi0, palms).map(|angle| body.support(angle));
    let [phi1, phi2] = palms;
    let (a, b, c) = ((phi1 + phi2).sin(), phi1.sin(), phi2.sin());
    [-(a * all[0][1] + b * all[1][1]) / c, (a * all[0][2] + b * all[1][2]) / c]
}

/// The zero of a function between two places where its signs differ, by Newton's steps while they stay between and by halves else. `at` gives value and slope.
fn zero(at: &dyn Fn(f64) -> [f64; 2], mut low: f64, mut high: f64, low_is_negative: bool) -> f64 {
    let mut x = f64::midpoint(low, high);
    let mut width = (high - low).abs();
    for _ in 0..MOST_STEPS {
        let [value, slope] = at(x);
        if value == 0.0 {
            return x;
        }
        if (value < 0.0) == low_is_negative {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope;
        let step = (newton - x).abs();
        let inside = newton > low.min(high) && newton < low.max(high);
        // steps that do not shrink by half are halves
        let next = if inside && 2.0 * step < width { newton } else { f64::midpoint(low, high) };
        width = (next - x).abs();
        if width <= f64::EPSILON * x.abs().max(1.0) {
            return next;
        }
        x = next;
    }
    x
}

/// Values and slopes at the end of a cell.
#[derive(Clone, Copy)]
struct Node {
    phi0: f64,
    value: [f64; 2],
}

/// The cell cut at the extremum of the function in it, if there is one: its nodes in order.
fn cut(at: &dyn Fn(f64) -> [f64; 2], a: Node, b: Node) -> ([Node; 3], usize) {
    let (first, last) = (a.value[1], b.value[1]);
    if (first < 0.0) == (last < 0.0) {
        return ([a, b, b], 2);
    }
    let (mut low, mut high) = (a.phi0, b.phi0);
    // the slope's sign by halves: its own derivative is not known, and kinks where the outline's curvature does
    let mut middle = a;
    for _ in 0..MOST_STEPS {
        let phi0 = f64::midpoint(low, high);
        middle = Node { phi0, value: at(phi0) };
        if (middle.value[1] < 0.0) == (first < 0.0) {
            low = phi0;
        } else {
            high = phi0;
        }
        // only the value at the extremum is needed: it is flat there
        if (high - low).abs() < 1e-9 {
            break;
        }
    }
    ([a, middle, b], 3)
}

/// Every equilibrium over the turn, by its angle from zero to a turn, stable and unstable ones in alternation.
///
/// None at all where the potential does not change with the turn, as that of a disc about its middle.
pub fn stationary_poses<B: ConvexBody + ?Sized>(body: &B, palms: [f64; 2]) -> Vec<BalancedPose> {
    let at = |phi0: f64| slope(body, phi0, palms);
    let node = |i: usize| {
        let phi0 = TAU * i as f64 / CELLS as f64;
        Node { phi0, value: at(phi0) }
    };
    let mut found = Vec::new();
    let first = node(0);
    let mut a = first;
    for i in 1..=CELLS {
        // the last node is the first: no equilibrium is lost or met twice for a rounding error
        let b = if i == CELLS { Node { phi0: TAU, ..first } } else { node(i) };
        let (nodes, count) = cut(&at, a, b);
        for pair in nodes[..count].windows(2) {
            if (pair[0].value[0] < 0.0) != (pair[1].value[0] < 0.0) {
                let phi0 = zero(&at, pair[0].phi0, pair[1].phi0, pair[0].value[0] < 0.0);
                found.push(BalancedPose { phi0, stiffness: at(phi0)[1] });
            }
        }
        a = b;
    }
    found
}

/// Every stable pose, by its angle from zero to a turn: all minima of the potential, at palms where `sin phi2` is positive.
pub fn stable_poses<B: ConvexBody + ?Sized>(body: &B, palms: [f64; 2]) -> Vec<f64> {
    let all = stationary_poses(body, palms).into_iter();
    all.filter(|at| at.stiffness > 0.0).map(|at| at.phi0).collect()
}

/// The way down from a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Descent {
    /// Where it ends.
    pub phi0: f64,
    /// Whether the potential is curved upwards all the way: the minimum is then the one whose slope was stood on.
    pub convex: bool,
}

pub(super) fn descent<B: ConvexBody + ?Sized>(body: &B, palms: [f64; 2], from: f64) -> Option<Descent> {
    let at = |phi0: f64| slope(body, phi0, palms);
    let mut a = Node { phi0: from, value: at(from) };
    let mut convex = a.value[1] > 0.0;
    if a.value[0] == 0.0 && convex {
        return Some(Descent { phi0: from, convex });
    }
    // from a crest it falls forwards
    let direction = if a.value[0] > 0.0 { -1.0 } else { 1.0 };
    let step = direction * TAU / CELLS as f64;
    let is_down = |value: f64| direction * value < 0.0;
    for i in 1..=CELLS {
        let phi0 = from + step * i as f64;
        let b = Node { phi0, value: at(phi0) };
        let (nodes, count) = cut(&at, a, b);
        for pair in nodes[..count].windows(2) {
            if !is_down(pair[1].value[0]) && is_down(pair[0].value[0]) {
                let phi0 = zero(&at, pair[0].phi0, pair[1].phi0, direction > 0.0);
                // up to the minimum the curvature's sign is that of the nodes and of the cuts between
                convex &= at(phi0)[1] > 0.0;
                return Some(Descent { phi0, convex });
            }
            convex &= pair[1].value[1] > 0.0;
        }
        a = b;
    }
    None
}

/// The minimum to which a body falls that is released in a pose: the next one downhill, however far, not taken into the first turn. None where there is no way down, as
/// for a disc about its middle, or the palms' angles are none.
pub fn descend<B: ConvexBody + ?Sized>(body: &B, palms: [f64; 2], from: f64) -> Option<f64> {
    descent(body, palms, from).map(|found| found.phi0).filter(|phi0| phi0.is_finite())
}
