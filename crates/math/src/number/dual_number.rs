//! What num-dual asks of a plain number, for the numbers of this floor.
//!
//! Of the functions in its trait the proof language knows eight ([`Function`]); the others are put together from these.
//! Over intervals all of them enclose; over double-doubles they lose digits where the composition cancels (`exp_m1`
//! near zero). Where a function has no value it is a NaN, or the whole line.
//!
//! What num-dual does with the numbers is rigorous over intervals as long as its rules use sums, products, quotients,
//! small whole numbers and halves, which is so for the eight functions. It is not so for the derivatives of `cbrt`,
//! `exp2`, `log`, `log2` and `log10` (constants rounded to doubles) and for `abs` and `signum` (a branch on the sign):
//! nothing in this crate uses these.

mod plain;

use super::{DoubleDouble, Function, Interval, RealNumber};
use num_dual::{DualNum, DualStruct, Mappable};
use num_traits::{FromPrimitive, Inv, Num, One, Signed, Zero};
use plain::Plain;
use std::cmp::Ordering;
use std::iter::{Product, Sum};
use std::ops::{Rem, RemAssign};

macro_rules! dual_number {
    ($number:ident, $abs_sub:expr, $signum:expr, $is_positive:expr) => {
        impl Zero for $number {
            fn zero() -> Self {
                $number::ZERO
            }
            fn is_zero(&self) -> bool {
                RealNumber::is_zero(*self) == Some(true)
            }
        }
        impl One for $number {
            fn one() -> Self {
                $number::ONE
            }
        }
        impl Rem for $number {
            type Output = Self;
            fn rem(self, other: Self) -> Self {
                self.remainder(other)
            }
        }
        impl Rem<&$number> for $number {
            type Output = Self;
            fn rem(self, other: &$number) -> Self {
                self.remainder(*other)
            }
        }
        impl Rem<f64> for $number {
            type Output = Self;
            fn rem(self, other: f64) -> Self {
                self.remainder(other.into())
            }
        }
        impl RemAssign for $number {
            fn rem_assign(&mut self, other: Self) {
                *self = self.remainder(other);
            }
        }
        impl RemAssign<f64> for $number {
            fn rem_assign(&mut self, other: f64) {
                *self = self.remainder(other.into());
            }
        }
        impl Num for $number {
            type FromStrRadixErr = &'static str;
            fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
                let value = (radix == 10).then(|| super::parse_decimal(text)).flatten();
                value.map(|value| Self::from_rational(&value)).ok_or("not a decimal number")
            }
        }
        impl Signed for $number {
            fn abs(&self) -> Self {
                $number::abs(*self)
            }
            fn abs_sub(&self, other: &Self) -> Self {
                let positive_part: fn($number) -> $number = $abs_sub;
                positive_part(*self - *other)
            }
            fn signum(&self) -> Self {
                let signum: fn($number) -> $number = $signum;
                signum(*self)
            }
            fn is_positive(&self) -> bool {
                let is_positive: fn($number) -> bool = $is_positive;
                is_positive(*self)
            }
            fn is_negative(&self) -> bool {
                let is_positive: fn($number) -> bool = $is_positive;
                is_positive(-*self)
            }
        }
        impl FromPrimitive for $number {
            fn from_i64(n: i64) -> Option<Self> {
                Some(Self::from_rational(&n.into()))
            }
            fn from_u64(n: u64) -> Option<Self> {
                Some(Self::from_rational(&n.into()))
            }
            fn from_f64(x: f64) -> Option<Self> {
                Some(x.into())
            }
        }
        impl Inv for $number {
            type Output = Self;
            fn inv(self) -> Self {
                $number::ONE / self
            }
        }
        impl Sum for $number {
            fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
                terms.fold($number::ZERO, |a, b| a + b)
            }
        }
        impl Product for $number {
            fn product<I: Iterator<Item = Self>>(factors: I) -> Self {
                factors.fold($number::ONE, |a, b| a * b)
            }
        }
        impl PartialEq<f64> for $number {
            fn eq(&self, other: &f64) -> bool {
                *self == $number::from(*other)
            }
        }
        impl PartialOrd<f64> for $number {
            fn partial_cmp(&self, other: &f64) -> Option<Ordering> {
                self.partial_cmp(&$number::from(*other))
            }
        }
        impl DualStruct for $number {
            type Real = f64;
            type Inner = Self;
            fn re(&self) -> f64 {
                self.to_f64()
            }
            fn from_inner(inner: &Self) -> Self {
                *inner
            }
        }
        impl Mappable<$number> for $number {
            type Output<O> = O;
            fn map_dual<M: Fn($number) -> O, O>(self, f: M) -> O {
                f(self)
            }
        }

        impl DualNum for $number {
            type Primitive = f64;
            const NDERIV: usize = 0;
            type InnerDual = Self;

            fn from_re(re: Self) -> Self {
                re
            }
            fn scale(self, factor: &Self) -> Self {
                self * factor
            }
            fn recip(&self) -> Self {
                Self::ONE / *self
            }
            fn powi(&self, n: i32) -> Self {
                self.raised(n)
            }
            fn powf(&self, n: f64) -> Self {
                if n == f64::from(n as i32) {
                    self.raised(n as i32)
                } else {
                    (self.value(Function::Log) * n).value(Function::Exp)
                }
            }
            fn sqrt(&self) -> Self {
                self.value(Function::Sqrt)
            }
            fn cbrt(&self) -> Self {
                let third = |x: Self| (x.value(Function::Log) / Self::from(3.0)).value(Function::Exp);
                if *self > 0.0 {
                    third(*self)
                } else if *self < 0.0 {
                    -third(-*self)
                } else if Zero::is_zero(self) {
                    Self::ZERO
                } else {
                    Self::UNKNOWN
                }
            }
            fn exp(&self) -> Self {
                self.value(Function::Exp)
            }
            fn exp2(&self) -> Self {
                (*self * Self::from(2.0).value(Function::Log)).value(Function::Exp)
            }
            fn exp_m1(&self) -> Self {
                self.value(Function::Exp) - Self::ONE
            }
            fn ln(&self) -> Self {
                self.value(Function::Log)
            }
            fn log(&self, base: f64) -> Self {
                self.logarithm(base)
            }
            fn log2(&self) -> Self {
                self.logarithm(2.0)
            }
            fn log10(&self) -> Self {
                self.logarithm(10.0)
            }
            fn ln_1p(&self) -> Self {
                (*self + Self::ONE).value(Function::Log)
            }
            fn sin(&self) -> Self {
                self.value(Function::Sin)
            }
            fn cos(&self) -> Self {
                self.value(Function::Cos)
            }
            fn tan(&self) -> Self {
                let (sin, cos) = $number::sin_cos(*self);
                sin / cos
            }
            fn sin_cos(&self) -> (Self, Self) {
                $number::sin_cos(*self)
            }
            fn asin(&self) -> Self {
                self.value(Function::Asin)
            }
            fn acos(&self) -> Self {
                self.value(Function::Acos)
            }
            fn atan(&self) -> Self {
                self.value(Function::Atan)
            }
            fn atan2(&self, other: Self) -> Self {
                let (y, x) = (*self, other);
                let (zero, pi) = (Self::ZERO, Self::pi());
                let half_pi = pi * Self::from(0.5);
                if x > zero {
                    (y / x).value(Function::Atan)
                } else if y > zero {
                    half_pi - (x / y).value(Function::Atan)
                } else if y < zero {
                    -half_pi - (x / y).value(Function::Atan)
                } else if x < zero && y == zero {
                    pi
                } else {
                    Self::any_angle()
                }
            }
            fn sinh(&self) -> Self {
                (self.value(Function::Exp) - (-*self).value(Function::Exp)) * Self::from(0.5)
            }
            fn cosh(&self) -> Self {
                (self.value(Function::Exp) + (-*self).value(Function::Exp)) * Self::from(0.5)
            }
            fn tanh(&self) -> Self {
                DualNum::sinh(self) / DualNum::cosh(self)
            }
            fn asinh(&self) -> Self {
                (*self + (self.raised(2) + Self::ONE).value(Function::Sqrt)).value(Function::Log)
            }
            fn acosh(&self) -> Self {
                (*self + (self.raised(2) - Self::ONE).value(Function::Sqrt)).value(Function::Log)
            }
            fn atanh(&self) -> Self {
                ((Self::ONE + *self) / (Self::ONE - *self)).value(Function::Log) * Self::from(0.5)
            }
            fn sph_j0(&self) -> Self {
                self.spherical_bessel(0)
            }
            fn sph_j1(&self) -> Self {
                self.spherical_bessel(1)
            }
            fn sph_j2(&self) -> Self {
                self.spherical_bessel(2)
            }
        }
    };
}

dual_number!(
    DoubleDouble,
    |x| if x > DoubleDouble::ZERO { x } else { DoubleDouble::ZERO },
    |x| if x.is_zero() == Some(true) { x } else { DoubleDouble::from(x.hi().signum()) },
    |x| x > DoubleDouble::ZERO
);
dual_number!(
    Interval,
    |x| Interval::new(x.low().max(0.0), x.high().max(0.0)),
    |x| {
        let sign = |end: f64| if end == 0.0 { 0.0 } else { end.signum() };
        Interval::new(sign(x.low()), sign(x.high()))
    },
    |x| x > Interval::ZERO
);

#[cfg(test)]
mod tests;
