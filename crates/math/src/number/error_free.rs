//! Error-free transformations: a rounded sum or product of two doubles together with what the rounding took away, as
//! a double. The bricks of [`Interval`](super::Interval) and [`DoubleDouble`](super::DoubleDouble).

/// `x + y - sum` exactly, where `sum` is `x + y` rounded, whichever is the greater (D. E. Knuth, TAOCP 2, 4.2.2,
/// theorem B; no underflow can harm it). A NaN where a step overflows, or where an operand is infinite.
#[inline]
pub(super) fn sum_error(x: f64, y: f64, sum: f64) -> f64 {
    let rest = sum - x;
    (x - (sum - rest)) + (y - rest)
}

/// `x + y` rounded, and its error.
#[inline]
pub(super) fn two_sum(x: f64, y: f64) -> (f64, f64) {
    let sum = x + y;
    (sum, sum_error(x, y, sum))
}

/// As [`two_sum`], for `|x| >= |y|` or `x = 0` (T. J. Dekker, *A floating-point technique for extending the available
/// precision*, Numer. Math. 18 (1971)).
#[inline]
pub(super) fn fast_two_sum(x: f64, y: f64) -> (f64, f64) {
    let sum = x + y;
    (sum, y - (sum - x))
}

/// `x * y` rounded, and its error; exact where the product is above 2^-960 or zero (lower down the error may itself
/// be rounded, to a multiple of 2^-1074).
///
/// By one fused multiplication where the compiler may use it; else by Dekker's product of halves, which is as exact. A
/// call of the library's fused multiplication would cost the same where the library finds the processor's own, and many
/// times more where it does not.
#[inline]
pub(super) fn two_product(x: f64, y: f64) -> (f64, f64) {
    let product = x * y;
    if cfg!(target_feature = "fma") {
        return (product, x.mul_add(y, -product));
    }
    let ((x1, x2), (y1, y2)) = (halves(x), halves(y));
    let error = ((x1 * y1 - product) + x1 * y2 + x2 * y1) + x2 * y2;
    if error.is_nan() { (product, product_error_near_overflow(x, y, product)) } else { (product, error) }
}

/// A double as the sum of two with at most 26 bits each (Veltkamp). A NaN above 2^996.
#[inline]
fn halves(x: f64) -> (f64, f64) {
    let c = 134217729.0 * x; // 2^27 + 1
    let high = c - (c - x);
    (high, x - high)
}

#[cold]
fn product_error_near_overflow(x: f64, y: f64, product: f64) -> f64 {
    if product.is_finite() { x.mul_add(y, -product) } else { 0.0 }
}
