//! The page of a fit of several experiments.

use super::plot::{MOST_PICTURES, compared, ends, profile, residuals};
use super::{JointObserved, direction_words, ending, entries, heading, short, weak, with_deviation};
use crate::document::document;
use maud::{Markup, PreEscaped, html};
use palmistry_fit::SimulatedExperiments;
use std::collections::BTreeSet;

fn parameters(observed: &JointObserved<'_>) -> Markup {
    let all = entries(observed);
    let has_profiles = all.iter().any(|entry| entry.profile.is_some());
    html! {
        @if all.is_empty() { p { "No search was made, or none came to an end." } }
        @else {
            div.scroll { table {
                thead { tr {
                    th { "parameter" } th { "value" } th { "deviation" } th { "scale" } th { "bounds" } th { "nominal" } th { "by the measurements" }
                    @if has_profiles { th { "95 % by the profile" } }
                } }
                tbody { @for entry in &all { tr {
                    td { (entry.parameter.name) }
                    td.n { (short(entry.value())) }
                    td.n { (with_deviation(entry)) }
                    td { (entry.parameter.scale.word()) }
                    td.n { (short(entry.parameter.bounds[0])) " to " (short(entry.parameter.bounds[1])) }
                    td.n { (entry.parameter.nominal.map_or(String::new(), short)) }
                    td {
                        (entry.standing.word())
                        @if !entry.others.is_empty() { ": also " (entry.others.iter().take(4).map(|value| short(*value)).collect::<Vec<_>>().join(", ")) }
                    }
                    @if has_profiles { td.n { @if let Some([low, high]) = entry.interval_words() { (low) " to " (high) } } }
                } } }
            } }
        }
        @let weak = weak(observed);
        @if !weak.is_empty() {
            h3 { "Directions that the measurements hardly determine" }
            p { "Unit steps along these, on the scales of the parameters (a decade, where it is log10), change little of what is expected: the deviation along each is the first number." }
            ul { @for one in weak { li {
                (if one.deviation.is_finite() { short(one.deviation) } else { "infinite".to_owned() }) ": " code { (direction_words(observed, &one.parts)) }
            } } }
        }
    }
}

fn pictures(observed: &JointObserved<'_>, simulated: &SimulatedExperiments) -> Markup {
    let problem = observed.experiments.problem();
    let timed = problem.measurements.iter().filter(|one| one.time.is_finite());
    let pairs: BTreeSet<(usize, &str)> = timed.map(|one| (one.experiment, one.output.as_str())).collect();
    html! {
        p { "Points: what was measured, with two deviations of its error. Lines: what is expected at those times." }
        div.two { @for (experiment, output) in pairs.iter().take(MOST_PICTURES) {
            (PreEscaped(compared(observed, simulated, *experiment, output)))
        } }
        @if pairs.len() > MOST_PICTURES { p { "The other " (pairs.len() - MOST_PICTURES) " are in the JSON." } }
    }
}

/// What is shown as expected, and at which parameters.
fn shown<'a>(observed: &JointObserved<'a>) -> Option<(&'a SimulatedExperiments, &'static str)> {
    match (&observed.answer.fit, &observed.answer.nominal) {
        (Some(Ok(fit)), _) => Some((&fit.simulated, "Measured and expected, at the best parameters")),
        (_, Some(own)) => {
            own.simulated.as_ref().ok().map(|own| (own, "Measured and expected, at the nominal values"))
        }
        _ => None,
    }
}

/// Scenes of several experiments, as a section of the page of a paper.
pub(crate) fn joint_section(all: &[JointObserved<'_>]) -> Markup {
    html! {
        section #experiments {
            h2 { "Experiments fitted together" }
            p {
                "Each scene has experiments with conditions of their own and one set of parameters. "
                code { "palmistry observe" } " writes a page of its own for each, with searches and residuals."
            }
            @for observed in all {
                h3 { (observed.experiments.scene.title) }
                p { (heading(observed)) "." }
                ul { @for line in ending(observed) { li { (line) } } }
                (parameters(observed))
                @if let Some((simulated, _)) = shown(observed) { (pictures(observed, simulated)) }
            }
        }
    }
}

/// The page as HTML.
pub fn joint_page(observed: &JointObserved<'_>) -> String {
    let answer = observed.answer;
    let content = html! {
        header {
            h1 { (observed.experiments.scene.title) }
            p { (heading(observed)) "." }
            @if observed.interrupted { p.bad { "This run was interrupted; it shows what was done until then." } }
        }
        main {
            section #answer {
                h2 { "What was found" }
                ul { @for line in ending(observed) { li { (line) } } }
            }
            section #parameters { h2 { "Parameters" } (parameters(observed)) }
            @if let Some((simulated, title)) = shown(observed) {
                section #compared { h2 { (title) } (pictures(observed, simulated)) }
            }
            @if let Some(Ok(fit)) = &answer.fit {
                @let objectives = fit.searches.iter().map(|one| one.objective).collect::<Vec<_>>();
                section #searches {
                    h2 { "Searches and residuals" }
                    p { "Each point on the left is a search from a start of its own; blue ones came to the best end." }
                    div.two { (PreEscaped(ends(&objectives))) (PreEscaped(residuals(observed, &fit.simulated))) }
                }
            }
            @if !answer.profiles.is_empty() {
                section #profiles {
                    h2 { "Profile likelihoods" }
                    p { "A parameter is held at each place and all others are fitted anew. Below the line lie 95 %." }
                    div.two { @for own in answer.profiles.iter().take(MOST_PICTURES) {
                        @let parameter = &observed.experiments.problem().parameters[own.parameter];
                        (PreEscaped(profile(&parameter.name, parameter.scale, own)))
                    } }
                }
            }
        }
    };
    document(&observed.experiments.scene.title, &content, false)
}
