//! The shared graph: every expression that occurs is one node, however often it occurs.
//!
//! Nodes are only ever added, and a node's operands come before it; a pass over the nodes in their order needs no
//! recursion, so no expression is too deep.

use crate::number::{Arithmetic, Function, Rationals, Refusal};
use dashu::base::BitTest;
use dashu::rational::RBig;
use palmistry_budget as budget;
use std::collections::{HashMap, HashSet};

/// A coordinate, a parameter, or any other name that stands for a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Symbol(pub(crate) u32);

/// A place in a [`Graph`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub(crate) u32);

/// One operation; its operands are earlier nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)] // names and messages say it
pub enum Node {
    /// An exact rational, by its place in the table of constants.
    Constant(u32),
    Pi,
    Symbol(Symbol),
    Add(NodeId, NodeId),
    Sub(NodeId, NodeId),
    Mul(NodeId, NodeId),
    Div(NodeId, NodeId),
    Neg(NodeId),
    Power(NodeId, i32),
    Apply(Function, NodeId),
}

impl Node {
    /// The nodes it needs.
    pub fn operands(self) -> impl Iterator<Item = NodeId> {
        let (a, b) = match self {
            Node::Constant(_) | Node::Pi | Node::Symbol(_) => (None, None),
            Node::Add(a, b) | Node::Sub(a, b) | Node::Mul(a, b) | Node::Div(a, b) => (Some(a), Some(b)),
            Node::Neg(a) | Node::Power(a, _) | Node::Apply(_, a) => (Some(a), None),
        };
        a.into_iter().chain(b)
    }
}

/// Nodes, each of them once.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    /// Nodes that have no value anywhere (a division by the constant zero), or need one that has none.
    undefined: Vec<bool>,
    places: HashMap<Node, NodeId>,
    constants: Vec<RBig>,
    constant_places: HashMap<RBig, u32>,
    symbols: Vec<String>,
    symbol_places: HashMap<String, Symbol>,
}

/// The extent of a graph: how many nodes, symbols and constants it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GraphExtent {
    nodes: usize,
    constants: usize,
    symbols: usize,
}

impl GraphExtent {
    /// Whether a node is one of so many.
    pub fn holds(&self, id: NodeId) -> bool {
        (id.0 as usize) < self.nodes
    }

    /// Whether a symbol is.
    pub fn names(&self, symbol: Symbol) -> bool {
        (symbol.0 as usize) < self.symbols
    }
}

/// Constants longer than this many bits are not multiplied out when the graph is built.
const FOLDED_BITS: usize = 4096;

/// Up to this part of a graph is few nodes, in [`Graph::reachable`]. A node of a set costs as much as some dozens of a table.
const FEW: usize = 128;

impl Graph {
    /// The number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no node yet.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The operation at a place.
    pub fn node(&self, id: NodeId) -> Node {
        self.nodes[id.0 as usize]
    }

    /// The rational at a place of the table of constants.
    pub(crate) fn constant_at(&self, index: u32) -> &RBig {
        &self.constants[index as usize]
    }

    /// The value of a node that is a rational constant.
    pub fn constant_value(&self, id: NodeId) -> Option<&RBig> {
        match self.node(id) {
            Node::Constant(index) => Some(self.constant_at(index)),
            _ => None,
        }
    }

    /// The symbol that a node is.
    pub fn as_symbol(&self, id: NodeId) -> Option<Symbol> {
        match self.node(id) {
            Node::Symbol(symbol) => Some(symbol),
            _ => None,
        }
    }

    /// A symbol's name.
    pub fn symbol_name(&self, symbol: Symbol) -> &str {
        &self.symbols[symbol.0 as usize]
    }

    /// The symbol of a name, if there is one.
    pub fn find_symbol(&self, name: &str) -> Option<Symbol> {
        self.symbol_places.get(name).copied()
    }

    /// The symbol of a name, new or known.
    pub fn intern(&mut self, name: &str) -> Symbol {
        if let Some(symbol) = self.symbol_places.get(name) {
            return *symbol;
        }
        let symbol = Symbol(self.symbols.len() as u32);
        self.symbols.push(name.to_owned());
        self.symbol_places.insert(name.to_owned(), symbol);
        symbol
    }

    fn insert(&mut self, node: Node) -> NodeId {
        budget::steps(16);
        if let Some(known) = self.places.get(&node) {
            return *known;
        }
        let outside = |function, a| {
            let value = self.constant_value(a).map(|c| Rationals { bits: FOLDED_BITS }.apply(function, c));
            matches!(value, Some(Err(Refusal::OutsideDomain(_))))
        };
        let undefined = match node {
            Node::Div(_, b) => self.is(b, 0),
            Node::Power(a, n) => n < 0 && self.is(a, 0),
            Node::Apply(function, a) => outside(function, a),
            _ => false,
        } || node.operands().any(|operand| self.undefined[operand.0 as usize]);
        budget::nodes(1);
        budget::steps(64);
        let id = NodeId(self.nodes.len() as u32);
        self.nodes.push(node);
        self.undefined.push(undefined);
        self.places.insert(node, id);
        id
    }

    /// Whether nothing may be simplified here, because an operand has no value: zero times nothing is not zero.
    pub(super) fn has_no_value(&self, operands: &[NodeId]) -> bool {
        operands.iter().any(|operand| self.undefined[operand.0 as usize])
    }

    /// The present extent, to return to.
    pub fn extent(&self) -> GraphExtent {
        GraphExtent { nodes: self.nodes.len(), constants: self.constants.len(), symbols: self.symbols.len() }
    }

    /// Takes away all that was added since; no node of it may be used any more. The cost is that of what goes.
    pub fn shrink_to(&mut self, extent: &GraphExtent) {
        self.undefined.truncate(extent.nodes);
        for node in self.nodes.drain(extent.nodes.min(self.nodes.len())..) {
            self.places.remove(&node);
        }
        for constant in self.constants.drain(extent.constants.min(self.constants.len())..) {
            self.constant_places.remove(&constant);
        }
        for symbol in self.symbols.drain(extent.symbols.min(self.symbols.len())..) {
            self.symbol_places.remove(&symbol);
        }
    }

    /// A symbol as an expression.
    pub fn symbol(&mut self, symbol: Symbol) -> NodeId {
        self.insert(Node::Symbol(symbol))
    }

    /// A rational constant.
    pub fn rational(&mut self, value: RBig) -> NodeId {
        let index = match self.constant_places.get(&value) {
            Some(index) => *index,
            None => {
                budget::bytes((value.numerator().bit_len() + value.denominator().bit_len()) / 8);
                let index = self.constants.len() as u32;
                self.constants.push(value.clone());
                self.constant_places.insert(value, index);
                index
            }
        };
        self.insert(Node::Constant(index))
    }

    /// An integer constant.
    pub fn integer(&mut self, value: i64) -> NodeId {
        self.rational(RBig::from(value))
    }

    /// The constant pi.
    pub fn pi(&mut self) -> NodeId {
        self.insert(Node::Pi)
    }

    /// The value of an operation on two constants, where it is defined and short.
    fn fold(
        &mut self,
        a: NodeId,
        b: NodeId,
        operation: impl Fn(&Rationals, &RBig, &RBig) -> Option<RBig>,
    ) -> Option<NodeId> {
        let value = match (self.constant_value(a), self.constant_value(b)) {
            (Some(x), Some(y)) => operation(&Rationals { bits: FOLDED_BITS }, x, y),
            _ => None,
        }?;
        Some(self.rational(value))
    }

    fn is(&self, id: NodeId, value: i8) -> bool {
        self.constant_value(id).is_some_and(|c| *c == RBig::from(value))
    }

    /// `a + b`
    pub fn add(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if self.has_no_value(&[a, b]) {
            return self.insert(Node::Add(a.min(b), a.max(b)));
        }
        if let Some(sum) = self.fold(a, b, |q, x, y| q.add(x, y).ok()) {
            return sum;
        }
        match (self.node(a), self.node(b)) {
            _ if self.is(a, 0) => b,
            _ if self.is(b, 0) => a,
            (_, Node::Neg(c)) => self.sub(a, c),
            (Node::Neg(c), _) => self.sub(b, c),
            _ => self.insert(Node::Add(a.min(b), a.max(b))),
        }
    }

    /// `a - b`
    pub fn sub(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if self.has_no_value(&[a, b]) {
            return self.insert(Node::Sub(a, b));
        }
        if let Some(difference) = self.fold(a, b, |q, x, y| q.sub(x, y).ok()) {
            return difference;
        }
        match self.node(b) {
            _ if a == b => self.integer(0),
            _ if self.is(b, 0) => a,
            _ if self.is(a, 0) => self.neg(b),
            Node::Neg(c) => self.add(a, c),
            _ => self.insert(Node::Sub(a, b)),
        }
    }

    /// `a * b`
    pub fn mul(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if self.has_no_value(&[a, b]) {
            return self.insert(Node::Mul(a.min(b), a.max(b)));
        }
        if let Some(product) = self.fold(a, b, |q, x, y| q.mul(x, y).ok()) {
            return product;
        }
        if self.is(a, 0) || self.is(b, 0) {
            return self.integer(0);
        }
        match (self.node(a), self.node(b)) {
            _ if self.is(a, 1) => b,
            _ if self.is(b, 1) => a,
            _ if self.is(a, -1) => self.neg(b),
            _ if self.is(b, -1) => self.neg(a),
            (Node::Neg(x), Node::Neg(y)) => self.mul(x, y),
            (Node::Neg(x), _) => {
                let product = self.mul(x, b);
                self.neg(product)
            }
            (_, Node::Neg(y)) => {
                let product = self.mul(a, y);
                self.neg(product)
            }
            _ if a == b => self.power(a, 2),
            _ => self.insert(Node::Mul(a.min(b), a.max(b))),
        }
    }

    /// `a / b`. A division by the constant zero is kept, so that its evaluation reports it.
    pub fn div(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if self.has_no_value(&[a, b]) {
            return self.insert(Node::Div(a, b));
        }
        if let Some(quotient) = self.fold(a, b, |q, x, y| q.div(x, y).ok()) {
            return quotient;
        }
        match (self.node(a), self.node(b)) {
            _ if self.is(b, 0) => self.insert(Node::Div(a, b)),
            _ if self.is(a, 0) => a,
            _ if self.is(b, 1) => a,
            _ if self.is(b, -1) => self.neg(a),
            (Node::Neg(x), Node::Neg(y)) => self.div(x, y),
            (Node::Neg(x), _) => {
                let quotient = self.div(x, b);
                self.neg(quotient)
            }
            (_, Node::Neg(y)) => {
                let quotient = self.div(a, y);
                self.neg(quotient)
            }
            // a rational function is what it is almost everywhere: s/tan(phi) has no pole where the cosine vanishes
            (_, Node::Div(x, y)) => {
                let top = self.mul(a, y);
                self.div(top, x)
            }
            _ => self.insert(Node::Div(a, b)),
        }
    }

    /// `-a`
    pub fn neg(&mut self, a: NodeId) -> NodeId {
        match self.node(a) {
            Node::Constant(index) => {
                let value = -self.constants[index as usize].clone();
                self.rational(value)
            }
            Node::Neg(inner) => inner,
            Node::Sub(x, y) => self.sub(y, x),
            _ => self.insert(Node::Neg(a)),
        }
    }

    /// `a^n`; a square root is unwound.
    pub fn power(&mut self, a: NodeId, n: i32) -> NodeId {
        if self.has_no_value(&[a]) {
            return self.insert(Node::Power(a, n));
        }
        if let Some(value) = self.constant_value(a)
            && let Ok(power) = (Rationals { bits: FOLDED_BITS }).power(value, n)
        {
            return self.rational(power);
        }
        match (self.node(a), n) {
            (_, 0) => self.integer(1),
            (_, 1) => a,
            (Node::Apply(Function::Sqrt, inner), n) if n % 2 == 0 => self.power(inner, n / 2),
            (Node::Power(base, m), n) => match m.checked_mul(n) {
                Some(product) => self.power(base, product),
                None => self.insert(Node::Power(a, n)),
            },
            (Node::Neg(inner), n) if n % 2 == 0 => self.power(inner, n),
            (_, n) => self.insert(Node::Power(a, n)),
        }
    }

    /// `f(a)`
    pub fn apply(&mut self, function: Function, a: NodeId) -> NodeId {
        if let Some(value) = self.constant_value(a)
            && let Ok(exact) = (Rationals { bits: FOLDED_BITS }).apply(function, value)
        {
            return self.rational(exact);
        }
        match (function, self.node(a)) {
            (Function::Cos, Node::Neg(inner)) => self.apply(Function::Cos, inner),
            (Function::Sin | Function::Atan | Function::Asin, Node::Neg(inner)) => {
                let value = self.apply(function, inner);
                self.neg(value)
            }
            _ => self.insert(Node::Apply(function, a)),
        }
    }

    /// The sum of many terms.
    pub fn sum(&mut self, terms: impl IntoIterator<Item = NodeId>) -> NodeId {
        let zero = self.integer(0);
        terms.into_iter().fold(zero, |sum, term| self.add(sum, term))
    }

    /// All nodes that the given ones need, themselves included, operands before what uses them.
    pub fn reachable(&self, roots: impl IntoIterator<Item = NodeId>) -> Vec<NodeId> {
        // a table of all nodes is quick to ask and slow to make: where few are needed, a set does
        let (mut few, mut table) = (HashSet::new(), Vec::new());
        let many = self.nodes.len() / FEW;
        let mut stack: Vec<NodeId> = roots.into_iter().collect();
        let mut found: Vec<NodeId> = Vec::new();
        while let Some(id) = stack.pop() {
            if table.is_empty() && found.len() >= many {
                table = vec![false; self.nodes.len()];
                for known in &found {
                    table[known.0 as usize] = true;
                }
            }
            let new = match table.get_mut(id.0 as usize) {
                Some(seen) => !std::mem::replace(seen, true),
                None => few.insert(id),
            };
            if new {
                found.push(id);
                stack.extend(self.node(id).operands());
            }
        }
        found.sort_unstable();
        found
    }

    /// The symbols that an expression mentions.
    pub fn symbols_of(&self, roots: impl IntoIterator<Item = NodeId>) -> Vec<Symbol> {
        let mut symbols: Vec<Symbol> =
            self.reachable(roots).into_iter().filter_map(|id| self.as_symbol(id)).collect();
        symbols.sort_unstable();
        symbols
    }

    /// The same operation on other operands.
    pub fn rebuild(&mut self, node: Node, operand: impl Fn(NodeId) -> NodeId) -> NodeId {
        match node {
            Node::Constant(_) | Node::Pi | Node::Symbol(_) => self.insert(node),
            Node::Add(a, b) => self.add(operand(a), operand(b)),
            Node::Sub(a, b) => self.sub(operand(a), operand(b)),
            Node::Mul(a, b) => self.mul(operand(a), operand(b)),
            Node::Div(a, b) => self.div(operand(a), operand(b)),
            Node::Neg(a) => self.neg(operand(a)),
            Node::Power(a, n) => self.power(operand(a), n),
            Node::Apply(function, a) => self.apply(function, operand(a)),
        }
    }

    /// The expressions with symbols replaced, all at once.
    pub fn substitute(&mut self, roots: &[NodeId], values: &HashMap<Symbol, NodeId>) -> Vec<NodeId> {
        let image = self.images(roots, values);
        roots.iter().map(|root| image[root]).collect()
    }

    /// The factor of a divisor that becomes the constant zero when symbols are replaced, as it was before.
    pub fn vanishing_divisor(
        &mut self,
        roots: &[NodeId],
        values: &HashMap<Symbol, NodeId>,
    ) -> Option<NodeId> {
        let image = self.images(roots, values);
        let vanishes = |graph: &Graph, id: NodeId| image.get(&id).is_some_and(|new| graph.is(*new, 0));
        let mut found =
            self.reachable(roots.iter().copied()).into_iter().find_map(|id| match self.node(id) {
                Node::Div(_, b) if vanishes(self, b) => Some(b),
                _ => None,
            })?;
        loop {
            found = match self.node(found) {
                Node::Mul(a, b) => {
                    if vanishes(self, a) {
                        a
                    } else {
                        b
                    }
                }
                Node::Neg(a) | Node::Power(a, _) => a,
                _ => return Some(found),
            };
        }
    }

    /// Everything that some expressions need, with symbols replaced.
    fn images(&mut self, roots: &[NodeId], values: &HashMap<Symbol, NodeId>) -> HashMap<NodeId, NodeId> {
        let mut image: HashMap<NodeId, NodeId> = HashMap::new();
        for id in self.reachable(roots.iter().copied()) {
            let node = self.node(id);
            let new = match node {
                Node::Symbol(symbol) => values.get(&symbol).copied().unwrap_or(id),
                _ => self.rebuild(node, |operand| image[&operand]),
            };
            image.insert(id, new);
        }
        image
    }
}
