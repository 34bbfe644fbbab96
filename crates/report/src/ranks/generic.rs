//! What is seen at almost all states, and of each unknown whether it is.

use palmistry_lang::UnknownKind;
use palmistry_rank::observability::{GenericAnswer, Seen};
use palmistry_rank::sweep::GenericOnBranch;
use serde_json::{Value, json};
use std::fmt::Write;

/// JSON has no infinity; a gap without bound is null.
pub(super) fn finite(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

/// What is said of an unknown.
pub(crate) fn unknown_verdict(kind: UnknownKind, seen: Seen) -> &'static str {
    match (kind, seen) {
        (UnknownKind::Parameter, Seen::Yes) => "locally identifiable",
        (_, Seen::Yes) => "locally observable",
        (UnknownKind::Parameter, Seen::No) => "not identifiable",
        (_, Seen::No) => "not observable",
        (_, Seen::Undecided) => "undecided",
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
    let unknown = |((name, kind), (_, seen)): (&(String, UnknownKind), &(_, Seen))| json!({ "name": name, "kind": kind.name(), "verdict": unknown_verdict(*kind, *seen) });
    let unknowns = unknowns.iter().zip(&generic.unknowns).map(unknown);
    object["unknowns"] = unknowns.collect();
    object["degrees_of_freedom_left"] = json!(generic.rank().map(|rank| generic.dimension - rank));
}

/// How the answer is known, in brackets.
fn certainty(generic: &GenericAnswer) -> String {
    if let Some(open) = &generic.open {
        return open.clone();
    }
    match generic.log2_error.is_finite() {
        false => "proved by a minor".to_owned(),
        true => format!("but for an error of probability below 2^{:.0}", generic.log2_error.ceil()),
    }
}

/// The answer in one sentence.
pub(crate) fn generic_sentence(generic: &GenericAnswer) -> String {
    let dimension = generic.dimension;
    match generic.rank() {
        Some(rank) if rank == dimension => {
            format!(
                "at almost all states the rank is {rank} of {dimension}: all is seen ({})",
                certainty(generic)
            )
        }
        Some(rank) => {
            let free = match dimension - rank {
                1 => "1 degree of freedom is".to_owned(),
                free => format!("{free} degrees of freedom are"),
            };
            format!(
                "at almost all states the rank is {rank} of {dimension}: {free} left ({})",
                certainty(generic)
            )
        }
        None => format!(
            "at almost all states the rank is at least {} and at most {} of {dimension}: {}",
            generic.at_least,
            generic.at_most,
            generic.open.as_deref().unwrap_or("nothing more is known")
        ),
    }
}

/// What is known where somebody did not wait for the states, as one object.
pub fn rank_so_far_json(file: &str, branches: &[GenericOnBranch]) -> Value {
    let branch = |branch: &GenericOnBranch| {
        let mut object = json!({ "conditions": branch.conditions });
        add_generic_json(&branch.generic, &branch.unknowns, &mut object);
        object
    };
    json!({
        "file": file,
        "interrupted": true,
        "samples": 0,
        "branches": branches.iter().map(branch).collect::<Vec<_>>(),
    })
}

/// The same as text.
pub fn rank_so_far_text(file: &str, branches: &[GenericOnBranch]) -> String {
    let mut out = format!("{file}: interrupted before states were looked at\n");
    for branch in branches {
        if !branch.conditions.is_empty() {
            let _ = writeln!(out, "where {}", branch.conditions.join(", "));
        }
        generic_text(&branch.generic, &branch.unknowns, &mut out);
    }
    out
}

/// The answer and the table of unknowns, in words.
pub(super) fn generic_text(generic: &GenericAnswer, unknowns: &Unknowns, out: &mut String) {
    let _ = writeln!(out, "{}", generic_sentence(generic));
    let width = unknowns.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    for ((name, kind), (_, seen)) in unknowns.iter().zip(&generic.unknowns) {
        let _ = writeln!(out, "  {name:<width$}  {:<9}  {}", kind.name(), unknown_verdict(*kind, *seen));
    }
}
