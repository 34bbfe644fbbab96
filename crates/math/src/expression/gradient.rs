//! All partial derivatives of one expression at once: the reverse mode on the shared graph.
//!
//! The adjoint of a node is the derivative of the root by that node. From the root, whose adjoint is one, they are
//! handed down to the operands by the chain rule; a node's adjoint is the sum of what its users hand down. Every
//! operation costs a few more, so that the whole gradient costs a small multiple of the value however many symbols
//! there are, where [`Derivation`](super::Derivation) costs one pass for each of them.
//!
//! Reference: A. Griewank and A. Walther, *Evaluating Derivatives* (2nd ed. 2008), section 3.2.

use super::bars::slopes_of_factors;
use super::derivative::{Derivation, chain};
use super::graph::{Graph, Node, NodeId, Symbol};
use std::collections::{HashMap, HashSet};

/// The derivatives of `root` by each of `symbols`, in their order.
pub fn gradient(graph: &mut Graph, root: NodeId, symbols: &[Symbol]) -> Vec<NodeId> {
    if graph.has_no_value(&[root]) {
        // a division by the constant zero is kept wherever it stands: of a term that does not vary nothing is handed down
        return symbols.iter().map(|symbol| Derivation::partial(graph, *symbol).apply(graph, root)).collect();
    }
    let order = graph.reachable([root]);
    let wanted: HashSet<Symbol> = symbols.iter().copied().collect();
    let mut adjoints = Adjoints { varies: HashSet::new(), sums: HashMap::new() };
    for id in &order {
        let node = graph.node(*id);
        let moves = match node {
            Node::Symbol(symbol) => wanted.contains(&symbol),
            _ => node.operands().any(|operand| adjoints.varies.contains(&operand)),
        };
        if moves {
            adjoints.varies.insert(*id);
        }
    }
    let one = graph.integer(1);
    adjoints.sums.insert(root, one);
    for id in order.into_iter().rev() {
        if adjoints.varies.contains(&id)
            && let Some(adjoint) = adjoints.sums.get(&id).copied()
        {
            adjoints.hand_down(graph, id, adjoint);
        }
    }
    let zero = graph.integer(0);
    let of = |graph: &mut Graph, symbol: Symbol| {
        let node = graph.symbol(symbol);
        adjoints.sums.get(&node).copied().unwrap_or(zero)
    };
    symbols.iter().map(|symbol| of(graph, *symbol)).collect()
}

struct Adjoints {
    /// The nodes that depend on a symbol by which is derived; no other needs an adjoint.
    varies: HashSet<NodeId>,
    sums: HashMap<NodeId, NodeId>,
}

impl Adjoints {
    fn varies(&self, id: NodeId) -> bool {
        self.varies.contains(&id)
    }

    fn add(&mut self, graph: &mut Graph, to: NodeId, part: NodeId) {
        if self.varies(to) {
            let sum = self.sums.get(&to).map_or(part, |known| graph.add(*known, part));
            self.sums.insert(to, sum);
        }
    }

    fn subtract(&mut self, graph: &mut Graph, from: NodeId, part: NodeId) {
        if self.varies(from) {
            let sum = match self.sums.get(&from) {
                Some(known) => graph.sub(*known, part),
                None => graph.neg(part),
            };
            self.sums.insert(from, sum);
        }
    }

    /// Hands the adjoint of a node down to its operands.
    fn hand_down(&mut self, graph: &mut Graph, id: NodeId, adjoint: NodeId) {
        if let Some(factors) = slopes_of_factors(graph, id)
            && factors.iter().all(|factor| factor.of < id)
        {
            for factor in factors {
                let part = graph.mul(adjoint, factor.slope);
                self.add(graph, factor.of, part);
            }
            return;
        }
        match graph.node(id) {
            Node::Constant(_) | Node::Pi | Node::Symbol(_) => {}
            Node::Add(a, b) => {
                self.add(graph, a, adjoint);
                self.add(graph, b, adjoint);
            }
            Node::Sub(a, b) => {
                self.add(graph, a, adjoint);
                self.subtract(graph, b, adjoint);
            }
            Node::Neg(a) => self.subtract(graph, a, adjoint),
            Node::Mul(a, b) => {
                for (operand, other) in [(a, b), (b, a)] {
                    if self.varies(operand) {
                        let part = graph.mul(adjoint, other);
                        self.add(graph, operand, part);
                    }
                }
            }
            // q = a/b: dq/da = 1/b, dq/db = -q/b; of a reciprocal it is -q^2, without another division
            Node::Div(a, b) if graph.constant_value(a).is_some_and(|c| c.is_one()) => {
                let square = graph.power(id, 2);
                let part = graph.mul(adjoint, square);
                self.subtract(graph, b, part);
            }
            Node::Div(a, b) => {
                let part = graph.div(adjoint, b);
                self.add(graph, a, part);
                if self.varies(b) {
                    let part = graph.mul(part, id);
                    self.subtract(graph, b, part);
                }
            }
            Node::Power(a, n) => {
                let lower = graph.power(a, n - 1);
                let part = graph.mul(adjoint, lower);
                let factor = graph.integer(i64::from(n));
                let part = graph.mul(factor, part);
                self.add(graph, a, part);
            }
            Node::Apply(function, a) => {
                let part = chain(graph, function, id, a, adjoint);
                self.add(graph, a, part);
            }
        }
    }
}
