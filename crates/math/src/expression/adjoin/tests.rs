//! What the relations show, and what they do not.

use super::*;
use crate::expression::{Guard, Need};

fn symbol(graph: &mut Graph, name: &str) -> NodeId {
    let symbol = graph.intern(name);
    graph.symbol(symbol)
}

fn shown(graph: &mut Graph, difference: NodeId, assumptions: &[Guard]) -> Related {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let before = graph.len();
    let found = zero_by_relations(graph, &[difference], assumptions, |_| false, &mut rng);
    assert_eq!(graph.len(), before, "the graph is left as it was");
    found
}

/// sqrt(x^2) is x where that is not negative, -x where it is not positive, and neither where nothing is known.
#[test]
fn a_sign_is_used_where_it_is_assumed() {
    let mut graph = Graph::default();
    let x = symbol(&mut graph, "x");
    let square = graph.power(x, 2);
    let root = graph.apply(Function::Sqrt, square);
    let (less, more) = (graph.sub(root, x), graph.add(root, x));
    let minus = graph.neg(x);
    let upward = Guard { node: x, need: Need::NotNegative };
    let downward = Guard { node: minus, need: Need::NotNegative };
    let is_shown = |found: Related| matches!(found, Related::Zero { .. });
    assert!(is_shown(shown(&mut graph, less, &[upward])));
    assert!(is_shown(shown(&mut graph, more, &[downward])));
    for difference in [less, more] {
        assert!(!is_shown(shown(&mut graph, difference, &[])));
    }
    assert!(!is_shown(shown(&mut graph, less, &[downward])));
}

/// From `x y >= 0` and `x >= 0` nothing follows for `y`, since `x` may be zero; from `x > 0` it does.
#[test]
fn a_factor_that_may_be_zero_tells_no_sign() {
    let mut graph = Graph::default();
    let (x, y) = (symbol(&mut graph, "x"), symbol(&mut graph, "y"));
    let product = graph.mul(x, y);
    let square = graph.power(y, 2);
    let root = graph.apply(Function::Sqrt, square);
    let difference = graph.sub(root, y);
    let whole = Guard { node: product, need: Need::NotNegative };
    for (need, expected) in [(Need::NotNegative, false), (Need::Positive, true)] {
        let found = shown(&mut graph, difference, &[whole, Guard { node: x, need }]);
        assert_eq!(matches!(found, Related::Zero { .. }), expected, "{need:?}: {found:?}");
    }
}

/// The probability is that of a proof, and an expression without functions is none of ours.
#[test]
fn a_proof_has_its_bound() {
    let mut graph = Graph::default();
    let (x, y) = (symbol(&mut graph, "x"), symbol(&mut graph, "y"));
    let sum = graph.add(x, y);
    let [whole, first, second] = [sum, x, y].map(|node| graph.apply(Function::Exp, node));
    let product = graph.mul(first, second);
    let difference = graph.sub(whole, product);
    match shown(&mut graph, difference, &[]) {
        Related::Zero { log2_error, used, .. } => {
            // one generator for each of x and y: after the rewriting nothing is left to be tested, or little
            assert!(log2_error < -100.0, "{log2_error}");
            assert_eq!(used, "exponentials");
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(shown(&mut graph, sum, &[]), Related::NoFunctions);
}
