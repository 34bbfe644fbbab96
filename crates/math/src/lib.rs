//! Numbers, and graphs of expressions over them: what a value can be ([`number`]); from text to an expression, its derivative, its value
//! ([`expression`]).
//!
//! This crate knows no file and no system.

pub mod expression;
pub mod number;
