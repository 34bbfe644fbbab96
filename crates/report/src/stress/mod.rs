//! The extremes.

pub(super) mod answer;
pub(super) mod plot;

pub use answer::{stress_json, stress_pictures, stress_text};
