//! The rank at many states.

pub(super) mod answer;

pub use answer::{rank_json, rank_text};
