//! Sines and cosines of sums of angles, written by the addition theorems in sines and cosines of the angles
//! themselves.
//!
//! After this an angle is met only as the pair of its sine and cosine, which a rational tangent of the half angle
//! makes rational: `sin = 2t/(1+t^2)`, `cos = (1-t^2)/(1+t^2)`. Quarter turns (`pi/2` and its multiples) are exact too.

use super::graph::{Graph, Node, NodeId, Symbol};
use crate::number::Function;
use dashu::integer::IBig;
use dashu::rational::RBig;
use std::collections::{BTreeMap, HashMap};

/// `sum of n_i angle_i + quarters * pi/2`, integers throughout.
#[derive(Clone, Default)]
struct Combination {
    angles: BTreeMap<Symbol, i64>,
    quarters: i64,
}

/// Multiples of an angle beyond this are left alone: their expansion would be longer than it is useful.
const LARGEST_MULTIPLE: i64 = 64;

/// Rewrites each sine and cosine whose argument is an integer combination of angles and quarter turns.
pub fn expand_angles(graph: &mut Graph, roots: &[NodeId], is_angle: impl Fn(Symbol) -> bool) -> Vec<NodeId> {
    expand(graph, roots, &is_angle)
}

/// Compiled once, and not for every closure.
fn expand(graph: &mut Graph, roots: &[NodeId], is_angle: &dyn Fn(Symbol) -> bool) -> Vec<NodeId> {
    let order = graph.reachable(roots.iter().copied());
    let mut combinations: HashMap<NodeId, Combination> = HashMap::new();
    for &id in &order {
        if let Some(combination) = combine(graph, id, &combinations, is_angle) {
            combinations.insert(id, combination);
        }
    }
    let mut image: HashMap<NodeId, NodeId> = HashMap::new();
    for id in order {
        let node = graph.node(id);
        let new = match node {
            Node::Apply(function @ (Function::Sin | Function::Cos), argument) => {
                match combinations.get(&argument) {
                    Some(combination) => {
                        let (sine, cosine) = sine_cosine(graph, combination);
                        if function == Function::Sin { sine } else { cosine }
                    }
                    None => graph.rebuild(node, |operand| image[&operand]),
                }
            }
            _ => graph.rebuild(node, |operand| image[&operand]),
        };
        image.insert(id, new);
    }
    roots.iter().map(|root| image[root]).collect()
}

/// A node as a combination of angles, if it is one.
fn combine(
    graph: &Graph,
    id: NodeId,
    known: &HashMap<NodeId, Combination>,
    is_angle: &dyn Fn(Symbol) -> bool,
) -> Option<Combination> {
    let combination = match graph.node(id) {
        Node::Symbol(symbol) if is_angle(symbol) => {
            Combination { angles: BTreeMap::from([(symbol, 1)]), quarters: 0 }
        }
        Node::Constant(_) if graph.constant_value(id)?.is_zero() => Combination::default(),
        Node::Pi => Combination { angles: BTreeMap::new(), quarters: 2 },
        Node::Add(a, b) => sum(known.get(&a)?, known.get(&b)?, 1)?,
        Node::Sub(a, b) => sum(known.get(&a)?, known.get(&b)?, -1)?,
        Node::Neg(a) => sum(&Combination::default(), known.get(&a)?, -1)?,
        Node::Mul(a, b) => match (graph.constant_value(a), graph.constant_value(b)) {
            (Some(factor), None) => scale(known.get(&b)?, factor)?,
            (None, Some(factor)) => scale(known.get(&a)?, factor)?,
            _ => return None,
        },
        Node::Div(a, b) => {
            scale(known.get(&a)?, &(RBig::ONE / graph.constant_value(b).filter(|c| !c.is_zero())?))?
        }
        _ => return None,
    };
    let small = combination.angles.values().all(|n| n.abs() <= LARGEST_MULTIPLE);
    small.then_some(combination)
}

fn sum(a: &Combination, b: &Combination, sign: i64) -> Option<Combination> {
    let mut total = a.clone();
    for (symbol, count) in &b.angles {
        let entry = total.angles.entry(*symbol).or_insert(0);
        *entry = entry.checked_add(sign * count)?;
    }
    total.angles.retain(|_, count| *count != 0);
    total.quarters = total.quarters.checked_add(sign * b.quarters)?;
    Some(total)
}

fn scale(a: &Combination, factor: &RBig) -> Option<Combination> {
    let times = |count: i64| -> Option<i64> {
        let product = RBig::from(count) * factor;
        if !product.denominator().is_one() {
            return None;
        }
        i64::try_from(IBig::clone(product.numerator())).ok().filter(|n| n.abs() < 1 << 32)
    };
    let mut angles = BTreeMap::new();
    for (symbol, count) in &a.angles {
        angles.insert(*symbol, times(*count)?);
    }
    angles.retain(|_, count| *count != 0);
    Some(Combination { angles, quarters: times(a.quarters)? })
}

/// The sine and the cosine of a combination.
fn sine_cosine(graph: &mut Graph, combination: &Combination) -> (NodeId, NodeId) {
    let (mut sine, mut cosine) = match combination.quarters.rem_euclid(4) {
        0 => (graph.integer(0), graph.integer(1)),
        1 => (graph.integer(1), graph.integer(0)),
        2 => (graph.integer(0), graph.integer(-1)),
        _ => (graph.integer(-1), graph.integer(0)),
    };
    for (&symbol, &count) in &combination.angles {
        let angle = graph.symbol(symbol);
        let unit = (graph.apply(Function::Sin, angle), graph.apply(Function::Cos, angle));
        (sine, cosine) = add_multiple(graph, (sine, cosine), unit, count);
    }
    (sine, cosine)
}

/// Sine and cosine of an angle and a whole multiple of another one.
pub(super) fn add_multiple(
    graph: &mut Graph,
    mut total: (NodeId, NodeId),
    mut unit: (NodeId, NodeId),
    count: i64,
) -> (NodeId, NodeId) {
    if count < 0 {
        unit.0 = graph.neg(unit.0);
    }
    for bit in (0..64).take_while(|bit| count.unsigned_abs() >> bit > 0) {
        if count.unsigned_abs() >> bit & 1 == 1 {
            total = addition(graph, total, unit);
        }
        unit = addition(graph, unit, unit);
    }
    total
}

/// `sin(a+b) = sin a cos b + cos a sin b`, `cos(a+b) = cos a cos b - sin a sin b`.
fn addition(graph: &mut Graph, a: (NodeId, NodeId), b: (NodeId, NodeId)) -> (NodeId, NodeId) {
    let (first, second) = (graph.mul(a.0, b.1), graph.mul(a.1, b.0));
    let sine = graph.add(first, second);
    let (first, second) = (graph.mul(a.1, b.1), graph.mul(a.0, b.0));
    (sine, graph.sub(first, second))
}
