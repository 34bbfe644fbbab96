//! Answers about ranks, as JSON and as text.

use super::generic::{add_generic_json, finite, generic_text};
use super::motions::{motions_json, motions_text};
use super::seen::{deviations_json, deviations_text, direction_text, place_text};
use crate::names::{by_default_text, fields_json, fields_text, ranges_json, values_json, values_text};
use palmistry_lang::Range;
use palmistry_math::number::rational_to_f64;
use palmistry_rank::observability::{NamedCoordinate, Spectrum, Stop};
use palmistry_rank::sweep::{BranchAnswer, Certainty, Digits, NoDigits, RankAnswer, SweepReport};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;

fn histogram_json(histogram: &BTreeMap<usize, u64>) -> Value {
    histogram
        .iter()
        .map(|(rank, count)| (rank.to_string(), json!(count)))
        .collect::<serde_json::Map<_, _>>()
        .into()
}

/// How many states each rung of the ladder decided.
fn rungs_json(report: &SweepReport) -> Value {
    let counts = report.rungs.iter().map(|(rung, count)| (rung.name(), json!(count)));
    counts.collect::<serde_json::Map<_, _>>().into()
}

fn certainty_text(certainty: Certainty) -> &'static str {
    match certainty {
        Certainty::Certified => "certified",
        Certainty::Computed => "computed",
    }
}

/// Singular values and condition of the worst state: those that were found to many digits, where they were.
fn nearest_doubles(report: &SweepReport, spectrum: &Spectrum) -> (Vec<f64>, f64) {
    let rough = || (spectrum.values.clone(), spectrum.condition());
    let Some(Ok(found)) = &report.digits else { return rough() };
    let values: Result<Vec<f64>, _> = found.values.iter().map(|value| value.parse()).collect();
    match (values, found.condition.parse()) {
        (Ok(values), Ok(condition)) => (values, condition),
        _ => rough(),
    }
}

/// Singular values to many digits, or why there are none.
fn digits_json(found: &Result<Digits, NoDigits>) -> Value {
    match found {
        Ok(found) => json!({
            "digits": found.digits,
            "singular_values": found.values,
            "condition": found.condition,
            "verdict": certainty_text(found.certainty),
            "numbers": found.rung.name(),
            "climbed": found.climbed,
        }),
        Err(why) => json!({ "missing": why.to_string() }),
    }
}

pub(super) fn sweep_json(report: &SweepReport) -> Value {
    let worst = report.worst.as_ref().map(|(state, spectrum)| {
        let (values_of_worst, condition) = nearest_doubles(report, spectrum);
        let values: serde_json::Map<String, Value> = state
            .iter()
            .map(|at| (at.name.clone(), json!({ "exact": at.exact, "value": at.value })))
            .collect();
        json!({
            "state": values,
            "singular_values": values_of_worst,
            "condition": finite(condition),
            "gap": finite(spectrum.gap),
        })
    });
    let mut object = json!({
        "samples": report.samples,
        "rank_histogram": histogram_json(&report.rank_histogram),
        "certified": report.certified,
        "decided_by": rungs_json(report),
        "climbed": report.climbed(),
        "singular_values_of": [report.remaining.0, report.remaining.1],
        "computed_rank_histogram": histogram_json(&report.computed_histogram),
        "computed_differs_from_certified": report.disagreements,
        "not_computed": report.samples - report.computed_histogram.values().sum::<u64>(),
        "smallest_gap": finite(report.smallest_gap),
        "worst_conditioned": worst,
        "unseen": report.unseen.iter().map(|direction| json!({
            "states": direction.states,
            "count": direction.count,
            "example": direction.example,
            "sample": direction.index,
            "at": direction.at.iter().map(|NamedCoordinate { name, exact, value }| {
                (name.clone(), json!({ "exact": exact, "value": value }))
            }).collect::<serde_json::Map<_, _>>(),
            "vector": direction.states.iter().zip(&direction.vector).map(|(name, part)| {
                let exact = direction.exact.then(|| part.to_string());
                (name.clone(), json!({ "exact": exact, "value": rational_to_f64(part) }))
            }).collect::<serde_json::Map<_, _>>(),
        })).collect::<Vec<_>>(),
        "poles": report.poles,
        "seconds": report.seconds,
        "interrupted": report.interrupted,
    });
    if let Some(digits) = &report.digits {
        object["worst_to_digits"] = digits_json(digits);
    }
    object
}

/// Why the words end where they end.
pub(crate) fn stop_text(stop: Stop) -> &'static str {
    match stop {
        Stop::Full => "the rank has reached the dimension",
        Stop::Ceiling => "the rank has reached that of the states around",
        Stop::NoGrowth => "the rank stopped growing",
        Stop::Order => "the longest words that were allowed",
        Stop::TooMany => "there are too many longer words",
        Stop::NotTaken => "none were asked for",
        Stop::Interrupted => "interrupted",
    }
}

fn branch_json(branch: &BranchAnswer) -> Value {
    let mut object = sweep_json(&branch.full);
    object["conditions"] = json!(branch.conditions);
    object["held_at_the_files_values"] = values_json(&branch.held);
    object["drawn_by_default"] = ranges_json(&branch.by_default);
    object["words"] = json!(branch.words);
    object["order"] = json!(branch.order);
    object["stopped_because"] = json!(stop_text(branch.stop));
    object["generic_rank"] = json!(branch.generic_rank);
    object["longer_words_cannot_raise_it"] = json!(branch.is_final);
    add_generic_json(&branch.generic, &branch.unknowns, &mut object);
    object["unseen_fields"] = branch.motions.as_ref().map_or(Value::Null, motions_json);
    object["standard_deviations"] = branch.deviations.as_ref().map_or(Value::Null, deviations_json);
    object["own_rows"] = branch.rows.as_ref().map_or(Value::Null, sweep_json);
    object
}

/// An answer as one object: the fields of the first branch of the conditions, and all branches where there are more.
pub fn rank_json(answer: &RankAnswer) -> Value {
    let mut branches: Vec<Value> = answer.branches.iter().map(branch_json).collect();
    let mut object = if branches.len() == 1 { branches.remove(0) } else { total_json(answer, branches) };
    object["file"] = json!(answer.file);
    if !answer.left_out.is_empty() {
        object["no_state_was_drawn_where"] = json!(answer.left_out);
    }
    object["fields"] = fields_json(&answer.fields);
    object["dimension"] = json!(answer.dimension);
    object["known"] = json!(answer.known);
    object["assumed"] = json!(answer.assumed);
    object["seed"] = json!(answer.seed);
    object
}

/// Several branches: their sums, and each of them.
fn total_json(answer: &RankAnswer, branches: Vec<Value>) -> Value {
    let mut histogram = BTreeMap::new();
    for branch in &answer.branches {
        for (rank, count) in &branch.full.rank_histogram {
            *histogram.entry(*rank).or_insert(0) += count;
        }
    }
    let sum =
        |of: fn(&SweepReport) -> u64| answer.branches.iter().map(|branch| of(&branch.full)).sum::<u64>();
    json!({
        "samples": sum(|r| r.samples),
        "rank_histogram": histogram_json(&histogram),
        "certified": sum(|r| r.certified),
        "seconds": answer.branches.iter().map(|branch| branch.full.seconds).sum::<f64>(),
        "interrupted": answer.interrupted(),
        "branches": branches,
    })
}

fn sweep_text(title: &str, report: &SweepReport, out: &mut String) {
    let _ = writeln!(out, "{title}");
    if report.samples == 0 {
        let _ = writeln!(out, "  no state could be decided");
    }
    for (rank, count) in report.rank_histogram.iter().rev() {
        let _ = writeln!(out, "  rank {rank:>2} at {count} states");
    }
    let _ = writeln!(out, "  certified at {} of {} states", report.certified, report.samples);
    let rungs: Vec<String> =
        report.rungs.iter().map(|(rung, count)| format!("{} at {count}", rung.name())).collect();
    let _ = writeln!(out, "  decided by {}; {} states climbed", rungs.join(", "), report.climbed());
    if report.disagreements > 0 {
        let _ = writeln!(
            out,
            "  at {} states the singular values alone suggest another rank: {:?}",
            report.disagreements, report.computed_histogram
        );
    }
    if report.smallest_gap.is_finite() {
        let _ = writeln!(out, "  smallest gap on which a computed rank rests: {:.1e}", report.smallest_gap);
    }
    // how hard a rank is to decide says nothing of how well a state is observable: it is for those who ask for digits
    if let Some((state, spectrum)) = report.worst.as_ref().filter(|_| report.digits.is_some()) {
        let values: Vec<String> = state.iter().map(|at| format!("{} = {:.6}", at.name, at.value)).collect();
        let condition = match &report.digits {
            Some(Ok(found)) => found.condition.clone(),
            _ => format!("{:.3e}", spectrum.condition()),
        };
        let _ = writeln!(out, "  worst conditioned: {condition} at {}", values.join(", "));
        let (rows, columns) = report.remaining;
        let _ = writeln!(
            out,
            "  (singular values are those of the {rows} by {columns} matrix that remains without unit rows, equilibrated)"
        );
    }
    match &report.digits {
        None => {}
        Some(Ok(found)) => {
            if !found.values.is_empty() {
                let _ = writeln!(out, "  its singular values: {}", found.values.join(", "));
            }
            let _ = writeln!(
                out,
                "  {} digits, {} by {}; rungs climbed: {}",
                found.digits,
                certainty_text(found.certainty),
                found.rung.name(),
                found.climbed
            );
        }
        Some(Err(why)) => {
            let _ = writeln!(out, "  no digits beyond those of doubles: {why}");
        }
    }
    for direction in &report.unseen {
        let _ = writeln!(
            out,
            "  not seen at {} states: a direction in {}; for one, {}",
            direction.count,
            direction.states.join(", "),
            direction.example
        );
        let _ = writeln!(out, "    at {}: {}", place_text(&direction.at), direction_text(direction));
    }
    for (pole, count) in &report.poles {
        let _ = writeln!(out, "  {count} poles left out: {pole}");
    }
    if report.interrupted {
        let _ = writeln!(out, "  interrupted: these are the states done until then");
    }
    if report.seconds.is_finite() {
        let _ = writeln!(out, "  {:.2} s", report.seconds);
    }
}

/// What an answer takes for granted beside its file's equations: what is known and so not counted, what is assumed of signals,
/// and ranges that the file does not give.
pub(crate) fn taken_for_granted(answer: &RankAnswer) -> Vec<String> {
    let mut lines = Vec::new();
    if !answer.known.is_empty() {
        lines.push(format!("known, and not counted: {}", answer.known.join(", ")));
    }
    if !answer.assumed.is_empty() {
        lines.push(format!("assumed of unknown signals: {}", answer.assumed.join(", ")));
    }
    let mut by_default: Vec<(String, Range)> = Vec::new();
    for one in answer.branches.iter().flat_map(|branch| &branch.by_default) {
        if !by_default.contains(one) {
            by_default.push(one.clone());
        }
    }
    if !by_default.is_empty() {
        lines.push(by_default_text(&by_default));
    }
    lines
}

/// An answer as text.
pub fn rank_text(answer: &RankAnswer) -> String {
    let mut out = format!("{}: {} states, {} outputs\n", answer.title, answer.dimension, answer.outputs);
    let _ = writeln!(out, "fields: {}", fields_text(&answer.fields));
    for line in taken_for_granted(answer) {
        let _ = writeln!(out, "{line}");
    }
    for branch in &answer.branches {
        if !branch.conditions.is_empty() {
            let _ = writeln!(out, "where {}", branch.conditions.join(", "));
        }
        if !branch.held.is_empty() {
            let _ = writeln!(
                out,
                "held at the file's values: {} (a claim 'rank = n' is about all values)",
                values_text(&branch.held)
            );
        }
        generic_text(&branch.generic, &branch.unknowns, &mut out);
        if branch.stop == Stop::NotTaken {
            branch.motions.iter().for_each(|found| motions_text(found, false, &mut out));
            let _ = writeln!(out, "no states were sampled (--samples N draws N)");
            continue;
        }
        let _ = writeln!(out, "words that were needed: {}", branch.words.join(", "));
        let _ =
            writeln!(out, "words of up to {} fields were taken: {}", branch.order, stop_text(branch.stop));
        if !branch.is_final {
            let _ =
                writeln!(out, "longer words may still raise the rank: nothing here says that they cannot");
        }
        branch.motions.iter().for_each(|found| motions_text(found, true, &mut out));
        sweep_text("the full codistribution", &branch.full, &mut out);
        branch.deviations.iter().for_each(|found| deviations_text(found, &mut out));
        if let Some(rows) = &branch.rows {
            sweep_text("the file's own choice of rows", rows, &mut out);
        }
    }
    for place in &answer.left_out {
        let _ = writeln!(out, "no state of the sample box was found where {place}");
    }
    out.trim_end().to_owned()
}
