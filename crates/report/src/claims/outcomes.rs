//! Outcomes of claims, as JSON and in lines.

use crate::names::{fields_json, fields_text, values_json, values_text};
use palmistry_lang::{Basis, Flaw};
use palmistry_math::number::{parse_decimal, rational_to_f64};
use palmistry_prove::claim::{AtFilesValues, Outcome, Verdict, Witness};
use palmistry_rank::observability::NamedCoordinate;
use serde_json::{Value, json};

/// A bound on a probability, as people write it.
pub(crate) fn error_bound(log2_error: f64) -> String {
    if log2_error == f64::NEG_INFINITY { "0".to_owned() } else { format!("2^{:.0}", log2_error.ceil()) }
}

fn witness_json(witness: &Witness) -> Value {
    let state: serde_json::Map<String, Value> = witness
        .state
        .iter()
        .map(|at| (at.name.clone(), json!({ "exact": at.exact, "value": at.value })))
        .collect();
    json!({ "state": state, "left": witness.left, "right": witness.right, "entry": witness.entry })
}

fn verdict_json(verdict: &Verdict) -> Value {
    match verdict {
        Verdict::Proved { engine, log2_error } => {
            json!({ "verdict": "proved", "engine": engine, "error_bound": error_bound(*log2_error) })
        }
        Verdict::Refuted { engine, witness } => {
            json!({ "verdict": "refuted", "engine": engine, "witness": witness_json(witness) })
        }
        Verdict::Definition { .. } => json!({ "verdict": "definition", "engine": null }),
        Verdict::Undecided { why } => json!({ "verdict": "undecided", "engine": null, "why": why }),
    }
}

/// An outcome as an entry of `claims`.
pub fn claim_json(outcome: &Outcome) -> Value {
    let mut object = verdict_json(&outcome.verdict);
    object["id"] = json!(outcome.id);
    object["file"] = json!(outcome.file);
    object["line"] = json!(outcome.place.0);
    object["column"] = json!(outcome.place.1);
    object["statement"] = json!(outcome.statement);
    object["verdict"] = json!(outcome.word());
    object["expected"] = json!(outcome.expected_word());
    object["ok"] = json!(outcome.ok);
    object["seconds"] = json!(outcome.seconds);
    if let Some(remark) = &outcome.remark {
        object["remark"] = json!(remark);
    }
    if !outcome.definitions.is_empty() {
        object["definitions"] =
            outcome.definitions.iter().map(|(name, text)| (name.clone(), json!(text))).collect();
    }
    if let Some(special) = &outcome.at_files_values {
        object["at_the_files_values"] = special_json(special);
    }
    if !outcome.not_looked_at.is_empty() {
        object["not_looked_at"] = json!(outcome.not_looked_at);
    }
    if !outcome.beside.is_empty() {
        object["beside"] = json!(outcome.beside);
    }
    if !outcome.fields.is_empty() {
        object["fields"] = fields_json(&outcome.fields);
    }
    if !outcome.differentiated_along.is_empty() {
        object["differentiated_along"] =
            outcome.differentiated_along.iter().map(|(name, text)| (name.clone(), json!(text))).collect();
    }
    if let Some(quoted) = &outcome.quoted {
        object["quoted"] = json!(quoted);
    }
    if let Basis::Restates(list) = &outcome.basis {
        object["restates"] = list.iter().map(|reference| json!(reference.text())).collect();
    }
    if let Some(from) = &outcome.follows {
        object["follows"] = json!(from);
    }
    if let Some(passage) = &outcome.passage {
        object["passage"] = json!(passage);
    }
    if let Some(conclusion) = &outcome.conclusion {
        object["conclusion"] = json!(conclusion);
    }
    if let Some((statement, verdict)) = &outcome.printed {
        let mut printed = verdict_json(verdict);
        printed["statement"] = json!(statement);
        if let Some(special) = &outcome.printed_at_files_values {
            printed["at_the_files_values"] = special_json(special);
        }
        if let Verdict::Refuted { witness, .. } = verdict {
            object["witness"] = witness_json(witness);
        }
        object["printed"] = printed;
        object["corrected"] = verdict_json(&outcome.verdict);
    }
    object
}

/// The state of a witness: `x = 1/2, y = 3`.
pub(crate) fn state_line(witness: &Witness) -> String {
    let state: Vec<String> = witness
        .state
        .iter()
        .map(|NamedCoordinate { name, exact, value: float }| {
            if exact.contains("sin") {
                format!("{name} = {float:.6} ({exact})")
            } else {
                format!("{name} = {exact}")
            }
        })
        .collect();
    state.join(", ")
}

/// A witness as one line.
pub(crate) fn witness_line(witness: &Witness) -> String {
    let state = state_line(witness);
    let place = if state.is_empty() { String::new() } else { format!("at {state}: ") };
    let entry = witness.entry.map_or(String::new(), |(row, column)| format!("entry {row},{column}: "));
    format!("{place}{entry}left = {}, right = {}", with_decimal(&witness.left), with_decimal(&witness.right))
}

/// A fraction with its decimal behind it; anything else as it is.
pub(crate) fn with_decimal(value: &str) -> String {
    match parse_decimal(value) {
        Some(number) if value.contains('/') => format!("{value} = {:.8}", rational_to_f64(&number)),
        _ => value.to_owned(),
    }
}

fn special_json(special: &AtFilesValues) -> Value {
    json!({ "values": values_json(&special.values), "verdict": special.word })
}

/// That a statement has another verdict where its parameters have the values of the file.
pub(crate) fn special_text(special: &AtFilesValues) -> String {
    format!("at the file's values {} it is {}", values_text(&special.values), special.word)
}

/// What the names in a claim's statements stand for, a line each, in the notation of the language.
pub(crate) fn explanations(outcome: &Outcome) -> Vec<String> {
    let definitions = outcome.definitions.iter().map(|(name, text)| format!("{name} = {text}"));
    let fields = outcome.differentiated_along.iter().map(|(name, text)| format!("field {name}  {text}"));
    definitions.chain(fields).collect()
}

/// An outcome as a line for the terminal, with a second one where there is something to explain.
pub fn claim_line(outcome: &Outcome) -> String {
    let mark = if outcome.ok { "ok  " } else { "FAIL" };
    let mut line = format!("  {mark} {:<10} {}", outcome.word(), outcome.id);
    if !outcome.fields.is_empty() {
        line.push_str(&format!("  [{}]", fields_text(&outcome.fields)));
    }
    let explain = |verdict: &Verdict| match verdict {
        Verdict::Proved { log2_error, .. } if *log2_error == f64::NEG_INFINITY => "certain".to_owned(),
        Verdict::Proved { log2_error, .. } => {
            format!("error probability below {}", error_bound(*log2_error))
        }
        Verdict::Refuted { witness, .. } => witness_line(witness),
        Verdict::Definition { text } => text.clone(),
        Verdict::Undecided { why } => why.clone(),
    };
    let [_, before, between] = outcome.fault.unwrap_or(Flaw::Erratum).keywords();
    if let Some(quoted) = &outcome.quoted {
        line.push_str(&format!("\n         {before:<10} {quoted}"));
    }
    if let (Some(_), None) = (outcome.fault, &outcome.printed) {
        line.push_str(&format!("\n         {between:<10} {}", outcome.statement));
    }
    match &outcome.printed {
        None => match &outcome.verdict {
            Verdict::Proved { .. } => {
                let of = match &outcome.basis {
                    Basis::Restates(list) if !list.is_empty() => {
                        let names: Vec<String> = list.iter().map(|reference| reference.text()).collect();
                        format!("of {}; ", names.join(", "))
                    }
                    _ => String::new(),
                };
                line.push_str(&format!("  ({of}{})", explain(&outcome.verdict)));
            }
            verdict => line.push_str(&format!("\n         {}", explain(verdict))),
        },
        Some((statement, verdict)) => {
            line.push_str(&format!(
                "\n         {:<10} {statement}\n                    {}: {}",
                if outcome.quoted.is_some() { "as" } else { before },
                verdict.word(),
                explain(verdict)
            ));
            if let Some(special) = &outcome.printed_at_files_values {
                line.push_str(&format!("\n                    {}", special_text(special)));
            }
            let corrected = &outcome.verdict;
            line.push_str(&format!(
                "\n         {between:<10} {}\n                    {}: {}",
                outcome.statement,
                corrected.word(),
                explain(corrected)
            ));
        }
    }
    if let Some(from) = &outcome.follows {
        line.push_str(&format!("\n         follows    {from}"));
    }
    for part in &outcome.not_looked_at {
        line.push_str(&format!("\n         {}", not_looked_at_text(part)));
    }
    if let Some(special) = &outcome.at_files_values {
        line.push_str(&format!("\n         {}", special_text(special)));
    }
    if !outcome.ok {
        line.push_str(&format!("\n         expected: {}", outcome.expected_word()));
    }
    line
}

/// A thin part of a set that a proof does not speak of, as a sentence.
pub(crate) fn not_looked_at_text(part: &str) -> String {
    format!("nothing is said of a part of fewer dimensions: {part}")
}
