//! The shape that is recovered from an experiment, as text and as JSON.

use crate::motion::fit::finite;
use crate::motion::shape::support_error;
use palmistry_bodies::mechanics::moving::Shape;
use palmistry_bodies::shape::{Convexity, Measured, ShapeEstimate};
use palmistry_scenes::{
    Answer, Apart, Contradiction, Experiment, Reconstruction, TooWide, WholeMotion, error, shown,
};
use serde_json::{Value, json};
use std::fmt::Write;

/// A residual that is larger than the noise by more than this factor is said.
pub(super) const EXPLAINED: f64 = 1.1;

/// Angles of which bands and errors are taken.
const NORMALS: u32 = 1440;

/// The reconstruction of the answer that is shown.
pub(super) fn reconstruction(answers: &[Answer]) -> Option<&Reconstruction> {
    shown(answers)?.reconstruction.as_deref()
}

/// A length in a convenient unit.
pub(super) fn length(metres: f64) -> String {
    match metres {
        m if m < 1e-6 => format!("{:.2} nm", m * 1e9),
        m if m < 1e-3 => format!("{:.2} µm", m * 1e6),
        m if m < 1.0 => format!("{:.2} mm", m * 1e3),
        m if m.is_infinite() => "anything".to_owned(),
        m => format!("{m:.3} m"),
    }
}

fn word(convexity: &Convexity) -> &'static str {
    match convexity {
        Convexity::Convex { .. } => "convex",
        Convexity::NotConvex { .. } => "not convex",
        Convexity::Undecided { .. } => "undecided",
    }
}

/// The largest half width of the band over the normals that count.
pub(super) fn widest(
    found: &Reconstruction,
    shape: &ShapeEstimate,
    counts: impl Fn(f64) -> bool,
) -> Option<f64> {
    let angles = (0..NORMALS).map(|i| std::f64::consts::TAU * f64::from(i) / f64::from(NORMALS));
    angles.filter(|angle| counts(*angle)).map(|angle| shape.band(&found.coverage, angle)).reduce(f64::max)
}

/// The true shape, where it is known and the frame is its own.
pub(super) fn truth(experiment: &Experiment) -> Option<&Shape> {
    experiment.simulation.as_ref().map(|simulation| &simulation.shape)
}

fn degrees(gap: &[f64; 2]) -> String {
    format!("{:.0}° to {:.0}°", gap[0].to_degrees(), gap[1].to_degrees())
}

/// The gaps of the coverage as text; nothing where there is none.
pub(super) fn gaps(found: &Reconstruction) -> String {
    let gaps: Vec<String> = found.coverage.gaps().iter().map(degrees).collect();
    if gaps.is_empty() { String::new() } else { format!("; not from {}", gaps.join(", ")) }
}

pub(super) fn convexity_in_words(shape: &ShapeEstimate) -> String {
    let itself = match shape.convexity() {
        Convexity::Convex { least } => format!("convex, with radii of curvature from {} on", length(least)),
        Convexity::NotConvex { angle, .. } => format!("not convex at the normal {:.1}°", angle.to_degrees()),
        Convexity::Undecided { angle } => {
            format!("not decided at the normal {:.1}°", angle.to_degrees().rem_euclid(360.0))
        }
    };
    let band = match shape.convexity_within_band() {
        Convexity::Convex { .. } => "so is all of its band".to_owned(),
        Convexity::NotConvex { angle, .. } => {
            format!("nothing in its band is, at {:.1}°", angle.to_degrees())
        }
        Convexity::Undecided { angle } => {
            format!("its band leaves it undecided, at {:.1}°", angle.to_degrees().rem_euclid(360.0))
        }
    };
    format!("{itself}; {band}")
}

pub(super) fn from_in_words(found: &Reconstruction) -> String {
    match &found.whole {
        Some(_) => "batch estimate of all measurements".to_owned(),
        None => format!("from the support radii that {} estimated", found.track.method.name()),
    }
}

/// That there is no shape: where some sample was observable, remarks say why.
pub(super) fn no_shape_in_words(found: &Reconstruction) -> &'static str {
    match found.track.instants.iter().any(|at| at.is_observed) {
        true => "no estimate",
        false => "no estimate: no sample is observable",
    }
}

/// The shape, as lines.
pub(super) fn shape_text(experiment: &Experiment, answers: &[Answer]) -> String {
    let mut text = String::new();
    let Some(found) = reconstruction(answers) else { return text };
    let Some(shape) = &found.shape else {
        let _ = writeln!(text, "\nshape: {}", no_shape_in_words(found));
        text.extend(reasons(found).iter().map(|why| format!("  {why}\n")));
        return text;
    };
    let _ = writeln!(text, "\nshape, {}: {}", from_in_words(found), model_in_words(shape));
    let mean = shape.support.mean();
    let _ = writeln!(text, "  normals touched: {:.1} %{}", 100.0 * found.coverage.fraction(), gaps(found));
    let covered = |angle: f64| found.coverage.contains(angle);
    if let Some(band) = widest(found, shape, covered) {
        let everywhere = widest(found, shape, |_| true).unwrap_or(f64::NAN);
        let _ = writeln!(
            text,
            "  band (two standard deviations): at most {} where touched, {} anywhere; mean radius {}",
            length(band),
            length(everywhere),
            length(mean)
        );
    }
    for (name, size) in sizes_in_words(found, shape, "m^2", 9) {
        let _ = writeln!(text, "  {name} {size}");
    }
    let _ = writeln!(text, "  {}", convexity_in_words(shape));
    text.extend(found.apart.iter().map(|apart| format!("  {}\n", apart_in_words(apart))));
    if let Some(whole) = &found.whole {
        let _ = writeln!(text, "  {}", residual_in_words(whole, shape));
        if let Some(gyration) = whole.gyration {
            let _ = write!(text, "  rho {:.9} m ± {:.1e}", gyration.value, gyration.deviation);
            match experiment.simulation.as_ref().and_then(|s| s.constants.get("rho")) {
                Some(truth) => {
                    let _ = writeln!(text, ", error {:.1e}", error(gyration.value, *truth));
                }
                None => text.push('\n'),
            }
        }
    } else if shape.widened > EXPLAINED {
        let _ = writeln!(text, "  {}", widened_in_words(shape));
    }
    if let Some((largest, rms)) = truth(experiment).and_then(|truth| support_error(shape, truth, covered)) {
        let _ = writeln!(
            text,
            "  error where touched: at most {} ({:.1e} of the mean radius), rms {}",
            length(largest),
            largest / mean,
            length(rms)
        );
    }
    text
}

pub(super) fn widened_in_words(shape: &ShapeEstimate) -> String {
    format!("the residuals are {:.1} times what bounds explain, and the band is as much wider", shape.widened)
}

pub(super) fn residual_in_words(whole: &WholeMotion, shape: &ShapeEstimate) -> String {
    let left = format!("contacts are explained to {} (rms)", length(whole.rms_residual));
    match (shape.widened > EXPLAINED, whole.stated) {
        (true, true) => {
            format!(
                "{left}, their noise being {}, and the band is {:.1} times as wide as that noise alone would make it",
                length(whole.sigma),
                shape.widened
            )
        }
        (true, false) => {
            format!(
                "{left}, no noise being stated, and residuals of neighbours are alike: the band is {:.1} times as wide for it",
                shape.widened
            )
        }
        (false, true) => format!("{left}, their noise being {}", length(whole.sigma)),
        (false, false) => format!("{left}, no noise being stated; taken for {}", length(whole.sigma)),
    }
}

/// The model of a support function.
pub(super) fn model_in_words(shape: &ShapeEstimate) -> String {
    match shape.support.points().len() {
        0 => format!("{} harmonics at most", shape.support.order()),
        points => format!("a closed cubic spline through {points} points"),
    }
}

fn contradiction_in_words(found: &Contradiction) -> String {
    let Contradiction { time, name, by_window, of_all } = found;
    format!(
        "the batch estimate of all measurements is no answer: it makes {name} {:.6} ± {:.1e} at {time:.3} s, and a window that fits {:.6} ± {:.1e}",
        of_all.value, of_all.deviation, by_window.value, by_window.deviation
    )
}

pub(super) fn apart_in_words(found: &Apart) -> String {
    let Apart { between, scale } = found;
    let why = match between > scale {
        true => " Are the times in another unit than s, as milliseconds?",
        false => "",
    };
    format!(
        "the batch estimate of all measurements is no answer: samples are {between:.3} s apart, more happens between them than is followed, and gravity moves a body of this size in {scale:.3} s.{why}"
    )
}

fn too_wide_in_words(found: &TooWide) -> String {
    format!(
        "the outline that was found is no answer: its band (two standard deviations) would be {} where touched, beside a mean radius of {}: errors of that size are not linear, the search has not ended, or the motion that was found leaves more than the stated noise",
        length(found.band),
        length(found.mean)
    )
}

/// Why there is no shape, or why none by all measurements at once.
pub(super) fn reasons(found: &Reconstruction) -> Vec<String> {
    let contradiction = found.contradiction.iter().map(contradiction_in_words);
    let too_wide = found.too_wide.iter().map(too_wide_in_words);
    contradiction.chain(too_wide).chain(found.apart.iter().map(apart_in_words)).collect()
}

/// Perimeter and area: of a body that was touched all round with their deviations, else the bounds from its contacts, whatever lies in the gaps. Not given
/// where these are not a convex body's.
pub(super) fn sizes_in_words(
    found: &Reconstruction,
    shape: &ShapeEstimate,
    square: &str,
    digits: usize,
) -> Vec<(&'static str, String)> {
    let Some(extent) = shape.extent(&found.coverage) else {
        return vec![("perimeter and area:", "not those of a convex body, not given".to_owned())];
    };
    let is_whole = found.coverage.gaps().is_empty();
    let of = |value: Measured, [least, most]: [f64; 2], unit: &str| {
        let is_within = (least..=most).contains(&value.value);
        match (is_whole && is_within, most.is_finite()) {
            (true, _) => format!("{:.digits$} {unit} ± {:.1e}", value.value, value.deviation),
            (false, true) => {
                format!("from {least:.6} to {most:.6} {unit}, by the contacts and the tangents there")
            }
            (false, false) => format!("at least {least:.6} {unit}, by the contacts"),
        }
    };
    vec![
        ("perimeter", of(shape.perimeter(), extent.perimeter, "m")),
        ("area", of(shape.area(), extent.area, square)),
    ]
}

fn measured(value: Measured) -> Value {
    json!({ "value": finite(value.value), "deviation": finite(value.deviation) })
}

fn convexity_json(convexity: &Convexity) -> Value {
    let mut found = json!({ "verdict": word(convexity) });
    match convexity {
        Convexity::Convex { least } => found["least_radius_of_curvature"] = finite(*least),
        Convexity::NotConvex { angle, value } => {
            found["angle"] = finite(*angle);
            found["radius_of_curvature"] = finite(*value);
        }
        Convexity::Undecided { angle } => found["angle"] = finite(*angle),
    }
    found
}

/// The shape as JSON; nothing where none was asked for.
pub(super) fn shape_json(experiment: &Experiment, answers: &[Answer]) -> Option<Value> {
    let found = reconstruction(answers)?;
    let mut json = json!({
        "method": found.track.method.name(),
        "from": if found.whole.is_some() { "all measurements" } else { "track" },
        "coverage": found.coverage.fraction(),
        "gaps": found.coverage.gaps(),
    });
    if let Some(Apart { between, scale }) = &found.apart {
        json["apart"] = json!({ "between": finite(*between), "scale": finite(*scale) });
    }
    if let Some(Contradiction { time, name, by_window, of_all }) = &found.contradiction {
        json["contradiction"] = json!({
            "time": finite(*time), "state": name, "window": measured(*by_window), "all_measurements": measured(*of_all),
        });
    }
    if let Some(TooWide { band, mean }) = &found.too_wide {
        json["too_wide"] = json!({ "band": finite(*band), "mean_radius": finite(*mean) });
    }
    let Some(shape) = &found.shape else { return Some(json) };
    let covered = |angle: f64| found.coverage.contains(angle);
    json["mean_radius"] = finite(shape.support.mean());
    json["harmonics"] = json!(shape.support.harmonics());
    json["band"] = json!({
        "largest_where_touched": widest(found, shape, covered).map(finite),
        "largest": widest(found, shape, |_| true).map(finite),
    });
    if !shape.support.points().is_empty() {
        json["points"] = json!(shape.support.points());
    }
    if let Some(extent) = shape.extent(&found.coverage) {
        // of a body that was not touched all round its contacts and tangents alone say something
        let is_whole = found.coverage.gaps().is_empty();
        let of = |value: Measured, [least, most]: [f64; 2]| {
            let mut json = json!({ "at_least": finite(least), "at_most": finite(most) });
            if is_whole && (least..=most).contains(&value.value) {
                json["value"] = finite(value.value);
                json["deviation"] = finite(value.deviation);
            }
            json
        };
        json["perimeter"] = of(shape.perimeter(), extent.perimeter);
        json["area"] = of(shape.area(), extent.area);
    }
    json["convexity"] = convexity_json(&shape.convexity());
    json["convexity_within_band"] = convexity_json(&shape.convexity_within_band());
    json["chi_square"] = finite(shape.chi_square);
    json["degrees_of_freedom"] = json!(shape.degrees);
    json["widened"] = finite(shape.widened);
    if let Some(whole) = &found.whole {
        json["residual"] = finite(whole.rms_residual);
        json["noise"] = finite(whole.sigma);
        json["noise_is_stated"] = json!(whole.stated);
        if let Some(gyration) = whole.gyration {
            json["rho"] = measured(gyration);
        }
    }
    if let Some((largest, rms)) = truth(experiment).and_then(|truth| support_error(shape, truth, covered)) {
        json["error"] = json!({
            "largest": finite(largest),
            "root_mean_square": finite(rms),
            "largest_over_mean_radius": finite(largest / shape.support.mean()),
        });
    }
    Some(json)
}
