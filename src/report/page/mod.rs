//! The page that holds everything that was found.

pub(super) mod extremes;
pub(super) mod findings;
pub(super) mod whole;

pub use findings::{findings_json, findings_text, printed_value_json};
pub use whole::page;
