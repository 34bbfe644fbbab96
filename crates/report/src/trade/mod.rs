//! Speed against accuracy.

pub(super) mod answer;
pub(super) mod plot;

pub use answer::{trade_front_table, trade_json, trade_text};
pub use plot::trade_plot;
