//! Lie derivatives, the observability codistribution and its rank: at one state, generically, under conditions ([`observability`]), and at
//! many states ([`sweep`]).
//!
//! This crate knows nothing of claims or palms.

pub mod observability;
pub mod sweep;
