//! The rank at many states.

pub(super) mod answer;
pub(super) mod motions;
mod seen;

pub use answer::{rank_json, rank_text};
pub use motions::unseen_field_text;
