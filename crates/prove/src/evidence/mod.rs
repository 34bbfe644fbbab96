//! What verdicts rest on, written down for the checker.
//!
//! The checker's `Lowering` turns nodes of the graph into a `palmistry_checker::Listing`, as they were read and without any
//! simplification of its own; [`rank_records`] writes the ranks of a sweep, each with its minor and its kernel, [`certificate_file`] proved boxes
//! with their minors.
//!
//! This floor decides nothing: what it writes is checked by code that does not trust it.

mod boxes;
mod minors;
mod ranks;
mod statements;
mod states;

#[doc(hidden)]
pub use boxes::{WrittenBoxes, certificate_file};
pub(crate) use minors::largest_minor;
#[doc(hidden)]
pub use palmistry_checker::Lowering;
#[doc(hidden)]
pub use ranks::rank_records;
pub(crate) use statements::StatementAt;
pub(crate) use states::exact_state;

/// Why evidence could not be written down.
#[derive(Debug, thiserror::Error)]
pub enum NotWritten {
    #[error("what the verdict rests on is too long to be written down: {0}")]
    TooLong(#[from] palmistry_checker::Missing),
    #[error("a condition cannot be read: {0}")]
    Condition(String),
}
