//! Duals nested to a depth that is known only at run time.
//!
//! The rules of differentiation are num-dual's, at every level; nothing here differentiates.

use num_dual::{Dual, DualNum, DualNumFloat, DualStruct, Mappable};
use num_traits::{FromPrimitive, Inv, Num, One, Signed, Zero};
use std::cmp::Ordering;
use std::fmt;
use std::iter::{Product, Sum};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign};

/// Duals within duals, to any depth: `Leaf` is a plain number, `Nest` a num-dual [`Dual`] whose two parts are towers
/// one level lower.
///
/// Operands of different depth meet by lifting the lower one to a constant of the higher. A derivative of order `k`
/// costs `2^k` numbers: this is the witness for the expression graph and not its rival.
#[derive(Clone, Debug)]
pub enum Tower<T> {
    /// A number that depends on none of the small quantities.
    Leaf(T),
    /// A number and its derivative by the outermost small quantity.
    Nest(Box<Dual<Tower<T>>>),
}

use Tower::{Leaf, Nest};

impl<T: DualNum> Tower<T> {
    /// `value + slope * e`, one level above both.
    pub fn nest(value: Tower<T>, slope: Tower<T>) -> Self {
        Nest(Box::new(Dual::new(value, slope)))
    }

    /// The derivative by the outermost small quantity of a tower `depth` levels high.
    pub fn slope(self, depth: usize) -> Self {
        match self {
            Nest(dual) if dual_depth(&dual) >= depth => dual.eps,
            _ => Leaf(T::zero()),
        }
    }

    /// The plain number at the bottom, if no level was used or the derivatives are not wanted.
    pub fn leaf(self) -> T {
        match self {
            Leaf(value) => value,
            Nest(dual) => dual.re.leaf(),
        }
    }

    /// The plain number at the bottom.
    pub fn bottom(&self) -> &T {
        match self {
            Leaf(value) => value,
            Nest(dual) => dual.re.bottom(),
        }
    }

    fn depth(&self) -> usize {
        match self {
            Leaf(_) => 0,
            Nest(dual) => dual_depth(dual),
        }
    }

    fn lifted(self) -> Dual<Tower<T>> {
        match self {
            Nest(dual) => *dual,
            leaf => Dual::new(leaf, Leaf(T::zero())),
        }
    }

    fn unary(&self, leaf: impl Fn(&T) -> T, nest: impl Fn(&Dual<Tower<T>>) -> Dual<Tower<T>>) -> Self {
        match self {
            Leaf(value) => Leaf(leaf(value)),
            Nest(dual) => Nest(Box::new(nest(dual))),
        }
    }

    fn binary(
        self,
        other: Self,
        leaf: impl Fn(T, T) -> T,
        nest: impl Fn(Dual<Tower<T>>, Dual<Tower<T>>) -> Dual<Tower<T>>,
    ) -> Self {
        match (self, other) {
            (Leaf(a), Leaf(b)) => Leaf(leaf(a, b)),
            (a, b) => match a.depth().cmp(&b.depth()) {
                Ordering::Equal => Nest(Box::new(nest(a.lifted(), b.lifted()))),
                Ordering::Less => Nest(Box::new(nest(Dual::from_re(a), b.lifted()))),
                Ordering::Greater => Nest(Box::new(nest(a.lifted(), Dual::from_re(b)))),
            },
        }
    }
}

fn dual_depth<T: DualNum>(dual: &Dual<Tower<T>>) -> usize {
    1 + dual.re.depth().max(dual.eps.depth())
}

macro_rules! operators {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident;)*) => {$(
        impl<T: DualNum> $operator for Tower<T> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.binary(other, |a, b| a.$method(b), |a, b| a.$method(b))
            }
        }
        impl<T: DualNum> $operator<&Tower<T>> for Tower<T> {
            type Output = Self;
            fn $method(self, other: &Self) -> Self {
                self.$method(other.clone())
            }
        }
        impl<T: DualNum<Primitive = F>, F: DualNumFloat> $operator<F> for Tower<T> {
            type Output = Self;
            fn $method(self, other: F) -> Self {
                self.$method(Leaf(T::from(other)))
            }
        }
        impl<T: DualNum> $assign for Tower<T> {
            fn $assign_method(&mut self, other: Self) {
                *self = self.clone().$method(other);
            }
        }
        impl<T: DualNum<Primitive = F>, F: DualNumFloat> $assign<F> for Tower<T> {
            fn $assign_method(&mut self, other: F) {
                *self = self.clone().$method(other);
            }
        }
    )*};
}

operators! {
    Add add AddAssign add_assign;
    Sub sub SubAssign sub_assign;
    Mul mul MulAssign mul_assign;
    Div div DivAssign div_assign;
    Rem rem RemAssign rem_assign;
}

impl<T: DualNum> Neg for Tower<T> {
    type Output = Self;
    fn neg(self) -> Self {
        self.unary(|a| -a.clone(), |a| -a.clone())
    }
}

impl<T: DualNum> Inv for Tower<T> {
    type Output = Self;
    fn inv(self) -> Self {
        self.unary(|a| a.recip(), |a| a.recip())
    }
}

// num-dual compares duals by their values alone; so does a tower.
impl<T: DualNum> PartialEq for Tower<T> {
    fn eq(&self, other: &Self) -> bool {
        self.bottom() == other.bottom()
    }
}
impl<T: DualNum> PartialOrd for Tower<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.bottom().partial_cmp(other.bottom())
    }
}
impl<T: DualNum<Primitive = F>, F: DualNumFloat> PartialEq<F> for Tower<T> {
    fn eq(&self, other: &F) -> bool {
        self.bottom() == other
    }
}
impl<T: DualNum<Primitive = F>, F: DualNumFloat> PartialOrd<F> for Tower<T> {
    fn partial_cmp(&self, other: &F) -> Option<Ordering> {
        self.bottom().partial_cmp(other)
    }
}

impl<T: DualNum> Zero for Tower<T> {
    fn zero() -> Self {
        Leaf(T::zero())
    }
    fn is_zero(&self) -> bool {
        self.bottom().is_zero()
    }
}
impl<T: DualNum> One for Tower<T> {
    fn one() -> Self {
        Leaf(T::one())
    }
}
impl<T: DualNum> Num for Tower<T> {
    type FromStrRadixErr = T::FromStrRadixErr;
    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        T::from_str_radix(text, radix).map(Leaf)
    }
}
impl<T: DualNum> Signed for Tower<T> {
    fn abs(&self) -> Self {
        self.unary(|a| a.abs(), |a| a.abs())
    }
    fn abs_sub(&self, other: &Self) -> Self {
        if self > other { self.clone() - other } else { Self::zero() }
    }
    fn signum(&self) -> Self {
        self.unary(|a| a.signum(), |a| a.signum())
    }
    fn is_positive(&self) -> bool {
        self.bottom().is_positive()
    }
    fn is_negative(&self) -> bool {
        self.bottom().is_negative()
    }
}
impl<T: DualNum> FromPrimitive for Tower<T> {
    fn from_i64(n: i64) -> Option<Self> {
        T::from_i64(n).map(Leaf)
    }
    fn from_u64(n: u64) -> Option<Self> {
        T::from_u64(n).map(Leaf)
    }
    fn from_f64(x: f64) -> Option<Self> {
        T::from_f64(x).map(Leaf)
    }
}
impl<T: DualNum<Primitive = F>, F: DualNumFloat> From<F> for Tower<T> {
    fn from(value: F) -> Self {
        Leaf(T::from(value))
    }
}
impl<T: DualNum> Sum for Tower<T> {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::zero(), |a, b| a + b)
    }
}
impl<T: DualNum> Product for Tower<T> {
    fn product<I: Iterator<Item = Self>>(factors: I) -> Self {
        factors.fold(Self::one(), |a, b| a * b)
    }
}
impl<T: DualNum> fmt::Display for Tower<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Leaf(value) => fmt::Display::fmt(value, f),
            Nest(dual) => write!(f, "({dual})"),
        }
    }
}

impl<T: DualNum> DualStruct for Tower<T> {
    type Real = T::Primitive;
    type Inner = Self;
    fn re(&self) -> T::Primitive {
        self.bottom().re()
    }
    fn from_inner(inner: &Self) -> Self {
        inner.clone()
    }
}
impl<T: DualNum> Mappable<Tower<T>> for Tower<T> {
    type Output<O> = O;
    fn map_dual<M: Fn(Tower<T>) -> O, O>(self, f: M) -> O {
        f(self)
    }
}

macro_rules! unary_functions {
    ($($name:ident)*) => {$(
        fn $name(&self) -> Self {
            self.unary(|a| a.$name(), |a| a.$name())
        }
    )*};
}

impl<T: DualNum> DualNum for Tower<T> {
    type Primitive = T::Primitive;
    const NDERIV: usize = T::NDERIV;
    type InnerDual = Self;

    fn from_re(re: Self) -> Self {
        re
    }
    fn scale(self, factor: &Self) -> Self {
        self * factor
    }
    fn powi(&self, n: i32) -> Self {
        self.unary(|a| a.powi(n), |a| a.powi(n))
    }
    fn powf(&self, n: T::Primitive) -> Self {
        self.unary(|a| a.powf(n), |a| a.powf(n))
    }
    fn log(&self, base: T::Primitive) -> Self {
        self.unary(|a| a.log(base), |a| a.log(base))
    }
    fn sin_cos(&self) -> (Self, Self) {
        (self.sin(), self.cos())
    }
    fn atan2(&self, other: Self) -> Self {
        self.clone().binary(other, |a, b| a.atan2(b), |a, b| a.atan2(b))
    }
    unary_functions! {
        recip sqrt cbrt exp exp2 exp_m1 ln log2 log10 ln_1p sin cos tan asin acos atan
        sinh cosh tanh asinh acosh atanh sph_j0 sph_j1 sph_j2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn second_derivative(f: impl Fn(Tower<f64>) -> Tower<f64>, x: f64) -> f64 {
        let inner = Tower::nest(Leaf(x), Leaf(1.0));
        let outer = Tower::nest(inner.clone(), Leaf(1.0));
        f(outer).slope(2).slope(1).leaf()
    }

    #[test]
    fn second_derivatives_by_hand() {
        assert_eq!(second_derivative(|x| x.clone() * x.clone() * x, 2.0), 12.0);
        assert!((second_derivative(|x| x.recip(), 2.0) - 0.25).abs() < 1e-15);
        assert!((second_derivative(|x| x.sin(), 0.5) + 0.5f64.sin()).abs() < 1e-15);
    }

    #[test]
    fn a_constant_is_not_moved() {
        assert_eq!(second_derivative(|_| Leaf(3.0), 2.0), 0.0);
    }
}
