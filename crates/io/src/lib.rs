//! What comes in and what goes out: text that strangers wrote, and the budget from which its cost is paid ([`foreign`]); files, read within
//! bounds and written whole or not at all ([`file`]); parts of a long computation ([`parts`]).
//!
//! This crate knows nothing of what stands in a file.

pub mod file;
pub mod foreign;
pub mod parts;

use std::sync::atomic::AtomicBool;

/// Never set: the flag of what nothing interrupts.
pub static UNINTERRUPTED: AtomicBool = AtomicBool::new(false);
