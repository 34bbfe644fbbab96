//! From nodes of a graph to a listing: one operation a node, operands first.

use super::doubt::Missing;
use super::listing::{Listing, Step};
use super::witness::{Requirement, RequirementKind, Sides, SidesRelation};
use dashu::rational::RBig;
use palmistry_math::expression::syntax::Relation;
use palmistry_math::expression::{Graph, Guard, Need, Node, NodeId};
use std::collections::HashMap;

/// A listing that grows as nodes are asked for.
#[derive(Debug)]
pub struct Lowering<'g> {
    graph: &'g Graph,
    listing: Listing,
    places: HashMap<NodeId, usize>,
}

impl<'g> Lowering<'g> {
    /// An empty listing.
    pub fn new(graph: &'g Graph) -> Self {
        Lowering::behind(graph, Listing::default())
    }

    /// A listing that goes on behind the operations of another one.
    pub fn behind(graph: &'g Graph, listing: Listing) -> Self {
        Lowering { graph, listing, places: HashMap::new() }
    }

    /// The place of a node's operation, and those of all that it needs.
    ///
    /// # Errors
    /// Where the listing becomes too long.
    pub fn place(&mut self, node: NodeId) -> Result<usize, Missing> {
        if let Some(known) = self.places.get(&node) {
            return Ok(*known);
        }
        // not by `Graph::reachable`, which is as long as the graph for each small term
        let mut open = vec![node];
        while let Some(&next) = open.last() {
            if self.places.contains_key(&next) {
                open.pop();
                continue;
            }
            let missing =
                self.graph.node(next).operands().filter(|operand| !self.places.contains_key(operand));
            let before = open.len();
            open.extend(missing.collect::<Vec<_>>());
            if open.len() == before {
                let step = self.step(next);
                let place = self.listing.push(step)?;
                self.places.insert(next, place);
                open.pop();
            }
        }
        self.places.get(&node).copied().ok_or(Missing::Place { place: self.listing.steps().len() })
    }

    /// The operation of a node whose operands have places.
    fn step(&self, node: NodeId) -> Step {
        let at = |operand: NodeId| self.places.get(&operand).copied().unwrap_or(usize::MAX);
        match self.graph.node(node) {
            Node::Constant(_) => Step::Constant(self.graph.constant_value(node).cloned().unwrap_or_default()),
            Node::Pi => Step::Pi,
            Node::Symbol(symbol) => Step::Symbol(self.graph.symbol_name(symbol).to_owned()),
            Node::Add(a, b) => Step::Add(at(a), at(b)),
            Node::Sub(a, b) => Step::Sub(at(a), at(b)),
            Node::Mul(a, b) => Step::Mul(at(a), at(b)),
            Node::Div(a, b) => Step::Div(at(a), at(b)),
            Node::Neg(a) => Step::Neg(at(a)),
            Node::Power(a, n) => Step::Power(at(a), n),
            Node::Apply(function, a) => Step::Apply(function, at(a)),
        }
    }

    /// The places of two nodes that are compared.
    ///
    /// # Errors
    /// Where the listing becomes too long.
    pub fn sides(&mut self, left: NodeId, relation: Relation, right: NodeId) -> Result<Sides, Missing> {
        let relation = match relation {
            Relation::Equal => SidesRelation::Equal,
            Relation::NotEqual => SidesRelation::NotEqual,
            Relation::Less => SidesRelation::Less,
            Relation::AtMost => SidesRelation::AtMost,
            Relation::Greater => SidesRelation::Greater,
            Relation::AtLeast => SidesRelation::AtLeast,
        };
        Ok(Sides { left: self.place(left)?, relation, right: self.place(right)? })
    }

    /// What a term needs to have a value.
    ///
    /// # Errors
    /// Where the listing becomes too long.
    pub fn requirement(&mut self, guard: Guard) -> Result<Requirement, Missing> {
        let kind = match guard.need {
            Need::NotZero => RequirementKind::NotZero,
            Need::Positive => RequirementKind::Positive,
            Need::NotNegative => RequirementKind::NotNegative,
            Need::WithinOne => RequirementKind::WithinOne,
            Need::InsideOne => RequirementKind::InsideOne,
        };
        Ok(Requirement { kind, step: self.place(guard.node)? })
    }

    /// A node that is to be zero, beside a zero.
    ///
    /// # Errors
    /// Where the listing becomes too long.
    pub fn vanishing(&mut self, node: NodeId) -> Result<Sides, Missing> {
        let left = self.place(node)?;
        let right = self.listing.push(Step::Constant(RBig::ZERO))?;
        Ok(Sides { left, relation: SidesRelation::Equal, right })
    }

    /// The listing.
    pub fn finish(self) -> Listing {
        self.listing
    }
}
