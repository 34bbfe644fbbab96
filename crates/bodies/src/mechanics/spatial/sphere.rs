//! Functions of a direction: whether one is positive everywhere, and integrals over all directions.

use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};

/// Where a function of a direction is not positive, or cannot be shown to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Doubt {
    pub direction: Vector3<f64>,
    pub value: f64,
}

/// A square of a cube's face is quartered this often before it is given up: values below about `4e-4` of the slope stay open.
const DEPTH: u32 = 12;
/// More squares are not looked at.
const MOST: usize = 4_000_000;

/// Whether a function of unit vectors is positive everywhere, given that it changes by no more than `slope` times the angle, and
/// that its computed values are off by no more than `rounding`.
///
/// Directions are the points of a cube around the unit sphere. The angle that a square of its faces subtends is no wider than the square,
/// so a value above the slope times half its diagonal is a proof for all of it; other squares are quartered.
pub(super) fn positive_everywhere(
    function: impl Fn(&Vector3<f64>) -> f64,
    slope: f64,
    rounding: f64,
) -> Result<(), Doubt> {
    let mut open: Vec<(usize, f64, [f64; 2], f64, u32)> = Vec::new();
    for axis in 0..3 {
        open.extend([-1.0, 1.0].map(|side| (axis, side, [0.0, 0.0], 1.0, 0)));
    }
    let mut looked = 0;
    while let Some((axis, side, middle, half, depth)) = open.pop() {
        let mut corner = Vector3::zeros();
        corner[axis] = side;
        corner[(axis + 1) % 3] = middle[0];
        corner[(axis + 2) % 3] = middle[1];
        let direction = corner.normalize();
        let value = function(&direction);
        if value > rounding + slope * half * 2f64.sqrt() * (1.0 + 1e-9) {
            continue;
        }
        looked += 1;
        if value <= rounding || value.is_nan() || depth == DEPTH || looked > MOST {
            return Err(Doubt { direction, value });
        }
        let quarter = half / 2.0;
        for (dx, dy) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let at = [middle[0] + dx * quarter, middle[1] + dy * quarter];
            open.push((axis, side, at, quarter, depth + 1));
        }
    }
    Ok(())
}

/// Nodes of the first rule, and how often they are doubled.
const FIRST: usize = 16;
const DOUBLINGS: u32 = 6;
/// A relative change below this is taken for rounding.
const SETTLED: f64 = 1e-13;

/// The integrals of some functions over all directions, by the rule of Gauss and Legendre along the axis and the trapezoidal rule
/// around it, which converge geometrically for analytic functions: refined until nothing changes any more.
///
/// # Errors
/// The last change, relative to the greatest integral, where it does not settle.
pub(super) fn over_all_directions<const N: usize>(
    function: impl Fn(&Vector3<f64>) -> [f64; N],
) -> Result<[f64; N], f64> {
    let rule = |nodes: usize| {
        let mut total = [0.0; N];
        let around = 2 * nodes;
        let step = TAU / around as f64;
        for (z, weight) in gauss_legendre(nodes) {
            let rho = ((1.0 - z) * (1.0 + z)).sqrt();
            for k in 0..around {
                let (sine, cosine) = (step * (k as f64 + 0.5)).sin_cos();
                let values = function(&Vector3::new(rho * cosine, rho * sine, z));
                total.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * step * value);
            }
        }
        total
    };
    let mut last = rule(FIRST);
    let mut change = f64::INFINITY;
    for level in 1..=DOUBLINGS {
        let next = rule(FIRST << level);
        let size = next.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        change = next.iter().zip(last).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size;
        if change <= SETTLED {
            return Ok(next);
        }
        last = next;
    }
    Err(change)
}

/// The nodes and weights on `[-1, 1]`: the zeros of a Legendre polynomial, by Newton's method from Tricomi's guesses.
fn gauss_legendre(nodes: usize) -> Vec<(f64, f64)> {
    let n = nodes as f64;
    let polynomial = |x: f64| {
        let (mut before, mut here) = (1.0, x);
        for k in 2..=nodes {
            let k = k as f64;
            (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
        }
        (here, n * (x * here - before) / (x * x - 1.0))
    };
    let node = |i: usize| {
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        for _ in 0..100 {
            let (value, slope) = polynomial(x);
            let by = value / slope;
            x -= by;
            if by.abs() < 1e-15 {
                break;
            }
        }
        let slope = polynomial(x).1;
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..nodes).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `e + 1 + x y z sqrt(27)` has the minimum `e` at `(-1, 1, 1)/sqrt(3)`.
    #[test]
    fn the_sign_is_decided_where_a_grid_would_miss_it() {
        let offset = |e: f64| move |n: &Vector3<f64>| e + 1.0 + 27f64.sqrt() * n.x * n.y * n.z;
        assert_eq!(positive_everywhere(offset(5e-3), 9.0, 1e-14), Ok(()));
        // squares at the edge of where it is negative stay open too
        assert!(positive_everywhere(offset(-1e-2), 9.0, 1e-14).is_err());
        assert!(positive_everywhere(|_| f64::NAN, 9.0, 0.0).is_err());
    }

    /// The area of the sphere, and `x^2`, `x^4 y^2 z^2` over it: `4 pi/3`, and `4 pi 3/(3 5 7 9)` by the moments of a Gaussian.
    #[test]
    fn integrals_of_powers() {
        let found = over_all_directions(|n| [1.0, n.x * n.x, n.x.powi(4) * n.y * n.y * n.z * n.z]).unwrap();
        for (found, expected) in found.iter().zip([4.0 * PI, 4.0 * PI / 3.0, 4.0 * PI * 3.0 / 945.0]) {
            assert!((found - expected).abs() < 1e-13, "{found} {expected}");
        }
        assert!(over_all_directions(|n| [if n.x > 0.3 { 1.0 } else { 0.0 }]).is_err());
    }
}
