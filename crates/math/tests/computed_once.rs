//! What a program computes once, and what it refuses where it runs.

use palmistry_math::expression::{Graph, Program};
use palmistry_math::number::{Arithmetic, Duals, Floats, Function, Refusal};

/// By hand: a part without inputs stands between two that have some; its value is that of the formula, and so are the others', in the order in which they were asked for.
#[test]
fn constants_are_computed_first_and_change_nothing() {
    let mut graph = Graph::default();
    let [x, y] = ["x", "y"].map(|name| {
        let symbol = graph.intern(name);
        graph.symbol(symbol)
    });
    let two = graph.integer(2);
    let first = graph.mul(x, y);
    let sine = graph.apply(Function::Sin, two);
    let root = graph.apply(Function::Sqrt, two);
    let constant = graph.add(sine, root);
    let last = graph.mul(constant, first);
    let program = Program::plain(&graph, &[first, constant, last]);
    let loaded = program.load(Floats).unwrap();
    let expected = 2.0f64.sin() + 2.0f64.sqrt();
    for _ in 0..2 {
        let found = loaded.run(&[3.0, 5.0], &mut vec![7.0]).unwrap();
        assert_eq!(found, [15.0, expected, expected * 15.0]);
    }
}

/// The root of minus one is refused where it runs, with its node, and not where the program is loaded.
#[test]
fn a_constant_without_a_value_is_named_where_it_runs() {
    let mut graph = Graph::default();
    let symbol = graph.intern("x");
    let (x, minus) = (graph.symbol(symbol), graph.integer(-1));
    let root = graph.apply(Function::Sqrt, minus);
    let sum = graph.add(x, root);
    let program = Program::plain(&graph, &[sum]);
    let failure = program.load(Floats).unwrap().run(&[1.0], &mut Vec::new()).unwrap_err();
    assert_eq!((failure.refusal, failure.node), (Refusal::OutsideDomain(Function::Sqrt), root));
}

/// Powers of dual numbers and their slopes, `n x^(n-1)`, and the pole.
#[test]
fn powers_of_dual_numbers() {
    type Dual = num_dual::Dual64;
    let duals = Duals::<Dual>::default();
    for n in -4..=6 {
        let found = duals.power(&Dual::new(1.5, 1.0), n).unwrap();
        let slope = f64::from(n) * 1.5f64.powi(n - 1);
        assert!(
            (found.re - 1.5f64.powi(n)).abs() < 1e-13 && (found.eps - slope).abs() < 1e-12,
            "{n}: {found}"
        );
    }
    assert_eq!(duals.power(&Dual::new(0.0, 1.0), -1).unwrap_err(), Refusal::DivisionByZero);
}
