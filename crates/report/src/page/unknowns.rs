//! What is observable generically, on the page: a sentence, and a table of the unknowns.

use super::entry::raised;
use super::inline::{conditions, in_line, numbers_first};
use crate::ranks::generic::{generic_sentence, unknown_verdict};
use maud::{Markup, html};
use palmistry_lang::Looks;
use palmistry_rank::observability::Observability;
use palmistry_rank::sweep::BranchAnswer;
use palmistry_workbench::paper::SetRank;

/// Of the first rank of a file, which is that at all states.
pub(super) fn unknowns(ranks: &[SetRank], looks: &Looks) -> Markup {
    let answer = ranks.iter().find_map(|rank| rank.answer().ok());
    html! {
        @for branch in answer.iter().flat_map(|answer| &answer.branches) { (of_branch(branch, looks)) }
    }
}

/// A sentence whose powers of two, bounds on probabilities, are set above the line.
fn powers_raised(sentence: &str) -> String {
    let word = |word: &str| if word.starts_with("2^-") { raised(word) } else { word.to_owned() };
    sentence.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

fn of_branch(branch: &BranchAnswer, looks: &Looks) -> Markup {
    let sentence = generic_sentence(&branch.generic);
    let mut letters = sentence.chars();
    let written: Vec<String> = branch.conditions.iter().map(|one| numbers_first(one)).collect();
    let first = letters.next().map(|letter| letter.to_uppercase().to_string()).unwrap_or_default();
    html! {
        p {
            (first) (powers_raised(letters.as_str()))
            @if !branch.conditions.is_empty() { ", where " (conditions(&written, looks)) }
            "."
        }
        // where everything is observable the sentence says so of each
        @if branch.generic.rank() != Some(branch.generic.dimension) {
            table {
                thead { tr { th { "unknown" } th { "is a" } th { "and is" } } }
                tbody {
                    @for ((name, kind), (_, seen)) in branch.unknowns.iter().zip(&branch.generic.unknowns) {
                        tr {
                            td { (in_line(name, looks)) }
                            td { (kind.name()) }
                            td.bad[*seen == Observability::No] { (unknown_verdict(*kind, *seen)) }
                        }
                    }
                }
            }
        }
    }
}
