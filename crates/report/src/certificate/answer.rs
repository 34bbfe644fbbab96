//! Certificates on regions, as JSON and as text.

use crate::layout::{counted, counted_in};
use crate::names::{by_default_text, fields_json, fields_text, ranges_json};
use dashu::rational::RBig;
use palmistry_math::number::rational_from_f64;
use palmistry_prove::certificate::{BoxStanding, OpenBox, PartAnswer, RegionAnswer, Vanishing};
use palmistry_rank::observability::AVOIDED;
use serde_json::{Value, json};
use std::fmt::Write;

fn standing_word(standing: BoxStanding) -> &'static str {
    match standing {
        BoxStanding::Proved => "proved",
        BoxStanding::MinorVanishes => "minor vanishes",
        BoxStanding::Pole => "singularity",
        BoxStanding::Undecided => "undecided",
    }
}

fn vanishing_json(vanishing: &Vanishing) -> Value {
    json!({
        "factor": vanishing.factor,
        "minor": vanishing.minor,
        "boxes": vanishing.boxes,
        "fraction": vanishing.fraction,
    })
}

fn part_json(part: &PartAnswer) -> Value {
    json!({
        "coordinates": part.coordinates,
        "not_zero_to_be_defined": part.guards,
        "not_zero": part.common,
        "minors_to_choose_from": part.alternatives,
        "proved_fraction": part.proved,
        "boxes": part.boxes,
        "open_boxes": part.open_boxes,
        "vanishing": part.vanishing.iter().map(vanishing_json).collect::<Vec<_>>(),
    })
}

fn open_json(open: &OpenBox) -> Value {
    let ranges: serde_json::Map<String, Value> =
        open.ranges.iter().map(|range| (range.name.clone(), json!([range.low, range.high]))).collect();
    json!({
        "box": ranges,
        "status": standing_word(open.standing),
        "factor": open.factor,
        "avoided": open.avoided,
        "fraction": open.fraction,
    })
}

/// An answer as one object. Fractions are of the volume of the box; what is proved is rounded down.
pub fn region_json(answer: &RegionAnswer) -> Value {
    let free = answer.ranges.iter().filter(|(_, matters)| *matters);
    let idle = answer.ranges.iter().filter(|(_, matters)| !*matters);
    json!({
        "file": answer.file,
        "title": answer.title,
        "fields": fields_json(&answer.fields),
        "dimension": answer.dimension,
        "order": answer.order,
        "rows": answer.rows,
        "columns": answer.columns,
        "proved_fraction": answer.proved,
        "proved_fraction_of_sampled": answer.proved_of_sampled,
        "minor_vanishes_fraction": answer.minor_vanishes,
        "open_fraction": answer.rest,
        "boxes": answer.boxes,
        "open_boxes": answer.open_boxes,
        "finished": answer.finished,
        "seconds": answer.seconds,
        "free_coordinates": free
            .map(|(c, _)| json!({ "name": c.name, "low": c.low.to_string(), "high": c.high.to_string() }))
            .collect::<Vec<_>>(),
        "drawn_by_default": ranges_json(&answer.by_default),
        "without_effect": idle.map(|(c, _)| c.name.clone()).collect::<Vec<_>>(),
        "avoided": { "expressions": answer.avoid, "distance": AVOIDED },
        "minors": answer.minors.iter().map(|minor| json!({ "rows": minor.rows, "factors": minor.factors })).collect::<Vec<_>>(),
        "minors_looked_at": answer.candidates,
        "these_are_all_minors": answer.all_minors,
        "parts": answer.parts.iter().map(part_json).collect::<Vec<_>>(),
        "largest_open_boxes": answer.largest.iter().map(open_json).collect::<Vec<_>>(),
        "curve": answer.curve.iter().map(|p| json!({ "boxes": p.boxes, "seconds": p.seconds, "proved_fraction": p.proved })).collect::<Vec<_>>(),
        "remarks": answer.remarks,
        "holds_nowhere": answer.nowhere,
    })
}

/// A fraction in percent, rounded down, with as many digits as it takes to distinguish it from all.
pub fn percent(fraction: f64) -> String {
    if fraction >= 1.0 {
        return "100%".to_owned();
    }
    let missing = (100.0 * (1.0 - fraction)).log10();
    let digits = (-missing).ceil().clamp(2.0, 12.0) as usize;
    let scale = 10u64.pow(digits as u32);
    // a double is a rational number: the last digit is decided exactly
    let whole = rational_from_f64(fraction).unwrap_or(RBig::ZERO) * RBig::from(100) * RBig::from(scale);
    let steps = whole.floor().to_f64().value().max(0.0);
    format!("{:.digits$}%", steps / scale as f64)
}

/// An answer as text.
pub fn region_text(answer: &RegionAnswer) -> String {
    let mut out = format!("{}: {}", answer.title, counted(answer.dimension, "state"));
    match answer.order {
        Some(order) => {
            let _ = writeln!(out, ", Lie derivatives up to order {order} ({})", fields_text(&answer.fields));
        }
        None => out.push_str(", the file's own choice of rows\n"),
    }
    if !answer.nowhere.is_empty() {
        let guards: Vec<String> = answer.nowhere.iter().map(|guard| shortened(guard)).collect();
        let _ = writeln!(
            out,
            "nothing is proved: the system or its rows are defined nowhere, since {} would have to hold",
            guards.join(" and ")
        );
        return out.trim_end().to_owned();
    }
    if answer.minors.is_empty() {
        let _ = writeln!(
            out,
            "no minor of full size was found that is not identically zero: nothing can be proved with these rows"
        );
        for remark in &answer.remarks {
            let _ = writeln!(out, "  {remark}");
        }
        return out.trim_end().to_owned();
    }
    if !answer.by_default.is_empty() {
        let _ = writeln!(out, "{}", by_default_text(&answer.by_default));
    }
    let _ = writeln!(out, "full rank is proved on {} of the volume of the box", percent(answer.proved));
    if !answer.avoid.is_empty() {
        let _ = writeln!(
            out,
            "  and on {} of what is further than {AVOIDED} from {} = 0",
            percent(answer.proved_of_sampled),
            answer.avoid.join(" = 0, ")
        );
    }
    let _ = writeln!(
        out,
        "  a minor is proved to vanish somewhere in boxes of {:.2e} of it; {:.2e} is undecided, or has a singularity in it",
        answer.minor_vanishes, answer.rest
    );
    let names = |matter: bool| -> Vec<&str> {
        let chosen = answer.ranges.iter().filter(|(_, matters)| *matters == matter);
        chosen.map(|(c, _)| c.name.as_str()).collect()
    };
    let _ = writeln!(out, "{}: {}", counted(names(true).len(), "free coordinate"), names(true).join(", "));
    if !names(false).is_empty() {
        let _ = writeln!(out, "  nothing depends on {}", names(false).join(", "));
    }
    let all = if answer.all_minors { "all" } else { "more than" };
    let _ = writeln!(
        out,
        "{}, chosen from {all} {}; zeros where the rows are defined:",
        counted(answer.minors.len(), "minor"),
        answer.candidates
    );
    for minor in &answer.minors {
        let _ = writeln!(out, "  {}", minor.rows.join(", "));
        for factor in &minor.factors {
            let _ = writeln!(out, "    vanishes where {} = 0", shortened(factor));
        }
    }
    for part in answer.parts.iter().filter(|part| !part.coordinates.is_empty()) {
        let _ = writeln!(
            out,
            "in {}: {} proved, {}, {} of them open",
            part.coordinates.join(", "),
            percent(part.proved),
            counted_in(part.boxes, "box", "boxes"),
            part.open_boxes
        );
        for vanishing in &part.vanishing {
            let what = if vanishing.minor.is_some() { "a minor vanishes" } else { "a singularity lies" };
            let _ = writeln!(
                out,
                "  {what} in {} of {:.2e}: {} = 0",
                counted_in(vanishing.boxes, "box", "boxes"),
                vanishing.fraction,
                shortened(&vanishing.factor)
            );
        }
    }
    for remark in &answer.remarks {
        let _ = writeln!(out, "{remark}");
    }
    let finished = if answer.finished { ", and nothing is left to halve" } else { "" };
    let time = if answer.seconds.is_nan() { String::new() } else { format!(" in {:.2} s", answer.seconds) };
    let _ = write!(out, "{}{time}{finished}", counted_in(answer.boxes, "box", "boxes"));
    out
}

/// Long factors are cut in text; JSON has them whole.
const LONGEST: usize = 90;

fn shortened(factor: &str) -> String {
    if factor.chars().count() <= LONGEST {
        return factor.to_owned();
    }
    factor.chars().take(LONGEST).chain("...".chars()).collect()
}

#[cfg(test)]
mod tests {
    use crate::certificate::percent;

    #[test]
    fn percents_are_rounded_down() {
        assert_eq!(percent(0.999_987_654), "99.998%");
        // 1 - 2^-20 is 0.99999904632568359375 exactly
        assert_eq!(percent(1.0 - 2f64.powi(-20)), "99.99990%");
        assert_eq!(percent(1.0 - 2f64.powi(-29)), "99.9999998%");
        assert_eq!(percent(0.5), "50.00%");
        assert_eq!(percent(2.0 / 3.0), "66.66%");
        assert_eq!(percent(1.0), "100%");
        assert_eq!(percent(0.0), "0.00%");
    }
}
