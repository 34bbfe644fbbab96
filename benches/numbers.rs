//! What an operation costs on each number type, and a whole program over each: the rows of the general
//! regime, at states with rational coordinates.
//!
//! `cargo bench --bench numbers`; the counter gives operations (for the rows: states) a second.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use palmistry::System;
use palmistry::expression::{Program, expand_angles};
use palmistry::number::{
    Arithmetic, DoubleDouble, Enclosures, Floats, Function, Interval, PrimeField, Rationals, RealNumber,
};
use palmistry::observability::{Branch, Locus, OWN_ROWS, State};
use palmistry::system::Value;
use std::collections::BTreeMap;
use std::path::Path;

fn main() {
    divan::main();
}

const MANY: usize = 1024;

/// A number that was computed, so that none of the short ways for round ones is taken; over intervals a little wide.
fn operands<T: RealNumber>(shift: f64) -> Vec<T> {
    let three = T::from_f64(3.0);
    (0..MANY).map(|i| T::from_f64(1.5 + ((i as f64 * 0.754877666 + shift) % 1.0) * 4.5) / three).collect()
}

fn each<T: RealNumber>(bencher: Bencher, operation: impl Fn(T, T) -> T) {
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
fn add<T: RealNumber>(bencher: Bencher) {
    each::<T>(bencher, |a, b| a + b);
}

#[divan::bench(types = [f32, f64, DoubleDouble, Interval])]
fn mul<T: RealNumber>(bencher: Bencher) {
    each::<T>(bencher, |a, b| a * b);
}

#[divan::bench(types = [f32, f64, DoubleDouble, Interval])]
fn div<T: RealNumber>(bencher: Bencher) {
    each::<T>(bencher, |a, b| a / b);
}

#[divan::bench(types = [f32, f64, DoubleDouble, Interval], args = [Function::Sin, Function::Sqrt, Function::Exp, Function::Atan])]
fn apply<T: RealNumber>(bencher: Bencher, function: Function) {
    each::<T>(bencher, |a, _| a.function(function).unwrap_or(a));
}

/// The rows as a program, and states.
fn rows() -> (Program, Vec<State>) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002/general.proof");
    let mut system = System::read(&file).expect("the file is read");
    let Some(Value::Matrix(rows)) = system.definition(OWN_ROWS) else { panic!("the file has rows") };
    let entries = rows.entries.clone();
    let is_angle = &system.angle_test();
    let roots = expand_angles(&mut system.graph, &entries, is_angle);
    let program = Program::new(&system.graph, &roots, is_angle);
    let locus =
        Locus::new(&mut system, &Branch::default(), &BTreeMap::new(), &entries).expect("a sample box");
    let states = (0..64).map(|index| locus.draw(1, index).expect("a state")).collect();
    (program, states)
}

fn run<A: Arithmetic>(bencher: Bencher, arithmetic: A) {
    let (program, states) = rows();
    let inputs: Vec<_> = states
        .iter()
        .map(|state| state.inputs(&program, &arithmetic).expect("every symbol has a value"))
        .collect();
    let loaded = program.load(arithmetic).expect("constants have images");
    let mut registers = Vec::new();
    bencher.counter(ItemsCount::new(inputs.len())).bench_local(|| {
        for inputs in &inputs {
            let _ = black_box(loaded.run(black_box(inputs), &mut registers));
        }
    });
}

#[divan::bench(types = [f32, f64, DoubleDouble, Interval])]
fn rows_over_machine_numbers<T: RealNumber>(bencher: Bencher) {
    run(bencher, Floats::<T>::new());
}

#[divan::bench]
fn rows_over_residues(bencher: Bencher) {
    run(bencher, PrimeField::new((1 << 61) + 15));
}

#[divan::bench]
fn rows_over_rationals(bencher: Bencher) {
    run(bencher, Rationals::default());
}

#[divan::bench(args = [53, 106, 212])]
fn rows_over_enclosures(bencher: Bencher, bits: usize) {
    run(bencher, Enclosures::new(bits));
}
