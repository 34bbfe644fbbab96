//! A file with additions, and what can be added to one.

use super::{Addition, AdditionKind, DesignQuestion};
use crate::sweep::named_unknowns;
use palmistry_lang::{System, UnknownKind, without_claims};
use std::collections::BTreeSet;

/// So many names of an input are tried.
const NAMES: usize = 100;

/// What can be added, by what it does to a search: rows of its own, or other equations.
pub(super) struct Additions {
    /// Outputs, known parameters, known initial conditions.
    pub rows: Vec<Addition>,
    /// The states into whose rates an input can go.
    pub inputs: Vec<Addition>,
    /// How many further experiments there can be.
    pub experiments: usize,
}

impl Additions {
    pub fn of(system: &System, question: &DesignQuestion<'_>, wanted: &[String]) -> Additions {
        let has = |kind: AdditionKind| question.kinds.contains(&kind);
        let unknowns = named_unknowns(system);
        let named = |kind: UnknownKind| -> Vec<String> {
            // what a file says of the first experiment holds in all
            let of_kind = unknowns.iter().filter(|(name, of_it)| *of_it == kind && !name.contains('@'));
            of_kind.map(|(name, _)| name.clone()).collect()
        };
        let states = named(UnknownKind::State);
        // a state of which only the initial condition is known can be measured, too
        let known_at_first =
            system.closed_coordinates().into_iter().filter(|state| system.known.contains(state));
        let known_at_first = known_at_first.map(|state| system.symbol_name(state).to_owned());
        let of_first = known_at_first.filter(|name| !name.contains('@'));
        let moving: Vec<String> = states.iter().cloned().chain(of_first).collect();
        let mut rows = Vec::new();
        if has(AdditionKind::Outputs) {
            let measured: BTreeSet<&str> = system.outputs.iter().map(|(text, _)| text.as_str()).collect();
            let measurable = question.measurable.as_ref().unwrap_or(&moving);
            let new = measurable.iter().filter(|text| !measured.contains(text.as_str()));
            rows.extend(new.cloned().map(Addition::Output));
        }
        if has(AdditionKind::Known) {
            // to know what is to be identified is no design
            let parameters = named(UnknownKind::Parameter).into_iter();
            let others = parameters.filter(|name| question.targets.is_empty() || !wanted.contains(name));
            rows.extend(others.map(Addition::Known));
        }
        if has(AdditionKind::Initial) {
            rows.extend(states.iter().cloned().map(Addition::Initial));
        }
        let moved = |name: &String| {
            let symbol = system.find_symbol(name);
            let fields = system.moving_fields().into_iter().map(|field| &system.fields[field]);
            let mut rates = fields.flat_map(|field| &field.components);
            rates.any(|(state, rate)| {
                Some(*state) == symbol
                    && system.graph.constant_value(*rate).is_none_or(|rate| !rate.is_zero())
            })
        };
        let inputs = match has(AdditionKind::Inputs) {
            true => moving.iter().filter(|name| moved(name)).cloned().map(Addition::Input).collect(),
            false => Vec::new(),
        };
        let has_experiments = has(AdditionKind::Experiments) && !says_experiments(system);
        Additions { rows, inputs, experiments: if has_experiments { question.at_most } else { 0 } }
    }

    pub fn count(&self) -> usize {
        self.rows.len() + self.inputs.len() + self.experiments.min(1)
    }
}

fn says_experiments(system: &System) -> bool {
    system.states.iter().any(|state| system.symbol_name(*state).contains('@'))
}

/// The file with additions.
///
/// # Errors
/// In words, where it cannot be read: a name that is taken, or a definition that is of one experiment.
pub(super) fn with(
    system: &System,
    question: &DesignQuestion<'_>,
    additions: &[Addition],
) -> Result<System, String> {
    let mut text = without_claims(&system.source);
    let of_inputs = additions.iter().filter(|addition| matches!(addition, Addition::Input(_)));
    for addition in of_inputs {
        let Addition::Input(state) = addition else { continue };
        // a name without brackets, also for a component, and none that stands in the file
        let word: String = state.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
        let mut names = (0..NAMES).map(|number| format!("into_{word}_{number}"));
        let name = names.find(|name| !system.source.contains(name.as_str()));
        let name = name.ok_or_else(|| format!("the file has all names for an input into {state}"))?;
        text.push_str(&format!("input {name}\n  {state}' = 1\n"));
        if system.states.len() > 1 {
            text.push_str("  others' = 0\n");
        }
    }
    for addition in additions {
        if let Addition::Initial(state) = addition {
            text.push_str(&format!("initial {state} known\n"));
        }
    }
    let experiments = additions.iter().filter(|addition| **addition == Addition::Experiment).count();
    if experiments > 0 {
        text.push_str(&format!("experiments {}\n", experiments + 1));
    }
    // a constant that is known is one that is measured
    for addition in additions {
        if let Addition::Output(expression) | Addition::Known(expression) = addition {
            // in brackets nothing else can follow an expression
            match expression.chars().all(|c| c.is_alphanumeric() || c == '_') {
                true => text.push_str(&format!("output {expression}\n")),
                false => text.push_str(&format!("output ({expression})\n")),
            }
        }
    }
    System::parse(&system.name, &text, question.folder).map_err(|why| why.to_string())
}
