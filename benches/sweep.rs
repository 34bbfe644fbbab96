//! What the sweep costs: the matrix of a state and its verdict (the counter gives states a second), the preparation of a
//! model, and a hundred thousand verdicts with everything included, on one thread and on two.
//!
//! `cargo bench --bench sweep`

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use palmistry::System;
use palmistry::expression::{BlockProgram, Input, NodeId, expand_angles};
use palmistry::number::{Instructions, rational_to_f64};
use palmistry::observability::{Branch, Locus, OWN_ROWS, solve_conditions};
use palmistry::sweep::{Certainty, Stream, StreamOptions, StreamReport};
use palmistry::system::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn main() {
    divan::main();
}

const REGIMES: [&str; 4] = ["general", "same_rate", "one_palm_fixed", "fixed_palms"];
/// As many as fit into the second-level cache with their matrices.
const BLOCK: usize = 512;

fn file(regime: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002").join(regime).with_extension("proof")
}

fn read(regime: &str) -> System {
    System::read(&file(regime)).expect("the file is read")
}

fn own_rows(system: &System) -> Vec<NodeId> {
    match system.definition(OWN_ROWS) {
        Some(Value::Matrix(matrix)) => matrix.entries.clone(),
        _ => panic!("{} does not define its rows", system.name),
    }
}

fn stream(system: &mut System) -> Stream {
    let rows = own_rows(system);
    let branch: Branch = solve_conditions(system, &[]).expect("there are none").remove(0);
    let locus = Locus::new(system, &branch, &BTreeMap::new(), &rows).expect("the box is given");
    Stream::new(system, &locus, &rows).expect("angles are angles")
}

fn verdicts(stream: &Stream, states: u64) -> StreamReport {
    let options = StreamOptions {
        states,
        seed: 1,
        wanted: Certainty::Computed,
        interrupt: &false.into(),
        progress: &|_| (),
    };
    stream
        .run(&options, &mut |left| assert!(left.is_empty(), "all states of the box are decided"))
        .expect("states")
}

/// All rows at given states, angles in radians, their sines and cosines included.
#[divan::bench(args = REGIMES, consts = [false, true], sample_count = 200)]
fn matrix<const WIDE: bool>(bencher: Bencher, regime: &str) {
    let mut system = read(regime);
    let is_angle = &system.angle_test();
    let rows = own_rows(&system);
    let rows = expand_angles(&mut system.graph, &rows, is_angle);
    let value = |symbol| {
        system.symbol_info(symbol).and_then(|info| info.default.clone().filter(|_| info.range.is_none()))
    };
    let known = |input: Input| match input {
        Input::Plain(symbol) => value(symbol),
        _ => None,
    };
    let program = BlockProgram::new(&system.graph, &rows, &[], |_| false, known);
    let columns: Vec<Vec<f64>> = program
        .inputs()
        .iter()
        .map(|input| {
            let Input::Plain(symbol) = input else { panic!("angles are given in radians") };
            let range = system.symbol_info(*symbol).and_then(|info| info.range.clone()).expect("a range");
            let (low, high) = (rational_to_f64(&range.low), rational_to_f64(&range.high));
            (0..BLOCK).map(|i| low + (high - low) * (i as f64 * 0.618_033_988_749_895).fract()).collect()
        })
        .collect();
    let inputs: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let mut matrices = vec![vec![0.0; BLOCK]; program.outputs()];
    let mut outputs: Vec<&mut [f64]> = matrices.iter_mut().map(Vec::as_mut_slice).collect();
    let instructions = if WIDE { Instructions::detect() } else { Instructions::Portable };
    bencher
        .counter(ItemsCount::new(BLOCK))
        .bench_local(|| program.evaluate_with(instructions, black_box(&inputs), &mut outputs));
}

/// Drawing, matrix, error bounds, equilibration, singular values and certificate, on one thread.
#[divan::bench(args = REGIMES, consts = [false, true], sample_count = 20)]
fn verdict<const WIDE: bool>(bencher: Bencher, regime: &str) {
    const STATES: u64 = 1 << 14;
    let instructions = if WIDE { Instructions::detect() } else { Instructions::Portable };
    let stream = stream(&mut read(regime)).with(instructions);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    bencher
        .counter(ItemsCount::new(STATES))
        .bench_local(|| pool.install(|| verdicts(&stream, black_box(STATES))));
}

/// From a system that is read to a model that is ready.
#[divan::bench(args = REGIMES, sample_count = 50)]
fn preparation(bencher: Bencher, regime: &str) {
    let system = read(regime);
    bencher.with_inputs(|| system.clone()).bench_local_values(|mut system| stream(&mut system));
}

/// A hundred thousand verdicts from the text on the disk, on so many threads.
#[divan::bench(args = [1, 2], consts = [0, 1], sample_count = 20)]
fn everything<const REGIME: usize>(bencher: Bencher, threads: usize) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("some threads");
    bencher
        .counter(ItemsCount::new(100_000u64))
        .bench_local(|| pool.install(|| verdicts(&stream(&mut read(black_box(REGIMES[REGIME]))), 100_000)));
}
