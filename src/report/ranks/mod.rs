//! The rank at many states.

mod accessible;
pub(super) mod answer;
mod seen;

pub use accessible::{accessibility_json, accessibility_text};
pub use answer::{rank_json, rank_text};
