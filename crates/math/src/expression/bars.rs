//! Products in which an absolute value stands to a power, `x*abs(x)`, `abs(x)^3`: they have a derivative where the rule of products, which
//! differentiates each factor by itself, finds none.
//!
//! `u^n |u|^m` has the derivative `(n + m) u^(n-1) |u|^m` everywhere as soon as `n + m` is two or more, zero included.

use super::graph::{Graph, Node, NodeId};
use crate::number::Function;

/// Products of more factors are differentiated factor by factor.
const MOST_FACTORS: usize = 16;

/// A factor of a product, with what it is differentiated by.
pub(super) struct FactorSlope {
    /// The node that the factor is made of.
    pub of: NodeId,
    /// The derivative of the whole product by that node.
    pub slope: NodeId,
}

/// A factor: a plain power, or one of an absolute value.
#[derive(Clone, Copy)]
struct Power {
    base: NodeId,
    plain: i32,
    bars: i32,
}

/// The derivatives of a product by what its factors are made of, so that they exist where an absolute value to a power has one. `None` where
/// no factor is such a power, and the ordinary rules say as much.
pub(super) fn slopes_of_factors(graph: &mut Graph, id: NodeId) -> Option<Vec<FactorSlope>> {
    if !matches!(graph.node(id), Node::Mul(..) | Node::Power(..) | Node::Apply(Function::Sqrt, _)) {
        return None;
    }
    let powers = powers(graph, id)?;
    let is_smooth = |power: &Power| power.bars > 0 && power.plain + power.bars > 1;
    if !powers.iter().any(is_smooth) {
        return None;
    }
    let values: Vec<NodeId> = powers.iter().map(|power| power.value(graph)).collect();
    let mut found = Vec::new();
    for (place, power) in powers.iter().enumerate() {
        let (of, own) = power.slope(graph, values[place]);
        let others = values.iter().enumerate().filter(|(other, _)| *other != place);
        let slope = others.fold(own, |product, (_, value)| graph.mul(product, *value));
        found.push(FactorSlope { of, slope });
    }
    Some(found)
}

/// The factors of a product, each base once. `None` where there are too many, or no absolute value is met.
fn powers(graph: &Graph, id: NodeId) -> Option<Vec<Power>> {
    let (mut open, mut found, mut bars) = (vec![(id, 1_i32)], Vec::<Power>::new(), false);
    while let Some((node, exponent)) = open.pop() {
        let (base, plain, barred) = match graph.node(node) {
            Node::Mul(a, b) => {
                open.extend([(b, exponent), (a, exponent)]);
                continue;
            }
            Node::Power(a, n) if n > 0 => {
                open.push((a, exponent.checked_mul(n)?));
                continue;
            }
            Node::Apply(Function::Sqrt, square) => match graph.node(square) {
                Node::Power(base, n) if n > 0 && n % 2 == 0 => (base, 0, exponent.checked_mul(n / 2)?),
                _ => (node, exponent, 0),
            },
            _ => (node, exponent, 0),
        };
        bars |= barred > 0;
        match found.iter_mut().find(|power| power.base == base) {
            Some(power) => {
                power.plain = power.plain.checked_add(plain)?;
                power.bars = power.bars.checked_add(barred)?;
            }
            None => found.push(Power { base, plain, bars: barred }),
        }
        if found.len() > MOST_FACTORS || open.len() > MOST_FACTORS {
            return None;
        }
    }
    bars.then_some(found)
}

impl Power {
    fn value(self, graph: &mut Graph) -> NodeId {
        let bars = graph.absolute(self.base);
        let (plain, bars) = (graph.power(self.base, self.plain), graph.power(bars, self.bars));
        graph.mul(plain, bars)
    }

    /// A node and the derivative of the power by it.
    fn slope(self, graph: &mut Graph, value: NodeId) -> (NodeId, NodeId) {
        let Power { base, plain, bars } = self;
        if bars == 1 && plain == 0 {
            // it has none at zero
            return (value, graph.integer(1));
        }
        let factor = graph.integer(i64::from(plain) + i64::from(bars));
        // of two bars one square is taken out
        let (plain, bars) = if plain == 0 && bars > 0 { (2, bars - 2) } else { (plain, bars) };
        let lower = Power { base, plain: plain - 1, bars }.value(graph);
        (base, graph.mul(factor, lower))
    }
}
