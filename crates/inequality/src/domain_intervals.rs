//! Intervals of doubles over the states at which things exist: of a root's argument only the part that is not negative
//! counts, and what cannot be bounded is the whole line. Nothing is refused, so that a program always has values; each
//! encloses the values at all states of the box at which all that it needs exists.

use dashu::rational::RBig;
use palmistry_math::number::{Arithmetic, Function, Interval, RealNumber, Refusal};

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

#[cfg(test)]
mod tests {
    use super::*;

    /// Every value at which the operation exists lies in the interval, also beside poles and infinities.
    #[test]
    fn what_exists_is_enclosed() {
        let all = WhereDefined;
        let divide = |a: (f64, f64), b: (f64, f64)| {
            all.div(&Interval::new(a.0, a.1), &Interval::new(b.0, b.1)).unwrap()
        };
        assert!(divide((0.0, 0.0), (0.0, 2.0)).contains(0.0));
        assert!(divide((0.0, 0.0), (-2.0, 0.0)).contains(0.0));
        assert!(divide((-1.0, 0.0), (-2.0, 0.0)).encloses(Interval::new(0.0, 1e6)));
        let above = divide((1.0, 2.0), (0.0, 4.0));
        assert!(above.low() > 0.2499 && above.contains(1e300));
        let below = divide((1.0, 2.0), (-4.0, 0.0));
        assert!(below.high() < -0.2499 && below.contains(-1e300));
        assert_eq!(divide((1.0, 2.0), (-1.0, 1.0)), Interval::WHOLE);
        let of = |function, low, high| all.apply(function, &Interval::new(low, high)).unwrap();
        assert!(of(Function::Sqrt, -4.0, 9.0).encloses(Interval::new(0.0, 3.0)));
        assert!(of(Function::Sqrt, -4.0, 9.0).low() >= 0.0);
        let log = of(Function::Log, -1.0, 1.0);
        assert!(log.contains(-1e300) && log.contains(0.0) && log.high() < 1e-9);
        assert_eq!(of(Function::Log, -2.0, -1.0), Interval::WHOLE);
        assert!(of(Function::Asin, 0.5, 7.0).contains(1.5));
    }
}
