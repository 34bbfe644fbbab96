//! Numbers of [`BITS`] bits with the usual operators.
//!
//! A [`Real`] is a binary float of the crate dashu, rounded to nearest after each operation. It is no
//! enclosure: how far a result can be trusted is estimated by whoever computed it (see
//! [`super::differentiate`]), not proved. An operation that has no value (a division by zero, the root of a
//! negative number) gives an undefined number, and whatever is computed from an undefined number is
//! undefined: one look at the end, with [`Real::is_defined`], covers all steps.

use dashu::base::Sign;
use dashu::float::round::Rounding;
use dashu::float::round::mode::HalfEven;
use dashu::float::{ConstCache, Context, FBig, FpError, Repr};
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use palmistry_math::number::rational_to_f64;
use std::cell::RefCell;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Bits of a significand: 96 decimal digits, of which numerical differentiation spends up to forty.
pub const BITS: usize = 320;

const CONTEXT: Context<HalfEven> = Context::new(BITS);

/// Beyond this binary exponent an argument of sine and cosine is not reduced.
const LARGEST_EXPONENT: isize = 4096;

thread_local! {
    // pi, for the reduction of arguments
    static CONSTANTS: RefCell<ConstCache> = const { RefCell::new(ConstCache::new()) };
}

/// A real number to `BITS` bits, or nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Real(Option<Repr<2>>);

type Rounded = Result<dashu::base::Approximation<FBig<HalfEven, 2>, Rounding>, FpError>;

fn value(result: Rounded) -> Real {
    let repr = result.ok().map(|rounded| rounded.value().into_repr());
    Real(repr.filter(Repr::is_finite))
}

impl Real {
    /// What an operation without a value gives.
    pub const UNDEFINED: Real = Real(None);

    /// A small whole number.
    pub fn whole(n: i64) -> Real {
        Real(Some(Repr::new(IBig::from(n), 0)))
    }

    /// Zero.
    pub fn zero() -> Real {
        Real::whole(0)
    }

    /// One.
    pub fn one() -> Real {
        Real::whole(1)
    }

    /// Two to the power `exponent`.
    pub fn power_of_two(exponent: isize) -> Real {
        Real(Some(Repr::new(IBig::ONE, exponent)))
    }

    /// The nearest number to a rational.
    pub fn from_rational(rational: &RBig) -> Real {
        let top = Repr::new(rational.numerator().clone(), 0);
        let bottom = Repr::new(IBig::from(rational.denominator().clone()), 0);
        value(CONTEXT.div(&top, &bottom))
    }

    /// The rational that it is; `None` where it is undefined.
    pub fn to_rational(&self) -> Option<RBig> {
        let repr = self.0.as_ref()?;
        let significand = RBig::from(repr.significand().clone());
        let scale = RBig::from(UBig::ONE << repr.exponent().unsigned_abs());
        Some(if repr.exponent() >= 0 { significand * scale } else { significand / scale })
    }

    /// The nearest double; a NaN where it is undefined.
    pub fn to_f64(&self) -> f64 {
        self.to_rational().map_or(f64::NAN, |rational| rational_to_f64(&rational))
    }

    /// Whether every step on the way to it had a value.
    pub fn is_defined(&self) -> bool {
        self.0.is_some()
    }

    /// Whether it is defined and greater than zero.
    pub fn is_positive(&self) -> bool {
        *self > Real::zero()
    }

    /// `|x|`
    pub fn abs(&self) -> Real {
        match &self.0 {
            Some(repr) if repr.sign() == Sign::Negative => -self,
            _ => self.clone(),
        }
    }

    /// The greater of two; undefined where one of them is.
    pub fn max(&self, other: &Real) -> Real {
        match self.partial_cmp(other) {
            Some(Ordering::Less) => other.clone(),
            Some(_) => self.clone(),
            None => Real::UNDEFINED,
        }
    }

    /// The square root; undefined below zero.
    pub fn sqrt(&self) -> Real {
        match &self.0 {
            Some(repr) if repr.significand().is_zero() => Real::zero(),
            Some(repr) if repr.sign() == Sign::Positive => value(CONTEXT.sqrt(repr)),
            _ => Real::UNDEFINED,
        }
    }

    /// The sine and the cosine of an angle in radians.
    pub fn sin_cos(&self) -> (Real, Real) {
        match &self.0 {
            Some(repr) if repr.exponent() + repr.digits() as isize <= LARGEST_EXPONENT => {
                CONSTANTS.with(|constants| {
                    let (sine, cosine) = CONTEXT.sin_cos(repr, Some(&mut constants.borrow_mut()));
                    (value(sine), value(cosine))
                })
            }
            _ => (Real::UNDEFINED, Real::UNDEFINED),
        }
    }
}

impl PartialOrd for Real {
    fn partial_cmp(&self, other: &Real) -> Option<Ordering> {
        Some(self.0.as_ref()?.cmp(other.0.as_ref()?))
    }
}

fn combine(a: &Real, b: &Real, operation: impl Fn(&Repr<2>, &Repr<2>) -> Rounded) -> Real {
    match (&a.0, &b.0) {
        (Some(x), Some(y)) => value(operation(x, y)),
        _ => Real::UNDEFINED,
    }
}

/// The operator for all four ways of lending or giving away its operands.
macro_rules! operator {
    ($trait:ident, $method:ident, |$a:ident, $b:ident| $body:expr) => {
        impl $trait<&Real> for &Real {
            type Output = Real;
            fn $method(self, other: &Real) -> Real {
                let ($a, $b) = (self, other);
                $body
            }
        }
        impl $trait<Real> for Real {
            type Output = Real;
            fn $method(self, other: Real) -> Real {
                $trait::$method(&self, &other)
            }
        }
        impl $trait<&Real> for Real {
            type Output = Real;
            fn $method(self, other: &Real) -> Real {
                $trait::$method(&self, other)
            }
        }
        impl $trait<Real> for &Real {
            type Output = Real;
            fn $method(self, other: Real) -> Real {
                $trait::$method(self, &other)
            }
        }
    };
}

operator!(Add, add, |a, b| combine(a, b, |x, y| CONTEXT.add(x, y)));
operator!(Sub, sub, |a, b| combine(a, b, |x, y| CONTEXT.sub(x, y)));
operator!(Mul, mul, |a, b| combine(a, b, |x, y| CONTEXT.mul(x, y)));
operator!(Div, div, |a, b| match &b.0 {
    Some(divisor) if divisor.significand().is_zero() => Real::UNDEFINED,
    _ => combine(a, b, |x, y| CONTEXT.div(x, y)),
});

impl Neg for &Real {
    type Output = Real;
    fn neg(self) -> Real {
        Real(self.0.clone().map(|repr| -repr))
    }
}

impl Neg for Real {
    type Output = Real;
    fn neg(self) -> Real {
        -&self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palmistry_math::number::{Arithmetic, Enclosures, Function, parse_decimal};

    #[test]
    fn a_sine_lies_in_its_enclosure() {
        let wide = Enclosures::new(2 * BITS);
        let near = RBig::from(UBig::ONE) / RBig::from(UBig::ONE << (BITS - 2));
        for text in ["0.3", "-7/3", "2", "100"] {
            let argument = Real::from_rational(&parse_decimal(text).unwrap());
            let at = wide.rational(&argument.to_rational().unwrap()).unwrap();
            let (sine, cosine) = argument.sin_cos();
            for (found, function) in [(sine, Function::Sin), (cosine, Function::Cos)] {
                let exact = wide.apply(function, &at).unwrap();
                let found = found.to_rational().unwrap();
                assert!(exact.low() - &near < found && found < exact.high() + &near, "{function:?} {text}");
            }
        }
    }

    #[test]
    fn what_has_no_value_stays_undefined() {
        let nothing = Real::one() / Real::zero();
        assert!(!nothing.is_defined());
        assert!(!(nothing * Real::zero()).is_defined());
        assert!(!Real::whole(-2).sqrt().is_defined());
        assert_eq!(Real::UNDEFINED.partial_cmp(&Real::one()), None);
        assert!(Real::UNDEFINED.to_f64().is_nan());
        let too_large = Real::power_of_two(5000).sin_cos();
        assert!(!too_large.0.is_defined() && !too_large.1.is_defined());
    }
}
