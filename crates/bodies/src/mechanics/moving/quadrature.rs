//! Perimeter, area and moments of a convex body, by quadrature over its outline.

use super::form::FormError;
use super::plane::{Plane, cross, dot};
use std::f64::consts::TAU;

/// What an outline encloses, in a given frame. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Integrals {
    pub perimeter: f64,
    pub area: f64,
    /// The integral of the position over the area.
    pub first: Plane,
    /// The integral of the squared distance from the origin over the area.
    pub second: f64,
    /// The greatest change of any of them at the last refinement, relative to the power of the perimeter that has the
    /// same unit. An estimate of the error, from above where the quadrature converges.
    pub change: f64,
}

/// A relative change below this is taken for rounding.
const SETTLED: f64 = 1e-13;
/// Doublings of the number of nodes.
const DOUBLINGS: u32 = 14;

/// The nodes and weights of Gauss and Legendre on `[-1, 1]` for six nodes, exact for polynomials of degree 11
/// (Abramowitz and Stegun, table 25.4).
const GAUSS: [(f64, f64); 3] = [
    (0.238_619_186_083_196_9, 0.467_913_934_572_691_05),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_35),
];

/// The rates at which the integrals grow along an outline at the point `x` that moves at the rate `step`: the fan of
/// triangles between the origin and the outline.
pub(super) fn rates(x: Plane, step: Plane) -> [f64; 5] {
    let doubled_area = cross(x, step);
    let [first_x, first_y] = x.map(|coordinate| coordinate * doubled_area / 3.0);
    [dot(step, step).sqrt(), doubled_area / 2.0, first_x, first_y, dot(x, x) * doubled_area / 4.0]
}

fn added(mut total: [f64; 5], weight: f64, values: [f64; 5]) -> [f64; 5] {
    total.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
    total
}

/// Refines until nothing changes any more.
fn refined(mut at_level: impl FnMut(u32) -> [f64; 5]) -> Result<Integrals, FormError> {
    let mut last = at_level(0);
    let mut change = f64::INFINITY;
    for level in 1..=DOUBLINGS {
        let next = at_level(level);
        let length = next[0];
        let units = [length, length.powi(2), length.powi(3), length.powi(3), length.powi(4)];
        change = (0..5).map(|i| (next[i] - last[i]).abs() / units[i]).fold(0.0, f64::max);
        last = next;
        if change <= SETTLED {
            let [perimeter, area, x, y, second] = last;
            return Ok(Integrals { perimeter, area, first: [x, y], second, change });
        }
    }
    Err(FormError::Quadrature(change))
}

/// The integrals over one turn of an analytic periodic function, by the trapezoidal rule, which then converges
/// geometrically.
pub(super) fn over_a_turn(rates: impl Fn(f64) -> [f64; 5]) -> Result<Integrals, FormError> {
    let mut sum = [0.0; 5];
    refined(|level| {
        let count = 64u32 << level;
        let step = TAU / f64::from(count);
        // the nodes of the level before are the even ones of this
        let stride = if level == 0 { 1 } else { 2 };
        let fresh = (stride - 1..count).step_by(stride as usize).map(|i| rates(f64::from(i) * step));
        sum = fresh.fold(sum, |total, values| added(total, 1.0, values));
        sum.map(|total| total * step)
    })
}

/// The integrals over the pieces of an outline, each an analytic function of a parameter from 0 to 1.
pub(super) fn over_pieces(
    pieces: usize,
    rates: impl Fn(usize, f64) -> [f64; 5],
) -> Result<Integrals, FormError> {
    refined(|level| {
        let panels = 1u32 << level;
        let half = 0.5 / f64::from(panels);
        let mut total = [0.0; 5];
        for (piece, panel) in (0..pieces).flat_map(|piece| (0..panels).map(move |panel| (piece, panel))) {
            let middle = f64::from(2 * panel + 1) * half;
            for (node, weight) in GAUSS {
                total = added(total, weight * half, rates(piece, middle - node * half));
                total = added(total, weight * half, rates(piece, middle + node * half));
            }
        }
        total
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The integral of `t^k` over `[0, 1]` is `1/(k + 1)`: exact up to the degree 11, not for 12.
    #[test]
    fn gauss_and_legendre() {
        let integral = |k: i32| {
            let power = |t: f64| (0.5 + 0.5 * t).powi(k);
            GAUSS.iter().map(|(node, weight)| 0.5 * weight * (power(*node) + power(-node))).sum::<f64>()
        };
        for k in 0..12 {
            assert!((integral(k) * f64::from(k + 1) - 1.0).abs() < 4e-15, "{k}");
        }
        assert!((integral(12) * 13.0 - 1.0).abs() > 1e-9);
    }

    /// A square of the side 2 about (1, 1), by its four sides: its second moment about the origin is `4 (1/3 + 1/3) +
    /// 4 * 2 = 32/3`.
    #[test]
    fn a_square() {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.0, 0.0]];
        let side = |i: usize, t: f64| {
            let step = super::super::plane::along(corners[i + 1], -1.0, corners[i]);
            rates(super::super::plane::along(corners[i], t, step), step)
        };
        let found = over_pieces(4, side).unwrap();
        let expected =
            [(found.perimeter, 8.0), (found.area, 4.0), (found.first[0], 4.0), (found.second, 32.0 / 3.0)];
        for (value, exact) in expected {
            assert!((value - exact).abs() < 1e-14, "{value} {exact}");
        }
    }

    #[test]
    fn what_does_not_settle_is_an_error() {
        assert!(matches!(
            over_a_turn(|a| [1.0, a.sqrt().sqrt(), 0.0, 0.0, 0.0]),
            Err(FormError::Quadrature(_))
        ));
    }
}
