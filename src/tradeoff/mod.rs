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

pub use differences::{Differences, FiniteDifference};
pub use growth::{Growth, growth_of_lie_derivatives};
pub use landscape::{Landscape, LandscapeRows, Map, Slope};
pub use models::{ModelComparison, compare_reduction};
pub use point_programs::{LoadedPoints, PointPrograms};
pub use printed::{ExpandedText, PrintedExpression, PrintedValue, printed_values};
pub use rounding::{RoundingStudy, study_rounding};
pub use routes::{RouteAgreement, compare_routes};
pub use term_by_term::term_by_term;
pub use trade::{
    Combination, CombinationLeftOut, CorrectDigits, DIGITS_TOLERANCE, Derivative, DerivativeResult, Number,
    RankMethod, RankResult, TIME_TOLERANCE, Trade, TradeQuestion, beats, trade,
};
