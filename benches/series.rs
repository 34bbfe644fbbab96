//! What a repeated Lie derivative of the ten-state regime costs, `L_g1^k s1` and its gradient, by the order `k` and by
//! the way: repeated derivation of the graph, Taylor series, nested duals. Preparation and run apart.
//!
//! `cargo bench --bench series`

use divan::{Bencher, black_box};
use palmistry::System;
use palmistry::expression::{BlockProgram, Derivation, Input, NodeId, Program, Symbol, gradient};
use palmistry::number::Floats;
use palmistry::observability::{
    Branch, Coordinate, Flow, Locus, differential_by_duals, float_inputs, lie_derivative_by_duals,
    lie_derivative_by_series,
};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

fn main() {
    divan::main();
}

const ORDERS: [usize; 5] = [1, 2, 4, 6, 8];

fn general() -> (System, usize, NodeId) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002/general.proof");
    let system = System::read(&file).expect("the file is read");
    let field = system.fields.iter().position(|field| field.name == "g1").expect("it has a field g1");
    let output = system.outputs.iter().find(|(name, _)| name == "s1").expect("it has an output s1").1;
    (system, field, output)
}

const STATES: u64 = 1000;

/// The first state that the sample box gives.
fn point(system: &mut System) -> HashMap<Symbol, f64> {
    points(system, 1).remove(0)
}

/// States of the sample box.
fn points(system: &mut System, count: u64) -> Vec<HashMap<Symbol, f64>> {
    let everything: Vec<NodeId> =
        system.fields.iter().flat_map(|field| field.components.iter().map(|(_, node)| *node)).collect();
    let locus = Locus::new(system, &Branch::default(), &BTreeMap::new(), &everything).expect("it has ranges");
    let state = |index| locus.draw(1, index).expect("the box is not empty").values;
    let number = |(symbol, value): (Symbol, Coordinate)| (symbol, value.to_f64());
    (0..count).map(|index| state(index).into_iter().map(number).collect()).collect()
}

fn value_of(input: &Input, state: &HashMap<Symbol, f64>) -> f64 {
    match input {
        Input::Plain(symbol) => state[symbol],
        Input::Sine(symbol) => state[symbol].sin(),
        Input::Cosine(symbol) => state[symbol].cos(),
        Input::Opaque(_) => f64::NAN,
    }
}

fn by_derivation(system: &mut System, field: usize, h: NodeId, order: usize) -> NodeId {
    (0..order).fold(h, |value, _| system.lie_derivative(field, value))
}

fn by_series(system: &mut System, field: usize, h: NodeId, order: usize) -> NodeId {
    lie_derivative_by_series(system, &vec![field; order], h).expect("no constant zero is divided by")
}

fn one_by_one(system: &mut System, value: NodeId) -> Vec<NodeId> {
    let graph = &mut system.graph;
    system.states.iter().map(|state| Derivation::partial(graph, *state).apply(graph, value)).collect()
}

fn at_once(system: &mut System, value: NodeId) -> Vec<NodeId> {
    gradient(&mut system.graph, value, &system.states)
}

/// Builds an expression and its program, from the system as it was read.
fn prepared(bencher: Bencher, build: impl Fn(&mut System, usize, NodeId) -> Vec<NodeId>) {
    let (system, field, h) = general();
    bencher.with_inputs(|| system.clone()).bench_local_values(|mut system| {
        let roots = build(&mut system, field, h);
        let program = Program::plain(&system.graph, &roots);
        (program, system)
    });
}

/// Runs the program at one state in doubles.
fn run(bencher: Bencher, build: impl Fn(&mut System, usize, NodeId) -> Vec<NodeId>) {
    let (mut system, field, h) = general();
    let point = point(&mut system);
    let roots = build(&mut system, field, h);
    let program = Program::plain(&system.graph, &roots);
    let inputs = float_inputs(&program, |symbol| point[&symbol]);
    let loaded = program.load(Floats::default()).expect("constants are finite");
    let mut registers = Vec::new();
    bencher
        .counter(divan::counter::ItemsCount::new(program.len()))
        .bench_local(|| loaded.run(black_box(&inputs), &mut registers));
}

mod prepare {
    use super::*;

    #[divan::bench(args = ORDERS)]
    fn value_by_derivation(bencher: Bencher, order: usize) {
        prepared(bencher, |system, field, h| vec![by_derivation(system, field, h, order)]);
    }

    #[divan::bench(args = ORDERS)]
    fn value_by_series(bencher: Bencher, order: usize) {
        prepared(bencher, |system, field, h| vec![by_series(system, field, h, order)]);
    }

    #[divan::bench(args = ORDERS)]
    fn gradient_by_derivation(bencher: Bencher, order: usize) {
        prepared(bencher, |system, field, h| {
            let value = by_derivation(system, field, h, order);
            one_by_one(system, value)
        });
    }

    /// The file read, series, gradient, and the block program: everything before the first state.
    #[divan::bench(args = ORDERS)]
    fn everything_for_a_gradient_in_blocks(bencher: Bencher, order: usize) {
        bencher.bench_local(|| {
            let (mut system, field, h) = general();
            let value = by_series(&mut system, field, h, order);
            let roots = at_once(&mut system, value);
            BlockProgram::new(&system.graph, &roots, &[], |symbol| system.is_angle(symbol), |_| None)
        });
    }

    #[divan::bench(args = ORDERS)]
    fn gradient_by_series_and_reverse_mode(bencher: Bencher, order: usize) {
        prepared(bencher, |system, field, h| {
            let value = by_series(system, field, h, order);
            at_once(system, value)
        });
    }
}

/// The counter gives operations a second.
mod value {
    use super::*;

    #[divan::bench(args = ORDERS)]
    fn by_the_derived_graph(bencher: Bencher, order: usize) {
        run(bencher, |system, field, h| vec![by_derivation(system, field, h, order)]);
    }

    #[divan::bench(args = ORDERS)]
    fn by_the_graph_of_the_series(bencher: Bencher, order: usize) {
        run(bencher, |system, field, h| vec![by_series(system, field, h, order)]);
    }

    /// No graph is built: series of doubles.
    #[divan::bench(args = ORDERS)]
    fn by_series_of_doubles(bencher: Bencher, order: usize) {
        let (mut system, field, h) = general();
        let point = point(&mut system);
        let flow = Flow::new(&system.graph, &system.fields[field].components, &[h], |_| false);
        let inputs: Vec<f64> = flow.inputs().iter().map(|input| value_of(input, &point)).collect();
        bencher.bench_local(|| flow.lie_derivatives(&Floats::default(), black_box(&inputs), order));
    }

    #[divan::bench(args = ORDERS)]
    fn by_nested_duals(bencher: Bencher, order: usize) {
        let (mut system, field, h) = general();
        let point = point(&mut system);
        let word = vec![field; order];
        bencher.bench_local(|| lie_derivative_by_duals(&system, black_box(&word), h, &point));
    }
}

/// The counter gives operations a second.
mod gradients {
    use super::*;

    #[divan::bench(args = ORDERS)]
    fn of_the_derived_graph_one_by_one(bencher: Bencher, order: usize) {
        run(bencher, |system, field, h| {
            let value = by_derivation(system, field, h, order);
            one_by_one(system, value)
        });
    }

    #[divan::bench(args = ORDERS)]
    fn of_the_derived_graph_by_reverse_mode(bencher: Bencher, order: usize) {
        run(bencher, |system, field, h| {
            let value = by_derivation(system, field, h, order);
            at_once(system, value)
        });
    }

    #[divan::bench(args = ORDERS)]
    fn of_the_series_by_reverse_mode(bencher: Bencher, order: usize) {
        run(bencher, |system, field, h| {
            let value = by_series(system, field, h, order);
            at_once(system, value)
        });
    }

    /// A block program at a thousand states; the counter gives states a second.
    #[divan::bench(args = ORDERS)]
    fn of_the_series_in_blocks(bencher: Bencher, order: usize) {
        let (mut system, field, h) = general();
        let value = by_series(&mut system, field, h, order);
        let roots = at_once(&mut system, value);
        let program =
            BlockProgram::new(&system.graph, &roots, &[], |symbol| system.is_angle(symbol), |_| None);
        let states = points(&mut system, STATES);
        let inputs: Vec<Vec<f64>> = program
            .inputs()
            .iter()
            .map(|input| states.iter().map(|state| value_of(input, state)).collect())
            .collect();
        let inputs: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
        let mut results = vec![vec![0.0; states.len()]; roots.len()];
        let mut outputs: Vec<&mut [f64]> = results.iter_mut().map(Vec::as_mut_slice).collect();
        bencher
            .counter(divan::counter::ItemsCount::new(states.len()))
            .bench_local(|| program.evaluate(black_box(&inputs), &mut outputs));
    }

    #[divan::bench(args = [1, 2, 4, 6], sample_count = 20)]
    fn by_nested_duals(bencher: Bencher, order: usize) {
        let (mut system, field, h) = general();
        let point = point(&mut system);
        let word = vec![field; order];
        bencher.bench_local(|| differential_by_duals(&system, black_box(&word), h, &point));
    }
}
