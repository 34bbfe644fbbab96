//! The main job's findings as JSON and as lines for the terminal.

use crate::certificate::answer::region_json;
use crate::claims::outcomes::{claim_json, claim_line};
use crate::claims::verdicts::{counts, counts_text, errors};
use crate::joint::{JointObserved, joint_json};
use crate::layout::counted;
use crate::motion::answers::{Observed, observe_json};
use crate::ranks::answer::rank_json;
use crate::ranks::{drops_json, taken_for_granted};
use crate::slow::slow_json;
use crate::slow_observed::SlowObserved;
use crate::space::{SpaceObserved, space_json};
use crate::stress::answer::stress_json;
use crate::trade::answer::trade_json;
use palmistry_io::foreign::shown;
use palmistry_lang::Flaw;
use palmistry_rank::sweep::RankAnswer;
use palmistry_scenes::Answer;
use palmistry_workbench::paper::{FileFindings, Findings, LeftOut, LineFound, ReductionFound, SetRank};
use palmistry_workbench::tradeoff::stress::StressStudy;
use palmistry_workbench::tradeoff::{LandscapeRows, Map, PrintedExpression, PrintedValue};
use serde_json::{Value, json};
use std::fmt::Write;

/// What a plot needs of a number, so that the file stays small.
fn four_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

fn map_json(kind: LandscapeRows, map: &Map, of: Option<&str>) -> Value {
    json!({
        "rows": if kind == LandscapeRows::Own { "own" } else { "full" },
        "x": { "name": map.x.name, "low": map.x.low, "high": map.x.high, "cells": map.width },
        "y": { "name": map.y.name, "low": map.y.low, "high": map.y.high, "cells": map.height },
        "of": of.unwrap_or("worst"),
        "standard_deviation": map.deviations.iter().map(|v| v.map(deviation_json)).collect::<Vec<_>>(),
        "cells_by_state": object_of(&map.shown, |count| json!(count)),
        "priors": object_of(&map.scales.priors, |value| json!(value)),
        "units_of_noise": object_of(&map.scales.noise, |value| json!(value)),
    })
}

fn object_of<T>(list: &[(String, T)], value: impl Fn(&T) -> Value) -> Value {
    list.iter().map(|(name, one)| (name.clone(), value(one))).collect::<serde_json::Map<_, _>>().into()
}

/// A standard deviation over its prior one; where it is infinite a string, since null is a pole.
fn deviation_json(value: f64) -> Value {
    if value.is_finite() { json!(four_digits(value)) } else { json!("infinite") }
}

fn line_json(line: &LineFound) -> Value {
    let slope = &line.slope;
    let of = |place: usize| -> Vec<Option<Value>> {
        slope.values.iter().map(|values| Some(deviation_json(values.as_ref()?[place]))).collect()
    };
    let all = slope.names.iter().enumerate().map(|(place, name)| (name.clone(), json!(of(place))));
    json!({
        "into": line.view.title,
        "rows": if line.rows == LandscapeRows::Own { "own" } else { "full" },
        "distance": slope.distance.iter().copied().map(four_digits).collect::<Vec<_>>(),
        "standard_deviation": all.collect::<serde_json::Map<_, _>>(),
        "priors": object_of(&slope.scales.priors, |value| json!(value)),
        "units_of_noise": object_of(&slope.scales.noise, |value| json!(value)),
    })
}

fn set_json(rank: &SetRank) -> Value {
    let mut object = match rank.answer() {
        Ok(answer) => rank_json(answer),
        Err(why) if rank.is_pole() => json!({ "singularity": why }),
        Err(why) => json!({ "not_decided": why }),
    };
    object["set"] = json!(rank.name());
    object["conditions"] = json!(rank.set.as_ref().map(|set| &set.written).cloned().unwrap_or_default());
    object["as_expected"] = json!(rank.as_expected());
    object
}

fn reduction_json(found: &ReductionFound) -> Value {
    json!({
        "of": found.of,
        "conditions": found.reduction.written,
        "left_out": found.left_out,
        "proved": found.proved(),
        "claims": found.claims.iter().map(claim_json).collect::<Vec<_>>(),
        "saved": match &found.comparison {
            Ok(c) => json!({
                "states": c.small_states,
                "states_of_the_larger": c.large_states,
                "operations": c.small_operations,
                "operations_of_the_larger": c.large_operations,
                "largest_relative_difference": c.largest_difference,
                "seconds_a_state": c.small_seconds,
                "seconds_a_state_of_the_larger": c.large_seconds,
                "seconds_ratio": c.large_seconds / c.small_seconds,
            }),
            Err(why) => json!({ "not_counted": why }),
        },
    })
}

fn file_json(file: &FileFindings) -> Value {
    json!({
        "file": file.system.name,
        "title": file.system.title,
        "ok": file.ok(),
        "claims": file.outcomes.iter().map(claim_json).collect::<Vec<_>>(),
        "ranks": file.ranks.iter().map(set_json).collect::<Vec<_>>(),
        "maps": file.maps.iter().map(|found| json!({
            "title": found.view.title,
            "maps": found.maps.iter().map(|(kind, map)| map_json(*kind, map, found.view.of.as_deref())).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "lines": file.lines.iter().map(line_json).collect::<Vec<_>>(),
        "printed": file.printed.iter().map(printed_json).collect::<Vec<_>>(),
        "reductions": file.reductions.iter().map(reduction_json).collect::<Vec<_>>(),
        "lie_derivatives": file.derivatives.as_ref().map(|found| json!({
            "field": found.field,
            "output": found.output,
            "routes": found.routes.iter().map(|r| json!({
                "order": r.order,
                "states": r.states,
                "largest_relative_difference": r.largest_difference,
            })).collect::<Vec<_>>(),
            "growth": found.growth.iter().map(|g| json!({
                "order": g.order, "operations": g.operations, "seconds": g.seconds,
            })).collect::<Vec<_>>(),
        })),
        "differentiation": file.ways.as_ref().map(|found| json!({
            "fields": found.fields,
            "derivatives": found.derivatives,
            "too_long": found.too_long,
            "order": found.order,
            "states": found.states,
            "agree": found.agree(),
            "largest_difference": { "duals": found.largest[0], "series": found.largest[1] },
        })),
        "trade": file.trade.as_ref().map(trade_json),
        "where_it_drops": file.drops.as_ref().map(drops_json),
        "certificate": file.certificate.as_ref().map(region_json),
        "left_out": left_json(&file.left_out),
        "too_large": left_json(&file.too_large),
    })
}

fn left_json(left: &[LeftOut]) -> Value {
    left.iter().map(|left| json!({ "what": left.what, "why": left.why })).collect()
}

fn printed_json(found: &PrintedExpression) -> Value {
    json!({
        "formula": found.text,
        "expanded": found.expanded.as_ref().map(|expanded| json!({
            "monomials": expanded.monomials,
            "front": expanded.front,
            "denominator": expanded.denominator,
        })),
        "values": found.values.iter().map(printed_value_json).collect::<Vec<_>>(),
    })
}

/// A number in print beside the certified value.
pub fn printed_value_json(value: &PrintedValue) -> Value {
    json!({
        "id": value.id,
        "point": value.point,
        "printed": value.printed,
        "certified": value.certified.decimal,
        "digits_that_agree": value.digits_that_agree,
        "printed_error": value.error,
        "carried": value.carried,
        "rounding": match &value.study {
            Ok(study) => json!({
                "digits": study.digits,
                "monomials": study.monomials,
                "orders": study.errors.len(),
                "least_error": study.errors.first(),
                "greatest_error": study.errors.last(),
                "root_mean_square_error": study.deviation(),
                "largest_monomial_over_sum": study.cancellation,
                "printed_error_is_inside": study.contains(value.error),
            }),
            Err(why) => json!({ "not_known": why }),
        },
    })
}

/// Everything as one object.
pub fn findings_json(found: &Findings) -> Value {
    let paper = &found.paper;
    let words = counts(found.outcomes()).into_iter().collect::<std::collections::BTreeMap<_, _>>();
    let stress: Vec<StressStudy> = found.files.iter().filter_map(|file| file.stress.clone()).collect();
    json!({
        "ok": found.ok(),
        "interrupted": found.interrupted,
        "seed": found.seed,
        "paper": {
            "title": paper.title,
            "authors": paper.authors,
            "year": paper.year,
            "source": paper.source,
        },
        "counts": words,
        "errata": found.outcomes().filter(|o| o.word() == "erratum").map(|o| &o.id).collect::<Vec<_>>(),
        "independent_errata": errors(&paper.numbering, found.outcomes(), Flaw::Erratum)
            .independent.iter().map(|o| &o.id).collect::<Vec<_>>(),
        "equations": paper.numbering.equations(found.outcomes()).iter().map(|equation| json!({
            "number": equation.number,
            "verdict": equation.word(),
            "entries": equation.entries.iter().map(|outcome| &outcome.id).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "files": found.files.iter().map(file_json).collect::<Vec<_>>(),
        "stress": stress_json(&stress, found.seed),
        "experiments": found.experiments.iter().map(|(experiment, answers)| {
            observe_json(&Observed::of(experiment, answers))
        }).chain(found.slow.iter().map(|(experiment, answers)| {
            slow_json(&SlowObserved::of(experiment, answers))
        })).chain(found.space.iter().map(|(experiment, answers)| {
            space_json(&SpaceObserved::of(experiment, answers))
        })).chain(found.joint.iter().map(|(experiments, answer)| {
            joint_json(&JointObserved::of(experiments, answer))
        })).collect::<Vec<_>>(),
        "seconds": found.seconds,
    })
}

/// Replaces each wall-clock time that a page would show by NaN, and leaves out what rests on such times: two runs with one seed
/// on one machine then have the same output to the last byte.
pub fn forget_times(found: &mut Findings) {
    found.seconds = f64::NAN;
    for file in &mut found.files {
        file.trade = None;
        if let Some(drops) = &mut file.drops {
            drops.seconds = f64::NAN;
        }
        for comparison in file.reductions.iter_mut().filter_map(|found| found.comparison.as_mut().ok()) {
            (comparison.small_seconds, comparison.large_seconds) = (f64::NAN, f64::NAN);
        }
        if let Some(certificate) = &mut file.certificate {
            certificate.seconds = f64::NAN;
        }
    }
    found.slow.iter_mut().for_each(|(_, answers)| answers.seconds = [f64::NAN; 3]);
    found.space.iter_mut().for_each(|(_, answers)| answers.forget_times());
    found.experiments.iter_mut().flat_map(|(_, answers)| answers).for_each(Answer::forget_times);
}

/// Takes away all that depends on the clock: each field with `seconds` in its name.
pub fn forget_seconds(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|name, _| !name.contains("seconds"));
            fields.values_mut().for_each(forget_seconds);
        }
        Value::Array(items) => items.iter_mut().for_each(forget_seconds),
        _ => {}
    }
}

/// `6 at 200 states; 5 at 3`, over all branches.
pub(crate) fn ranks_in_words(answer: &RankAnswer, own: bool) -> String {
    let mut total = std::collections::BTreeMap::new();
    for branch in &answer.branches {
        let report = if own { branch.rows.as_ref() } else { Some(&branch.full) };
        for (rank, count) in report.into_iter().flat_map(|r| &r.rank_histogram) {
            // Lie derivatives that were not taken may raise it
            let is_least = !own && branch.may_be_raised(*rank);
            *total.entry((*rank, is_least)).or_insert(0u64) += count;
        }
    }
    let text = |(rank, is_least): &(usize, bool)| match is_least {
        true => format!("at least {rank}"),
        false => rank.to_string(),
    };
    match total.len() {
        0 => "-".to_owned(),
        1 => total.keys().map(text).collect(),
        _ => total
            .iter()
            .rev()
            .map(|(rank, count)| format!("{} at {count}", text(rank)))
            .collect::<Vec<_>>()
            .join(", "),
    }
}

/// The ranks, reductions and printed numbers of one file, as lines.
fn file_text(file: &FileFindings, out: &mut String) {
    let system = &file.system;
    if !(file.ranks.is_empty() && file.printed.is_empty() && file.left_out.is_empty()) {
        let _ = writeln!(out, "{}: {}", shown(&system.name), system.title);
    }
    if !file.ranks.is_empty() {
        let own = file.ranks.iter().filter_map(|rank| rank.found.as_ref().ok());
        let has_own = own.flat_map(|answer| &answer.branches).any(|branch| branch.rows.is_some());
        let heading = if has_own { "the file's rows" } else { "" };
        let line = format!("  {:<48} {:>16} {heading:>16}", "rank on", "full");
        let _ = writeln!(out, "{}", line.trim_end());
        let first = file.ranks.iter().find_map(|rank| rank.found.as_ref().ok());
        for line in first.map(taken_for_granted).unwrap_or_default() {
            let _ = writeln!(out, "  {line}");
        }
        for rank in &file.ranks {
            let (full, own) = match rank.answer() {
                _ if rank.is_pole() => ("a singularity".to_owned(), "-".to_owned()),
                Ok(answer) => (ranks_in_words(answer, false), ranks_in_words(answer, true)),
                Err(why) => (format!("not decided: {why}"), String::new()),
            };
            let own = if has_own { own } else { String::new() };
            let unexpected = if rank.as_expected() { "" } else { "   not as expected" };
            let line = format!("  {:<48} {full:>16} {own:>16}{unexpected}", rank.name());
            let _ = writeln!(out, "{}", line.trim_end());
        }
    }
    for found in &file.reductions {
        let proved = found.claims.iter().filter(|outcome| outcome.ok).count();
        let _ = writeln!(
            out,
            "  is {} where {}: {proved} of {} statements proved",
            found.reduction.alias.text,
            found.reduction.written.join(", "),
            found.claims.len()
        );
        for outcome in found.claims.iter().filter(|outcome| !outcome.ok) {
            let _ = writeln!(out, "    {}: {}", outcome.verdict.word(), outcome.statement);
        }
        if let Ok(c) = &found.comparison {
            let ratio = c.large_seconds / c.small_seconds;
            let faster =
                if ratio.is_nan() { String::new() } else { format!("{ratio:.1} times faster a state, ") };
            let _ = writeln!(
                out,
                "  {} states instead of {}: {faster}entries equal to {:.0e}",
                c.small_states,
                c.large_states,
                c.largest_difference.max(f64::EPSILON)
            );
        }
    }
    for printed in &file.printed {
        if let Some(expanded) = &printed.expanded {
            let _ =
                writeln!(out, "  {} has {} monomials when multiplied out", printed.text, expanded.monomials);
        }
        for value in &printed.values {
            let why = match &value.study {
                Ok(study) => format!(
                    "its error {:+.1e} lies {} what {} digits do ({:.1e} to {:.1e})",
                    value.error,
                    if study.contains(value.error) { "inside" } else { "outside" },
                    study.digits,
                    study.errors.first().copied().unwrap_or(0.0),
                    study.errors.last().copied().unwrap_or(0.0)
                ),
                Err(why) => format!("whether rounding explains it is not known: {why}"),
            };
            let _ = writeln!(
                out,
                "  printed {:<12} true {}  {} digits agree; {why}",
                value.printed, &value.certified.decimal, value.digits_that_agree,
            );
        }
        for outcome in file.outcomes.iter().filter(|outcome| outcome.pole_of.as_ref() == Some(&printed.text))
        {
            let _ = writeln!(out, "  {}: {}", outcome.word(), outcome.statement);
        }
    }
    for left in &file.left_out {
        let _ = writeln!(out, "  not done: {}: {}", left.what, left.why);
    }
    for left in &file.too_large {
        let _ = writeln!(out, "  bounded: {}: {}", left.what, left.why);
    }
}

/// Everything for the terminal: what does not hold, the errata, and a line for the rest.
pub fn findings_text(found: &Findings) -> String {
    let mut out = String::new();
    let numbering = &found.paper.numbering;
    let notable = found.outcomes().filter(|outcome| !outcome.ok || outcome.printed.is_some());
    for outcome in numbering.in_order(notable) {
        let _ = writeln!(out, "{}", claim_line(outcome));
    }
    for file in &found.files {
        file_text(file, &mut out);
    }
    for fault in Flaw::ALL {
        let found = errors(numbering, found.outcomes(), fault);
        let ids: Vec<&str> = found.independent.iter().map(|outcome| outcome.id.as_str()).collect();
        if !(ids.is_empty() && found.following.is_empty()) {
            let _ = writeln!(out, "{}; independent: {}", found.text(fault.word()), ids.join(", "));
        }
    }
    let failed = found.outcomes().filter(|outcome| !outcome.ok).count();
    let (claims, counts) = (counted(found.outcomes().count(), "claim"), counts_text(found.outcomes()));
    let colon = if counts.is_empty() { "" } else { ": " };
    let _ = write!(out, "{claims}{colon}{counts}; {failed} not as expected");
    // a paper whose claims all are may end with status 1
    match found.others_not_as_expected() {
        0 => out.push('\n'),
        others => {
            let _ = writeln!(out, ", and {} besides the claims", counted(others, "result"));
        }
    }
    if numbering.count() > 0 {
        let equations = numbering.equations(found.outcomes());
        let without = equations.iter().filter(|equation| equation.entries.is_empty()).count();
        let equations = counted(equations.len(), "numbered equation");
        let _ = writeln!(out, "{equations}, {without} of them without an entry");
    }
    if found.interrupted {
        let _ = writeln!(out, "interrupted: this is what was done until then");
    }
    match found.seconds.is_nan() {
        true => out.truncate(out.trim_end().len()),
        false => _ = write!(out, "{:.1} s", found.seconds),
    }
    out
}
