//! Claims: their outcomes as lines, JSON and JUnit, the counts of their verdicts, and the errata.

pub(super) mod errata;
mod junit;
pub(super) mod outcomes;
pub(super) mod text;
pub(super) mod verdicts;

pub use errata::errata_markdown;
pub use junit::junit;
pub use outcomes::{claim_json, claim_line};
pub use text::{ClaimsForm, ClaimsSummary, Shown, claim_text, claims_text};
pub use verdicts::counts_text;
