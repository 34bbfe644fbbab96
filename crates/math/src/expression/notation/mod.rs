//! Formulas as mathematics: from the syntax of an expression to MathML and to LaTeX, by way of one [`Formula`].
//!
//! What is set means what is written: brackets stand wherever leaving them out would change the value, products and sums are
//! only regrouped where that changes nothing, and two names never look alike in one formula.

mod latex;
mod layout;
mod mathml;
mod name;
#[cfg(test)]
mod tests;

pub use latex::latex;
pub use layout::FormulaLayout;
pub use mathml::{mathml, mathml_in_pieces};
pub use name::{in_letters, letter_and_index};

use crate::expression::syntax::Relation;

/// A formula as it is set: what stands where, and in which kind of letter, but not in whose notation.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// Digits, as they are written.
    Number(String),
    /// A name with its index and accents.
    Name(FormulaName),
    /// Upright letters: `sin`, `det`.
    Word(&'static str),
    /// A name letter by letter as in the file, where its usual look would say something else.
    Literal(String),
    /// Words of a sentence between formulas.
    Text(&'static str),
    Sign(FormulaSign),
    /// One after the other.
    Row(Vec<Formula>),
    /// Above and below the line.
    Fraction(Box<Formula>, Box<Formula>),
    /// With an index and an exponent.
    Scripts {
        base: Box<Formula>,
        below: Option<Box<Formula>>,
        above: Option<Box<Formula>>,
    },
    Root(Box<Formula>),
    /// In brackets of a kind: what opens, what stands inside, what closes.
    Fence(Fence, Box<Formula>),
    /// Rows of entries.
    Matrix(Vec<Vec<Formula>>),
}

/// A sign between or before parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormulaSign {
    Plus,
    Minus,
    /// A minus before a first term.
    Negative,
    /// Between factors that would run together.
    Dot,
    /// The product of two vectors that is a vector.
    Cross,
    /// A narrow space between factors.
    Thin,
    Comma,
    /// A comma in an index, with no room behind it.
    IndexComma,
    Relation(Relation),
    /// `x` lies in an interval.
    In,
    /// A value at a point.
    At,
    Partial,
    Transpose,
}

/// Brackets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fence {
    Round,
    Square,
    Bars,
}

/// How a name looks.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct FormulaName {
    /// The system that it comes from, of `general.f`.
    pub(super) from: Vec<String>,
    /// The letters without index and accents: `omega` of `omega0`.
    pub(super) letters: String,
    /// The parts of the index: digits and words.
    pub(super) index: Vec<String>,
    /// What stands above, from the inside out.
    pub(super) accents: Vec<Accent>,
}

/// What stands above a letter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Accent {
    Dot,
    TwoDots,
    Tilde,
    Bar,
    Hat,
}

impl Formula {
    /// How many parts lie within one another.
    pub fn depth(&self) -> usize {
        let deepest =
            |parts: &mut dyn Iterator<Item = &Formula>| parts.map(Formula::depth).max().unwrap_or(0);
        1 + match self {
            Formula::Row(parts) => deepest(&mut parts.iter()),
            Formula::Fraction(a, b) => a.depth().max(b.depth()),
            Formula::Scripts { base, below, above } => {
                deepest(&mut [Some(base), below.as_ref(), above.as_ref()].into_iter().flatten().map(|f| &**f))
            }
            Formula::Root(inner) | Formula::Fence(_, inner) => inner.depth(),
            Formula::Matrix(rows) => deepest(&mut rows.iter().flatten()),
            _ => 0,
        }
    }
}
