//! Answers about ranks, as JSON and as text.

use super::deviations::{deviations_json, deviations_text, direction_text, place_text};
use super::generic::{add_generic_json, finite, generic_text};
use super::motions::{motions_json, motions_text};
use crate::layout::{counted, item, prose};
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

/// How many states each number type decided.
fn number_types_json(report: &SweepReport) -> Value {
    let counts = report.number_types.iter().map(|(number_type, count)| (number_type.name(), json!(count)));
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
            "numbers": found.number_type.name(),
            "escalated": found.climbed,
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
        "decided_by": number_types_json(report),
        "escalated": report.climbed(),
        "singular_values_of": [report.remaining.0, report.remaining.1],
        "computed_rank_histogram": histogram_json(&report.computed_histogram),
        "computed_differs_from_certified": report.disagreements,
        "not_computed": report.samples - report.computed_histogram.values().sum::<u64>(),
        "smallest_gap": finite(report.smallest_gap),
        "worst_conditioned": worst,
        "unobservable": report.unobservable.iter().map(|direction| json!({
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

/// Why no Lie derivatives of higher order were taken.
pub(crate) fn stop_text(stop: Stop) -> &'static str {
    match stop {
        Stop::Full => "the rank has reached the dimension",
        Stop::Ceiling => "the rank has reached that of the states around",
        Stop::NoGrowth => "the rank stopped growing",
        Stop::Order => "the highest order that was allowed",
        Stop::TooMany => "there are too many of higher order",
        Stop::NotTaken => "none were asked for",
        Stop::Interrupted => "interrupted",
    }
}

fn branch_json(branch: &BranchAnswer) -> Value {
    let mut object = sweep_json(&branch.full);
    object["conditions"] = json!(branch.conditions);
    object["fixed_at_the_files_values"] = values_json(&branch.held);
    object["drawn_by_default"] = ranges_json(&branch.by_default);
    object["lie_derivatives"] = json!(branch.lie_derivatives);
    object["order"] = json!(branch.order);
    object["stopped_because"] = json!(stop_text(branch.stop));
    object["generic_rank"] = json!(branch.generic_rank);
    object["higher_derivatives_cannot_raise_it"] = json!(branch.is_final);
    add_generic_json(&branch.generic, &branch.unknowns, &mut object);
    object["unobservable_directions"] = branch.motions.as_ref().map_or(Value::Null, motions_json);
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

/// The ranks at the sampled states in one sentence, and what was met on the way.
fn sampled_text(title: &str, report: &SweepReport, out: &mut String) {
    let ranks: Vec<String> =
        report.rank_histogram.iter().rev().map(|(rank, count)| format!("{rank} at {count} states")).collect();
    let sampled = match ranks.is_empty() {
        true => "no state could be decided".to_owned(),
        false => {
            format!("rank {}; certified at {} of {}", ranks.join(", "), report.certified, report.samples)
        }
    };
    prose(&format!("{title}: {sampled}"), out);
    if report.disagreements > 0 {
        item(
            &format!(
                "at {} the singular values alone suggest another rank: {:?}",
                counted(report.disagreements, "state"),
                report.computed_histogram
            ),
            out,
        );
    }
    for (pole, count) in &report.poles {
        item(&format!("{} left out, singular there: {pole}", counted(*count, "state")), out);
    }
    if report.interrupted {
        item("interrupted: these are the states done until then", out);
    }
}

/// Unobservable directions at single states; where the rank there is lower than elsewhere, by Lie derivatives up to this order alone.
fn directions_text(report: &SweepReport, short_up_to: Option<usize>, out: &mut String) {
    let unobservable = match short_up_to {
        Some(order) => format!("not observable by Lie derivatives up to order {order}"),
        None => "unobservable".to_owned(),
    };
    for direction in &report.unobservable {
        item(
            &format!(
                "at {} {unobservable}: a direction in {}; for one, {}",
                counted(direction.count, "state"),
                direction.states.join(", "),
                direction.example
            ),
            out,
        );
        item(&format!("  at {}:", place_text(&direction.at)), out);
        // on one line: it is to be copied
        let _ = writeln!(out, "    {}", direction_text(direction));
    }
}

/// How the ranks at the sampled states were decided.
fn sweep_details(report: &SweepReport, out: &mut String) {
    let number_types: Vec<String> = report
        .number_types
        .iter()
        .map(|(number_type, count)| format!("{} at {count}", number_type.name()))
        .collect();
    if !number_types.is_empty() {
        let climbed = report.climbed();
        item(
            &format!(
                "number types: {}; {climbed} states escalated to a higher precision",
                number_types.join(", ")
            ),
            out,
        );
    }
    if report.smallest_gap.is_finite() {
        item(&format!("smallest gap on which a computed rank rests: {:.1e}", report.smallest_gap), out);
    }
    if report.seconds.is_finite() {
        item(&format!("{:.2} s", report.seconds), out);
    }
}

/// The digits of the worst conditioned state, which were asked for.
fn digits_text(report: &SweepReport, out: &mut String) {
    let Some(digits) = &report.digits else { return };
    // how hard a rank is to decide says nothing of how well a state is observable: it is for those who ask for digits
    if let Some((state, spectrum)) = &report.worst {
        let values: Vec<String> = state.iter().map(|at| format!("{} = {:.6}", at.name, at.value)).collect();
        let condition = match digits {
            Ok(found) => found.condition.clone(),
            Err(_) => format!("{:.3e}", spectrum.condition()),
        };
        item(&format!("worst conditioned: {condition} at {}", values.join(", ")), out);
        let (rows, columns) = report.remaining;
        item(
            &format!(
                "(singular values are those of the {rows} by {columns} matrix that remains without unit rows, equilibrated)"
            ),
            out,
        );
    }
    match digits {
        Ok(found) => {
            if !found.values.is_empty() {
                item(&format!("its singular values: {}", found.values.join(", ")), out);
            }
            let (kind, climbed) = (certainty_text(found.certainty), counted(found.climbed, "escalation"));
            item(
                &format!("{} digits, {kind} by {} after {climbed}", found.digits, found.number_type.name()),
                out,
            );
        }
        Err(why) => item(&format!("no digits beyond those of doubles: {why}"), out),
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

/// An answer as text: the unknowns, unobservable directions, the sampled ranks, how well each state is observable; and with the details the Lie derivatives that were used, number
/// types, gaps and times.
pub fn rank_text(answer: &RankAnswer, details: bool) -> String {
    let (states, outputs) = (counted(answer.dimension, "unknown"), counted(answer.outputs, "output"));
    let mut out = format!("{}\n", answer.title);
    prose(&format!("{states}, {outputs}; {}", fields_text(&answer.fields)), &mut out);
    for line in taken_for_granted(answer) {
        prose(&line, &mut out);
    }
    for branch in &answer.branches {
        branch_text(branch, details, &mut out);
    }
    for place in &answer.left_out {
        prose(&format!("no state of the sample box was found where {place}"), &mut out);
    }
    out.trim_end().to_owned()
}

fn branch_text(branch: &BranchAnswer, details: bool, out: &mut String) {
    if !branch.conditions.is_empty() {
        prose(&format!("where {}", branch.conditions.join(", ")), out);
    }
    if !branch.held.is_empty() {
        let values = values_text(&branch.held);
        prose(
            &format!("fixed at the values in the file: {values} (a claim 'rank = n' is about all values)"),
            out,
        );
    }
    generic_text(&branch.generic, &branch.unknowns, out);
    let sampled = branch.stop != Stop::NotTaken;
    branch.motions.iter().for_each(|found| motions_text(found, sampled, out));
    if !sampled {
        prose("no states were sampled (--samples N draws N)", out);
        return;
    }
    if !branch.is_final {
        prose("higher Lie derivatives may still raise the rank: nothing here says that they cannot", out);
    }
    let short_up_to = branch.is_short_somewhere().then_some(branch.order);
    let title = match short_up_to {
        Some(order) => format!("at sampled states, by Lie derivatives up to order {order}"),
        None => "at sampled states".to_owned(),
    };
    sampled_text(&title, &branch.full, out);
    // fields that were found say the same for all states
    let is_known = branch.motions.as_ref().is_some_and(|found| found.fields_missing == 0);
    let lower = branch.full.rank_histogram.range(..branch.generic_rank).map(|(_, count)| count).sum::<u64>();
    if details || !is_known {
        directions_text(&branch.full, short_up_to, out);
    }
    digits_text(&branch.full, out);
    if lower > 0 {
        item(
            &format!(
                "rank-deficient at {lower} of them: --where-it-drops gives the singular set, by Lie derivatives of all orders"
            ),
            out,
        );
    }
    if details {
        let longest = branch.order;
        item(&format!("Lie derivatives used: {}", branch.lie_derivatives.join(", ")), out);
        item(&format!("Lie derivatives up to order {longest} were taken: {}", stop_text(branch.stop)), out);
        sweep_details(&branch.full, out);
    }
    if let Some(rows) = &branch.rows {
        sampled_text("rows of the file at the same states", rows, out);
        directions_text(rows, None, out);
        digits_text(rows, out);
        if details {
            sweep_details(rows, out);
        }
    }
    branch.deviations.iter().for_each(|found| deviations_text(found, out));
}
