//! Double-double numbers: the unevaluated sum of two doubles, about 31 decimal digits.
//!
//! With `u = 2^-53`, the relative error of a sum is at most `3u^2 + 13u^3`, of a product `7u^2`, of a quotient
//! `15u^2 + 56u^3` (M. Joldes, J.-M. Muller, V. Popescu, *Tight and rigorous error bounds for basic building blocks of
//! double-word arithmetic*, ACM TOMS 44 (2017), algorithms 6, 10 and 17; after Y. Hida, X. S. Li, D. H. Bailey,
//! *Algorithms for quad-double precision floating point arithmetic*, ARITH-15 (2001)), of a square root `25/8 u^2`
//! (V. Lefevre et al., *Accurate calculation of Euclidean norms using double-word arithmetic*, ACM TOMS 49 (2023)).
//! So every operation is right to 2^-102, and every function to 2^-100 (the count is in `functions`).
//!
//! This holds as long as nothing comes near the ends of the range. A result beyond the greatest double is an infinity,
//! whose low part is zero; what has no value is a NaN; below about 1e-290 the low part has fewer bits and then none,
//! so that a result is right to 2^-102 of itself or to a few times 2^-1074, whichever is more.

mod arithmetic;
mod functions;
mod reduction;
mod tables;

pub(super) use tables::SINE;

use super::error_free::{fast_two_sum, two_product, two_sum};
use super::{Function, RealNumber, Refusal, rational_from_f64, rational_to_f64, round_to_decimal};
use dashu::rational::RBig;
use std::cmp::Ordering;
use std::fmt;

/// `hi + lo`, where `hi` is the double nearest to the sum.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct DoubleDouble {
    hi: f64,
    lo: f64,
}

impl DoubleDouble {
    /// Zero.
    pub const ZERO: DoubleDouble = DoubleDouble { hi: 0.0, lo: 0.0 };
    /// One.
    pub const ONE: DoubleDouble = DoubleDouble { hi: 1.0, lo: 0.0 };
    /// No number.
    pub const NAN: DoubleDouble = DoubleDouble { hi: f64::NAN, lo: 0.0 };
    /// Pi.
    pub const PI: DoubleDouble = tables::PI;

    /// The sum of two doubles, exactly.
    pub fn new(a: f64, b: f64) -> Self {
        let (hi, lo) = two_sum(a, b);
        Self::guarded(hi, lo)
    }

    /// The double nearest to it.
    #[inline]
    pub const fn hi(self) -> f64 {
        self.hi
    }

    /// The rest: the number less the double nearest to it.
    #[inline]
    pub const fn lo(self) -> f64 {
        self.lo
    }

    /// The rational that it is; `None` for an infinity or a NaN.
    pub fn to_rational(self) -> Option<RBig> {
        Some(rational_from_f64(self.hi)? + rational_from_f64(self.lo)?)
    }

    /// The magnitude.
    #[inline]
    pub fn abs(self) -> Self {
        if self.hi.is_sign_negative() { -self } else { self }
    }

    /// The whole number next to it on the way to zero.
    pub fn trunc(self) -> Self {
        let whole = self.hi.trunc();
        if whole != self.hi {
            whole.into()
        } else if self.hi > 0.0 {
            Self::new(self.hi, self.lo.floor())
        } else {
            Self::new(self.hi, self.lo.ceil())
        }
    }

    /// The square.
    #[inline]
    pub fn sqr(self) -> Self {
        self * self
    }

    /// Two parts that are normalised already, unless the result left the range: its low part is then meaningless.
    #[inline]
    fn guarded(hi: f64, lo: f64) -> Self {
        DoubleDouble { hi, lo: if hi.is_finite() { lo } else { 0.0 } }
    }

    /// `hi + lo` for `|hi| >= |lo|`.
    #[inline]
    fn normalised(hi: f64, lo: f64) -> Self {
        let (hi, lo) = fast_two_sum(hi, lo);
        Self::guarded(hi, lo)
    }

    /// Times a power of two.
    fn scaled(self, by: f64) -> Self {
        let high = self.hi * by;
        if high.is_finite() {
            Self::normalised(high, self.lo * by)
        } else {
            DoubleDouble { hi: high, lo: 0.0 }
        }
    }

    /// Times a double (algorithm 7 of Joldes et al.: at most `1.5u^2 + 4u^3`).
    #[inline]
    fn times(self, y: f64) -> Self {
        let (high, low) = two_product(self.hi, y);
        if !high.is_finite() {
            return DoubleDouble { hi: high, lo: 0.0 };
        }
        let (t1, t2) = fast_two_sum(high, self.lo * y);
        Self::normalised(t1, t2 + low)
    }

    /// The square root; a NaN for negative numbers.
    pub fn sqrt(self) -> Self {
        let root = self.hi.sqrt();
        if root == 0.0 || !root.is_finite() {
            return DoubleDouble { hi: root, lo: 0.0 };
        }
        if !(1e-250..=1e300).contains(&self.hi) {
            // 2^400 and 2^-200 are exact, and the square of the root is then within the range
            let (up, down) = if self.hi < 1.0 {
                (2f64.powi(400), 2f64.powi(-200))
            } else {
                (2f64.powi(-400), 2f64.powi(200))
            };
            return self.scaled(up).sqrt().scaled(down);
        }
        let (square, error) = two_product(root, root);
        let rest = self.lo + ((self.hi - square) - error);
        Self::normalised(root, rest / (2.0 * root))
    }
}

impl From<f64> for DoubleDouble {
    #[inline]
    fn from(value: f64) -> Self {
        DoubleDouble { hi: value, lo: 0.0 }
    }
}

impl PartialOrd for DoubleDouble {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match self.hi.partial_cmp(&other.hi) {
            Some(Ordering::Equal) => self.lo.partial_cmp(&other.lo),
            order => order,
        }
    }
}

/// Thirty-two significant digits.
impl fmt::Display for DoubleDouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.to_rational() {
            Some(value) => write!(f, "{}", round_to_decimal(&value, 32)),
            None => write!(f, "{}", self.hi),
        }
    }
}

impl RealNumber for DoubleDouble {
    fn from_rational(value: &RBig) -> Self {
        let hi = rational_to_f64(value);
        let lo = rational_from_f64(hi).map_or(0.0, |hi| rational_to_f64(&(value - hi)));
        Self::normalised(hi, lo)
    }
    fn from_f64(value: f64) -> Self {
        value.into()
    }
    fn to_f64(self) -> f64 {
        self.hi
    }
    fn pi() -> Self {
        DoubleDouble::PI
    }
    fn function(self, function: Function) -> Result<Self, Refusal> {
        let value = match function {
            Function::Sin => self.sin_cos().0,
            Function::Cos => self.sin_cos().1,
            Function::Asin => self.asin(),
            Function::Acos => self.acos(),
            Function::Atan => self.atan(),
            Function::Sqrt => self.sqrt(),
            Function::Exp => self.exp(),
            Function::Log => self.ln(),
        };
        if value.hi.is_nan() && !self.hi.is_nan() { Err(Refusal::OutsideDomain(function)) } else { Ok(value) }
    }
    #[inline]
    fn is_zero(self) -> Option<bool> {
        Some(self.hi == 0.0)
    }
    fn is_finite(self) -> bool {
        self.hi.is_finite()
    }
}

#[cfg(test)]
mod tests;
