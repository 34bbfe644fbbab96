//! Lanes without help from the instruction set: eight doubles side by side, and one alone.

use crate::number::lanes::{ErrorBounds, Lanes};
use crate::number::{Function, sine};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A function of a double by the standard library; not a number outside its domain.
pub(super) fn evaluate(function: Function, x: f64) -> f64 {
    match function {
        Function::Sin => x.sin(),
        Function::Cos => x.cos(),
        Function::Asin => x.asin(),
        Function::Acos => x.acos(),
        Function::Atan => x.atan(),
        Function::Sqrt => x.sqrt(),
        Function::Exp => x.exp(),
        Function::Log => x.ln(),
    }
}

/// Lanes without help from the instruction set.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub struct Eight([f64; 8]);

macro_rules! eight_operator {
    ($($trait:ident $method:ident $operator:tt),*) => {$(
        impl $trait for Eight {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for (a, b) in self.0.iter_mut().zip(other.0) {
                    *a $operator b;
                }
                self
            }
        }
    )*};
}
eight_operator!(Add add +=, Sub sub -=, Mul mul *=, Div div /=);

impl Neg for Eight {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        for a in &mut self.0 {
            *a = -*a;
        }
        self
    }
}

impl ErrorBounds for Eight {}

impl Lanes for Eight {
    const COUNT: usize = 8;

    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        Eight([value; 8])
    }
    #[inline(always)]
    fn load(mut self, from: &[f64]) -> Self {
        self.0.copy_from_slice(&from[..8]);
        self
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[..8].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn abs(mut self) -> Self {
        for a in &mut self.0 {
            *a = a.abs();
        }
        self
    }
    #[inline(always)]
    fn sqrt(mut self) -> Self {
        for a in &mut self.0 {
            *a = a.sqrt();
        }
        self
    }
    #[inline(always)]
    fn where_less(self, bound: Self, then: Self, mut otherwise: Self) -> Self {
        for i in 0..8 {
            otherwise.0[i] = if self.0[i] < bound.0[i] { then.0[i] } else { otherwise.0[i] };
        }
        otherwise
    }
    #[inline(always)]
    fn any_less(self, bound: Self) -> bool {
        let mut any = false;
        for i in 0..8 {
            any |= self.0[i] < bound.0[i];
        }
        any
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sine::sin_cos(self)
    }
    #[inline(always)]
    fn apply(mut self, function: Function) -> Self {
        for a in &mut self.0 {
            *a = evaluate(function, *a);
        }
        self
    }
}

impl ErrorBounds for f64 {}

impl Lanes for f64 {
    const COUNT: usize = 1;

    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn load(self, from: &[f64]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[0] = self;
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn where_less(self, bound: Self, then: Self, otherwise: Self) -> Self {
        if self < bound { then } else { otherwise }
    }
    #[inline(always)]
    fn any_less(self, bound: Self) -> bool {
        self < bound
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sine::sin_cos(self)
    }
    #[inline(always)]
    fn apply(self, function: Function) -> Self {
        evaluate(function, self)
    }
}
