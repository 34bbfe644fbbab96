//! A number and a bound on its error, lane by lane: running error analysis (J. H. Wilkinson; N. J. Higham, *Accuracy and
//! Stability of Numerical Algorithms*, 2002, section 3.3).
//!
//! The bound is rigorous: it holds for the exact value of the same expression, but that functions other than the square
//! root, the sine and the cosine are believed to be accurate ([`ErrorBounds::without_bound`]). It is kept in units of `2^-53` and
//! itself computed with rounding, which [`Bounded::error`] makes up for.

use super::Function;
use super::lanes::{ErrorBounds, LaneTask, Lanes};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The unit of rounding: to the nearest double, `|fl(x) - x| <= 2^-53 |fl(x)|`.
const UNIT: f64 = f64::EPSILON / 2.0;

/// Added to the bound of a product, in units of rounding: one that is so small that it is rounded to a fixed number of
/// places.
const SUBNORMAL: f64 = f64::MIN_POSITIVE;

/// The terms of a bound are positive, so that each of its own roundings takes away no more than a `2^-53`th part; a
/// million of them in a row stay below this.
const SLACK: f64 = 1.0 + 1e-9;

/// What is divided by must be known to this part of itself.
const KNOWN: f64 = 1e-3;

/// Units of rounding within which the standard library's functions are believed to be: two in the last place.
const BELIEVED: f64 = 4.0;

/// A value, and how far it may be from the exact one.
#[derive(Clone, Copy, Debug)]
pub struct Bounded<L> {
    /// The value.
    pub value: L,
    /// The bound in units of `2^-53`, but for the roundings of the bound itself.
    pub units: L,
}

impl<L: Lanes> Bounded<L> {
    /// Exact values.
    #[inline(always)]
    pub fn exact(value: L) -> Self {
        Bounded { value, units: value.splat(0.0) }
    }

    /// The bound on the error. Not a number where there is none.
    #[inline(always)]
    pub fn error(self) -> L {
        self.units * self.value.splat(UNIT * SLACK)
    }

    /// Whether the exact value is certain not to be zero: `then` in these lanes, else `otherwise`.
    #[inline(always)]
    pub fn where_not_zero(self, then: L, otherwise: L) -> L {
        self.error().where_less(self.value.abs(), then, otherwise)
    }
}

impl<L: Lanes> Add for Bounded<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let value = self.value + other.value;
        Bounded { value, units: self.units + other.units + value.abs() }
    }
}

impl<L: Lanes> Sub for Bounded<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let value = self.value - other.value;
        Bounded { value, units: self.units + other.units + value.abs() }
    }
}

impl<L: Lanes> Mul for Bounded<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let value = self.value * other.value;
        let unit = value.splat(UNIT);
        // |a b - a' b'| <= (|a| + e) f + |b| e
        let propagated =
            (self.value.abs() + unit * self.units) * other.units + other.value.abs() * self.units;
        Bounded { value, units: propagated + (value.abs() + value.splat(SUBNORMAL)) }
    }
}

impl<L: Lanes> Div for Bounded<L> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let size = other.value.abs();
        let unit = value.splat(UNIT);
        let nothing = value.splat(f64::NAN);
        // the exact divisor is no smaller than (1 - KNOWN) times the computed one, or there is no bound
        let known = (unit * other.units).where_less(
            value.splat(KNOWN) * size,
            value.splat(1.0 + 2.0 * KNOWN),
            nothing,
        );
        let propagated = (self.units + value.abs() * other.units) / size * known;
        Bounded { value, units: propagated + (value.abs() + value.splat(SUBNORMAL)) }
    }
}

impl<L: Lanes> Neg for Bounded<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Bounded { value: -self.value, units: self.units }
    }
}

impl<L: Lanes> ErrorBounds for Bounded<L> {
    #[inline(always)]
    fn within(self, units: f64) -> Self {
        Bounded { units: self.value.splat(units), ..self }
    }
    #[inline(always)]
    fn without_bound(self) -> Self {
        self.within(f64::NAN)
    }
}

/// Comparisons look at the values alone.
impl<L: Lanes> Lanes for Bounded<L> {
    const COUNT: usize = L::COUNT;

    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        Bounded::exact(self.value.splat(value))
    }
    #[inline(always)]
    fn load(self, from: &[f64]) -> Self {
        Bounded::exact(self.value.load(from))
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        self.value.store(to);
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Bounded { value: self.value.abs(), units: self.units }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        let (unit, zero) = (value.splat(UNIT), value.splat(0.0));
        // |sqrt x - sqrt x'| <= |x - x'| / sqrt x, for x' >= 0; an exact zero stays one
        let propagated = zero.where_less(self.units, self.units / value, zero);
        let outside = self.value.where_less(unit * self.units, value.splat(f64::NAN), propagated);
        Bounded { value, units: outside + value.abs() }
    }
    #[inline(always)]
    fn where_less(self, bound: Self, then: Self, otherwise: Self) -> Self {
        Bounded {
            value: self.value.where_less(bound.value, then.value, otherwise.value),
            units: self.value.where_less(bound.value, then.units, otherwise.units),
        }
    }
    #[inline(always)]
    fn any_less(self, bound: Self) -> bool {
        self.value.any_less(bound.value)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        // their slopes are at most one, and they are within one unit in the last place: two units of rounding
        let (sine, cosine) = self.value.sin_cos();
        let two = sine.splat(2.0);
        (
            Bounded { value: sine, units: self.units + two * sine.abs() },
            Bounded { value: cosine, units: self.units + two * cosine.abs() },
        )
    }
    fn apart<T: LaneTask>(self, task: T) -> T::Output {
        self.value.apart(task)
    }
    #[inline(always)]
    fn apply(self, function: Function) -> Self {
        let (x, value) = (self.value, self.value.apply(function));
        let (one, nothing) = (x.splat(1.0), x.splat(f64::NAN));
        let distance = x.splat(UNIT) * self.units;
        let known = x.splat(KNOWN);
        // the greatest slope near the argument, within a part of 2 KNOWN; none where the argument is not known well enough
        let slope = match function {
            Function::Sin | Function::Cos | Function::Atan => one,
            Function::Exp => distance.where_less(known, value, nothing),
            Function::Log => distance.where_less(known * x, one / x, nothing),
            Function::Sqrt => distance.where_less(known * x, one / (value + value), nothing),
            Function::Asin | Function::Acos => {
                let rest = (one - x.abs()) * (one + x.abs());
                distance.where_less(known * rest, one / rest.sqrt(), nothing)
            }
        };
        let zero = x.splat(0.0);
        // what is exact stays so, at the ends of the domain too
        let propagated = zero.where_less(self.units, self.units * slope * x.splat(1.0 + 2.0 * KNOWN), zero);
        Bounded { value, units: propagated + value.abs() * x.splat(BELIEVED) }
    }
}
