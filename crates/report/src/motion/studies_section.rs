//! What the studies of a scene came to, as a part of a page.

use crate::axis::unit_of;
use crate::motion::answers::{Observed, noise_unit};
use crate::motion::studies::compared;
use crate::motion::study_plot;
use maud::{Markup, PreEscaped, html};
use palmistry_scenes::{ARRIVED, CurvatureMap};

fn curvature(map: &CurvatureMap) -> Markup {
    html! {
        h3 { "Between palms of other curvatures" }
        figure {
            (PreEscaped(study_plot::curvature(map)))
            figcaption {
                "The larger bound of Cramér and Rao of both support radii in the first window, over that between flat palms: " (compared(map)) ". "
                "Below one these palms determine more than flat ones. Curvatures above zero are those of hollow palms."
            }
        }
    }
}

/// The error over noise, and the basins of attraction.
pub(super) fn studies(observed: &Observed<'_>) -> Markup {
    let places = 0..observed.experiment.names().len();
    html! {
        @if !observed.studied.noise.is_empty() {
            h3 { "The error over noise" }
            figure {
                div.grid { @for place in places { (PreEscaped(study_plot::noise(observed, place))) } }
                figcaption {
                    "The first window by least squares, over many seeds: the root of the mean square error of those that converged, and "
                    "the bound at the truth, both in decades. Dots on the line: nothing more is to be had from these measurements. Dots "
                    "above it: the search did not find the best state. By chance they are off by a part of about one in the root of twice "
                    "the number of seeds. "
                    @for level in &observed.studied.noise {
                        (format!("{:.0e}{}: {} of {} converged. ", level.noise, noise_unit(observed), level.converged, level.seeds))
                    }
                }
            }
            (noise_table(observed))
        }
        @if !observed.studied.basins.is_empty() {
            h3 { "From where they arrive" }
            figure {
                div.basins { @for basin in &observed.studied.basins { (PreEscaped(study_plot::basin(observed, basin))) } }
                figcaption {
                    "First guesses of two states, the others as in the scene, from which each method comes within "
                    (format!("{:.0}%", 100.0 * ARRIVED)) " of all that is estimated: after the first window for methods that work by "
                    "windows, at the last sample for the others. The cross is the truth. Where the measurements have errors, and the bound "
                    "of a state is near that part of it, they decide as well."
                }
            }
        }
        @if let Some(map) = &observed.studied.curvature { (curvature(map)) }
    }
}

/// The error over noise beside its Cramér-Rao bound.
fn noise_table(observed: &Observed<'_>) -> Markup {
    let unit = noise_unit(observed);
    let names = observed.experiment.names();
    html! {
        div.scroll { table {
            thead { tr {
                th { "noise" @if !unit.is_empty() { "," (unit) } } th { "converged" }
                @for name in &names { th { (name) ", rms error" } th { "bound" @if let Some(unit) = unit_of(&observed.experiment.system, name) { ", " (unit) } } th { "ratio" } }
            } }
            tbody { @for level in &observed.studied.noise { tr {
                td.n { (format!("{:.1e}", level.noise)) }
                td.n { (level.converged) " of " (level.seeds) }
                @for (error, bound) in level.errors.iter().zip(&level.bounds) {
                    td.n { (format!("{error:.2e}")) }
                    td.n { @if bound.is_finite() { (format!("{bound:.2e}")) } @else { "unobservable" } }
                    td.n { @if bound.is_finite() && *bound > 0.0 { (format!("{:.2}", error / bound)) } @else { "-" } }
                }
            } } }
        } }
    }
}
