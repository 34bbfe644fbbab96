//! The main job's findings as JSON and as lines for the terminal.

use crate::report::certificate::answer::region_json;
use crate::report::claims::outcomes::{claim_json, claim_line};
use crate::report::claims::words::{counts, counts_text, errors};
use crate::report::motion::answers::{Observed, observe_json};
use crate::report::ranks::answer::rank_json;
use crate::report::stress::answer::stress_json;
use crate::report::trade::answer::trade_json;
use crate::sweep::RankAnswer;
use crate::system::Flaw;
use crate::tradeoff::{Map, Rows, Slope};
use crate::verification::{
    DETERMINANT, PrintedValue, RegimeResult, Verification, equations, in_order_of_the_thesis,
};
use serde_json::{Value, json};
use std::fmt::Write;

/// What a plot needs of a number, so that the file stays small.
fn four_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

fn map_json(kind: Rows, map: &Map) -> Value {
    json!({
        "rows": if kind == Rows::Own { "own" } else { "full" },
        "x": { "name": map.x.0, "low": map.x.1, "high": map.x.2, "cells": map.width },
        "y": { "name": map.y.0, "low": map.y.1, "high": map.y.2, "cells": map.height },
        "smallest_singular_value": map.smallest.iter().map(|v| v.map(four_digits)).collect::<Vec<_>>(),
    })
}

fn line_json(title: &str, slope: &Slope) -> Value {
    let short = |values: &[f64]| values.iter().copied().map(four_digits).collect::<Vec<_>>();
    json!({
        "into": title,
        "distance": short(&slope.distance),
        "singular_values": slope.values.iter().map(|values| short(values)).collect::<Vec<_>>(),
    })
}

fn regime_json(result: &RegimeResult) -> Value {
    json!({
        "file": result.regime.file,
        "title": result.title,
        "left_out": result.regime.left_out,
        "ranks": result.ranks.iter().map(|(set, found)| {
            let mut object = match found {
                Ok(answer) => rank_json(answer),
                Err(pole) => json!({ "pole": pole }),
            };
            object["set"] = json!(set.title);
            object["conditions"] = json!(set.conditions);
            object
        }).collect::<Vec<_>>(),
        "maps": result.maps.iter().map(|(kind, map)| map_json(*kind, map)).collect::<Vec<_>>(),
        "lines": result.lines.iter().map(|(title, slope)| line_json(title, slope)).collect::<Vec<_>>(),
        "smallest_model": result.comparison.as_ref().map(|c| json!({
            "states": c.small_states,
            "operations": c.small_operations,
            "operations_of_the_ten_state_model": c.large_operations,
            "largest_relative_difference": c.largest_difference,
            "seconds_a_state": c.small_seconds,
            "ten_state_seconds_a_state": c.large_seconds,
            "seconds_ratio": c.large_seconds / c.small_seconds,
        })),
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
        "rounding": {
            "digits": value.study.digits,
            "monomials": value.study.monomials,
            "orders": value.study.errors.len(),
            "least_error": value.study.errors.first(),
            "greatest_error": value.study.errors.last(),
            "root_mean_square_error": value.study.deviation(),
            "largest_monomial_over_sum": value.study.cancellation,
            "printed_error_is_inside": value.study.contains(value.error),
        },
    })
}

/// Everything as one object.
pub fn verification_json(found: &Verification) -> Value {
    json!({
        "ok": found.ok(),
        "interrupted": found.interrupted,
        "seed": found.seed,
        "claims": found.outcomes.iter().map(claim_json).collect::<Vec<_>>(),
        "words": counts(&found.outcomes).into_iter().collect::<std::collections::BTreeMap<_, _>>(),
        "errata": found.outcomes.iter().filter(|o| o.word() == "erratum").map(|o| &o.id).collect::<Vec<_>>(),
        "independent_errata":
            errors(&found.outcomes, Flaw::Erratum).independent.iter().map(|o| &o.id).collect::<Vec<_>>(),
        "equations": equations(&found.outcomes).iter().map(|equation| json!({
            "number": equation.number,
            "verdict": equation.word(),
            "entries": equation.entries.iter().map(|outcome| &outcome.id).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "regimes": found.regimes.iter().map(regime_json).collect::<Vec<_>>(),
        "appendix": found.appendix.as_ref().map(|a| json!({
            "monomials": a.monomials,
            "front": a.front,
            "denominator": a.denominator,
            "values": a.values.iter().map(printed_value_json).collect::<Vec<_>>(),
        })),
        "lie_derivatives": {
            "routes": found.routes.iter().map(|r| json!({
                "order": r.order,
                "states": r.states,
                "largest_relative_difference": r.largest_difference,
            })).collect::<Vec<_>>(),
            "growth": found.growth.iter().map(|g| json!({
                "order": g.order, "operations": g.operations, "seconds": g.seconds,
            })).collect::<Vec<_>>(),
        },
        "trade": found.trade.as_ref().map(trade_json),
        "stress": stress_json(&found.stress, found.seed),
        "certificates": found.regions.iter().map(region_json).collect::<Vec<_>>(),
        "experiments": found.experiments.iter().map(|(experiment, answers)| {
            observe_json(&Observed::of(experiment, answers))
        }).collect::<Vec<_>>(),
        "seconds": found.seconds,
    })
}

/// `6 at 200 states; 5 at 3`, over all branches.
pub(crate) fn ranks_in_words(answer: &RankAnswer, own: bool) -> String {
    let mut total = std::collections::BTreeMap::new();
    for branch in &answer.branches {
        let report = if own { branch.rows.as_ref() } else { Some(&branch.full) };
        for (rank, count) in report.into_iter().flat_map(|r| &r.rank_histogram) {
            *total.entry(*rank).or_insert(0u64) += count;
        }
    }
    match total.len() {
        0 => "-".to_owned(),
        1 => total.keys().map(usize::to_string).collect(),
        _ => total
            .iter()
            .rev()
            .map(|(rank, count)| format!("{rank} at {count}"))
            .collect::<Vec<_>>()
            .join(", "),
    }
}

/// Everything that a reader of the terminal wants to see: what does not hold, the errata, and a line for the rest.
pub fn verification_text(found: &Verification) -> String {
    let mut out = String::new();
    let notable = found.outcomes.iter().filter(|outcome| !outcome.ok || outcome.printed.is_some());
    for outcome in in_order_of_the_thesis(notable) {
        let _ = writeln!(out, "{}", claim_line(outcome));
    }
    for result in &found.regimes {
        let _ = writeln!(out, "{}", result.title);
        let _ = writeln!(out, "  {:<48} {:>16} {:>16}", "rank on", "full", "thesis's rows");
        for (set, found) in &result.ranks {
            let (full, own) = match found {
                Ok(answer) => (ranks_in_words(answer, false), ranks_in_words(answer, true)),
                Err(_) => ("a pole".to_owned(), "a pole".to_owned()),
            };
            let _ = writeln!(out, "  {:<48} {full:>16} {own:>16}", set.title);
        }
        if let Some(c) = &result.comparison {
            let _ = writeln!(
                out,
                "  {} states instead of {}: {:.1} times faster a state, entries equal to {:.0e}",
                c.small_states,
                c.large_states,
                c.large_seconds / c.small_seconds,
                c.largest_difference.max(f64::EPSILON)
            );
        }
    }
    if let Some(appendix) = &found.appendix {
        let _ = writeln!(
            out,
            "Appendix A.2: the determinant has {} monomials when multiplied out",
            appendix.monomials
        );
        for value in &appendix.values {
            let place = if value.study.contains(value.error) { "inside" } else { "outside" };
            let _ = writeln!(
                out,
                "  printed {:<12} true {}  {} digits agree; its error {:+.1e} lies {place} what ten digits do ({:.1e} to {:.1e})",
                value.printed,
                &value.certified.decimal,
                value.digits_that_agree,
                value.error,
                value.study.errors.first().copied().unwrap_or(0.0),
                value.study.errors.last().copied().unwrap_or(0.0),
            );
        }
    }
    for outcome in found.outcomes.iter().filter(|outcome| outcome.pole_of.as_deref() == Some(DETERMINANT)) {
        let _ = writeln!(out, "  {}: {}", outcome.word(), outcome.statement);
    }
    for fault in Flaw::ALL {
        let found = errors(&found.outcomes, fault);
        let ids: Vec<&str> = found.independent.iter().map(|outcome| outcome.id.as_str()).collect();
        if !(ids.is_empty() && found.following.is_empty()) {
            let _ = writeln!(out, "{}; on their own: {}", found.text(fault.word()), ids.join(", "));
        }
    }
    let failed = found.outcomes.iter().filter(|outcome| !outcome.ok).count();
    let (claims, counts) = (found.outcomes.len(), counts_text(&found.outcomes));
    let _ = writeln!(out, "{claims} claims: {counts}, {failed} not as expected");
    if found.interrupted {
        let _ = writeln!(out, "interrupted: this is what was done until then");
    }
    let _ = write!(out, "{:.1} s", found.seconds);
    out
}
