//! What a system says of its dimensions.

use super::check::problems_of;
use super::exponents::Dimension;
use super::quantity::{Entry, Quantity};
use crate::expression::Symbol;
use crate::system::error::ReadError;
use crate::system::grammar::Statement;
use crate::system::model::System;

impl System {
    /// Whether the file, or one that it imports, declares a dimension; without, nothing is known and nothing checked.
    pub fn declares_dimensions(&self) -> bool {
        self.dimensions.is_declared
    }

    /// The dimension of a symbol, declared or inferred.
    ///
    /// ```
    /// use palmistry::System;
    /// let text = r#"
    ///     system "A stone falls"
    ///     state x : length, v
    ///     param g : acceleration = -9.81
    ///     drift f
    ///       x' = v
    ///       v' = g
    /// "#;
    /// let system = System::parse("stone.proof", text, std::path::Path::new(""))?;
    /// let v = system.dimension_of(system.find_symbol("v").unwrap()).unwrap();
    /// assert_eq!((v.to_string(), v.unit()), ("length/time".to_owned(), "m/s".to_owned()));
    /// # Ok::<(), palmistry::ReadError>(())
    /// ```
    pub fn dimension_of(&self, symbol: Symbol) -> Option<&Dimension> {
        self.dimensions.of(symbol)
    }

    /// The dimension of a definition in words, as far as it is known: of a matrix, that of all entries where they have one.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))] // editors ask for it
    pub(crate) fn dimension_of_definition(&self, name: &str) -> Option<String> {
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
        found.map(|dimension| match dimension.is_none() {
            true => "without dimension".to_owned(),
            false => format!("dimension {dimension} ({})", dimension.unit()),
        })
    }

    /// Whether the numbers of a state in other units are those of the file's units, each times what its dimension says, and
    /// nothing else changes: dimensions are declared, all that the file defines has a known one, and no definition, field or
    /// output holds a number in place of something that has a unit, as in `e at {x = 2}`.
    pub fn dimensions_tell_units(&self) -> bool {
        self.dimensions.is_declared && !self.dimensions.holds_units
    }

    /// The mistakes in the dimensions of a statement about this system: none where nothing is declared. What an erratum
    /// prints may have some; what a file claims has none, or the file would not have been read.
    pub fn dimension_mistakes(&self, statement: &Statement) -> Vec<ReadError> {
        let problems = problems_of(self, statement);
        problems.into_iter().map(|problem| problem.locate(&self.name, &self.source)).collect()
    }
}
