//! Intervals of doubles over the states at which things exist: of a root's argument only the part that is not negative
//! counts, and what cannot be bounded is the whole line. Nothing is refused, so that a program always has values; each
//! encloses the values at all states of the box at which all that it needs exists.

use crate::number::{Arithmetic, Function, Interval, Real, Refusal};
use dashu::rational::RBig;

/// The arithmetic.
#[derive(Clone, Copy, Debug)]
pub struct WhereDefined;

impl Arithmetic for WhereDefined {
    type Number = Interval;

    fn rational(&self, value: &RBig) -> Result<Interval, Refusal> {
        Ok(Interval::from_rational(value))
    }
    fn pi(&self) -> Result<Interval, Refusal> {
        Ok(Interval::PI)
    }
    fn add(&self, a: &Interval, b: &Interval) -> Result<Interval, Refusal> {
        Ok(*a + *b)
    }
    fn sub(&self, a: &Interval, b: &Interval) -> Result<Interval, Refusal> {
        Ok(*a - *b)
    }
    fn mul(&self, a: &Interval, b: &Interval) -> Result<Interval, Refusal> {
        Ok(*a * *b)
    }
    fn div(&self, a: &Interval, b: &Interval) -> Result<Interval, Refusal> {
        // of a divisor that ends at zero the rest counts
        if b.low() == 0.0 && b.high() > 0.0 {
            return Ok(*a * Interval::new(reciprocal_below(b.high()), f64::INFINITY));
        }
        if b.high() == 0.0 && b.low() < 0.0 {
            return Ok(*a * Interval::new(f64::NEG_INFINITY, -reciprocal_below(-b.low())));
        }
        Ok(*a / *b)
    }
    fn neg(&self, a: &Interval) -> Result<Interval, Refusal> {
        Ok(-*a)
    }
    fn apply(&self, function: Function, a: &Interval) -> Result<Interval, Refusal> {
        let inside = match function {
            Function::Sqrt => a.intersection(Interval::new(0.0, f64::INFINITY)),
            Function::Asin | Function::Acos => a.intersection(Interval::new(-1.0, 1.0)),
            Function::Log if a.low() <= 0.0 => {
                let high = Interval::point(a.high()).function(function).ok().filter(|_| a.high() > 0.0);
                return Ok(high.map_or(Interval::WHOLE, |high| Interval::new(f64::NEG_INFINITY, high.high())));
            }
            _ => Some(*a),
        };
        Ok(inside.and_then(|inside| inside.function(function).ok()).unwrap_or(Interval::WHOLE))
    }
    fn is_zero(&self, _: &Interval) -> Option<bool> {
        None
    }
    fn power(&self, a: &Interval, n: i32) -> Result<Interval, Refusal> {
        if n < 0 {
            return self.div(&Interval::ONE, &a.pow(n.unsigned_abs()));
        }
        Ok(a.pow(n.unsigned_abs()))
    }
}

/// A number that is not above the reciprocal of a positive one.
fn reciprocal_below(value: f64) -> f64 {
    if value.is_infinite() { 0.0 } else { (1.0 / value).next_down().max(0.0) }
}
