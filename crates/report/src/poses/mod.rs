//! Stable poses of bodies between slow palms: of one body with pictures, and the conjecture on many.

pub(super) mod conjecture;
pub(super) mod picture;
pub(super) mod survey;

pub use conjecture::{conjecture_json, conjecture_text};
pub use survey::{poses_json, poses_page, poses_text};
