//! Which coordinates of the state space are known, and what those are that are not.
//!
//! Whatever a file declares becomes a coordinate with a rate: a constant that is to be identified, a signal that somebody
//! knows, one that nobody does. Ranks, dimensions and differentials count those that are *unknown*; a known one moves, is
//! drawn, and has no column.

use super::model::System;
use dashu::rational::RBig;
use palmistry_math::expression::syntax::{Equation, ExprKind, Span};
use palmistry_math::expression::{NodeId, Symbol};
use std::collections::{BTreeMap, BTreeSet};

/// What an unknown coordinate stands for in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum UnknownKind {
    /// A state: it is *observable* or not.
    State,
    /// A constant, declared with `param k unknown`: it is *identifiable* or not.
    Parameter,
    /// An unknown signal, or one of its derivatives.
    Signal,
}

impl UnknownKind {
    /// In one word, for tables.
    pub fn name(self) -> &'static str {
        match self {
            UnknownKind::State => "state",
            UnknownKind::Parameter => "parameter",
            UnknownKind::Signal => "signal",
        }
    }
}

/// A signal and those of its derivatives that are coordinates, itself first. Each moves as the next one says; the last of a
/// known signal is driven by a field of its own, the last of an unknown one stands still.
#[derive(Clone, Debug)]
pub(crate) struct Signal {
    pub is_known: bool,
    /// Whether the file itself says how many derivatives of it there are.
    pub has_order: bool,
    pub chain: Vec<Symbol>,
    pub span: Span,
}

/// What the coordinates of a system were declared as.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coordinates {
    /// Those of the first experiment, and what is the same in all, in the order of the file.
    pub own: Vec<Symbol>,
    /// What they are, where they are no states.
    pub kinds: BTreeMap<Symbol, UnknownKind>,
    /// The signals of all experiments.
    pub signals: Vec<Signal>,
    /// Values near which unknown constants are drawn.
    pub hints: BTreeMap<Symbol, RBig>,
    /// What the file says of values at the beginning.
    pub initial: Vec<Equation>,
    /// Those whose initial condition is known, and whose rates may depend on what is not.
    pub known_at_first: BTreeSet<Symbol>,
    /// The outputs that are zero.
    pub zero_outputs: Vec<NodeId>,
    /// How long words may be where there are such: known signals have derivatives up to there.
    pub highest_lie_order: Option<usize>,
    /// How many experiments are made beside the first one.
    pub further_experiments: usize,
    /// Whether the file has said so.
    pub experiments_said: bool,
    /// What a coordinate of the first experiment is in each of the others.
    pub copies: BTreeMap<Symbol, Vec<Symbol>>,
}

impl System {
    /// The coordinates that are not known, in the order of [`System::states`]: the columns of every codistribution. Their
    /// number is the dimension that a rank is measured against.
    pub fn unknowns(&self) -> Vec<Symbol> {
        self.states.iter().copied().filter(|state| !self.known.contains(state)).collect()
    }

    /// How many coordinates are not known: the rank at which all is seen.
    pub fn unknown_count(&self) -> usize {
        self.states.len() - self.known.len()
    }

    /// What an unknown coordinate is; nothing for a known one, and for what is no coordinate.
    pub fn unknown_kind(&self, symbol: Symbol) -> Option<UnknownKind> {
        if self.known.contains(&symbol) || !self.states.contains(&symbol) {
            return None;
        }
        Some(self.coordinates.kinds.get(&symbol).copied().unwrap_or(UnknownKind::State))
    }

    /// The coordinates whose differentials no field leads out of: all but the known signals, whose rates are known too. A
    /// state whose initial condition is known is among them, for its rate need not be known.
    pub fn closed_coordinates(&self) -> Vec<Symbol> {
        let at_first = &self.coordinates.known_at_first;
        let kept = |state: &Symbol| !self.known.contains(state) || at_first.contains(state);
        self.states.iter().copied().filter(kept).collect()
    }

    /// The signals, each with those of its derivatives that are coordinates, itself first.
    pub fn signal_chains(&self) -> Vec<Vec<Symbol>> {
        self.coordinates.signals.iter().map(|signal| signal.chain.clone()).collect()
    }

    /// The value near which an unknown constant is drawn, where the file gives one.
    pub fn hint(&self, symbol: Symbol) -> Option<&RBig> {
        self.coordinates.hints.get(&symbol)
    }

    /// The names of the unknown coordinates, in their order.
    pub fn column_names(&self) -> Vec<String> {
        self.unknowns().into_iter().map(|symbol| self.symbol_name(symbol).to_owned()).collect()
    }

    /// The names of the known coordinates, in their order.
    pub fn known_names(&self) -> Vec<String> {
        let known = self.states.iter().filter(|state| self.known.contains(state));
        known.map(|symbol| self.symbol_name(*symbol).to_owned()).collect()
    }

    /// What a symbol stands for, in words, where it is no plain state and no plain parameter.
    pub fn stands_for(&self, symbol: Symbol) -> Option<String> {
        let kind = self.coordinates.kinds.get(&symbol);
        let words = match kind {
            _ if self.coordinates.known_at_first.contains(&symbol) => "known initial condition",
            Some(UnknownKind::Parameter) => "a constant that is to be identified",
            Some(UnknownKind::Signal) if self.known.contains(&symbol) => "a signal that is known",
            Some(UnknownKind::Signal) => "a signal that is not known",
            _ => return None,
        };
        let signals = &self.coordinates.signals;
        let last = signals.iter().find(|signal| !signal.is_known && signal.chain.contains(&symbol));
        let assumed = last.and_then(|signal| signal.chain.last());
        let assumed = assumed
            .map(|last| format!(", with {} = 0", next_derivative(self.symbol_name(*last))))
            .unwrap_or_default();
        Some(format!("{words}{assumed}"))
    }

    /// What the file says of values at the beginning, as conditions: `initial x = 0`. A rank is that at states which meet
    /// them.
    pub fn initial_conditions(&self) -> &[Equation] {
        &self.coordinates.initial
    }

    /// A state whose value at the beginning is told by parameters, and not a number.
    pub fn initial_value_without_a_number(&self) -> Option<&str> {
        let has_number = |symbol: Symbol| {
            let range = self.symbol_info(symbol).and_then(|info| info.range.as_ref());
            range.is_some_and(|range| range.low == range.high)
        };
        self.coordinates.initial.iter().find_map(|equation| match &equation.left.kind {
            ExprKind::Name(name) => {
                self.find_symbol(name).filter(|symbol| !has_number(*symbol)).map(|_| name.as_str())
            }
            _ => None,
        })
    }

    /// The outputs that are zero, `output 0 = y(x, u)`: they tie known signals to states.
    pub fn zero_outputs(&self) -> Vec<NodeId> {
        self.coordinates.zero_outputs.clone()
    }

    /// How long words may be, where known signals have derivatives up to an order only since outputs tie them.
    pub fn highest_lie_order(&self) -> Option<usize> {
        self.coordinates.highest_lie_order
    }

    /// The how manieth derivative of a signal a symbol is.
    pub fn derivative_of_signal(&self, symbol: Symbol) -> Option<usize> {
        let mut signals = self.coordinates.signals.iter();
        signals.find_map(|signal| signal.chain.iter().position(|link| *link == symbol))
    }

    /// The derivative of a signal, or of one of its derivatives, where there is a symbol for it.
    pub fn next_derivative_of_signal(&self, symbol: Symbol) -> Option<Symbol> {
        let mut pairs = self.coordinates.signals.iter().flat_map(|signal| signal.chain.windows(2));
        pairs.find_map(|pair| (pair[0] == symbol).then_some(pair[1]))
    }

    /// Whether a symbol is the last derivative that is taken of a signal that outputs tie: its rate is nothing that is known.
    pub fn is_cut_off(&self, symbol: Symbol) -> bool {
        let last = |signal: &Signal| signal.is_known && signal.chain.last() == Some(&symbol);
        self.highest_lie_order().is_some() && self.coordinates.signals.iter().any(last)
    }

    /// What is assumed of unknown signals: that a derivative vanishes, as `w'' = 0`.
    pub fn assumed_of_signals(&self) -> Vec<String> {
        let unknown = self.coordinates.signals.iter().filter(|signal| !signal.is_known);
        let last = unknown.filter_map(|signal| signal.chain.last());
        last.map(|last| format!("{} = 0", next_derivative(self.symbol_name(*last)))).collect()
    }
}

/// The name of the derivative of a signal: `u'` of `u`, `u''@2` of `u'@2`.
pub(super) fn next_derivative(name: &str) -> String {
    match name.split_once('@') {
        Some((base, experiment)) => format!("{base}'@{experiment}"),
        None => format!("{name}'"),
    }
}
