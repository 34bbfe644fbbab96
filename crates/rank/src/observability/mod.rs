//! Is the state observable from the outputs? Lie derivatives, the observability codistribution, the conditions
//! under which its rank is asked for, and what one matrix of numbers says of it.
//!
//! [`Locus`] says where states are drawn from; [`Codistribution`] which differentials are taken. The rank at many states and
//! on whole boxes is decided above ([`crate::sweep`], `palmistry-prove`).
//!
//! This floor knows nothing of claims or palms.

mod accessibility;
mod by_need;
mod codistribution;
mod conditions;
mod defined;
mod driven;
mod elimination;
mod equilibrate;
mod evaluated_rows;
mod fibre;
mod flow;
mod generic;
mod interior;
mod kinks;
mod locus;
mod needed;
mod nested;
mod reduction;
mod related_rank;
mod residue_polynomial;
mod saturation;
mod series;
mod signs;
mod singular;
mod state;
mod symmetry;

pub use accessibility::{Accessibility, BracketMinor, BracketsSoFar, RankBounds};
#[doc(hidden)]
pub use codistribution::OWN_ROWS;
pub use codistribution::{Codistribution, Frame, Length, LieDerivative};
pub use conditions::{Branch, Unsolved, parse_condition, solve_conditions};
#[doc(hidden)]
pub use conditions::{
    Solution, UnsolvedBranch, also_met_otherwise, assumed, linear_solution, solve, vanishes,
};
#[doc(hidden)]
pub use defined::Defined;
#[doc(hidden)]
pub use elimination::{certain_rank, independent_rows, kernel, rank};
pub(crate) use equilibrate::WEIGHT_OF_ERRORS;
#[cfg(test)]
pub(crate) use equilibrate::equilibrate;
pub use fibre::{
    Image, Mirror, SecondPoint, Solutions, SolutionsAnswer, SolutionsOf, SolutionsQuestion,
    WORK as SOLUTIONS_WORK, mirrors, solutions, solutions_telling,
};
#[doc(hidden)]
pub use flow::Flow;
#[doc(hidden)]
pub use generic::{Directions, Probe};
pub use generic::{
    GenericAnswer, GenericRank, Observability, generic_answer, generic_answer_of, generic_rank,
};
pub(crate) use generic::{OutputRows, Rows};
#[doc(hidden)]
pub use interior::{Interior, SmoothPart, interior, smooth_part};
#[doc(hidden)]
pub use kinks::{KinkRows, rows_at_kinks};
#[doc(hidden)]
pub use locus::AVOIDED;
pub(crate) use locus::{ATTEMPTS, Source};
pub use locus::{Locus, LocusError};
pub use needed::CodistributionError;
#[doc(hidden)]
pub use nested::{differential_by_duals, lie_derivative_by_duals};
#[doc(hidden)]
pub use reduction::Reduction;
#[doc(hidden)]
pub use related_rank::related_rank;
#[doc(hidden)]
pub use saturation::RankGrowth;
pub use saturation::{Ceiling, Stop};
#[doc(hidden)]
pub use series::lie_derivative_by_series;
#[doc(hidden)]
pub use signs::{Edges, SignCell, in_sign_cell, sign_cells};
pub(crate) use singular::SEPARATED;
#[doc(hidden)]
pub use singular::customary_singular_values;
pub use singular::{Spectrum, singular_values};
#[doc(hidden)]
pub use state::float_inputs;
pub use state::{Coordinate, MissingInput, NamedCoordinate, State, WrittenState};
pub use symmetry::{
    FieldComponent, IdentifiableFunction, IdentifiableFunctions, NotReparametrised, ObservableFunction,
    UnobservableDirections, UnobservableField, identifiable_functions, reparametrise,
    unobservable_directions,
};
