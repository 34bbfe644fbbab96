//! Numbers of fixed size that stand for a real number: `f32`, `f64`, and those of this floor. [`Floats`] makes an
//! arithmetic of any of them.
//!
//! [`Floats`]: super::Floats

use super::{Function, Refusal, rational_to_f64};
use dashu::rational::RBig;
use std::fmt::{Debug, Display};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number of fixed size: copied freely, computed with by operators, rounded (or enclosed) after every operation.
///
/// The operators answer always, if need be by a NaN or by the whole line; the methods that return a [`Result`] say
/// where the question had no answer.
pub trait RealNumber:
    Copy
    + Debug
    + Display
    + PartialEq
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The image of an exact rational: the nearest number, or the tightest enclosure.
    fn from_rational(value: &RBig) -> Self;
    /// The image of a double: exact, except for `f32`.
    fn from_f64(value: f64) -> Self;
    /// A double near the number: the nearest one, or the middle of the enclosure.
    fn to_f64(self) -> f64;
    /// The image of pi.
    fn pi() -> Self;
    /// Whether it lies outside a function's real domain, or may do so. A NaN does not: it is already named.
    fn is_outside(self, function: Function) -> bool {
        let (one, zero) = (Self::from_f64(1.0), Self::from_f64(0.0));
        match function {
            Function::Asin | Function::Acos => self < -one || self > one,
            Function::Sqrt | Function::Log => self < zero,
            Function::Sin | Function::Cos | Function::Atan | Function::Exp => false,
        }
    }
    /// `f(self)`.
    ///
    /// # Errors
    /// [`Refusal::OutsideDomain`] where [`RealNumber::is_outside`], or where there is no value (the sine of an infinity).
    fn function(self, function: Function) -> Result<Self, Refusal>;
    /// Whether it is zero; `None` where that cannot be decided.
    fn is_zero(self) -> Option<bool>;
    /// Whether neither an infinity nor a NaN is met in it.
    fn is_finite(self) -> bool;

    /// Whether one may divide by it.
    ///
    /// # Errors
    /// [`Refusal::DivisionByZero`] or [`Refusal::DivisorNotSeparated`], where it is zero or may be.
    #[inline]
    fn check_divisor(self) -> Result<(), Refusal> {
        match self.is_zero() {
            Some(false) => Ok(()),
            Some(true) => Err(Refusal::DivisionByZero),
            None => Err(Refusal::DivisorNotSeparated),
        }
    }

    /// `self / divisor`.
    ///
    /// # Errors
    /// As [`RealNumber::check_divisor`].
    #[inline]
    fn quotient(self, divisor: Self) -> Result<Self, Refusal> {
        divisor.check_divisor()?;
        Ok(self / divisor)
    }

    /// `self^n` by repeated squaring; a negative power is the reciprocal of the positive one.
    ///
    /// # Errors
    /// As [`RealNumber::quotient`], where `n` is negative.
    fn power(self, n: i32) -> Result<Self, Refusal> {
        let one = Self::from_f64(1.0);
        let (mut result, mut square) = (one, self);
        let mut rest = n.unsigned_abs();
        while rest > 0 {
            if rest & 1 == 1 {
                result = result * square;
            }
            rest >>= 1;
            if rest > 0 {
                square = square * square;
            }
        }
        if n < 0 { one.quotient(result) } else { Ok(result) }
    }
}

macro_rules! machine_float {
    ($float:ident, $from_rational:expr) => {
        impl RealNumber for $float {
            #[inline]
            fn from_rational(value: &RBig) -> Self {
                $from_rational(value)
            }
            #[inline]
            fn from_f64(value: f64) -> Self {
                value as $float
            }
            #[inline]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline]
            fn pi() -> Self {
                std::$float::consts::PI
            }
            fn function(self, function: Function) -> Result<Self, Refusal> {
                let value = match function {
                    Function::Sin => self.sin(),
                    Function::Cos => self.cos(),
                    Function::Asin => self.asin(),
                    Function::Acos => self.acos(),
                    Function::Atan => self.atan(),
                    Function::Sqrt => self.sqrt(),
                    Function::Exp => self.exp(),
                    Function::Log => self.ln(),
                };
                if value.is_nan() && !self.is_nan() {
                    Err(Refusal::OutsideDomain(function))
                } else {
                    Ok(value)
                }
            }
            #[inline]
            fn is_zero(self) -> Option<bool> {
                Some(self == 0.0)
            }
            #[inline]
            fn is_finite(self) -> bool {
                $float::is_finite(self)
            }
        }
    };
}

machine_float!(f64, rational_to_f64);
machine_float!(f32, |value: &RBig| value.to_f32().value());
