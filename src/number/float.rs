//! Machine floats as an [`Arithmetic`]: fast, rounded, and never the last word.

use super::{Arithmetic, Function, Refusal, rational_to_f64};
use dashu::rational::RBig;

/// IEEE double precision. A division by exactly zero is refused and named; an overflow runs through as an infinity
/// and is for the caller to find at the end, where one test covers all operations.
#[derive(Clone, Copy, Debug, Default)]
pub struct Floats;

impl Arithmetic for Floats {
    type Number = f64;

    #[inline]
    fn rational(&self, value: &RBig) -> Result<f64, Refusal> {
        Ok(rational_to_f64(value))
    }
    #[inline]
    fn pi(&self) -> Result<f64, Refusal> {
        Ok(std::f64::consts::PI)
    }
    #[inline]
    fn add(&self, a: &f64, b: &f64) -> Result<f64, Refusal> {
        Ok(a + b)
    }
    #[inline]
    fn sub(&self, a: &f64, b: &f64) -> Result<f64, Refusal> {
        Ok(a - b)
    }
    #[inline]
    fn mul(&self, a: &f64, b: &f64) -> Result<f64, Refusal> {
        Ok(a * b)
    }
    #[inline]
    fn div(&self, a: &f64, b: &f64) -> Result<f64, Refusal> {
        if *b == 0.0 { Err(Refusal::DivisionByZero) } else { Ok(a / b) }
    }
    #[inline]
    fn neg(&self, a: &f64) -> Result<f64, Refusal> {
        Ok(-a)
    }
    fn apply(&self, function: Function, a: &f64) -> Result<f64, Refusal> {
        let value = match function {
            Function::Sin => a.sin(),
            Function::Cos => a.cos(),
            Function::Asin => a.asin(),
            Function::Acos => a.acos(),
            Function::Atan => a.atan(),
            Function::Sqrt => a.sqrt(),
            Function::Exp => a.exp(),
            Function::Log => a.ln(),
        };
        if value.is_nan() && !a.is_nan() { Err(Refusal::OutsideDomain(function)) } else { Ok(value) }
    }
    fn is_zero(&self, a: &f64) -> Option<bool> {
        Some(*a == 0.0)
    }
}
