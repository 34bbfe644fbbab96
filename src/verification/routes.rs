//! Two routes to the same Lie derivative: num-dual's nested duals, and derivatives of the expression graph.

use crate::expression::{Program, Symbol, expand_angles};
use crate::number::Floats;
use crate::observability::{Branch, Locus, float_inputs, lie_derivative_by_duals};
use crate::system::System;
use std::collections::{BTreeMap, HashMap};

/// How far the routes agree at one order.
#[derive(Clone, Copy, Debug)]
pub struct RouteAgreement {
    pub order: usize,
    /// The largest relative difference over the states.
    pub largest_difference: f64,
    pub states: usize,
}

const STATES: u64 = 16;

/// Compares the routes for the first output along the first field.
///
/// # Errors
/// In words, where a state cannot be drawn or evaluated.
pub fn compare_routes(system: &System, orders: usize, seed: u64) -> Result<Vec<RouteAgreement>, String> {
    let mut system = system.clone();
    let output = system.outputs[0].1;
    let locus = Locus::new(&mut system, &Branch::default(), &BTreeMap::new(), &[output])
        .map_err(|e| e.to_string())?;
    let mut value = output;
    let mut found = Vec::new();
    for order in 1..=orders {
        value = system.lie_derivative(0, value);
        let expanded = expand_angles(&mut system.graph, &[value], |_| false);
        let program = Program::new(&system.graph, &expanded, |_| false, false);
        let mut largest = 0.0f64;
        for index in 0..STATES {
            let state = locus.draw(seed, index).map_err(|e| e.to_string())?;
            let mut point: HashMap<Symbol, f64> = system
                .symbols()
                .filter_map(|(s, info)| Some((s, info.default.as_ref()?.to_f64().value())))
                .collect();
            point.extend(state.values.iter().map(|(symbol, value)| (*symbol, value.to_f64())));
            let inputs = float_inputs(&program, |symbol| point[&symbol]);
            let graph = program.load(Floats).map_err(|e| e.to_string())?.run(&inputs, &mut Vec::new());
            let graph = graph.map_err(|failure| failure.refusal.to_string())?[0];
            let duals = lie_derivative_by_duals(&system, &vec![0; order], output, &point)
                .map_err(|error| format!("{error:?}"))?;
            largest = largest.max((graph - duals).abs() / graph.abs().max(f64::MIN_POSITIVE));
        }
        found.push(RouteAgreement { order, largest_difference: largest, states: STATES as usize });
    }
    Ok(found)
}
