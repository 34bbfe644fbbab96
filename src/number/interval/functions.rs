//! Functions of one variable on intervals: from the values at the ends where the function is monotone, and sine and
//! cosine from where their greatest and least values may lie.

use super::Interval;
use super::rounding::{sqrt_down, sqrt_up};
use crate::number::{Arithmetic, Enclosures, Function, rational_from_f64, rational_to_f64};

impl Interval {
    /// The function's values on the interval; `None` where one of its numbers lies outside the function's domain.
    pub fn image(self, function: Function) -> Option<Self> {
        let increasing = |f: &dyn Fn(f64) -> Interval| Interval { lo: f(self.lo).lo, hi: f(self.hi).hi };
        let outside = match function {
            Function::Asin | Function::Acos => self.lo < -1.0 || self.hi > 1.0,
            Function::Sqrt => self.lo < 0.0,
            Function::Log => self.lo <= 0.0,
            _ => false,
        };
        if outside {
            return None;
        }
        Some(match function {
            Function::Sin => self.wave(Function::Sin, 0.25),
            Function::Cos => self.wave(Function::Cos, 0.0),
            Function::Sqrt => Interval { lo: sqrt_down(self.lo), hi: sqrt_up(self.hi) },
            Function::Acos => Interval { lo: at(function, self.hi).lo, hi: at(function, self.lo).hi },
            _ => increasing(&|x| at(function, x)),
        })
    }

    /// A function of period 2 pi whose greatest value 1 is at `crest` turns, its least value -1 half a turn on, and
    /// which is monotone between them.
    fn wave(self, function: Function, crest: f64) -> Self {
        const RANGE: Interval = Interval { lo: -1.0, hi: 1.0 };
        if self.lo == f64::NEG_INFINITY || self.hi == f64::INFINITY {
            return RANGE;
        }
        let ends = at(function, self.lo).hull(at(function, self.hi));
        if self.is_point() {
            return ends;
        }
        // whether a whole number of turns lies in it, counted from the crest or the trough: if in doubt, yes
        let turns = self / (Interval::PI * 2.0);
        let meets = |shift: f64| {
            let counted = turns - shift;
            counted.lo.ceil() <= counted.hi
        };
        Interval {
            lo: if meets(crest + 0.5) { -1.0 } else { ends.lo },
            hi: if meets(crest) { 1.0 } else { ends.hi },
        }
    }
}

/// The function's value at one number of its domain, which may be infinite where the function has a limit.
fn at(function: Function, x: f64) -> Interval {
    match function {
        Function::Exp if x > 709.8 => return Interval { lo: f64::MAX, hi: f64::INFINITY },
        Function::Exp if x < -745.2 => return Interval { lo: 0.0, hi: f64::from_bits(1) },
        Function::Log if x == f64::INFINITY => return Interval { lo: 709.7, hi: f64::INFINITY },
        Function::Atan if x.is_infinite() => return Interval::PI * 0.5_f64.copysign(x),
        _ => (),
    }
    let wide = Enclosures::new(64);
    let value = rational_from_f64(x).and_then(|x| wide.apply(function, &wide.rational(&x).ok()?).ok());
    value.map_or(Interval::WHOLE, |value| {
        // the conversion is to nearest, and the neighbours of the nearest are beyond
        let (lo, hi) = (rational_to_f64(&value.low()), rational_to_f64(&value.high()));
        let exact = |x: f64, end| rational_from_f64(x) == Some(end);
        Interval {
            lo: if exact(lo, value.low()) { lo } else { lo.next_down() },
            hi: if exact(hi, value.high()) { hi } else { hi.next_up() },
        }
    })
}
