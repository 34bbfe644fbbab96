//! Signs that can be read off an expression: squares, sums of what is not negative, exponentials. What no rule covers has no
//! known sign; nothing is computed.

use super::graph::{Graph, Node, NodeId};
use crate::number::Function;
use dashu::rational::RBig;
use std::collections::HashMap;

/// What is known of the sign of an expression, wherever it has a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Above zero.
    Positive,
    /// Zero or above.
    NotNegative,
    /// Below zero.
    Negative,
    /// Zero or below.
    NotPositive,
}

impl Sign {
    /// The sign of the negative.
    pub fn negated(self) -> Sign {
        match self {
            Sign::Positive => Sign::Negative,
            Sign::NotNegative => Sign::NotPositive,
            Sign::Negative => Sign::Positive,
            Sign::NotPositive => Sign::NotNegative,
        }
    }

    /// Whether zero is excluded.
    pub fn is_strict(self) -> bool {
        matches!(self, Sign::Positive | Sign::Negative)
    }

    /// Whether it is not negative, for all that is known.
    pub fn is_upward(self) -> bool {
        matches!(self, Sign::Positive | Sign::NotNegative)
    }

    /// The sign of what is not negative (`upward`) or not positive, and not zero where that is `strict`.
    pub fn new(upward: bool, strict: bool) -> Sign {
        match (upward, strict) {
            (true, true) => Sign::Positive,
            (true, false) => Sign::NotNegative,
            (false, true) => Sign::Negative,
            (false, false) => Sign::NotPositive,
        }
    }
}

/// The sign of an expression at all values of its symbols at which it exists, where a rule gives it.
pub fn sign(graph: &Graph, root: NodeId) -> Option<Sign> {
    sign_given(graph, root, &HashMap::new())
}

/// The same where some expressions, symbols for example, are known to have a sign.
pub fn sign_given(graph: &Graph, root: NodeId, given: &HashMap<NodeId, Sign>) -> Option<Sign> {
    let mut known: HashMap<NodeId, Sign> = HashMap::new();
    for id in graph.reachable([root]) {
        let (found, given) = (rule(graph, id, &known), given.get(&id).copied());
        // what excludes zero says more
        if let Some(sign) = given.filter(|sign| sign.is_strict()).or(found).or(given) {
            known.insert(id, sign);
        }
    }
    known.get(&root).copied()
}

fn rule(graph: &Graph, id: NodeId, known: &HashMap<NodeId, Sign>) -> Option<Sign> {
    let of = |operand: NodeId| known.get(&operand).copied();
    match graph.node(id) {
        Node::Constant(_) => match graph.constant_value(id)?.cmp(&RBig::ZERO) {
            std::cmp::Ordering::Greater => Some(Sign::Positive),
            std::cmp::Ordering::Equal => Some(Sign::NotNegative),
            std::cmp::Ordering::Less => Some(Sign::Negative),
        },
        Node::Pi => Some(Sign::Positive),
        Node::Symbol(_) => None,
        Node::Neg(a) => of(a).map(Sign::negated),
        Node::Add(a, b) => sum(of(a)?, of(b)?),
        Node::Sub(a, b) => sum(of(a)?, of(b)?.negated()),
        Node::Mul(a, b) | Node::Div(a, b) => {
            let (a, b) = (of(a)?, of(b)?);
            Some(Sign::new(a.is_upward() == b.is_upward(), a.is_strict() && b.is_strict()))
        }
        // a negative power exists only where its base is not zero
        Node::Power(a, n) if n % 2 == 0 => Some(Sign::new(true, n < 0 || of(a).is_some_and(Sign::is_strict))),
        Node::Power(a, n) => of(a).map(|sign| Sign::new(sign.is_upward(), n < 0 || sign.is_strict())),
        Node::Apply(Function::Exp, _) => Some(Sign::Positive),
        Node::Apply(Function::Sqrt, a) => Some(Sign::new(true, of(a) == Some(Sign::Positive))),
        Node::Apply(Function::Acos, _) => Some(Sign::NotNegative),
        Node::Apply(Function::Atan | Function::Asin, a) => of(a),
        Node::Apply(..) => None,
    }
}

fn sum(a: Sign, b: Sign) -> Option<Sign> {
    (a.is_upward() == b.is_upward()).then(|| Sign::new(a.is_upward(), a.is_strict() || b.is_strict()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_sums_and_exponentials_have_signs() {
        let mut graph = Graph::default();
        let [x, y] = ["x", "y"].map(|name| {
            let symbol = graph.intern(name);
            graph.symbol(symbol)
        });
        let one = graph.integer(1);
        let square = graph.power(x, 2);
        assert_eq!(sign(&graph, square), Some(Sign::NotNegative));
        let shifted = graph.add(square, one);
        assert_eq!(sign(&graph, shifted), Some(Sign::Positive));
        let low = graph.neg(shifted);
        let low = graph.sub(low, square);
        assert_eq!(sign(&graph, low), Some(Sign::Negative));
        let wave = graph.apply(Function::Exp, y);
        let product = graph.mul(wave, low);
        assert_eq!(sign(&graph, product), Some(Sign::Negative));
        let open = graph.add(square, y);
        assert_eq!(sign(&graph, open), None);
        let difference = graph.sub(shifted, one);
        assert_eq!(sign(&graph, difference), None, "nothing is computed");
    }
}
