//! The rank at many states.

mod accessible;
pub(super) mod answer;
pub(super) mod generic;
pub(super) mod motions;
mod seen;

pub use accessible::{accessibility_json, accessibility_text};
pub(super) use answer::taken_for_granted;
pub use answer::{rank_json, rank_text};
pub use motions::unseen_field_text;
