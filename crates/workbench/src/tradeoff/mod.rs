//! Speed against accuracy, and the extremes. What rounding does to a printed formula, what a smaller model
//! saves, how the singular values behave on the way into a singularity.

mod differences;
mod growth;
mod landscape;
mod models;
mod point_programs;
mod printed;
mod rounding;
mod routes;
pub mod stress;
mod term_by_term;
mod trade;
mod ways;

#[doc(hidden)]
pub use growth::{Growth, growth_of_lie_derivatives};
#[doc(hidden)]
pub use landscape::{
    Landscape, LandscapeRows, Map, PictureRows, PictureScales, Slope, standard_deviations_at,
};
pub(crate) use models::{ModelComparison, compare_reduction};
pub(crate) use printed::printed_values;
#[doc(hidden)]
pub use printed::{ExpandedText, PrintedExpression, PrintedValue};
#[doc(hidden)]
pub use rounding::RoundingStudy;
pub(crate) use rounding::study_rounding;
pub(crate) use routes::{RouteAgreement, compare_routes};
#[doc(hidden)]
pub use trade::{
    Combination, CombinationLeftOut, CorrectDigits, DIGITS_TOLERANCE, Derivative, DerivativeResult, Number,
    RankMethod, TIME_TOLERANCE, Trade, TradeQuestion, trade,
};
#[doc(hidden)]
pub use ways::{WaysAgreement, compare_ways};
