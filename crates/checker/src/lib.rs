//! A small checker of what the engines found, which shares none of their code.
//!
//! An engine that refutes, certifies or proves writes down what its verdict rests on: a `Listing` of operations as plain
//! data, a state in exact numbers, the two sides, a minor. The checker reads the claim from the proof file, builds its sides and
//! rows anew, and evaluates them naively, one operation after the other: a `Refutation` at its witness, a `CertifiedRank` by its
//! minor and its kernel, a `StatedIdentity` and a `ClaimedRank` at states of its own choice. Equations and generic ranks it shows
//! by itself, by multiplying out and by elimination (`normal`), or at random points modulo random primes (`modular`). The words of its findings are explained in `book/src/verdicts.md`.
//!
//! This floor knows exact numbers ([`palmistry_math::number`]), expressions with their derivatives, and the reader of proof files
//! ([`palmistry_lang`]); none of the engines.

#![warn(missing_docs)]

mod binding;
mod bound;
mod bound_drawn;
mod bound_rank;
mod bound_span;
mod boxes;
mod checking;
mod claim;
mod claimed_rank;
mod doubt;
mod evaluation;
mod exact;
mod file;
mod identity;
mod listing;
mod lowering;
mod minor;
mod modular;
mod normal;
mod own_matrix;
mod piece;
mod record;
mod sources;
mod state;
mod witness;

#[doc(hidden)]
pub use binding::listed_statement;
pub use binding::{ClaimKind, ClaimParts, ClaimSense, RecordedWord};
#[doc(hidden)]
pub use boxes::{CertifiedBox, CertifiedBoxes, SymbolRange};
pub use checking::Checking;
#[doc(hidden)]
pub use claimed_rank::{ClaimedRank, ClaimedWord};
#[doc(hidden)]
pub use doubt::Missing;
pub use doubt::{Doubt, Effort, Finding, Half, ShownBy, Unchecked};
#[doc(hidden)]
pub use file::LARGEST_FILE;
pub use file::{CheckedVerdict, Unreadable, VerdictFile};
#[doc(hidden)]
pub use identity::StatedIdentity;
#[doc(hidden)]
pub use listing::Listing;
#[doc(hidden)]
pub use lowering::Lowering;
#[doc(hidden)]
pub use minor::{CertifiedRank, Minor, RankedState};
#[doc(hidden)]
pub use record::Evidence;
pub use record::VerdictRecord;
pub use sources::{ProofSources, source_digest};
#[doc(hidden)]
pub use state::{ExactCoordinate, ExactState, Ratio};
#[doc(hidden)]
pub use witness::{PrintedSides, Refutation, Requirement, Sides};
