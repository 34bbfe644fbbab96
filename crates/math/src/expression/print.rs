//! An expression of the graph as text, for messages.

use super::composed::Written;
use super::graph::{Graph, Node, NodeId};

/// Longer texts than this are not written: nobody reads them, and an expression whose parts are shared many times over may
/// have a text that fits no memory.
const LONGEST: usize = 4000;

/// How tightly an expression holds together.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    Product,
    Power,
    Atom,
}

/// What is still to be written.
enum Pending {
    Sign(&'static str),
    Exponent(String),
    Expression(NodeId, Binding),
}

impl Graph {
    /// The expression in the notation of the proof language, whole. Where its text would be longer than anybody reads, it is
    /// described instead: never cut, since a part of a formula is another formula.
    pub fn text(&self, id: NodeId) -> String {
        let mut out = String::new();
        let mut pending = vec![Pending::Expression(id, Binding::Sum)];
        while let Some(next) = pending.pop() {
            match next {
                Pending::Sign(sign) => out.push_str(sign),
                Pending::Exponent(exponent) => out.push_str(&exponent),
                Pending::Expression(id, around) => self.write(id, around, &mut pending, &mut out),
            }
            if out.len() > LONGEST {
                return self.description(id);
            }
        }
        out
    }

    /// An expression that is too long to write.
    fn description(&self, id: NodeId) -> String {
        let names: Vec<&str> =
            self.symbols_of([id]).into_iter().map(|symbol| self.symbol_name(symbol)).collect();
        format!("(an expression of {} operations in {})", self.reachable([id]).len(), names.join(", "))
    }

    /// Writes what comes first and leaves the rest pending, so that no depth of an expression exhausts the stack.
    fn write(&self, id: NodeId, around: Binding, pending: &mut Vec<Pending>, out: &mut String) {
        let written = self.written(id);
        let binding = match written {
            Some(Written::Call(..)) => Binding::Atom,
            Some(Written::Power { .. }) => Binding::Power,
            None => self.binding(id),
        };
        if binding < around {
            out.push('(');
            pending.push(Pending::Sign(")"));
        }
        match written {
            Some(Written::Call(name, arguments)) => {
                out.push_str(name);
                out.push('(');
                pending.push(Pending::Sign(")"));
                for (place, argument) in arguments.into_iter().enumerate().rev() {
                    pending.push(Pending::Expression(argument, Binding::Sum));
                    if place > 0 {
                        pending.push(Pending::Sign(", "));
                    }
                }
                return;
            }
            Some(Written::Power { base, exponent, negated }) => {
                let least = if negated { Binding::Product } else { Binding::Atom };
                if negated {
                    pending.push(Pending::Sign(")"));
                }
                pending.push(Pending::Expression(exponent, least));
                pending.push(Pending::Sign(if negated { "^(-" } else { "^" }));
                pending.push(Pending::Expression(base, Binding::Atom));
                return;
            }
            None => {}
        }
        let mut two = |a: NodeId, left: Binding, sign: &'static str, b: NodeId, right: Binding| {
            pending.push(Pending::Expression(b, right));
            pending.push(Pending::Sign(sign));
            pending.push(Pending::Expression(a, left));
        };
        match self.node(id) {
            Node::Constant(index) => out.push_str(&self.constant_at(index).to_string()),
            Node::Pi => out.push_str("pi"),
            Node::Symbol(symbol) => out.push_str(self.symbol_name(symbol)),
            Node::Add(a, b) => two(a, Binding::Sum, " + ", b, Binding::Product),
            Node::Sub(a, b) => two(a, Binding::Sum, " - ", b, Binding::Product),
            Node::Mul(a, b) => two(a, Binding::Product, "*", b, Binding::Power),
            Node::Div(a, b) => two(a, Binding::Product, "/", b, Binding::Power),
            Node::Neg(a) => {
                out.push('-');
                pending.push(Pending::Expression(a, Binding::Product));
            }
            Node::Power(a, n) => {
                let exponent = if n < 0 { format!("^({n})") } else { format!("^{n}") };
                pending.push(Pending::Exponent(exponent));
                pending.push(Pending::Expression(a, Binding::Atom));
            }
            Node::Apply(function, a) => {
                out.push_str(function.name());
                out.push('(');
                pending.push(Pending::Sign(")"));
                pending.push(Pending::Expression(a, Binding::Sum));
            }
        }
    }

    fn binding(&self, id: NodeId) -> Binding {
        match self.node(id) {
            Node::Add(..) | Node::Sub(..) | Node::Neg(_) => Binding::Sum,
            Node::Mul(..) | Node::Div(..) => Binding::Product,
            Node::Power(..) => Binding::Power,
            Node::Constant(index) => {
                let value = self.constant_at(index);
                if !value.denominator().is_one() {
                    Binding::Product
                } else if *value < dashu::rational::RBig::ZERO {
                    Binding::Sum
                } else {
                    Binding::Atom
                }
            }
            Node::Pi | Node::Symbol(_) | Node::Apply(..) => Binding::Atom,
        }
    }
}
