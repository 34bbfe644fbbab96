//! Functions of one variable on intervals: from the values at the ends where the function is monotone, and sine and
//! cosine from where their greatest and least values may lie.
//!
//! The value at an end is found as a double-double, whose error is bounded by proof ([`DoubleDouble`]), and the double
//! is stepped outward where that error could carry the value beyond it: nearly always the two doubles next to the
//! value are found.

use super::Interval;
use super::rounding::{sqrt_down, sqrt_up};
use crate::number::{DoubleDouble, Function, Real};

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
        let (sin, cos) = at(self.lo);
        if self.is_point() {
            return (sin, cos);
        }
        let (sin_high, cos_high) = at(self.hi);
        let (sin, cos) = (sin.hull(sin_high), cos.hull(cos_high));
        // between its crests, a whole number of turns from `crest`, and its troughs half a turn on, a wave is monotone;
        // if in doubt whether there is one between the ends there is
        let turns = self / (Interval::PI + Interval::PI);
        let meets = |crest: f64| {
            let counted = turns - Interval::point(crest);
            counted.lo.ceil() <= counted.hi
        };
        let wave = |ends: Interval, crest: f64| Interval {
            lo: if meets(crest + 0.5) { -1.0 } else { ends.lo },
            hi: if meets(crest) { 1.0 } else { ends.hi },
        };
        (wave(sin, 0.25), wave(cos, 0.0))
    }
}

/// Sine and cosine of a finite number.
fn at(x: f64) -> (Interval, Interval) {
    if x == 0.0 {
        return (Interval::ZERO, Interval::ONE);
    }
    let (sin, cos) = DoubleDouble::from(x).sin_cos();
    let within = |all: Interval| Interval { lo: all.lo.max(-1.0), hi: all.hi.min(1.0) };
    (within(around(sin)), within(around(cos)))
}

/// The doubles around the number of which this is the value of a function, right to `2^-100` of itself.
fn around(value: DoubleDouble) -> Interval {
    let (hi, lo) = (value.hi(), value.lo());
    if hi.abs() < 1e-270 {
        // here a double-double may have no low part; it is right to a unit in the last place of a double
        return Interval { lo: hi.next_down().next_down(), hi: hi.next_up().next_up() };
    }
    if hi.is_infinite() {
        return Interval::point(hi);
    }
    // |lo| is at most half a step from hi in either direction, and the error far below the other half
    let error = hi.abs() * f64::from_bits((1023 - 99) << 52);
    Interval {
        lo: if lo >= error { hi } else { hi.next_down() },
        hi: if lo <= -error { hi } else { hi.next_up() },
    }
}
