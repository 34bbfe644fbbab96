//! What three palms tell of a body in space: a page with a picture of the shape that can be turned, tables, and curves of errors.

use crate::experiment::space::directions;
use crate::report::document::document;
use crate::report::slow_plot::logarithmic;
use crate::report::solid_picture::{SCRIPT, ShownSurface, turnable_picture};
use crate::report::space::{SpaceObserved, entries, headline, shape_rows, space_ended};
use crate::shape::sphere::{OuterBound, SurfaceMesh};
use maud::{Markup, PreEscaped, html};
use nalgebra::Vector3;

/// Rings of the surfaces that are shown.
const RINGS: usize = 16;

/// More windows than these are in the JSON only.
const MOST_WINDOWS: usize = 60;

/// A surface by its points at directions: rings of four-sided faces between two caps.
fn surface(point: impl Fn(&Vector3<f64>) -> Vector3<f64>) -> SurfaceMesh {
    let rings = directions(RINGS);
    let around = 2 * RINGS;
    let corners = rings.iter().flatten().map(point).collect();
    let mut polygons: Vec<Vec<usize>> = vec![(0..around).collect()];
    for ring in 1..RINGS {
        for k in 0..around {
            let (above, below) = ((ring - 1) * around, ring * around);
            let next = (k + 1) % around;
            polygons.push(vec![above + k, below + k, below + next, above + next]);
        }
    }
    polygons.push(((RINGS - 1) * around..RINGS * around).rev().collect());
    SurfaceMesh { corners, polygons }
}

fn picture(observed: &SpaceObserved<'_>) -> Markup {
    let experiment = observed.experiment;
    let Some(shape) = &observed.answers.shape else { return html! { p { "There is no shape." } } };
    let truth = experiment.truth.as_ref().map(|_| {
        surface(|normal| experiment.true_support(normal).map_or(Vector3::zeros(), |(_, point)| point))
    });
    let found = shape.estimate.as_ref().map(|found| surface(|normal| found.support.point_and_bend(normal).0));
    let mut all = Vec::new();
    if let Some(surface) = &truth {
        all.push(ShownSurface { name: "the body", colour: "#9a9a9a", surface });
    } else if let Some(surface) = &found {
        all.push(ShownSurface { name: "the recovered support function", colour: "#9a9a9a", surface });
    }
    if let Ok(hull) = &shape.hull {
        all.push(ShownSurface { name: "hull of the contacts", colour: "#1f77b4", surface: &hull.surface });
    }
    if let Ok(OuterBound::Bounded(region)) = &shape.outer {
        all.push(ShownSurface { name: "half-spaces", colour: "#ff7f0e", surface: &region.surface });
    }
    html! {
        (turnable_picture(&experiment.scene.title, &all))
        script { (PreEscaped(SCRIPT)) }
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

/// The page as HTML.
pub fn space_page(observed: &SpaceObserved<'_>) -> String {
    let (experiment, answers) = (observed.experiment, observed.answers);
    let content = html! {
        header {
            h1 { (experiment.scene.title) }
            p {
                "A smooth convex body in space on three palms, from their readings with nothing known; " b { (experiment.readings.times.len()) " samples" } ". "
                @if experiment.truth.is_none() { "Recorded: what is true is not known. " }
                @if let Some(ended) = space_ended(observed) { (ended) ". " }
            }
            @if observed.interrupted { p.bad { "This run was interrupted; it shows what was done until then." } }
        }
        main {
            section #shape {
                h2 { "The shape that was touched" }
                (picture(observed))
                table { tbody { @for (what, value) in shape_rows(observed) { tr { th scope="row" { (what) } td { (value) } } } } }
            }
            section #state {
                h2 { "State, inertia and mass" }
                @for update in answers.updates.iter().take(MOST_WINDOWS) {
                    p { (headline(observed, update)) }
                    @let all = entries(observed, update);
                    @if !all.is_empty() {
                        div.scroll { table {
                            thead { tr { th { "" } th { "recovered" } th { "true" } th { "error" } th { "bound" } } }
                            tbody { @for entry in &all { tr {
                                td { (entry.name) ", " (entry.unit) }
                                td.number { (format!("{:.8}", entry.recovered)) }
                                td.number { (entry.truth.map_or("-".to_owned(), |truth| format!("{truth:.8}"))) }
                                td.number { (entry.truth.map_or("-".to_owned(), |truth| format!("{:.1e}", (entry.recovered - truth).abs()))) }
                                td.number { (format!("{:.1e}", entry.bound)) }
                            } } }
                        } }
                    }
                }
                @if answers.updates.len() > MOST_WINDOWS { p { "The other windows are in observe.json." } }
            }
            @if experiment.truth.is_some() { section #errors { h2 { "Errors over the samples" } (PreEscaped(curves(observed))) } }
        }
    };
    document(&experiment.scene.title, &content, false)
}
