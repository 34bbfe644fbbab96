//! What three palms determine of a body in space: a page with a picture of the shape that can be turned, tables, and curves of errors.

use crate::document::document;
use crate::slow_plot::logarithmic;
use crate::solid_picture::{SCRIPT, ShownSurface, turnable_picture};
use crate::space::{SpaceObserved, entries, headline, shape_rows, space_ended};
use crate::space_surfaces::{SurfaceKind, space_surfaces};
use maud::{Markup, PreEscaped, html};

/// Rings of the smooth surfaces that are shown.
const RINGS: usize = 16;

/// More windows than these are in the JSON only.
const MOST_WINDOWS: usize = 60;

fn picture(observed: &SpaceObserved<'_>) -> Markup {
    let surfaces = space_surfaces(observed, RINGS);
    let is_known = surfaces.iter().any(|one| one.kind == SurfaceKind::Body);
    let mut shown = Vec::new();
    for one in &surfaces {
        let colour = match one.kind {
            SurfaceKind::Body => "#9a9a9a",
            // beside the body itself it could not be distinguished
            SurfaceKind::Shape if !is_known => "#9a9a9a",
            SurfaceKind::Hull => "#1f77b4",
            SurfaceKind::HalfSpaces => "#ff7f0e",
            _ => continue,
        };
        shown.push(ShownSurface { name: one.kind.name(), colour, surface: &one.surface });
    }
    html! {
        @if observed.answers.shape.is_none() { p { "There is no shape." } }
        @else {
            (turnable_picture(&observed.experiment.scene.title, &shown))
        }
    }
}

/// Errors over the samples: of the poses, and of the support radii at the contacts.
fn curves(observed: &SpaceObserved<'_>) -> String {
    let errors: Vec<_> =
        observed.answers.updates.iter().flat_map(|update| observed.experiment.errors(update)).collect();
    if errors.is_empty() {
        return String::new();
    }
    let centre = errors.iter().map(|error| error.centre).collect();
    let radius = errors.iter().map(|error| error.radius).collect();
    let turn = errors.iter().map(|error| error.turn).collect();
    let lengths = [("centre of mass", "#0072b2", centre), ("support radius", "#d55e00", radius)];
    logarithmic("errors of the centre of mass and of support radii at contacts", "m", &lengths)
        + &logarithmic(
            "error of the turn since the window's first sample",
            "rad",
            &[("turn", "#009e73", turn)],
        )
}

/// The shape, and the bounds that there are of it.
fn shape(observed: &SpaceObserved<'_>) -> Markup {
    html! {
        (picture(observed))
        table { tbody { @for (what, value) in shape_rows(observed) { tr { th scope="row" { (what) } td { (value) } } } } }
    }
}

/// State, inertia and mass, a table a window.
fn windows(observed: &SpaceObserved<'_>) -> Markup {
    let updates = &observed.answers.updates;
    html! {
        @for update in updates.iter().take(MOST_WINDOWS) {
            p { (headline(observed, update)) }
            @let all = entries(observed, update);
            @if !all.is_empty() {
                div.scroll { table {
                    thead { tr { th { "" } th { "recovered" } th { "true" } th { "error" } th { "bound" } } }
                    tbody { @for entry in &all { tr {
                        td { (entry.name) ", " (entry.unit) }
                        td.n { (format!("{:.8}", entry.recovered)) }
                        td.n { (entry.truth.map_or("-".to_owned(), |truth| format!("{truth:.8}"))) }
                        td.n { (entry.truth.map_or("-".to_owned(), |truth| format!("{:.1e}", (entry.recovered - truth).abs()))) }
                        td.n { (format!("{:.1e}", entry.bound)) }
                    } } }
                } }
            }
        }
        @if updates.len() > MOST_WINDOWS { p { "The other windows are in the JSON." } }
    }
}

/// Scenes in space, as a section of the page of a paper.
pub(super) fn space_section(all: &[SpaceObserved<'_>]) -> Markup {
    html! {
        section #space {
            h2 { "Bodies in space on three palms" }
            p {
                "A smooth convex body is recovered from the contacts with three palms, with nothing known: motion, inertia, mass and shape. "
                code { "palmistry observe" } " writes such a page for any scene."
            }
            @for observed in all {
                h3 { (observed.experiment.scene.title) }
                p {
                    b { (observed.experiment.measurements.times.len()) " samples" } ". "
                    @if let Some(ended) = space_ended(observed) { (ended) ". " }
                }
                (shape(observed))
                (windows(observed))
                @if observed.experiment.truth.is_some() { div.two { (PreEscaped(curves(observed))) } }
            }
            script { (PreEscaped(SCRIPT)) }
        }
    }
}

/// The page as HTML.
pub fn space_page(observed: &SpaceObserved<'_>) -> String {
    let experiment = observed.experiment;
    let content = html! {
        header {
            h1 { (experiment.scene.title) }
            p {
                "A smooth convex body in space on three palms, from their measurements with nothing known; " b { (experiment.measurements.times.len()) " samples" } ". "
                @if experiment.truth.is_none() { "Recorded: what is true is not known. " }
                @if let Some(ended) = space_ended(observed) { (ended) ". " }
            }
            @if observed.interrupted { p.bad { "This run was interrupted; it shows what was done until then." } }
        }
        main {
            section #shape {
                h2 { "The shape that was touched" }
                (shape(observed))
            }
            section #state {
                h2 { "State, inertia and mass" }
                (windows(observed))
            }
            @if experiment.truth.is_some() { section #errors { h2 { "Errors over the samples" } (PreEscaped(curves(observed))) } }
            script { (PreEscaped(SCRIPT)) }
        }
    };
    document(&experiment.scene.title, &content, false)
}
