//! How much there is in a system, and the way back to it.
//!
//! To decide a claim, expressions are added to the system's graph and derivatives to its fields. The next claim has to
//! begin where this one began, or its verdict would depend on what was decided before; and a copy of the whole system for
//! each claim would cost as much as the file is long, so that a file of many claims would take time as its square.

use super::model::{Field, System};
use palmistry_math::expression::{GraphExtent, KnownSoFar, Symbol};
use std::collections::HashMap;

/// How much there is in a system.
#[derive(Clone, Debug)]
pub struct SystemExtent {
    graph: GraphExtent,
    /// What each field of the file knows, in their order.
    fields: Vec<KnownSoFar>,
    /// The same for the imported fields.
    imported_fields: Vec<KnownSoFar>,
    /// The same for the derivations by one symbol.
    partials: HashMap<Symbol, KnownSoFar>,
}

impl System {
    /// How much there is, to come back to.
    pub fn extent(&self) -> SystemExtent {
        let of_field = |field: &Field| field.derivation.known_so_far();
        SystemExtent {
            graph: self.graph.extent(),
            fields: self.fields.iter().map(of_field).collect(),
            imported_fields: self.imported_fields.iter().map(of_field).collect(),
            partials: self.partials.iter().map(|(symbol, known)| (*symbol, known.known_so_far())).collect(),
        }
    }

    /// Takes away all expressions and derivatives that were added since: the system is as it was.
    ///
    /// Nothing that names a node or a symbol may outlive it: [`System::is_within`] says so, and without optimisation it is looked at
    /// each time.
    pub fn shrink_to(&mut self, extent: &SystemExtent) {
        let System { graph, fields, imported_fields, partials, domain, .. } = self;
        graph.shrink_to(&extent.graph);
        for (field, known) in fields.iter_mut().zip(&extent.fields) {
            field.derivation.shrink_to(*known);
        }
        for (field, known) in imported_fields.iter_mut().zip(&extent.imported_fields) {
            field.derivation.shrink_to(*known);
        }
        partials.retain(|symbol, derivation| match extent.partials.get(symbol) {
            Some(known) => {
                derivation.shrink_to(*known);
                true
            }
            None => false,
        });
        *domain = Default::default();
        debug_assert!(self.is_within(&extent.graph), "a node outlived its graph");
    }

    /// Whether all nodes and symbols that a system names are those of a graph of this extent.
    pub(crate) fn is_within(&self, extent: &GraphExtent) -> bool {
        let holds = |field: &Field| {
            let components =
                field.components.iter().all(|(symbol, id)| extent.names(*symbol) && extent.holds(*id));
            let guards = field.guards.iter().flatten().all(|guard| extent.holds(guard.node));
            components && guards && field.derivation.is_within(extent)
        };
        let outputs = self.outputs.iter().chain(&self.avoid).all(|(_, id)| extent.holds(*id));
        let guards = self.output_guards.iter().flatten().all(|guard| extent.holds(guard.node));
        let symbols = self.symbols.keys().chain(&self.states).chain(&self.known);
        outputs
            && guards
            && self.fields.iter().chain(&self.imported_fields).all(holds)
            && self.partials.values().all(|derivation| derivation.is_within(extent))
            && symbols.into_iter().all(|symbol| extent.names(*symbol))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A map that a known signal drives names the signal's later values as it is composed with. What is taken away and composed
    /// anew is what it was, and nothing that is left names what went: in continuous time, in steps, and where roots of squares
    /// are taken with a sign.
    #[test]
    fn nothing_outlives_its_graph() {
        let steps = "state x param a, b unknown known u(t) drift f x+ = a*x + b*u*sqrt(a^2) output x";
        let flow = "state x, z param a unknown known u(t) drift f x' = a*x + z*u z' = sqrt(x^2) output x initial z known";
        for text in [steps, flow] {
            let mut system: System = format!("system \"s\" {text}").parse().unwrap();
            let extent = system.extent();
            let output = system.outputs[0].1;
            let derived = |system: &mut System| {
                let mut value = output;
                for _ in 0..4 {
                    value = system.lie_derivative(0, value);
                }
                let slope = system.partial(value, system.states[0]);
                (system.graph.text(value), system.graph.text(slope))
            };
            let before = derived(&mut system);
            for further in ["q", "r"] {
                system.shrink_to(&extent);
                assert!(system.is_within(&system.graph.extent()), "{text}");
                // what takes the places of what went
                let symbol = system.graph.intern(further);
                let mut node = system.graph.symbol(symbol);
                for _ in 0..40 {
                    node = system.graph.mul(node, output);
                }
                assert_eq!(derived(&mut system), before, "{text}");
            }
        }
    }
}
