//! The errata as a text that a code host shows: for each the equation as printed, as it should be, and a state in exact
//! numbers with both values.

use crate::claims::outcomes::{error_bound, explanations, special_text, with_decimal};
use crate::claims::verdicts::{meaning, numbered, verdicts_markdown};
use crate::formula::statement_latex_in;
use palmistry_io::foreign::{code_block, code_span, markdown};
use palmistry_lang::{Basis, Flaw};
use palmistry_prove::claim::{Outcome, Verdict, Witness};
use palmistry_workbench::paper::{NumberedEquation, Paper};
use std::fmt::Write;

/// What is the matter with forms in the text, by kinds, and a table of all numbered equations, in Markdown.
pub fn errata_markdown<'o>(paper: &Paper, outcomes: impl IntoIterator<Item = &'o Outcome>) -> String {
    let outcomes: Vec<&Outcome> = outcomes.into_iter().collect();
    let mut out = format!(
        "# Errata to {}\n\n\
         Written by `palmistry verify`; every statement below is checked each time it runs. Each printed form is refuted \
         at a state in exact numbers, at which its two sides differ, wherever it can be stated; the corrected form is proved.\n\n",
        reference(paper),
    );
    verdicts_markdown(&paper.numbering, &outcomes, &mut out);
    words_of_sentences(&outcomes, &mut out);
    for fault in Flaw::ALL {
        let of_kind = outcomes.iter().copied().filter(|outcome| outcome.fault == Some(fault) && outcome.ok);
        let of_kind = paper.numbering.in_order(of_kind);
        if of_kind.is_empty() {
            continue;
        }
        let _ = writeln!(
            out,
            "# {}\n\n{}.{}\n",
            heading(fault),
            capitalised(meaning(fault.word())),
            effect(fault)
        );
        for outcome in of_kind {
            entry(outcome, fault, &mut out);
        }
    }
    undecided(paper, &outcomes, &mut out);
    let equations = paper.numbering.equations(outcomes);
    if !equations.is_empty() {
        table(&equations, &mut out);
    }
    out
}

/// The words with which an entry about a sentence begins, and what they mean.
const WORDS_OF_SENTENCES: [(&str, &str); 2] = [
    ("Overstated", "what is said is too strong or too general, and a weaker form of it holds"),
    (
        "False as stated",
        "a counterexample is shown; *true where*, or *true of*, says under which condition it holds",
    ),
];

/// With which of these words a remark begins.
fn word_of_sentence(remark: &str) -> Option<&'static str> {
    WORDS_OF_SENTENCES.into_iter().map(|(word, _)| word).find(|word| remark.starts_with(word))
}

/// What the words mean with which entries about sentences begin, and how many have each.
fn words_of_sentences(outcomes: &[&Outcome], out: &mut String) {
    let with = |word: &str| {
        let remarks = outcomes.iter().filter(|outcome| outcome.ok && outcome.fault.is_some());
        remarks.filter(|outcome| outcome.remark.as_deref().and_then(word_of_sentence) == Some(word)).count()
    };
    let counts: Vec<(usize, &str, &str)> =
        WORDS_OF_SENTENCES.into_iter().map(|(word, means)| (with(word), word, means)).collect();
    if counts.iter().all(|(count, _, _)| *count == 0) {
        return;
    }
    let _ = writeln!(out, "Entries about sentences begin with a word of their own:\n");
    for (count, word, means) in counts {
        let _ = writeln!(out, "- *{word}* ({count}): {means}.");
    }
    out.push('\n');
}

/// Whether damage changes what the paper concludes.
fn effect(fault: Flaw) -> &'static str {
    match fault {
        Flaw::PrintOrScan | Flaw::Scan => {
            " No conclusion of the paper changes, unless an entry says so: what comes before and after has the right form."
        }
        Flaw::Erratum | Flaw::Convention | Flaw::Loose => "",
    }
}

/// The statements that are neither proved nor refuted, each with the reason.
fn undecided(paper: &Paper, outcomes: &[&Outcome], out: &mut String) {
    let open = outcomes.iter().copied().filter(|outcome| outcome.ok && outcome.word() == "undecided");
    let open = paper.numbering.in_order(open);
    if open.is_empty() {
        return;
    }
    let _ = writeln!(
        out,
        "# Undecided\n\nStatements of the paper that are neither proved nor refuted, with the reason.\n"
    );
    for outcome in open {
        if let Verdict::Undecided { why } = &outcome.verdict {
            let _ = writeln!(out, "## {}\n\n{}\n", markdown(&outcome.id), markdown(why));
        }
    }
}

/// Authors, title and year in a line.
fn reference(paper: &Paper) -> String {
    let year = paper.year.map_or(String::new(), |year| format!(" ({year})"));
    let title = match paper.title.trim() {
        "" => String::new(),
        title => format!("*{}*", markdown(title)),
    };
    format!("{}{title}{year}", markdown(&paper.authors_in_words()))
}

fn heading(fault: Flaw) -> &'static str {
    match fault {
        Flaw::Erratum => "Errata",
        Flaw::PrintOrScan => "Print or scan",
        Flaw::Scan => "Scanning faults",
        Flaw::Convention => "Conventions",
        Flaw::Loose => "Loose wording",
    }
}

fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or(String::new(), |first| first.to_uppercase().chain(characters).collect())
}

/// One form that does not hold as the text has it.
fn entry(outcome: &Outcome, fault: Flaw, out: &mut String) {
    let [_, before, between] = fault.keywords();
    let (before, between) = (capitalised(before), capitalised(between));
    let _ = writeln!(out, "## {}\n", markdown(&outcome.id));
    if let Some(passage) = &outcome.passage {
        let _ = writeln!(out, "{}.\n", markdown(&capitalised(passage)));
    }
    if let Some(quoted) = &outcome.quoted {
        let _ = writeln!(out, "{before}:\n\n{}", code_block(quoted));
    }
    if let Some((printed, _)) = &outcome.printed {
        let label = if outcome.quoted.is_some() { "As a statement" } else { before.as_str() };
        let _ = writeln!(out, "{label}:\n\n{}", formula(printed, outcome));
    }
    let _ = writeln!(out, "{between}:\n\n{}", formula(&outcome.statement, outcome));
    definitions(outcome, out);
    if let Some((_, Verdict::Refuted { witness, .. })) = &outcome.printed {
        let _ = writeln!(out, "{}\n", in_words(witness));
    }
    if let Some(special) = &outcome.printed_at_files_values {
        let _ = writeln!(out, "Of the form in the text: {}.\n", markdown(&special_text(special)));
    }
    if let Verdict::Proved { log2_error, .. } = &outcome.verdict {
        let form = match fault {
            Flaw::Erratum => "corrected form",
            Flaw::PrintOrScan | Flaw::Scan => "repaired form",
            Flaw::Convention | Flaw::Loose => "form that is meant",
        };
        let certainty = match *log2_error {
            f64::NEG_INFINITY => format!("The {form} is proved."),
            bound => format!(
                "The {form} is proved; the probability that the proof errs is below {}.",
                error_bound(bound)
            ),
        };
        let _ = writeln!(out, "{certainty}\n");
    }
    if let Some(special) = &outcome.at_files_values {
        let _ = writeln!(out, "Of the right form: {}.\n", markdown(&special_text(special)));
    }
    if let Some(from) = &outcome.follows {
        let _ = writeln!(out, "Follows {}.\n", markdown(from));
    }
    if let Some(remark) = &outcome.remark {
        let word = word_of_sentence(remark).unwrap_or_default();
        let emphasised = if word.is_empty() { String::new() } else { format!("*{word}*") };
        let _ = writeln!(out, "{emphasised}{}\n", markdown(&remark[word.len()..]));
    }
    if let Some(conclusion) = &outcome.conclusion {
        let _ = writeln!(out, "Conclusion: {}\n", markdown(conclusion));
    }
}

/// A statement as code hosts typeset it, and as it stands in its file, where it is one.
fn formula(text: &str, outcome: &Outcome) -> String {
    let latex = statement_latex_in(text, &outcome.looks).filter(|latex| latex.len() <= LONGEST_FORMULA);
    // there they do not know the command for the name of an operator
    let shown = latex.map(|latex| latex.replace("\\operatorname{", "\\mathrm{"));
    shown.map_or(String::new(), |latex| format!("```math\n{latex}\n```\n\n")) + &code_block(text)
}

/// What is longer is shown as it is written alone.
const LONGEST_FORMULA: usize = 2000;

/// What the abbreviations of a statement mean, but for those that are too long to be written out.
fn definitions(outcome: &Outcome, out: &mut String) {
    let is_long = |line: &String| line.contains("= (an expression of ");
    let (long, lines): (Vec<String>, Vec<String>) = explanations(outcome).into_iter().partition(is_long);
    if !lines.is_empty() {
        let _ = writeln!(out, "where\n\n{}", code_block(&lines.join("\n")));
    }
    if !long.is_empty() {
        let names: Vec<&str> = long.iter().filter_map(|line| line.split(" = ").next()).collect();
        let _ = writeln!(out, "For {} see the proof file.\n", code_span(&names.join(", ")));
    }
}

fn in_words(witness: &Witness) -> String {
    let state: Vec<String> =
        witness.state.iter().map(|at| markdown(&format!("{}: {}", at.name, at.exact))).collect();
    let side = match witness.entry {
        None => "left side of the form in the text".to_owned(),
        Some((row, column)) => {
            format!("entry in row {row}, column {column} of the left side of the form in the text")
        }
    };
    let place =
        if state.is_empty() { format!("The {side}") } else { format!("At {} the {side}", state.join("; ")) };
    format!(
        "{place} is {}, of the right side {}.",
        code_span(&with_decimal(&witness.left)),
        code_span(&with_decimal(&witness.right))
    )
}

fn table(all: &[NumberedEquation<'_>], out: &mut String) {
    let _ = writeln!(out, "# All numbered equations\n");
    let counts: Vec<String> = Outcome::WORDS
        .into_iter()
        .chain(["no entry"])
        .map(|word| (all.iter().filter(|equation| equation.word() == word).count(), word))
        .filter(|(count, _)| *count > 0)
        .map(|(count, word)| numbered(count, word))
        .collect();
    let _ = writeln!(
        out,
        "{} equations: {}.\n\n| equation | verdict | entries |\n|---|---|---|",
        all.len(),
        counts.join(", ")
    );
    for equation in all {
        let entries: Vec<String> =
            equation.entries.iter().map(|outcome| in_the_table(outcome, equation.word())).collect();
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
            last = format!("{last}: {}", markdown(&reasons.join("; ").replace('|', "/")));
        }
        let _ = writeln!(out, "| {} | {} | {last} |", markdown(&equation.number), equation.word());
    }
}

/// An entry beside its equation: with its verdict where that differs from the equation's, with what it restates or follows from.
fn in_the_table(outcome: &Outcome, word: &str) -> String {
    let mut notes = Vec::new();
    if outcome.word() != word {
        notes.push(outcome.word().to_owned());
    }
    if let Basis::Restates(list) = &outcome.basis
        && !list.is_empty()
    {
        let names: Vec<String> = list.iter().map(|reference| reference.text()).collect();
        notes.push(format!("of {}", names.join(", ")));
    }
    if let Some(from) = &outcome.follows {
        notes.push(format!("follows {from}"));
    }
    let id = markdown(&outcome.id);
    if notes.is_empty() { id } else { format!("{id} ({})", markdown(&notes.join(" "))) }
}
