//! Pictures of an estimated outline with its band.

use crate::axis::number;
use crate::drawing::{INK, MESH, svg};
use crate::motion::frames::{TRUE_OUTLINE, View};
use palmistry_bodies::mechanics::moving::Shape;
use palmistry_bodies::shape::ShapeEstimate;
use palmistry_scenes::Reconstruction;
use plotters::prelude::*;
use std::f64::consts::TAU;

/// Twice the size in which they are shown.
const SIZE: (u32, u32) = (800, 720);

/// Normals of a curve.
const NORMALS: usize = 720;

/// The band, where it was touched and where not, and the outline.
const BAND: RGBAColor = RGBAColor(0, 114, 178, 0.3);
const UNTOUCHED: RGBAColor = RGBAColor(200, 170, 80, 0.3);
const OUTLINE: RGBColor = RGBColor(0, 114, 178);
const ERROR: RGBColor = RGBColor(213, 94, 0);

fn angle(i: usize) -> f64 {
    TAU * i as f64 / NORMALS as f64
}

/// By what round factor a band is drawn wider than it is, so that it is visible: not wider than a twelfth of the radius.
fn magnification(shape: &ShapeEstimate, counts: impl Fn(f64) -> bool) -> f64 {
    let widest =
        (0..NORMALS).map(angle).filter(|angle| counts(*angle)).map(|angle| 2.0 * shape.deviation(angle));
    let widest = widest.fold(0.0, f64::max);
    let most = shape.support.mean() / 12.0 / widest;
    if !(most.is_finite() && most > 1.0) {
        return 1.0;
    }
    let power = 10f64.powf(most.log10().floor());
    [5.0, 2.0].into_iter().map(|k| k * power).find(|factor| *factor <= most).unwrap_or(power)
}

/// How far the edge of a band is drawn from its outline, in m: an infinite band, as in a gap of half a turn, does not fill the page, and the outline within is
/// where it is.
fn drawn(band: f64, mean: f64) -> f64 {
    band.min(0.3 * mean.abs())
}

/// The outline in the frame of the body, with the band by how many times it is drawn wider.
pub(super) fn outline_picture(
    found: &Reconstruction,
    shape: &ShapeEstimate,
    truth: Option<&Shape>,
) -> (String, f64) {
    let covered = |angle: f64| found.coverage.contains(angle);
    let magnified = magnification(shape, covered);
    let band = |angle: f64| shape.band(&found.coverage, angle);
    let place = |i: usize, off: f64| {
        let (angle, [x, y]) = (angle(i), shape.support.point(angle(i)));
        let wider = if covered(angle) { magnified } else { 1.0 };
        let off = off * drawn(band(angle) * wider, shape.support.mean());
        [x + off * angle.cos(), y + off * angle.sin()]
    };
    let sides: Vec<[f64; 2]> = truth.map(|shape| shape.outline(NORMALS)).unwrap_or_default();
    let everywhere = (0..NORMALS).flat_map(|i| [place(i, 1.0), place(i, -1.0)]).chain(sides.iter().copied());
    let view = View::of(everywhere, (f64::from(SIZE.0) - 120.0, f64::from(SIZE.1) - 160.0));
    let pixel = |place: [f64; 2]| view.pixel(place, (60.0, 90.0));
    let picture = svg(SIZE, "the outline with its band", |area| {
        let words = ("sans-serif", 28).into_font().color(&INK);
        area.draw(&Text::new("the outline, and its band", (20, 10), words))?;
        for (is_touched, colour) in [(true, BAND), (false, UNTOUCHED)] {
            for run in runs(|i| covered(angle(i)) == is_touched) {
                let out = run.iter().map(|i| pixel(place(*i, 1.0)));
                let back = run.iter().rev().map(|i| pixel(place(*i, -1.0)));
                area.draw(&Polygon::new(out.chain(back).collect::<Vec<_>>(), colour.filled()))?;
            }
        }
        let closed =
            |points: Vec<(i32, i32)>| points.first().copied().map(|first| [points, vec![first]].concat());
        if let Some(points) = closed(sides.iter().map(|place| pixel(*place)).collect()) {
            area.draw(&PathElement::new(points, TRUE_OUTLINE.stroke_width(7)))?;
        }
        if let Some(points) = closed((0..NORMALS).map(|i| pixel(place(i, 0.0))).collect()) {
            area.draw(&PathElement::new(points, OUTLINE.stroke_width(3)))?;
        }
        area.draw(&Circle::new(pixel([0.0; 2]), 8, INK.filled()))?;
        Ok(())
    });
    (picture, magnified)
}

/// The runs of neighbouring normals that count, each with the normal after its last, so that runs meet.
fn runs(counts: impl Fn(usize) -> bool) -> Vec<Vec<usize>> {
    let mut runs: Vec<Vec<usize>> = Vec::new();
    let mut run: Vec<usize> = Vec::new();
    for i in 0..NORMALS {
        if counts(i) {
            run.push(i);
        } else if !run.is_empty() {
            run.push(i);
            runs.push(std::mem::take(&mut run));
        }
    }
    if !run.is_empty() {
        run.push(0);
        runs.push(run);
    }
    runs
}

/// The band over the angle of the normal, in a convenient unit, and the error in it where the truth is known.
pub(super) fn band_picture(found: &Reconstruction, shape: &ShapeEstimate, truth: Option<&Shape>) -> String {
    let covered = |angle: f64| found.coverage.contains(angle);
    let band = |angle: f64| shape.band(&found.coverage, angle);
    let off = |angle: f64| truth.map(|truth| shape.support.support(angle)[0] - truth.support(angle)[0]);
    let angles = || (0..=NORMALS).map(angle);
    let touched = angles().filter(|angle| covered(*angle));
    let largest = touched.map(|angle| band(angle).max(off(angle).map_or(0.0, f64::abs))).fold(0.0, f64::max);
    let largest = if largest > 0.0 && largest.is_finite() { largest } else { shape.support.mean() };
    let (unit, size) = match largest {
        m if m < 1e-6 => ("nm", 1e-9),
        m if m < 1e-3 => ("µm", 1e-6),
        m if m < 1.0 => ("mm", 1e-3),
        _ => ("m", 1.0),
    };
    let high = 1.3 * largest / size;
    svg(SIZE, "the band over the angle of the normal", |area| {
        let (top, plot) = area.split_vertically(60);
        let words = ("sans-serif", 28).into_font().color(&INK);
        top.draw(&Text::new("band of the support radius", (20, 10), words))?;
        let mut chart = ChartBuilder::on(&plot)
            .margin(16)
            .margin_right(30)
            .x_label_area_size(70)
            .y_label_area_size(120)
            .build_cartesian_2d(0.0..360.0, -high..high)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(MESH)
            .x_labels(7)
            .y_labels(7)
            .label_style(("sans-serif", 24).into_font().color(&INK))
            .x_label_formatter(&|v| number(*v, 360.0))
            .y_label_formatter(&|v| number(*v, 2.0 * high))
            .x_desc("angle of the normal, degrees")
            .y_desc(format!("radius, {unit}"))
            .axis_desc_style(("sans-serif", 24))
            .draw()?;
        for (is_touched, colour) in [(true, BAND), (false, UNTOUCHED)] {
            for run in runs(|i| covered(angle(i)) == is_touched) {
                let edge = |i: &usize, last: bool, sign: f64| {
                    // the run's last normal may be the first of the next turn
                    let degrees = if last && *i == 0 { 360.0 } else { angle(*i).to_degrees() };
                    (degrees, (sign * band(angle(*i)) / size).clamp(-high, high))
                };
                let count = run.len();
                let upper = run.iter().enumerate().map(|(n, i)| edge(i, n + 1 == count, 1.0));
                let lower = run.iter().enumerate().rev().map(|(n, i)| edge(i, n + 1 == count, -1.0));
                let corners: Vec<(f64, f64)> = upper.chain(lower).collect();
                chart.draw_series([Polygon::new(corners, colour.filled())])?;
            }
        }
        let errors: Vec<(f64, f64)> = angles()
            .filter_map(|angle| Some((angle.to_degrees(), (off(angle)? / size).clamp(-high, high))))
            .collect();
        if !errors.is_empty() {
            chart.draw_series(LineSeries::new(errors, ERROR.stroke_width(4)))?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::drawn;

    #[test]
    fn a_band_without_an_end_is_drawn_about_its_outline() {
        assert_eq!(drawn(0.1, 2.0), 0.1);
        assert_eq!(drawn(f64::INFINITY, 2.0), 0.6);
        // an outline is where its band has no width
        assert_eq!(0.0 * drawn(f64::INFINITY, 2.0), 0.0);
    }
}
