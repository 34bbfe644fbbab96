//! Pictures of a slow body, written as SVG: the motion, what was touched, errors.

use crate::moved_body::{MovedPose, moved_body, rows};
use crate::slow_observed::SlowObserved;
use palmistry_scenes::slow::SlowTrack;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write;

/// Frames of the animation at most.
const MOVED: usize = 90;

/// Points of an outline.
const OUTLINE: usize = 96;

/// The track that is shown: the whole one, where there is none the quadrature's.
fn shown<'a>(observed: &SlowObserved<'a>) -> Option<&'a SlowTrack> {
    let answers = observed.answers;
    answers.together.as_ref().map(|found| &found.track).or(answers.quadrature.as_ref())
}

fn pose(observed: &SlowObserved<'_>, row: usize) -> Option<MovedPose> {
    let measurements = &observed.experiment.measurements;
    let (palms, contacts) = (measurements.palms[row], measurements.contacts[row]);
    if let Some(truth) = &observed.experiment.truth {
        let at = truth.trajectory.moments.get(row)?;
        return Some(MovedPose { phi0: at.phi0, centre: at.centre, palms, contacts });
    }
    let track = shown(observed)?;
    let [r1, r2] = *track.radii.get(row)?;
    let (first, second, opening) = (palms[0], palms[0] + palms[1], palms[1].sin());
    let centre =
        [(second.cos() * r1 + first.cos() * r2) / opening, (second.sin() * r1 + first.sin() * r2) / opening];
    Some(MovedPose { phi0: track.phi0[row], centre, palms, contacts })
}

/// The outline in the body's frame: the true one, or the one that was found.
fn outline(observed: &SlowObserved<'_>) -> Vec<[f64; 2]> {
    if let Some(truth) = &observed.experiment.truth {
        return truth.shape.outline(OUTLINE);
    }
    let support = observed.answers.together.as_ref().map(|found| &found.shape.support);
    let angles = (0..OUTLINE).map(|i| TAU * i as f64 / OUTLINE as f64);
    support.map_or_else(Vec::new, |support| angles.map(|angle| support.point(angle)).collect())
}

fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sine, cosine) = angle.sin_cos();
    [cosine * x - sine * y, sine * x + cosine * y]
}

/// The body and its palms in motion.
pub(super) fn animation(observed: &SlowObserved<'_>) -> String {
    let rows = rows(observed.experiment.measurements.rows(), MOVED);
    let poses: Vec<MovedPose> = rows.iter().filter_map(|row| pose(observed, *row)).collect();
    moved_body(&outline(observed), &poses)
}

/// Figure 3.6: at so many samples the points that were touched so far, as they were found; those of so many samples at most.
pub(super) fn frames(observed: &SlowObserved<'_>, most: usize, dots_of: usize) -> String {
    let (Some(found), measurements) = (&observed.answers.together, &observed.experiment.measurements) else {
        return "<p>Nothing was found.</p>".to_owned();
    };
    let support = &found.shape.support;
    let size = (0..OUTLINE)
        .map(|i| support.point(TAU * i as f64 / OUTLINE as f64))
        .map(|[x, y]| x.hypot(y))
        .fold(0.0, f64::max);
    let scale = 42.0 / size;
    let mut out = String::new();
    let count = measurements.rows();
    for frame in rows(count, most + 1).into_iter().skip(1) {
        let phi0 = found.track.phi0[frame];
        let mut dots = String::new();
        for row in (0..=frame).step_by((count / dots_of).max(1)) {
            let palms = measurements.palms[row];
            let normals = [palms[0] - FRAC_PI_2, palms[0] + palms[1] - 3.0 * FRAC_PI_2];
            for normal in normals {
                let [x, y] = turned(support.point(normal - found.track.phi0[row]), phi0);
                let _ = write!(dots, "M{:.1},{:.1}h.1", x * scale, -y * scale);
            }
        }
        let palms = measurements.palms[frame];
        let lines = [palms[0] - FRAC_PI_2, palms[0] + palms[1] - 3.0 * FRAC_PI_2].map(|normal| {
            let [x, y] = turned(support.point(normal - phi0), phi0);
            let along = [-normal.sin() * 30.0, normal.cos() * 30.0];
            format!(
                "<path d=\"M{:.1},{:.1}L{:.1},{:.1}\" stroke=\"#9a9a9a\"/><circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.5\" fill=\"#c8283c\"/>",
                x * scale - along[0], -y * scale + along[1], x * scale + along[0], -y * scale - along[1], x * scale, -y * scale
            )
        });
        let _ = write!(
            out,
            "<svg role=\"img\" aria-label=\"After {} samples\" viewBox=\"-55 -55 110 122\" width=\"110\" height=\"122\">{}{}<path d=\"{dots}\" stroke=\"#0072b2\" stroke-width=\"2.4\" stroke-linecap=\"round\"/><circle r=\"2.5\" fill=\"#282c34\"/><text y=\"66\" font-size=\"10\" text-anchor=\"middle\" fill=\"currentColor\">{}</text></svg>",
            frame + 1,
            lines[0],
            lines[1],
            frame + 1
        );
    }
    out
}

/// A curve of sizes over the samples, by their logarithms.
pub(super) fn logarithmic(title: &str, unit: &str, series: &[(&str, &str, Vec<f64>)]) -> String {
    let positive = || series.iter().flat_map(|(_, _, values)| values).filter(|v| v.is_finite() && **v > 0.0);
    let high = positive().copied().fold(f64::MIN_POSITIVE, f64::max).log10().ceil();
    let low = positive().copied().fold(f64::INFINITY, f64::min).log10().floor().max(high - 17.0);
    // neither where nothing is positive
    if high.partial_cmp(&low) != Some(std::cmp::Ordering::Greater) {
        return String::new();
    }
    let y = |value: f64| 20.0 + 180.0 * (high - value.max(1e-300).log10().clamp(low, high)) / (high - low);
    let mut out = format!(
        "<svg role=\"img\" aria-label=\"{title}\" viewBox=\"0 0 460 250\" width=\"460\" height=\"250\"><text x=\"230\" y=\"12\" font-size=\"13\" text-anchor=\"middle\" fill=\"currentColor\">{title} ({unit})</text>"
    );
    let mut decade = low;
    while decade <= high {
        let at = y(10f64.powf(decade));
        let _ = write!(
            out,
            "<path d=\"M50,{at:.1}H450\" stroke=\"currentColor\" stroke-opacity=\"0.15\"/><text x=\"46\" y=\"{:.1}\" font-size=\"10\" text-anchor=\"end\" fill=\"currentColor\">1e{decade}</text>",
            at + 3.0
        );
        decade += ((high - low) / 6.0).ceil().max(1.0);
    }
    for (place, (name, colour, values)) in series.iter().enumerate() {
        let count = values.len().max(2);
        let mut line = String::new();
        let mut pen = "M";
        for (i, value) in values.iter().enumerate() {
            if value.is_finite() {
                let _ =
                    write!(line, "{pen}{:.1},{:.1}", 50.0 + 400.0 * i as f64 / (count - 1) as f64, y(*value));
                pen = "L";
            } else {
                pen = "M";
            }
        }
        let _ = write!(
            out,
            "<path d=\"{line}\" fill=\"none\" stroke=\"{colour}\"/><text x=\"{}\" y=\"240\" font-size=\"11\" fill=\"{colour}\">{name}</text>",
            50 + 135 * place
        );
    }
    out.push_str("<text x=\"250\" y=\"218\" font-size=\"10\" text-anchor=\"middle\" fill=\"currentColor\">samples</text></svg>");
    out
}

/// Figures 3.7 and 3.8: errors of the radii and the orientation, and the errors that are known without the truth.
pub(super) fn curves(observed: &SlowObserved<'_>) -> String {
    off_truth(observed, usize::MAX) + &seen_errors(observed)
}

/// The greatest values of stretches, so many at most.
fn greatest(values: Vec<f64>, most: usize) -> Vec<f64> {
    let of = |part: &[f64]| part.iter().copied().fold(0.0, f64::max);
    values.chunks(values.len().div_ceil(most).max(1)).map(of).collect()
}

/// Errors of the radii and the orientation, a curve of so many points at most; nothing where the truth is not known.
pub(super) fn off_truth(observed: &SlowObserved<'_>, most: usize) -> String {
    let answers = observed.answers;
    let thesis = answers.thesis.first().map(|(_, found)| found);
    let tracks = [
        ("all at once", "#0072b2", answers.together.as_ref().map(|found| &found.track)),
        ("quadrature", "#009e73", answers.quadrature.as_ref()),
        ("thesis", "#d55e00", thesis.map(|found| &found.track)),
    ];
    let mut out = String::new();
    if let Some(truth) = &observed.experiment.truth {
        let moments = &truth.trajectory.moments;
        let mut radii = Vec::new();
        let mut turns = Vec::new();
        for (name, colour, track) in &tracks {
            let Some(track) = track else { continue };
            let both = track.radii.iter().zip(moments);
            let off = |(r, at): (&[f64; 2], &palmistry_bodies::mechanics::moving::Moment)| {
                (r[0] - at.palms[0].r).abs().max((r[1] - at.palms[1].r).abs())
            };
            radii.push((*name, *colour, greatest(both.map(off).collect(), most)));
            let first = track.phi0.first().zip(moments.first()).map_or(0.0, |(phi0, at)| phi0 - at.phi0);
            let both = track.phi0.iter().zip(moments);
            let turned = both.map(|(phi0, at)| (phi0 - at.phi0 - first).abs());
            turns.push((*name, *colour, greatest(turned.collect(), most)));
        }
        out += &logarithmic("greatest error of a support radius", "m", &radii);
        out += &logarithmic("error of the orientation", "rad", &turns);
    }
    out
}

/// The errors of the thesis, which need no truth.
fn seen_errors(observed: &SlowObserved<'_>) -> String {
    let answers = observed.answers;
    let thesis = answers.thesis.first().map(|(_, found)| found);
    let seen = |name: &'static str, colour: &'static str, values: Option<&Vec<f64>>| {
        values.map(|values| (name, colour, values.iter().map(|x| x.abs()).collect::<Vec<f64>>()))
    };
    let misled = answers.misled.as_ref();
    let force = [
        seen("thesis", "#d55e00", thesis.map(|found| &found.force_error)),
        seen("height 1 % off", "#cc79a7", misled.map(|found| &found.force_error)),
    ];
    let contact = [
        seen("thesis", "#d55e00", thesis.map(|found| &found.contact_error)),
        seen("height 1 % off", "#cc79a7", misled.map(|found| &found.contact_error)),
    ];
    logarithmic("e_f of 3.38", "m", &force.into_iter().flatten().collect::<Vec<_>>())
        + &logarithmic("e_c of 3.39", "m", &contact.into_iter().flatten().collect::<Vec<_>>())
}
