//! The rank at many states.

pub(super) mod answer;
mod generic;
mod seen;

pub(super) use answer::taken_for_granted;
pub use answer::{rank_json, rank_text};
