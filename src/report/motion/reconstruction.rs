//! The shape that an experiment tells, in words and as JSON.

use crate::experiment::{Answer, Experiment, Reconstruction, WholeMotion, error, shown};
use crate::mechanics::moving::Shape;
use crate::report::motion::fit::finite;
use crate::report::motion::shape::support_error;
use crate::shape::{Convexity, Measured, ShapeEstimate};
use serde_json::{Value, json};
use std::fmt::Write;

/// A misfit that is larger than the noise by more than this factor is said.
pub(super) const EXPLAINED: f64 = 1.1;

/// Angles of which bands and errors are taken.
const NORMALS: u32 = 1440;

/// The reconstruction of the answer that is shown.
pub(super) fn reconstruction(answers: &[Answer]) -> Option<&Reconstruction> {
    shown(answers)?.reconstruction.as_deref()
}

/// A length in a unit in which it is easily read.
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

/// The gaps of the coverage in words; nothing where there is none.
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
        Some(_) => "from all readings at once".to_owned(),
        None => format!("from what {} believed of the support radii", found.track.method.name()),
    }
}

/// The shape, as lines.
pub(super) fn shape_text(experiment: &Experiment, answers: &[Answer]) -> String {
    let mut text = String::new();
    let Some(found) = reconstruction(answers) else { return text };
    let Some(shape) = &found.shape else {
        let _ = writeln!(text, "\nshape: nothing was seen of it");
        return text;
    };
    let _ = writeln!(text, "\nshape, {}: {} harmonics", from_in_words(found), shape.support.order());
    let mean = shape.support.mean;
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
    let (perimeter, area) = (shape.perimeter(), shape.area());
    if found.coverage.fraction() < 1.0 {
        let _ = writeln!(
            text,
            "  what follows is of the polynomial: harmonics that show only in gaps are not in it"
        );
    }
    let _ = writeln!(text, "  perimeter {:.9} m ± {:.1e}", perimeter.value, perimeter.deviation);
    let _ = writeln!(text, "  area {:.9} m^2 ± {:.1e}", area.value, area.deviation);
    let _ = writeln!(text, "  {}", convexity_in_words(shape));
    if let Some(whole) = &found.whole {
        let _ = writeln!(text, "  {}", misfit_in_words(whole, shape));
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
    format!("the misfit is {:.1} times what bounds explain, and the band is as much wider", shape.widened)
}

pub(super) fn misfit_in_words(whole: &WholeMotion, shape: &ShapeEstimate) -> String {
    let left = format!("contacts are explained to {} (rms)", length(whole.misfit));
    match shape.widened > EXPLAINED {
        true => {
            format!("{left}, {:.1} times their noise, and the band is as much wider", shape.widened)
        }
        false => format!("{left}, their noise being {}", length(whole.sigma)),
    }
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
        "from": if found.whole.is_some() { "all readings" } else { "track" },
        "coverage": found.coverage.fraction(),
        "gaps": found.coverage.gaps(),
    });
    let Some(shape) = &found.shape else { return Some(json) };
    let covered = |angle: f64| found.coverage.contains(angle);
    json["mean_radius"] = finite(shape.support.mean);
    json["harmonics"] = json!(shape.support.harmonics);
    json["band"] = json!({
        "largest_where_touched": widest(found, shape, covered).map(finite),
        "largest": widest(found, shape, |_| true).map(finite),
    });
    json["perimeter"] = measured(shape.perimeter());
    json["area"] = measured(shape.area());
    json["convexity"] = convexity_json(&shape.convexity());
    json["convexity_within_band"] = convexity_json(&shape.convexity_within_band());
    json["chi_square"] = finite(shape.chi_square);
    json["degrees_of_freedom"] = json!(shape.degrees);
    json["widened"] = finite(shape.widened);
    if let Some(whole) = &found.whole {
        json["misfit"] = finite(whole.misfit);
        json["noise"] = finite(whole.sigma);
        if let Some(gyration) = whole.gyration {
            json["rho"] = measured(gyration);
        }
    }
    if let Some((largest, rms)) = truth(experiment).and_then(|truth| support_error(shape, truth, covered)) {
        json["error"] = json!({
            "largest": finite(largest),
            "root_mean_square": finite(rms),
            "largest_over_mean_radius": finite(largest / shape.support.mean),
        });
    }
    Some(json)
}
