//! Floor 7: what was found, as JSON, as text, as JUnit XML, and as a page with plots.
//!
//! Nothing is decided here.

mod claims;
mod errata;
mod extremes;
mod observe;
mod observe_curves;
mod observe_frames;
mod observe_page;
mod observe_plot;
mod observe_section;
mod observe_shape;
mod observe_study_plot;
mod observe_table;
mod page;
mod plot;
mod ranks;
mod region;
mod region_plot;
mod stress;
mod stress_plot;
mod trade;
mod trade_plot;
mod verification;
mod words;

pub use claims::{claim_json, claim_line, junit};
pub use errata::errata_markdown;
pub use observe::{Observed, ended_in_words, fault_lines, method_name, observe_json, observe_text};
pub use observe_page::observe_page;
pub use page::page;
pub use ranks::{rank_json, rank_text};
pub use region::{percent, region_json, region_text};
pub use region_plot::{region_curve, region_map};
pub use stress::{stress_json, stress_pictures, stress_text};
pub use stress_plot::{conditioning_picture, lines_picture, scalings_picture};
pub use trade::{TRADE_FRONT_HEADINGS, trade_front_table, trade_json, trade_text};
pub use trade_plot::trade_plot;
pub use verification::{printed_value_json, verification_json, verification_text};
pub use words::counts_text;
