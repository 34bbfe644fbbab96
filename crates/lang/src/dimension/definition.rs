//! Dimensions in words, as editors show them beside a name.

use super::exponents::Dimension;
use super::quantity::{Entry, Quantity};
use crate::model::System;

impl Dimension {
    /// `dimension length/time (m/s)`.
    pub fn in_words(&self) -> String {
        match self.is_none() {
            true => "without dimension".to_owned(),
            false => format!("dimension {self} ({})", self.unit()),
        }
    }
}

impl System {
    /// The dimension of a definition in words, as far as it is known: of a matrix, that of all entries where they have one.
    pub fn dimension_of_definition(&self, name: &str) -> Option<String> {
        let Quantity::Table(table) = self.dimensions.definitions.get(name)? else { return None };
        let mut solution = self.dimensions.solution.clone();
        let mut found: Option<Dimension> = None;
        for entry in &table.entries {
            match entry {
                Entry::Zero => {}
                Entry::Open => return None,
                Entry::Of(form) => {
                    let dimension = solution.dimension(form)?;
                    if found.as_ref().is_some_and(|known| *known != dimension) {
                        return Some("entries of several dimensions".to_owned());
                    }
                    found = Some(dimension);
                }
            }
        }
        found.as_ref().map(Dimension::in_words)
    }
}
