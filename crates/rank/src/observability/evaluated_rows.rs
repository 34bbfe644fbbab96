//! Rows of differentials at some random points of a locus, each row evaluated once however many are asked for later: what is shared by expressions is evaluated once too.

use super::elimination::independent_rows;
use palmistry_budget as budget;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{Graph, Node, NodeId};
use palmistry_math::number::{Arithmetic, PrimeField};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::HashMap;

/// So many points, each modulo a prime of its own.
const POINTS: usize = 2;

/// A point, with what was evaluated at it.
struct Place {
    field: PrimeField,
    rng: ChaCha8Rng,
    values: HashMap<NodeId, u64>,
    rows: Vec<Vec<u64>>,
}

/// Rows of rational functions at some points.
pub(super) struct EvaluatedRows {
    places: Vec<Place>,
}

impl EvaluatedRows {
    /// No rows. None where angles are met, which are no variables of rational functions.
    pub fn new(system: &System) -> Option<EvaluatedRows> {
        let mut rng = ChaCha8Rng::seed_from_u64(0x0072_6f77_7365); // any fixed seed: the rows do not depend on the user's
        let mut place = |number: u64| {
            let field = PrimeField::random(&mut rng);
            let rng = ChaCha8Rng::seed_from_u64(number);
            Place { field, rng, values: HashMap::new(), rows: Vec::new() }
        };
        system
            .angles()
            .is_empty()
            .then(|| EvaluatedRows { places: (0..POINTS as u64).map(&mut place).collect() })
    }

    /// Takes rows. None where they have no values: a function is met, or every point is a pole.
    pub fn push(&mut self, graph: &Graph, rows: &[Vec<NodeId>], conditions: &Assignment) -> Option<()> {
        self.places.retain_mut(|place| {
            rows.iter().all(|row| {
                let row: Option<Vec<u64>> =
                    row.iter().map(|entry| place.value(graph, *entry, conditions)).collect();
                row.map(|row| place.rows.push(row)).is_some()
            })
        });
        (!self.places.is_empty()).then_some(())
    }

    /// Which rows raise the rank, at the point where these are most.
    pub fn independent(&self) -> Option<Vec<usize>> {
        let of = |place: &Place| independent_rows(&place.field, &place.rows).ok();
        self.places.iter().filter_map(of).max_by_key(Vec::len)
    }

    /// Keeps these rows alone.
    pub fn keep(&mut self, kept: &[usize]) {
        for place in &mut self.places {
            place.rows = kept.iter().map(|row| place.rows[*row].clone()).collect();
        }
    }
}

impl Place {
    /// The value of an expression, where it is a rational function that has one.
    fn value(&mut self, graph: &Graph, root: NodeId, conditions: &Assignment) -> Option<u64> {
        let mut waiting = vec![root];
        while let Some(id) = waiting.last().copied() {
            if self.values.contains_key(&id) {
                waiting.pop();
                continue;
            }
            let node = graph.node(id);
            let given = match node {
                Node::Symbol(symbol) => conditions.get(&symbol).copied(),
                _ => None,
            };
            let missing: Vec<NodeId> =
                node.operands().chain(given).filter(|operand| !self.values.contains_key(operand)).collect();
            if !missing.is_empty() {
                waiting.extend(missing);
                continue;
            }
            budget::steps(1);
            let value = match (node, given) {
                (_, Some(given)) => self.values[&given],
                (Node::Symbol(_), None) => self.field.draw(&mut self.rng),
                _ => self.operation(graph, id, node)?,
            };
            self.values.insert(id, value);
            waiting.pop();
        }
        self.values.get(&root).copied()
    }

    fn operation(&self, graph: &Graph, id: NodeId, node: Node) -> Option<u64> {
        let (field, at) = (&self.field, |operand: NodeId| self.values[&operand]);
        match node {
            Node::Constant(_) => field.rational(graph.constant_value(id)?).ok(),
            Node::Add(a, b) => field.add(&at(a), &at(b)).ok(),
            Node::Sub(a, b) => field.sub(&at(a), &at(b)).ok(),
            Node::Mul(a, b) => field.mul(&at(a), &at(b)).ok(),
            Node::Div(a, b) => field.div(&at(a), &at(b)).ok(),
            Node::Neg(a) => field.neg(&at(a)).ok(),
            Node::Power(a, n) => {
                let mut base = if n < 0 { field.inverse(at(a))? } else { at(a) };
                let (mut left, mut power) = (n.unsigned_abs(), field.one());
                while left > 0 {
                    if left % 2 == 1 {
                        power = field.product(power, base);
                    }
                    base = field.product(base, base);
                    left /= 2;
                }
                Some(power)
            }
            Node::Pi | Node::Symbol(_) | Node::Apply(..) => None,
        }
    }
}
