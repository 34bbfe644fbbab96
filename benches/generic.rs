//! What is seen at almost all states, as the unknowns grow: oscillators in a ring of which one is seen, `3 n` unknowns, and species
//! that are all seen with all that they do to each other, `n^2 + 2 n` unknowns.
//!
//! `cargo bench --bench generic`

use divan::{Bencher, black_box};
use palmistry::System;
use palmistry::observability::{Ceiling, generic_answer};
use std::collections::HashMap;
use std::fmt::Write;

fn main() {
    divan::main();
}

/// Each with its own unknown stiffness, coupled to both neighbours.
fn ring(size: usize) -> System {
    let (mut states, mut rates) = (Vec::new(), String::new());
    for i in 0..size {
        let (before, after) = ((i + size - 1) % size, (i + 1) % size);
        states.extend([format!("x{i}"), format!("v{i}"), format!("w{i}")]);
        let _ = writeln!(rates, "x{i}' = v{i}  v{i}' = -w{i}*x{i} + x{before} - 2*x{i} + x{after}");
    }
    let text = format!("system \"ring\" state {} drift f {rates} others' = 0 output x0", states.join(", "));
    text.parse().expect("a system")
}

fn lotka_volterra(size: usize) -> System {
    let (mut states, mut rates) = (Vec::new(), String::new());
    for i in 0..size {
        states.extend([format!("x{i}"), format!("r{i}")]);
        let _ = write!(rates, "x{i}' = x{i}*(r{i}");
        for j in 0..size {
            states.push(format!("a{i}_{j}"));
            let _ = write!(rates, " + a{i}_{j}*x{j}");
        }
        let _ = writeln!(rates, ")");
    }
    let outputs: Vec<String> = (0..size).map(|i| format!("x{i}")).collect();
    let text = format!(
        "system \"species\" state {} drift f {rates} others' = 0 output {}",
        states.join(", "),
        outputs.join(", ")
    );
    text.parse().expect("a system")
}

fn answer(bencher: Bencher, system: &System) {
    bencher.bench_local(|| {
        let answer = generic_answer(black_box(system), &HashMap::new(), Ceiling::Rests);
        assert_eq!(answer.rank(), Some(answer.dimension));
        answer
    });
}

#[divan::bench(args = [5, 8, 20, 33, 50, 100], sample_count = 5)]
fn ring_of_oscillators(bencher: Bencher, size: usize) {
    answer(bencher, &ring(size));
}

#[divan::bench(args = [3, 8, 16], sample_count = 5)]
fn all_species_seen(bencher: Bencher, size: usize) {
    answer(bencher, &lotka_volterra(size));
}
