//! Gains, biases and delays of measured columns, estimated beside the states: constants of a model.
//!
//! A measurement `r` of `x` is `gain x(t - delay) + bias`. Where `x` is followed that is its expected value; where it is taken from its column it
//! is `(r - bias)/gain`. Only outputs can have an unknown delay; delays are in no expression: a flow goes back by them (`late`).

use palmistry_lang::{Kind, SymbolInfo, System};
use palmistry_math::expression::{NodeId, Symbol};
use std::collections::HashMap;

/// What may be wrong with the measurements of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationKind {
    /// The factor of the true value.
    Gain,
    /// What is added to it.
    Bias,
    /// By how much the measurement is late, in s.
    Delay,
}

impl CalibrationKind {
    /// The suffix of the column's name.
    pub fn word(self) -> &'static str {
        match self {
            CalibrationKind::Gain => "gain",
            CalibrationKind::Bias => "bias",
            CalibrationKind::Delay => "delay",
        }
    }

    /// Its value for a perfect sensor.
    pub fn nominal(self) -> f64 {
        match self {
            CalibrationKind::Gain => 1.0,
            CalibrationKind::Bias | CalibrationKind::Delay => 0.0,
        }
    }

    /// The column and the kind of a name such as `tau1.gain`; none of any other name.
    pub fn of(name: &str) -> Option<(&str, CalibrationKind)> {
        let (column, word) = name.split_once('.')?;
        let kinds = [CalibrationKind::Gain, CalibrationKind::Bias, CalibrationKind::Delay];
        let kind = kinds.into_iter().find(|kind| kind.word() == word)?;
        (!column.is_empty()).then_some((column, kind))
    }
}

/// Declares the gains, biases and delays that are estimated as states that no field moves.
pub fn declare(system: &mut System, names: &[String]) {
    for name in names {
        let Some((column, _)) = CalibrationKind::of(name) else { continue };
        if system.find_symbol(column).is_none() || system.find_symbol(name).is_some() {
            continue;
        }
        let symbol = system.graph.intern(name);
        let info = SymbolInfo { kind: Kind::State, is_angle: false, default: None, range: None };
        system.symbols.insert(symbol, info);
        system.states.push(symbol);
    }
}

/// The gain, bias and delay of a column that are estimated, as symbols.
pub struct EstimatedCalibration {
    /// The column.
    pub column: Symbol,
    /// Its gain, where one is estimated.
    pub gain: Option<Symbol>,
    /// Its bias, where one is estimated.
    pub bias: Option<Symbol>,
    /// Its delay, where one is estimated.
    pub delay: Option<Symbol>,
}

/// What is estimated of each column.
pub fn estimated_calibrations(system: &System, followed: &[String]) -> Vec<EstimatedCalibration> {
    let mut all: Vec<EstimatedCalibration> = Vec::new();
    for name in followed {
        let Some((column, kind)) = CalibrationKind::of(name) else { continue };
        let (Some(column), Some(symbol)) = (system.find_symbol(column), system.find_symbol(name)) else {
            continue;
        };
        let place = all.iter().position(|other| other.column == column).unwrap_or_else(|| {
            all.push(EstimatedCalibration { column, gain: None, bias: None, delay: None });
            all.len() - 1
        });
        match kind {
            CalibrationKind::Gain => all[place].gain = Some(symbol),
            CalibrationKind::Bias => all[place].bias = Some(symbol),
            CalibrationKind::Delay => all[place].delay = Some(symbol),
        }
    }
    all
}

/// Puts the estimated gains, biases and delays into rates and outputs: outputs that are followed states get gain and bias, and elsewhere
/// a column stands for its measurements with both taken off.
pub(super) fn put_in(
    system: &mut System,
    followed: &[String],
    rates: &mut [NodeId],
    outputs: &mut [(String, NodeId)],
) {
    let all = estimated_calibrations(system, followed);
    let mut true_values = HashMap::new();
    for EstimatedCalibration { column, gain, bias, .. } in all {
        let name = system.symbol_name(column).to_owned();
        let own = system.graph.symbol(column);
        let [gain, bias] = [gain, bias].map(|symbol| symbol.map(|symbol| system.graph.symbol(symbol)));
        if followed.contains(&name) {
            for (_, node) in outputs.iter_mut().filter(|(output, _)| *output == name) {
                let scaled = gain.map_or(*node, |gain| system.graph.mul(gain, *node));
                *node = bias.map_or(scaled, |bias| system.graph.add(scaled, bias));
            }
        } else {
            let level = bias.map_or(own, |bias| system.graph.sub(own, bias));
            let value = gain.map_or(level, |gain| system.graph.div(level, gain));
            true_values.insert(column, value);
        }
    }
    if true_values.is_empty() {
        return;
    }
    let moved = system.graph.substitute(rates, &true_values);
    rates.copy_from_slice(&moved);
    for (name, node) in outputs {
        // the measurement of a column that stands for itself is that column
        if system.find_symbol(name).is_none_or(|symbol| !true_values.contains_key(&symbol)) {
            *node = system.graph.substitute(&[*node], &true_values)[0];
        }
    }
}
