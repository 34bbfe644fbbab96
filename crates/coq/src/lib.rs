//! Claims as theorems for the proof assistant Coq: definitions, fields and statements of a proof file in the terms of the library in
//! `proofs/coq`, each printed from the syntax tree that the program has read, and each theorem with a proof of one line.
//!
//! Nothing is calculated here: derivatives, determinants and substitutions are written as such, and Coq computes them from their
//! definitions. What cannot be written is left out, and why is said.
//!
//! This floor knows the reader of proof files ([`palmistry_lang`]), and no engine.

#![warn(missing_docs)]

mod definitions;
mod foreseen;
mod identity_theorem;
mod names;
mod of_claim;
mod place;
mod printer;
mod rank;
mod rank_theorem;
mod residue;
mod theorem;

pub use theorem::{Exported, NoTheorem, exported, stated};
