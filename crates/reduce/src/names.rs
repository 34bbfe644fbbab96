//! Formulas of the smaller system in the names of the larger file's definitions.

use super::remaining::Remaining;
use palmistry_lang::Value;
use palmistry_math::expression::{Node, NodeId};
use std::collections::{HashMap, HashSet};

/// A definition of the larger file that the smaller one still uses.
pub(crate) struct Definition {
    pub name: String,
    pub node: NodeId,
}

/// Formulas of the smaller system in the names of its definitions.
pub(crate) struct Names {
    /// In an order in which each is defined above its use.
    pub definitions: Vec<Definition>,
}

impl Names {
    /// The definitions that are numbers and stand in the formulas, none of them a single symbol.
    pub fn new(remaining: &mut Remaining) -> Names {
        let mut values = remaining.values.clone();
        for law in &remaining.laws {
            let given = law.given(&mut remaining.system.graph);
            values.insert(law.state, given);
        }
        // what a condition gives may hold a state that a law gives
        for law in &remaining.laws {
            let given = HashMap::from([(law.state, values[&law.state])]);
            for value in values.values_mut() {
                *value = remaining.system.graph.substitute(&[*value], &given)[0];
            }
        }
        let numbers: Vec<(String, NodeId)> = remaining
            .system
            .definitions
            .iter()
            .filter(|(name, _)| !name.contains(['.', '[', '@']))
            .filter_map(|(name, value)| match value {
                Value::Scalar(node) => Some((name.clone(), *node)),
                _ => None,
            })
            .collect();
        let nodes: Vec<NodeId> = numbers.iter().map(|(_, node)| *node).collect();
        let images = match remaining.system.graph.vanishing_divisor(&nodes, &values) {
            // a definition that divides by zero is used by no rate, for those have values
            Some(_) => numbers
                .iter()
                .map(|(_, node)| {
                    let divides = remaining.system.graph.vanishing_divisor(&[*node], &values).is_some();
                    (!divides).then(|| remaining.system.graph.substitute(&[*node], &values)[0])
                })
                .collect(),
            None => {
                remaining.system.graph.substitute(&nodes, &values).into_iter().map(Some).collect::<Vec<_>>()
            }
        };
        let formulas: Vec<NodeId> =
            remaining.rates.iter().flatten().copied().chain(remaining.output_nodes()).collect();
        let order: HashMap<NodeId, usize> = remaining
            .system
            .graph
            .reachable(formulas)
            .into_iter()
            .enumerate()
            .map(|(at, id)| (id, at))
            .collect();
        let mut taken = HashSet::new();
        let mut definitions: Vec<(usize, Definition)> = Vec::new();
        for ((name, _), node) in numbers.into_iter().zip(images) {
            let Some(node) = node else { continue };
            let is_plain = match remaining.system.graph.node(node) {
                Node::Neg(inner) => remaining.system.graph.as_symbol(inner).is_some(),
                _ => false,
            };
            let is_plain = is_plain
                || remaining.system.graph.as_symbol(node).is_some()
                || remaining.system.graph.constant_value(node).is_some();
            if let (false, Some(at)) = (is_plain, order.get(&node))
                && taken.insert(node)
            {
                definitions.push((*at, Definition { name, node }));
            }
        }
        definitions.sort_by_key(|(at, _)| *at);
        let mut names =
            Names { definitions: definitions.into_iter().map(|(_, definition)| definition).collect() };
        let formulas: Vec<NodeId> =
            remaining.rates.iter().flatten().copied().chain(remaining.output_nodes()).collect();
        if formulas.iter().any(|formula| names.text(remaining, *formula, None).starts_with(TOO_LONG)) {
            names.define_parts(remaining, &formulas, &order);
        }
        names
    }

    /// Defines what formulas that are too long have in common.
    fn define_parts(&mut self, remaining: &Remaining, formulas: &[NodeId], order: &HashMap<NodeId, usize>) {
        let graph = &remaining.system.graph;
        let defined: HashSet<NodeId> = self.definitions.iter().map(|definition| definition.node).collect();
        // how often each is used, and how long it is beside what has a name
        let mut uses: HashMap<NodeId, usize> = HashMap::new();
        let mut lengths: HashMap<NodeId, usize> = HashMap::new();
        let mut parts = Vec::new();
        let all = graph.reachable(formulas.iter().copied());
        for id in &all {
            for operand in graph.node(*id).operands() {
                *uses.entry(operand).or_default() += 1;
            }
        }
        for id in all {
            let node = graph.node(id);
            let mut length: usize = 1 + node.operands().map(|operand| lengths[&operand]).sum::<usize>();
            let is_shared = uses.get(&id).is_some_and(|count| *count > 1);
            if defined.contains(&id) || is_shared && length > SHORT || length > LONG {
                if !defined.contains(&id) {
                    parts.push(id);
                }
                length = 1;
            }
            lengths.insert(id, length);
        }
        let is_taken =
            |name: &str| graph.find_symbol(name).is_some() || remaining.system.definition(name).is_some();
        let mut number = 0;
        for node in parts {
            let name = loop {
                number += 1;
                let name = format!("part{number}");
                if !is_taken(&name) {
                    break name;
                }
            };
            self.definitions.push(Definition { name, node });
        }
        self.definitions.sort_by_key(|definition| order.get(&definition.node).copied());
    }

    /// A formula, with definitions by their names but for the one that is being defined.
    pub fn text(&self, remaining: &mut Remaining, node: NodeId, but: Option<NodeId>) -> String {
        let graph = &mut remaining.system.graph;
        let names: HashMap<NodeId, &str> = self
            .definitions
            .iter()
            .filter(|definition| Some(definition.node) != but)
            .map(|definition| (definition.node, definition.name.as_str()))
            .collect();
        let mut image: HashMap<NodeId, NodeId> = HashMap::new();
        for id in graph.reachable([node]) {
            let new = match names.get(&id) {
                Some(name) => {
                    let symbol = graph.intern(name);
                    graph.symbol(symbol)
                }
                None => {
                    let node = graph.node(id);
                    graph.rebuild(node, |operand| image[&operand])
                }
            };
            image.insert(id, new);
        }
        // a sum with a negative number is a difference
        graph.text(image[&node]).replace(" + -", " - ")
    }
}

/// What is used more than once and has more operations than this is a part with a name of its own, where formulas are too long without.
const SHORT: usize = 8;
/// Formulas of more operations are cut.
const LONG: usize = 150;

/// What is printed of a formula that is too long begins so.
pub(crate) const TOO_LONG: &str = "(an expression";
