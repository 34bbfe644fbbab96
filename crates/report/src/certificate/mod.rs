//! Full rank on boxes.

pub(super) mod answer;
pub(super) mod plot;

pub use answer::{percent, region_json, region_text};
pub use plot::{region_curve, region_map};
