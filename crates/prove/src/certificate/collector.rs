//! The factors of one question, each of them once, and how they become tapes.

use super::boxes::FreeCoordinate;
use super::factor::Factor;
use super::slots::Slots;
use super::tape::{Role, Tape};
use palmistry_math::expression::{Graph, Need, Node, NodeId, Products, Symbol};
use palmistry_math::number::polynomial::Polynomial;
use palmistry_math::number::{Fraction, Interval};
use std::collections::HashMap;

/// Where the symbols of a system are.
#[derive(Clone)]
pub(super) struct Ranges {
    /// The sides of the box.
    pub free: Vec<FreeCoordinate>,
    /// What is known of the others.
    pub held: HashMap<Symbol, Interval>,
}

impl Ranges {
    pub fn role(&self, symbol: Symbol) -> Option<Role> {
        let free = self.free.iter().position(|coordinate| coordinate.symbol == symbol);
        free.map(Role::Free).or_else(|| self.held.get(&symbol).copied().map(Role::Held))
    }

    /// The coordinates that an expression depends on.
    pub fn coordinates_of(&self, graph: &Graph, node: NodeId) -> Vec<usize> {
        let symbols = graph.symbols_of([node]);
        (0..self.free.len()).filter(|place| symbols.contains(&self.free[*place].symbol)).collect()
    }

    /// The same with some coordinates only.
    pub fn only(&self, kept: impl Fn(usize) -> bool) -> Ranges {
        let free =
            self.free.iter().enumerate().filter(|(place, _)| kept(*place)).map(|(_, c)| c.clone()).collect();
        Ranges { free, held: self.held.clone() }
    }

    /// The tape of an expression.
    ///
    /// # Errors
    /// In words: a symbol has neither range nor value.
    pub fn tape(&self, graph: &Graph, node: NodeId, slots: &mut Slots) -> Result<Tape, String> {
        Tape::new(graph, node, |symbol| self.role(symbol), slots).map_err(|symbol| {
            let name = graph.symbol_name(symbol);
            format!(
                "nothing says where '{name}' is; give it a range in 'sample', a value in 'param', or a range with --box"
            )
        })
    }
}

/// A factor before it is a tape.
struct Expression {
    node: NodeId,
    witnesses: Vec<NodeId>,
    need: Need,
}

/// Collects factors.
#[derive(Default)]
pub(super) struct Collector {
    pub products: Products,
    expressions: Vec<Expression>,
    places: HashMap<(NodeId, Need), usize>,
    polynomials: HashMap<Polynomial, usize>,
    /// Factors that were met, to be tried on what is split next.
    pub known: Vec<Polynomial>,
    /// Sums that were met, and polynomials that they are multiples of.
    sums: Vec<(NodeId, Polynomial)>,
}

/// So many expressions are tried in the place of a factor.
const MOST_WITNESSES: usize = 2;

impl Collector {
    /// The place among the factors of an expression that has to be different from zero.
    pub fn expression(&mut self, node: NodeId) -> usize {
        self.needed(node, Need::NotZero)
    }

    /// The same of one that has to meet another need: to be not zero, positive or not negative.
    pub fn needed(&mut self, node: NodeId, need: Need) -> usize {
        if let Some(known) = self.places.get(&(node, need)) {
            return *known;
        }
        self.expressions.push(Expression { node, witnesses: Vec::new(), need });
        let place = self.expressions.len() - 1;
        self.places.insert((node, need), place);
        place
    }

    /// The place of a polynomial among the factors.
    pub fn polynomial(&mut self, graph: &mut Graph, polynomial: &Polynomial) -> usize {
        if let Some(known) = self.polynomials.get(polynomial) {
            return *known;
        }
        let node = self.products.node(graph, polynomial);
        let place = self.expression(node);
        if polynomial.len() > 1 {
            // multiples that bring in no further symbols
            let own = graph.symbols_of([node]);
            let is_multiple = |(sum, multiple): &&(NodeId, Polynomial)| {
                *sum != node
                    && graph.symbols_of([*sum]).iter().all(|symbol| own.contains(symbol))
                    && multiple.divide_exactly(polynomial).is_some()
            };
            let found = self.sums.iter().filter(is_multiple).map(|(sum, _)| *sum).take(MOST_WITNESSES);
            let mut witnesses: Vec<NodeId> = found.collect();
            let squares = self.products.in_squares(graph, polynomial);
            // the square of a root has become what the root is taken of, and may have cancelled in the one and not the other
            witnesses.extend(
                squares.filter(|form| graph.symbols_of([*form]).iter().all(|symbol| own.contains(symbol))),
            );
            self.expressions[place].witnesses = witnesses;
        }
        self.polynomials.insert(polynomial.clone(), place);
        place
    }

    /// Notes which sums are multiples of which polynomials.
    pub fn note(&mut self, graph: &Graph, nodes: &[(NodeId, Fraction)]) {
        for (node, value) in nodes {
            let is_sum = matches!(graph.node(*node), Node::Add(..) | Node::Sub(..));
            if !is_sum || self.sums.iter().any(|(known, _)| known == node) {
                continue;
            }
            for place in value.top.keys() {
                let factor = self.products.fractions().factor(*place);
                if factor.len() > 1 {
                    self.sums.push((*node, factor));
                }
            }
        }
    }

    /// The expression of a factor.
    pub fn node(&self, place: usize) -> NodeId {
        self.expressions[place].node
    }

    /// Some factors as tapes.
    ///
    /// # Errors
    /// In words: a symbol has neither range nor value.
    pub fn factors(
        &self,
        graph: &Graph,
        places: &[usize],
        ranges: &Ranges,
        slots: &mut Slots,
    ) -> Result<Vec<Factor>, String> {
        let mut factor = |place: &usize| {
            let expression = &self.expressions[*place];
            let tape = ranges.tape(graph, expression.node, slots)?;
            let witnesses = expression.witnesses.iter().map(|node| ranges.tape(graph, *node, slots));
            Ok(Factor {
                text: graph.text(expression.node),
                tape,
                witnesses: witnesses.collect::<Result<_, String>>()?,
                need: expression.need,
            })
        };
        places.iter().map(&mut factor).collect()
    }
}
