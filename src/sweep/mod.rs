//! The rank at many states: how certain it is at each, on the cheapest rung of the ladder of numbers that can tell, and what is
//! seen of all of them together.
//!
//! [`answer_rank`] takes a whole question; [`sweep`] decides every state that a [`Locus`](crate::observability::Locus) draws,
//! once by singular values (*computed*) and once by exact arithmetic at that very state (*certified*); a [`Stream`] does so
//! eight states at a time, and leaves to [`Judge`] those that it cannot decide.
//!
//! This floor knows nothing of claims or palms.

mod certainty;
mod deviation;
mod digits;
mod ladder;
mod question;
mod states;
mod stream;
mod unseen;

pub use certainty::Certainty;
pub use deviation::{NEARLY_INVISIBLE, StandardDeviation, StandardDeviations};
pub use digits::{Digits, MOST_DIGITS, NoDigits};
pub use ladder::{Judge, StateJudgement, StateReport};
pub use question::{BranchAnswer, RankAnswer, RankError, RankQuestion, TakenRow, answer_rank};
pub use states::{RecordedState, SweepOptions, SweepReport, sweep};
pub use stream::{
    DECADES, Elimination, Jacobi, StateVerdict, StatesError, Stream, StreamOptions, StreamReport, Verdicts,
};
pub use unseen::UnseenDirection;
