//! The fields of the smaller system, made of those of the larger one.

use super::question::{NotReduced, ReduceQuestion};
use palmistry_lang::{Kind, Role, System};
use palmistry_math::expression::{NodeId, Symbol};

/// A field of the smaller system: a field of the larger one, or its drift with the inputs that something drives.
#[derive(Clone, Debug)]
pub(crate) struct Flow {
    pub role: Role,
    pub name: String,
    /// Fields of the larger system by their places, each with the symbol that it is multiplied by.
    pub terms: Vec<(Option<Symbol>, usize)>,
}

/// The fields that are kept: each input by itself, or all that is driven in the drift.
pub(crate) fn flows(system: &System, question: &ReduceQuestion) -> Result<Vec<Flow>, NotReduced> {
    // that a known signal may change is a field of its own, which no file writes
    let moving: Vec<usize> = system
        .moving_fields()
        .into_iter()
        .filter(|field| !system.fields[*field].name.contains('\''))
        .collect();
    let inputs: Vec<&str> = moving
        .iter()
        .filter(|field| system.fields[**field].role == Role::Input)
        .map(|field| system.fields[*field].name.as_str())
        .collect();
    let named = question.undriven.iter().chain(question.driven.iter().map(|(field, _)| field));
    if let Some(name) = named.into_iter().find(|name| !inputs.contains(&name.as_str())) {
        return Err(NotReduced::NoInput { name: name.clone(), inputs: inputs.join(", ") });
    }
    let mut flows = Vec::new();
    for field in moving {
        let of = &system.fields[field];
        let is_driven = |(name, _): &&(String, String)| *name == of.name;
        if question.undriven.contains(&of.name) || question.driven.iter().any(|one| is_driven(&one)) {
            continue;
        }
        flows.push(Flow { role: of.role, name: of.name.clone(), terms: vec![(None, field)] });
    }
    if !question.driven.is_empty() {
        if !flows.iter().any(|flow| flow.role == Role::Drift) {
            let name =
                ["f", "drift", "motion"].into_iter().find(|name| !inputs.contains(name)).unwrap_or("f0");
            flows.insert(0, Flow { role: Role::Drift, name: name.to_owned(), terms: Vec::new() });
        }
        for (name, by) in &question.driven {
            let symbol = given(system, by)?;
            let place = system.fields.iter().position(|field| field.name == *name);
            if let (Some(place), Some(drift)) =
                (place, flows.iter_mut().find(|flow| flow.role == Role::Drift))
            {
                drift.terms.push((Some(symbol), place));
            }
        }
    }
    Ok(flows)
}

/// A parameter or a known signal.
pub(crate) fn given(system: &System, name: &str) -> Result<Symbol, NotReduced> {
    let is_given = |symbol: &Symbol| {
        system.known.contains(symbol)
            || system.symbol_info(*symbol).is_some_and(|info| info.kind == Kind::Parameter)
                && system.unknown_kind(*symbol).is_none()
    };
    system.find_symbol(name).filter(is_given).ok_or_else(|| NotReduced::NoSignal { name: name.to_owned() })
}

/// What a field does to a symbol.
pub(crate) fn component(system: &mut System, flow: &Flow, symbol: Symbol) -> NodeId {
    let mut rate = system.graph.integer(0);
    for (by, field) in &flow.terms {
        let found = system.fields[*field].components.iter().find(|(other, _)| *other == symbol);
        let Some((_, mut moved)) = found.copied() else { continue };
        if let Some(by) = by {
            let by = system.graph.symbol(*by);
            moved = system.graph.mul(by, moved);
        }
        rate = system.graph.add(rate, moved);
    }
    rate
}
