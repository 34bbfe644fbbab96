//! What a question is, as a number: two that differ in anything that the answer depends on have different numbers, but for one
//! chance in 2^64.

use super::asked::RankQuestion;
use crate::observability::OWN_ROWS;
use dashu::rational::RBig;
use palmistry_io::file::Checksum;
use palmistry_lang::{SymbolInfo, System, Value};
use palmistry_math::expression::{Graph, Node, NodeId};
use std::collections::HashMap;

/// Collects what is asked.
#[derive(Debug, Default)]
pub struct Fingerprint(Checksum);

impl Fingerprint {
    /// Adds a text; where it ends is part of it.
    pub fn text(&mut self, text: &str) {
        self.0.add(&format!("{}:{text};", text.len()));
    }

    /// Adds expressions, by what they are and not by their places in a graph.
    pub fn nodes(&mut self, graph: &Graph, nodes: &[NodeId]) {
        let mut known: HashMap<NodeId, u64> = HashMap::new();
        // operands come first
        for id in graph.reachable(nodes.iter().copied()) {
            let mut sum = Checksum::default();
            let kind = match graph.node(id) {
                Node::Constant(_) => {
                    format!("c{}", graph.constant_value(id).map(RBig::to_string).unwrap_or_default())
                }
                Node::Pi => "pi".to_owned(),
                Node::Symbol(symbol) => format!("s{}", graph.symbol_name(symbol)),
                Node::Add(..) => "+".to_owned(),
                Node::Sub(..) => "-".to_owned(),
                Node::Mul(..) => "*".to_owned(),
                Node::Div(..) => "/".to_owned(),
                Node::Neg(_) => "neg".to_owned(),
                Node::Power(_, exponent) => format!("^{exponent}"),
                Node::Apply(function, _) => format!("{function:?}"),
            };
            sum.add(&kind);
            for operand in graph.node(id).operands() {
                sum.add(&format!(" {:x}", known[&operand]));
            }
            known.insert(id, sum.value());
        }
        self.text(&nodes.len().to_string());
        for node in nodes {
            self.text(&format!("{:x}", known[node]));
        }
    }

    /// Adds the version of the program, the text of a system's file and what it takes from others: symbols with their values and
    /// ranges, outputs, the rates of what moves.
    pub fn system(&mut self, system: &System) {
        self.text(env!("CARGO_PKG_VERSION"));
        self.text(&system.source);
        for (symbol, SymbolInfo { kind, is_angle, default, range }) in system.symbols() {
            let number = |value: Option<&RBig>| value.map(RBig::to_string).unwrap_or_default();
            let ends = [default.as_ref(), range.as_ref().map(|r| &r.low), range.as_ref().map(|r| &r.high)];
            let name = system.symbol_name(symbol);
            self.text(&format!("{name} {kind:?} {is_angle} {:?}", ends.map(number)));
        }
        self.text(&system.known_names().join(","));
        let outputs: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
        self.nodes(&system.graph, &outputs);
        for field in system.moving_fields() {
            for (symbol, rate) in &system.fields[field].components {
                self.text(system.symbol_name(*symbol));
                self.nodes(&system.graph, &[*rate]);
            }
        }
    }

    /// Adds a number by its bits.
    pub fn number(&mut self, number: f64) {
        self.text(&format!("{:x}", number.to_bits()));
    }

    /// The number.
    pub fn value(&self) -> u64 {
        self.0.value()
    }
}

/// The number of a question as it is asked: of its system, and of all options on which what is found at a state depends. What is
/// reported of the worst state besides, such as its digits, is no part of it.
pub(super) fn of_question(system: &System, question: &RankQuestion<'_>, only_if_short: bool) -> u64 {
    let mut found = Fingerprint::default();
    found.system(system);
    let RankQuestion { samples, seed, wanted, order, fixed, conditions, .. } = question;
    found.text(&format!("{samples} {seed} {wanted:?} {order:?} {only_if_short} {}", conditions.len()));
    conditions.iter().for_each(|condition| found.text(condition));
    for (symbol, value) in fixed {
        found.text(&format!("{} = {value}", system.symbol_name(*symbol)));
    }
    let avoided: Vec<NodeId> = system.avoid.iter().map(|(_, node)| *node).collect();
    found.nodes(&system.graph, &avoided);
    if let Some(Value::Matrix(own)) = system.definition(OWN_ROWS) {
        found.nodes(&system.graph, &own.entries);
    }
    found.value()
}
