//! Block programs against exact arithmetic, against the scalar program, and against themselves on other processors.

use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry::System;
use palmistry::expression::{BlockProgram, Graph, Input, NodeId, Program, expand_angles};
use palmistry::number::{
    Arithmetic, Bounded, Floats, Instructions, Interval, Rationals, rational_from_f64, rational_to_f64,
};
use palmistry::system::Value;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn unknown(_: Input) -> Option<RBig> {
    None
}

/// The values and the bounds on their errors, one state at a time.
fn bounded(program: &BlockProgram, inputs: &[f64]) -> (Vec<Bounded<f64>>, Bounded<f64>) {
    let mut machine = program.machine(Bounded::exact(0.0));
    for (place, value) in inputs.iter().enumerate() {
        if let Some(room) = machine.input(place) {
            room.fill(Bounded::exact(*value));
        }
    }
    machine.run();
    ((0..program.outputs()).map(|place| machine.output(place, 0)).collect(), machine.health(0))
}

/// Holds a block program against exact arithmetic at the same inputs: every value has to lie within its own bound.
/// Returns how many values were compared and the greatest bound relative to a value.
fn hold_against_rationals(
    graph: &Graph,
    roots: &[NodeId],
    block: &BlockProgram,
    inputs: &[f64],
) -> (usize, f64) {
    let exact = Rationals::default();
    let scalar = Program::plain(graph, roots);
    let place = |input: &Input| block.inputs().iter().position(|other| other == input);
    let given: Vec<RBig> = scalar
        .inputs()
        .iter()
        .map(|input| place(input).map_or(RBig::ONE, |i| rational_from_f64(inputs[i]).unwrap()))
        .collect();
    let Ok(values) = scalar.load(exact).unwrap().run(&given, &mut Vec::new()) else { return (0, 0.0) };
    let (found, health) = bounded(block, inputs);
    let (mut compared, mut widest) = (0, 0.0f64);
    for (value, found) in values.iter().zip(found) {
        let error = found.error();
        if !found.value.is_finite() || !error.is_finite() || health.value != 0.0 {
            continue;
        }
        let difference = exact.sub(value, &rational_from_f64(found.value).unwrap()).unwrap();
        let bound = rational_from_f64(error).unwrap();
        assert!(
            difference <= bound && -difference.clone() <= bound,
            "{} instead of {} within {error}",
            found.value,
            rational_to_f64(value)
        );
        compared += 1;
        if found.value != 0.0 {
            widest = widest.max(error / found.value.abs());
        }
    }
    (compared, widest)
}

/// A random graph of all operations that rationals know.
fn random_graph(rng: &mut ChaCha8Rng, operations: usize) -> (Graph, Vec<NodeId>) {
    let mut graph = Graph::default();
    let mut nodes: Vec<NodeId> = Vec::new();
    for name in ["x", "y", "z"] {
        let symbol = graph.intern(name);
        nodes.push(graph.symbol(symbol));
    }
    for _ in 0..3 {
        let (top, bottom) = (rng.random_range(-9..=9i64), rng.random_range(1..=7i64));
        nodes.push(graph.rational(RBig::from(top) / RBig::from(bottom)));
    }
    for _ in 0..operations {
        let a = nodes[rng.random_range(0..nodes.len())];
        let b = nodes[rng.random_range(nodes.len().saturating_sub(8)..nodes.len())];
        let node = match rng.random_range(0..10) {
            0..3 => graph.add(a, b),
            3..5 => graph.sub(a, b),
            5..8 => graph.mul(a, b),
            8 => graph.div(a, b),
            _ => graph.power(b, rng.random_range(-2..=3)),
        };
        nodes.push(node);
    }
    let roots = nodes.split_off(nodes.len() - 5);
    (graph, roots)
}

#[test]
fn every_value_of_a_random_expression_lies_within_its_bound() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut compared = 0;
    for _ in 0..400 {
        let operations = rng.random_range(5..40);
        let (graph, roots) = random_graph(&mut rng, operations);
        let block = BlockProgram::new(&graph, &roots, &[], |_| false, unknown);
        for _ in 0..4 {
            let inputs: Vec<f64> = block.inputs().iter().map(|_| rng.random_range(-3.0..3.0)).collect();
            compared += hold_against_rationals(&graph, &roots, &block, &inputs).0;
        }
    }
    assert!(compared > 4000, "only {compared} values were compared");
}

fn regime(name: &str) -> (System, Vec<NodeId>) {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002").join(name);
    let mut system = System::read(&file).unwrap();
    let Some(Value::Matrix(rows)) = system.definition("rows").cloned() else { panic!("no rows") };
    let is_angle = &system.angle_test();
    let roots = expand_angles(&mut system.graph, &rows.entries, is_angle);
    (system, roots)
}

#[test]
fn the_matrices_of_the_regimes_are_those_of_exact_arithmetic() {
    for name in ["general", "same_rate", "one_palm_fixed", "fixed_palms"] {
        let (system, roots) = regime(&format!("{name}.proof"));
        // sines and cosines are given here, any two numbers
        let is_angle = &system.angle_test();
        let block = BlockProgram::new(&system.graph, &roots, &[], is_angle, unknown);
        let scalar = Program::new(&system.graph, &roots, is_angle);
        let exact = Rationals::default();
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let (mut compared, mut widest) = (0, Vec::new());
        for _ in 0..20 {
            let inputs: Vec<f64> =
                block.inputs().iter().map(|_| f64::from(rng.random_range(-99i32..99)) / 32.0).collect();
            let place = |input: &Input| block.inputs().iter().position(|other| other == input);
            let given: Vec<RBig> = scalar
                .inputs()
                .iter()
                .map(|input| place(input).map_or(RBig::ONE, |i| rational_from_f64(inputs[i]).unwrap()))
                .collect();
            let Ok(values) = scalar.load(exact).unwrap().run(&given, &mut Vec::new()) else { continue };
            let (found, health) = bounded(&block, &inputs);
            assert_eq!(health.value, 0.0);
            for (value, found) in values.iter().zip(found) {
                let off =
                    rational_to_f64(&exact.sub(value, &rational_from_f64(found.value).unwrap()).unwrap());
                assert!(off.abs() <= found.error(), "{name}: off by {off}, bound {}", found.error());
                compared += 1;
                if found.value != 0.0 {
                    widest.push(found.error() / found.value.abs());
                }
            }
        }
        assert!(compared > 300, "{name}: {compared}");
        widest.sort_by(f64::total_cmp);
        let middle = widest[widest.len() / 2];
        // a bound that says nothing would pass everything above
        assert!(middle > 0.0 && middle < 1e-13, "{name}: half of the bounds are above {middle}");
    }
}

fn random_states(block: &BlockProgram, count: usize) -> Vec<Vec<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    block.inputs().iter().map(|_| (0..count).map(|_| rng.random_range(0.3..2.5)).collect()).collect()
}

fn evaluate(
    instructions: Instructions,
    block: &BlockProgram,
    inputs: &[Vec<f64>],
) -> (Vec<Vec<f64>>, Vec<usize>) {
    let count = inputs.first().map_or(0, Vec::len);
    let mut outputs = vec![vec![0.0; count]; block.outputs()];
    let given: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
    let mut taken: Vec<&mut [f64]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
    let lost = block.evaluate_with(instructions, &given, &mut taken);
    (outputs, lost)
}

#[test]
fn the_same_bits_with_and_without_wide_instructions_for_any_number_of_states() {
    for name in ["general.proof", "same_rate.proof"] {
        let (system, roots) = regime(name);
        // angles in radians, their sines computed
        let block = BlockProgram::new(&system.graph, &roots, &[], |_| false, unknown);
        let all = random_states(&block, 1000);
        let (whole, _) = evaluate(Instructions::Portable, &block, &all);
        for instructions in Instructions::ALL {
            for count in [1, 7, 8, 9, 15, 17, 65, 1000] {
                let some: Vec<Vec<f64>> = all.iter().map(|values| values[..count].to_vec()).collect();
                let (found, lost) = evaluate(instructions, &block, &some);
                assert!(lost.is_empty());
                for (a, b) in found.iter().zip(&whole) {
                    let same = a.iter().zip(b).all(|(x, y)| x.to_bits() == y.to_bits());
                    assert!(same, "{name}, {instructions:?}, {count} states");
                }
            }
        }
    }
}

#[test]
fn the_scalar_program_agrees_to_within_the_rounding_of_both() {
    // its own rounding is bounded by intervals
    let (system, roots) = regime("general.proof");
    let block = BlockProgram::new(&system.graph, &roots, &[], |_| false, unknown);
    let states = random_states(&block, 200);
    let scalar = Program::plain(&system.graph, &roots);
    let arithmetic = Floats::<Interval>::default();
    let loaded = scalar.load(arithmetic).unwrap();
    for state in 0..200 {
        let inputs: Vec<f64> = states.iter().map(|values| values[state]).collect();
        let (found, _) = bounded(&block, &inputs);
        let given: Vec<Interval> = scalar
            .inputs()
            .iter()
            .map(|input| {
                let place = block.inputs().iter().position(|other| other == input).unwrap();
                arithmetic.rational(&rational_from_f64(inputs[place]).unwrap()).unwrap()
            })
            .collect();
        for (interval, found) in loaded.run(&given, &mut Vec::new()).unwrap().iter().zip(found) {
            let distance = (interval.mid() - found.value).abs();
            assert!(distance <= interval.rad() + found.error(), "{} and {interval:?}", found.value);
        }
    }
}

/// A program for one expression of x and y.
fn of(text: &str) -> BlockProgram {
    let source = format!("system \"s\" state x, y param p output x let e = {text}");
    let system = System::parse("s.proof", &source, std::path::Path::new("")).unwrap();
    let Some(Value::Scalar(root)) = system.definition("e").cloned() else { panic!("{text}") };
    BlockProgram::new(&system.graph, &[root], &[], |_| false, unknown)
}

fn at(text: &str, x: f64, y: f64) -> Option<f64> {
    let block = of(text);
    let names = block.inputs().len();
    assert!(names <= 2);
    let values = [x, y];
    let inputs: Vec<Vec<f64>> = (0..names).map(|place| vec![values[place]]).collect();
    if names == 0 {
        let (found, health) = bounded(&block, &[]);
        return (!block.is_undefined() && health.value == 0.0).then_some(found[0].value);
    }
    let (outputs, lost) = evaluate(Instructions::detect(), &block, &inputs);
    lost.is_empty().then_some(outputs[0][0])
}

#[test]
fn what_is_not_finite_is_named_even_where_it_would_vanish() {
    assert_eq!(at("1/x", 0.0, 0.0), None);
    assert_eq!(at("1/(1 + 1/x)", 0.0, 0.0), None); // 1/(1 + infinity) would be zero
    assert_eq!(at("1/(x*x)", 1e-200, 0.0), None); // a divisor that underflows
    assert_eq!(at("1/(x*x + 1)", 1e200, 0.0), None); // one that overflows: its reciprocal would be zero
    assert_eq!(at("atan(x*x)", 1e200, 0.0), None);
    assert_eq!(at("log(x)", -1.0, 0.0), None);
    assert_eq!(at("sqrt(x)", -1.0, 0.0), None);
    assert_eq!(at("sin(x*x)", 1e200, 0.0), None);
    assert_eq!(at("x*y", 1e200, 1e200), None);
    assert_eq!(at("x + y", f64::NAN, 1.0), None);
    assert_eq!(at("x/(p - p)", 1.0, 1.0), None);
    assert_eq!(at("1/x", 4.0, 0.0), Some(0.25));
    assert_eq!(at("exp(x)", 0.0, 0.0), Some(1.0));
}

#[test]
fn a_watched_expression_is_checked_and_not_computed() {
    let source = "system \"s\" state x, y output x let e = x let w = 1/(x - y)";
    let system = System::parse("s.proof", source, std::path::Path::new("")).unwrap();
    let scalar = |name| match system.definition(name) {
        Some(Value::Scalar(root)) => *root,
        _ => panic!("{name}"),
    };
    let block = BlockProgram::new(&system.graph, &[scalar("e")], &[scalar("w")], |_| false, unknown);
    assert_eq!((block.outputs(), block.inputs().len()), (1, 2));
    let (outputs, lost) =
        evaluate(Instructions::detect(), &block, &[vec![1.0, 2.0, 3.0], vec![5.0, 2.0, 4.0]]);
    assert_eq!((outputs, lost), (vec![vec![1.0, 2.0, 3.0]], vec![1]));
}

#[test]
fn algebra_is_exact() {
    // factors are taken out of sums: one product, and what is zero is zero without rounding
    assert!(of("x*y + x*p").operations() <= 2);
    assert_eq!(at("x/10 - 0.1*x", 3.0, 0.0), Some(0.0));
    assert_eq!(at("(x + y)*(1/3) - (x + y)/3", 0.7, 0.1), Some(0.0));
    assert_eq!(at("-(x - y)", 1.0, 3.0), Some(2.0));
    assert_eq!(at("-x*y", 2.0, 3.0), Some(-6.0));
    assert_eq!(at("-x - y", 2.0, 3.0), Some(-5.0));
    assert_eq!(at("x^7", 2.0, 0.0), Some(128.0));
    assert_eq!(at("x^(-3)", 2.0, 0.0), Some(0.125));
    assert_eq!(at("x*x^(-1)", 2.0, 0.0), Some(1.0));
    assert_eq!(at("2 + 3", 0.0, 0.0), Some(5.0));
    assert_eq!(at("(x^1000)^1000", 1.0, 0.0), Some(1.0));
}

#[test]
fn known_inputs_become_constants() {
    let mut graph = Graph::default();
    let (x, y) = (graph.intern("x"), graph.intern("y"));
    let (a, b) = (graph.symbol(x), graph.symbol(y));
    let product = graph.mul(a, b);
    let half = RBig::from(IBig::ONE) / RBig::from(2);
    let known = |input| (input == Input::Plain(y)).then(|| half.clone());
    let block = BlockProgram::new(&graph, &[product], &[], |_| false, known);
    assert_eq!(block.inputs(), [Input::Plain(x)]);
    assert_eq!(bounded(&block, &[3.0]).0[0].value, 1.5);
}

#[test]
fn long_programs_are_compiled_and_deep_ones_too() {
    let mut graph = Graph::default();
    let x = graph.intern("x");
    let mut node = graph.symbol(x);
    let start = node;
    for step in 0..50_000i64 {
        let constant = graph.integer(step % 5 + 2);
        let product = graph.mul(node, start);
        node = graph.add(product, constant);
    }
    let block = BlockProgram::new(&graph, &[node], &[], |_| false, unknown);
    assert!(block.registers() < 40, "{} registers", block.registers());
    // x = 0: the last constant alone is left
    assert_eq!(bounded(&block, &[0.0]).0[0].value, 6.0);
}
