//! Answers about accessibility, as JSON and as text.

use super::answer::{stop_text, sweep_json};
use super::deviations::{part_text, place_text};
use super::generic::finite;
use crate::layout::{counted, in_columns};
use crate::names::{fields_json, fields_text, values_json, values_text};
use palmistry_rank::observability::RankBounds;
use palmistry_rank::sweep::{AccessibilityAnswer, AccessibilityBranch, SweepReport, UnobservableDirection};
use serde_json::{Value, json};
use std::fmt::Write;

fn bounds_json(bounds: &RankBounds) -> Value {
    json!({
        "rank": bounds.rank(),
        "at_least": bounds.at_least,
        "at_most": bounds.at_most,
        "log2_error": finite(bounds.log2_error),
        "from_a_state": bounds.from_a_state,
    })
}

fn branch_json(branch: &AccessibilityBranch) -> Value {
    let mut sampled = branch.sampled.as_ref().map_or(Value::Null, sweep_json);
    if let Some(fields) = sampled.as_object_mut()
        && let Some(unobservable) = fields.remove("unobservable")
    {
        fields.insert("unmoved".to_owned(), unobservable);
    }
    json!({
        "conditions": branch.conditions,
        "fixed_at_the_files_values": values_json(&branch.held),
        "brackets": branch.brackets,
        "order": branch.order,
        "stopped_because": stop_text(branch.stop),
        "accessibility": bounds_json(&branch.whole),
        "strong_accessibility": bounds_json(&branch.strong),
        "sampled": sampled,
    })
}

/// An answer as one object.
pub fn accessibility_json(answer: &AccessibilityAnswer) -> Value {
    json!({
        "file": answer.file,
        "fields": fields_json(&answer.fields),
        "dimension": answer.coordinates.len(),
        "coordinates": answer.coordinates,
        "seed": answer.seed,
        "final": answer.is_final(),
        "interrupted": answer.interrupted(),
        "branches": answer.branches.iter().map(branch_json).collect::<Vec<_>>(),
    })
}

fn bounds_text(what: &str, bounds: &RankBounds, full: usize, out: &mut String) {
    let _ = match bounds.rank() {
        Some(rank) => {
            let sure = match bounds.log2_error.is_finite() {
                // the bound itself is rounded up
                true => format!("no more, error probability below 2^{}", bounds.log2_error.ceil()),
                false => "certain".to_owned(),
            };
            let scope = match bounds.from_a_state {
                true => " on the parts of the domain that have sampled states",
                false => "",
            };
            writeln!(out, "{what}: generic rank {rank} of {full}{scope} ({sure})")
        }
        None => writeln!(
            out,
            "{what}: undecided, generically a rank of {} to {} of {full}",
            bounds.at_least, bounds.at_most
        ),
    };
}

/// An answer as text.
pub fn accessibility_text(answer: &AccessibilityAnswer) -> String {
    let full = answer.coordinates.len();
    let mut out = format!("{}: {} that can be moved\n", answer.title, counted(full, "coordinate"));
    let _ = writeln!(out, "fields: {}", fields_text(&answer.fields));
    for branch in &answer.branches {
        if !branch.conditions.is_empty() {
            let _ = writeln!(out, "where {}", branch.conditions.join(", "));
        }
        if !branch.held.is_empty() {
            let _ = writeln!(out, "fixed at the values in the file: {}", values_text(&branch.held));
        }
        bounds_text("accessibility", &branch.whole, full, &mut out);
        bounds_text("strong accessibility, without the drift itself", &branch.strong, full, &mut out);
        let _ = writeln!(out, "brackets that were needed: {}", branch.brackets.join(", "));
        let fields = counted(branch.order, "field");
        let _ = writeln!(out, "brackets of up to {fields} were taken: {}", stop_text(branch.stop));
        if let Some(report) = &branch.sampled {
            sampled_text(branch, report, &mut out);
        }
    }
    in_columns(out.trim_end())
}

/// `dx - 2 dy`
fn differential_text(direction: &UnobservableDirection) -> String {
    let mut text = String::new();
    for (name, part) in direction.states.iter().zip(&direction.vector) {
        let part = part_text(part);
        let size = part.trim_start_matches('-');
        text.push_str(match (text.is_empty(), part.starts_with('-')) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        });
        let factor = if size == "1" { String::new() } else { format!("{size} ") };
        let _ = write!(text, "{factor}d{name}");
    }
    text
}

fn sampled_text(branch: &AccessibilityBranch, report: &SweepReport, out: &mut String) {
    let _ = writeln!(out, "the brackets that were taken, at sampled states");
    if report.samples == 0 {
        let _ = writeln!(out, "  no state could be decided");
    }
    for (rank, count) in report.rank_histogram.iter().rev() {
        let more = match branch.whole.rank() {
            Some(generic) if *rank < generic => "; longer brackets may raise it there",
            _ => "",
        };
        let _ = writeln!(out, "  rank {rank:>2} at {}{more}", counted(*count, "state"));
    }
    let _ = writeln!(out, "  certified at {} of {}", report.certified, counted(report.samples, "state"));
    for direction in &report.unobservable {
        let _ = writeln!(
            out,
            "  no bracket moves, at {}: a combination of {}; for one, {} = 0",
            counted(direction.count, "state"),
            direction.states.join(", "),
            differential_text(direction)
        );
        let _ = writeln!(out, "    at {}", place_text(&direction.at));
    }
    for (pole, count) in &report.poles {
        let _ = writeln!(out, "  {} left out, singular there: {pole}", counted(*count, "state"));
    }
    if report.interrupted {
        let _ = writeln!(out, "  interrupted: these are the states done until then");
    }
    if report.seconds.is_finite() {
        let _ = writeln!(out, "  {:.2} s", report.seconds);
    }
}
