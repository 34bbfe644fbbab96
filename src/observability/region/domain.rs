//! Where a system is defined: nothing that its outputs and fields divide by is zero, no logarithm or square root has an
//! argument that is not positive.
//!
//! Every Lie derivative divides by the same things and by no others, so that it is defined, and smooth, where these are.

use crate::expression::{Graph, Node, NodeId};
use crate::number::Function;

/// Something that has to be different from zero, or positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Guard {
    NotZero(NodeId),
    Positive(NodeId),
}

/// What keeps these expressions and all their derivatives defined. A square root has to have a positive argument: at
/// zero it has no derivative.
pub(super) fn guards(graph: &mut Graph, roots: &[NodeId]) -> Vec<Guard> {
    let mut found = Vec::new();
    for id in graph.reachable(roots.iter().copied()) {
        let guard = match graph.node(id) {
            Node::Div(_, divisor) => Guard::NotZero(divisor),
            Node::Power(base, n) if n < 0 => Guard::NotZero(base),
            Node::Apply(Function::Log | Function::Sqrt, argument) => Guard::Positive(argument),
            Node::Apply(Function::Asin | Function::Acos, argument) => {
                let (one, square) = (graph.integer(1), graph.power(argument, 2));
                Guard::Positive(graph.sub(one, square))
            }
            _ => continue,
        };
        let (Guard::NotZero(node) | Guard::Positive(node)) = guard;
        let holds = graph.constant_value(node).is_some_and(|value| match guard {
            Guard::NotZero(_) => !value.is_zero(),
            Guard::Positive(_) => *value > dashu::rational::RBig::ZERO,
        });
        if !holds && !found.contains(&guard) {
            found.push(guard);
        }
    }
    found
}
