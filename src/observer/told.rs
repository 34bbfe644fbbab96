//! Whether gains and biases that are sought can be told at all: by the rank, before anything is read.

use super::Signals;
use super::calibration::{CalibrationKind, Sought, declare, sought};
use super::task::EstimateQuestion;
use crate::expression::{NodeId, Symbol};
use crate::number::{rational_from_f64, rational_to_f64};
use crate::observability::{Ceiling, Seen, generic_answer};
use crate::system::{Kind, Role, SymbolInfo, System};
use std::collections::HashMap;

/// What is sought that no readings tell, whatever drives the inputs, where a gain or a bias is sought: by the rank of the observability
/// codistribution at almost all states, modulo primes, with gains and biases as states at rest. A rank falls on special sets and
/// never rises, so that what is not seen at almost all states is seen at none; what this does not name may still be unseen, and the bound
/// of a window says so. Nothing is named where the rank is not known, or a column drives the model that is no input.
pub(crate) fn not_told(system: &System, wanted: &EstimateQuestion, signals: &Signals) -> Vec<String> {
    let names: Vec<String> = wanted.guess.iter().map(|(name, _)| name.clone()).collect();
    if !names.iter().any(|name| CalibrationKind::of(name).is_some()) {
        return Vec::new();
    }
    if !system.zero_outputs().is_empty() {
        // what outputs tie is not driven at will: the bound of a window says what is not told
        return Vec::new();
    }
    let mut system = system.clone();
    declare(&mut system, &names);
    if with_calibrations(&mut system, &names, wanted, signals).is_none() {
        return Vec::new();
    }
    hold_constants(&mut system, &names, wanted, signals);
    let answer = generic_answer(&system, &HashMap::new(), Ceiling::Rests);
    let unseen = answer.unknowns.iter().filter(|(_, seen)| *seen == Seen::No);
    let unseen: Vec<&str> = unseen.map(|(symbol, _)| system.symbol_name(*symbol)).collect();
    names.into_iter().filter(|name| unseen.contains(&name.as_str())).collect()
}

/// Gains and biases where sensors and motors have them: in outputs and in what drives the inputs. None where a column has another part.
fn with_calibrations(
    system: &mut System,
    names: &[String],
    wanted: &EstimateQuestion,
    signals: &Signals,
) -> Option<()> {
    system.outputs.retain(|(name, _)| signals.find(name).is_some());
    for place in 0..system.fields.len() {
        let field = &system.fields[place].name;
        let driver = wanted.inputs.iter().find(|(other, _)| other == field).map(|(_, symbol)| symbol);
        if driver.is_none() && system.fields[place].role == Role::Input {
            system.fields[place].role = Role::Other;
        }
    }
    for Sought { column, gain, bias } in sought(system, names) {
        let name = system.symbol_name(column).to_owned();
        let [gain, bias] = [gain, bias].map(|symbol| symbol.map(|symbol| system.graph.symbol(symbol)));
        if let Some(place) = system.outputs.iter().position(|(output, _)| *output == name) {
            let node = system.outputs[place].1;
            let scaled = gain.map_or(node, |gain| system.graph.mul(gain, node));
            system.outputs[place].1 = bias.map_or(scaled, |bias| system.graph.add(scaled, bias));
            continue;
        }
        let driven = wanted.inputs.iter().filter(|(_, symbol)| *symbol == name);
        let driven: Vec<&String> = driven.map(|(field, _)| field).collect();
        if driven.is_empty() {
            return None;
        }
        for field in driven {
            let drift = system.drift()?;
            let field = system.fields.iter().position(|other| other.name == *field)?;
            for k in 0..system.fields[field].components.len() {
                // u g = (r - bias)/gain g
                let (symbol, moved) = system.fields[field].components[k];
                let moved = gain.map_or(moved, |gain| system.graph.div(moved, gain));
                system.fields[field].components[k].1 = moved;
                let Some(bias) = bias else { continue };
                let part = system.graph.mul(bias, moved);
                let part = system.graph.neg(part);
                let own = system.fields[drift].components.iter().position(|(other, _)| *other == symbol);
                match own {
                    Some(own) => {
                        let before = system.fields[drift].components[own].1;
                        system.fields[drift].components[own].1 = system.graph.add(before, part);
                    }
                    None => system.fields[drift].components.push((symbol, part)),
                }
            }
        }
    }
    // what changes with time and is neither a state nor an input is no constant
    let nodes = system.fields.iter().filter(|field| field.role != Role::Other);
    let nodes = nodes.flat_map(|field| field.components.iter().map(|(_, node)| *node));
    let nodes: Vec<NodeId> = nodes.chain(system.outputs.iter().map(|(_, node)| *node)).collect();
    let varies = |symbol: &Symbol| {
        let name = system.symbol_name(*symbol);
        let is_parameter = system.symbol_info(*symbol).is_some_and(|info| info.kind == Kind::Parameter);
        is_parameter && signals.find(name).is_some() && !wanted.known.contains_key(name)
    };
    (!system.graph.symbols_of(nodes).iter().any(varies)).then_some(())
}

/// Puts in what is known and does not change; an angle keeps its place among the states, at any value.
fn hold_constants(system: &mut System, names: &[String], wanted: &EstimateQuestion, signals: &Signals) {
    let mut values = HashMap::new();
    let symbols: Vec<(Symbol, SymbolInfo)> = system.symbols().map(|(s, info)| (s, info.clone())).collect();
    for (symbol, info) in symbols {
        let name = system.symbol_name(symbol).to_owned();
        if names.contains(&name) {
            continue;
        }
        let default = || info.default.as_ref().map(rational_to_f64).filter(|_| signals.find(&name).is_none());
        let Some(value) = wanted.known.get(&name).copied().or_else(default).and_then(rational_from_f64)
        else {
            continue;
        };
        if info.is_angle && !value.is_zero() {
            if system.states.contains(&symbol) && signals.find(&name).is_none() {
                system.known.insert(symbol);
            }
            continue;
        }
        values.insert(symbol, system.graph.rational(value));
    }
    system.states.retain(|state| !values.contains_key(state));
    system.known.retain(|state| !values.contains_key(state));
    for place in 0..system.fields.len() {
        system.fields[place].components.retain(|(symbol, _)| !values.contains_key(symbol));
        let nodes: Vec<NodeId> = system.fields[place].components.iter().map(|(_, node)| *node).collect();
        let nodes = system.graph.substitute(&nodes, &values);
        for (component, node) in system.fields[place].components.iter_mut().zip(nodes) {
            component.1 = node;
        }
        system.fields[place].derive_anew();
    }
    let nodes: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
    let nodes = system.graph.substitute(&nodes, &values);
    for (output, node) in system.outputs.iter_mut().zip(nodes) {
        output.1 = node;
    }
}
