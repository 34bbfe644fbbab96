//! What is observable generically, except on a set of measure zero, and of each unknown whether it is.

use crate::layout::{in_columns, prose};
use palmistry_lang::UnknownKind;
use palmistry_rank::observability::{GenericAnswer, Observability};
use palmistry_rank::sweep::GenericOnBranch;
use serde_json::{Value, json};
use std::fmt::Write;

/// JSON has no infinity; a gap without bound is null.
pub(super) fn finite(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

/// The verdict on an unknown.
pub(crate) fn unknown_verdict(kind: UnknownKind, seen: Observability) -> &'static str {
    match (kind, seen) {
        (UnknownKind::Parameter, Observability::Yes) => "locally identifiable",
        (_, Observability::Yes) => "locally observable",
        (UnknownKind::Parameter, Observability::No) => "non-identifiable",
        (_, Observability::No) => "unobservable",
        (_, Observability::Undecided) => "undecided",
    }
}

/// The unknowns: their names and what they are.
type Unknowns = [(String, UnknownKind)];

/// The answer and the table of unknowns, as the fields of an object.
pub(super) fn add_generic_json(generic: &GenericAnswer, unknowns: &Unknowns, object: &mut Value) {
    object["generic"] = json!({
        "rank": generic.rank(),
        "at_least": generic.at_least,
        "at_most": generic.at_most,
        "log2_error": finite(generic.log2_error),
        "points": generic.rounds,
        "derivatives": generic.order,
        "open": generic.open,
    });
    let unknown = |((name, kind), (_, seen)): (&(String, UnknownKind), &(_, Observability))| json!({ "name": name, "kind": kind.name(), "verdict": unknown_verdict(*kind, *seen) });
    let unknowns = unknowns.iter().zip(&generic.unknowns).map(unknown);
    object["unknowns"] = unknowns.collect();
    object["unobservable_dimension"] = json!(generic.rank().map(|rank| generic.dimension - rank));
}

/// How the answer is known, in brackets.
fn certainty(generic: &GenericAnswer) -> String {
    if let Some(open) = &generic.open {
        return open.clone();
    }
    match generic.log2_error.is_finite() {
        false => "proved by a minor".to_owned(),
        true => format!("error probability below 2^{:.0}", generic.log2_error.ceil()),
    }
}

/// The answer in one sentence.
pub(crate) fn generic_sentence(generic: &GenericAnswer) -> String {
    let dimension = generic.dimension;
    let Some(rank) = generic.rank() else {
        return format!(
            "generically the rank is at least {} and at most {} of {dimension}: {}",
            generic.at_least,
            generic.at_most,
            generic.open.as_deref().unwrap_or("nothing more is known")
        );
    };
    let means = match dimension - rank {
        0 => "the observability rank condition holds: locally weakly observable".to_owned(),
        free => format!("the unobservable distribution has dimension {free}"),
    };
    format!("generically the rank is {rank} of {dimension}; {means} ({})", certainty(generic))
}

/// What is known where somebody did not wait for the states, as one object.
pub fn rank_so_far_json(file: &str, branches: &[GenericOnBranch], cut_off: Option<&str>) -> Value {
    let branch = |branch: &GenericOnBranch| {
        let mut object = json!({ "conditions": branch.conditions });
        add_generic_json(&branch.generic, &branch.unknowns, &mut object);
        object
    };
    let mut object = json!({
        "file": file,
        "interrupted": cut_off.is_none(),
        "samples": 0,
        "branches": branches.iter().map(branch).collect::<Vec<_>>(),
    });
    if let Some(why) = cut_off {
        object["cut_off"] = json!(why);
    }
    object
}

/// The same as text.
pub fn rank_so_far_text(file: &str, branches: &[GenericOnBranch], cut_off: Option<&str>) -> String {
    let mut out = match cut_off {
        Some(why) => format!("{file}: {why}\n"),
        None => format!("{file}: interrupted before states were looked at\n"),
    };
    for branch in branches {
        if !branch.conditions.is_empty() {
            let _ = writeln!(out, "where {}", branch.conditions.join(", "));
        }
        generic_text(&branch.generic, &branch.unknowns, &mut out);
    }
    in_columns(&out)
}

/// The table of unknowns and then the sentence that it follows from, as text.
pub(super) fn generic_text(generic: &GenericAnswer, unknowns: &Unknowns, out: &mut String) {
    let width = unknowns.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    for ((name, kind), (_, seen)) in unknowns.iter().zip(&generic.unknowns) {
        let _ = writeln!(out, "  {name:<width$}  {:<9}  {}", kind.name(), unknown_verdict(*kind, *seen));
    }
    prose(&generic_sentence(generic), out);
}
