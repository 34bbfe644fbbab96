//! Gains, biases and delays of what is read, sought beside the states: constants of a model, at rest.
//!
//! A reading `r` of `x` is `gain x(t - delay) + bias`. Where `x` is followed that is what is expected of it; where it is taken from its column it
//! is `(r - bias)/gain`. Delays are sought of outputs alone, and have no part in expressions: a flow goes back by them (`late`).

use palmistry_lang::{Kind, SymbolInfo, System};
use palmistry_math::expression::{NodeId, Symbol};
use std::collections::HashMap;

/// What may be wrong with how a column is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationKind {
    /// By what the true value is multiplied.
    Gain,
    /// What is added.
    Bias,
    /// By how much the reading is late, in s.
    Delay,
}

impl CalibrationKind {
    /// The word behind the name of a column.
    pub fn word(self) -> &'static str {
        match self {
            CalibrationKind::Gain => "gain",
            CalibrationKind::Bias => "bias",
            CalibrationKind::Delay => "delay",
        }
    }

    /// Its value of a sensor that is right.
    pub fn nominal(self) -> f64 {
        match self {
            CalibrationKind::Gain => 1.0,
            CalibrationKind::Bias | CalibrationKind::Delay => 0.0,
        }
    }

    /// The column and the kind of a name such as `tau1.gain`; none of any other.
    pub fn of(name: &str) -> Option<(&str, CalibrationKind)> {
        let (column, word) = name.split_once('.')?;
        let kinds = [CalibrationKind::Gain, CalibrationKind::Bias, CalibrationKind::Delay];
        let kind = kinds.into_iter().find(|kind| kind.word() == word)?;
        (!column.is_empty()).then_some((column, kind))
    }
}

/// Declares what is sought of the columns' gains, biases and delays as states that no field moves.
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

/// Gain, bias and delay that are sought of a column, as symbols.
pub struct Sought {
    /// The column.
    pub column: Symbol,
    /// Its gain, where one is sought.
    pub gain: Option<Symbol>,
    /// Its bias, where one is sought.
    pub bias: Option<Symbol>,
    /// Its delay, where one is sought.
    pub delay: Option<Symbol>,
}

/// What is sought of each column.
pub fn sought(system: &System, followed: &[String]) -> Vec<Sought> {
    let mut all: Vec<Sought> = Vec::new();
    for name in followed {
        let Some((column, kind)) = CalibrationKind::of(name) else { continue };
        let (Some(column), Some(symbol)) = (system.find_symbol(column), system.find_symbol(name)) else {
            continue;
        };
        let place = all.iter().position(|other| other.column == column).unwrap_or_else(|| {
            all.push(Sought { column, gain: None, bias: None, delay: None });
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

/// Puts what is sought of the columns into rates and outputs: outputs that are followed states are read with gain and bias, and what
/// stands for a column elsewhere is what was read without them.
pub(super) fn put_in(
    system: &mut System,
    followed: &[String],
    rates: &mut [NodeId],
    outputs: &mut [(String, NodeId)],
) {
    let all = sought(system, followed);
    let mut true_values = HashMap::new();
    for Sought { column, gain, bias, .. } in all {
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
        // what is read of a column that stands for itself is that column
        if system.find_symbol(name).is_none_or(|symbol| !true_values.contains_key(&symbol)) {
            *node = system.graph.substitute(&[*node], &true_values)[0];
        }
    }
}
