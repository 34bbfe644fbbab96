//! All fields of a system at once: the rates of its states with a signal before each input field, and the constants that
//! conditions give.

use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{Graph, NodeId, Symbol};
use std::collections::{HashMap, HashSet};

/// A name that no file can give.
const DRIVE: &str = "\u{1}drive";

/// Drift and inputs as one motion.
pub(super) struct Driven {
    /// The rates of the states that move, in the order of the file.
    pub rates: Vec<(Symbol, NodeId)>,
    /// The signals before the input fields.
    pub drives: HashSet<Symbol>,
}

/// The rates of a system, written in a graph that holds its expressions.
pub(super) fn driven(system: &System, graph: &mut Graph) -> Driven {
    let mut rates: HashMap<Symbol, NodeId> = HashMap::new();
    let mut drives = HashSet::new();
    for (number, place) in system.moving_fields().into_iter().enumerate() {
        let field = &system.fields[place];
        let drive = (Some(place) != system.drift()).then(|| graph.intern(&format!("{DRIVE}{number}")));
        drives.extend(drive);
        for (symbol, component) in &field.components {
            let term = match drive {
                Some(drive) => {
                    let signal = graph.symbol(drive);
                    graph.mul(signal, *component)
                }
                None => *component,
            };
            let sum = rates.get(symbol).map_or(term, |sum| graph.add(*sum, term));
            rates.insert(*symbol, sum);
        }
    }
    let moved = system.states.iter().filter_map(|state| Some((*state, *rates.get(state)?)));
    Driven { rates: moved.collect(), drives }
}

/// The conditions that give a constant its value: they hold at all times, those on states only where the flow begins.
pub(super) fn told_constants(system: &System, graph: &Graph, conditions: &Assignment) -> Assignment {
    let is_told = |(symbol, value): &(&Symbol, &NodeId)| {
        !system.states.contains(symbol) && graph.symbols_of([**value]).is_empty()
    };
    conditions.iter().filter(is_told).map(|(symbol, value)| (*symbol, *value)).collect()
}
