//! Numbers, and graphs of expressions over them: what a value can be ([`number`]); from text to an expression, its derivative, its value
//! ([`expression`]).
//!
//! This crate knows no file and no system.

#![warn(missing_docs)]

// each imports from those above it

// what a value can be
pub mod number;

// from text to a shared graph of expressions, its derivative, its value
pub mod expression;
