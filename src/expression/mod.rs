//! From text to a shared graph of expressions, its derivative, and its value over any number.
//!
//! [`parse_expression`] reads text into a [`syntax::Expr`]; an elaborator on a higher floor, which knows what names mean, builds
//! nodes of a [`Graph`] from it; a [`Derivation`] differentiates nodes; a [`Program`] is what is evaluated.
//!
//! This floor knows nothing of states, outputs or claims.

mod adjoin;
mod angle;
mod block;
mod common_factor;
mod derivative;
mod domain;
mod expansion;
mod gradient;
mod graph;
mod nodes;
pub mod notation;
mod print;
mod products;
mod program;
mod sign;
mod squares;
pub mod syntax;
mod zero_test;

pub(crate) mod parse;

pub use adjoin::{Related, zero_by_relations};
pub use angle::expand_angles;
pub use block::{BlockProgram, Machine};
pub use common_factor::share_a_factor;
pub use derivative::Derivation;
pub use domain::{Guard, Need, add_guard, substitute_guards};
pub use expansion::{Expansion, expand};
pub use gradient::gradient;
pub(crate) use graph::Extent;
pub use graph::{Graph, Node, NodeId, Symbol};
pub use nodes::Nodes;
pub use parse::{Expected, parse_expression};
pub use products::{NodeFractions, Products, Variable};
pub use program::{Failure, Input, Loaded, Program};
pub use sign::{Sign, sign, sign_given};
pub use zero_test::{LOG2_ERROR, ZeroTest, draw_residues, failure_bound, identically_zero, sizes};
