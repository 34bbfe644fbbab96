//! What the studies of a scene came to, as JSON, as text and as a part of a page.

use crate::experiment::{ARRIVED, Basin, CurvatureMap, NoiseLevel, Told};
use crate::report::axis::unit_of;
use crate::report::motion::answers::{Observed, noise_unit};
use crate::report::motion::fit::finite;
use crate::report::motion::study_plot;
use maud::{Markup, PreEscaped, html};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Adds each study that was made.
pub(super) fn studies_json(observed: &Observed<'_>, found: &mut Value) {
    let experiment = observed.experiment;
    if !observed.studied.noise.is_empty() {
        let names = experiment.names();
        let level = |level: &NoiseLevel| {
            let by_name = |values: &[f64]| -> Map<String, Value> {
                names.iter().zip(values).map(|(name, value)| ((*name).to_owned(), finite(*value))).collect()
            };
            json!({
                "noise": level.noise,
                "seeds": level.seeds,
                "converged": level.converged,
                "said_not_to_fit": level.unfit,
                "root_mean_square_error": by_name(&level.errors),
                "bound": by_name(&level.bounds),
            })
        };
        found["noise"] = json!(observed.studied.noise.iter().map(level).collect::<Vec<_>>());
    }
    if !observed.studied.basins.is_empty() {
        let basin = |basin: &Basin| {
            json!({
                "method": basin.method.name(),
                "states": basin.names,
                "values": basin.values,
                "arrives": basin.arrives,
                "fraction": basin.fraction(),
            })
        };
        found["basins"] = json!(observed.studied.basins.iter().map(basin).collect::<Vec<_>>());
    }
    if let Some(map) = &observed.studied.curvature {
        found["curvature"] = curvature_json(map);
    }
}

fn told_json(told: Told) -> Value {
    match told {
        Told::NotHeld => json!("not held"),
        Told::Blind => json!("blind"),
        Told::Bound(bound) => json!(bound),
    }
}

fn curvature_json(map: &CurvatureMap) -> Value {
    let side = map.curvatures.len();
    let motions = map.motions.iter().map(|motion| {
        json!({ "orientation": motion.orientation, "rate": motion.rate, "flat": told_json(motion.flat) })
    });
    let pairs = map.told.iter().enumerate().map(|(cell, told)| {
        let ratio = map.ratio(cell).map(|ratio| {
            json!({
                "median": of_ratio(ratio.median),
                "least": of_ratio(ratio.least),
                "greatest": of_ratio(ratio.greatest),
                "motions": ratio.motions,
            })
        });
        json!({
            "curvatures": [map.curvatures[cell % side], map.curvatures[cell / side]],
            "bounds": told.iter().map(|told| told.map_or(Value::Null, told_json)).collect::<Vec<_>>(),
            "over_flat": ratio,
        })
    });
    json!({
        "noise": map.noise,
        "motions": motions.collect::<Vec<_>>(),
        "pairs": pairs.collect::<Vec<_>>(),
    })
}

fn of_ratio(ratio: f64) -> Value {
    if ratio.is_finite() { json!(ratio) } else { json!("blind") }
}

/// Adds a paragraph for each study.
pub(super) fn studies_text(observed: &Observed<'_>, text: &mut String) {
    let names = observed.experiment.names();
    for level in &observed.studied.noise {
        let _ = writeln!(
            text,
            "\nnoise {:.1e}{}: {} of {} seeds converged, of {} it was said that they do not fit",
            level.noise,
            noise_unit(observed),
            level.converged,
            level.seeds,
            level.unfit
        );
        for ((name, error), bound) in names.iter().zip(&level.errors).zip(&level.bounds) {
            let ratio = error / bound;
            let _ = writeln!(text, "  {name:<8} rms error {error:.3e}, bound {bound:.3e}, ratio {ratio:.3}");
        }
    }
    for basin in &observed.studied.basins {
        let _ = writeln!(
            text,
            "\n{} arrives from {:.1}% of {} first guesses of {} and {}",
            basin.method.name(),
            100.0 * basin.fraction(),
            basin.arrives.iter().flatten().count(),
            basin.names[0],
            basin.names[1]
        );
    }
    if let Some(map) = &observed.studied.curvature {
        curvature_text(map, text);
    }
}

fn curvature_text(map: &CurvatureMap, text: &mut String) {
    let side = map.curvatures.len();
    let _ = writeln!(text, "\nthe larger bound of r1 and r2 over that between flat palms: {}", compared(map));
    let head: String = map.curvatures.iter().map(|curvature| format!("{curvature:>9.3}")).collect();
    let _ = writeln!(text, "  1/b2, 1/m  1/b1 ={head}");
    for (row, curvature) in map.curvatures.iter().enumerate().rev() {
        let cells: String =
            (0..side).map(|column| format!("{:>9}", ratio_words(map, row * side + column))).collect();
        let _ = writeln!(text, "  {curvature:>9.3}        {cells}");
    }
}

/// The median of a pair of curvatures in words.
pub(super) fn ratio_words(map: &CurvatureMap, cell: usize) -> String {
    match map.ratio(cell) {
        Some(ratio) if ratio.median.is_finite() => format!("{:.2}", ratio.median),
        Some(_) => "blind".to_owned(),
        None => "none".to_owned(),
    }
}

/// Of how many motions a map is the median.
fn compared(map: &CurvatureMap) -> String {
    let seen = map.motions.iter().filter(|motion| matches!(motion.flat, Told::Bound(_))).count();
    format!(
        "the median of those of {seen} motions in which the body is held (of {}, flat palms see nothing or do not hold it in the others), contacts read to {:.1e} m",
        map.motions.len(),
        map.noise
    )
}

fn curvature(map: &CurvatureMap) -> Markup {
    html! {
        h3 { "Between palms of other curvatures" }
        figure {
            (PreEscaped(study_plot::curvature(map)))
            figcaption {
                "The larger bound of Cramér and Rao of both support radii in the first window, over that between flat palms: " (compared(map)) ". "
                "Below one these palms tell more than flat ones. Curvatures above zero are those of hollow palms."
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
                    "the bound at the truth, both in decades. Dots on the line: nothing more is to be had from these readings. Dots "
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
                    (format!("{:.0}%", 100.0 * ARRIVED)) " of all that is sought: after the first window for methods that work by "
                    "windows, at the last sample for the others. The cross is the truth. Where the readings have errors, and the bound "
                    "of a state is near that part of it, they decide as well."
                }
            }
        }
        @if let Some(map) = &observed.studied.curvature { (curvature(map)) }
    }
}

/// The error over noise beside its bound.
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
                td.number { (format!("{:.1e}", level.noise)) }
                td.number { (level.converged) " of " (level.seeds) }
                @for (error, bound) in level.errors.iter().zip(&level.bounds) {
                    td.number { (format!("{error:.2e}")) }
                    td.number { @if bound.is_finite() { (format!("{bound:.2e}")) } @else { "not seen" } }
                    td.number { @if bound.is_finite() && *bound > 0.0 { (format!("{:.2}", error / bound)) } @else { "-" } }
                }
            } } }
        } }
    }
}
