//! What a system says of its dimensions.

use super::check::problems_of;
use super::exponents::Dimension;
use crate::error::ReadError;
use crate::model::System;
use crate::syntax::Statement;
use palmistry_math::expression::Symbol;

impl System {
    /// Whether the file, or one that it imports, declares a dimension; without, nothing is known and nothing checked.
    pub fn declares_dimensions(&self) -> bool {
        self.dimensions.is_declared
    }

    /// The dimension of a symbol, declared or inferred.
    ///
    /// ```
    /// use palmistry_lang::System;
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
    /// # Ok::<(), palmistry_lang::ReadError>(())
    /// ```
    pub fn dimension_of(&self, symbol: Symbol) -> Option<&Dimension> {
        self.dimensions.of(symbol)
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
