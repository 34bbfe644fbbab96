//! A field as it stands in the file: what it says of each state, and where that exists.

use super::codes::Code;
use super::declare::in_words;
use super::elaborate::Wanted;
use super::error::Problem;
use super::model::{Field, FieldPlace, Kind, Role, System, Time};
use super::written::{Scope, Written, places_in};
use palmistry_math::expression::syntax::{Expr, Name, Span};
use palmistry_math::expression::{Derivation, Guard, NodeId, Symbol};
use std::collections::HashSet;

/// What a field says of states, and where each component exists.
pub(super) type Components = (Vec<(Symbol, NodeId)>, Vec<Vec<Guard>>);

impl System {
    pub(super) fn enter_field(
        &mut self,
        role: Role,
        name: Name,
        components: &[(Name, Expr)],
        others_are_zero: bool,
    ) -> Result<(), Problem> {
        self.refuse_field(&name, Time::Continuous)?;
        // asked in this order: a file of many fields is not gone through for each of them
        if role == Role::Drift
            && let Some(first) = self.drift()
        {
            let message = format!("there is a drift '{}' already", self.fields[first].name);
            return Err(Problem::new(Code::Twice, &name.span, message, "the second one").help(format!(
                "write 'input {0}' if it is driven, 'field {0}' if it is only differentiated along",
                name.text
            )));
        }
        let (mut rates, mut guards) = self.rates_as_written(role, &name, components)?;
        let moved: HashSet<Symbol> = rates.iter().map(|(symbol, _)| *symbol).collect();
        let missing = self.moving_states().find(|state| !moved.contains(state));
        if let (Some(missing), false) = (missing, others_are_zero) {
            let message =
                format!("the field '{}' does not say how '{}' moves", name.text, self.symbol_name(missing));
            return Err(Problem::new(Code::Field, &name.span, message, "this field")
                .help(match (rates.is_empty(), role) {
                    (true, Role::Input) => format!(
                        "an input field has a rate for each state below its name; a signal that drives the system is declared with 'known {}(t)'",
                        name.text
                    ),
                    (true, _) => format!(
                        "write a rate for each state below its name (and no ':' behind it), as in {}' = ...",
                        self.symbol_name(missing)
                    ),
                    _ => "end it with: others' = 0, if the states that it does not name stand still".to_owned(),
                }));
        }
        let written = self.written_components(components);
        let written = if others_are_zero { written.followed_by("others' = 0") } else { written };
        let mut fields = Vec::new();
        match role {
            Role::Drift => self.complete_drift(&mut rates, &mut guards),
            Role::Input => {
                for (experiment, copies) in self.further_experiments() {
                    let (rates, guards) = self.in_experiment(&rates, &guards, &copies);
                    fields.push((in_words(&name.text, experiment), rates, guards));
                }
            }
            Role::Other => {}
        }
        fields.insert(0, (name.text, rates, guards));
        for (title, rates, guards) in fields {
            let derivation = Derivation::new(rates.iter().copied().collect());
            self.field_places.insert(title.clone(), FieldPlace::Own(self.fields.len()));
            self.fields.push(Field {
                name: title,
                role,
                span: name.span.clone(),
                components: rates,
                guards,
                written: written.clone(),
                derivation,
            });
        }
        Ok(())
    }

    /// The components of a field as they are written.
    pub(super) fn written_components(&self, components: &[(Name, Expr)]) -> Written {
        match (components.first(), components.last()) {
            (Some((first, _)), Some((_, last))) => {
                self.written_as(&(first.span.start..last.span.end), components.iter().map(|(_, expr)| expr))
            }
            _ => Written::default(),
        }
    }

    /// What a field says of each state that it names, and where that exists.
    pub(super) fn rates_as_written(
        &mut self,
        role: Role,
        name: &Name,
        components: &[(Name, Expr)],
    ) -> Result<Components, Problem> {
        let mut rates: Vec<(Symbol, _)> = Vec::new();
        let mut moved: HashSet<Symbol> = HashSet::new();
        let mut guards = Vec::new();
        for (state, expr) in components {
            let is_state =
                |symbol: &Symbol| self.symbol_info(*symbol).is_some_and(|info| info.kind == Kind::State);
            let symbol = self.find_symbol(&state.text).filter(is_state);
            let Some(symbol) = symbol else {
                return Err(self.unknown(&state.text, &state.span, Wanted::State));
            };
            self.refuse_rate(role, symbol, &state.span)?;
            if !moved.insert(symbol) {
                let message = format!("'{}' is given twice in the field '{}'", state.text, name.text);
                return Err(Problem::new(Code::Twice, &state.span, message, "the second time")
                    .help("leave one of the two out"));
            }
            let (rate, domain) = self.apart(|system| system.scalar(expr))?;
            self.refuse_without_value(expr)?;
            rates.push((symbol, rate));
            guards.push(self.guards_of(&domain));
        }
        Ok((rates, guards))
    }

    /// Some expressions as they are written, within a span that holds them all.
    pub(super) fn written_as<'a>(
        &self,
        span: &Span,
        expressions: impl IntoIterator<Item = &'a Expr>,
    ) -> Written {
        let states = || self.column_names();
        let is_definition = |name: &str| self.definitions.contains_key(name);
        let scope = Scope { source: &self.source, is_definition: &is_definition, states: &states };
        let mut places = Vec::new();
        for expr in expressions {
            places_in(&scope, expr, &mut places);
        }
        Written::new(&self.source, span, places)
    }
}
