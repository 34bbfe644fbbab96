//! The errata as a text that a code host shows: for each the equation as printed, as it should be, and a state in exact
//! numbers with both values.

use super::claims::{error_bound, explanations, special_text, with_decimal};
use crate::claim::{Outcome, Verdict, Witness};
use crate::verification::{Equation, equations, in_order_of_the_thesis};
use std::fmt::Write;

/// The errata, the scanning faults, and a table of all numbered equations, in Markdown.
pub fn errata_markdown(outcomes: &[Outcome]) -> String {
    let mut out = String::from(
        "# Errata to M. Moll, *Shape Reconstruction Using Active Tactile Sensors* (2002)\n\n\
         Written by `palmistry verify`; every statement below is checked each time it runs. A printed form is refuted by a \
         state in exact numbers at which its two sides differ; the corrected form is proved. What may be the doing of the \
         scanner, and not of the author, is said where it is so.\n\n",
    );
    let of_kind = |word: &'static str| {
        in_order_of_the_thesis(outcomes.iter().filter(move |outcome| outcome.word() == word))
    };
    for outcome in of_kind("erratum") {
        erratum(outcome, &mut out);
    }
    let _ =
        writeln!(out, "# Scanning faults\n\nThe formula is right once the damage of the scan is repaired.\n");
    for outcome in of_kind("scanning fault") {
        let _ = writeln!(out, "## {}\n", outcome.id);
        let _ = writeln!(
            out,
            "Scanned:\n\n{}\nRepaired, and proved:\n",
            block(outcome.scanned.as_deref().unwrap_or(""))
        );
        let _ = writeln!(out, "{}", block(&outcome.statement));
        definitions(outcome, &mut out);
        if let Some(remark) = &outcome.remark {
            let _ = writeln!(out, "{remark}\n");
        }
    }
    table(&equations(outcomes), &mut out);
    out
}

fn block(code: &str) -> String {
    format!("```\n{code}\n```\n")
}

fn erratum(outcome: &Outcome, out: &mut String) {
    let Some((printed, refutation)) = &outcome.printed else { return };
    let _ = writeln!(out, "## {}\n", outcome.id);
    let _ = writeln!(out, "Printed:\n\n{}", block(printed));
    let _ = writeln!(out, "Corrected:\n\n{}", block(&outcome.statement));
    definitions(outcome, out);
    if let Verdict::Refuted { witness, .. } = refutation {
        let _ = writeln!(out, "{}\n", in_words(witness));
    }
    if let Some(special) = &outcome.printed_at_files_values {
        let _ = writeln!(out, "Of the printed form: {}.\n", special_text(special));
    }
    if let Verdict::Proved { log2_error, .. } = &outcome.verdict {
        let certainty = match *log2_error {
            f64::NEG_INFINITY => "The corrected form is proved.".to_owned(),
            bound => format!(
                "The corrected form is proved; the probability that the proof errs is below {}.",
                error_bound(bound)
            ),
        };
        let _ = writeln!(out, "{certainty}\n");
    }
    if let Some(special) = &outcome.at_files_values {
        let _ = writeln!(out, "Of the corrected form: {}.\n", special_text(special));
    }
    if let Some(remark) = &outcome.remark {
        let _ = writeln!(out, "{remark}\n");
    }
}

/// What the abbreviations of a statement mean.
fn definitions(outcome: &Outcome, out: &mut String) {
    let lines = explanations(outcome);
    if !lines.is_empty() {
        let _ = writeln!(out, "where\n\n{}", block(&lines.join("\n")));
    }
}

fn in_words(witness: &Witness) -> String {
    let state: Vec<String> =
        witness.state.iter().map(|(name, exact, _)| format!("{name}: {exact}")).collect();
    let side = match witness.entry {
        None => "left side of the printed form".to_owned(),
        Some((row, column)) => {
            format!("entry in row {row}, column {column} of the left side of the printed form")
        }
    };
    let place =
        if state.is_empty() { format!("The {side}") } else { format!("At {} the {side}", state.join("; ")) };
    format!(
        "{place} is `{}`, of the right side `{}`.",
        with_decimal(&witness.left),
        with_decimal(&witness.right)
    )
}

fn table(all: &[Equation<'_>], out: &mut String) {
    let _ = writeln!(out, "# All numbered equations\n");
    let words = ["proved", "erratum", "scanning fault", "definition", "undecided", "refuted", "no entry"];
    let counts: Vec<String> = words
        .iter()
        .map(|word| (all.iter().filter(|equation| equation.word() == *word).count(), word))
        .filter(|(count, _)| *count > 0)
        .map(|(count, word)| format!("{count} {word}"))
        .collect();
    let _ = writeln!(
        out,
        "{} equations: {}.\n\n| equation | verdict | entries |\n|---|---|---|",
        all.len(),
        counts.join(", ")
    );
    for equation in all {
        let entries: Vec<String> = equation
            .entries
            .iter()
            .map(|outcome| match outcome.word() {
                word if word == equation.word() => outcome.id.clone(),
                word => format!("{} ({word})", outcome.id),
            })
            .collect();
        let reasons: Vec<&str> = equation
            .entries
            .iter()
            .filter_map(|outcome| match &outcome.verdict {
                Verdict::Undecided { why } => Some(why.as_str()),
                _ => None,
            })
            .collect();
        let mut last = entries.join(", ");
        if !reasons.is_empty() {
            last = format!("{last}: {}", reasons.join("; ").replace('|', "/"));
        }
        let _ = writeln!(out, "| {} | {} | {last} |", equation.number, equation.word());
    }
}
