//! Elementary functions of double-doubles, each right to 2^-100 of its value.
//!
//! All go the same way: the argument is brought near a point at which the function is tabulated, and the rest
//! goes into a short Taylor series, whose higher terms need no more than a double. With `u = 2^-53` and the
//! errors of the operations as in the parent module (sum `3u^2`, product `7u^2`, quotient `15u^2`, times a double
//! `2u^2`, root `4u^2`; a tabulated constant `u^2`), the relative errors are counted at each function, for the argument
//! where they are greatest. Terms of the order `u^3`, and truncated series, add less than `u^2/2` each.

use super::arithmetic::{exponent_of, shifted};
use super::tables::{
    ARC_TANGENT, HALF_PI, INVERSE_FACTORIAL, INVERSE_ODD, LN_2, LN_2_BY_32, MINUS_LOG, POWER_OF_TWO,
    RECIPROCAL, SINE,
};
use super::{DoubleDouble, reduction};
use crate::number::error_free::two_product;

impl DoubleDouble {
    /// Sine and cosine; NaN at infinity.
    ///
    /// With `x = a + r`, `a` a multiple of pi/64 and `|r| <= pi/128 = 0.0246`:
    /// `sin x = sin a + (cos a sin r - sin a (1 - cos r))`. The rest has the error `10u^2`, so `sin r` has `14u^2` and
    /// `1 - cos r`, at most 3.1e-4, has `40u^2`. Where `sin a = 0` that is all. Elsewhere `sin a >= 0.0490` and
    /// `|sin x| >= 0.0245`: the bracket adds `(14 + 7 + 1 + 3) u^2 * 0.0246`, `sin a` adds `u^2 * 0.0491`, the sum `3u^2`:
    /// together below `31 u^2 < 2^-101`. The cosine is the sine of the complement.
    pub fn sin_cos(self) -> (Self, Self) {
        if !self.hi.is_finite() {
            return (f64::NAN.into(), f64::NAN.into());
        }
        let reduced = reduction::reduce(self);
        let (r, square) = (reduced.rest, reduced.rest.sqr());
        // sin r = r - r^3 (1/3! - r^2/5! + ...), truncated below 2^-115; after r^7 a double is enough
        let f = |n: usize| INVERSE_FACTORIAL[n];
        let z = square.hi;
        let tail = f(9).hi - z * (f(11).hi - z * f(13).hi);
        let series = f(3) - square * (f(5) - square * (f(7) - Self::from(z * tail)));
        let sine = r - r * square * series;
        // 1 - cos r = r^2/2 - r^4 (1/4! - ...)
        let tail = f(10).hi - z * (f(12).hi - z * f(14).hi);
        let series = f(4) - square * (f(6) - square * (f(8) - Self::from(z * tail)));
        let versine = square.times(0.5) - square.sqr() * series;
        let (s, c) = if reduced.step == 0 {
            (sine, Self::ONE - versine)
        } else {
            let (a, b) = (SINE[reduced.step], SINE[32 - reduced.step]);
            (a + (b * sine - a * versine), b - (a * sine + b * versine))
        };
        match reduced.quadrant {
            0 => (s, c),
            1 => (c, -s),
            2 => (-s, -c),
            _ => (-c, s),
        }
    }

    /// How many right angles go into a finite angle, rounded down, modulo four.
    pub(in crate::number) fn quadrant(self) -> i32 {
        let reduced = reduction::reduce(self);
        let short = reduced.step == 0 && reduced.rest.hi < 0.0;
        (reduced.quadrant as i32 - i32::from(short)) & 3
    }

    /// The exponential: infinity above about 709.78, zero below about -745.1.
    ///
    /// `x = k ln 2 / 32 + r`, `|r| <= 0.0109`, where `r` is found to `4u^2 * 0.0109`; `exp r - 1` adds `30u^2` of
    /// itself; times a power of 2^(1/32), and added to it: `(4 + 30 + 8) u^2 * 0.011 + u^2 + 3u^2 < 5u^2 < 2^-103`.
    pub fn exp(self) -> Self {
        if self.hi.is_nan() || self.hi > 710.0 {
            return (self.hi * f64::INFINITY).into();
        }
        if self.hi < -746.0 {
            return Self::ZERO;
        }
        let k = (self.hi / LN_2.hi * 32.0).round();
        let r = self
            - Self::from(k * LN_2_BY_32[0])
            - Self::from(k * LN_2_BY_32[1])
            - Self::from(k * LN_2_BY_32[2]);
        let f = |n: usize| INVERSE_FACTORIAL[n];
        let z = r.hi;
        let tail = f(7).hi + z * (f(8).hi + z * (f(9).hi + z * (f(10).hi + z * (f(11).hi + z * f(12).hi))));
        let series = f(4) + r * (f(5) + r * (f(6) + Self::from(z * tail)));
        let less_one = r + r.sqr() * (f(2) + r * (f(3) + r * series));
        let power = POWER_OF_TWO[(k as i32).rem_euclid(32) as usize];
        shifted(power + power * less_one, (k as i32).div_euclid(32))
    }

    /// The natural logarithm; minus infinity at zero, NaN below.
    ///
    /// `x = 2^k m`, `c` a number of nine bits near `1/m`, `m c = 1 + z`, `|z| < 0.0252`:
    /// `ln x = (k ln 2 - ln c) + ln(1 + z)`, the last as `2 artanh(z/(2 + z))` to `25u^2`. Where `k = 0` and `c = 1` that
    /// is all; elsewhere the two parts, where they cancel, are at worst 0.0318 and -0.0163 (`c = 248/256`):
    /// `(25 * 0.0163 + 0.0318) / 0.0155 + 3 < 32`, so `32 u^2 = 2^-101`.
    pub fn ln(self) -> Self {
        if self.hi <= 0.0 || !self.hi.is_finite() {
            return self.hi.ln().into();
        }
        let (k, m) = {
            let k = exponent_of(self.hi);
            let m = shifted(self, -k);
            // a subnormal number is not yet near one
            let more = exponent_of(m.hi);
            let m = shifted(m, -more);
            if m.hi < 1.4140625 { (k + more, m) } else { (k + more + 1, m.scaled(0.5)) }
        };
        let index = (m.hi * 32.0).round() as usize - 23;
        let c = RECIPROCAL[index] / 256.0;
        let (product, error) = two_product(m.hi, c);
        let (low, rest) = two_product(m.lo, c);
        let z = Self::new(product - 1.0, error) + Self::new(low, rest);
        let s = z / (z + Self::from(2.0));
        let square = s.sqr();
        let g = |n: usize| INVERSE_ODD[n];
        let w = square.hi;
        let tail = g(4).hi + w * (g(5).hi + w * (g(6).hi + w * (g(7).hi + w * g(8).hi)));
        let series = g(1) + square * (g(2) + square * (g(3) + Self::from(w * tail)));
        let near_one = (s + s * square * series).times(2.0);
        let far = LN_2.times(f64::from(k)) + MINUS_LOG[index];
        if far.hi == 0.0 { near_one } else { far + near_one }
    }

    /// The arc tangent.
    ///
    /// With `a = j/32` next to `|x|`, or to `1/|x|` where that is less: `atan x = atan a + atan t`,
    /// `t = (x - a)/(1 + a x)` to `(3 + 5 + 15) u^2`, `|t| < 0.0157`, its series to `27u^2`. The worst case is `j = 1`,
    /// `x = 1/64`: `(27 * 0.0157 + 0.0312)/0.0156 + 3 < 33`, so `33u^2 < 2^-100.9`. Beyond one the result is above pi/4 and its error
    /// less.
    pub fn atan(self) -> Self {
        if self.hi.is_nan() {
            return self;
        }
        let x = self.abs();
        let beyond = x.hi > 1.0;
        let small = if beyond { 1.0 / x.hi } else { x.hi };
        let j = (small * 32.0).round();
        let a = j / 32.0;
        let t = match (beyond, x.hi.is_infinite()) {
            (_, true) => Self::ZERO,
            // (1/x - a)/(1 + a/x)
            (true, _) => (Self::ONE - x.times(a)) / (x + Self::from(a)),
            (false, _) if j == 0.0 => x,
            (false, _) => (x - Self::from(a)) / (Self::ONE + x.times(a)),
        };
        let square = t.sqr();
        let g = |n: usize| INVERSE_ODD[n];
        let w = square.hi;
        let tail = g(5).hi - w * (g(6).hi - w * (g(7).hi - w * (g(8).hi - w * g(9).hi)));
        let series = g(1) - square * (g(2) - square * (g(3) - square * (g(4) - Self::from(w * tail))));
        let near_zero = t - t * square * series;
        let far = ARC_TANGENT[j as usize];
        let angle = if beyond {
            (HALF_PI - far) - near_zero
        } else if j == 0.0 {
            near_zero
        } else {
            far + near_zero
        };
        if self.hi.is_sign_negative() { -angle } else { angle }
    }

    /// The arc sine; NaN beyond one.
    ///
    /// The arc tangent of `x / sqrt((1 - x)(1 + x))`: the quotient has `(3 + 3 + 7)/2 + 4 + 15 < 26u^2`, which the arc tangent
    /// does not increase: `59 u^2 < 2^-100`.
    pub fn asin(self) -> Self {
        let x = self.abs();
        if x == Self::ONE {
            return if self.hi > 0.0 { HALF_PI } else { -HALF_PI };
        }
        (self / ((Self::ONE - x) * (Self::ONE + x)).sqrt()).atan()
    }

    /// The arc cosine; NaN beyond one.
    ///
    /// Twice the arc tangent of `sqrt((1 - x)/(1 + x))`, which has `(3 + 3 + 15)/2 + 4 < 15u^2`: `48u^2 < 2^-100`.
    pub fn acos(self) -> Self {
        let (above, below) = (Self::ONE - self, Self::ONE + self);
        if below.hi == 0.0 {
            return super::tables::PI;
        }
        (above / below).sqrt().atan().times(2.0)
    }
}
