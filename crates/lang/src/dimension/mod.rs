//! The dimensions of what a file writes down: length, mass, time and so on.
//!
//! A file may say of a state or a parameter what it measures, as in `state r1 : length`. Then every definition, field,
//! output and claim is checked: the terms of a sum, the two sides of a relation and the two sides of `x' = e` have one
//! dimension, and the argument of a sine has none. What is not declared is inferred: an undeclared symbol has an unknown
//! dimension, which is found by linear equations in its exponents, and two places that ask for two dimensions are a
//! mistake. No arithmetic is done, and no verdict rests on it: dimensions are a witness of their own.
//!
//! The exponents are exact rationals over the seven base dimensions of the SI ([`Dimension`]); `reading` is the notation,
//! `form` a dimension with unknowns, `solution` what is known of these, `expression` and `matrices` the rules,
//! `square` those of determinants, `check` a whole file.

mod check;
mod definition;
mod exponents;
mod expression;
mod form;
mod functions;
mod matrices;
mod mistakes;
mod problem;
mod quantity;
mod reading;
mod scaled_unit;
mod solution;
mod square;
mod system;
mod words;

pub(super) use check::check;
pub(crate) use check::{Dimensions, Import};
pub use exponents::{Base, Dimension};
pub(crate) use reading::{Declared, DeclaredDimension, DeclaredTarget};
pub(super) use reading::{annotation, declared};
pub use scaled_unit::{ScaledUnit, scaled_unit};
pub(super) use words::all as words;
