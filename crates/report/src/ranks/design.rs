//! What to measure or to know besides, as JSON and as text.

use super::generic::unknown_verdict;
use crate::claims::outcomes::error_bound;
use crate::layout::{counted, in_columns};
use crate::names::{values_json, values_text};
use palmistry_io::foreign::shown;
use palmistry_lang::UnknownKind;
use palmistry_rank::design::{Addition, Design, DesignAnswer, DesignTarget};
use palmistry_rank::observability::Solutions;
use serde_json::{Value, json};
use std::fmt::Write;

/// The kind of an addition, and of what.
fn parts(addition: &Addition) -> (&'static str, Option<&str>) {
    match addition {
        Addition::Output(text) => ("output", Some(text)),
        Addition::Known(name) => ("known", Some(name)),
        Addition::Initial(name) => ("initial", Some(name)),
        Addition::Input(name) => ("input", Some(name)),
        Addition::Experiment => ("experiment", None),
    }
}

/// As a person would ask for it.
fn words(addition: &Addition) -> String {
    match addition {
        Addition::Output(text) => format!("measure {text}"),
        Addition::Known(name) => format!("know {name}"),
        Addition::Initial(name) => format!("know {name} initially"),
        Addition::Input(name) => format!("a known input into {name}'"),
        Addition::Experiment => "one more experiment".to_owned(),
    }
}

/// Several experiments more are one thing to say.
fn set_in_words(additions: &[Addition]) -> String {
    let experiments = additions.iter().filter(|one| **one == Addition::Experiment).count();
    let others = additions.iter().filter(|one| **one != Addition::Experiment).map(words);
    let last = match experiments {
        0 => None,
        1 => Some(words(&Addition::Experiment)),
        more => Some(format!("{more} more experiments")),
    };
    others.chain(last).collect::<Vec<_>>().join("; ")
}

/// What is known of a target as things stand.
fn now(target: &DesignTarget) -> String {
    let local = unknown_verdict(target.kind, target.observability);
    let globally = if target.kind == UnknownKind::Parameter { "identifiable" } else { "observable" };
    match &target.solutions {
        Some(Solutions::Finite(1)) => format!("globally {globally}"),
        Some(Solutions::Finite(count)) => format!("{local}, {count} solutions"),
        Some(Solutions::Undecided(why)) => format!("{local}, globally undecided: {why}"),
        Some(Solutions::Infinite) | None => local.to_owned(),
    }
}

fn target_json(target: &DesignTarget) -> Value {
    let solutions = match &target.solutions {
        Some(Solutions::Finite(count)) => json!(count),
        Some(Solutions::Infinite) => json!("infinity"),
        Some(Solutions::Undecided(_)) | None => Value::Null,
    };
    json!({
        "name": target.name,
        "kind": target.kind.name(),
        "local": unknown_verdict(target.kind, target.observability),
        "values": solutions,
    })
}

fn set_json(design: &Design) -> Value {
    let addition = |addition: &Addition| {
        let (kind, what) = parts(addition);
        json!({ "kind": kind, "what": what })
    };
    json!({
        "additions": design.additions.iter().map(addition).collect::<Vec<_>>(),
        "verdict": if design.log2_error.is_some() { "proved" } else { "computed" },
        "error_bound": design.log2_error.map(error_bound),
    })
}

/// An answer as one object.
pub fn design_json(answer: &DesignAnswer) -> Value {
    let left_out = |(addition, why): &(Addition, String)| {
        let (kind, what) = parts(addition);
        json!({ "kind": kind, "what": what, "why": why })
    };
    json!({
        "file": answer.file,
        "title": answer.title,
        "globally": answer.globally,
        "fixed_at_the_files_values": values_json(&answer.held),
        "identify": answer.targets.iter().map(target_json).collect::<Vec<_>>(),
        "is_met": answer.is_met,
        "candidates": answer.candidates,
        "designs": answer.designs.iter().map(set_json).collect::<Vec<_>>(),
        "contradicted": answer.contradicted,
        "looked_at": answer.looked_at,
        "final": answer.open.is_none(),
        "why": answer.open,
        "left_out": answer.left_out.iter().map(left_out).collect::<Vec<_>>(),
    })
}

/// An answer as text.
pub fn design_text(answer: &DesignAnswer) -> String {
    let mut out = format!("{}: {}\n", shown(&answer.file), answer.title);
    let how = if answer.globally { "globally (one value)" } else { "locally (finitely many values)" };
    if !answer.held.is_empty() {
        let _ = writeln!(out, "with {}", values_text(&answer.held));
    }
    let _ = writeln!(out, "to be identified {how}:");
    let width = answer.targets.iter().map(|target| target.name.chars().count()).max().unwrap_or(0);
    for target in &answer.targets {
        let _ = writeln!(out, "  {:<width$}  {}", target.name, now(target));
    }
    if answer.is_met {
        out.push_str("nothing needs to be added");
        return in_columns(&out);
    }
    let mut last = 0;
    let texts: Vec<String> = answer.designs.iter().map(|design| set_in_words(&design.additions)).collect();
    let width =
        texts.iter().map(|text| text.chars().count()).filter(|width| *width <= WIDEST).max().unwrap_or(0);
    for (design, text) in answer.designs.iter().zip(&texts) {
        let size = design.additions.len();
        if size != last {
            let count = answer.designs.iter().filter(|other| other.additions.len() == size).count();
            let sets = counted(count, "minimal set");
            let _ = writeln!(out, "{sets} of {}:", counted(size, "addition"));
            last = size;
        }
        let proof = match design.log2_error {
            Some(f64::NEG_INFINITY) => "proved, certain".to_owned(),
            Some(log2_error) => format!("proved, error probability below {}", error_bound(log2_error)),
            None => "computed".to_owned(),
        };
        let _ = writeln!(out, "  {text:<width$}  {proved}", proved = proof);
    }
    let all = counted(answer.candidates, "single addition");
    let up_to = counted(answer.looked_at, "addition");
    match (&answer.open, answer.designs.is_empty()) {
        (Some(why), _) => {
            let _ = writeln!(out, "{all}; sets of up to {up_to} were looked at, and not all is known: {why}");
        }
        (None, true) if answer.candidates == 0 => {
            out.push_str("there is nothing that can be added\n");
        }
        (None, true) => {
            let _ = writeln!(
                out,
                "{all}; no set of up to {up_to} of these suffices; --at-most looks for larger ones"
            );
        }
        (None, false) => {
            let _ = writeln!(out, "{all}; all sets of up to {up_to} were looked at");
        }
    }
    if answer.contradicted > 0 {
        let sets = counted(answer.contradicted, "set");
        let _ = writeln!(out, "{sets} sufficed at a random point alone and, decided anew, do not");
    }
    for (addition, why) in &answer.left_out {
        let _ = writeln!(out, "left out: {}: {}", words(addition), shown(why));
    }
    in_columns(out.trim_end())
}

/// Longer sets do not widen the column of sets.
const WIDEST: usize = 48;
