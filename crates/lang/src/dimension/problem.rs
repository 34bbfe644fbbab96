//! What is asked of two dimensions, and in which words.

use super::form::Form;

/// What is asked of two dimensions.
#[derive(Clone, Debug)]
pub(super) enum Asked {
    /// Terms of a sum, and the sign between them.
    Sum(String),
    /// Two sides, and the relation between them.
    Relation(String),
    /// The products that a calculation with matrices adds, and its name.
    Products(&'static str),
    /// The argument of a function has none.
    Argument(String),
    /// The arguments of a function that compares them.
    Arguments(String),
    /// An exponent has none.
    Exponent,
    /// What a symbol is replaced by.
    Replaced(String),
    /// The rate of a state in a field.
    Rate { state: String, field: String },
    /// What a definition, output or symbol is declared to be.
    Declared(String),
    /// The tolerance of a relation.
    Tolerance,
    /// Angles are numbers.
    Angle(String),
    /// What a file that is imported takes a symbol for.
    Imported(String),
}

impl Asked {
    pub(super) fn message(&self, left: &str, right: &str) -> String {
        match self {
            Asked::Sum(sign) => format!("terms of two dimensions: {left} {sign} {right}"),
            Asked::Relation(sign) => format!("two sides of two dimensions: {left} {sign} {right}"),
            Asked::Products(what) => format!("{what} adds products of two dimensions: {left} + {right}"),
            Asked::Argument(name) => format!("'{name}' takes a number without dimension, not {left}"),
            Asked::Arguments(name) => format!("'{name}' of two dimensions: {left} and {right}"),
            Asked::Exponent => format!("an exponent is a number without dimension, not {left}"),
            Asked::Replaced(name) => format!("'{name}' is {left}, and what stands for it is {right}"),
            Asked::Rate { state, field } => {
                format!("in '{field}' the rate of '{state}' has to be {left}, and is {right}")
            }
            Asked::Declared(name) => format!("'{name}' is declared as {left}, and is {right}"),
            Asked::Tolerance => format!("what is compared is {left}, and its tolerance {right}"),
            Asked::Angle(name) => format!("'{name}' is declared as {left}, and an angle is a number"),
            Asked::Imported(name) => format!("'{name}' is {left} here, and {right} in the imported file"),
        }
    }

    pub(super) fn label(&self) -> &'static str {
        match self {
            Asked::Sum(_) => "these cannot be added",
            Asked::Relation(_) => "these cannot be compared",
            Asked::Products(_) => "in this",
            Asked::Argument(_) | Asked::Arguments(_) => "this function",
            Asked::Exponent => "this exponent",
            Asked::Replaced(_) | Asked::Rate { .. } => "of two dimensions",
            Asked::Declared(_) => "this is something else",
            Asked::Tolerance => "this tolerance",
            Asked::Angle(_) => "this angle",
            Asked::Imported(_) => "imported here",
        }
    }

    pub(super) fn advice(&self, sides: [&Form; 2]) -> Option<&'static str> {
        let is_number = |form: &Form| form.unknown.is_empty() && form.known.is_none();
        let beside_a_number = sides.iter().any(|side| is_number(side));
        match self {
            Asked::Sum(_) | Asked::Relation(_) | Asked::Rate { .. } if beside_a_number => Some(
                "a number has no dimension; give what it stands for a name and a dimension, as in \
                 'param k : length = 2'",
            ),
            Asked::Argument(_) | Asked::Exponent => Some("divide by something of the same dimension"),
            _ => None,
        }
    }
}
