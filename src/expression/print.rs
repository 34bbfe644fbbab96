//! An expression of the graph as text, for messages.

use super::graph::{Graph, Node, NodeId};

/// Deeper than this an expression is cut short in a message.
const DEEPEST: usize = 24;
/// And longer than this.
const LONGEST: usize = 400;

/// How tightly an expression holds together.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    Product,
    Atom,
}

impl Graph {
    /// The expression in the notation of the proof language, cut short where it is long.
    pub fn text(&self, id: NodeId) -> String {
        let mut out = String::new();
        self.write(id, Binding::Sum, 0, &mut out);
        out
    }

    fn write(&self, id: NodeId, around: Binding, depth: usize, out: &mut String) {
        if depth > DEEPEST || out.len() > LONGEST {
            out.push_str("...");
            return;
        }
        let binding = match self.node(id) {
            Node::Add(..) | Node::Sub(..) | Node::Neg(_) => Binding::Sum,
            Node::Mul(..) | Node::Div(..) => Binding::Product,
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
            _ => Binding::Atom,
        };
        let brackets = binding < around;
        if brackets {
            out.push('(');
        }
        let mut two = |a: NodeId, left: Binding, sign: &str, b: NodeId, right: Binding| {
            self.write(a, left, depth + 1, out);
            out.push_str(sign);
            self.write(b, right, depth + 1, out);
        };
        match self.node(id) {
            Node::Constant(index) => out.push_str(&self.constant_at(index).to_string()),
            Node::Pi => out.push_str("pi"),
            Node::Symbol(symbol) => out.push_str(self.symbol_name(symbol)),
            Node::Add(a, b) => two(a, Binding::Sum, " + ", b, Binding::Product),
            Node::Sub(a, b) => two(a, Binding::Sum, " - ", b, Binding::Product),
            Node::Mul(a, b) => two(a, Binding::Product, "*", b, Binding::Atom),
            Node::Div(a, b) => two(a, Binding::Product, "/", b, Binding::Atom),
            Node::Neg(a) => {
                out.push('-');
                self.write(a, Binding::Product, depth + 1, out);
            }
            Node::Power(a, n) => {
                self.write(a, Binding::Atom, depth + 1, out);
                out.push_str(&if n < 0 { format!("^({n})") } else { format!("^{n}") });
            }
            Node::Apply(function, a) => {
                out.push_str(function.name());
                out.push('(');
                self.write(a, Binding::Sum, depth + 1, out);
                out.push(')');
            }
        }
        if brackets {
            out.push(')');
        }
    }
}
