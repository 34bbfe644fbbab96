//! Answers as pieces of HTML for a notebook: one table each, formulas as MathML, and behind it all that the terminal says. A piece has
//! no style of its own but the colour of its verdicts, and asks for nothing from elsewhere.

use super::claims::outcomes::{error_bound, state_line, with_decimal};
use super::formula::formula_mathml;
use super::ranks::generic::{generic_sentence, unknown_verdict};
use super::ranks::rank_text;
use maud::{Markup, PreEscaped, html};
use palmistry_prove::claim::{Outcome, Verdict};
use palmistry_rank::sweep::{BranchAnswer, RankAnswer};

/// Claims with their verdicts, a row each.
pub fn claims_html(outcomes: &[Outcome]) -> String {
    let expected = outcomes.iter().filter(|outcome| outcome.ok).count();
    html! {
        table {
            thead { tr { th { "claim" } th { "verdict" } th { "statement" } th { "what stands behind it" } } }
            tbody {
                @for outcome in outcomes {
                    tr {
                        td { code { (outcome.id) } }
                        td style=(format!("color:{}", colour(outcome))) {
                            b { (outcome.word()) }
                            @if !outcome.ok { br; "expected: " (outcome.expected_word()) }
                        }
                        td style="text-align:left" { (formula(&outcome.statement)) }
                        td style="text-align:left" { (behind(&outcome.verdict)) }
                    }
                }
            }
        }
        p { (outcomes.len()) " claims, " (expected) " as expected" }
    }
    .into_string()
}

/// As expected, or not; what is undecided is neither good nor bad by itself.
fn colour(outcome: &Outcome) -> &'static str {
    match (outcome.ok, &outcome.verdict) {
        (false, _) => "#b00020",
        (true, Verdict::Undecided { .. }) => "#8a6d00",
        (true, _) => "#1b7837",
    }
}

fn formula(text: &str) -> Markup {
    html! {
        @match formula_mathml(text) {
            Some(formula) => (PreEscaped(formula)),
            None => code { (text) },
        }
    }
}

fn behind(verdict: &Verdict) -> Markup {
    html! {
        @match verdict {
            Verdict::Proved { log2_error, .. } if *log2_error == f64::NEG_INFINITY => "certain",
            Verdict::Proved { log2_error, .. } => { "error probability below " (error_bound(*log2_error)) }
            Verdict::Refuted { witness, .. } => {
                "at " code { (state_line(witness)) }
                @if let Some((row, column)) = witness.entry { ", entry " (row) "," (column) }
                ": left " code { (with_decimal(&witness.left)) } ", right " code { (with_decimal(&witness.right)) }
            }
            Verdict::Definition { text } => (text),
            Verdict::Undecided { why } => (why),
        }
    }
}

/// What is observable, unknown by unknown, and the ranks at the states that were examined.
pub fn rank_html(answer: &RankAnswer) -> String {
    html! {
        p { b { (answer.title) } }
        @for branch in &answer.branches { (branch_html(branch)) }
        details { summary { "all that was found" } pre { (rank_text(answer, true)) } }
    }
    .into_string()
}

fn branch_html(branch: &BranchAnswer) -> Markup {
    let full = &branch.full;
    html! {
        @if !branch.conditions.is_empty() { p { "where " code { (branch.conditions.join(", ")) } } }
        p { (generic_sentence(&branch.generic)) }
        table {
            thead { tr { th { "unknown" } th { "kind" } th { "verdict" } } }
            tbody {
                @for ((name, kind), (_, seen)) in branch.unknowns.iter().zip(&branch.generic.unknowns) {
                    tr { td { (formula(name)) } td { (kind.name()) } td { (unknown_verdict(*kind, *seen)) } }
                }
            }
        }
        @if full.samples > 0 {
            table {
                thead { tr { th { "rank" } th { "states" } } }
                tbody {
                    @for (rank, states) in &full.rank_histogram { tr { td { (rank) } td { (states) } } }
                }
            }
            p { "certified at " (full.certified) " of " (full.samples) " states" }
        }
    }
}
