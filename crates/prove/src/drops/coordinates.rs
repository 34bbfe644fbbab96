//! What stands for states.

use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{NodeId, Symbol};

/// States in terms of what stands for them.
#[derive(Clone, Debug, Default)]
pub(super) struct Coordinates {
    /// A state, the symbol that stands for it and what that means.
    pub changed: Vec<(Symbol, Symbol, NodeId)>,
    /// The replaced states, in terms of all other symbols.
    pub values: Assignment,
}

impl Coordinates {
    /// A differential, by these states, in these coordinates.
    pub fn row(&self, system: &mut System, states: &[Symbol], row: &[NodeId]) -> Vec<NodeId> {
        if self.changed.is_empty() {
            return row.to_vec();
        }
        let there = system.graph.substitute(row, &self.values);
        let mut found = Vec::new();
        for (place, state) in states.iter().enumerate() {
            let own = self.changed.iter().find(|(old, ..)| old == state);
            let by = own.map_or(*state, |(_, new, _)| *new);
            let mut sum = if own.is_some() { system.graph.integer(0) } else { there[place] };
            for (old, ..) in &self.changed {
                let Some(at) = states.iter().position(|state| state == old) else { continue };
                let slope = system.partial(self.values[old], by);
                let part = system.graph.mul(there[at], slope);
                sum = system.graph.add(sum, part);
            }
            found.push(sum);
        }
        found
    }
}
