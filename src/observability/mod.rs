//! Floor 3: is the state seen in the outputs? Lie derivatives along words of fields, the observability codistribution,
//! its rank at sampled states, and how certain that rank is.
//!
//! [`Locus`] says where states are drawn from; [`Codistribution`] which differentials are taken;
//! [`sweep`] decides the rank at every sampled state, once by singular values (*computed*) and once by exact
//! arithmetic at that very state (*certified*).
//!
//! This floor knows nothing of claims or palms.

mod codistribution;
mod conditions;
mod defined;
mod digits;
mod elimination;
mod equilibrate;
mod flow;
mod generic;
mod ladder;
mod locus;
mod nested;
mod question;
mod reduction;
pub mod region;
mod series;
mod singular;
mod state;
mod stream;
mod sweep;

pub use codistribution::{Codistribution, Length, Stop, Word};
pub use conditions::{
    Branch, Solution, Unsolved, also_met_otherwise, assumed, linear_solution, solve, solve_conditions,
};
pub use defined::Defined;
pub use digits::{Digits, MOST_DIGITS, NoDigits};
pub(crate) use elimination::independent_rows;
pub use elimination::{certain_rank, kernel, rank};
pub use equilibrate::equilibrate;
pub use flow::Flow;
pub use generic::{GenericRank, generic_rank};
pub use ladder::{Certainty, Judge, Judged, StateReport};
pub use locus::{AVOIDED, Locus, LocusError};
pub use nested::{NestedError, differential_by_duals, lie_derivative_by_duals};
pub use question::{
    BranchAnswer, OWN_ROWS, RankAnswer, RankQuestion, TakenRow, answer_rank, parse_condition,
};
pub use reduction::Reduction;
pub use series::lie_derivative_by_series;
pub use singular::{Spectrum, customary_singular_values, singular_values};
pub use state::{Coordinate, State, StateInWords, float_inputs};
pub use stream::{
    DECADES, Elimination, Jacobi, StatesError, Stream, StreamOptions, StreamReport, Verdict, Verdicts,
};
pub use sweep::{RecordedState, SweepOptions, SweepReport, UnseenDirection, sweep};
