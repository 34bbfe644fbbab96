//! The page of a paper, put together from its parts: one file, with its pictures and nothing from elsewhere.

use super::anchors::{Anchors, TheoremAddresses, placed, stem};
use super::claims::{all_claims, claims_of, equations, faults, tally};
use super::entry::{ENGINES, name};
use super::extremes::{extremes, extremes_heading};
use super::regime::{file_section, has_a_section};
use super::source::sources;
use crate::axis::unit_of;
use crate::document::document;
use crate::joint::{JointObserved, joint_section};
use crate::layout::counted;
use crate::motion::answers::Observed;
use crate::motion::section::observed_section;
use crate::slow_observed::SlowObserved;
use crate::slow_section::slow_section;
use crate::space::SpaceObserved;
use crate::space_page::space_section;
use maud::{Markup, html};
use palmistry_prove::claim::Outcome;
use palmistry_workbench::paper::Findings;

/// The names of the sections, which nothing else on the page may have.
const SECTIONS: [&str; 15] = [
    "equations",
    "errata",
    "extremes",
    "observers",
    "slow",
    "space",
    "experiments",
    "claims",
    "sources",
    "filter",
    "list",
    "word",
    "file",
    "text",
    "sort",
];

/// The page as HTML.
pub fn page(found: &Findings) -> String {
    page_with(found, &TheoremAddresses::new())
}

/// The page, on which claims lead to their theorems.
pub fn page_with(found: &Findings, theorems: &TheoremAddresses) -> String {
    let names: Vec<String> = (0..found.files.len()).map(|place| format!("file{place}")).collect();
    let engines: Vec<String> = (0..ENGINES).map(name).collect();
    let reserved: Vec<&str> = SECTIONS
        .into_iter()
        .chain(["shown"])
        .chain(names.iter().chain(&engines).map(String::as_str))
        .collect();
    let (anchors, claims) = (Anchors::new(&found.files, &reserved, theorems), placed(&found.files));
    let numbering = &found.paper.numbering;
    let experiments: Vec<Observed<'_>> =
        found.experiments.iter().map(|(experiment, answers)| Observed::of(experiment, answers)).collect();
    let slow: Vec<SlowObserved<'_>> =
        found.slow.iter().map(|(experiment, answers)| SlowObserved::of(experiment, answers)).collect();
    let space: Vec<SpaceObserved<'_>> =
        found.space.iter().map(|(experiment, answers)| SpaceObserved::of(experiment, answers)).collect();
    let joint: Vec<JointObserved<'_>> =
        found.joint.iter().map(|(experiments, answer)| JointObserved::of(experiments, answer)).collect();
    let files: Vec<&str> = found.files.iter().map(|file| stem(&file.system.name)).collect();
    let systems: Vec<_> = found.files.iter().map(|file| &file.system).collect();
    let sections = || found.files.iter().zip(&names).filter(|(file, _)| has_a_section(file));
    let has_faults = claims.iter().any(|claim| claim.outcome.fault.is_some());
    let content = html! {
        (header(found, html! {
            @if numbering.count() > 0 { a href="#equations" { "All equations" } }
            @if has_faults { a href="#errata" { "What does not hold" } }
            @for (file, name) in sections() { a href=(format!("#{name}")) { (file.system.title) } }
            @if let Some(heading) = extremes_heading(found) { a href="#extremes" { (heading) } }
            @if !experiments.is_empty() { a href="#observers" { "Bodies in motion" } }
            @if !slow.is_empty() { a href="#slow" { "Bodies at rest" } }
            @if !space.is_empty() { a href="#space" { "Bodies in space" } }
            @if !joint.is_empty() { a href="#experiments" { "Experiments" } }
            @if !claims.is_empty() { a href="#claims" { "All claims" } }
            a href="#sources" { "The proof files" }
        }))
        main {
            @if numbering.count() > 0 { (equations(numbering, &claims, &anchors)) }
            (faults(numbering, &claims, &anchors))
            @for (file, name) in sections() {
                @let place = found.files.iter().position(|one| std::ptr::eq(one, file)).unwrap_or(0);
                (file_section(name, file, &claims_of(place, &claims, &anchors), &|name| unit_of(&file.system, name)))
            }
            @if let Some(heading) = extremes_heading(found) { (extremes(found, heading)) }
            @if !experiments.is_empty() { (observed_section(&experiments)) }
            @if !slow.is_empty() { (slow_section(&slow)) }
            @if !space.is_empty() { (space_section(&space)) }
            @if !joint.is_empty() { (joint_section(&joint)) }
            @if !claims.is_empty() { (all_claims(&claims, &anchors, &files)) }
            (sources(&systems, &anchors))
        }
    };
    let title = match found.paper.title.as_str() {
        "" => "What holds, and what does not".to_owned(),
        title => format!("{title}: what holds, and what does not"),
    };
    document(&title, &content, true)
}

fn header(found: &Findings, links: Markup) -> Markup {
    let outcomes: Vec<&Outcome> = found.outcomes().collect();
    html! {
        header {
            h1 { @if found.paper.title.is_empty() { "What holds, and what does not" } @else { (found.paper.title) } }
            @let authors = found.paper.authors.join(", ");
            @if !authors.is_empty() || found.paper.year.is_some() || found.paper.source.is_some() {
                p.lead {
                    (authors)
                    @if let Some(year) = found.paper.year { " (" (year) ")" }
                    @if let Some(source) = &found.paper.source { @if !authors.is_empty() || found.paper.year.is_some() { ". " } (source) }
                    "."
                }
            }
            p { "Checked by palmistry from first principles: what holds, and what does not." }
            (tally(&outcomes))
            @match found.others_not_as_expected() {
                0 => {}
                others => p { b.bad { (counted(others, "result")) " besides the claims" } @if others == 1 { " is" } @else { " are" } " not as expected, marked below." }
            }
            @if !outcomes.is_empty() {
            @if outcomes.iter().all(|outcome| outcome.ok && outcome.fault.is_none()) { p { "No errata." } }
            details {
                summary { "what stands behind each verdict" }
                p {
                    b { "Proved" } " is exact arithmetic with the probability of an error stated, " b { "refuted" }
                    " a state in exact numbers at which the two sides differ, " b { "erratum" }
                    " a printed form refuted and its corrected form proved. " b { "Holds by definition" }
                    ": the two sides are one expression once names are put in, so that there is nothing to prove."
                }
            }
            }
            p.y {
                "Seed " (found.seed)
                @if !found.seconds.is_nan() { ", " (format!("{:.0} s", found.seconds)) " in all" }
                "."
            }
            @if found.interrupted { p.bad { "This run was interrupted; it shows what was done until then." } }
            nav { (links) }
        }
    }
}
