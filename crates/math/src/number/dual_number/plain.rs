//! What double-doubles and intervals do differently where num-dual's trait is concerned.

use crate::number::{DoubleDouble, Function, Interval, RealNumber};

/// A number that holds no derivatives itself.
pub(super) trait Plain: RealNumber {
    /// The value where there is none.
    const UNKNOWN: Self;
    /// The remainder of the division towards zero.
    fn remainder(self, divisor: Self) -> Self;
    /// Every angle, or the one that stands for all.
    fn any_angle() -> Self;
    /// The spherical Bessel function of the first kind and order zero, one or two.
    fn spherical_bessel(self, order: u32) -> Self;

    fn value(self, function: Function) -> Self {
        self.function(function).unwrap_or(Self::UNKNOWN)
    }
    fn raised(self, n: i32) -> Self {
        self.power(n).unwrap_or(Self::UNKNOWN)
    }
    fn logarithm(self, base: f64) -> Self {
        self.value(Function::Log) / Self::from_f64(base).value(Function::Log)
    }
    /// `sin x/x`, `sin x/x^2 - cos x/x`, `(3/x^3 - 1/x) sin x - 3 cos x/x^2`.
    fn closed_bessel(self, order: u32) -> Self {
        let (sin, cos, three) = (self.value(Function::Sin), self.value(Function::Cos), Self::from_f64(3.0));
        match order {
            0 => sin / self,
            1 => (sin / self - cos) / self,
            _ => ((three / self.raised(2) - Self::from_f64(1.0)) * sin - three * cos / self) / self,
        }
    }
}

impl Plain for DoubleDouble {
    const UNKNOWN: Self = DoubleDouble::NAN;

    fn remainder(self, divisor: Self) -> Self {
        self - divisor * (self / divisor).trunc()
    }
    fn any_angle() -> Self {
        DoubleDouble::ZERO
    }
    fn spherical_bessel(self, order: u32) -> Self {
        if self.abs() > DoubleDouble::ONE {
            return self.closed_bessel(order);
        }
        // x^n/(2n + 1)!! (1 - x^2/2/(2n + 3) (1 - x^2/4/(2n + 5) (...))), without cancellation
        let n = f64::from(order);
        let square = self.sqr();
        let series = (1..15).rev().map(f64::from).fold(DoubleDouble::ONE, |rest, k| {
            DoubleDouble::ONE - square * rest / DoubleDouble::from(2.0 * k * (2.0 * (n + k) + 1.0))
        });
        let first = [1.0, 3.0, 15.0][order.min(2) as usize];
        self.raised(order as i32) * series / DoubleDouble::from(first)
    }
}

impl Plain for Interval {
    const UNKNOWN: Self = Interval::WHOLE;

    fn remainder(self, divisor: Self) -> Self {
        let quotient = self / divisor;
        let whole = quotient.low().trunc();
        if whole == quotient.high().trunc() && whole.is_finite() {
            self - divisor * Interval::point(whole)
        } else if divisor.contains_zero() {
            Interval::WHOLE
        } else {
            Interval::new(-divisor.magnitude(), divisor.magnitude())
        }
    }
    fn any_angle() -> Self {
        Interval::PI.hull(-Interval::PI)
    }
    fn spherical_bessel(self, order: u32) -> Self {
        let bound = Interval::new(-1.0, 1.0); // of all of them: they are means of plane waves
        self.closed_bessel(order).intersection(bound).unwrap_or(bound)
    }
}
