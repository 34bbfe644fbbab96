//! Constants of a scene put into the model: columns that never change in the measurements become constants, and terms that vanish with them are dropped.
//!
//! A column that drives the model needs no further condition: its values are given, and they are all equal. A state that is measured by itself has a rate of its
//! own in the model; it is a constant where this rate is exactly zero with all other constants put in, so that the smaller model moves as the larger one does.
//!
//! Observers put in the columns that drive the model, and integrate the measured states. With the measured states put in as well the right-hand side is a third
//! shorter and an estimate a sixth faster, and a search whose motion crosses a pole of the equations ends elsewhere by rounding alone (the scene `turning_point`: *lost*
//! at the pole, or all steps spent behind it). What does not change an answer is used by plans alone.

use super::scene::Scene;
use super::simulation::TOUCH;
use palmistry_lang::System;
use palmistry_math::number::rational_from_f64;
use palmistry_observe::{CalibrationKind, Signals, total_rates};
use std::collections::{BTreeMap, HashMap};

/// Values whose relative difference is below this are equal, where the model says that they are constant.
const ROUNDED: f64 = 8.0 * f64::EPSILON;

/// Which columns are constants of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ConstantColumns {
    /// Those that drive it.
    Driving,
    /// States that are measured by themselves as well.
    MeasuredToo,
}

/// The columns that are constants of a scene's model, by name; anything already in `known` is excluded.
pub(super) fn constants(
    scene: &Scene,
    system: &System,
    known: &BTreeMap<String, f64>,
    signals: &Signals,
    which: ConstantColumns,
) -> BTreeMap<String, f64> {
    let settings = &scene.observer;
    // of a body between palms the common errors are those of the contacts, else those of every output
    let has_palms = TOUCH.iter().all(|name| system.outputs.iter().any(|(output, _)| output == name));
    let all_err = !has_palms && (scene.sensor.noise > 0.0 || scene.sensor.resolution > 0.0);
    let mut found = BTreeMap::new();
    let mut outputs = Vec::new();
    for (place, name) in signals.names().iter().enumerate() {
        let column = signals.column(place);
        let Some(first) = column.first() else { continue };
        let is_steady = column.iter().all(|value| value == first);
        // a sum that a simulation accumulates is rounded each time
        let is_nearly = column.iter().all(|value| (value - first).abs() <= ROUNDED * first.abs());
        let is_met = system.find_symbol(name).is_some() && !known.contains_key(name);
        // an estimated column, or one with an estimated bias, gain or delay, has no exact values; those that drive a model are put in with these
        let is_sought = settings.estimate.iter().any(|sought| {
            sought == name
                || which == ConstantColumns::MeasuredToo
                    && CalibrationKind::of(sought).is_some_and(|(column, _)| column == name)
        });
        if !is_nearly || !is_met || TOUCH.contains(&name.as_str()) || is_sought {
            continue;
        }
        if !system.outputs.iter().any(|(output, _)| output == name) {
            if is_steady {
                found.insert(name.clone(), *first);
            }
        } else if which == ConstantColumns::MeasuredToo && !all_err && !scene.channels.contains_key(name) {
            // a sensor with errors may show one value of a state that moves
            outputs.push((name.clone(), *first));
        }
    }
    // all together, and without those whose rate does not vanish so, until none is left that moves
    while !outputs.is_empty() {
        let all = known.iter().chain(&found).map(|(name, value)| (name, *value));
        let all: Vec<(&String, f64)> =
            all.chain(outputs.iter().map(|(name, value)| (name, *value))).collect();
        let moves = moving(scene, system, &all, &outputs);
        if moves.is_empty() {
            break;
        }
        outputs.retain(|(name, _)| !moves.contains(name));
    }
    found.extend(outputs);
    found
}

/// Those of some states whose rate is not exactly zero with these values put in.
fn moving(
    scene: &Scene,
    system: &System,
    values: &[(&String, f64)],
    states: &[(String, f64)],
) -> Vec<String> {
    let mut system = system.clone();
    let inputs: Vec<(String, String)> =
        scene.observer.inputs.iter().map(|(field, symbol)| (field.clone(), symbol.clone())).collect();
    let all = || states.iter().map(|(name, _)| name.clone()).collect::<Vec<String>>();
    let names = all();
    let symbols: Option<Vec<_>> = names
        .iter()
        .map(|name| system.find_symbol(name).filter(|symbol| system.states.contains(symbol)))
        .collect();
    let Some(symbols) = symbols else {
        // an output of that name that is no state
        return states
            .iter()
            .filter(|(name, _)| {
                system.find_symbol(name).is_none_or(|symbol| !system.states.contains(&symbol))
            })
            .map(|(name, _)| name.clone())
            .collect();
    };
    let Ok(rates) = total_rates(&mut system, &symbols, &inputs) else { return all() };
    let mut constants = HashMap::new();
    for (name, value) in values {
        if let (Some(symbol), Some(exact)) = (system.find_symbol(name), rational_from_f64(*value)) {
            let node = system.graph.rational(exact);
            constants.insert(symbol, node);
        }
    }
    if system.graph.vanishing_divisor(&rates, &constants).is_some() {
        return all();
    }
    let rates = system.graph.substitute(&rates, &constants);
    let is_zero = |rate| system.graph.constant_value(rate).is_some_and(|rate| rate.is_zero());
    names.into_iter().zip(rates).filter(|(_, rate)| !is_zero(*rate)).map(|(name, _)| name).collect()
}
