//! Decimal floats of a few digits, each operation rounded to nearest, as an [`Arithmetic`].
//!
//! This is how a computer-algebra system evaluates an expression at its default setting (ten digits). It is here to
//! show what such an evaluation does to a formula, not to compute with.

use super::{Arithmetic, Function, Refusal};
use dashu::float::round::mode::HalfEven;
use dashu::float::{Context, FBig, FpError, Repr};
use dashu::integer::IBig;
use dashu::rational::RBig;

/// Decimal floats of a fixed number of digits, rounded half to even after every operation.
#[derive(Clone, Copy, Debug)]
pub struct Decimals {
    context: Context<HalfEven>,
}

/// One decimal float.
pub type Decimal = Repr<10>;

type Rounded = Result<dashu::base::Approximation<FBig<HalfEven, 10>, dashu::float::round::Rounding>, FpError>;

impl Decimals {
    /// Decimal floats of `digits` digits (at least 1).
    pub fn new(digits: usize) -> Self {
        Decimals { context: Context::new(digits.max(1)) }
    }

    /// The rational that a decimal is.
    pub fn exactly(value: &Decimal) -> RBig {
        let significand = RBig::from(value.significand().clone());
        let scale = RBig::from(IBig::from(10).pow(value.exponent().unsigned_abs()));
        if value.exponent() >= 0 { significand * scale } else { significand / scale }
    }

    fn value(result: Rounded) -> Result<Decimal, Refusal> {
        let value = result.map_err(|_| Refusal::NotFinite)?.value().into_repr();
        if value.is_finite() { Ok(value) } else { Err(Refusal::DivisionByZero) }
    }
}

impl Arithmetic for Decimals {
    type Number = Decimal;

    fn rational(&self, value: &RBig) -> Result<Decimal, Refusal> {
        let top = Repr::new(value.numerator().clone(), 0);
        let bottom = Repr::new(IBig::from(value.denominator().clone()), 0);
        Self::value(self.context.div(&top, &bottom))
    }
    fn pi(&self) -> Result<Decimal, Refusal> {
        Self::value(self.context.acos(&Repr::neg_one(), None))
    }
    fn add(&self, a: &Decimal, b: &Decimal) -> Result<Decimal, Refusal> {
        Self::value(self.context.add(a, b))
    }
    fn sub(&self, a: &Decimal, b: &Decimal) -> Result<Decimal, Refusal> {
        Self::value(self.context.sub(a, b))
    }
    fn mul(&self, a: &Decimal, b: &Decimal) -> Result<Decimal, Refusal> {
        Self::value(self.context.mul(a, b))
    }
    fn div(&self, a: &Decimal, b: &Decimal) -> Result<Decimal, Refusal> {
        if b.significand().is_zero() {
            Err(Refusal::DivisionByZero)
        } else {
            Self::value(self.context.div(a, b))
        }
    }
    fn neg(&self, a: &Decimal) -> Result<Decimal, Refusal> {
        Ok(-a.clone())
    }
    fn apply(&self, function: Function, a: &Decimal) -> Result<Decimal, Refusal> {
        // through a hundred bits: the function is then rounded once, as it should be
        let wide = super::Enclosures::new(100);
        let value = wide.apply(function, &wide.rational(&Self::exactly(a))?)?;
        self.rational(&value.low())
    }
    fn is_zero(&self, a: &Decimal) -> Option<bool> {
        Some(a.significand().is_zero())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_digits_are_kept_and_the_eleventh_is_lost() {
        let ten = Decimals::new(10);
        let q = |n: i64, d: u64| ten.rational(&RBig::from_parts(n.into(), d.into())).unwrap();
        assert_eq!(
            Decimals::exactly(&q(1, 3)),
            RBig::from_parts(3333333333i64.into(), 10000000000u64.into())
        );
        let lost = ten.sub(&ten.add(&q(1, 1), &q(1, 100_000_000_000)).unwrap(), &q(1, 1)).unwrap();
        assert_eq!(ten.is_zero(&lost), Some(true));
    }
}
