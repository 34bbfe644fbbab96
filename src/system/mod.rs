//! A system, that is its states, parameters, vector fields, outputs and sample box, and how it is read from a
//! proof file.
//!
//! [`System::read`] turns a file into a [`System`], or into a [`ReadError`] that points into the text. The claims of
//! the file are carried along as syntax; what they mean is decided two floors up.
//!
//! This floor knows nothing of ranks, verdicts or palms.

mod determinant;
mod dimension;
mod domain;
mod elaborate;
mod error;
mod extent;
mod format;
mod grammar;
mod lie;
mod matrices;
mod model;
mod outline;
mod problems;
mod read;
mod references;
mod restates;
mod standing;
mod views;
#[doc(hidden)]
pub mod vocabulary;
mod written;

pub use dimension::{Base, Dimension};
pub use error::ReadError;
pub(crate) use error::{Problem, boundary, line_and_column, nearest};
pub use format::format_text;
pub use grammar::{ClaimBody, ClaimSyntax, Expectation, Statement, parse_statement};
pub use model::{
    Assignment, Explanations, Field, FieldRole, Kind, Matrix, Range, Role, SymbolInfo, System, Value,
};
pub(crate) use outline::{Declaration, DeclarationKind, Outline};
pub use problems::MOST_PROBLEMS;
pub use read::Examination;
pub(crate) use read::{load, with_plain_line_ends};
pub use standing::{Basis, Flaw, Reference};
pub use views::{LineEnd, LineView, MapView, NamedSet, Point, ReductionTo};
pub(crate) use written::in_one_line;
