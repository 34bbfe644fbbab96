//! Systems in discrete time: `x+ = e` says what a state is after a step. The drift is a map `F`, `L(f, e)` is `e` after a step,
//! that is `e o F`, and a word of so many fields the output after so many steps.
//!
//! What a state is not said to become it stays. A known signal has any value at every step, and the values of later steps are
//! symbols of their own; an unknown one moves by its differences, `w+ = w + w'`, up to the order that is assumed.

use super::codes::Code;
use super::error::Problem;
use super::model::{Field, FieldPlace, Role, System, Time};
use super::signals::NOWHERE;
use palmistry_math::expression::syntax::{Expr, Name, Span};
use palmistry_math::expression::{Derivation, Guard, NodeId, Symbol, signal_of};

impl System {
    /// Refuses the name of a field that is taken, or one whose time is not that of the others.
    pub(super) fn refuse_field(&mut self, name: &Name, time: Time) -> Result<(), Problem> {
        if name.text.contains('.') {
            let message = "a name with a dot belongs to an imported system";
            return Err(Problem::new(Code::Name, &name.span, message, "choose one without"));
        }
        if self.field(&name.text).is_some() {
            return Err(Problem::new(
                Code::Twice,
                &name.span,
                format!("there is a field '{}' already", name.text),
                "the second one",
            ));
        }
        if let Some(first) = self.fields.first()
            && self.time != time
        {
            let message = format!("the field '{}' above is one of another time", first.name);
            return Err(Problem::new(Code::Time, &name.span, message, "x' and x+ in one system")
                .help("x' is a rate of change, x+ the value after a step: a system has one of the two"));
        }
        self.time = time;
        Ok(())
    }

    /// Enters what takes states to their successors.
    pub(super) fn enter_map(
        &mut self,
        role: Role,
        name: Name,
        components: &[(Name, Expr)],
    ) -> Result<(), Problem> {
        self.refuse_field(&name, Time::Discrete)?;
        if role == Role::Input {
            let message = "in discrete time an input is a known signal, and no field";
            return Err(Problem::new(Code::Time, &name.span, message, "an input of steps")
                .help("declare 'known u(t)', and write u where the drift depends on it"));
        }
        if role == Role::Drift
            && let Some(first) = self.drift()
        {
            let message = format!("there is a drift '{}' already", self.fields[first].name);
            return Err(Problem::new(Code::Twice, &name.span, message, "the second one")
                .help(format!("write 'field {}' if it is only composed with", name.text)));
        }
        let (mut successors, mut guards) = self.rates_as_written(role, &name, components)?;
        let written = self.written_components(components);
        if role == Role::Drift {
            self.complete_drift(&mut successors, &mut guards);
        }
        self.add_map(name.text, role, name.span, successors, guards);
        if let Some(field) = self.fields.last_mut() {
            field.written = written;
        }
        Ok(())
    }

    fn add_map(
        &mut self,
        name: String,
        role: Role,
        span: Span,
        components: Vec<(Symbol, NodeId)>,
        guards: Vec<Vec<Guard>>,
    ) {
        let fresh = if role == Role::Drift { self.known_signals() } else { Vec::new() };
        let derivation = Derivation::composition(&self.graph, components.iter().copied().collect(), &fresh);
        self.field_places.insert(name.clone(), FieldPlace::Own(self.fields.len()));
        let written = Default::default();
        self.fields.push(Field { name, role, span, components, guards, written, derivation });
    }

    /// What is still to be said of signals, where time is discrete.
    pub(super) fn finish_discrete_signals(&mut self) -> Result<(), Problem> {
        for signal in &self.coordinates.signals {
            if signal.is_known && signal.chain.len() > 1 {
                let name = self.symbol_name(signal.chain[0]).to_owned();
                let message = format!("in discrete time '{name}' has no derivatives");
                return Err(Problem::new(
                    Code::Time,
                    &signal.span,
                    message,
                    "a known signal has any value at every step",
                )
                .help("declare what it was a step before as a state, as in before+ = u"));
            }
        }
        if self.drift().is_none() && !self.coordinates.signals.is_empty() {
            let (mut successors, mut guards) = (Vec::new(), Vec::new());
            self.complete_drift(&mut successors, &mut guards);
            self.add_map("signals".to_owned(), Role::Drift, NOWHERE, successors, guards);
        }
        Ok(())
    }

    /// The signals that somebody knows, of all experiments.
    pub fn known_signals(&self) -> Vec<Symbol> {
        let known = self.coordinates.signals.iter().filter(|signal| signal.is_known);
        known.filter_map(|signal| signal.chain.first().copied()).collect()
    }

    /// The signal of which a symbol is the value some steps later; every other symbol is itself.
    pub fn now(&self, symbol: Symbol) -> Symbol {
        signal_of(self.symbol_name(symbol)).and_then(|name| self.find_symbol(name)).unwrap_or(symbol)
    }

    /// Nothing, where time is continuous.
    ///
    /// # Errors
    /// In words, for what knows only of rates.
    pub fn require_continuous(&self, what: &str) -> Result<(), String> {
        match self.time {
            Time::Continuous => Ok(()),
            Time::Discrete => Err(format!("{}: {what}, and this one moves in steps (x+ = ...)", self.name)),
        }
    }
}
