//! Bodies in motion and what observers made of them.

pub(super) mod answers;
pub(super) mod closure;
pub(super) mod curves;
pub(super) mod fit;
pub(super) mod frames;
pub(super) mod modes;
mod next;
pub(super) mod outline_plot;
pub(super) mod outline_section;
pub(super) mod page;
pub(super) mod plot;
pub(super) mod recognition;
pub(super) mod reconstruction;
pub(super) mod section;
pub(super) mod shape;
pub(super) mod stream;
pub(super) mod studies;
pub(super) mod studies_section;
pub(super) mod study_plot;
pub(super) mod table;
mod verdicts;

pub use answers::{Observed, observe_json, observe_text};
pub use modes::{modes_json, modes_text};
pub use page::observe_page;
pub use stream::{stream_end_json, stream_end_text, stream_json, stream_text};
