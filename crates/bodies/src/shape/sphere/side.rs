//! On which side of a plane a point lies: the sign of a determinant of four points, without an error.
//!
//! Points are homogeneous, `[x, y, z, w]` with `w > 0` for the place `(x, y, z)/w`, so that a half-space `n . x <= w` is a point as it is given, and no
//! quotient is rounded. A determinant in doubles is believed where it exceeds the bound of its rounding; else it is made of integers.

use dashu::integer::IBig;
use std::cmp::Ordering;

/// A homogeneous point.
pub(super) type Point = [f64; 4];

/// Doubles lose no more than this part of the sum of the products' magnitudes: each product has two roundings in either minor and one of its own, and five
/// sums follow; twice that.
const ROUNDING: f64 = 20.0 * f64::EPSILON / 2.0;

/// What underflow may take away, many times over.
const UNDERFLOW: f64 = 1e-280;

/// The two pairs of columns whose minors are multiplied, with the sign (Laplace's expansion by the first two rows).
const PAIRS: [([usize; 2], [usize; 2], bool); 6] = [
    ([0, 1], [2, 3], true),
    ([0, 2], [1, 3], false),
    ([0, 3], [1, 2], true),
    ([1, 2], [0, 3], true),
    ([1, 3], [0, 2], false),
    ([2, 3], [0, 1], true),
];

/// The determinant of four points as rows, rounded, and a bound of its error.
fn rounded(rows: [&Point; 4]) -> (f64, f64) {
    let [a, b, c, d] = rows;
    let minor = |p: &Point, q: &Point, [i, j]: [usize; 2]| {
        let (left, right) = (p[i] * q[j], p[j] * q[i]);
        (left - right, left.abs() + right.abs())
    };
    let (mut sum, mut size) = (0.0, 0.0);
    for (first, second, plus) in PAIRS {
        let ((u, u_size), (v, v_size)) = (minor(a, b, first), minor(c, d, second));
        sum += if plus { u * v } else { -(u * v) };
        size += u_size * v_size;
    }
    (sum, ROUNDING * size + UNDERFLOW)
}

/// The determinant of four points as rows, computed in doubles: a measure of distance for points beside one plane.
pub(super) fn about(rows: [&Point; 4]) -> f64 {
    rounded(rows).0
}

/// A finite point times a power of two, in integers.
pub(super) fn whole(point: &Point) -> [IBig; 4] {
    let parts = point.map(|value| {
        let bits = value.to_bits();
        let exponent = ((bits >> 52) & 0x7ff) as i32;
        let fraction = bits & ((1 << 52) - 1);
        let (digits, exponent) = if exponent == 0 { (fraction, 1) } else { (fraction | 1 << 52, exponent) };
        (value < 0.0, digits, exponent)
    });
    let least = parts.iter().filter(|part| part.1 != 0).map(|part| part.2).min().unwrap_or(0);
    parts.map(|(negative, digits, exponent)| {
        if digits == 0 {
            return IBig::ZERO;
        }
        let size = IBig::from(digits) << (exponent - least) as usize;
        if negative { -size } else { size }
    })
}

/// The sign of the determinant of four rows of integers.
pub(super) fn sign_of_whole(rows: [&[IBig; 4]; 4]) -> Ordering {
    let [a, b, c, d] = rows;
    let minor = |p: &[IBig; 4], q: &[IBig; 4], [i, j]: [usize; 2]| &p[i] * &q[j] - &p[j] * &q[i];
    let mut sum = IBig::ZERO;
    for (first, second, plus) in PAIRS {
        let product = minor(a, b, first) * minor(c, d, second);
        if plus { sum += product } else { sum -= product }
    }
    sum.cmp(&IBig::ZERO)
}

/// The sign of the determinant of four finite points as rows: exactly.
pub(super) fn side(rows: [&Point; 4]) -> Ordering {
    let (sum, error) = rounded(rows);
    if sum.abs() > error {
        return if sum > 0.0 { Ordering::Greater } else { Ordering::Less };
    }
    let [a, b, c, d] = rows.map(whole);
    sign_of_whole([&a, &b, &c, &d])
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu::rational::RBig;
    use palmistry_math::number::rational_from_f64;

    /// Against elimination in rationals: points of a plane, off it by a unit of the last place, huge and tiny.
    #[test]
    fn signs_are_those_of_rationals() {
        let exact = |rows: [&Point; 4]| {
            let mut rows = rows.map(|row| row.map(|value| rational_from_f64(value).unwrap()));
            let mut sign = RBig::ONE;
            for k in 0..4 {
                let Some(pivot) = (k..4).find(|i| !rows[*i][k].is_zero()) else { return Ordering::Equal };
                if pivot != k {
                    rows.swap(pivot, k);
                    sign = -sign;
                }
                for i in k + 1..4 {
                    let by = &rows[i][k] / &rows[k][k];
                    let pivot = rows[k].clone();
                    for (entry, above) in rows[i].iter_mut().zip(&pivot).skip(k) {
                        *entry -= &by * above;
                    }
                }
                sign *= &rows[k][k];
            }
            sign.cmp(&RBig::ZERO)
        };
        let plane = |x: f64, y: f64| [x, y, 0.3 * x - 0.7 * y + 0.1, 1.0];
        let mut seen = [0; 3];
        for step in 0..60 {
            let t = f64::from(step);
            let scale = [1.0, 1e-130, 1e70][step as usize % 3];
            let mut last = plane(t.sin(), 0.4 * t);
            last[2] = [last[2], last[2].next_up(), last[2].next_down()][(step as usize / 3) % 3];
            let rows =
                [plane(0.1, 0.2), plane(1.3, -0.4), plane(-0.7, 0.9), last].map(|p| p.map(|v| v * scale));
            let rows = [&rows[0], &rows[1], &rows[2], &rows[3]];
            let found = side(rows);
            assert_eq!(found, exact(rows), "{step}");
            seen[(found as i8 + 1) as usize] += 1;
        }
        assert!(seen[0] > 5 && seen[2] > 5, "{seen:?}");
        let unit = |i: usize| std::array::from_fn(|j| f64::from(u8::from(i == j)));
        assert_eq!(side([&unit(0), &unit(1), &unit(2), &unit(3)]), Ordering::Greater);
        assert_eq!(side([&unit(0), &unit(1), &unit(2), &unit(2)]), Ordering::Equal);
    }
}
