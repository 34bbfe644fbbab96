//! Sum, difference, product and quotient of intervals, as operators.

use super::Interval;
use super::rounding::{
    FRACTION, LOWER_HALF, SAFE, add_down, add_up, div_down, div_up, is_short_quotient, mul_down, mul_up,
};
use crate::number::error_free::sum_error;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// The next double below a finite one that is not zero, where `step` is one; the same one where it is zero.
///
/// Doubles of one sign are ordered as their bits are. The step below the least is minus infinity.
#[inline]
pub(super) fn below(x: f64, step: bool) -> f64 {
    let bits = x.to_bits() as i64;
    let sign = 1 | (bits >> 63);
    f64::from_bits(bits.wrapping_sub(sign & -i64::from(step)) as u64)
}

/// The next double above, as [`below`].
#[inline]
pub(super) fn above(x: f64, step: bool) -> f64 {
    let bits = x.to_bits() as i64;
    let sign = 1 | (bits >> 63);
    f64::from_bits(bits.wrapping_add(sign & -i64::from(step)) as u64)
}

/// Whether neither underflow nor overflow is near, zero and NaN being neither.
#[inline]
fn is_ordinary(x: f64) -> bool {
    const LEAST: u64 = SAFE.to_bits();
    const BEYOND: u64 = f64::INFINITY.to_bits();
    (x.to_bits() & (u64::MAX >> 1)).wrapping_sub(LEAST) < BEYOND - LEAST
}

impl Neg for Interval {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Interval { lo: -self.hi, hi: -self.lo }
    }
}

impl Add for Interval {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        let (lo, hi) = (self.lo + other.lo, self.hi + other.hi);
        let (below_by, above_by) = (sum_error(self.lo, other.lo, lo), sum_error(self.hi, other.hi, hi));
        if below_by.is_nan() || above_by.is_nan() {
            return add_slowly(self, other);
        }
        // a sum that is zero is exact
        Interval { lo: below(lo, below_by < 0.0), hi: above(hi, above_by > 0.0) }
    }
}

#[cold]
fn add_slowly(a: Interval, b: Interval) -> Interval {
    Interval { lo: add_down(a.lo, b.lo), hi: add_up(a.hi, b.hi) }
}

impl Sub for Interval {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        // rounding to nearest is monotone: the least rounded product is the rounded least product
        let first = self.lo * other.lo;
        let (mut lo, mut hi) = (first, first);
        for product in [self.lo * other.hi, self.hi * other.lo, self.hi * other.hi] {
            // a NaN here is 0 * inf with a zero or a NaN beside it: it may be passed over
            lo = if product < lo { product } else { lo };
            hi = if product > hi { product } else { hi };
        }
        if is_ordinary(lo) & is_ordinary(hi) {
            let (x, y) = (self.lo.to_bits() | self.hi.to_bits(), other.lo.to_bits() | other.hi.to_bits());
            let exact = (x & FRACTION == 0) | (y & FRACTION == 0) | ((x | y) & LOWER_HALF == 0);
            Interval { lo: below(lo, !exact), hi: above(hi, !exact) }
        } else {
            mul_slowly(self, other)
        }
    }
}

#[cold]
fn mul_slowly(a: Interval, b: Interval) -> Interval {
    let pairs = [(a.lo, b.lo), (a.lo, b.hi), (a.hi, b.lo), (a.hi, b.hi)];
    Interval {
        lo: pairs.into_iter().map(|(x, y)| mul_down(x, y)).fold(f64::MAX, f64::min),
        hi: pairs.into_iter().map(|(x, y)| mul_up(x, y)).fold(f64::MIN, f64::max),
    }
}

impl Div for Interval {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        if other.contains_zero() {
            return Interval::WHOLE;
        }
        let (a, b) = if other.lo > 0.0 { (self, other) } else { (-self, -other) };
        let (low_by, high_by) =
            (if a.lo >= 0.0 { b.hi } else { b.lo }, if a.hi >= 0.0 { b.lo } else { b.hi });
        let (lo, hi) = (a.lo / low_by, a.hi / high_by);
        if is_ordinary(lo) & is_ordinary(hi) & is_ordinary(a.lo) & is_ordinary(a.hi) {
            let exact = [is_short_quotient(a.lo, low_by, lo), is_short_quotient(a.hi, high_by, hi)];
            Interval { lo: below(lo, !exact[0]), hi: above(hi, !exact[1]) }
        } else {
            Interval { lo: div_down(a.lo, low_by), hi: div_up(a.hi, high_by) }
        }
    }
}

macro_rules! further_operators {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident;)*) => {$(
        impl $operator<&Interval> for Interval {
            type Output = Self;
            #[inline]
            fn $method(self, other: &Interval) -> Self {
                self.$method(*other)
            }
        }
        impl $operator<f64> for Interval {
            type Output = Self;
            #[inline]
            fn $method(self, other: f64) -> Self {
                self.$method(Interval::point(other))
            }
        }
        impl $assign for Interval {
            #[inline]
            fn $assign_method(&mut self, other: Self) {
                *self = self.$method(other);
            }
        }
        impl $assign<f64> for Interval {
            #[inline]
            fn $assign_method(&mut self, other: f64) {
                *self = self.$method(other);
            }
        }
    )*};
}

further_operators! {
    Add add AddAssign add_assign;
    Sub sub SubAssign sub_assign;
    Mul mul MulAssign mul_assign;
    Div div DivAssign div_assign;
}
