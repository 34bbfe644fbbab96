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

pub(crate) use growth::Growth;
#[doc(hidden)]
pub use growth::growth_of_lie_derivatives;
#[cfg(all(test, feature = "report"))]
pub(crate) use landscape::PictureScales;
pub(crate) use landscape::{Landscape, Map, PictureRows, Slope};
#[doc(hidden)]
pub use landscape::{LandscapeRows, standard_deviations_at};
pub(crate) use models::{ModelComparison, compare_reduction};
#[doc(hidden)]
pub use printed::{ExpandedText, PrintedValue};
pub(crate) use printed::{PrintedExpression, printed_values};
pub(crate) use rounding::{RoundingStudy, study_rounding};
pub(crate) use routes::{RouteAgreement, compare_routes};
#[doc(hidden)]
pub use trade::{Combination, CorrectDigits, Derivative, Number, RankMethod, Trade, TradeQuestion, trade};
#[doc(hidden)]
pub use trade::{CombinationLeftOut, DIGITS_TOLERANCE, DerivativeResult, TIME_TOLERANCE};
