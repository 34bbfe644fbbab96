//! Unobservable directions as vector fields, and identifiable combinations as functions.

use crate::claims::outcomes::error_bound;
use crate::formula::SignedPart;
use crate::layout::{counted, item, prose};
use palmistry_rank::observability::{FieldComponent, UnobservableDirections, UnobservableField};
use palmistry_rank::sweep::RankAnswer;
use serde_json::{Value, json};
use std::fmt::Write;

/// A field as a differential operator: `x d/dx - y d/dy + (a + b) d/dz`.
pub fn unobservable_field_text(field: &UnobservableField) -> String {
    let mut text = String::new();
    for SignedPart { negative, rate, state } in signed_parts(field) {
        text.push_str(match (text.is_empty(), negative) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        });
        let _ = match rate {
            "1" => write!(text, "d/d{state}"),
            rate if is_sum(rate) => write!(text, "({rate}) d/d{state}"),
            rate => write!(text, "{rate} d/d{state}"),
        };
    }
    text
}

/// The components of a field, each with its sign: that of a sum or a difference is that of its first term alone.
pub(crate) fn signed_parts(field: &UnobservableField) -> Vec<SignedPart<'_>> {
    fn part(FieldComponent { text, name: state, .. }: &FieldComponent) -> SignedPart<'_> {
        match text.strip_prefix('-').filter(|rest| !is_sum(rest)) {
            Some(rate) => SignedPart { negative: true, rate, state },
            None => SignedPart { negative: false, rate: text, state },
        }
    }
    field.components.iter().map(part).collect()
}

/// Whether a term is added or subtracted outside brackets.
fn is_sum(text: &str) -> bool {
    let mut depth = 0;
    let mut before = '(';
    for sign in text.chars() {
        match sign {
            '(' => depth += 1,
            ')' => depth -= 1,
            '+' | '-' if depth == 0 && before == ' ' => return true,
            _ => {}
        }
        before = sign;
    }
    false
}

fn certainty(log2_error: f64) -> String {
    match log2_error == f64::NEG_INFINITY {
        true => "certain".to_owned(),
        false => format!("error probability below {}", error_bound(log2_error)),
    }
}

/// Identifiable combinations and unobservable directions as text. Of a direction without a field it is said whether one at a single sampled state
/// is known.
pub(super) fn motions_text(found: &UnobservableDirections, at_states: bool, out: &mut String) {
    let scope = if found.for_all_parameters { ", for all parameter values" } else { "" };
    // a field stays one at any values; at special ones there may be more of them, and fewer functions
    let degree = if found.cut_off { "; higher degrees have too many coefficients to be tried" } else { "" };
    if !found.functions.is_empty() || found.functions_missing > 0 {
        let of_what = if found.for_all_parameters { "generically identifiable" } else { "identifiable" };
        prose(&format!("{of_what} combinations of the unobservable unknowns:"), out);
    }
    for function in &found.functions {
        item(&format!("{}  (proved, {})", function.text, certainty(function.log2_error)), out);
    }
    if found.functions_missing > 0 {
        let more = counted(found.functions_missing, "more function");
        item(&format!("{more}, not found in low degree{degree}"), out);
    }
    let directions = if found.directions() == 1 { "direction" } else { "directions" };
    prose(&format!("unobservable {directions}{scope}:"), out);
    for field in &found.fields {
        item(&format!("{}  (proved, {})", unobservable_field_text(field), certainty(field.log2_error)), out);
    }
    if found.fields_missing > 0 {
        let below = if at_states { "; --details has each at one state" } else { "" };
        item(
            &format!(
                "{} more, of which no field of low degree was found{degree}{below}",
                found.fields_missing
            ),
            out,
        );
    }
}

/// Identifiable combinations and unobservable directions of an answer as JSON, those of its first branch; null where all is observable.
pub fn unobservable_directions_json(answer: &RankAnswer) -> Value {
    answer.branches.first().and_then(|branch| branch.motions.as_ref()).map_or(Value::Null, motions_json)
}

/// The same as JSON.
pub(super) fn motions_json(found: &UnobservableDirections) -> Value {
    json!({
        "fields": found.fields.iter().map(|field| json!({
            "text": unobservable_field_text(field),
            "components": field.components.iter().map(|part| (part.name.clone(), json!(part.text)))
                .collect::<serde_json::Map<_, _>>(),
            "error_bound": error_bound(field.log2_error),
        })).collect::<Vec<_>>(),
        "fields_missing": found.fields_missing,
        "observable": found.observable_names,
        "functions": found.functions.iter().map(|function| json!({
            "text": function.text,
            "error_bound": error_bound(function.log2_error),
        })).collect::<Vec<_>>(),
        "functions_missing": found.functions_missing,
        "cut_off": found.cut_off,
        "for_all_parameters": found.for_all_parameters,
    })
}
