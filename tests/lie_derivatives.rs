//! Two routes to a Lie derivative that share no rule of differentiation: the graph's, and num-dual's. And what the
//! graph costs.

use num_dual::Dual64;
use palmistry::expression::{Program, Symbol};
use palmistry::number::{Arithmetic, Enclosures, Floats, rational_from_f64, rational_to_f64};
use palmistry::observability::{Branch, Locus, differential_by_duals, float_inputs, lie_derivative_by_duals};
use palmistry::{System, tradeoff::growth_of_lie_derivatives};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

fn read(name: &str) -> System {
    System::read(&Path::new("proofs/moll2002").join(name)).unwrap()
}

/// A state of the sample box in doubles.
fn point(system: &mut System, index: u64) -> HashMap<Symbol, f64> {
    let everything: Vec<_> =
        system.fields.iter().flat_map(|field| field.components.iter().map(|(_, node)| *node)).collect();
    let locus = Locus::new(system, &Branch::default(), &BTreeMap::new(), &everything).unwrap();
    locus
        .draw(11, index)
        .unwrap()
        .values
        .into_iter()
        .map(|(symbol, value)| (symbol, value.to_f64()))
        .collect()
}

/// All words of `length` fields.
fn words(fields: usize, length: usize) -> Vec<Vec<usize>> {
    (0..length).fold(vec![Vec::new()], |words, _| {
        words.iter().flat_map(|word| (0..fields).map(move |f| [word.as_slice(), &[f]].concat())).collect()
    })
}

/// Differentials along every word of up to two fields, all regimes, every output. What rounding may do to a value is
/// measured, not guessed: the same program is run in interval arithmetic with the 53 bits of a double, and the width of
/// the result bounds what any evaluation in doubles of these operations may be off by. The graph's value has to lie in
/// that interval; num-dual takes other steps to the same value, and may be off by some widths (its quotient rule
/// squares the divisor, its products take two roundings more).
#[test]
fn differentials_agree_to_what_conditioning_allows() {
    let intervals = Enclosures::new(53);
    for name in ["general.proof", "same_rate.proof", "one_palm_fixed.proof", "fixed_palms.proof"] {
        let mut system = read(name);
        for index in 0..5 {
            let point = point(&mut system, index);
            let fields = system.fields.len();
            for word in (0..=2).flat_map(|length| words(fields, length)) {
                for (output, h) in system.outputs.clone() {
                    let mut value = h;
                    for field in word.iter().rev() {
                        value = system.lie_derivative(*field, value);
                    }
                    let row = system.differential(value);
                    let program = Program::new(&system.graph, &row, |_| false, false);
                    let inputs = float_inputs(&program, |symbol| point[&symbol]);
                    let graph = program.load(Floats).unwrap().run(&inputs, &mut Vec::new()).unwrap();
                    let exact: Vec<_> = inputs
                        .iter()
                        .map(|x| intervals.rational(&rational_from_f64(*x).unwrap()).unwrap())
                        .collect();
                    let bounds = program.load(intervals).unwrap().run(&exact, &mut Vec::new()).unwrap();
                    let duals = differential_by_duals(&system, &word, h, &point).unwrap();
                    for ((x, y), bound) in graph.iter().zip(&duals).zip(&bounds) {
                        let (low, high) = (rational_to_f64(&bound.low()), rational_to_f64(&bound.high()));
                        // a sine of the system's library may be off by one more unit than a correctly rounded one
                        let width = 2.0 * (high - low) + f64::EPSILON * x.abs();
                        let middle = low + (high - low) / 2.0;
                        let place = format!("{name} {word:?} {output}: {x} and {y} in {low} to {high}");
                        assert!((x - middle).abs() <= width, "graph: {place}");
                        assert!((y - middle).abs() <= 8.0 * width, "duals: {place}");
                    }
                }
            }
        }
    }
}

/// Over another number type: the derivative by a parameter of a Lie derivative, with num-dual's own duals at the leaves,
/// against 4.48 differentiated by hand: d(L_f s1)/dg = cos(phi1)/(omega1 - omega0).
#[test]
fn any_number_that_num_dual_knows_will_do() {
    let mut system = read("same_rate.proof");
    let symbol = |system: &System, name: &str| system.find_symbol(name).unwrap();
    let plain = point(&mut system, 3);
    let g = symbol(&system, "g");
    let duals: HashMap<Symbol, Dual64> = plain
        .iter()
        .map(|(s, x)| (*s, if *s == g { Dual64::from_re(*x).derivative() } else { Dual64::from_re(*x) }))
        .collect();
    let value = lie_derivative_by_duals(&system, &[0], system.outputs[0].1, &duals).unwrap();
    let at = |name: &str| plain[&symbol(&system, name)];
    let by_hand = at("phi1").cos() / (at("omega1") - at("omega0"));
    assert!((value.eps - by_hand).abs() <= 4.0 * f64::EPSILON * by_hand.abs());
}

/// The harmonic oscillator: L_f^k x is x, y, -x, -y, x, ... exactly, at any order and by both routes.
#[test]
fn a_circle_comes_back_to_itself() {
    let text = "system \"circle\" state x, y field f x' = y y' = -x output x";
    let mut system = System::parse("circle.proof", text, Path::new("")).unwrap();
    let (x, y) = (system.find_symbol("x").unwrap(), system.find_symbol("y").unwrap());
    let point = HashMap::from([(x, 0.25), (y, 3.0)]);
    let mut value = system.outputs[0].1;
    for order in 1..=12 {
        value = system.lie_derivative(0, value);
        let expected = [0.25, 3.0, -0.25, -3.0][order % 4];
        let program = Program::new(&system.graph, &[value], |_| false, false);
        let inputs = float_inputs(&program, |symbol| point[&symbol]);
        assert_eq!(program.load(Floats).unwrap().run(&inputs, &mut Vec::new()).unwrap(), [expected]);
        let duals = lie_derivative_by_duals(&system, &vec![0; order], system.outputs[0].1, &point).unwrap();
        assert_eq!(duals, expected);
    }
}

/// Twelve orders on the same-rate regime. A graph that doubled from order to order would be 2048 times as large at
/// order 12 as at order 1; one that grows as the cube is 1728/8 = 216 times as large at order 12 as at order 2.
#[test]
fn the_graph_grows_as_a_power_of_the_order() {
    let system = read("same_rate.proof");
    let growth = growth_of_lie_derivatives(&system, 0, 0, 12);
    let size = |order: usize| growth[order - 1].operations as f64;
    let exponent = (size(12) / size(6)).log2();
    assert!(exponent < 3.2, "operations grow as order^{exponent:.2}");
    assert!(size(12) < 216.0 * size(2), "{growth:?}");
}
