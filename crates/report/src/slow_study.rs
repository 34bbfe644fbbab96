//! What a study of slow motion over many bodies found: text, JSON, a section of the page.

use crate::layout::{counted, counted_in};
use crate::slow_speed::{speed, ways_of};
use maud::{Markup, PreEscaped, html};
use palmistry_scenes::slow::{JumpTally, StudyRow, WayTally, median_and_worst};
use serde_json::{Value, json};
use std::fmt::Write;

/// Beside each other what stands in the table of a study: of the bodies over which the way came to its end, and how many those are that are not among them.
fn tally(way: &WayTally) -> [String; 2] {
    let stopped = match way.stopped() {
        0 => String::new(),
        some => format!(", stopped on {some} of {}", way.radius.len()),
    };
    [&way.radius, &way.phi0].map(|values| {
        let ended: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
        match median_and_worst(&ended) {
            Some([median, worst]) => format!("{median:.1e} ({worst:.1e}){stopped}"),
            None => format!("-{stopped}"),
        }
    })
}

/// The rows of a study by the number of jumps, as text.
fn jump_tallies(row: &StudyRow) -> Vec<String> {
    let one = |(jumps, at): (&usize, &JumpTally)| {
        format!(
            "with {}: {}, the whole outline of {}, every jump in its place in {}; descent leads to {} of {}; {} explained, {} with a jump that never happened, {} with one that was missed",
            counted(*jumps, "jump"),
            counted(at.runs, "run"),
            at.recovered,
            at.located,
            at.predicted[1],
            counted(at.predicted[0], "jump"),
            counted(at.explained, "run"),
            at.false_jumps,
            at.missed
        )
    };
    row.jumps.iter().map(one).collect()
}

/// What a row of a study is of.
fn row_in_words(row: &StudyRow) -> String {
    let order = row.order.map_or_else(String::new, |order| format!(", order {order}"));
    format!(
        "{} {}, resolution {} m{order}",
        row.family.name(),
        counted(row.samples, "sample"),
        row.resolution
    )
}

/// Bodies that were drawn and do not count, as text.
fn passed_over(row: &StudyRow) -> String {
    let why = if row.jumps.is_empty() { "jumped" } else { "did not jump as often as is asked" };
    let ended = match row.asked.saturating_sub(row.bodies) {
        0 => String::new(),
        missing => {
            let missing = counted_in(missing, "body", "bodies");
            format!("; it ended {missing} before the {} that were asked for", row.asked)
        }
    };
    format!("{} {why}{ended}", row.jumped)
}

/// As text.
pub(super) fn study_text(rows: &[StudyRow]) -> String {
    let mut out = String::new();
    for row in rows {
        let _ = writeln!(
            out,
            "{}: {} of {} recovered, {}, {}",
            row_in_words(row),
            row.recovered,
            row.bodies,
            counted(row.silent, "silent failure"),
            passed_over(row)
        );
        for line in jump_tallies(row) {
            let _ = writeln!(out, "  {line}");
        }
        if let Some([median, worst]) = median_and_worst(&row.outline) {
            let _ = writeln!(out, "  outline: median {median:.2e} m, worst {worst:.2e} m");
        }
        for (name, way) in ways_of(row) {
            let [radius, phi0] = tally(way);
            let each = way.seconds / row.bodies.max(1) as f64;
            let _ = writeln!(out, "  {name}: radius {radius}, phi0 {phi0} rad, {each:.1e} s");
        }
    }
    out
}

/// A number, or null where it is none.
pub(super) fn number(x: f64) -> Value {
    if x.is_finite() { json!(x) } else { Value::Null }
}

/// As JSON.
pub(super) fn study_json(rows: &[StudyRow]) -> Vec<Value> {
    rows.iter().map(|row| {
        let ways = ways_of(row).map(|(name, way)| {
            let each = |values: &[f64]| values.iter().map(|x| number(*x)).collect::<Vec<_>>();
            json!({ "name": name, "radius_errors": each(&way.radius), "phi0_errors": each(&way.phi0), "seconds": way.seconds })
        });
        json!({
            "family": row.family.name(),
            "samples": row.samples,
            "resolution": row.resolution,
            "bodies": row.bodies,
            "asked": row.asked,
            "order": row.order,
            "jumped": row.jumped,
            "jumps": row.jumps.iter().map(|(jumps, at)| {
                json!({ "jumps": jumps, "runs": at.runs, "recovered": at.recovered, "located": at.located, "found": at.predicted[0], "predicted": at.predicted[1], "explained": at.explained, "false_jumps": at.false_jumps, "missed": at.missed })
            }).collect::<Vec<_>>(),
            "recovered": row.recovered,
            "silent": row.silent,
            "outline_errors": row.outline.iter().map(|x| number(*x)).collect::<Vec<_>>(),
            "ways": ways,
        })
    })
    .collect()
}

/// The section of the page.
pub(super) fn study_section(rows: &[StudyRow]) -> Markup {
    html! {
        p { "Medians over all bodies, the worst in brackets; errors of a support radius in parts of the mean radius, of the orientation in rad, over the bodies on which the way came to the last sample. Seconds are those of the processor." }
        table {
            thead { tr {
                th { "family" } th { "samples" } th { "resolution" } th { "order" } th { "way" } th { "radius" } th { "phi0" } th { "s a body" }
            } }
            tbody {
                @for row in rows {
                    @for (name, way) in ways_of(row) {
                        @let [radius, phi0] = tally(way);
                        tr {
                            td { (row.family.name()) } td { (row.samples) } td { (row.resolution) " m" } td { (row.order.map_or_else(|| "chosen".to_owned(), |order| order.to_string())) } td { (name) }
                            td { (radius) } td { (phi0) } td { (format!("{:.1e}", way.seconds / row.bodies.max(1) as f64)) }
                        }
                    }
                }
            }
        }
        @for row in rows {
            p {
                (row_in_words(row)) ": "
                b { (row.recovered) " of " (row.bodies) " recovered, " (counted(row.silent, "silent failure")) }
                "; " (passed_over(row))
                @if let Some([median, worst]) = median_and_worst(&row.outline) {
                    "; greatest error of the outline: median " (format!("{median:.1e} m, worst {worst:.1e} m"))
                }
                "."
                @for line in jump_tallies(row) { br; (line) }
            }
        }
        (PreEscaped(speed(rows)))
    }
}
