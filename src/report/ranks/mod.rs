//! The rank at many states.

pub(super) mod answer;
mod drops;
mod seen;

pub use answer::{rank_json, rank_text};
pub use drops::{drops_json, drops_text};
