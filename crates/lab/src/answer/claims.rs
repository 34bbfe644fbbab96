//! The verdicts of claims, each sent as soon as it is there.

use super::place::Place;
use super::{Refused, Tell};
use palmistry_io::UNINTERRUPTED;
use palmistry_io::foreign::shown;
use palmistry_prove::claim::{Kept, decide_all_keeping};
use palmistry_report::{Colour, Layout, claim_json, claim_text, formula_mathml_in};
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// The width of a claim's text, in characters.
const COLUMNS: usize = 80;

pub(super) fn claims(
    place: &Place<'_>,
    only: &[String],
    seed: u64,
    tell: Tell<'_>,
) -> Result<Value, Refused> {
    let mut system = place.system()?;
    let only: BTreeSet<&str> = only.iter().map(String::as_str).collect();
    system.claims.retain(|claim| only.contains(claim.id.as_str()));
    let layout = Layout { width: Some(COLUMNS), colour: Colour::Plain };
    decide_all_keeping(Kept::Verdicts, &system, seed, &UNINTERRUPTED, &|outcome| {
        let mut claim = claim_json(outcome);
        claim["mathml"] = json!(formula_mathml_in(&outcome.statement, &outcome.looks));
        // a verdict is kept while its claim moves up and down
        let (line, column) = outcome.place;
        let place = format!("  {}:{line}:{column}", shown(&outcome.file));
        claim["text"] = json!(claim_text(outcome, &layout).replace(&place, ""));
        for key in ["line", "column", "file"] {
            claim.as_object_mut().map(|claim| claim.remove(key));
        }
        tell(json!({ "kind": "claim", "claim": claim }));
    });
    Ok(json!({ "claims": system.claims.len() }))
}
