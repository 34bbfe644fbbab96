//! The values of a script: numbers, matrices and lists, row by row.

use super::super::expression::ForeignExpr;

/// A matrix with more entries is refused.
pub(super) const MOST_ENTRIES: usize = 20_000;

/// What a name stands for.
#[derive(Clone, Debug)]
pub(crate) enum ScriptValue {
    /// A number: an expression of symbols and definitions.
    One(ForeignExpr),
    /// A matrix, row by row; a list is a column.
    Many { rows: usize, entries: Vec<ForeignExpr>, form: Form },
    /// Something that is no number and no matrix.
    Else,
}

/// What a matrix is in its language: by that it is joined and multiplied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// Of MATLAB, or of SymPy.
    Matrix,
    /// A list of Python.
    List,
    /// A list of lists of Python.
    Rows,
    /// An array of numpy with one index.
    Vector,
    /// An array of numpy with two.
    Array,
}

impl Form {
    pub fn is_list(self) -> bool {
        matches!(self, Form::List | Form::Rows)
    }
}

impl ScriptValue {
    /// All entries, as they are.
    pub(super) fn parts(&self) -> &[ForeignExpr] {
        match self {
            ScriptValue::One(one) => std::slice::from_ref(one),
            ScriptValue::Many { entries, .. } => entries,
            ScriptValue::Else => &[],
        }
    }

    /// All entries, row by row.
    pub fn entries(self) -> Option<Vec<ForeignExpr>> {
        match self {
            ScriptValue::One(one) => Some(vec![one]),
            ScriptValue::Many { entries, .. } => Some(entries),
            ScriptValue::Else => None,
        }
    }
}
