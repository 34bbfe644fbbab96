//! The page that holds everything that was found.

pub(super) mod extremes;
pub(super) mod findings;
pub(super) mod whole;

pub use findings::{printed_value_json, verification_json, verification_text};
pub use whole::page;
