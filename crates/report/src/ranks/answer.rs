//! Answers about ranks, as JSON.

use super::deviations::deviations_json;
use super::generic::{add_generic_json, finite};
use super::motions::motions_json;
use crate::names::{fields_json, ranges_json, values_json};
use palmistry_math::number::rational_to_f64;
use palmistry_rank::observability::{NamedCoordinate, Spectrum, Stop};
use palmistry_rank::sweep::{BranchAnswer, Certainty, Digits, NoDigits, RankAnswer, SweepReport};
use serde_json::{Value, json};
use std::collections::BTreeMap;

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

pub(super) fn certainty_text(certainty: Certainty) -> &'static str {
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
        "singularities": report.poles,
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
