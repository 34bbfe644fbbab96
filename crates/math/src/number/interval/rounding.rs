//! The directed operations on single doubles: a result that is never above (`_down`) or never below (`_up`) the exact
//! one. These are the careful forms, right for zeros, infinities, overflow and underflow; the operators of intervals
//! take shorter ways where none of these is near.
//!
//! An infinite argument is an end that does not exist, and so 0 * inf = 0. Downwards the result is never +inf: what
//! overflowed is a number above the greatest double.

use super::Interval;
use crate::number::DoubleDouble;
use crate::number::error_free::sum_error;

/// The fraction bits of a double.
pub(super) const FRACTION: u64 = (1 << 52) - 1;

/// The lowest 27 bits. Where two numbers have none of them set their significands have at most 26 bits each, and
/// their product fits into 53.
pub(super) const LOWER_HALF: u64 = (1 << 27) - 1;

/// 2^-960: above this magnitude nothing is near the doubles below 2^-1022, which have fewer bits.
pub(super) const SAFE: f64 = f64::from_bits(((1023 - 960) as u64) << 52);

/// Whether `x * y` is exact, if neither overflow nor underflow is near. Sufficient, not necessary.
#[inline]
pub(super) fn is_short_product(x: f64, y: f64) -> bool {
    let (x, y) = (x.to_bits(), y.to_bits());
    x & FRACTION == 0 || y & FRACTION == 0 || (x | y) & LOWER_HALF == 0
}

/// Whether `quotient` is exactly `x / y`. Sufficient, not necessary; `x` and the quotient are far from underflow.
#[inline]
pub(super) fn is_short_quotient(x: f64, y: f64, quotient: f64) -> bool {
    y.to_bits() & FRACTION == 0 || is_short_product(quotient, y) && quotient * y == x
}

/// `x + y`, neither of them +inf.
pub(super) fn add_down(x: f64, y: f64) -> f64 {
    let sum = x + y;
    if sum_error(x, y, sum) >= 0.0 { sum } else { sum.next_down() }
}

/// `x + y`, neither of them -inf.
pub(super) fn add_up(x: f64, y: f64) -> f64 {
    -add_down(-x, -y)
}

/// `x * y`
pub(super) fn mul_down(x: f64, y: f64) -> f64 {
    if x == 0.0 || y == 0.0 {
        return 0.0;
    }
    let product = x * y;
    if (SAFE..=f64::MAX).contains(&product.abs()) && is_short_product(x, y) {
        product
    } else if product == 0.0 && (x > 0.0) == (y > 0.0) {
        0.0
    } else {
        product.next_down()
    }
}

/// `x * y`
pub(super) fn mul_up(x: f64, y: f64) -> f64 {
    -mul_down(-x, y)
}

/// `x / y` for a `y` that is not zero; not both are infinite.
pub(super) fn div_down(x: f64, y: f64) -> f64 {
    if x == 0.0 || y.is_infinite() {
        return 0.0; // with an infinite divisor zero is the limit, and bounds what has its sign
    }
    let quotient = x / y;
    let safe = |size: f64| (SAFE..=f64::MAX).contains(&size.abs());
    if safe(quotient) && safe(x) && is_short_quotient(x, y, quotient) {
        quotient
    } else if quotient == 0.0 && (x > 0.0) == (y > 0.0) {
        0.0
    } else {
        quotient.next_down()
    }
}

/// `x / y`, as [`div_down`].
pub(super) fn div_up(x: f64, y: f64) -> f64 {
    -div_down(-x, y)
}

/// The square root of an `x >= 0`: below, and above.
pub(super) fn sqrt_down(x: f64) -> f64 {
    let root = x.sqrt();
    if is_exact_root(x, root) { root.min(f64::MAX) } else { root.next_down() }
}

/// As [`sqrt_down`], from above.
pub(super) fn sqrt_up(x: f64) -> f64 {
    let root = x.sqrt();
    if is_exact_root(x, root) { root } else { root.next_up() }
}

fn is_exact_root(x: f64, root: f64) -> bool {
    x == 0.0 || x >= SAFE && root.to_bits() & LOWER_HALF == 0 && root * root == x
}

/// The doubles around the number of which this is the value of a function, right to `2^-100` of itself.
pub(super) fn around(value: DoubleDouble) -> Interval {
    let (hi, lo) = (value.hi(), value.lo());
    if hi.abs() < 1e-270 {
        // here a double-double may have no low part; it is right to a unit in the last place of a double
        return Interval { lo: hi.next_down().next_down(), hi: hi.next_up().next_up() };
    }
    if hi.is_infinite() {
        return Interval::point(hi);
    }
    // |lo| is at most half a step from hi in either direction, and the error far below the other half
    let error = hi.abs() * f64::from_bits((1023 - 99) << 52);
    Interval {
        lo: if lo >= error { hi } else { hi.next_down() },
        hi: if lo <= -error { hi } else { hi.next_up() },
    }
}
