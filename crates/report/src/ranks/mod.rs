//! The rank at many states.

mod accessible;
pub(super) mod answer;
mod design;
mod deviations;
mod drops;
pub(super) mod generic;
mod global;
pub(super) mod motions;
mod state_table;

pub use accessible::{accessibility_json, accessibility_text};
pub(super) use answer::taken_for_granted;
pub use answer::{rank_json, rank_text};
pub use design::{design_json, design_text};
pub(super) use deviations::deviation_text;
pub use drops::{drops_json, drops_text};
pub use generic::{rank_so_far_json, rank_so_far_text};
pub use global::{global_json, global_text};
pub use motions::unobservable_field_text;
pub use state_table::{StateTableWriter, TableForm};
