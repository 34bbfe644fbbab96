//! Numbers of fixed size as an [`Arithmetic`].

use super::{Arithmetic, Function, Real, Refusal};
use dashu::rational::RBig;
use std::marker::PhantomData;

/// The arithmetic of a number of fixed size, IEEE double precision if none is named.
///
/// Over machine floats it is fast, rounded, and never the last word. A division by exactly zero is refused and named;
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

impl<T: Real> Arithmetic for Floats<T> {
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
