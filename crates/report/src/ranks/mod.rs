//! The rank at many states.

mod accessible;
pub(super) mod answer;
mod design;
mod deviations;
mod drops;
pub(super) mod generic;
mod global;
pub(super) mod motions;
mod singular;
mod state_table;
mod text;

pub use accessible::{accessibility_json, accessibility_text};
pub use answer::rank_json;
pub use design::{design_json, design_text};
pub(super) use deviations::deviation_text;
pub use drops::{drops_json, drops_text};
pub use generic::{rank_so_far_json, rank_so_far_text};
pub use global::{global_json, global_text};
pub use motions::{unobservable_directions_json, unobservable_field_text};
pub use singular::{SingularSet, singular_set_json};
pub use state_table::{StateTableWriter, TableForm};
pub(super) use text::taken_for_granted;
pub use text::{RankTextParts, rank_text, rank_text_with};
