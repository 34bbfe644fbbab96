//! Lanes in the vector registers of x86-64.

use super::portable::evaluate;
use crate::number::lanes::{ErrorBounds, LaneTask, Lanes, MOST_LANES, Vectorised};
use crate::number::{Function, sine};
use pulp::x86::{V3, V4};
use pulp::{NullaryFnOnce, cast};
use std::arch::x86_64::{__m256d, __m512d, _CMP_LT_OQ};
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The proof that the processor has some instructions, and what they do to one register.
pub(super) trait Registers: Copy + Debug {
    /// Doubles side by side.
    type Register: Copy + Debug;
    /// One mark for each of them.
    type Mask: Copy;
    /// So many.
    const WIDTH: usize;

    fn splat(self, value: f64) -> Self::Register;
    fn load(self, from: &[f64]) -> Self::Register;
    fn store(self, a: Self::Register, to: &mut [f64]);
    fn add(self, a: Self::Register, b: Self::Register) -> Self::Register;
    fn sub(self, a: Self::Register, b: Self::Register) -> Self::Register;
    fn mul(self, a: Self::Register, b: Self::Register) -> Self::Register;
    fn div(self, a: Self::Register, b: Self::Register) -> Self::Register;
    fn neg(self, a: Self::Register) -> Self::Register;
    fn abs(self, a: Self::Register) -> Self::Register;
    fn sqrt(self, a: Self::Register) -> Self::Register;
    /// The larger and the smaller one, and `b` where one of them is not a number.
    fn max(self, a: Self::Register, b: Self::Register) -> Self::Register;
    fn min(self, a: Self::Register, b: Self::Register) -> Self::Register;
    /// Where `a < b`; nowhere where one of them is not a number.
    fn less(self, a: Self::Register, b: Self::Register) -> Self::Mask;
    fn select(self, mask: Self::Mask, then: Self::Register, otherwise: Self::Register) -> Self::Register;
    fn any(self, mask: Self::Mask) -> bool;
    /// Runs work in a function that is compiled for these instructions.
    fn vectorize<W: NullaryFnOnce>(self, work: W) -> W::Output;
}

/// Registers of four doubles: AVX2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Four(V3);

impl Four {
    pub fn new() -> Option<Self> {
        V3::try_new().map(Four)
    }
}

impl Registers for Four {
    type Register = __m256d;
    type Mask = __m256d;
    const WIDTH: usize = 4;

    #[inline(always)]
    fn splat(self, value: f64) -> __m256d {
        self.0.avx._mm256_set1_pd(value)
    }
    #[inline(always)]
    fn load(self, from: &[f64]) -> __m256d {
        cast([from[0], from[1], from[2], from[3]])
    }
    #[inline(always)]
    fn store(self, a: __m256d, to: &mut [f64]) {
        to[..4].copy_from_slice(&cast::<__m256d, [f64; 4]>(a));
    }
    #[inline(always)]
    fn add(self, a: __m256d, b: __m256d) -> __m256d {
        self.0.avx._mm256_add_pd(a, b)
    }
    #[inline(always)]
    fn sub(self, a: __m256d, b: __m256d) -> __m256d {
        self.0.avx._mm256_sub_pd(a, b)
    }
    #[inline(always)]
    fn mul(self, a: __m256d, b: __m256d) -> __m256d {
        self.0.avx._mm256_mul_pd(a, b)
    }
    #[inline(always)]
    fn div(self, a: __m256d, b: __m256d) -> __m256d {
        self.0.avx._mm256_div_pd(a, b)
    }
    #[inline(always)]
    fn neg(self, a: __m256d) -> __m256d {
        self.0.avx._mm256_xor_pd(a, self.splat(-0.0))
    }
    #[inline(always)]
    fn abs(self, a: __m256d) -> __m256d {
        self.0.avx._mm256_andnot_pd(self.splat(-0.0), a)
    }
    #[inline(always)]
    fn sqrt(self, a: __m256d) -> __m256d {
        self.0.avx._mm256_sqrt_pd(a)
    }
    #[inline(always)]
    fn max(self, a: __m256d, b: __m256d) -> __m256d {
        self.0.avx._mm256_max_pd(a, b)
    }
    #[inline(always)]
    fn min(self, a: __m256d, b: __m256d) -> __m256d {
        self.0.avx._mm256_min_pd(a, b)
    }
    #[inline(always)]
    fn less(self, a: __m256d, b: __m256d) -> __m256d {
        self.0.avx._mm256_cmp_pd::<_CMP_LT_OQ>(a, b)
    }
    #[inline(always)]
    fn select(self, mask: __m256d, then: __m256d, otherwise: __m256d) -> __m256d {
        self.0.avx._mm256_blendv_pd(otherwise, then, mask)
    }
    #[inline(always)]
    fn any(self, mask: __m256d) -> bool {
        self.0.avx._mm256_movemask_pd(mask) != 0
    }
    #[inline(always)]
    fn vectorize<W: NullaryFnOnce>(self, work: W) -> W::Output {
        self.0.vectorize(work)
    }
}

/// Registers of eight doubles: AVX-512.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eight(V4);

impl Eight {
    pub fn new() -> Option<Self> {
        V4::try_new().map(Eight)
    }
}

impl Registers for Eight {
    type Register = __m512d;
    type Mask = u8;
    const WIDTH: usize = 8;

    #[inline(always)]
    fn splat(self, value: f64) -> __m512d {
        self.0.avx512f._mm512_set1_pd(value)
    }
    #[inline(always)]
    fn load(self, from: &[f64]) -> __m512d {
        let from = &from[..8];
        cast([from[0], from[1], from[2], from[3], from[4], from[5], from[6], from[7]])
    }
    #[inline(always)]
    fn store(self, a: __m512d, to: &mut [f64]) {
        to[..8].copy_from_slice(&cast::<__m512d, [f64; 8]>(a));
    }
    #[inline(always)]
    fn add(self, a: __m512d, b: __m512d) -> __m512d {
        self.0.avx512f._mm512_add_pd(a, b)
    }
    #[inline(always)]
    fn sub(self, a: __m512d, b: __m512d) -> __m512d {
        self.0.avx512f._mm512_sub_pd(a, b)
    }
    #[inline(always)]
    fn mul(self, a: __m512d, b: __m512d) -> __m512d {
        self.0.avx512f._mm512_mul_pd(a, b)
    }
    #[inline(always)]
    fn div(self, a: __m512d, b: __m512d) -> __m512d {
        self.0.avx512f._mm512_div_pd(a, b)
    }
    #[inline(always)]
    fn neg(self, a: __m512d) -> __m512d {
        self.0.avx512dq._mm512_xor_pd(a, self.splat(-0.0))
    }
    #[inline(always)]
    fn abs(self, a: __m512d) -> __m512d {
        self.0.avx512f._mm512_abs_pd(a)
    }
    #[inline(always)]
    fn sqrt(self, a: __m512d) -> __m512d {
        self.0.avx512f._mm512_sqrt_pd(a)
    }
    #[inline(always)]
    fn max(self, a: __m512d, b: __m512d) -> __m512d {
        self.0.avx512f._mm512_max_pd(a, b)
    }
    #[inline(always)]
    fn min(self, a: __m512d, b: __m512d) -> __m512d {
        self.0.avx512f._mm512_min_pd(a, b)
    }
    #[inline(always)]
    fn less(self, a: __m512d, b: __m512d) -> u8 {
        self.0.avx512f._mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b)
    }
    #[inline(always)]
    fn select(self, mask: u8, then: __m512d, otherwise: __m512d) -> __m512d {
        self.0.avx512f._mm512_mask_blend_pd(mask, otherwise, then)
    }
    #[inline(always)]
    fn any(self, mask: u8) -> bool {
        mask != 0
    }
    #[inline(always)]
    fn vectorize<W: NullaryFnOnce>(self, work: W) -> W::Output {
        self.0.vectorize(work)
    }
}

/// Runs some work in the registers.
pub(super) fn run<R: Registers, W: Vectorised>(registers: R, work: W) -> W::Output {
    struct Here<R, W>(R, W);
    impl<R: Registers, W: Vectorised> NullaryFnOnce for Here<R, W> {
        type Output = W::Output;
        #[inline(always)]
        fn call(self) -> W::Output {
            self.1.run(Two { parts: [self.0.splat(0.0); 2], registers: self.0 })
        }
    }
    registers.vectorize(Here(registers, work))
}

struct Apart<T>(T);
impl<T: LaneTask> NullaryFnOnce for Apart<T> {
    type Output = T::Output;
    #[inline(always)]
    fn call(self) -> T::Output {
        self.0.call()
    }
}

/// Two registers, so that the processor has something to do while one of them waits.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Two<R: Registers> {
    parts: [R::Register; 2],
    registers: R,
}

impl<R: Registers> Two<R> {
    #[inline(always)]
    fn with(self, low: R::Register, high: R::Register) -> Self {
        Two { parts: [low, high], registers: self.registers }
    }
}

macro_rules! operator {
    ($($trait:ident $method:ident),*) => {$(
        impl<R: Registers> $trait for Two<R> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let ([a, b], [c, d]) = (self.parts, other.parts);
                self.with(self.registers.$method(a, c), self.registers.$method(b, d))
            }
        }
    )*};
}
operator!(Add add, Sub sub, Mul mul, Div div);

impl<R: Registers> Neg for Two<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let [a, b] = self.parts;
        self.with(self.registers.neg(a), self.registers.neg(b))
    }
}

impl<R: Registers> ErrorBounds for Two<R> {}

impl<R: Registers> Lanes for Two<R> {
    const COUNT: usize = 2 * R::WIDTH;
    const SIMPLE: bool = true;

    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        let all = self.registers.splat(value);
        self.with(all, all)
    }
    #[inline(always)]
    fn load(self, from: &[f64]) -> Self {
        let from = &from[..Self::COUNT];
        self.with(self.registers.load(&from[..R::WIDTH]), self.registers.load(&from[R::WIDTH..]))
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let to = &mut to[..Self::COUNT];
        let [a, b] = self.parts;
        self.registers.store(a, &mut to[..R::WIDTH]);
        self.registers.store(b, &mut to[R::WIDTH..]);
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let [a, b] = self.parts;
        self.with(self.registers.abs(a), self.registers.abs(b))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let [a, b] = self.parts;
        self.with(self.registers.sqrt(a), self.registers.sqrt(b))
    }
    #[inline(always)]
    fn where_less(self, bound: Self, then: Self, otherwise: Self) -> Self {
        let ([a, b], [c, d], registers) = (self.parts, bound.parts, self.registers);
        self.with(
            registers.select(registers.less(a, c), then.parts[0], otherwise.parts[0]),
            registers.select(registers.less(b, d), then.parts[1], otherwise.parts[1]),
        )
    }
    #[inline(always)]
    fn any_less(self, bound: Self) -> bool {
        let ([a, b], [c, d], registers) = (self.parts, bound.parts, self.registers);
        registers.any(registers.less(a, c)) | registers.any(registers.less(b, d))
    }
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.parts, other.parts);
        self.with(self.registers.max(a, c), self.registers.max(b, d))
    }
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.parts, other.parts);
        self.with(self.registers.min(a, c), self.registers.min(b, d))
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sine::sin_cos(self)
    }
    fn apart<T: LaneTask>(self, task: T) -> T::Output {
        self.registers.vectorize(Apart(task))
    }
    #[inline(always)]
    fn apply(self, function: Function) -> Self {
        let mut values = [0.0; MOST_LANES];
        self.store(&mut values);
        for value in &mut values[..Self::COUNT] {
            *value = evaluate(function, *value);
        }
        self.load(&values)
    }
}
