//! Functions of one variable on intervals: from the values at the ends where the function is monotone, and sine and
//! cosine from where their greatest and least values may lie.
//!
//! The value at an end is found as a double-double, whose error is bounded by proof ([`DoubleDouble`]), and the double
//! is stepped outward where that error could carry the value beyond it: nearly always the two doubles next to the
//! value are found.

use super::Interval;
use super::circular::circular;
use super::rounding::{around, sqrt_down, sqrt_up};
use crate::number::{DoubleDouble, Function, RealNumber};

impl Interval {
    /// The function's values on the interval; `None` where one of its numbers lies outside the function's domain.
    pub fn image(self, function: Function) -> Option<Self> {
        if self.is_outside(function) {
            return None;
        }
        let increasing = |f: fn(DoubleDouble) -> DoubleDouble| Interval {
            lo: around(f(self.lo.into())).lo,
            hi: around(f(self.hi.into())).hi,
        };
        let all = match function {
            Function::Sin => self.sin_cos().0,
            Function::Cos => self.sin_cos().1,
            Function::Sqrt => Interval { lo: sqrt_down(self.lo), hi: sqrt_up(self.hi) },
            Function::Exp => increasing(DoubleDouble::exp),
            Function::Log => increasing(DoubleDouble::ln),
            Function::Atan => increasing(DoubleDouble::atan),
            Function::Asin => increasing(DoubleDouble::asin),
            Function::Acos => -increasing(|x| -x.acos()),
        };
        // where the value is rational, it is met exactly
        let exactly = |x: f64| match function {
            Function::Asin | Function::Atan if x == 0.0 => Some(0.0),
            Function::Exp if x == 0.0 => Some(1.0),
            Function::Log | Function::Acos if x == 1.0 => Some(0.0),
            Function::Exp if x == f64::NEG_INFINITY => Some(0.0),
            _ => None,
        };
        let (first, last) = if function == Function::Acos { (self.hi, self.lo) } else { (self.lo, self.hi) };
        let least = if function == Function::Exp { 0.0 } else { f64::NEG_INFINITY };
        Some(Interval {
            lo: exactly(first).unwrap_or(all.lo.max(least)),
            hi: exactly(last).unwrap_or(all.hi),
        })
    }

    /// Sine and cosine together, for half the price.
    pub fn sin_cos(self) -> (Self, Self) {
        const RANGE: Interval = Interval { lo: -1.0, hi: 1.0 };
        if self.lo == f64::NEG_INFINITY || self.hi == f64::INFINITY {
            return (RANGE, RANGE);
        }
        let low = circular(self.lo);
        if self.is_point() {
            return (low.sin, low.cos);
        }
        let high = circular(self.hi);
        let width = self.width();
        let meets = |k: i32| low.meets(&high, width, k);
        // between its crest and its trough a wave is monotone
        let wave = |ends: Interval, crest: i32, trough: i32| Interval {
            lo: if meets(trough) { -1.0 } else { ends.lo },
            hi: if meets(crest) { 1.0 } else { ends.hi },
        };
        (wave(low.sin.hull(high.sin), 1, 3), wave(low.cos.hull(high.cos), 0, 2))
    }
}
