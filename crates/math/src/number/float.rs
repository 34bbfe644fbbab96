//! Numbers of fixed size as an [`Arithmetic`].

use super::{Arithmetic, Function, RealNumber, Refusal};
use dashu::rational::RBig;
use std::marker::PhantomData;

/// The arithmetic of a number of fixed size, IEEE double precision if none is named.
///
/// Over machine floats it is fast, rounded, and never decisive. A division by exactly zero is refused and named;
/// an overflow runs through as an infinity and is for the caller to find at the end, where one test covers all
/// operations. Over an [`Interval`](super::Interval) it is rigorous, and a divisor that may be zero is refused.
#[derive(Clone, Copy, Debug)]
pub struct Floats<T = f64> {
    number: PhantomData<T>,
}

/// The arithmetic of `f64`: as a value, `Floats` is `Floats::<f64>::new()`.
#[allow(non_upper_case_globals)]
pub const Floats: Floats = Floats::new();

impl<T> Floats<T> {
    /// The arithmetic; it has no settings.
    pub const fn new() -> Self {
        Floats { number: PhantomData }
    }
}

impl<T> Default for Floats<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: RealNumber> Arithmetic for Floats<T> {
    type Number = T;

    #[inline]
    fn rational(&self, value: &RBig) -> Result<T, Refusal> {
        Ok(T::from_rational(value))
    }
    #[inline]
    fn pi(&self) -> Result<T, Refusal> {
        Ok(T::pi())
    }
    #[inline]
    fn add(&self, a: &T, b: &T) -> Result<T, Refusal> {
        Ok(*a + *b)
    }
    #[inline]
    fn sub(&self, a: &T, b: &T) -> Result<T, Refusal> {
        Ok(*a - *b)
    }
    #[inline]
    fn mul(&self, a: &T, b: &T) -> Result<T, Refusal> {
        Ok(*a * *b)
    }
    #[inline]
    fn div(&self, a: &T, b: &T) -> Result<T, Refusal> {
        a.quotient(*b)
    }
    #[inline]
    fn neg(&self, a: &T) -> Result<T, Refusal> {
        Ok(-*a)
    }
    #[inline]
    fn apply(&self, function: Function, a: &T) -> Result<T, Refusal> {
        a.function(function)
    }
    #[inline]
    fn is_zero(&self, a: &T) -> Option<bool> {
        a.is_zero()
    }
    #[inline]
    fn power(&self, a: &T, n: i32) -> Result<T, Refusal> {
        a.power(n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::DoubleDouble;

    /// What is common to the machine's floats: constants are rounded to nearest, a pole is named, an argument outside
    /// the domain too, and an overflow runs through.
    fn behaves_as_a_float<T: RealNumber>(third: T, largest: T) {
        let all = Floats::<T>::new();
        let number = |n: i64, d: u64| all.rational(&RBig::from_parts(n.into(), d.into())).unwrap();
        assert_eq!(number(1, 3), third);
        assert_eq!(all.div(&number(1, 1), &number(3, 1)), Ok(third));
        assert_eq!(all.div(&third, &number(0, 1)), Err(Refusal::DivisionByZero));
        assert_eq!(all.power(&number(0, 1), -2), Err(Refusal::DivisionByZero));
        assert_eq!(all.power(&number(-2, 1), 5), Ok(number(-32, 1)));
        assert_eq!(all.power(&number(-2, 1), i32::MIN), all.rational(&RBig::ZERO));
        assert_eq!(all.apply(Function::Sqrt, &number(-1, 1)), Err(Refusal::OutsideDomain(Function::Sqrt)));
        assert_eq!(all.apply(Function::Acos, &number(3, 2)), Err(Refusal::OutsideDomain(Function::Acos)));
        assert!(!all.mul(&largest, &largest).unwrap().is_finite() && largest.is_finite());
        assert_eq!(all.is_zero(&number(0, 1)), Some(true));
    }

    #[test]
    fn floats_round_and_name_their_poles() {
        behaves_as_a_float(1.0f32 / 3.0, f32::MAX);
        behaves_as_a_float(1.0f64 / 3.0, f64::MAX);
        let third = DoubleDouble::ONE / DoubleDouble::from(3.0);
        behaves_as_a_float(third, DoubleDouble::from(f64::MAX));
    }
}
