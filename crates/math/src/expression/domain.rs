//! Where a term has a value: divisors, and the arguments of roots, logarithms and inverse sines.
//!
//! The graph simplifies as it is built, and what it simplifies may have a value where the term as it was written has none:
//! `0*log(x)` becomes zero, `1/(1/x)` becomes `x`. So whoever reads a term keeps its [`Guard`]s beside the value: the term
//! exists where all of them hold and the value can be computed, and nowhere else. Guards are never simplified away, other
//! than by a constant of which they hold.

use super::graph::{Graph, Node, NodeId, Symbol};
use super::sign::{Sign, sign};
use crate::number::{Enclosure, Function, Interval};
use dashu::rational::RBig;
use std::cmp::Ordering;
use std::collections::HashMap;

/// The condition on the operand of an operation for it to have a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Need {
    /// A divisor: not zero.
    NotZero,
    /// The argument of a logarithm: positive.
    Positive,
    /// The argument of a square root: not negative.
    NotNegative,
    /// The argument of an inverse sine or cosine: between minus one and one, both counted.
    WithinOne,
    /// The same, neither counted: where an inverse sine has a derivative.
    InsideOne,
}

/// An operand, and the condition that it has to meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Guard {
    /// The expression.
    pub node: NodeId,
    /// The condition.
    pub need: Need,
}

impl Need {
    /// What a function needs of its argument.
    pub fn of(function: Function) -> Option<Need> {
        match function {
            Function::Log => Some(Need::Positive),
            Function::Sqrt => Some(Need::NotNegative),
            Function::Asin | Function::Acos => Some(Need::WithinOne),
            Function::Sin | Function::Cos | Function::Atan | Function::Exp => None,
        }
    }

    /// What the operation needs to have derivatives of all orders, too.
    pub fn smooth(self) -> Need {
        match self {
            Need::NotNegative => Need::Positive,
            Need::WithinOne => Need::InsideOne,
            other => other,
        }
    }

    /// Whether an exact value meets it.
    pub fn is_met_by(self, value: &RBig) -> bool {
        let sign = value.cmp(&RBig::ZERO);
        let beside_one = || (value * value).cmp(&RBig::ONE);
        match self {
            Need::NotZero => sign != Ordering::Equal,
            Need::Positive => sign == Ordering::Greater,
            Need::NotNegative => sign != Ordering::Less,
            Need::WithinOne => beside_one() != Ordering::Greater,
            Need::InsideOne => beside_one() == Ordering::Less,
        }
    }

    /// Whether all values between two bounds meet it, or none does; `None` where some may and some may not.
    pub fn is_met_between(self, low: &RBig, high: &RBig) -> Option<bool> {
        let (zero, one) = (RBig::ZERO, RBig::ONE);
        let (all, none) = match self {
            Need::NotZero => (*low > zero || *high < zero, low.is_zero() && high.is_zero()),
            Need::Positive => (*low > zero, *high <= zero),
            Need::NotNegative => (*low >= zero, *high < zero),
            Need::WithinOne => (*low >= -one.clone() && *high <= one, *low > one || *high < -one.clone()),
            Need::InsideOne => (*low > -one.clone() && *high < one, *low >= one || *high <= -one.clone()),
        };
        if all { Some(true) } else { none.then_some(false) }
    }

    /// The same between two doubles. A bound that is not a number decides nothing.
    pub fn is_met_in(self, low: f64, high: f64) -> Option<bool> {
        let (all, none) = match self {
            Need::NotZero => (low > 0.0 || high < 0.0, low == 0.0 && high == 0.0),
            Need::Positive => (low > 0.0, high <= 0.0),
            Need::NotNegative => (low >= 0.0, high < 0.0),
            Need::WithinOne => (low >= -1.0 && high <= 1.0, low > 1.0 || high < -1.0),
            Need::InsideOne => (low > -1.0 && high < 1.0, low >= 1.0 || high <= -1.0),
        };
        if all { Some(true) } else { none.then_some(false) }
    }

    /// Whether an enclosed value meets it; `None` where the enclosure does not decide it.
    pub fn is_met_by_enclosure(self, value: &Enclosure) -> Option<bool> {
        self.is_met_between(&value.low(), &value.high())
    }

    /// The same of a value in an interval.
    pub fn is_met_by_interval(self, value: Interval) -> Option<bool> {
        self.is_met_in(value.low(), value.high())
    }
}

impl Guard {
    /// The guard in the notation of the proof language: `x + 1 != 0`, `x >= 0`.
    pub fn text(self, graph: &Graph) -> String {
        if let (Node::Neg(inner), Need::Positive | Need::NotNegative) = (graph.node(self.node), self.need) {
            let sign = if self.need == Need::Positive { "<" } else { "<=" };
            return format!("{} {sign} 0", graph.text(inner));
        }
        let operand = graph.text(self.node);
        match self.need {
            Need::NotZero => format!("{operand} != 0"),
            Need::Positive => format!("{operand} > 0"),
            Need::NotNegative => format!("{operand} >= 0"),
            Need::WithinOne => format!("-1 <= {operand} <= 1"),
            Need::InsideOne => format!("-1 < {operand} < 1"),
        }
    }

    /// Whether rules of sign show that it holds wherever its operand exists (`true`) or nowhere (`false`).
    pub fn is_obvious(self, graph: &Graph) -> Option<bool> {
        if let Some(known) = self.constant(graph) {
            return Some(known);
        }
        match (self.need, sign(graph, self.node)?) {
            (Need::NotZero, sign) if sign.is_strict() => Some(true),
            (Need::Positive, Sign::Positive) => Some(true),
            (Need::Positive, Sign::Negative | Sign::NotPositive) => Some(false),
            (Need::NotNegative, Sign::Positive | Sign::NotNegative) => Some(true),
            (Need::NotNegative, Sign::Negative) => Some(false),
            _ => None,
        }
    }

    /// Whether it is about a constant, and so holds everywhere or nowhere.
    pub fn constant(self, graph: &Graph) -> Option<bool> {
        graph.constant_value(self.node).map(|value| self.need.is_met_by(value))
    }
}

/// The guards with symbols replaced, each once; those of constants of which they hold are left out.
pub fn substitute_guards(
    graph: &mut Graph,
    guards: &[Guard],
    values: &HashMap<Symbol, NodeId>,
) -> Vec<Guard> {
    let nodes: Vec<NodeId> = guards.iter().map(|guard| guard.node).collect();
    let images = graph.substitute(&nodes, values);
    let mut found = Vec::new();
    for (guard, node) in guards.iter().zip(images) {
        add_guard(graph, &mut found, Guard { node, need: guard.need });
    }
    found
}

/// Adds a guard that is not yet there, unless it holds of a constant.
pub fn add_guard(graph: &Graph, guards: &mut Vec<Guard>, guard: Guard) {
    if guard.constant(graph) != Some(true) && !guards.contains(&guard) {
        guards.push(guard);
    }
}
