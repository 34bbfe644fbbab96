//! Is the state seen in the outputs? Lie derivatives along words of fields, the observability codistribution, the conditions
//! under which its rank is asked for, and what one matrix of numbers says of it.
//!
//! [`Locus`] says where states are drawn from; [`Codistribution`] which differentials are taken. The rank at many states and
//! on whole boxes is decided above ([`crate::sweep`], [`crate::certificate`]).
//!
//! This floor knows nothing of claims or palms.

mod codistribution;
mod conditions;
mod defined;
mod elimination;
mod equilibrate;
mod flow;
mod generic;
mod locus;
mod nested;
mod reduction;
mod series;
mod singular;
mod state;

pub use codistribution::{Codistribution, CodistributionError, Length, OWN_ROWS, Stop, Word};
pub(crate) use conditions::vanishes;
pub use conditions::{
    Branch, Solution, Unsolved, also_met_otherwise, assumed, linear_solution, parse_condition, solve,
    solve_conditions,
};
pub use defined::Defined;
pub(crate) use elimination::independent_rows;
pub use elimination::{certain_rank, kernel, rank};
pub(crate) use equilibrate::WEIGHT_OF_ERRORS;
pub use equilibrate::equilibrate;
pub use flow::Flow;
pub use generic::{GenericRank, generic_rank};
pub(crate) use locus::{ATTEMPTS, Source};
pub use locus::{AVOIDED, Locus, LocusError};
pub use nested::{NestedError, differential_by_duals, lie_derivative_by_duals};
pub use reduction::Reduction;
pub use series::lie_derivative_by_series;
pub(crate) use singular::SEPARATED;
pub use singular::{Spectrum, customary_singular_values, singular_values};
pub use state::{Coordinate, NamedCoordinate, State, StateInWords, float_inputs};
