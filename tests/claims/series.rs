//! Repeated Lie derivatives by Taylor series and gradients by the reverse mode, held against repeated derivation and
//! against nested duals.

use dashu::rational::RBig;
use palmistry::System;
use palmistry::expression::{Derivation, identically_zero};
use palmistry::expression::{Graph, Input, NodeId, Program, Symbol, ZeroTest, expand_angles, gradient};
use palmistry::number::{
    Arithmetic, Enclosures, Floats, PrimeField, Rationals, rational_from_f64, rational_to_f64,
};
use palmistry::observability::{Branch, Coordinate, Flow, Locus, State, float_inputs};
use palmistry::observability::{differential_by_duals, lie_derivative_by_series};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

fn read(name: &str) -> System {
    System::read(&Path::new("proofs/moll2002").join(name).with_extension("proof")).unwrap()
}

fn by_derivation(system: &mut System, word: &[usize], h: NodeId) -> NodeId {
    word.iter().rev().fold(h, |value, field| system.lie_derivative(*field, value))
}

/// One partial derivative after the other.
fn forward(graph: &mut Graph, root: NodeId, symbols: &[Symbol]) -> Vec<NodeId> {
    symbols.iter().map(|symbol| Derivation::partial(graph, *symbol).apply(graph, root)).collect()
}

fn assert_identical(system: &mut System, left: &[NodeId], right: &[NodeId], what: &str) {
    let differences: Vec<NodeId> = left.iter().zip(right).map(|(a, b)| system.graph.sub(*a, *b)).collect();
    let is_angle = &system.angle_test();
    let differences = expand_angles(&mut system.graph, &differences, is_angle);
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let found = identically_zero(&system.graph, &differences, is_angle, &mut rng);
    assert!(matches!(found, ZeroTest::Zero { .. }), "{what}: {found:?}");
}

/// All words of `length` fields.
fn words(fields: usize, length: usize) -> Vec<Vec<usize>> {
    (0..length).fold(vec![Vec::new()], |words, _| {
        words.iter().flat_map(|word| (0..fields).map(move |f| [word.as_slice(), &[f]].concat())).collect()
    })
}

fn states_of(system: &mut System, mentioned: &[NodeId], count: u64) -> Vec<State> {
    let locus = Locus::new(system, &Branch::default(), &BTreeMap::new(), mentioned).unwrap();
    (0..count).map(|index| locus.draw(3, index).unwrap()).collect()
}

/// Every word of up to three fields (mixed ones too) and the unmixed ones of four, of every output of every regime:
/// proved identical modulo random primes.
#[test]
fn series_and_derivation_are_identical() {
    for name in ["general", "same_rate", "one_palm_fixed", "fixed_palms"] {
        let mut system = read(name);
        let fields = system.fields.len();
        let mut all: Vec<_> = (1..=3).flat_map(|length| words(fields, length)).collect();
        all.extend((0..fields).map(|field| vec![field; 4]));
        for word in all {
            let (mut series, mut derived) = (Vec::new(), Vec::new());
            for (_, h) in system.outputs.clone() {
                let first = by_derivation(&mut system, &word[word.len() - 1..], h);
                if system.graph.constant_value(first).is_none() {
                    series.push(lie_derivative_by_series(&mut system, &word, h).unwrap());
                    derived.push(by_derivation(&mut system, &word, h));
                }
            }
            assert_identical(&mut system, &series, &derived, &format!("{name} {word:?}"));
        }
    }
}

/// The reverse mode against one derivation for each state, on Lie derivatives up to order three and on every function.
#[test]
fn gradients_and_partial_derivatives_are_identical() {
    for name in ["general", "same_rate", "one_palm_fixed", "fixed_palms"] {
        let mut system = read(name);
        let states = system.states.clone();
        for field in 0..system.fields.len() {
            for order in 1..=3 {
                for (output, h) in system.outputs.clone() {
                    let value = by_derivation(&mut system, &vec![field; order], h);
                    let reverse = gradient(&mut system.graph, value, &states);
                    let one_by_one = forward(&mut system.graph, value, &states);
                    assert_identical(&mut system, &reverse, &one_by_one, &format!("{name} {field} {output}"));
                }
            }
        }
    }
}

const FUNCTIONS: &str = r#"
    system "every function, moved by a field of two states"
    state x, y
    drift f
      x' = x*y + exp(-x) - sqrt(1 + y^2)/3
      y' = sin(x + y) - log(2 + x^2)*cos(y)
    input g
      x' = atan(x*y) + asin(y/5)^3
      y' = acos(x/7) - (x + 2)^(-2) + pi
    output x*sin(y), atan(x)/y
"#;

/// With every function that there is, in interval arithmetic of 200 bits: the two enclosures have to meet, and to be
/// narrow enough for that to mean something.
#[test]
fn every_function_has_its_recurrence() {
    let mut system = System::parse("functions.proof", FUNCTIONS, Path::new("")).unwrap();
    let states = system.states.clone();
    let intervals = Enclosures::new(200);
    let at = |name: &str| rational_from_f64(if name == "x" { 0.375 } else { 0.8125 }).unwrap();
    for word in (1..=4).flat_map(|length| words(2, length)) {
        for (output, h) in system.outputs.clone() {
            let series = lie_derivative_by_series(&mut system, &word, h).unwrap();
            let derived = by_derivation(&mut system, &word, h);
            let mut roots = vec![series, derived];
            roots.extend(gradient(&mut system.graph, series, &states));
            roots.extend(forward(&mut system.graph, derived, &states));
            let program = Program::plain(&system.graph, &roots);
            let inputs: Vec<_> = program
                .inputs()
                .iter()
                .map(|input| match input {
                    Input::Plain(symbol) => {
                        intervals.rational(&at(system.graph.symbol_name(*symbol))).unwrap()
                    }
                    other => panic!("{other:?}"),
                })
                .collect();
            let values = program.load(intervals).unwrap().run(&inputs, &mut Vec::new()).unwrap();
            for (a, b) in [(0, 1), (2, 4), (3, 5)] {
                let common = Enclosures::common(&values[a], &values[b]);
                let common = common.unwrap_or_else(|| panic!("{word:?} of {output}, entry {a}"));
                let width = rational_to_f64(&(common.high() - common.low()));
                assert!(width < 1e-40, "{word:?} of {output}, entry {a}: {width:e}");
            }
        }
    }
}

/// The exact value of one input at a state.
fn value(state: &State, input: &Input) -> RBig {
    match input {
        Input::Plain(symbol) => match &state.values[symbol] {
            Coordinate::Number(value) => value.clone(),
            angle => panic!("{angle:?}"),
        },
        Input::Sine(symbol) | Input::Cosine(symbol) => match &state.values[symbol] {
            Coordinate::Angle { sine, .. } if matches!(input, Input::Sine(_)) => sine.clone(),
            Coordinate::Angle { cosine, .. } => cosine.clone(),
            number => panic!("{number:?}"),
        },
        other => panic!("{other:?}"),
    }
}

/// `L_g1^8 s1` of the ten-state regime and its gradient, exactly at rational states: series and reverse mode against
/// derivation alone; and the numbers that the series gives over rationals and residues without any graph.
#[test]
fn order_eight_is_the_same_rational_number() {
    let mut system = read("general");
    let g1 = system.fields.iter().position(|field| field.name == "g1").unwrap();
    let (h, states) = (system.outputs[0].1, system.states.clone());
    let word = vec![g1; 8];
    let series = lie_derivative_by_series(&mut system, &word, h).unwrap();
    let derived = by_derivation(&mut system, &word, h);
    let mut roots = vec![series];
    roots.extend(gradient(&mut system.graph, series, &states));
    roots.push(derived);
    roots.extend(forward(&mut system.graph, derived, &states));
    let is_angle = &system.angle_test();
    let mut extended = roots;
    extended.extend(system.fields[g1].components.iter().map(|(_, node)| *node));
    let extended = expand_angles(&mut system.graph, &extended, is_angle);
    let (roots, rates) = extended.split_at(22);
    let moved: Vec<_> =
        system.fields[g1].components.iter().map(|(symbol, _)| *symbol).zip(rates.iter().copied()).collect();
    let program = Program::new(&system.graph, roots, is_angle);
    let flow = Flow::new(&system.graph, &moved, &[h], is_angle);
    let exact = Rationals::default();
    let field = PrimeField::random(&mut ChaCha8Rng::seed_from_u64(9));
    for state in states_of(&mut system, roots, 3) {
        let inputs = state.inputs(&program, &exact).unwrap();
        let values = program.load(exact).unwrap().run(&inputs, &mut Vec::new()).unwrap();
        assert_eq!(values[..11], values[11..]);
        let given: Vec<RBig> = flow.inputs().iter().map(|input| value(&state, input)).collect();
        assert_eq!(flow.lie_derivatives(&exact, &given, 8).unwrap()[0][8], values[0]);
        let inputs: Vec<u64> = given.iter().map(|x| field.rational(x).unwrap()).collect();
        let residue = field.rational(&values[0]).unwrap();
        assert_eq!(flow.lie_derivatives(&field, &inputs, 8).unwrap()[0][8], residue);
    }
}

/// Nested duals share no rule with either: orders up to five in doubles. An entry of a gradient is held to the size of
/// the largest, as cancellation in one entry is measured by what cancels.
#[test]
fn nested_duals_agree() {
    let mut system = read("general");
    let everything: Vec<NodeId> =
        system.fields.iter().flat_map(|field| field.components.iter().map(|(_, node)| *node)).collect();
    let states = system.states.clone();
    for state in states_of(&mut system, &everything, 4) {
        let point: HashMap<Symbol, f64> = state.values.iter().map(|(s, x)| (*s, x.to_f64())).collect();
        for field in 0..system.fields.len() {
            for order in 1..=5 {
                let (word, h) = (vec![field; order], system.outputs[0].1);
                let series = lie_derivative_by_series(&mut system, &word, h).unwrap();
                let row = gradient(&mut system.graph, series, &states);
                let program = Program::plain(&system.graph, &row);
                let inputs = float_inputs(&program, |symbol| point[&symbol]);
                let row = program.load(Floats).unwrap().run(&inputs, &mut Vec::new()).unwrap();
                let duals = differential_by_duals(&system, &word, h, &point).unwrap();
                let scale = duals.iter().fold(0.0f64, |a, x| a.max(x.abs()));
                for (x, y) in row.iter().zip(&duals) {
                    // measured: at most 2e-15 of the largest entry
                    assert!((x - y).abs() <= 1e-13 * scale, "{field} {order}: {row:?} {duals:?}");
                }
            }
        }
    }
}

/// The cost of a gradient is a small multiple of the value's, however many states there are; and of the k-th Lie
/// derivative by series it is of the second order in k, where derivation is of the third.
#[test]
fn the_operations_are_few() {
    let mut system = read("general");
    let (h, states) = (system.outputs[0].1, system.states.clone());
    let mut sizes = Vec::new();
    for order in [4, 8, 16, 32] {
        let word = vec![1; order];
        let value = lie_derivative_by_series(&mut system, &word, h).unwrap();
        let row = gradient(&mut system.graph, value, &states);
        let size = |roots: &[NodeId]| Program::plain(&system.graph, roots).len();
        assert!(size(&row) < 4 * size(&[value]), "order {order}: {} and {}", size(&row), size(&[value]));
        sizes.push(size(&[value]) as f64);
    }
    assert!((sizes[3] / sizes[2]).log2() < 2.1, "{sizes:?}");
    let derived = by_derivation(&mut system, &[1; 8], h);
    let derived = Program::plain(&system.graph, &[derived]).len();
    assert!((sizes[1] as usize) < derived, "{sizes:?} {derived}");
}

/// A division by the constant zero does not vanish when it is differentiated, in whatever term it stands.
#[test]
fn what_is_undefined_stays_undefined() {
    let mut graph = Graph::default();
    let symbol = graph.intern("x");
    let (x, one, zero) = (graph.symbol(symbol), graph.integer(1), graph.integer(0));
    let pole = graph.div(one, zero);
    let sum = graph.add(x, pole);
    let slope = gradient(&mut graph, sum, &[symbol])[0];
    let program = Program::plain(&graph, &[slope]);
    let inputs = vec![2.0; program.inputs().len()];
    assert!(program.load(Floats).unwrap().run(&inputs, &mut Vec::new()).is_err());
}
