//! All claims as a list that can be sorted and filtered, the map of numbered equations, and the faults of the text by kinds.

use super::anchors::{Anchors, Placed};
use super::entry::{Engines, entry};
use crate::claims::verdicts::{RULE_OF_DAMAGE, counts, errors, meaning};
use maud::{Markup, html};
use palmistry_lang::Flaw;
use palmistry_prove::claim::Outcome;
use palmistry_workbench::paper::Numbering;

/// How many claims have each verdict; the numbers add up to all of them.
pub(super) fn tally(outcomes: &[&Outcome]) -> Markup {
    let failed = outcomes.iter().filter(|outcome| !outcome.ok).count();
    html! {
        @if outcomes.is_empty() { p { "Nothing is claimed here; what follows is what was found of the system." } }
        @else {
        p { b { (outcomes.len()) } @if outcomes.len() == 1 { " claim" } @else { " claims" } @if failed > 0 { ", " b.bad { (failed) " not as expected" } } @else { ", all as expected" } ":" }
        ul.tally {
            @for (word, count) in counts(outcomes.iter().copied()) {
                li data-w=(word) title=(meaning(word)) { b { (count) } " " span.v { (word) } }
            }
        }
        }
    }
}

/// The claims of one file as cells: name, sign and colour of the verdict, and a way to the entry.
pub(super) fn claims_of(file: usize, claims: &[Placed<'_>], anchors: &Anchors) -> Markup {
    let own: Vec<&Placed<'_>> = claims.iter().filter(|claim| claim.file == file).collect();
    html! {
        @if !own.is_empty() {
            h3 { "What is claimed" }
            div.cells.wide {
                @for claim in own {
                    a data-w=(claim.outcome.word()) class=[(!claim.outcome.ok).then_some("bad")] href=(format!("#{}", anchors.claim(claim.file, &claim.outcome.id))) { (breakable(&claim.outcome.id)) }
                }
            }
        }
    }
}

/// An id that may be broken behind its dots and underscores, where a cell has no room for it on one line.
fn breakable(id: &str) -> Markup {
    html! { @for part in id.split_inclusive(['.', '_', '-', ':']) { (part) @if part.ends_with(['.', '_', '-', ':']) { wbr; } } }
}

/// One cell for each numbered equation: its number, the sign and colour of its verdict, and a way to its first entry.
pub(super) fn equations(numbering: &Numbering, claims: &[Placed<'_>], anchors: &Anchors) -> Markup {
    let all = numbering.equations(claims.iter().map(|claim| claim.outcome));
    let mut words: Vec<&str> = all.iter().map(|equation| equation.word()).collect();
    words.sort_unstable();
    words.dedup();
    let place = |outcome: &Outcome| claims.iter().find(|claim| std::ptr::eq(claim.outcome, outcome));
    html! {
        section #equations {
            h2 { "All numbered equations" }
            p.legend {
                @for word in words {
                    span.cell data-w=(word) { (word) ": " (all.iter().filter(|e| e.word() == word).count()) } " "
                }
            }
            div.cells {
                @for equation in &all {
                    @let ids = equation.entries.iter().map(|o| o.id.as_str()).collect::<Vec<_>>().join(", ");
                    // the entry that gives the equation its verdict, or the first one
                    @let first = equation.entries.iter().find(|o| o.word() == equation.word()).or(equation.entries.first());
                    @match first.and_then(|outcome| place(outcome)) {
                        Some(claim) => {
                            a data-w=(equation.word()) href=(format!("#{}", anchors.claim(claim.file, &claim.outcome.id))) title=[(equation.entries.len() > 1).then_some(ids)] {
                                (equation.number)
                            }
                        }
                        None => { span data-w="no entry" { (equation.number) } }
                    }
                }
            }
        }
    }
}

/// What does not hold as it stands in the text, by kinds, each with a way to its entry.
pub(super) fn faults(numbering: &Numbering, claims: &[Placed<'_>], anchors: &Anchors) -> Markup {
    let outcomes = || claims.iter().map(|claim| claim.outcome);
    let of_kind =
        |fault: Flaw| numbering.in_order(outcomes().filter(move |outcome| outcome.fault == Some(fault)));
    let place = |outcome: &Outcome| claims.iter().find(|claim| std::ptr::eq(claim.outcome, outcome));
    html! {
        @if Flaw::ALL.into_iter().any(|fault| !of_kind(fault).is_empty()) {
            section #errata {
                h2 { "What does not hold as it stands" }
                p { "Each printed form below is refuted at a state that a pocket calculator can check, wherever it can be stated; the corrected form is proved." }
                @for fault in Flaw::ALL {
                    @let found = of_kind(fault);
                    @if !found.is_empty() {
                        @let errors = errors(numbering, outcomes(), fault);
                        @let (count, following) = (errors.counts(fault.word()), errors.consequences());
                        h3 data-w=(fault.word()) { span.v { (count) } }
                        p { (meaning(fault.word())) "." @if !following.is_empty() { " Consequential: " (following) "." } }
                        p.links {
                            @for claim in found.into_iter().filter_map(place) {
                                a href=(format!("#{}", anchors.claim(claim.file, &claim.outcome.id))) { (claim.outcome.id) } " "
                            }
                        }
                    }
                }
                details { summary { "how it is decided whether the author, the print or the scan is at fault" } p { (RULE_OF_DAMAGE.replace('*', "")) } }
            }
        }
    }
}

/// The list of all claims, under the names of their files. What filters it is shown by the script alone.
pub(super) fn all_claims(claims: &[Placed<'_>], anchors: &Anchors, files: &[&str]) -> Markup {
    let words = counts(claims.iter().map(|claim| claim.outcome));
    let engines = Engines::new(claims);
    html! {
        section #claims {
            h2 { "All claims" }
            form #filter hidden {
                label { "verdict " select #word {
                    option value="" { "all" }
                    @for (word, count) in &words { option value=(word) { (word) " (" (count) ")" } }
                    option value="!" { "not as expected" }
                } }
                label { "file " select #file {
                    option value="" { "all" }
                    @for (place, name) in files.iter().enumerate() {
                        @let count = claims.iter().filter(|claim| claim.file == place).count();
                        @if count > 0 { option value=(place) { (name) " (" (count) ")" } }
                    }
                } }
                label { "containing " input #text type="search" autocomplete="off"; }
                label { "sorted by " select #sort {
                    option value="" { "file" } option value="w" { "verdict" } option value="i" { "name" }
                } }
                output #shown for="word file text sort" {}
            }
            (engines.legend())
            div #list {
                @for (place, name) in files.iter().enumerate() {
                    @let of_file: &[_] = &claims.iter().filter(|claim| claim.file == place).collect::<Vec<_>>();
                    @if !of_file.is_empty() {
                        h3 data-f=(place) { a href=(format!("#{}", anchors.file(place))) { (name) } }
                        @for claim in of_file { (entry(**claim, anchors, &engines)) }
                    }
                }
            }
        }
    }
}
