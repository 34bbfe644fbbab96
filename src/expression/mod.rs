//! From text to a shared graph of expressions, its derivative, and its value over any number.
//!
//! [`parse_expression`] reads text into a [`syntax::Expr`]; an elaborator on a higher floor, which knows what names mean, builds
//! nodes of a [`Graph`] from it; a [`Derivation`] differentiates nodes; a [`Program`] is what is evaluated.
//!
//! This floor knows nothing of states, outputs or claims.

mod adjoin;
mod angle;
mod bars;
mod block;
mod common_factor;
mod composed;
mod derivative;
mod domain;
mod expansion;
mod gradient;
mod graph;
mod input;
mod nodes;
#[doc(hidden)]
pub mod notation;
mod print;
mod products;
mod program;
mod sign;
mod squares;
#[doc(hidden)]
pub mod syntax;
mod zero_test;

pub(crate) mod parse;

pub(crate) use adjoin::{Related, normal_form, over_generators, without_signs, zero_by_relations};
pub use angle::expand_angles;
#[doc(hidden)]
pub use block::BlockProgram;
pub(crate) use block::Machine;
pub(crate) use common_factor::share_a_factor;
pub(crate) use composed::COMPOSED;
pub use derivative::Derivation;
pub(crate) use derivative::{KnownSoFar, signal_of};
pub use domain::{Guard, Need};
pub(crate) use domain::{add_guard, substitute_guards};
pub(crate) use expansion::Expansion;
#[doc(hidden)]
pub use expansion::expand;
pub use gradient::gradient;
pub(crate) use graph::Extent;
pub use graph::{Graph, Node, NodeId, Symbol};
pub use input::{Input, SymbolFunction, SymbolInput};
pub(crate) use nodes::Nodes;
pub use parse::{Expected, parse_expression};
pub(crate) use products::{NodeFractions, Products, Variable};
pub(crate) use program::Loaded;
pub use program::{Failure, Program};
pub(crate) use sign::{Sign, sign, sign_given};
pub(crate) use zero_test::{LOG2_ERROR, draw_residues, failure_bound, sizes};
pub use zero_test::{ZeroTest, identically_zero};
