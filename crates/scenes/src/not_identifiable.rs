//! Whether estimated gains, biases and delays are identifiable at all: by the rank, before any measurement is used.

use palmistry_lang::{Kind, Role, SymbolInfo, System};
use palmistry_math::expression::{NodeId, Symbol};
use palmistry_math::number::{rational_from_f64, rational_to_f64};
use palmistry_observe::{
    CalibrationKind, EstimateQuestion, EstimatedCalibration, Signals, declare, estimated_calibrations,
};
use palmistry_rank::observability::{Ceiling, Observability, generic_answer};
use std::collections::HashMap;

/// The estimated unknowns that are not identifiable, whatever drives the inputs, where a gain or a bias is estimated: by the generic rank of the observability
/// codistribution, modulo primes, with gains and biases as constant states. A rank falls on special sets and
/// never rises, so that what is generically unobservable is so everywhere; an unknown that is not named may still be unobservable, and the Cramér-Rao bound
/// of a window says so. Nothing is named where the rank is not known, or a column drives the model that is no input.
///
/// A late output is replaced by `h - d h'` on the set where the delay `d` is zero: there its differential is that of `h(x(t - d))`. What is unobservable there is so
/// for any delay: a generic direction `(xi, 1)` in the kernel of all outputs, `L_xi h = h'` of those that are late and zero of all others, commutes with the motion where
/// the state is otherwise observable, and its flow then moves states and delays together so that nothing changes. Inputs, on which `h'` depends, are measured states, driven by
/// their rate of change: constant inputs would determine no delay, and others may.
pub(crate) fn not_identifiable(system: &System, wanted: &EstimateQuestion, signals: &Signals) -> Vec<String> {
    let names: Vec<String> = wanted.guess.iter().map(|(name, _)| name.clone()).collect();
    if !names.iter().any(|name| CalibrationKind::of(name).is_some()) {
        return Vec::new();
    }
    let Some(mut system) = as_estimated(system, &names, wanted, signals) else { return Vec::new() };
    let mut at = HashMap::new();
    let late =
        estimated_calibrations(&system, &names).into_iter().filter_map(|own| Some((own.column, own.delay?)));
    let late: Vec<(Symbol, Symbol)> = late.collect();
    if !late.is_empty() && delayed(&mut system, &late, wanted).is_none() {
        return Vec::new();
    }
    for (_, delay) in late {
        at.insert(delay, system.graph.integer(0));
    }
    let answer = generic_answer(&system, &at, Ceiling::Rests);
    let unobserved = answer.unknowns.iter().filter(|(_, seen)| *seen == Observability::No);
    let unobserved: Vec<&str> = unobserved.map(|(symbol, _)| system.symbol_name(*symbol)).collect();
    names.into_iter().filter(|name| unobserved.contains(&name.as_str())).collect()
}

/// The system whose unknowns are what is estimated: with gains and biases where sensors and motors have them, known constants put in, and the outputs that are
/// measured. None where signals are tied by outputs, which are not driven at will then, and where a column drives the model that is no input.
pub(super) fn as_estimated(
    system: &System,
    names: &[String],
    wanted: &EstimateQuestion,
    signals: &Signals,
) -> Option<System> {
    if !system.zero_outputs().is_empty() {
        return None;
    }
    let mut system = system.clone();
    declare(&mut system, names);
    with_calibrations(&mut system, names, wanted, signals)?;
    hold_constants(&mut system, names, wanted, signals);
    Some(system)
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
        // a known signal is driven by its derivative, and no constant
        let is_of_a_signal = field.contains('\'');
        if driver.is_none() && !is_of_a_signal && system.fields[place].role == Role::Input {
            system.fields[place].role = Role::Other;
        }
    }
    for EstimatedCalibration { column, gain, bias, .. } in estimated_calibrations(system, names) {
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

/// Puts in known constants; an angle keeps its place among the states, at any value.
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
        system.fields[place].derive_anew(&system.graph);
    }
    let nodes: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
    let nodes = system.graph.substitute(&nodes, &values);
    for (output, node) in system.outputs.iter_mut().zip(nodes) {
        output.1 = node;
    }
}

/// Replaces late outputs by `h - d h'`, and each driven input by a measured state. None where there is no drift to move them.
fn delayed(system: &mut System, late: &[(Symbol, Symbol)], wanted: &EstimateQuestion) -> Option<()> {
    let drift = system.drift()?;
    let is_read = |column: &Symbol| {
        system.outputs.iter().any(|(output, _)| output.as_str() == system.symbol_name(*column))
    };
    if !late.iter().all(|(column, _)| is_read(column)) {
        // a delay of a column that drives the model is reported where the model is made
        return None;
    }
    // of an output that a known signal is a part of, the derivative of the signal is a part too
    let signals: Vec<Symbol> = system.signal_chains().into_iter().flatten().collect();
    let late_nodes: Vec<NodeId> = late
        .iter()
        .filter_map(|(column, _)| {
            let name = system.symbol_name(*column);
            system.outputs.iter().find(|(output, _)| output == name).map(|(_, node)| *node)
        })
        .collect();
    if system.graph.symbols_of(late_nodes).iter().any(|symbol| signals.contains(symbol)) {
        return None;
    }
    let mut driven: Vec<Symbol> = Vec::new();
    for (field, name) in &wanted.inputs {
        let place = system.fields.iter().position(|other| other.name == *field)?;
        let symbol = system.find_symbol(name)?;
        let input = system.graph.symbol(symbol);
        for k in 0..system.fields[place].components.len() {
            let (state, moved) = system.fields[place].components[k];
            let moved = system.graph.mul(input, moved);
            let own = system.fields[drift].components.iter().position(|(other, _)| *other == state);
            match own {
                Some(own) => {
                    let before = system.fields[drift].components[own].1;
                    system.fields[drift].components[own].1 = system.graph.add(before, moved);
                }
                None => system.fields[drift].components.push((state, moved)),
            }
        }
        if driven.contains(&symbol) {
            // one column drives both: it is one state
            system.fields[place].role = Role::Other;
            continue;
        }
        driven.push(symbol);
        system.fields[place].components = vec![(symbol, system.graph.integer(1))];
        system.fields[place].derive_anew(&system.graph);
        let info = SymbolInfo { kind: Kind::State, is_angle: false, default: None, range: None };
        system.symbols.insert(symbol, info);
        system.states.push(symbol);
        system.outputs.push((name.clone(), input));
    }
    system.fields[drift].derive_anew(&system.graph);
    for (column, delay) in late {
        let name = system.symbol_name(*column).to_owned();
        let output = system.outputs.iter().position(|(other, _)| *other == name)?;
        let node = system.outputs[output].1;
        let rate = system.lie_derivative(drift, node);
        let delay = system.graph.symbol(*delay);
        let part = system.graph.mul(delay, rate);
        system.outputs[output].1 = system.graph.sub(node, part);
    }
    Some(())
}
