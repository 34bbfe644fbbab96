//! What an operation costs on each rung of the ladder of numbers, and a whole program over each.
//!
//! `cargo bench --bench numbers`; the counter gives operations (states, in the last group) a second.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use palmistry::number::{DoubleDouble, Function, Interval, Real};

fn main() {
    divan::main();
}

const MANY: usize = 1024;

/// Operands between 0.5 and 2, none of them short.
fn operands<T: Real>(shift: f64) -> Vec<T> {
    (0..MANY).map(|i| T::from_f64(0.5 + ((i as f64 * 0.754877666 + shift) % 1.0) * 1.5)).collect()
}

fn each<T: Real>(bencher: Bencher, operation: impl Fn(T, T) -> T) {
    let (a, b) = (operands::<T>(0.1), operands::<T>(0.7));
    let mut out = a.clone();
    bencher.counter(ItemsCount::new(MANY)).bench_local(|| {
        for ((out, a), b) in out.iter_mut().zip(black_box(&a)).zip(black_box(&b)) {
            *out = operation(*a, *b);
        }
        black_box(&mut out);
    });
}

#[divan::bench(types = [f32, f64, DoubleDouble, Interval])]
fn add<T: Real>(bencher: Bencher) {
    each::<T>(bencher, |a, b| a + b);
}

#[divan::bench(types = [f32, f64, DoubleDouble, Interval])]
fn mul<T: Real>(bencher: Bencher) {
    each::<T>(bencher, |a, b| a * b);
}

#[divan::bench(types = [f32, f64, DoubleDouble, Interval])]
fn div<T: Real>(bencher: Bencher) {
    each::<T>(bencher, |a, b| a / b);
}

#[divan::bench(types = [f32, f64, DoubleDouble, Interval])]
fn sin<T: Real>(bencher: Bencher) {
    each::<T>(bencher, |a, _| a.function(Function::Sin).unwrap_or(a));
}

#[divan::bench(types = [f32, f64, DoubleDouble, Interval])]
fn exp<T: Real>(bencher: Bencher) {
    each::<T>(bencher, |a, _| a.function(Function::Exp).unwrap_or(a));
}

#[divan::bench(types = [f32, f64, DoubleDouble, Interval])]
fn atan<T: Real>(bencher: Bencher) {
    each::<T>(bencher, |a, _| a.function(Function::Atan).unwrap_or(a));
}

#[divan::bench(types = [f32, f64, DoubleDouble, Interval])]
fn sqrt<T: Real>(bencher: Bencher) {
    each::<T>(bencher, |a, _| a.function(Function::Sqrt).unwrap_or(a));
}
