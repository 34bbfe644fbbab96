//! Functions that are made of others, exactly: absolute values, hyperbolic functions, real powers, the angle of a point.
//!
//! | written | is | exists where | has derivatives where |
//! |---|---|---|---|
//! | `abs(x)` | `sqrt(x^2)` | everywhere | `x` is not zero |
//! | `sign(x)` | `x/sqrt(x^2)` | `x` is not zero | there |
//! | `min(x, y)`, `max(x, y)` | `(x + y - abs(x - y))/2`, `(x + y + abs(x - y))/2` | everywhere | `x` is not `y` |
//! | `sinh(x)`, `cosh(x)` | `(exp(x) - exp(-x))/2`, `(exp(x) + exp(-x))/2` | everywhere | everywhere |
//! | `tanh(x)` | `1 - 2/(exp(2 x) + 1)` | everywhere | everywhere |
//! | `atan2(y, x)` | `2 atan(y/(sqrt(x^2 + y^2) + x))` | off `y = 0`, `x <= 0` | there |
//! | `x^n` | `exp(n log(x))` | `x` is positive | there |
//!
//! So whatever is known of roots, exponentials, logarithms and inverse tangents is known of them, in every arithmetic and by the
//! checker. [`Graph::text`] writes them as they were written.

use super::graph::{Graph, Node, NodeId};
use crate::number::Function;
use dashu::rational::RBig;

/// The names of the functions, each with the least and the largest number of its arguments.
pub const COMPOSED: [(&str, usize, usize); 8] = [
    ("abs", 1, 1),
    ("sign", 1, 1),
    ("min", 2, usize::MAX),
    ("max", 2, usize::MAX),
    ("sinh", 1, 1),
    ("cosh", 1, 1),
    ("tanh", 1, 1),
    ("atan2", 2, 2),
];

/// An expression as it may have been written.
pub(crate) enum Written {
    /// A function of the table above, of its arguments.
    Call(&'static str, Vec<NodeId>),
    /// `base^exponent`, the exponent negated where it is said so.
    Power { base: NodeId, exponent: NodeId, negated: bool },
}

impl Graph {
    /// `|a|`
    pub fn absolute(&mut self, a: NodeId) -> NodeId {
        let square = self.power(a, 2);
        self.apply(Function::Sqrt, square)
    }

    /// The greater (`true`) or the smaller of two.
    pub fn extreme(&mut self, a: NodeId, b: NodeId, greater: bool) -> NodeId {
        let (sum, difference) = (self.add(a, b), self.sub(a, b));
        let distance = self.absolute(difference);
        let twice = if greater { self.add(sum, distance) } else { self.sub(sum, distance) };
        let two = self.integer(2);
        self.div(twice, two)
    }

    /// `sinh`, `cosh` or `tanh` of an expression.
    pub fn hyperbolic(&mut self, name: &str, a: NodeId) -> NodeId {
        let (one, two) = (self.integer(1), self.integer(2));
        if name == "tanh" {
            let double = self.mul(two, a);
            let power = self.apply(Function::Exp, double);
            let bottom = self.add(power, one);
            let part = self.div(two, bottom);
            return self.sub(one, part);
        }
        let back = self.neg(a);
        let (up, down) = (self.apply(Function::Exp, a), self.apply(Function::Exp, back));
        let twice = if name == "sinh" { self.sub(up, down) } else { self.add(up, down) };
        self.div(twice, two)
    }

    /// `sqrt(x^2 + y^2) + x`, what the tangent of half the angle of a point is divided by.
    pub fn half_angle_divisor(&mut self, y: NodeId, x: NodeId) -> NodeId {
        let squares = [self.power(x, 2), self.power(y, 2)];
        let sum = self.add(squares[0], squares[1]);
        let distance = self.apply(Function::Sqrt, sum);
        self.add(distance, x)
    }

    /// The angle of the point `(x, y)` from the positive `x` axis, between minus and plus pi.
    pub fn angle_of_point(&mut self, y: NodeId, x: NodeId) -> NodeId {
        let divisor = self.half_angle_divisor(y, x);
        let tangent = self.div(y, divisor);
        let half = self.apply(Function::Atan, tangent);
        let two = self.integer(2);
        self.mul(two, half)
    }

    /// `base^exponent` for a positive base.
    pub fn real_power(&mut self, base: NodeId, exponent: NodeId) -> NodeId {
        let logarithm = self.apply(Function::Log, base);
        let product = self.mul(exponent, logarithm);
        self.apply(Function::Exp, product)
    }

    /// What an expression may have been written as, where it is one of the table above.
    pub(crate) fn written(&self, id: NodeId) -> Option<Written> {
        let call = |name, arguments: &[NodeId]| Some(Written::Call(name, arguments.to_vec()));
        match self.node(id) {
            Node::Apply(Function::Sqrt, square) => call("abs", &[self.base_of_square(square)?]),
            Node::Apply(Function::Exp, exponent) => self.written_power(exponent),
            Node::Div(a, b) if self.under_bars(b) == Some(a) => call("sign", &[a]),
            Node::Div(twice, two) if self.is_number(two, 2) => self.written_half(twice),
            Node::Sub(one, part) if self.is_number(one, 1) => {
                let Node::Div(two, bottom) = self.node(part) else { return None };
                let Node::Add(x, y) = self.node(bottom) else { return None };
                let power = if self.is_number(x, 1) { y } else { x };
                let one = if power == y { x } else { y };
                let Node::Apply(Function::Exp, double) = self.node(power) else { return None };
                let argument = self.other_factor(double, |graph, id| graph.is_number(id, 2))?;
                (self.is_number(one, 1) && self.is_number(two, 2)).then_some(())?;
                call("tanh", &[argument])
            }
            Node::Mul(..) => {
                let half = self.other_factor(id, |graph, id| graph.is_number(id, 2))?;
                let Node::Apply(Function::Atan, tangent) = self.node(half) else { return None };
                let Node::Div(y, divisor) = self.node(tangent) else { return None };
                let Node::Add(a, b) = self.node(divisor) else { return None };
                let x = [(a, b), (b, a)].into_iter().find_map(|(root, x)| {
                    let Node::Apply(Function::Sqrt, sum) = self.node(root) else { return None };
                    let Node::Add(p, q) = self.node(sum) else { return None };
                    let squares = (self.base_of_square(p)?, self.base_of_square(q)?);
                    (squares == (x, y) || squares == (y, x)).then_some(x)
                })?;
                call("atan2", &[y, x])
            }
            _ => None,
        }
    }

    fn is_number(&self, id: NodeId, value: i8) -> bool {
        self.constant_value(id).is_some_and(|known| *known == RBig::from(value))
    }

    fn base_of_square(&self, id: NodeId) -> Option<NodeId> {
        match self.node(id) {
            Node::Power(base, 2) => Some(base),
            _ => None,
        }
    }

    /// What an absolute value is taken of.
    fn under_bars(&self, id: NodeId) -> Option<NodeId> {
        match self.node(id) {
            Node::Apply(Function::Sqrt, square) => self.base_of_square(square),
            _ => None,
        }
    }

    /// The factor beside one that is as asked for.
    fn other_factor(&self, id: NodeId, is_asked: impl Fn(&Graph, NodeId) -> bool) -> Option<NodeId> {
        match self.node(id) {
            Node::Mul(a, b) if is_asked(self, a) => Some(b),
            Node::Mul(a, b) if is_asked(self, b) => Some(a),
            _ => None,
        }
    }

    /// `exp(n log(x))` as a power.
    fn written_power(&self, exponent: NodeId) -> Option<Written> {
        let (product, negated) = match self.node(exponent) {
            Node::Neg(inner) => (inner, true),
            _ => (exponent, false),
        };
        let Node::Mul(a, b) = self.node(product) else { return None };
        [(b, a), (a, b)].into_iter().find_map(|(logarithm, exponent)| match self.node(logarithm) {
            Node::Apply(Function::Log, base) => Some(Written::Power { base, exponent, negated }),
            _ => None,
        })
    }

    /// Half of a sum or a difference: an extreme, a hyperbolic sine or cosine.
    fn written_half(&self, twice: NodeId) -> Option<Written> {
        let exponent = |id| match self.node(id) {
            Node::Apply(Function::Exp, exponent) => Some(exponent),
            _ => None,
        };
        let (a, b, sum) = match self.node(twice) {
            Node::Add(a, b) => (a, b, true),
            Node::Sub(a, b) => (a, b, false),
            _ => return None,
        };
        if let (Some(up), Some(down)) = (exponent(a), exponent(b)) {
            let opposite = |x, y| matches!(self.node(y), Node::Neg(inner) if inner == x);
            let name = if sum { "cosh" } else { "sinh" };
            return match (opposite(up, down), opposite(down, up)) {
                (true, _) => Some(Written::Call(name, vec![up])),
                (_, true) if sum => Some(Written::Call(name, vec![down])),
                _ => None,
            };
        }
        let name = if sum { "max" } else { "min" };
        let sides = if sum { [(a, b), (b, a)] } else { [(a, b), (a, b)] };
        sides.into_iter().find_map(|(total, distance)| {
            let difference = self.under_bars(distance)?;
            let Node::Sub(p, q) = self.node(difference) else { return None };
            let is_sum = matches!(self.node(total), Node::Add(x, y) if (x, y) == (p, q) || (x, y) == (q, p));
            is_sum.then(|| Written::Call(name, vec![p, q]))
        })
    }
}
