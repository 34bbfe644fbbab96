//! The rank at many states: how certain it is at each, on the cheapest number type that can decide, and what is observable at
//! all of them together.
//!
//! [`answer_rank`] takes a whole question; [`sweep`] decides every state that a [`Locus`](crate::observability::Locus) draws,
//! once by singular values (*computed*) and once by exact arithmetic at that very state (*certified*); a [`Stream`] does so
//! eight states at a time, and leaves to [`RankDecider`] those that it cannot decide.
//!
//! This floor knows nothing of claims or palms.

mod accessible;
mod asked;
mod cells;
mod certainty;
mod counts;
mod deviation;
mod digits;
mod escalation;
mod fingerprint;
mod given_states;
mod left;
mod paid;
mod part;
mod part_text;
mod preparation;
mod prepared;
mod prepared_branch;
mod question;
mod scales;
mod series;
mod solutions;
mod states;
mod stream;
mod table;
mod unobservable;

pub use accessible::{
    AccessibilityAnswer, AccessibilityBranch, answer_accessibility, answer_accessibility_telling,
};
pub use asked::RankQuestion;
pub(crate) use asked::{held_conditions, held_constants};
pub use certainty::Certainty;
#[doc(hidden)]
pub use deviation::NEARLY_INVISIBLE;
pub use deviation::{LeastObservable, StandardDeviation, StandardDeviations};
#[doc(hidden)]
pub use digits::MOST_DIGITS;
pub use digits::{Digits, NoDigits};
#[doc(hidden)]
pub use escalation::{DecidedRows, ProofWanted, RankDecider, StateDecision, StateReport};
#[doc(hidden)]
pub use fingerprint::Fingerprint;
pub use given_states::GivenStates;
pub use palmistry_io::parts::PartError;
pub use part::{MergeError, RankPart, shard_of};
pub use preparation::{RankPreparation, answer_rank, answer_rank_at_once};
pub use prepared::sweep;
pub use question::{BranchAnswer, GenericOnBranch, RankAnswer, RankError, TakenRow};
pub(crate) use question::{held_parameters, named_unknowns};
#[doc(hidden)]
pub use scales::{DrawnStates, MeasuredRows, Scales};
pub use solutions::{GlobalAnswer, SolutionsWanted, answer_solutions, answer_solutions_telling};
pub use states::{RecordedState, SweepOptions, SweepReport};
#[doc(hidden)]
pub use stream::{
    Elimination, Jacobi, StateVerdict, StatesError, Stream, StreamOptions, StreamReport, Verdicts,
};
pub use table::{StateRow, StateTable};
pub use unobservable::UnobservableDirection;
