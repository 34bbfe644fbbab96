//! What comes in and what goes out: text that strangers wrote, and the budget from which its cost is paid ([`foreign`]); files, read within
//! bounds and written whole or not at all ([`file`]); parts of a long computation ([`parts`]).
//!
//! This crate knows nothing of what stands in a file.

#![warn(missing_docs)]

// each imports from those above it

// what strangers wrote: how it is shown, how much of it is taken in
#[doc(hidden)]
pub mod foreign;

// files: read within bounds, written whole or not at all
#[doc(hidden)]
pub mod file;

// parts of a long computation
#[doc(hidden)]
pub mod parts;

use std::sync::atomic::AtomicBool;

/// Never set: the flag of what nothing interrupts.
pub static UNINTERRUPTED: AtomicBool = AtomicBool::new(false);
