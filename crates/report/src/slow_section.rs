//! Scenes of slow motion as a part of the page of a paper.

use crate::slow::{jumps_in_words, ways_table};
use crate::slow_observed::SlowObserved;
use crate::slow_plot::{frames, off_truth};
use maud::{Markup, PreEscaped, html};

/// Samples at which it is shown what was touched.
const FRAMES: usize = 4;

/// Samples whose contacts are drawn, and points of a curve.
const DOTS: usize = 20;
const POINTS: usize = 30;

/// Slow scenes, as a section of the page.
pub(super) fn slow_section(all: &[SlowObserved<'_>]) -> Markup {
    html! {
        section #slow {
            h2 { "Bodies at rest between slow palms" }
            p {
                "A body lies where its centre of mass is lowest, and is led by palms that move slowly. Its shape is recovered from the contacts alone: nothing is known at the start. "
                code { "palmistry observe" } " writes such a page for any scene."
            }
            @for observed in all { (one(observed)) }
        }
    }
}

fn one(observed: &SlowObserved<'_>) -> Markup {
    let (experiment, answers) = (observed.experiment, observed.answers);
    html! {
        h3 { (experiment.scene.title) }
        p {
            b { (experiment.measurements.rows()) " samples" }
            @if let Some(truth) = &experiment.truth {
                "; the motion " (truth.trajectory.ended) ", with " (truth.trajectory.jumps.len()) " jumps"
            }
            ". The measurements " b class=[(!answers.explained).then_some("bad")] { @if answers.explained { "are" } @else { "are not" } " explained" } "."
            @if !answers.jumps.is_empty() { " Jumps found in them, and where descent in the recovered potential leads: " (jumps_in_words(answers)) "." }
        }
        (ways_table(observed))
        figure {
            div.frames { (PreEscaped(frames(observed, FRAMES, DOTS))) }
            figcaption { "What was touched after so many samples, as it was found: the body about its centre of mass, with the palms' lines." }
        }
        figure { div.two { (PreEscaped(off_truth(observed, POINTS))) } }
    }
}
