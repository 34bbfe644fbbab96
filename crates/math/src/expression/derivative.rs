//! Derivatives of the shared graph.
//!
//! A [`Derivation`] is a linear map `D` on expressions with `D(uv) = D(u)v + uD(v)`, given by its values on the
//! symbols: a partial derivative (`D(x) = 1`), or the Lie derivative along a field (`D(x_i) = f_i`). What it has
//! computed it keeps, and since equal expressions are one node, repeated application stays small: after `k` steps a
//! product of `u` and `v` has left the `k + 1` products `D^i(u) D^(k-i)(v)` and sums of neighbours among them, so the
//! graph of the `k`-th Lie derivative has O(k^3) nodes for each node of the function and the field.

use super::bars::slopes_of_factors;
use super::graph::{Graph, GraphExtent, Node, NodeId, Symbol};
use crate::number::Function;
use std::collections::HashMap;

/// The name of a known signal's value some steps later.
fn later_value(signal: &str, steps: usize) -> String {
    format!("{signal}(t+{steps})")
}

/// The signal of which a symbol is a later value, by their names.
pub fn signal_of(name: &str) -> Option<&str> {
    let (signal, step) = name.strip_suffix(')')?.split_once("(t+")?;
    step.parse::<usize>().is_ok().then_some(signal)
}

/// A derivation and what it has computed so far; or the composition with a map, which takes each symbol to its successor and
/// everything else to what it is of these.
#[derive(Clone, Debug)]
pub struct Derivation {
    slopes: HashMap<Symbol, NodeId>,
    composes: bool,
    /// Of a composition: symbols whose successors are new at every step, by the name of the first and the step.
    fresh: HashMap<Symbol, (String, usize)>,
    known: HashMap<NodeId, NodeId>,
    /// What is known, in the order in which it was found.
    found: Vec<NodeId>,
    /// The symbols that were given a successor since, each with that successor, in the order in which they were met.
    stepped: Vec<(Symbol, Symbol)>,
}

/// How much a derivation has computed, to return to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KnownSoFar {
    derivatives: usize,
    steps: usize,
}

impl Derivation {
    /// The derivation that takes each of these symbols to its expression and all others to zero.
    pub fn new(slopes: HashMap<Symbol, NodeId>) -> Self {
        Derivation {
            slopes,
            composes: false,
            fresh: HashMap::new(),
            known: HashMap::new(),
            found: Vec::new(),
            stepped: Vec::new(),
        }
    }

    /// The composition with the map that takes symbols to their successors, and others to themselves. What is `fresh` has
    /// any value at every step: `u` goes to the symbol `u(t+1)`, and that to `u(t+2)`.
    pub fn composition(graph: &Graph, successors: HashMap<Symbol, NodeId>, fresh: &[Symbol]) -> Self {
        let named = |symbol: &Symbol| (*symbol, (graph.symbol_name(*symbol).to_owned(), 0));
        let fresh = fresh.iter().map(named).collect();
        Derivation { composes: true, fresh, ..Derivation::new(successors) }
    }

    /// The same kind of map with other values on the symbols; it has computed nothing yet.
    pub fn with_values(&self, graph: &Graph, values: HashMap<Symbol, NodeId>) -> Self {
        match self.composes {
            false => Derivation::new(values),
            true => {
                let first = self.fresh.iter().filter(|(_, (_, step))| *step == 0);
                let first: Vec<Symbol> = first.map(|(symbol, _)| *symbol).collect();
                Derivation::composition(graph, values, &first)
            }
        }
    }

    /// Whether it is the composition with a map.
    pub fn composes(&self) -> bool {
        self.composes
    }

    /// An expression after one step.
    fn composed(&mut self, graph: &mut Graph, root: NodeId) -> NodeId {
        if let Some(known) = self.known.get(&root) {
            return *known;
        }
        for symbol in graph.symbols_of([root]) {
            if let Some((name, step)) = self.fresh.get(&symbol).cloned()
                && !self.slopes.contains_key(&symbol)
            {
                let next = graph.intern(&later_value(&name, step + 1));
                let node = graph.symbol(next);
                self.slopes.insert(symbol, node);
                self.fresh.insert(next, (name, step + 1));
                self.stepped.push((symbol, next));
            }
        }
        let value = graph.substitute(&[root], &self.slopes)[0];
        self.known.insert(root, value);
        self.found.push(root);
        value
    }

    /// The partial derivative by one symbol.
    pub fn partial(graph: &mut Graph, symbol: Symbol) -> Self {
        let one = graph.integer(1);
        Derivation::new(HashMap::from([(symbol, one)]))
    }

    /// `D(root)`.
    pub fn apply(&mut self, graph: &mut Graph, root: NodeId) -> NodeId {
        if self.composes {
            return self.composed(graph, root);
        }
        if let Some(known) = self.known.get(&root) {
            return *known;
        }
        for id in self.unknown(graph, root) {
            let slope = self.rule(graph, id);
            self.known.insert(id, slope);
            self.found.push(id);
        }
        self.known[&root]
    }

    /// How much has been computed, to return to.
    pub fn known_so_far(&self) -> KnownSoFar {
        KnownSoFar { derivatives: self.found.len(), steps: self.stepped.len() }
    }

    /// Forgets what was found since, and the later values of signals that were named since: their nodes and symbols go.
    pub fn shrink_to(&mut self, before: KnownSoFar) {
        for id in self.found.drain(before.derivatives.min(self.found.len())..) {
            self.known.remove(&id);
        }
        for (symbol, next) in self.stepped.drain(before.steps.min(self.stepped.len())..) {
            self.slopes.remove(&symbol);
            self.fresh.remove(&next);
        }
    }

    /// Whether every node and symbol that it names is one of a graph of this extent.
    pub fn is_within(&self, extent: &GraphExtent) -> bool {
        let nodes = self.known.iter().flat_map(|(id, value)| [id, value]).chain(self.slopes.values());
        let symbols = self.slopes.keys().chain(self.fresh.keys());
        nodes.into_iter().all(|id| extent.holds(*id)) && symbols.into_iter().all(|one| extent.names(*one))
    }

    /// What the root needs and is not yet differentiated, operands first.
    fn unknown(&self, graph: &Graph, root: NodeId) -> Vec<NodeId> {
        let mut found = std::collections::BTreeSet::new();
        let mut stack = vec![root];
        while let Some(id) = stack.pop() {
            if !self.known.contains_key(&id) && found.insert(id) {
                stack.extend(graph.node(id).operands());
            }
        }
        found.into_iter().collect()
    }

    fn rule(&self, graph: &mut Graph, id: NodeId) -> NodeId {
        let slope = |operand: NodeId| self.known[&operand];
        if let Some(factors) = slopes_of_factors(graph, id)
            && factors.iter().all(|factor| self.known.contains_key(&factor.of))
        {
            let zero = graph.integer(0);
            return factors.into_iter().fold(zero, |sum, factor| {
                let part = graph.mul(factor.slope, slope(factor.of));
                graph.add(sum, part)
            });
        }
        match graph.node(id) {
            Node::Constant(_) | Node::Pi => graph.integer(0),
            Node::Symbol(symbol) => match self.slopes.get(&symbol) {
                Some(value) => *value,
                None => graph.integer(0),
            },
            Node::Add(a, b) => graph.add(slope(a), slope(b)),
            Node::Sub(a, b) => graph.sub(slope(a), slope(b)),
            Node::Neg(a) => graph.neg(slope(a)),
            Node::Mul(a, b) => {
                let left = graph.mul(slope(a), b);
                let right = graph.mul(a, slope(b));
                graph.add(left, right)
            }
            // q = a/b, so a = q b and D(q) = (D(a) - q D(b)) / b
            Node::Div(a, b) => {
                let moved = graph.mul(id, slope(b));
                let top = graph.sub(slope(a), moved);
                graph.div(top, b)
            }
            Node::Power(a, n) => {
                let lower = graph.power(a, n - 1);
                let factor = graph.integer(i64::from(n));
                let outer = graph.mul(factor, lower);
                graph.mul(outer, slope(a))
            }
            Node::Apply(function, a) => {
                let inner = slope(a);
                if graph.constant_value(inner).is_some_and(|c| c.is_zero()) {
                    return inner;
                }
                chain(graph, function, id, a, inner)
            }
        }
    }
}

/// `D(f(a)) = f'(a) D(a)`; `value` is the node `f(a)`.
pub(super) fn chain(
    graph: &mut Graph,
    function: Function,
    value: NodeId,
    a: NodeId,
    inner: NodeId,
) -> NodeId {
    let one = graph.integer(1);
    match function {
        Function::Sin => {
            let outer = graph.apply(Function::Cos, a);
            graph.mul(outer, inner)
        }
        Function::Cos => {
            let outer = graph.apply(Function::Sin, a);
            let product = graph.mul(outer, inner);
            graph.neg(product)
        }
        Function::Exp => graph.mul(value, inner),
        Function::Log => graph.div(inner, a),
        Function::Sqrt => {
            let two = graph.integer(2);
            let twice = graph.mul(two, value);
            graph.div(inner, twice)
        }
        Function::Atan => {
            let square = graph.power(a, 2);
            let bottom = graph.add(one, square);
            graph.div(inner, bottom)
        }
        Function::Asin | Function::Acos => {
            let square = graph.power(a, 2);
            let rest = graph.sub(one, square);
            let bottom = graph.apply(Function::Sqrt, rest);
            let quotient = graph.div(inner, bottom);
            if function == Function::Asin { quotient } else { graph.neg(quotient) }
        }
    }
}
