//! What was found, as JSON, as text, as JUnit XML, and as a page with plots.
//!
//! Nothing is decided here.

mod axis;
mod certificate;
mod claims;
mod compact;
mod document;
mod drawing;
mod formula;
mod layout;
mod motion;
mod names;
mod page;
mod plot;
mod ranks;
mod stress;
mod trade;

pub use axis::unit_of;
pub use certificate::{percent, region_curve, region_json, region_map, region_text};
pub use claims::{
    ClaimsForm, ClaimsSummary, Shown, claim_json, claim_line, claim_text, claims_text, counts_text,
    errata_markdown, junit,
};
pub use formula::{conditions_mathml, definition_mathml, expression_latex, formula_mathml, statement_latex};
pub use layout::{Colour, Layout, Tone};
pub use motion::{Observed, ended_in_words, fault_lines, observe_json, observe_page, observe_text};
pub use page::{findings_json, findings_text, forget_seconds, page, printed_value_json};
pub use ranks::{rank_json, rank_text};
pub use stress::{
    conditioning_picture, lines_picture, scalings_picture, stress_json, stress_pictures, stress_text,
};
pub use trade::{TRADE_FRONT_HEADINGS, trade_front_table, trade_json, trade_plot, trade_text};
