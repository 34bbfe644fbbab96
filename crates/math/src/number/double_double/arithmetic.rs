//! Sum, difference, product and quotient of double-doubles, as operators: algorithms 6, 10 and 17 of Joldes, Muller and
//! Popescu.

use super::DoubleDouble;
use crate::number::error_free::{fast_two_sum, two_product, two_sum};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

impl Neg for DoubleDouble {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        DoubleDouble { hi: -self.hi, lo: -self.lo }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        let (high, low) = two_sum(self.hi, other.hi);
        if !high.is_finite() {
            return DoubleDouble { hi: high, lo: 0.0 };
        }
        let (t1, t2) = two_sum(self.lo, other.lo);
        let (high, low) = fast_two_sum(high, low + t1);
        Self::normalised(high, t2 + low)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let (high, low) = two_product(self.hi, other.hi);
        if !high.is_finite() {
            return DoubleDouble { hi: high, lo: 0.0 };
        }
        Self::normalised(high, low + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let quotient = self.hi / other.hi;
        // the divisor times the quotient has to stay within the range, and must not lose its low bits
        let ordinary = |x: f64| (1e-150..=1e150).contains(&x.abs());
        if !(ordinary(self.hi) && ordinary(other.hi)) {
            return divide_extremes(self, other, quotient);
        }
        let product = other.times(quotient);
        let rest = (self.hi - product.hi) + (self.lo - product.lo);
        Self::normalised(quotient, rest / other.hi)
    }
}

/// The quotient where one of the numbers is zero, infinite, a NaN, or so great or small that it is scaled first.
#[cold]
fn divide_extremes(a: DoubleDouble, b: DoubleDouble, quotient: f64) -> DoubleDouble {
    let plain = |x: f64| x != 0.0 && x.is_finite();
    if !(plain(a.hi) && plain(b.hi)) {
        return DoubleDouble { hi: quotient, lo: 0.0 };
    }
    // each to the neighbourhood of one (2^-52 is near enough, where it was subnormal)
    let (of_a, of_b) = (exponent_of(a.hi), exponent_of(b.hi));
    let unit = shifted(a, -of_a) / shifted(b, -of_b);
    shifted(unit, of_a - of_b)
}

/// The binary exponent of a normal number; -1022 for zero and subnormal ones.
pub(super) fn exponent_of(x: f64) -> i32 {
    ((x.abs().max(f64::MIN_POSITIVE).to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// Times `2^n`, `|n|` below 3000; one power of two could be out of range where the product is not.
pub(super) fn shifted(x: DoubleDouble, n: i32) -> DoubleDouble {
    let third = n / 3;
    x.scaled(2f64.powi(third)).scaled(2f64.powi(third)).scaled(2f64.powi(n - 2 * third))
}

macro_rules! further_operators {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident;)*) => {$(
        impl $operator<&DoubleDouble> for DoubleDouble {
            type Output = Self;
            #[inline]
            fn $method(self, other: &DoubleDouble) -> Self {
                self.$method(*other)
            }
        }
        impl $operator<f64> for DoubleDouble {
            type Output = Self;
            #[inline]
            fn $method(self, other: f64) -> Self {
                self.$method(DoubleDouble::from(other))
            }
        }
        impl $assign for DoubleDouble {
            #[inline]
            fn $assign_method(&mut self, other: Self) {
                *self = self.$method(other);
            }
        }
        impl $assign<f64> for DoubleDouble {
            #[inline]
            fn $assign_method(&mut self, other: f64) {
                *self = self.$method(other);
            }
        }
    )*};
}

further_operators! {
    Add add AddAssign add_assign;
    Sub sub SubAssign sub_assign;
    Mul mul MulAssign mul_assign;
    Div div DivAssign div_assign;
}
