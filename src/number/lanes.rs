//! Doubles side by side: the same operation on eight states at once.
//!
//! [`Lanes`] is a number whose operations act on several values, or on one; what is written over it runs on vectors of
//! the processor, on a plain `f64`, or on any number that is given the trait. Every operation is rounded once, as IEEE
//! prescribes, and none is contracted or reassociated, so that the results do not depend on the width of the vectors.
//! [`Instructions::detect`] chooses at run time.

use super::Function;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number, or several numbers on which the same operations act.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// How many doubles are given to it and taken from it.
    const COUNT: usize;
    /// Whether an operation is a single instruction or two, so that code that is compiled for every combination of
    /// several operations pays.
    const SIMPLE: bool = false;

    /// The same exact value in every lane. (`self` only says what kind of number is wanted.)
    fn splat(self, value: f64) -> Self;
    /// The same value in every lane, whose error is so many times `2^-53`; most numbers have no use for that.
    #[inline(always)]
    fn splat_within(self, value: f64, _units: f64) -> Self {
        self.splat(value)
    }
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
    fn apart<T: Task>(self, task: T) -> T::Output {
        called(task)
    }

    /// Zero; not a number where bounds on errors are kept and the one on this value, that of a function of the standard
    /// library, is believed and not proved.
    #[inline(always)]
    fn believed(self) -> Self {
        self.splat(0.0)
    }

    /// Zero where the value is finite, else not a number.
    #[inline(always)]
    #[allow(clippy::eq_op)] // infinity less infinity is not a number
    fn lost(self) -> Self {
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
pub trait Task {
    type Output;
    fn call(self) -> Self::Output;
}

#[inline(never)]
fn called<T: Task>(task: T) -> T::Output {
    task.call()
}

/// Work that runs over any [`Lanes`]. Implementations have to be `#[inline(always)]`, all the way down, to be compiled
/// for the vectors of the processor; a closure in between may be compiled without them.
pub trait Vectorised {
    type Output;
    /// `lanes` is a value of the kind to be used.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Which instructions of the processor are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// What every processor has.
    Portable,
    /// Vectors of four doubles, on x86-64.
    Avx2,
}

impl Instructions {
    /// The best of what the processor at hand has.
    pub fn detect() -> Self {
        if cfg!(target_arch = "x86_64") && wide::available() {
            Instructions::Avx2
        } else {
            Instructions::Portable
        }
    }

    /// Runs some work with these instructions, or without them where the processor does not have them.
    pub fn run<W: Vectorised>(self, work: W) -> W::Output {
        match self {
            Instructions::Portable => work.run(Eight::default()),
            Instructions::Avx2 => wide::run(work),
        }
    }
}

/// A function of a double by the standard library; not a number outside its domain.
fn evaluate(function: Function, x: f64) -> f64 {
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
        super::sine::sin_cos(self)
    }
    #[inline(always)]
    fn apply(mut self, function: Function) -> Self {
        for a in &mut self.0 {
            *a = evaluate(function, *a);
        }
        self
    }
}

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
        super::sine::sin_cos(self)
    }
    #[inline(always)]
    fn apply(self, function: Function) -> Self {
        evaluate(function, self)
    }
}

#[cfg(target_arch = "x86_64")]
mod wide {
    use super::{Add, Div, Eight, Function, Lanes, Mul, Neg, Sub, Task, Vectorised, evaluate};
    use pulp::x86::V3;
    use pulp::{NullaryFnOnce, f64x4};

    pub(super) fn available() -> bool {
        V3::is_available()
    }

    pub(super) fn run<W: Vectorised>(work: W) -> W::Output {
        struct Here<W>(V3, W);
        impl<W: Vectorised> NullaryFnOnce for Here<W> {
            type Output = W::Output;
            #[inline(always)]
            fn call(self) -> W::Output {
                self.1.run(TwoFours { parts: [self.0.splat_f64x4(0.0); 2], simd: self.0 })
            }
        }
        match V3::try_new() {
            Some(simd) => simd.vectorize(Here(simd, work)),
            None => work.run(Eight::default()),
        }
    }

    struct Apart<T>(T);
    impl<T: Task> NullaryFnOnce for Apart<T> {
        type Output = T::Output;
        #[inline(always)]
        fn call(self) -> T::Output {
            self.0.call()
        }
    }

    /// Two vectors of four doubles.
    #[derive(Clone, Copy, Debug)]
    #[repr(align(64))]
    struct TwoFours {
        parts: [f64x4; 2],
        simd: V3,
    }

    impl TwoFours {
        #[inline(always)]
        fn with(self, low: f64x4, high: f64x4) -> Self {
            TwoFours { parts: [low, high], simd: self.simd }
        }
    }

    macro_rules! wide_operator {
        ($($trait:ident $method:ident $vector:ident),*) => {$(
            impl $trait for TwoFours {
                type Output = Self;
                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    let ([a, b], [c, d]) = (self.parts, other.parts);
                    self.with(self.simd.$vector(a, c), self.simd.$vector(b, d))
                }
            }
        )*};
    }
    wide_operator!(Add add add_f64x4, Sub sub sub_f64x4, Mul mul mul_f64x4, Div div div_f64x4);

    impl Neg for TwoFours {
        type Output = Self;
        #[inline(always)]
        fn neg(self) -> Self {
            let sign = self.simd.splat_f64x4(-0.0);
            let [a, b] = self.parts;
            self.with(self.simd.xor_f64x4(sign, a), self.simd.xor_f64x4(sign, b))
        }
    }

    #[inline(always)]
    fn four(from: &[f64]) -> f64x4 {
        f64x4(from[0], from[1], from[2], from[3])
    }

    impl Lanes for TwoFours {
        const COUNT: usize = 8;
        const SIMPLE: bool = true;

        #[inline(always)]
        fn splat(self, value: f64) -> Self {
            let all = self.simd.splat_f64x4(value);
            self.with(all, all)
        }
        #[inline(always)]
        fn load(self, from: &[f64]) -> Self {
            let from = &from[..8];
            self.with(four(&from[..4]), four(&from[4..]))
        }
        #[inline(always)]
        fn store(self, to: &mut [f64]) {
            let [f64x4(a, b, c, d), f64x4(e, f, g, h)] = self.parts;
            to[..8].copy_from_slice(&[a, b, c, d, e, f, g, h]);
        }
        #[inline(always)]
        fn abs(self) -> Self {
            let [a, b] = self.parts;
            self.with(self.simd.abs_f64x4(a), self.simd.abs_f64x4(b))
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            let [a, b] = self.parts;
            self.with(self.simd.sqrt_f64x4(a), self.simd.sqrt_f64x4(b))
        }
        #[inline(always)]
        fn where_less(self, bound: Self, then: Self, otherwise: Self) -> Self {
            let simd = self.simd;
            let low = simd.cmp_lt_f64x4(self.parts[0], bound.parts[0]);
            let high = simd.cmp_lt_f64x4(self.parts[1], bound.parts[1]);
            self.with(
                simd.select_f64x4(low, then.parts[0], otherwise.parts[0]),
                simd.select_f64x4(high, then.parts[1], otherwise.parts[1]),
            )
        }
        #[inline(always)]
        fn any_less(self, bound: Self) -> bool {
            let simd = self.simd;
            let [a, b] = self.parts;
            let low = simd.cmp_lt_f64x4(a, bound.parts[0]);
            let high = simd.cmp_lt_f64x4(b, bound.parts[1]);
            let either = simd.or_m64x4(low, high);
            simd.avx._mm256_movemask_pd(pulp::cast(either)) != 0
        }
        #[inline(always)]
        fn sin_cos(self) -> (Self, Self) {
            crate::number::sine::sin_cos(self)
        }
        fn apart<T: Task>(self, task: T) -> T::Output {
            self.simd.vectorize(Apart(task))
        }
        #[inline(always)]
        fn apply(self, function: Function) -> Self {
            let mut values = [0.0; 8];
            self.store(&mut values);
            for value in &mut values {
                *value = evaluate(function, *value);
            }
            self.load(&values)
        }
    }
}

#[cfg(not(target_arch = "x86_64"))]
mod wide {
    use super::{Eight, Vectorised};
    pub(super) fn available() -> bool {
        false
    }
    pub(super) fn run<W: Vectorised>(work: W) -> W::Output {
        work.run(Eight::default())
    }
}
