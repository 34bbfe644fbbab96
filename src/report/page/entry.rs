//! One claim as an entry of the page: its formula, its verdict, what stands behind it, and where it stands in its file.

use super::anchors::{Anchors, Placed};
use crate::claim::{Outcome, Verdict};
use crate::report::claims::outcomes::{error_bound, explanations, special_text, witness_line};
use crate::report::formula::formula_mathml;
use crate::report::ranks::answer::fields_text;
use crate::system::{Basis, Flaw};
use maud::{Markup, PreEscaped, html};

/// An entry with its anchor; `name` is that of its file.
pub(super) fn entry(claim: Placed<'_>, anchors: &Anchors, name: &str) -> Markup {
    let Placed { file, outcome } = claim;
    let anchor = anchors.claim(file, &outcome.id);
    html! {
        article #(anchor) data-w=(outcome.word()) data-f=(file) class=[(!outcome.ok).then_some("bad")] {
            h4 {
                a href=(format!("#{anchor}")) { (outcome.id) } " " b.v { (outcome.word()) } " "
                @if !outcome.ok { b { "expected: " (outcome.expected_word()) } " " }
                @if let Some(line) = anchors.line(file, &outcome.id) {
                    a.s href=(format!("#{}", anchors.line_name(file, line))) { (name) ":" (line) }
                }
            }
            @match outcome.fault {
                Some(fault) => (faulty(outcome, fault)),
                None => {
                    @if !matches!(outcome.verdict, Verdict::Definition { .. }) || formula_mathml(&outcome.statement).is_some() {
                        (formula(&outcome.statement))
                    }
                    p.y { (explain(&outcome.verdict)) (restated(outcome)) }
                }
            }
            @if let Some(special) = &outcome.at_files_values { p.y { (special_text(special)) } }
            @if !outcome.fields.is_empty() { p.y { "fields: " (fields_text(&outcome.fields)) } }
            @if let Some(from) = &outcome.follows { p.y { "follows " (from) } }
            @if let Some(remark) = &outcome.remark { p.r { (remark) } }
        }
    }
}

/// A form in the text that does not hold, and the right one.
fn faulty(outcome: &Outcome, fault: Flaw) -> Markup {
    let [_, before, between] = fault.keywords();
    let lines = explanations(outcome);
    html! {
        @if let Some(quoted) = &outcome.quoted { p.q { span.l { (before) } q { (quoted) } } }
        @if let Some((statement, verdict)) = &outcome.printed {
            div.q { span.l { @if outcome.quoted.is_some() { "as" } @else { (before) } } (formula(statement)) }
            p.y { b { (verdict.word()) } " " (explain(verdict)) }
            @if let Some(special) = &outcome.printed_at_files_values { p.y { (special_text(special)) } }
        }
        div.c { span.l { (between) } (formula(&outcome.statement)) }
        p.y { b { (outcome.verdict.word()) } " " (explain(&outcome.verdict)) }
        @if !lines.is_empty() {
            details { summary { "what the names mean" } @for line in lines { code { (line) } } }
        }
    }
}

/// A statement as mathematics; as it is written where it is none.
pub(super) fn formula(text: &str) -> Markup {
    html! {
        @match formula_mathml(text) {
            Some(formula) => { div.f { (PreEscaped(formula)) } }
            None => { div.f { code { (text) } } }
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

/// What stands behind a verdict.
pub(super) fn explain(verdict: &Verdict) -> Markup {
    html! {
        @match verdict {
            Verdict::Proved { engine, log2_error } => {
                (engine)
                @if *log2_error == f64::NEG_INFINITY { "; certain" }
                @else { "; probability of an error below " (error_bound(*log2_error)) }
            }
            Verdict::Refuted { witness, .. } => { (witness_line(witness)) }
            Verdict::Definition { text } => { (text) }
            Verdict::Undecided { why } => { (why) }
        }
    }
}
