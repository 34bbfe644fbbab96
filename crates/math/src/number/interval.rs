//! Intervals of doubles, rounded outward: every operation returns an interval that contains all values of the
//! operation on its arguments. Fast enough to be asked millions of times; [`Enclosures`](super::Enclosures) are
//! slower and as tight as one likes.
//!
//! The rounding mode is left alone. An endpoint is computed to nearest, and then moved by one place outward unless it
//! is known to be exact (sums know it always, by Knuth's error-free transformation; products and quotients where the
//! significands are short, a zero or a power of two among them).

mod arithmetic;
mod circular;
mod functions;
mod rounding;

use super::{Function, RealNumber, Refusal, rational_from_f64, rational_to_f64};
use dashu::rational::RBig;
use rounding::{add_up, mul_down, mul_up};
use std::cmp::Ordering;
use std::fmt;

/// The closed interval from `lo` to `hi`, which may be infinite.
///
/// Always `lo <= hi`, `lo` below infinity and `hi` above minus infinity: an interval is never empty and never a NaN.
/// Where nothing is known (a divisor that contains zero, an argument that may lie outside a function's domain, a NaN
/// that was put in) an operator returns the whole line; [`RealNumber::quotient`] and [`RealNumber::function`] refuse instead.
///
/// Two intervals are equal where they have the same ends; one is less than the other where every number of it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

impl Interval {
    /// All real numbers.
    pub const WHOLE: Interval = Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    /// Zero alone.
    pub const ZERO: Interval = Interval { lo: 0.0, hi: 0.0 };
    /// One alone.
    pub const ONE: Interval = Interval { lo: 1.0, hi: 1.0 };
    /// The two doubles beside pi (the nearest double is below it: sin(fl(pi)) > 0).
    pub const PI: Interval = Interval { lo: std::f64::consts::PI, hi: std::f64::consts::PI.next_up() };

    /// The least interval that contains both numbers, in whichever order; the whole line if one is a NaN.
    pub const fn new(a: f64, b: f64) -> Self {
        if a.is_nan() || b.is_nan() {
            return Interval::WHOLE;
        }
        let (lo, hi) = if a <= b { (a, b) } else { (b, a) };
        // an overflow stands for some finite number beyond the greatest double
        let lo = if lo == f64::INFINITY { f64::MAX } else { lo };
        let hi = if hi == f64::NEG_INFINITY { f64::MIN } else { hi };
        Interval { lo, hi }
    }

    /// One number alone; an infinity or a NaN becomes what is known of it.
    pub const fn point(value: f64) -> Self {
        Interval::new(value, value)
    }

    /// The left end.
    #[inline]
    pub const fn low(self) -> f64 {
        self.lo
    }

    /// The right end.
    #[inline]
    pub const fn high(self) -> f64 {
        self.hi
    }

    /// A double in the interval, the middle as near as doubles allow; zero for the whole line.
    pub fn mid(self) -> f64 {
        match (self.lo == f64::NEG_INFINITY, self.hi == f64::INFINITY) {
            (true, true) => 0.0,
            (true, false) => f64::MIN,
            (false, true) => f64::MAX,
            _ => (0.5 * self.lo + 0.5 * self.hi).clamp(self.lo, self.hi),
        }
    }

    /// An upper bound of the distance from [`Interval::mid`] to either end.
    pub fn rad(self) -> f64 {
        add_up(self.hi, -self.mid()).max(add_up(self.mid(), -self.lo))
    }

    /// An upper bound of the distance between the ends.
    pub fn width(self) -> f64 {
        add_up(self.hi, -self.lo)
    }

    /// The greatest magnitude in it.
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The least magnitude in it.
    pub fn mignitude(self) -> f64 {
        if self.contains_zero() { 0.0 } else { self.lo.abs().min(self.hi.abs()) }
    }

    /// The magnitudes of its numbers.
    pub fn abs(self) -> Self {
        Interval { lo: self.mignitude(), hi: self.magnitude() }
    }

    /// Whether a number lies in it.
    #[inline]
    pub fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// Whether all of another interval lies in it.
    #[inline]
    pub fn encloses(self, other: Self) -> bool {
        self.lo <= other.lo && other.hi <= self.hi
    }

    /// Whether zero lies in it.
    #[inline]
    pub fn contains_zero(self) -> bool {
        self.lo <= 0.0 && 0.0 <= self.hi
    }

    /// Whether it is one number.
    #[inline]
    pub fn is_point(self) -> bool {
        self.lo == self.hi
    }

    /// The least interval that contains both.
    #[inline]
    pub fn hull(self, other: Self) -> Self {
        Interval { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// What lies in both; `None` where nothing does.
    #[inline]
    pub fn intersection(self, other: Self) -> Option<Self> {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        (lo <= hi).then_some(Interval { lo, hi })
    }

    /// The two halves, which share the middle.
    pub fn split(self) -> (Self, Self) {
        let mid = self.mid();
        (Interval { lo: self.lo, hi: mid }, Interval { lo: mid, hi: self.hi })
    }

    /// The squares of its numbers.
    #[inline]
    pub fn sqr(self) -> Self {
        let product = self * self;
        // the product of an interval with itself knows nothing of the sameness where it straddles zero
        if self.lo < 0.0 && 0.0 < self.hi {
            Interval { lo: 0.0, hi: product.hi.max(mul_up(self.lo, self.lo)) }
        } else {
            product
        }
    }

    /// The `n`-th powers of its numbers: an even power is never negative, an odd one increases.
    pub fn pow(self, n: u32) -> Self {
        match n {
            0 => Interval::ONE,
            1 => self,
            2 => self.sqr(),
            _ if n.is_multiple_of(2) => {
                let size = self.abs();
                Interval { lo: power_down(size.lo, n), hi: power_up(size.hi, n) }
            }
            _ => {
                let lo = if self.lo < 0.0 { -power_up(-self.lo, n) } else { power_down(self.lo, n) };
                let hi = if self.hi < 0.0 { -power_down(-self.hi, n) } else { power_up(self.hi, n) };
                Interval { lo, hi }
            }
        }
    }
}

/// `x^n` or less, for `x >= 0` and `n > 0`: products of lower bounds of positive numbers.
fn power_down(x: f64, n: u32) -> f64 {
    by_squaring(x, n, mul_down)
}

/// `x^n` or more.
fn power_up(x: f64, n: u32) -> f64 {
    by_squaring(x, n, mul_up)
}

fn by_squaring(x: f64, n: u32, mul: impl Fn(f64, f64) -> f64) -> f64 {
    let (mut result, mut square, mut rest) = (1.0, x, n);
    while rest > 1 {
        if rest & 1 == 1 {
            result = mul(result, square);
        }
        square = mul(square, square);
        rest >>= 1;
    }
    mul(result, square)
}

impl PartialOrd for Interval {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        if self == other {
            Some(Ordering::Equal)
        } else if self.hi < other.lo {
            Some(Ordering::Less)
        } else if self.lo > other.hi {
            Some(Ordering::Greater)
        } else {
            None
        }
    }
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}, {}]", self.lo, self.hi)
    }
}

impl From<f64> for Interval {
    fn from(value: f64) -> Self {
        Interval::point(value)
    }
}

impl RealNumber for Interval {
    fn from_rational(value: &RBig) -> Self {
        // correct for whatever double the conversion returns
        let (mut lo, mut hi) = (rational_to_f64(value), rational_to_f64(value));
        while rational_from_f64(lo).map_or(lo > 0.0, |q| q > *value) {
            lo = lo.next_down();
        }
        while rational_from_f64(hi).map_or(hi < 0.0, |q| q < *value) {
            hi = hi.next_up();
        }
        Interval { lo, hi }
    }
    fn from_f64(value: f64) -> Self {
        Interval::point(value)
    }
    fn to_f64(self) -> f64 {
        self.mid()
    }
    fn pi() -> Self {
        Interval::PI
    }
    fn is_outside(self, function: Function) -> bool {
        match function {
            Function::Asin | Function::Acos => self.lo < -1.0 || self.hi > 1.0,
            Function::Sqrt => self.lo < 0.0,
            Function::Log => self.lo <= 0.0,
            Function::Sin | Function::Cos | Function::Atan | Function::Exp => false,
        }
    }
    fn function(self, function: Function) -> Result<Self, Refusal> {
        self.image(function).ok_or(Refusal::OutsideDomain(function))
    }
    #[inline]
    fn is_zero(self) -> Option<bool> {
        if !self.contains_zero() {
            Some(false)
        } else if self.is_point() {
            Some(true)
        } else {
            None
        }
    }
    fn is_finite(self) -> bool {
        self.lo > f64::NEG_INFINITY && self.hi < f64::INFINITY
    }
    fn power(self, n: i32) -> Result<Self, Refusal> {
        let power = self.pow(n.unsigned_abs());
        if n < 0 { Interval::ONE.quotient(power) } else { Ok(power) }
    }
}

#[cfg(test)]
mod tests;
