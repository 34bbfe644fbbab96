//! Claims, the engines that decide them, and the verdicts.
//!
//! [`decide`] takes one claim of a file to an [`Outcome`]. A verdict never says more than its engine knows: *proved*
//! rests on an exact argument with the probability of an error stated, *refuted* on a state in exact numbers at which
//! the two sides differ, and everything else is *undecided*.
//!
//! This floor shares no formula with `proofs/`, and knows nothing of pages or plots.

mod branches;
mod cells;
mod claimed_ranks;
mod decide;
mod defaults;
mod everywhere;
mod evidence;
mod existence;
mod identity;
mod inequality;
mod irreducible;
mod isolated;
mod kinks;
mod pieces;
mod point;
mod pole;
mod question;
mod rank_bounds;
mod rank_witness;
mod ranks;
mod selection;
mod solutions;
mod terms;
mod value;
mod verdict;
mod visible;
mod visible_evidence;
mod witness;

pub use decide::{decide, decide_all, decide_all_keeping, prove};
pub use evidence::Kept;
#[doc(hidden)]
pub use isolated::isolated;
pub use point::{EvaluationError, ValueAtPoint, evaluate};
#[doc(hidden)]
pub use selection::{Selection, UnmetPattern};
#[doc(hidden)]
pub use value::exists_at;
pub use value::{PointValue, ValueError, certified_value, computed_value};
pub use verdict::{AtFilesValues, Outcome, Verdict, Witness};
