//! Expressions as numbers: an [`Arithmetic`] whose numbers are nodes of a graph.
//!
//! Whatever is computed over any arithmetic can so be computed once in symbols: the result is a part of the graph, to
//! be evaluated over every other arithmetic, or differentiated. Constants fold away as the graph is built.

use super::graph::{Graph, NodeId};
use crate::number::{Arithmetic, Function, Refusal};
use dashu::rational::RBig;
use std::cell::RefCell;

/// The nodes of one graph, which grows as they are calculated with.
#[derive(Debug)]
pub struct Nodes<'g>(RefCell<&'g mut Graph>);

impl<'g> Nodes<'g> {
    /// Numbers that are nodes of this graph.
    pub fn new(graph: &'g mut Graph) -> Self {
        Nodes(RefCell::new(graph))
    }

    fn build(&self, operation: impl FnOnce(&mut Graph) -> NodeId) -> Result<NodeId, Refusal> {
        // borrowed for one operation at a time, and no operation of the graph comes back here
        let mut graph = self.0.try_borrow_mut().map_err(|_| Refusal::TooLarge)?;
        Ok(operation(&mut graph))
    }
}

impl Arithmetic for Nodes<'_> {
    type Number = NodeId;

    fn rational(&self, value: &RBig) -> Result<NodeId, Refusal> {
        self.build(|graph| graph.rational(value.clone()))
    }
    fn pi(&self) -> Result<NodeId, Refusal> {
        self.build(Graph::pi)
    }
    fn add(&self, a: &NodeId, b: &NodeId) -> Result<NodeId, Refusal> {
        self.build(|graph| graph.add(*a, *b))
    }
    fn sub(&self, a: &NodeId, b: &NodeId) -> Result<NodeId, Refusal> {
        self.build(|graph| graph.sub(*a, *b))
    }
    fn mul(&self, a: &NodeId, b: &NodeId) -> Result<NodeId, Refusal> {
        self.build(|graph| graph.mul(*a, *b))
    }
    fn div(&self, a: &NodeId, b: &NodeId) -> Result<NodeId, Refusal> {
        if self.is_zero(b) == Some(true) {
            return Err(Refusal::DivisionByZero);
        }
        self.build(|graph| graph.div(*a, *b))
    }
    fn neg(&self, a: &NodeId) -> Result<NodeId, Refusal> {
        self.build(|graph| graph.neg(*a))
    }
    fn apply(&self, function: Function, a: &NodeId) -> Result<NodeId, Refusal> {
        self.build(|graph| graph.apply(function, *a))
    }
    /// Known of constants alone.
    fn is_zero(&self, a: &NodeId) -> Option<bool> {
        self.0.try_borrow().ok()?.constant_value(*a).map(RBig::is_zero)
    }
    fn power(&self, a: &NodeId, n: i32) -> Result<NodeId, Refusal> {
        if n < 0 && self.is_zero(a) == Some(true) {
            return Err(Refusal::DivisionByZero);
        }
        self.build(|graph| graph.power(*a, n))
    }
}
