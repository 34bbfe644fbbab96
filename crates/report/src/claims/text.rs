//! Claims as a report on a terminal: a line for what is as expected, and all that is known of what is not.

use crate::claims::outcomes::{
    claim_line, error_bound, not_looked_at_text, special_text, state_line, with_decimal,
};
use crate::claims::verdicts::counts_text;
use crate::formula::statement_latex_in;
use crate::layout::{Layout, Tone, counted};
use palmistry_io::foreign;
use palmistry_lang::Flaw;
use palmistry_prove::claim::{Outcome, Verdict, Witness};

/// Which outcomes are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// All, those that are as expected with a line each.
    All,
    /// Those that are not as expected.
    Unexpected,
}

/// How outcomes are shown.
#[derive(Clone, Copy, Debug)]
pub struct ClaimsForm {
    /// Which claims.
    pub shown: Shown,
    /// Whether each statement is written as LaTeX too.
    pub latex: bool,
}

/// What stands below a report.
#[derive(Clone, Copy, Debug)]
pub struct ClaimsSummary {
    /// How many claims there are, decided or not; none where not all files were read before the run was cut off.
    pub claims: Option<usize>,
    /// How long it took in all.
    pub seconds: f64,
}

/// The columns before a label, and before what stands behind it.
const LABEL: usize = 9;
const TEXT: usize = 20;

/// Outcomes file by file, and a summary that adds up.
pub fn claims_text(
    outcomes: &[Outcome],
    summary: ClaimsSummary,
    form: ClaimsForm,
    layout: &Layout,
) -> String {
    let shown = form.shown;
    let mut lines = Vec::new();
    let mut file = "";
    for outcome in outcomes.iter().filter(|outcome| shown == Shown::All || !outcome.ok) {
        if outcome.file != file && shown == Shown::All {
            file = &outcome.file;
            lines.push(layout.paint(Tone::Strong, &foreign::shown(file)));
        }
        lines.push(claim_text(outcome, layout));
        for told in &outcome.beside {
            lines.push(layout.wrap(&format!("{:LABEL$}", ""), TEXT, told));
        }
        if let Some(formula) =
            form.latex.then(|| statement_latex_in(&outcome.statement, &outcome.looks)).flatten()
        {
            // on one line, however long: it is to be copied
            lines.push(format!("{:LABEL$}{:<10} {formula}", "", "latex"));
        }
    }
    let failed = outcomes.iter().filter(|outcome| !outcome.ok).count();
    let tone = if failed == 0 { Tone::Good } else { Tone::Bad };
    let unexpected = layout.paint(tone, &format!("{failed} not as expected"));
    let counts = counts_text(outcomes);
    let colon = if counts.is_empty() { "" } else { ": " };
    let total = format!(
        "{}{colon}{counts}; {unexpected}, {:.1} s",
        counted(outcomes.len(), "claim"),
        summary.seconds
    );
    lines.push(layout.wrap("", 2, &total));
    match summary.claims {
        Some(claims) if outcomes.len() < claims => {
            lines.push(format!("interrupted: {} not decided", counted(claims - outcomes.len(), "claim")));
        }
        Some(_) => {}
        None => lines.push("interrupted while the files were read".to_owned()),
    }
    lines.join("\n")
}

/// An outcome: a line where it is as expected, with further ones where there is something to explain; otherwise where it
/// stands, the statement as it is written, both sides at the witness, and what was expected.
pub fn claim_text(outcome: &Outcome, layout: &Layout) -> String {
    if !outcome.ok {
        return unexpected(outcome, layout);
    }
    let wrapped = |(number, line): (usize, &str)| match number {
        0 => layout.wrap("", LABEL, line).replacen("ok", &layout.paint(Tone::Good, "ok"), 1),
        _ => {
            let indent = line.len() - line.trim_start().len();
            layout.wrap(&line[..indent], TEXT, &line[indent..])
        }
    };
    claim_line(outcome).lines().enumerate().map(wrapped).collect::<Vec<_>>().join("\n")
}

/// Everything about a claim that has not the verdict that its file expects.
fn unexpected(outcome: &Outcome, layout: &Layout) -> String {
    let (line, column) = outcome.place;
    let head = format!(
        "  {} {:<10} {}  {}:{line}:{column}",
        layout.paint(Tone::Bad, "FAIL"),
        outcome.word(),
        layout.paint(Tone::Strong, &outcome.id),
        foreign::shown(&outcome.file),
    );
    let mut lines = vec![head];
    let mut say = |label: &str, text: &str| {
        lines.push(layout.wrap(&format!("{:LABEL$}{label:<10} ", ""), TEXT, text));
    };
    let [_, before, between] = outcome.fault.unwrap_or(Flaw::Erratum).keywords();
    if let Some(quoted) = &outcome.quoted {
        say(before, quoted);
    }
    if let Some((statement, verdict)) = &outcome.printed {
        say(if outcome.quoted.is_some() { "as" } else { before }, statement);
        details(verdict, &mut say);
        if let Some(special) = &outcome.printed_at_files_values {
            say("", &special_text(special));
        }
    }
    say(if outcome.fault.is_some() { between } else { "claimed" }, &outcome.statement);
    details(&outcome.verdict, &mut say);
    for part in &outcome.not_looked_at {
        say("", &not_looked_at_text(part));
    }
    if let Some(special) = &outcome.at_files_values {
        say("", &special_text(special));
    }
    if let Some(from) = &outcome.follows {
        say("follows", from);
    }
    say("expected", expectation(outcome).as_str());
    lines.join("\n")
}

/// What the file expects, as text.
fn expectation(outcome: &Outcome) -> String {
    match (outcome.fault, &outcome.printed) {
        (Some(fault), printed) => {
            let [_, before, between] = fault.keywords();
            let refuted = if printed.is_some() { format!("'{before}' refuted, ") } else { String::new() };
            format!("{}: {refuted}'{between}' proved", fault.word())
        }
        (None, _) => outcome.expected_word().to_owned(),
    }
}

/// What became of a statement.
fn details(verdict: &Verdict, say: &mut impl FnMut(&str, &str)) {
    match verdict {
        Verdict::Proved { log2_error, .. } if *log2_error == f64::NEG_INFINITY => say("", "proved: certain"),
        Verdict::Proved { log2_error, .. } => {
            say("", &format!("proved, error probability below {}", error_bound(*log2_error)));
        }
        Verdict::Refuted { witness, .. } => sides(witness, say),
        Verdict::Undecided { why } => say("undecided", why),
        Verdict::Definition { text } => say("", text),
    }
}

/// Both sides at a witness.
fn sides(witness: &Witness, say: &mut impl FnMut(&str, &str)) {
    match state_line(witness) {
        state if state.is_empty() => say("refuted", ""),
        state => say("refuted at", &state),
    }
    if let Some((row, column)) = witness.entry {
        say("in entry", &format!("{row},{column}"));
    }
    say("left", &with_decimal(&witness.left));
    say("right", &with_decimal(&witness.right));
}
