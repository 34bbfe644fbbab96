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

pub mod parse;

#[doc(hidden)]
pub use adjoin::{Related, normal_form, over_generators, without_signs, zero_by_relations};
pub use angle::expand_angles;
#[doc(hidden)]
pub use block::{BlockProgram, Machine};
#[doc(hidden)]
pub use common_factor::share_a_factor;
#[doc(hidden)]
pub use composed::COMPOSED;
pub use derivative::Derivation;
#[doc(hidden)]
pub use derivative::{KnownSoFar, signal_of};
pub use domain::{Guard, Need};
#[doc(hidden)]
pub use domain::{add_guard, substitute_guards};
#[doc(hidden)]
pub use expansion::{Expansion, expand};
pub use gradient::gradient;
#[doc(hidden)]
pub use graph::GraphExtent;
pub use graph::{Graph, Node, NodeId, Symbol};
pub use input::{Input, SymbolFunction, SymbolInput};
#[doc(hidden)]
pub use nodes::Nodes;
pub use parse::{Expected, parse_expression};
#[doc(hidden)]
pub use products::{NodeFractions, Products, Variable};
#[doc(hidden)]
pub use program::Loaded;
pub use program::{Failure, Program};
#[doc(hidden)]
pub use sign::{Sign, sign, sign_given};
#[doc(hidden)]
pub use zero_test::{LOG2_ERROR, draw_residues, failure_bound, sizes};
pub use zero_test::{ZeroTest, identically_zero};
