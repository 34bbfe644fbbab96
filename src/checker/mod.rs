//! A small checker of what the engines found, which shares nothing with them.
//!
//! An engine that refutes, certifies or proves writes down what its verdict rests on: a [`Listing`] of operations as plain
//! data, a state in exact numbers, the two sides, a minor. The checker reads that and evaluates it again, naively, one
//! operation after the other: a [`Refutation`] at its witness, a [`CertifiedRank`] by its minor and its kernel, a
//! [`StatedIdentity`] and a [`ClaimedRank`] at states of its own choice. It cannot check the step from a file's text to expressions and their
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

pub use boxes::{CertifiedBox, CertifiedBoxes, SymbolRange};
pub use claimed_rank::{ClaimedRank, ClaimedWord};
pub use doubt::{Doubt, Effort, Finding, Missing};
pub use evaluation::{Difference, Evaluation, PRECISIONS};
pub use exact::{Exact, Form};
pub use file::{CheckedVerdict, Evidence, LARGEST_FILE, Unreadable, VerdictFile, VerdictRecord};
pub use identity::StatedIdentity;
pub use listing::{Listing, MOST_STEPS, Step};
pub use minor::{CertifiedRank, Minor, RankedState};
pub use state::{ExactCoordinate, ExactState, Ratio};
pub use witness::{PrintedSides, Refutation, Requirement, RequirementKind, Sides, SidesRelation};
