//! Two routes to the same Lie derivative: num-dual's nested duals, and derivatives of the expression graph.

use crate::tradeoff::growth::MOST_OPERATIONS;
use palmistry_lang::System;
use palmistry_math::expression::{Program, Symbol, expand_angles};
use palmistry_math::number::Floats;
use palmistry_rank::observability::{Branch, Locus, float_inputs, lie_derivative_by_duals};
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

/// Compares the routes for one output along one field (both by their places in the system), up to an order, or until there are
/// too many operations.
///
/// # Errors
/// In words, where a state cannot be drawn or evaluated.
pub fn compare_routes(
    system: &System,
    field: usize,
    output: usize,
    orders: usize,
    seed: u64,
) -> Result<Vec<RouteAgreement>, String> {
    let mut system = system.clone();
    let output = system.outputs[output].1;
    let mut programs = Vec::new();
    let mut derivatives = vec![output];
    let mut value = output;
    for _ in 1..=orders {
        value = system.lie_derivative(field, value);
        let expanded = expand_angles(&mut system.graph, &[value], |_| false);
        programs.push(Program::plain(&system.graph, &expanded));
        derivatives.push(value);
        if programs.last().is_some_and(|program| program.len() > MOST_OPERATIONS) {
            break;
        }
    }
    let locus = Locus::new(&mut system, &Branch::default(), &BTreeMap::new(), &derivatives)
        .map_err(|e| e.to_string())?;
    let states: Vec<_> = (0..STATES)
        .map(|index| locus.draw(seed, index))
        .collect::<Result<_, _>>()
        .map_err(|e| e.to_string())?;
    let mut found = Vec::new();
    for (before, program) in programs.iter().enumerate() {
        let word = vec![field; before + 1];
        let mut largest = 0.0f64;
        for state in &states {
            let mut point: HashMap<Symbol, f64> = system
                .symbols()
                .filter_map(|(s, info)| Some((s, info.default.as_ref()?.to_f64().value())))
                .collect();
            point.extend(state.values.iter().map(|(symbol, value)| (*symbol, value.to_f64())));
            let inputs = float_inputs(program, |symbol| point.get(&symbol).copied().unwrap_or(f64::NAN));
            let graph = program.load(Floats).map_err(|e| e.to_string())?.run(&inputs, &mut Vec::new());
            let graph = graph.map_err(|failure| failure.refusal.to_string())?[0];
            let duals = lie_derivative_by_duals(&system, &word, output, &point)
                .map_err(|error| format!("{error:?}"))?;
            largest = largest.max((graph - duals).abs() / graph.abs().max(f64::MIN_POSITIVE));
        }
        found.push(RouteAgreement { order: before + 1, largest_difference: largest, states: states.len() });
    }
    Ok(found)
}
