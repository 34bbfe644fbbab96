//! What is not seen as vector fields, and what is seen as functions.

use crate::claims::outcomes::error_bound;
use crate::formula::SignedPart;
use palmistry_rank::observability::{FieldComponent, UnseenField, UnseenMotions};
use serde_json::{Value, json};
use std::fmt::Write;

/// A field as a differential operator: `x d/dx - y d/dy + (a + b) d/dz`.
pub fn unseen_field_text(field: &UnseenField) -> String {
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
pub(crate) fn signed_parts(field: &UnseenField) -> Vec<SignedPart<'_>> {
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
        false => format!("but for a probability below {}", error_bound(log2_error)),
    }
}

/// Fields and functions as text, before what was found at sampled states or alone.
pub(super) fn motions_text(found: &UnseenMotions, sampled: bool, out: &mut String) {
    let directions = found.directions();
    let directions =
        if directions == 1 { "one direction".to_owned() } else { format!("{directions} directions") };
    let scope = if found.for_all_parameters { ", whatever the parameters" } else { "" };
    let _ = writeln!(out, "not seen at almost all states: {directions}{scope}");
    for field in &found.fields {
        let _ =
            writeln!(out, "  along  {}  (proved, {})", unseen_field_text(field), certainty(field.log2_error));
    }
    let degree = if found.cut_off { "; higher degrees have too many coefficients to be tried" } else { "" };
    if found.fields_missing > 0 {
        let _ = writeln!(
            out,
            "  and {} more, of which no field of low degree was found{degree}{}",
            found.fields_missing,
            if sampled { ": below each is shown at one state" } else { "" }
        );
    }
    if !found.seen_names.is_empty() {
        let _ = writeln!(out, "seen by themselves: {}", found.seen_names.join(", "));
    }
    for function in &found.functions {
        let _ =
            writeln!(out, "seen together: {}  (proved, {})", function.text, certainty(function.log2_error));
    }
    if found.functions_missing > 0 {
        let more = match found.functions_missing {
            1 => "1 more function is seen, which is not found in low degree".to_owned(),
            missing => format!("{missing} more functions are seen, which are not found in low degree"),
        };
        let _ = writeln!(out, "{more}{degree}");
    }
}

/// The same as JSON.
pub(super) fn motions_json(found: &UnseenMotions) -> Value {
    json!({
        "fields": found.fields.iter().map(|field| json!({
            "text": unseen_field_text(field),
            "components": field.components.iter().map(|part| (part.name.clone(), json!(part.text)))
                .collect::<serde_json::Map<_, _>>(),
            "error_bound": error_bound(field.log2_error),
        })).collect::<Vec<_>>(),
        "fields_missing": found.fields_missing,
        "seen": found.seen_names,
        "functions": found.functions.iter().map(|function| json!({
            "text": function.text,
            "error_bound": error_bound(function.log2_error),
        })).collect::<Vec<_>>(),
        "functions_missing": found.functions_missing,
        "cut_off": found.cut_off,
        "for_all_parameters": found.for_all_parameters,
    })
}
