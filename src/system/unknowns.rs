//! Which coordinates of the state space are known, and what those are that are not.
//!
//! Whatever a file declares becomes a coordinate with a rate: a constant that is to be identified, a signal that somebody
//! knows, one that nobody does. Ranks, dimensions and differentials count those that are *unknown*; a known one moves, is
//! drawn, and has no column.

use super::model::System;
use crate::expression::Symbol;

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
        Some(self.unknown_kinds.get(&symbol).copied().unwrap_or(UnknownKind::State))
    }

    /// The names of the unknown coordinates, in their order.
    pub(crate) fn column_names(&self) -> Vec<String> {
        self.unknowns().into_iter().map(|symbol| self.symbol_name(symbol).to_owned()).collect()
    }
}
