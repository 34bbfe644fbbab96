//! Systems of the witness, and how they are written down.

use super::expression::{Expression, Symbol};

/// How `rank` finds the fields that count. Where it is set, fields are written with their roles, `drift` and `input`,
/// and a plain `field` is only differentiated along.
pub const ROLES_ARE_WRITTEN: bool = true;

/// What a field is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    Drift,
    Input,
    /// Only differentiated along.
    Plain,
}

/// A vector field: a rate for each state, in their order.
#[derive(Clone, Debug)]
pub struct Field {
    pub name: String,
    pub role: Role,
    /// Whether `rank` takes words of it.
    pub counts: bool,
    pub rates: Vec<Expression>,
}

impl Field {
    pub fn new(name: &str, role: Role, rates: Vec<Expression>) -> Field {
        Field { name: name.to_owned(), role, counts: role != Role::Plain, rates }
    }

    fn text(&self, states: &[Symbol]) -> String {
        let word = match self.role {
            Role::Drift if ROLES_ARE_WRITTEN => "drift",
            Role::Input if ROLES_ARE_WRITTEN => "input",
            _ => "field",
        };
        let mut text = format!("{word} {}\n", self.name);
        for (state, rate) in states.iter().zip(&self.rates) {
            text.push_str(&format!("  {state}' = {}\n", rate.text()));
        }
        text
    }
}

/// A control system.
#[derive(Clone, Debug, Default)]
pub struct Model {
    pub states: Vec<Symbol>,
    /// Symbols beside the states, with the text of a value that is a default and no more.
    pub parameters: Vec<(Symbol, Option<String>)>,
    /// Those of the symbols that stand inside sines and cosines only.
    pub angles: Vec<Symbol>,
    pub fields: Vec<Field>,
    pub outputs: Vec<Expression>,
}

impl Model {
    /// The entries of a proof file that come before the claims.
    pub fn text(&self) -> String {
        let mut text = format!("system \"drawn\"\nstate {}\n", self.states.join(", "));
        for (name, value) in &self.parameters {
            match value {
                Some(value) => text.push_str(&format!("param {name} = {value}\n")),
                None => text.push_str(&format!("param {name}\n")),
            }
        }
        if !self.angles.is_empty() {
            text.push_str(&format!("angle {}\n", self.angles.join(", ")));
        }
        for field in &self.fields {
            text.push_str(&field.text(&self.states));
        }
        if !self.outputs.is_empty() {
            let outputs: Vec<String> = self.outputs.iter().map(Expression::text).collect();
            text.push_str(&format!("output {}\n", outputs.join(", ")));
        }
        text
    }

    /// All symbols, states first.
    pub fn symbols(&self) -> Vec<Symbol> {
        self.states.iter().copied().chain(self.parameters.iter().map(|(name, _)| *name)).collect()
    }
}
