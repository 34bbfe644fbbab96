//! The page that holds everything that was found.

mod anchors;
mod claims;
mod drops;
mod entry;
pub(super) mod extremes;
pub(super) mod findings;
mod inline;
mod motions;
mod regime;
mod source;
pub(super) mod system;
mod unknowns;
pub(super) mod whole;

pub use anchors::TheoremAddresses;
pub use drops::drops_page;
pub use findings::{findings_json, findings_text, forget_seconds, forget_times};
pub use system::system_mathematics;
pub use whole::{page, page_with};
