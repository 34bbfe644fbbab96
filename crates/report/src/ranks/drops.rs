//! Where a rank drops, as JSON and as text.

use crate::claims::outcomes::error_bound;
use crate::layout::{counted, counted_in, in_columns};
use crate::names::{by_default_text, ranges_json};
use palmistry_prove::drops::{BoxShare, DropAnswer, DropSet, UsedMinor};
use serde_json::{Value, json};
use std::fmt::Write;

/// Longer formulas are not printed in a text: they are counted.
const LONGEST: usize = 400;

pub(super) fn set_json(set: &DropSet) -> Value {
    let state = set.state.as_ref().map(|state| {
        let named = |at: &palmistry_rank::observability::NamedCoordinate| {
            (at.name.clone(), json!({ "exact": at.exact, "value": at.value }))
        };
        state.iter().map(named).collect::<serde_json::Map<String, Value>>()
    });
    json!({
        "equations": set.equations,
        "unless": set.unless,
        "rank": set.rank,
        "exactly": set.exactly,
        "exists": set.exists,
        "open": set.open,
        "error_bound": if set.open.is_none() { json!(error_bound(set.log2_error)) } else { Value::Null },
        "state": state,
    })
}

fn minor_json(minor: &UsedMinor) -> Value {
    json!({
        "equations": minor.equations,
        "rows": minor.rows,
        "columns": minor.columns,
        "factors": minor.factors.iter().map(|(factor, power)| json!([factor, power])).collect::<Vec<_>>(),
    })
}

fn box_json(share: &Result<BoxShare, String>) -> Value {
    match share {
        Ok(share) => json!({
            "proved_fraction": share.proved,
            "boxes": share.boxes,
            "sides": ranges_json(&share.sides),
            "drawn_by_default": ranges_json(&share.by_default),
        }),
        Err(why) => json!({ "not_done": why }),
    }
}

/// The answer as one JSON object.
pub fn drops_json(answer: &DropAnswer) -> Value {
    json!({
        "file": answer.file,
        "title": answer.title,
        "dimension": answer.dimension,
        "rank": answer.rank,
        "final": answer.is_final,
        "exact": answer.is_exact(),
        "initial": answer.initial,
        "domain": answer.domain,
        "sets": answer.sets.iter().map(set_json).collect::<Vec<_>>(),
        "open": answer.open.iter().map(set_json).collect::<Vec<_>>(),
        "minors": answer.minors.iter().map(minor_json).collect::<Vec<_>>(),
        "cases": answer.cases.0,
        "empty": answer.cases.1,
        "out_of_reach": answer.out_of_reach,
        "interrupted": answer.interrupted,
        "on_the_box": answer.on_the_box.as_ref().map(box_json),
        "seconds": answer.seconds,
    })
}

/// A formula, or how long it is: one that is cut off would be another one.
fn short(text: &str) -> String {
    match text.chars().count() {
        length if length > LONGEST => format!("[a formula of {length} characters: --json has it]"),
        _ => text.to_owned(),
    }
}

fn place(equations: &[String], unless: &[String]) -> String {
    let all: Vec<String> = equations.iter().chain(unless).map(|text| short(text)).collect();
    if all.is_empty() { "at all states".to_owned() } else { format!("where {}", all.join(", ")) }
}

/// The answer as text.
pub fn drops_text(answer: &DropAnswer) -> String {
    let mut out = String::new();
    let DropAnswer { title, file, rank, dimension, .. } = answer;
    let _ = writeln!(out, "{title} ({file})");
    let _ = writeln!(
        out,
        "{}",
        match answer.is_final {
            true => format!("generic rank {rank} of {dimension}"),
            false => format!(
                "rank {rank} of {dimension} is asked for; whether it is the generic rank is not decided"
            ),
        }
    );
    if !answer.initial.is_empty() {
        let _ = writeln!(out, "of those that are asked for, where {}", answer.initial.join(", "));
    }
    if !answer.domain.is_empty() {
        let _ = writeln!(out, "all Lie derivatives exist where {}", answer.domain.join(", "));
    }
    for set in &answer.sets {
        let most = if set.exactly { "" } else { "at most " };
        let _ = write!(out, "rank {most}{} {}", set.rank, place(&set.equations, &set.unless));
        match error_bound(set.log2_error).as_str() {
            "0" => out.push_str(" (certain)"),
            bound => {
                let _ = write!(out, " (error probability below {bound})");
            }
        }
        out.push('\n');
        if let Some(state) = &set.state {
            let named: Vec<String> = state.iter().map(|at| format!("{} = {}", at.name, at.exact)).collect();
            let _ = writeln!(out, "  for example at {}", named.join(", "));
        } else if !set.exists {
            let _ = writeln!(out, "  no state of it was found, and there may be none");
        }
    }
    for set in &answer.open {
        let why = set.open.as_deref().unwrap_or_default();
        let _ = writeln!(out, "undecided {}: {why}", place(&set.equations, &set.unless));
    }
    match (&answer.out_of_reach, answer.is_exact()) {
        (Some(why), _) if !answer.sets.is_empty() => {
            let _ = writeln!(out, "these sets may not be all: {why}");
        }
        (Some(why), _) => {
            let _ = writeln!(out, "the singular set was not found: {why}");
        }
        (None, true) if answer.sets.is_empty() => {
            let _ = writeln!(
                out,
                "the singular set is empty: proved, by minors as products of factors that do not vanish"
            );
        }
        (None, true) => {
            let _ = writeln!(
                out,
                "and nowhere else: proved, by minors as products of factors that do not vanish there"
            );
        }
        (None, false) => {
            let _ = writeln!(out, "off these sets the rank is no lower: proved");
        }
    }
    match &answer.on_the_box {
        Some(Ok(share)) => {
            let _ = writeln!(
                out,
                "on {} % of the sample box the rank is {rank}: proved, by interval certificates ({})",
                share.percent(),
                counted_in(share.boxes, "box", "boxes")
            );
            if !share.by_default.is_empty() {
                let _ = writeln!(out, "  {}", by_default_text(&share.by_default));
            }
        }
        Some(Err(why)) => {
            let _ = writeln!(out, "interval certificates prove nothing on the sample box: {why}");
        }
        None => {}
    }
    for minor in &answer.minors {
        let factor = |(factor, power): &(String, i64)| match power {
            1 => format!("({})", short(factor)),
            _ => format!("({})^{power}", short(factor)),
        };
        let factors: Vec<String> = minor.factors.iter().map(factor).collect();
        let product = if factors.is_empty() { "a number".to_owned() } else { factors.join(" ") };
        let _ = writeln!(out, "minor {}: of {}", place(&minor.equations, &[]), minor.rows.join(", "));
        let _ = writeln!(out, "  {product}");
    }
    // cut off before its first case it has none to count, and no time where none is to be told
    let counted = match answer.cases {
        (0, _) => None,
        (cases, empty) => Some(format!("{}, {empty} of them empty", counted(cases, "case"))),
    };
    let time = answer.seconds.is_finite().then(|| format!("{:.1} s", answer.seconds));
    let last: Vec<String> = counted.into_iter().chain(time).collect();
    if !last.is_empty() {
        let _ = writeln!(out, "{}", last.join(", "));
    }
    in_columns(&out)
}
