//! The shape that an experiment tells, in words, as JSON and as a part of a page.

use crate::experiment::{Experiment, Reconstruction, WholeMotion, error, shown};
use crate::mechanics::moving::Shape;
use crate::report::motion::answers::Observed;
use crate::report::motion::fit::finite;
use crate::report::motion::outline_plot::{band_picture, outline_picture};
use crate::report::motion::section::length;
use crate::report::motion::shape::support_error;
use crate::shape::{Convexity, Measured, ShapeEstimate};
use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};
use std::fmt::Write;

/// A misfit that is larger than the noise by more than this factor is said.
const EXPLAINED: f64 = 1.1;

/// Angles of which bands and errors are taken.
const NORMALS: u32 = 1440;

/// The reconstruction of the answer that is shown.
pub(super) fn reconstruction<'a>(observed: &Observed<'a>) -> Option<&'a Reconstruction> {
    shown(observed.answers)?.reconstruction.as_deref()
}

fn word(convexity: &Convexity) -> &'static str {
    match convexity {
        Convexity::Convex { .. } => "convex",
        Convexity::NotConvex { .. } => "not convex",
        Convexity::Undecided { .. } => "undecided",
    }
}

/// The largest half width of the band over the normals that count.
fn widest(shape: &ShapeEstimate, counts: impl Fn(f64) -> bool) -> Option<f64> {
    let angles = (0..NORMALS).map(|i| std::f64::consts::TAU * f64::from(i) / f64::from(NORMALS));
    angles.filter(|angle| counts(*angle)).map(|angle| 2.0 * shape.deviation(angle)).reduce(f64::max)
}

/// The true shape, where it is known and the frame is its own.
fn truth<'a>(experiment: &'a Experiment) -> Option<&'a Shape> {
    experiment.simulation.as_ref().map(|simulation| &simulation.shape)
}

fn degrees(gap: &[f64; 2]) -> String {
    format!("{:.0}° to {:.0}°", gap[0].to_degrees(), gap[1].to_degrees())
}

/// The gaps of the coverage in words; nothing where there is none.
fn gaps(found: &Reconstruction) -> String {
    let gaps: Vec<String> = found.coverage.gaps().iter().map(degrees).collect();
    if gaps.is_empty() { String::new() } else { format!("; not from {}", gaps.join(", ")) }
}

fn convexity_in_words(shape: &ShapeEstimate) -> String {
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

fn from_in_words(found: &Reconstruction) -> String {
    match &found.whole {
        Some(_) => "from all readings at once".to_owned(),
        None => format!("from what {} believed of the support radii", found.track.method.name()),
    }
}

/// The shape, as lines.
pub(super) fn shape_text(observed: &Observed<'_>) -> String {
    let mut text = String::new();
    let Some(found) = reconstruction(observed) else { return text };
    let Some(shape) = &found.shape else {
        let _ = writeln!(text, "\nshape: nothing was seen of it");
        return text;
    };
    let _ = writeln!(text, "\nshape, {}: {} harmonics", from_in_words(found), shape.support.order());
    let mean = shape.support.mean;
    let _ = writeln!(text, "  normals touched: {:.1} %{}", 100.0 * found.coverage.fraction(), gaps(found));
    let covered = |angle: f64| found.coverage.contains(angle);
    if let Some(band) = widest(shape, covered) {
        let everywhere = widest(shape, |_| true).unwrap_or(f64::NAN);
        let _ = writeln!(
            text,
            "  band (two standard deviations): at most {} where touched, {} anywhere; mean radius {}",
            length(band),
            length(everywhere),
            length(mean)
        );
    }
    let (perimeter, area) = (shape.perimeter(), shape.area());
    let _ = writeln!(text, "  perimeter {:.9} m ± {:.1e}", perimeter.value, perimeter.deviation);
    let _ = writeln!(text, "  area {:.9} m^2 ± {:.1e}", area.value, area.deviation);
    let _ = writeln!(text, "  {}", convexity_in_words(shape));
    if let Some(whole) = &found.whole {
        let _ = writeln!(text, "  {}", misfit_in_words(whole, shape));
        if let Some(gyration) = whole.gyration {
            let _ = write!(text, "  rho {:.9} m ± {:.1e}", gyration.value, gyration.deviation);
            match observed.experiment.simulation.as_ref().and_then(|s| s.constants.get("rho")) {
                Some(truth) => {
                    let _ = writeln!(text, ", error {:.1e}", error(gyration.value, *truth));
                }
                None => text.push('\n'),
            }
        }
    } else if shape.widened > EXPLAINED {
        let _ = writeln!(text, "  {}", widened_in_words(shape));
    }
    if let Some((largest, rms)) =
        truth(observed.experiment).and_then(|truth| support_error(shape, truth, covered))
    {
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

fn widened_in_words(shape: &ShapeEstimate) -> String {
    format!("the misfit is {:.1} times what bounds explain, and the band is as much wider", shape.widened)
}

fn misfit_in_words(whole: &WholeMotion, shape: &ShapeEstimate) -> String {
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
pub(super) fn shape_json(observed: &Observed<'_>) -> Option<Value> {
    let found = reconstruction(observed)?;
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
        "largest_where_touched": widest(shape, covered).map(finite),
        "largest": widest(shape, |_| true).map(finite),
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
    if let Some((largest, rms)) =
        truth(observed.experiment).and_then(|truth| support_error(shape, truth, covered))
    {
        json["error"] = json!({
            "largest": finite(largest),
            "root_mean_square": finite(rms),
            "largest_over_mean_radius": finite(largest / shape.support.mean),
        });
    }
    Some(json)
}

/// The shape with its pictures; nothing where none was asked for.
pub(super) fn shape_section(observed: &Observed<'_>) -> Markup {
    let Some(found) = reconstruction(observed) else { return html! {} };
    let Some(shape) = &found.shape else {
        return html! { p.remark { "Nothing was seen of the shape." } };
    };
    let truth = truth(observed.experiment);
    let covered = |angle: f64| found.coverage.contains(angle);
    let (perimeter, area) = (shape.perimeter(), shape.area());
    let (picture, magnified) = outline_picture(found, shape, truth);
    html! {
        p {
            "A closed support function with " (shape.support.order()) " harmonics, " (from_in_words(found)) ". "
            b { (format!("{:.1} %", 100.0 * found.coverage.fraction())) " of the normals were touched" } (gaps(found)) ". "
            @if let Some(band) = widest(shape, covered) {
                "The band, two standard deviations to either side, is at most " b { (length(band)) } " wide where it was touched: "
                (format!("{:.1e}", band / shape.support.mean)) " of the mean radius " (length(shape.support.mean)) ". "
            }
            @if let Some((largest, rms)) = truth.and_then(|truth| support_error(shape, truth, covered)) {
                "The largest error there is " b { (length(largest)) } " (rms " (length(rms)) "). "
            }
        }
        p {
            "Perimeter " (format!("{:.6} m ± {:.1e}", perimeter.value, perimeter.deviation)) ", area "
            (format!("{:.6} m² ± {:.1e}", area.value, area.deviation)) ". The polynomial is " (convexity_in_words(shape)) ". "
            @match &found.whole {
                Some(whole) => { (misfit_in_words(whole, shape)) "." }
                None if shape.widened > EXPLAINED => { (widened_in_words(shape)) "." }
                None => {}
            }
        }
        figure {
            div.two { (PreEscaped(picture)) (PreEscaped(band_picture(found, shape, truth))) }
            figcaption {
                "Left: the outline"
                @if truth.is_some() { " over the true one (grey)" }
                ", with its band"
                @if magnified > 1.0 { " drawn " b { (format!("{magnified:.0}")) " times as wide as it is" } }
                "; pale where no normal was touched: there convexity alone says how wide it is. Right: the band over the angle of the normal"
                @if truth.is_some() { ", and the error of the support radius in it" }
                "."
            }
        }
    }
}
