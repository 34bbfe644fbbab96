//! A small checker of what the engines found, which shares nothing with them.
//!
//! An engine that refutes, certifies or proves writes down what its verdict rests on: a `Listing` of operations as plain
//! data, a state in exact numbers, the two sides, a minor. The checker reads that and evaluates it again, naively, one
//! operation after the other: a `Refutation` at its witness, a `CertifiedRank` by its minor and its kernel, a
//! `StatedIdentity` and a `ClaimedRank` at states of its own choice. It cannot check the step from a file's text to expressions and their
//! derivatives; what it can and cannot check is told in `book/src/verdicts.md`.
//!
//! This floor knows exact numbers ([`crate::number`]) and none of the engines: no graph, no program, no system.

mod boxes;
mod claimed_rank;
mod doubt;
mod evaluation;
mod exact;
mod file;
mod identity;
mod listing;
mod minor;
mod piece;
mod state;
mod witness;

#[doc(hidden)]
pub use boxes::CertifiedBoxes;
pub(crate) use boxes::{CertifiedBox, SymbolRange};
pub(crate) use claimed_rank::{ClaimedRank, ClaimedWord};
pub(crate) use doubt::Missing;
pub use doubt::{Doubt, Effort, Finding};
pub use file::{CheckedVerdict, Unreadable, VerdictFile, VerdictRecord};
#[doc(hidden)]
pub use file::{Evidence, LARGEST_FILE};
pub(crate) use identity::StatedIdentity;
pub(crate) use listing::{Listing, Step};
pub(crate) use minor::{CertifiedRank, Minor, RankedState};
#[doc(hidden)]
pub use state::Ratio;
pub(crate) use state::{ExactCoordinate, ExactState};
pub(crate) use witness::{PrintedSides, Refutation, Requirement, RequirementKind, Sides, SidesRelation};
