//! Lie derivatives, the observability codistribution and its rank: at one state, generically, under conditions ([`observability`]), and at
//! many states ([`sweep`]).
//!
//! This crate knows nothing of claims or palms.

#![warn(missing_docs)]

// each imports from those above it

// Lie derivatives, codistribution, conditions
pub mod observability;

// the rank at many states
pub mod sweep;

// what to add to an experiment
pub mod design;
