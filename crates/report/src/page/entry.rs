//! One claim as an entry of the page: its formula, its verdict, what stands behind it, and where it stands in its file.

use super::anchors::{Anchors, Placed};
use super::inline::{field_name, in_line};
use crate::claims::outcomes::{error_bound, not_looked_at_text, special_text, with_decimal};
use crate::formula::formula_mathml_in;
use maud::{Markup, PreEscaped, html};
use palmistry_lang::{Basis, Flaw, Looks};
use palmistry_prove::claim::{Outcome, Verdict, Witness};
use palmistry_rank::observability::NamedCoordinate;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// An entry with its anchor.
pub(super) fn entry(claim: Placed<'_>, anchors: &Anchors, engines: &Engines<'_>) -> Markup {
    let Placed { file, outcome } = claim;
    let anchor = anchors.claim(file, &outcome.id);
    // most are proved: that is what an entry without a verdict means
    let word = Some(outcome.word()).filter(|word| *word != "proved");
    html! {
        article #(anchor) data-w=[word] class=[(!outcome.ok).then_some("bad")] {
            h4 {
                (outcome.id) " " b { (outcome.word()) } " "
                @if let Some(passage) = &outcome.passage { (passage) " " }
                @if !outcome.ok { em { "expected: " (outcome.expected_word()) } " " }
                @if let Some(line) = anchors.line(file, &outcome.id) {
                    a href=(format!("#{}", Anchors::line_name(file, line))) { (line) }
                }
                @if let Some(theorem) = anchors.theorem(file, &outcome.id) {
                    " " a href=(theorem) title="as a theorem that Coq checks" { "Coq" }
                }
            }
            @match outcome.fault {
                Some(fault) => (faulty(outcome, fault, engines)),
                None => {
                    @if !matches!(outcome.verdict, Verdict::Definition { .. }) || formula_mathml_in(&outcome.statement, &outcome.looks).is_some() {
                        // the entry itself scrolls: it needs no element of its own
                        (bare_formula(&outcome.statement, &outcome.looks))
                    }
                    p { (engines.explain(&outcome.verdict, &outcome.looks)) (restated(outcome)) }
                }
            }
            @for told in &outcome.beside { p { (told) } }
            @for part in &outcome.not_looked_at { p { (not_looked_at_text(part)) } }
            @if let Some(special) = &outcome.at_files_values { p { (special_text(special)) } }
            @if !outcome.fields.is_empty() { p { "fields: " (fields(outcome)) } }
            @if let Some(from) = &outcome.follows { p { "follows " (from) } }
            @if let Some(remark) = &outcome.remark { p.r { (remark) } }
            @if let Some(conclusion) = &outcome.conclusion { p.r { b { "Conclusion: " } (conclusion) } }
        }
    }
}

/// A form in the text that does not hold, and the right one.
fn faulty(outcome: &Outcome, fault: Flaw, engines: &Engines<'_>) -> Markup {
    let [_, before, between] = fault.keywords();
    html! {
        @if let Some(quoted) = &outcome.quoted { p.q { span.l { (before) } q { (quoted) } } }
        @if let Some((statement, verdict)) = &outcome.printed {
            div.q { span.l { @if outcome.quoted.is_some() { "as" } @else { (before) } } (formula(statement, &outcome.looks)) }
            p { b { (verdict.word()) } " " (engines.explain(verdict, &outcome.looks)) }
            @if let Some(special) = &outcome.printed_at_files_values { p { (special_text(special)) } }
        }
        div.c { span.l { (between) } (formula(&outcome.statement, &outcome.looks)) }
        p { b { (outcome.verdict.word()) } " " (engines.explain(&outcome.verdict, &outcome.looks)) }
    }
}

/// A statement as mathematics; as it is written where it is none.
pub(super) fn formula(text: &str, looks: &Looks) -> Markup {
    html! {
        @match formula_mathml_in(text, looks) {
            Some(formula) => { div { (PreEscaped(formula)) } }
            None => { div { code { (text) } } }
        }
    }
}

fn bare_formula(text: &str, looks: &Looks) -> Markup {
    match formula_mathml_in(text, looks) {
        Some(formula) => html! { (PreEscaped(formula)) },
        None => html! { code { (text) } },
    }
}

/// The fields along which was differentiated, each with what it is.
fn fields(outcome: &Outcome) -> Markup {
    html! {
        @for (place, field) in outcome.fields.iter().enumerate() {
            @if place > 0 { ", " }
            (field.role.name()) " " (field_name(&field.name, &outcome.looks))
        }
    }
}

/// A state at which the two sides differ, and what they are there.
fn witness(found: &Witness, looks: &Looks) -> Markup {
    html! {
        @if !found.state.is_empty() { "at " (state(&found.state, looks)) ": " }
        @if let Some((row, column)) = found.entry { "entry " (row) "," (column) ": " }
        "left = " (with_decimal(&found.left)) ", right = " (with_decimal(&found.right))
    }
}

/// A state, its coordinates as mathematics and its numbers exactly; of an angle by its sine and cosine the nearest decimal as well.
pub(super) fn state(at: &[NamedCoordinate], looks: &Looks) -> Markup {
    html! {
        @for (place, NamedCoordinate { name, exact, value }) in at.iter().enumerate() {
            @if place > 0 { ", " }
            (in_line(name, looks))
            @if exact.contains("sin") { " = " (format!("{value:.6}")) " (" (exact) ")" } @else { " = " (exact) }
        }
    }
}

fn restated(outcome: &Outcome) -> Markup {
    html! {
        @if let Basis::Restates(list) = &outcome.basis && !list.is_empty() {
            "; of " (list.iter().map(|reference| reference.text()).collect::<Vec<_>>().join(", "))
        }
    }
}

/// Names are letters.
pub(super) const ENGINES: usize = 26;

/// What decides claims: a name for each that decides several, so that it need not be said a thousand times.
pub(super) struct Engines<'a>(Vec<&'a str>);

impl<'a> Engines<'a> {
    /// Those of some claims, the most frequent first.
    pub fn new(claims: &[Placed<'a>]) -> Engines<'a> {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for claim in claims {
            if let Verdict::Proved { engine, .. } = &claim.outcome.verdict {
                *counts.entry(engine).or_default() += 1;
            }
        }
        let mut found: Vec<(&str, usize)> = counts.into_iter().filter(|(_, count)| *count > 3).collect();
        found.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        found.truncate(ENGINES);
        Engines(found.into_iter().map(|(engine, _)| engine).collect())
    }

    /// The names and what they stand for.
    pub fn legend(&self) -> Markup {
        html! {
            @if !self.0.is_empty() {
                details open {
                    summary { "How they are decided" }
                    ol type="A" { @for (place, engine) in self.0.iter().enumerate() { li #(name(place)) { (engine) } } }
                }
            }
        }
    }

    fn explain(&self, verdict: &Verdict, looks: &Looks) -> Markup {
        match verdict {
            Verdict::Proved { engine, log2_error } => match self.0.iter().position(|known| known == engine) {
                Some(place) => html! {
                    "by " (name(place)) (certainty(*log2_error))
                },
                None => explain(verdict, looks),
            },
            _ => explain(verdict, looks),
        }
    }
}

/// What an engine is called on the page.
pub(super) fn name(engine: usize) -> String {
    char::from(b'A' + engine as u8).to_string()
}

fn certainty(log2_error: f64) -> Markup {
    html! {
        @if log2_error == f64::NEG_INFINITY { "; certain" }
        @else { "; error probability below " (raised(&error_bound(log2_error))) }
    }
}

/// A power as it is written, its exponent above the line: `2⁻¹⁰¹` for `2^-101`.
pub(super) fn raised(power: &str) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let Some((base, exponent)) = power.split_once('^') else { return power.to_owned() };
    let raise = |c: char| match c.to_digit(10) {
        Some(digit) => DIGITS[digit as usize],
        None if c == '-' => '⁻',
        None => c,
    };
    base.chars().chain(exponent.chars().map(raise)).collect()
}

/// A text that is longer than a page needs has its first part here, and all of it in the terminal.
fn in_short(text: &str) -> Cow<'_, str> {
    const MOST: usize = 160;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{} ... (palmistry prove says it all)", &text[..end]).into(),
        None => text.into(),
    }
}

/// What stands behind a verdict.
pub(super) fn explain(verdict: &Verdict, looks: &Looks) -> Markup {
    html! {
        @match verdict {
            Verdict::Proved { engine, log2_error } => {
                (in_short(engine)) (certainty(*log2_error))
            }
            Verdict::Refuted { witness: found, .. } => { (witness(found, looks)) }
            Verdict::Definition { text } => { (text) }
            Verdict::Undecided { why } => { (why) }
        }
    }
}
