//! What is unobservable at a state, and how well everything else is observable.

use crate::layout::{in_columns, item, prose};
use crate::names::plain_number;
use dashu::rational::RBig;
use palmistry_math::number::{rational_to_f64, round_to_decimal};
use palmistry_rank::observability::{NamedCoordinate, WrittenState};
use palmistry_rank::sweep::{LeastObservable, NEARLY_INVISIBLE, StandardDeviations, UnobservableDirection};
use serde_json::{Value, json};
use std::fmt::Write;

/// Numbers of more characters than these are shown rounded.
const LONGEST: usize = 12;

/// A state as text: exactly where its numbers are short, angles in radians.
pub(super) fn place_text(state: &WrittenState) -> String {
    let coordinate = |NamedCoordinate { name, exact, value }: &NamedCoordinate| match exact.len() <= LONGEST {
        true => format!("{name} = {exact}"),
        // an angle is nought
        false if *value == 0.0 || has_decimals(*value) => format!("{name} = {value:.6}"),
        false => format!("{name} = {value:.5e}"),
    };
    state.iter().map(coordinate).collect::<Vec<_>>().join(", ")
}

/// A direction as a vector: `(r1, r2) += t (1, -2), that is d/dr1 - 2 d/dr2`.
pub(super) fn direction_text(direction: &UnobservableDirection) -> String {
    let parts: Vec<String> = direction.vector.iter().map(part_text).collect();
    let mut field = String::new();
    for (name, part) in direction.states.iter().zip(&parts) {
        let size = part.trim_start_matches('-');
        let sign = match (field.is_empty(), part.starts_with('-')) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        };
        let factor = if size == "1" { String::new() } else { format!("{size} ") };
        let _ = write!(field, "{sign}{factor}d/d{name}");
    }
    let (states, parts) = (direction.states.join(", "), parts.join(", "));
    match direction.states.len() {
        1 => format!("{states} += t, that is {field}"),
        _ => format!("({states}) += t ({parts}), that is {field}"),
    }
}

pub(super) fn part_text(part: &RBig) -> String {
    let (exact, near) = (plain_number(part), rational_to_f64(part));
    match exact.len() <= LONGEST {
        true => exact,
        false if has_decimals(near) => format!("{near:.6}"),
        false => round_to_decimal(part, 6),
    }
}

/// Whether six decimals say what a number is: of one that is nearer to zero they would be zeros.
fn has_decimals(value: f64) -> bool {
    (1e-4..1e9).contains(&value.abs())
}

/// Standard deviations as a table.
pub(super) fn deviations_text(found: &StandardDeviations, out: &mut String) {
    prose(
        &format!(
            "standard deviation of each state, normalised by its prior one (the spread over the box); median and worst of {} \
             states, each Lie derivative measured up to its own spread:",
            found.states
        ),
        out,
    );
    let width = found.list.iter().map(|row| row.state.chars().count()).max().unwrap_or(0).max(5);
    let _ = writeln!(out, "  {:<width$}  {:>10}  {:>12}  {:>12}", "state", "prior", "median", "worst");
    for row in &found.list {
        // of an observable state whose deviation doubles cannot compute it is not said that it is unobservable
        let infinite = if row.is_observable { "unknown" } else { unobservable(found) };
        let deviation = |value: f64| if value.is_finite() { number_text(value) } else { infinite.to_owned() };
        let remark = match (row.infinite, row.median >= NEARLY_INVISIBLE) {
            (0, true) => "  nearly unobservable".to_owned(),
            (0, false) => String::new(),
            (count, _) if count == found.states => String::new(),
            (count, _) => format!("  {infinite} at {count} of them"),
        };
        let line = format!(
            "  {:<width$}  {:>10}  {:>12}  {:>12}{remark}",
            row.state,
            number_text(row.spread),
            deviation(row.median),
            deviation(row.worst)
        );
        // a long name: the line is broken
        let _ = writeln!(out, "{}", in_columns(line.trim_end()));
    }
    if let Some(least) = &found.least {
        let (state, deviation) = (&least.state, deviation_text(found, least));
        item(&format!("least observable: {state}, {deviation}, at {}", place_text(&least.at)), out);
    }
}

/// The states that are nearly unobservable, in one line; nothing where there is none.
pub(super) fn nearly_unobservable_text(found: &StandardDeviations, out: &mut String) {
    let nearly = found.list.iter().filter(|row| row.infinite == 0 && row.median >= NEARLY_INVISIBLE);
    let names: Vec<&str> = nearly.map(|row| row.state.as_str()).collect();
    if !names.is_empty() {
        item(
            &format!("nearly unobservable there: {} (--details: standard deviations)", names.join(", ")),
            out,
        );
    }
}

/// How well the state is observable that is so least.
pub(crate) fn deviation_text(found: &StandardDeviations, least: &LeastObservable) -> String {
    let is_observable = found.list.iter().any(|row| row.state == least.state && row.is_observable);
    match (least.deviation.is_finite(), is_observable) {
        (true, _) => number_text(least.deviation),
        (false, true) => "unknown".to_owned(),
        (false, false) => unobservable(found).to_owned(),
    }
}

/// The term for a state that the Lie derivatives which were taken do not determine.
fn unobservable(found: &StandardDeviations) -> &'static str {
    if found.may_be_finite { "infinite" } else { "unobservable" }
}

fn number_text(value: f64) -> String {
    match value {
        value if (0.01..1e4).contains(&value) => format!("{value:.3}"),
        value => format!("{value:.2e}"),
    }
}

/// The same as JSON: `null` where a state is unobservable, or where doubles cannot decide how well it is observable.
pub(super) fn deviations_json(found: &StandardDeviations) -> Value {
    let finite = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
    json!({
        "states": found.states,
        "units_of_noise": found.lie_derivatives.iter().map(|(word, unit)| (word.clone(), json!(unit)))
            .collect::<serde_json::Map<_, _>>(),
        "least_observable": found.least.as_ref().map(|least| json!({
            "state": least.state,
            "deviation": finite(least.deviation),
            "at": least.at.iter().map(|at| (at.name.clone(), json!({ "exact": at.exact, "value": at.value })))
                .collect::<serde_json::Map<_, _>>(),
        })),
        "of": found.list.iter().map(|row| json!({
            "state": row.state,
            "prior_standard_deviation": row.spread,
            "median": finite(row.median),
            "worst": finite(row.worst),
            "unobservable_at": if row.is_observable { 0 } else { row.infinite },
            "unknown_at": if row.is_observable { row.infinite } else { 0 },
            "nearly_invisible": row.median.is_finite() && row.median >= NEARLY_INVISIBLE,
        })).collect::<Vec<_>>(),
    })
}
