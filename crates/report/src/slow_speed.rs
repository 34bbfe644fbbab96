//! Speed against accuracy of all ways to a slow body's shape, as a picture: a mark a row of a study, lines over the numbers of samples.

use crate::layout::counted;
use palmistry_scenes::slow::{StudyRow, WayTally, median_and_worst};
use std::fmt::Write;

/// All ways of a row, by their names.
pub(super) fn ways_of(row: &StudyRow) -> [(&'static str, &WayTally); 5] {
    let [own, dopri5, dop853] = &row.thesis;
    [
        ("thesis, true radii", own),
        ("thesis by Dopri5, true radii", dopri5),
        ("thesis by Dop853, true radii", dop853),
        ("quadrature, true height", &row.quadrature),
        ("all at once, nothing known", &row.together),
    ]
}

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 450.0;

/// Where the diagram ends: left, right, top, bottom.
const FRAME: [f64; 4] = [56.0, 624.0, 30.0, 330.0];

/// In the order of the ways.
const COLOURS: [&str; 5] = ["#d55e00", "#e69f00", "#cc79a7", "#009e73", "#0072b2"];

/// A row of the study as a point, by logarithms.
struct Mark<'a> {
    row: &'a StudyRow,
    way: usize,
    seconds: f64,
    error: f64,
}

/// The marks that lie on one line: all but the number of samples is the same.
fn is_same_line(a: &Mark<'_>, b: &Mark<'_>) -> bool {
    let key = |mark: &Mark<'_>| (mark.way, mark.row.family, mark.row.resolution.to_bits(), mark.row.order);
    key(a) == key(b)
}

fn marks(rows: &[StudyRow]) -> (Vec<Mark<'_>>, usize) {
    let (mut marks, mut missing) = (Vec::new(), 0);
    for row in rows.iter().filter(|row| row.bodies > 0) {
        for (place, (_, way)) in ways_of(row).into_iter().enumerate() {
            let seconds = way.seconds / row.bodies as f64;
            let error = median_and_worst(&way.radius).map_or(f64::INFINITY, |[median, _]| median);
            if seconds > 0.0 && error > 0.0 && error.is_finite() {
                marks.push(Mark { row, way: place, seconds: seconds.log10(), error: error.log10() });
            } else if error.is_infinite() {
                missing += 1;
            }
        }
    }
    (marks, missing)
}

/// Whole decades about all values.
fn decades(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] =
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |ends, x| [ends[0].min(x), ends[1].max(x)]);
    [low.floor(), high.ceil().max(low.floor() + 1.0)]
}

/// A mark of a family, about the origin.
fn form(family: usize) -> &'static str {
    [
        "M-4,0a4,4 0 1 0 8,0a4,4 0 1 0 -8,0Z",
        "M-3.6,-3.6h7.2v7.2h-7.2Z",
        "M0,-5L5,0L0,5L-5,0Z",
        "M0,-4.6L4.6,3.6H-4.6Z",
    ][family % 4]
}

/// The median error of a radius over the mean one against the processor's seconds a body. Nothing where no row has a time.
pub(super) fn speed(rows: &[StudyRow]) -> String {
    let (marks, missing) = marks(rows);
    if marks.is_empty() {
        return String::new();
    }
    let [left, right, top, bottom] = FRAME;
    let (x, y) =
        (decades(marks.iter().map(|mark| mark.seconds)), decades(marks.iter().map(|mark| mark.error)));
    let across = |at: f64| left + (right - left) * (at - x[0]) / (x[1] - x[0]);
    let up = |at: f64| bottom - (bottom - top) * (at - y[0]) / (y[1] - y[0]);
    let mut families = Vec::new();
    rows.iter().for_each(|row| {
        if !families.contains(&row.family) {
            families.push(row.family);
        }
    });
    let mut out = format!(
        "<svg role=\"img\" aria-label=\"Speed against accuracy\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\"><text x=\"{}\" y=\"16\" font-size=\"13\" text-anchor=\"middle\" fill=\"currentColor\">median error of a radius over its mean, against seconds of the processor a body</text>",
        WIDTH / 2.0
    );
    for decade in x[0] as i32..=x[1] as i32 {
        let at = across(f64::from(decade));
        let _ = write!(
            out,
            "<path d=\"M{at:.1},{top}V{bottom}\" stroke=\"currentColor\" stroke-opacity=\"0.15\"/><text x=\"{at:.1}\" y=\"{}\" font-size=\"10\" text-anchor=\"middle\" fill=\"currentColor\">1e{decade} s</text>",
            bottom + 14.0
        );
    }
    for decade in (y[0] as i32..=y[1] as i32).step_by(2) {
        let at = up(f64::from(decade));
        let _ = write!(
            out,
            "<path d=\"M{left},{at:.1}H{right}\" stroke=\"currentColor\" stroke-opacity=\"0.15\"/><text x=\"{}\" y=\"{:.1}\" font-size=\"10\" text-anchor=\"end\" fill=\"currentColor\">1e{decade}</text>",
            left - 4.0,
            at + 3.0
        );
    }
    for (i, first) in marks.iter().enumerate() {
        if marks[..i].iter().any(|mark| is_same_line(mark, first)) {
            continue;
        }
        let mut line: Vec<&Mark<'_>> = marks.iter().filter(|mark| is_same_line(mark, first)).collect();
        line.sort_by_key(|mark| mark.row.samples);
        if line.len() > 1 {
            let points: Vec<String> = line
                .iter()
                .map(|mark| format!("{:.1},{:.1}", across(mark.seconds), up(mark.error)))
                .collect();
            let _ = write!(
                out,
                "<path d=\"M{}\" fill=\"none\" stroke=\"{}\" stroke-opacity=\"0.5\"/>",
                points.join("L"),
                COLOURS[first.way]
            );
        }
    }
    for mark in &marks {
        let Mark { row, way, .. } = mark;
        let order = row.order.map_or_else(String::new, |order| format!(", order {order}"));
        let family = families.iter().position(|family| *family == row.family).unwrap_or(0);
        let fill = if row.resolution > 0.0 { "none" } else { COLOURS[*way] };
        let _ = write!(
            out,
            "<path d=\"{}\" transform=\"translate({:.1},{:.1})\" fill=\"{fill}\" stroke=\"{}\" pointer-events=\"all\"><title>{}: {}, {} samples, resolution {} m{order}</title></path>",
            form(family),
            across(mark.seconds),
            up(mark.error),
            COLOURS[*way],
            ways_of(row)[*way].0,
            row.family.name(),
            row.samples,
            row.resolution
        );
    }
    out += &legend(rows, &families.iter().map(|family| family.name()).collect::<Vec<_>>(), missing);
    out.push_str("</svg>");
    out
}

/// What colours, forms and fillings mean, and what is not drawn.
fn legend(rows: &[StudyRow], families: &[&str], missing: usize) -> String {
    let mut out = String::new();
    for (place, (name, _)) in rows.first().map(ways_of).into_iter().flatten().enumerate() {
        let (x, y) = (left_of(place % 3), 366.0 + 16.0 * (place / 3) as f64);
        let _ = write!(
            out,
            "<text x=\"{x}\" y=\"{y}\" font-size=\"11\" fill=\"{}\">{name}</text>",
            COLOURS[place]
        );
    }
    for (place, name) in families.iter().enumerate() {
        let (x, y) = (FRAME[0] + 120.0 * place as f64, 400.0);
        let _ = write!(
            out,
            "<path d=\"{}\" transform=\"translate({},{y})\" fill=\"currentColor\"/><text x=\"{}\" y=\"{}\" font-size=\"11\" fill=\"currentColor\">{name}</text>",
            form(place),
            x + 4.0,
            x + 14.0,
            y + 4.0
        );
    }
    let mut last =
        vec!["filled: exact measurements, hollow: rounded; lines join numbers of samples".to_owned()];
    if missing > 0 {
        last.push(format!("not drawn: {} of a way that stopped on most bodies", counted(missing, "row")));
    }
    for (line, text) in last.into_iter().enumerate() {
        let _ = write!(
            out,
            "<text x=\"{}\" y=\"{}\" font-size=\"11\" fill=\"currentColor\">{text}</text>",
            FRAME[0],
            424.0 + 16.0 * line as f64
        );
    }
    out
}

/// Where a column of the legend begins.
fn left_of(column: usize) -> f64 {
    FRAME[0] + 195.0 * column as f64
}
