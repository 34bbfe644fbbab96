//! What the studies of a scene came to, as JSON and as text.

use crate::motion::fit::finite;
use palmistry_scenes::{Basin, CurvatureMap, NoiseLevel, Studied, WindowBound};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Adds each study that was made, of the estimated states by these names.
pub(super) fn studies_json(studied: &Studied, names: &[&str], found: &mut Value) {
    if !studied.noise.is_empty() {
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
        found["noise"] = json!(studied.noise.iter().map(level).collect::<Vec<_>>());
    }
    if !studied.basins.is_empty() {
        let basin = |basin: &Basin| {
            json!({
                "method": basin.method.name(),
                "states": basin.names,
                "values": basin.values,
                "arrives": basin.arrives,
                "fraction": basin.fraction(),
            })
        };
        found["basins"] = json!(studied.basins.iter().map(basin).collect::<Vec<_>>());
    }
    if let Some(map) = &studied.curvature {
        found["curvature"] = curvature_json(map);
    }
}

fn bound_json(told: WindowBound) -> Value {
    match told {
        WindowBound::NotHeld => json!("not held"),
        WindowBound::Unobservable => json!("not observable"),
        WindowBound::Bound(bound) => json!(bound),
    }
}

fn curvature_json(map: &CurvatureMap) -> Value {
    let side = map.curvatures.len();
    let motions = map.motions.iter().map(|motion| {
        json!({ "orientation": motion.orientation, "rate": motion.rate, "flat": bound_json(motion.flat) })
    });
    let pairs = map.bounds.iter().enumerate().map(|(cell, told)| {
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
            "bounds": told.iter().map(|told| told.map_or(Value::Null, bound_json)).collect::<Vec<_>>(),
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
    if ratio.is_finite() { json!(ratio) } else { json!("not observable") }
}

/// Adds a paragraph for each study; noise is in this unit.
pub(super) fn studies_text(studied: &Studied, names: &[&str], unit: &str, text: &mut String) {
    for level in &studied.noise {
        let _ = writeln!(
            text,
            "\nnoise {:.1e}{}: {} of {} seeds converged, {} of them fail the chi-square test",
            level.noise, unit, level.converged, level.seeds, level.unfit
        );
        for ((name, error), bound) in names.iter().zip(&level.errors).zip(&level.bounds) {
            let ratio = error / bound;
            let _ = writeln!(text, "  {name:<8} rms error {error:.3e}, bound {bound:.3e}, ratio {ratio:.3}");
        }
    }
    for basin in &studied.basins {
        let _ = writeln!(
            text,
            "\n{} arrives from {:.1}% of {} initial guesses of {} and {}",
            basin.method.name(),
            100.0 * basin.fraction(),
            basin.arrives.iter().flatten().count(),
            basin.names[0],
            basin.names[1]
        );
    }
    if let Some(map) = &studied.curvature {
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
            (0..side).map(|column| format!("{:>9}", ratio_text(map, row * side + column))).collect();
        let _ = writeln!(text, "  {curvature:>9.3}        {cells}");
    }
}

/// The median of a pair of curvatures as text.
pub(super) fn ratio_text(map: &CurvatureMap, cell: usize) -> String {
    match map.ratio(cell) {
        Some(ratio) if ratio.median.is_finite() => format!("{:.2}", ratio.median),
        Some(_) => "not observable".to_owned(),
        None => "none".to_owned(),
    }
}

/// Of how many motions a map is the median.
pub(super) fn compared(map: &CurvatureMap) -> String {
    let seen = map.motions.iter().filter(|motion| matches!(motion.flat, WindowBound::Bound(_))).count();
    format!(
        "the median of those of {seen} motions in which the body is held (of {}, from flat palms it is unobservable or not held in the others), contacts measured to {:.1e} m",
        map.motions.len(),
        map.noise
    )
}
