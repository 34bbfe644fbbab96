//! A system, that is its states, parameters, vector fields, outputs and sample box, and how it is read from a
//! proof file.
//!
//! [`System::read`] turns a file into a [`System`], or into a [`ReadError`] that points into the text. The claims of
//! the file are carried along as syntax; what they mean is decided two floors up.
//!
//! This floor knows nothing of ranks, verdicts or palms.

#![warn(missing_docs)]

mod advice;
mod as_written;
mod assume;
mod codes;
mod codistribution;
mod comparable;
mod components;
mod declare;
mod determinant;
mod dimension;
mod discrete;
mod domain;
mod drawn;
mod driven;
mod elaborate;
mod enter_field;
mod entries;
mod entry_words;
mod error;
mod examine;
mod excerpt;
mod extent;
mod foreign;
mod format;
mod functions;
mod given;
mod grammar;
mod imports;
mod lie;
mod looks;
mod matrices;
mod model;
mod nearby;
mod outline;
mod problems;
mod read;
mod references;
mod restates;
mod signals;
mod source_text;
mod standing;
mod syntax;
mod unknowns;
mod views;
mod visible;
#[doc(hidden)]
pub mod vocabulary;
mod written;

pub use as_written::{FieldAsWritten, SystemAsWritten};
pub use codes::Code;
#[doc(hidden)]
pub use codes::ERRORS;
pub use determinant::determinant;
pub use dimension::{Base, Dimension, ScaledUnit, scaled_unit};
#[doc(hidden)]
pub use entries::{Entry, entries_of};
pub use error::ReadError;
#[doc(hidden)]
pub use error::{Problem, boundary, line_and_column, nearest};
pub use examine::Examination;
pub use format::format_text;
pub use given::{GivenError, given_number};
#[doc(hidden)]
pub use grammar::parse_statement;
pub use model::{
    Assignment, Field, FieldRole, Kind, Looks, Matrix, Range, Role, SymbolInfo, System, Time, Value,
};
#[doc(hidden)]
pub use nearby::nearest_file;
#[doc(hidden)]
pub use outline::{Declaration, DeclarationKind, Outline, without_claims};
#[doc(hidden)]
pub use problems::{Cause, MOST_PROBLEMS};
#[doc(hidden)]
pub use source_text::{load, with_plain_line_ends};
pub use standing::{Basis, Flaw, Reference};
pub use syntax::Expectation;
#[doc(hidden)]
pub use syntax::{ClaimBody, ClaimSyntax, Statement};
pub use unknowns::UnknownKind;
#[doc(hidden)]
pub use views::{CoordinateRange, LineEnd, LineView, MapView, NamedSet, Point, ReductionTo};
#[doc(hidden)]
pub use written::in_one_line;
