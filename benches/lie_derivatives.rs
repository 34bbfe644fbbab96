//! What a repeated Lie derivative costs, by its order: building the graph, running its program, and the same value by
//! nested duals (which double with each order, and so end earlier).
//!
//! `cargo bench --bench lie_derivatives`

use divan::{Bencher, black_box};
use palmistry::System;
use palmistry::expression::{Program, Symbol};
use palmistry::number::Floats;
use palmistry::observability::{float_inputs, lie_derivative_by_duals};
use std::collections::HashMap;
use std::path::Path;

fn main() {
    divan::main();
}

fn same_rate() -> System {
    System::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002/same_rate.proof"))
        .expect("the file is read")
}

fn point(system: &System) -> HashMap<Symbol, f64> {
    let values = [
        ("r1", 1.5),
        ("r2", 1.5),
        ("omega0", 1.0),
        ("s1", 1.0),
        ("s2", 2.0),
        ("phi1", 0.5),
        ("phi2", 2.0),
        ("omega1", 2.5),
        ("g", -9.81),
    ];
    values.into_iter().map(|(name, value)| (system.find_symbol(name).expect("a known name"), value)).collect()
}

const ORDERS: std::ops::RangeInclusive<usize> = 1..=12;

/// All orders up to this one, from the file's expressions.
#[divan::bench(args = ORDERS, sample_count = 20)]
fn build_the_graph(bencher: Bencher, order: usize) {
    let system = same_rate();
    bencher.with_inputs(|| system.clone()).bench_local_values(|mut system| {
        let mut value = system.outputs[0].1;
        for _ in 0..order {
            value = system.lie_derivative(0, value);
        }
        black_box(value)
    });
}

/// One value of this order.
#[divan::bench(args = ORDERS, sample_count = 50)]
fn run_the_program(bencher: Bencher, order: usize) {
    let mut system = same_rate();
    let mut value = system.outputs[0].1;
    for _ in 0..order {
        value = system.lie_derivative(0, value);
    }
    let program = Program::plain(&system.graph, &[value]);
    let point = point(&system);
    let inputs = float_inputs(&program, |symbol| point[&symbol]);
    let loaded = program.load(Floats).expect("constants are finite");
    let mut registers = Vec::new();
    bencher.bench_local(|| loaded.run(black_box(&inputs), &mut registers));
}

/// The same value by num-dual.
#[divan::bench(args = 1..=8, sample_count = 10)]
fn nested_duals(bencher: Bencher, order: usize) {
    let system = same_rate();
    let point = point(&system);
    let word = vec![0; order];
    bencher.bench_local(|| lie_derivative_by_duals(&system, black_box(&word), system.outputs[0].1, &point));
}
