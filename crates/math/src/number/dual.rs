//! Dual numbers of the crate num-dual as an [`Arithmetic`], over every number of fixed size.
//!
//! The rules of differentiation are num-dual's; nothing here differentiates. What is added is the way in: constants of
//! a program come to the innermost number as exact rationals (num-dual itself would pass them through a double, and
//! neither an enclosure nor thirty digits would survive that), and a division or a function that has no value there is
//! refused as it is without derivatives.
//!
//! A residue modulo a prime is no `DualNum`: it has no order, no magnitude and none of the functions that the trait
//! demands. Exact derivatives are the expression graph's.

use super::{Arithmetic, Function, RealNumber, Refusal, Tower};
use dashu::rational::RBig;
use nalgebra::allocator::Allocator;
use nalgebra::{DefaultAllocator, Dim, U1};
use num_dual::{Dual, Dual2Vec, DualNum, DualVec};
use std::marker::PhantomData;

/// A number that num-dual differentiates over or with: a plain one, or a dual of such.
pub trait Differentiable: DualNum {
    /// The plain number at the bottom of the duals.
    type Base: RealNumber;
    /// A constant.
    fn constant(value: Self::Base) -> Self;
    /// The value without its derivatives.
    fn base(&self) -> Self::Base;
}

impl<T: RealNumber + DualNum> Differentiable for T {
    type Base = T;
    fn constant(value: T) -> T {
        value
    }
    fn base(&self) -> T {
        *self
    }
}

impl<T: Differentiable> Differentiable for Dual<T> {
    type Base = T::Base;
    fn constant(value: T::Base) -> Self {
        Dual::from_re(T::constant(value))
    }
    fn base(&self) -> T::Base {
        self.re.base()
    }
}

impl<T: Differentiable, D: Dim> Differentiable for DualVec<T, D>
where
    DefaultAllocator: Allocator<D>,
{
    type Base = T::Base;
    fn constant(value: T::Base) -> Self {
        DualVec::from_re(T::constant(value))
    }
    fn base(&self) -> T::Base {
        self.re.base()
    }
}

impl<T: Differentiable, D: Dim> Differentiable for Dual2Vec<T, D>
where
    DefaultAllocator: Allocator<U1, D> + Allocator<D> + Allocator<D, D>,
{
    type Base = T::Base;
    fn constant(value: T::Base) -> Self {
        Dual2Vec::from_re(T::constant(value))
    }
    fn base(&self) -> T::Base {
        self.re.base()
    }
}

impl<T: Differentiable> Differentiable for Tower<T> {
    type Base = T::Base;
    fn constant(value: T::Base) -> Self {
        Tower::Leaf(T::constant(value))
    }
    fn base(&self) -> T::Base {
        self.bottom().base()
    }
}

/// The numbers of any type that num-dual can differentiate over.
#[derive(Clone, Copy, Debug)]
pub struct Duals<T>(PhantomData<T>);

impl<T> Default for Duals<T> {
    fn default() -> Self {
        Duals(PhantomData)
    }
}

impl<T: Differentiable> Arithmetic for Duals<T> {
    type Number = T;

    fn rational(&self, value: &RBig) -> Result<T, Refusal> {
        Ok(T::constant(T::Base::from_rational(value)))
    }
    fn pi(&self) -> Result<T, Refusal> {
        Ok(T::constant(T::Base::pi()))
    }
    fn add(&self, a: &T, b: &T) -> Result<T, Refusal> {
        Ok(a.clone() + b)
    }
    fn sub(&self, a: &T, b: &T) -> Result<T, Refusal> {
        Ok(a.clone() - b)
    }
    fn mul(&self, a: &T, b: &T) -> Result<T, Refusal> {
        Ok(a.clone() * b)
    }
    fn div(&self, a: &T, b: &T) -> Result<T, Refusal> {
        b.base().check_divisor()?;
        Ok(a.clone() / b)
    }
    fn neg(&self, a: &T) -> Result<T, Refusal> {
        Ok(-a.clone())
    }
    fn apply(&self, function: Function, a: &T) -> Result<T, Refusal> {
        if a.base().is_outside(function) {
            return Err(Refusal::OutsideDomain(function));
        }
        Ok(match function {
            Function::Sin => a.sin(),
            Function::Cos => a.cos(),
            Function::Asin => a.asin(),
            Function::Acos => a.acos(),
            Function::Atan => a.atan(),
            Function::Sqrt => a.sqrt(),
            Function::Exp => a.exp(),
            Function::Log => a.ln(),
        })
    }
    /// By repeated squaring, as for other numbers, but without a product with one, and without the exact number one for each power.
    fn power(&self, a: &T, n: i32) -> Result<T, Refusal> {
        let one = || T::constant(T::Base::from_f64(1.0));
        let (mut result, mut square, mut rest) = (None, a.clone(), n.unsigned_abs());
        while rest > 0 {
            if rest & 1 == 1 {
                result = Some(match result {
                    None => square.clone(),
                    Some(result) => result * &square,
                });
            }
            rest >>= 1;
            if rest > 0 {
                square = square.clone() * &square;
            }
        }
        let result = result.unwrap_or_else(one);
        if n < 0 { self.div(&one(), &result) } else { Ok(result) }
    }
    /// Unknown: a dual number whose value is zero may still have a derivative.
    fn is_zero(&self, a: &T) -> Option<bool> {
        match a.base().is_zero() {
            Some(false) => Some(false),
            _ => None,
        }
    }
}
