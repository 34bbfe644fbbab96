//! Two routes to a Lie derivative that share no rule of differentiation: the graph's, and num-dual's. And what the
//! graph costs.

use dashu::base::Abs;
use dashu::integer::IBig;
use dashu::rational::RBig;
use num_dual::{Dual64, DualNum};
use palmistry::System;
use palmistry::expression::{Program, Symbol, expand_angles};
use palmistry::number::{
    Arithmetic, DoubleDouble, Enclosures, Floats, Interval, Rationals, RealNumber, rational_from_f64,
    rational_to_f64,
};
use palmistry::observability::{
    Branch, Coordinate, Locus, differential_by_duals, float_inputs, lie_derivative_by_duals,
};
use palmistry::tradeoff::{WaysAgreement, compare_ways, growth_of_lie_derivatives};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

const REGIMES: [&str; 5] = [
    "general.proof",
    "constraint/two_rates.proof",
    "same_rate.proof",
    "one_palm_fixed.proof",
    "fixed_palms.proof",
];

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

/// Differentials along every word of up to two fields, all regimes, every output, over a number of `bits` bits. What
/// rounding may do to a value is measured, not guessed: the same program is run in interval arithmetic of as many bits,
/// and the width of the result bounds what any evaluation of these operations in such numbers may be off by. The graph's
/// value has to lie in that interval; num-dual takes other steps to the same value, and may be off by some widths (its
/// quotient rule squares the divisor, its products take two roundings more).
fn differentials_agree<T: RealNumber + DualNum>(bits: usize, exactly: fn(T) -> RBig) {
    let intervals = Enclosures::new(bits);
    let unit = |x: &RBig| x.clone().abs() / RBig::from(IBig::ONE << (bits - 1));
    for name in REGIMES {
        let mut system = read(name);
        for index in 0..5 {
            let point: HashMap<Symbol, T> = point(&mut system, index)
                .into_iter()
                .map(|(symbol, x)| (symbol, <T as RealNumber>::from_f64(x)))
                .collect();
            let fields = system.fields.len();
            for word in (0..=2).flat_map(|length| words(fields, length)) {
                for (output, h) in system.outputs.clone() {
                    let mut value = h;
                    for field in word.iter().rev() {
                        value = system.lie_derivative(*field, value);
                    }
                    let row = system.differential(value);
                    let program = Program::plain(&system.graph, &row);
                    let inputs = float_inputs(&program, |symbol| point[&symbol]);
                    let graph =
                        program.load(Floats::<T>::new()).unwrap().run(&inputs, &mut Vec::new()).unwrap();
                    let exact: Vec<_> =
                        inputs.iter().map(|x| intervals.rational(&exactly(*x)).unwrap()).collect();
                    let bounds = program.load(intervals).unwrap().run(&exact, &mut Vec::new()).unwrap();
                    let duals = differential_by_duals(&system, &word, h, &point).unwrap();
                    for ((x, y), bound) in graph.iter().zip(&duals).zip(&bounds) {
                        let (x, y) = (exactly(*x), exactly(*y));
                        // a sine of the number's library may be off by one more unit than a correctly rounded one
                        let width = RBig::from(2) * (bound.high() - bound.low()) + unit(&x);
                        let middle = (bound.low() + bound.high()) / RBig::from(2);
                        let off = |x: &RBig| rational_to_f64(&(x - &middle)).abs();
                        let width = rational_to_f64(&width);
                        let place = format!("{name} {word:?} {output}: width {width}");
                        assert!(off(&x) <= width, "graph: {place}, off by {}", off(&x));
                        assert!(off(&y) <= 8.0 * width, "duals: {place}, off by {}", off(&y));
                    }
                }
            }
        }
    }
}

#[test]
fn differentials_agree_to_what_conditioning_allows() {
    differentials_agree::<f64>(53, |x| rational_from_f64(x).unwrap());
}

#[test]
fn differentials_agree_in_single_precision() {
    differentials_agree::<f32>(24, |x| rational_from_f64(f64::from(x)).unwrap());
}

/// A hundred bits are what a double-double promises of each operation.
#[test]
fn differentials_agree_to_thirty_digits() {
    differentials_agree::<DoubleDouble>(100, |x| x.to_rational().unwrap());
}

/// At states whose coordinates are rational, and whose angles have rational sines and cosines, the exact differential
/// lies in the intervals of both routes.
#[test]
fn intervals_enclose_the_exact_differential() {
    for name in REGIMES {
        let mut system = read(name);
        let everything: Vec<_> =
            system.fields.iter().flat_map(|field| field.components.iter().map(|(_, node)| *node)).collect();
        let locus = Locus::new(&mut system, &Branch::default(), &BTreeMap::new(), &everything).unwrap();
        let (angles, fields) = (system.angles(), system.fields.len());
        for index in 0..5 {
            let state = locus.draw(7, index).unwrap();
            let enclosed = |value: &Coordinate| match value {
                Coordinate::Number(value) => Interval::from_rational(value),
                Coordinate::Angle { sine, cosine } => {
                    Interval::from_rational(sine).atan2(Interval::from_rational(cosine))
                }
            };
            let point: HashMap<Symbol, Interval> =
                state.values.iter().map(|(symbol, value)| (*symbol, enclosed(value))).collect();
            for word in (0..=2).flat_map(|length| words(fields, length)) {
                for (output, h) in system.outputs.clone() {
                    let mut value = h;
                    for field in word.iter().rev() {
                        value = system.lie_derivative(*field, value);
                    }
                    let row = system.differential(value);
                    let row = expand_angles(&mut system.graph, &row, |s| angles.contains(&s));
                    let program = Program::new(&system.graph, &row, |s| angles.contains(&s));
                    let inputs = state.inputs(&program, &Rationals::default()).unwrap();
                    let exact =
                        program.load(Rationals::default()).unwrap().run(&inputs, &mut Vec::new()).unwrap();
                    let inputs = float_inputs(&program, |symbol| point[&symbol]);
                    let graph = program
                        .load(Floats::<Interval>::new())
                        .unwrap()
                        .run(&inputs, &mut Vec::new())
                        .unwrap();
                    let duals = differential_by_duals(&system, &word, h, &point).unwrap();
                    for (exact, bounds) in exact.iter().zip(graph.iter().zip(&duals)) {
                        for (route, bound) in [("graph", bounds.0), ("duals", bounds.1)] {
                            let end = |x: f64| rational_from_f64(x).unwrap();
                            assert!(
                                end(bound.low()) <= *exact && *exact <= end(bound.high()),
                                "{route} {name} {word:?} {output}: {bound} for {}",
                                rational_to_f64(exact)
                            );
                        }
                    }
                }
            }
        }
    }
}

/// A third is no double: were it passed through one on its way into the duals, the interval would not hold the exact
/// derivative, and the double-double would end after sixteen digits.
#[test]
fn constants_of_a_program_keep_their_digits_within_duals() {
    let text = "system \"third\" state x drift f x' = x/3 + 1/7 output x";
    let system = System::parse("third.proof", text, Path::new("")).unwrap();
    let (x, h) = (system.find_symbol("x").unwrap(), system.outputs[0].1);
    let ninth = RBig::from_parts(1.into(), 9u8.into());
    let point = HashMap::from([(x, Interval::point(0.75))]);
    let bound = differential_by_duals(&system, &[0, 0], h, &point).unwrap()[0];
    let end = |x: f64| rational_from_f64(x).unwrap();
    assert!(end(bound.low()) < ninth && ninth < end(bound.high()) && bound.width() < 1e-15);
    let point = HashMap::from([(x, DoubleDouble::from(0.75))]);
    let fine = differential_by_duals(&system, &[0, 0], h, &point).unwrap()[0];
    assert!((fine - DoubleDouble::from_rational(&ninth)).hi().abs() < 1e-31);
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
    let text = "system \"circle\" state x, y drift f x' = y y' = -x output x";
    let mut system = System::parse("circle.proof", text, Path::new("")).unwrap();
    let (x, y) = (system.find_symbol("x").unwrap(), system.find_symbol("y").unwrap());
    let point = HashMap::from([(x, 0.25), (y, 3.0)]);
    let mut value = system.outputs[0].1;
    for order in 1..=12 {
        value = system.lie_derivative(0, value);
        let expected = [0.25, 3.0, -0.25, -3.0][order % 4];
        let program = Program::plain(&system.graph, &[value]);
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

/// What `verify` holds to each other: graph, Taylor series and dual numbers, for all Lie derivatives of the codistribution, along the drift and every input of every regime.
#[test]
fn three_ways_agree_on_every_regime() {
    for name in REGIMES {
        let system = read(name);
        let found = compare_ways(&system, 1).unwrap().expect("Lie derivatives");
        println!("{name}: {found:?}");
        assert!(found.agree(), "{name}: {found:?}");
        assert_eq!(found.fields.len(), system.moving_fields().len(), "{name}");
        assert!(
            found.derivatives >= system.outputs.len() && found.order >= 1 && found.states == 8,
            "{name}: {found:?}"
        );
    }
    // what is no number agrees with nothing
    let found = compare_ways(&read("same_rate.proof"), 1).unwrap().unwrap();
    for wrong in [1e-3, f64::NAN, f64::INFINITY] {
        assert!(!WaysAgreement { largest: [wrong, 0.0], ..found.clone() }.agree(), "{wrong}");
    }
    // a derivative that vanishes without looking so, beside another; and no derivative at all, of which nothing is said
    let parse = |text: &str| System::parse("s.proof", text, Path::new("")).unwrap();
    let vanishes = parse(
        "system \"s\" state x, y, z drift f x' = y*(x - 1/3) - y*x + y/3 y' = z z' = sin(y) output x, y \
         sample x in [0.1, 1] y in [0.1, 1] z in [0.1, 1]",
    );
    let found = compare_ways(&vanishes, 1).unwrap().unwrap();
    assert!(found.agree() && found.derivatives > 0, "{found:?}");
    let none = parse("system \"s\" state x drift f x' = -x output x sample x in [0, 1]");
    assert!(compare_ways(&none, 1).unwrap().is_none());
}
