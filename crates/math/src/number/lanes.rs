//! Doubles side by side: the same operation on several states at once.
//!
//! [`Lanes`] is a number whose operations act on several values, or on one; what is written over it runs on vectors of
//! the processor, on a plain `f64`, or on any number that is given the trait. Every operation is rounded once, as IEEE
//! prescribes, and none is contracted or reassociated, so that the results do not depend on the width of the vectors.
//! [`Instructions::detect`](super::Instructions::detect) chooses at run time.

use super::Function;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// No lanes hold more doubles than this.
pub const MOST_LANES: usize = 16;

/// Bounds on errors that code over any numbers gives to those numbers that keep them; most ignore them.
pub trait ErrorBounds: Copy {
    /// The same value, whose error is at most so many times `2^-53`.
    #[inline(always)]
    fn within(self, _units: f64) -> Self {
        self
    }

    /// The same value, of whose error no bound is proved.
    #[inline(always)]
    fn without_bound(self) -> Self {
        self
    }
}

/// A number, or several numbers on which the same operations act.
pub trait Lanes:
    ErrorBounds
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// How many doubles are given to it and taken from it.
    const COUNT: usize;
    /// Whether an operation is a single instruction or two, so that code that is compiled for every combination of
    /// several operations pays.
    const SIMPLE: bool = false;

    /// The same exact value in every lane. (`self` only says what kind of number is wanted.)
    fn splat(self, value: f64) -> Self;
    /// The first values of a slice, as many as there are lanes.
    fn load(self, from: &[f64]) -> Self;
    /// Writes the values to the start of a slice.
    fn store(self, to: &mut [f64]);
    /// The magnitude.
    fn abs(self) -> Self;
    /// The square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// `then` where `self < bound`, else (and where one of them is not a number) `otherwise`.
    fn where_less(self, bound: Self, then: Self, otherwise: Self) -> Self;
    /// Whether `self < bound` in any lane.
    fn any_less(self, bound: Self) -> bool;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
    /// Any function, lane by lane, by the standard library.
    fn apply(self, function: Function) -> Self;

    /// Does some work in a function of its own that is compiled for these lanes, so that it is compiled once for them
    /// and not wherever it is called.
    fn apart<T: LaneTask>(self, task: T) -> T::Output {
        called(task)
    }

    /// Zero where the value is finite, else not a number.
    #[inline(always)]
    #[allow(clippy::eq_op)] // infinity less infinity is not a number
    fn zero_if_finite(self) -> Self {
        self - self
    }

    /// The larger one; `other` where one of them is not a number.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        other.where_less(self, self, other)
    }
    /// The smaller one; `other` where one of them is not a number.
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.where_less(other, self, other)
    }
}

/// A piece of work; the method has to be `#[inline(always)]`, all the way down, like that of [`Vectorised`].
pub trait LaneTask {
    /// Its result.
    type Output;
    /// Does it.
    fn call(self) -> Self::Output;
}

#[inline(never)]
fn called<T: LaneTask>(task: T) -> T::Output {
    task.call()
}

/// Work that runs over any [`Lanes`]. Implementations have to be `#[inline(always)]`, all the way down, to be compiled
/// for the vectors of the processor; a closure in between may be compiled without them.
pub trait Vectorised {
    /// Its result.
    type Output;
    /// `lanes` is a value of the kind to be used.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}
