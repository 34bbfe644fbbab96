//! The extremes, as JSON and as tables.

use crate::layout::counted;
use crate::names::{by_default_text, ranges_json};
use crate::stress::plot::{conditioning_picture, lines_picture, ranks_text, scalings_picture};
use palmistry_workbench::tradeoff::stress::{
    Conditioning, First, Line, LineLimit, OnTheSet, Scaling, StressStudy, UnitsRow, Way,
};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;

fn first_json(first: &Option<First>) -> Value {
    first.as_ref().map_or(Value::Null, |first| {
        let First { distance, least, states, said } = first;
        json!({ "distance": distance, "least_distance": least, "states": states, "said": said })
    })
}

/// An object with a field for each way.
fn by_way(of: impl Fn(Way) -> Value) -> Value {
    Way::ALL.iter().map(|way| (way.name().to_owned(), of(*way))).collect::<Map<_, _>>().into()
}

fn line_json(line: &Line) -> Value {
    let end = match &line.end {
        LineLimit::Ranks { ranks, certified } => json!({ "ranks": ranks, "certified": certified }),
        LineLimit::Pole(why) => json!({ "singularity": why }),
        LineLimit::Infinity => json!({ "infinity": true }),
    };
    json!({
        "title": line.title,
        "solved": line.steps,
        "states": line.states,
        "distances": line.distances,
        "true_ranks": line.ranks,
        "certified": line.certified,
        "singularities": line.poles,
        "on_the_set": end,
        "ways": by_way(|way| {
            let found = &line.ways[way.place()];
            json!({
                "first_wrong": first_json(&found.wrong),
                "first_lost_half_its_digits": first_json(&found.lost),
                "first_undecided": first_json(&found.open),
                "first_refused": first_json(&found.refused),
                "on_the_set": {
                    "right": found.on_the_set.right,
                    "wrong": found.on_the_set.wrong,
                    "undecided": found.on_the_set.open,
                    "refused": found.on_the_set.refused,
                },
                "marks": found.marks.iter().map(|mark| mark.map(|m| m.name())).collect::<Vec<_>>(),
                "digits": found.digits,
            })
        }),
    })
}

fn scaling_json(scaling: &Scaling) -> Value {
    json!({
        "quantity": scaling.quantity,
        "exponents": scaling.exponents,
        "ways": by_way(|way| {
            let found = &scaling.ways[way.place()];
            json!({
                "right": found.right.map(|(low, high)| [low, high]),
                "below": found.below,
                "above": found.above,
                "marks": found.marks.iter().map(|mark| mark.map(|m| m.name())).collect::<Vec<_>>(),
            })
        }),
    })
}

fn units_json(row: &UnitsRow) -> Value {
    json!({
        "units": row.name,
        "states": row.states,
        "ways": by_way(|way| {
            let found = row.ways[way.place()];
            json!({
                "wrong": found.wrong,
                "undecided": found.open,
                "refused": found.refused,
                "changed": found.changed,
            })
        }),
    })
}

fn histogram_json(histogram: &BTreeMap<i32, usize>) -> Value {
    let name = |decade: i32| if decade == i32::MAX { "infinite".to_owned() } else { format!("1e{decade}") };
    histogram.iter().map(|(decade, count)| (name(*decade), json!(count))).collect::<Map<_, _>>().into()
}

fn conditioning_json(found: &Conditioning) -> Value {
    json!({
        "states": found.states,
        "rows_of_length_one": histogram_json(&found.old),
        "equilibrated": histogram_json(&found.new),
        "fixed_thresholds": found.thresholds.iter().map(|(threshold, old, new)| json!({
            "part_of_the_largest": threshold,
            "wrong_rows_of_length_one": old,
            "wrong_equilibrated": new,
        })).collect::<Vec<_>>(),
    })
}

fn study_json(study: &StressStudy) -> Value {
    json!({
        "file": study.file,
        "title": study.title,
        "rows": study.rows,
        "dimension": study.dimension,
        "drawn_by_default": ranges_json(&study.by_default),
        "remaining": [study.remaining.0, study.remaining.1],
        "lines": study.lines.iter().map(line_json).collect::<Vec<_>>(),
        "skipped": study.skipped.iter().map(|(title, why)| json!({ "title": title, "why": why })).collect::<Vec<_>>(),
        "scalings": study.scalings.iter().map(scaling_json).collect::<Vec<_>>(),
        "units": study.units.iter().map(units_json).collect::<Vec<_>>(),
        "conditioning": conditioning_json(&study.conditioning),
        "conditioning_near_the_sets": conditioning_json(&study.conditioning_near),
        "interrupted": study.interrupted,
    })
}

/// What was found of some systems, as one object.
pub fn stress_json(studies: &[StressStudy], seed: u64) -> Value {
    json!({
        "seed": seed,
        "studies": studies.iter().map(study_json).collect::<Vec<_>>(),
        "interrupted": studies.iter().any(|study| study.interrupted),
    })
}

/// From which distances on what happens, each with its letter (see [`stress_text`]); `-` where nothing does.
fn cell(line: &Line, way: Way) -> String {
    let found = &line.ways[way.place()];
    let firsts = [('w', &found.wrong), ('d', &found.lost), ('?', &found.open), ('!', &found.refused)];
    let words = firsts.iter().filter_map(|(letter, first)| {
        let First { distance, least, states, .. } = first.as_ref()?;
        let range = if least < distance { format!("..{least:.0e}") } else { String::new() };
        let part =
            if *states < line.states { format!(" at {states}/{}", line.states) } else { String::new() };
        Some(format!("{letter}{distance:.0e}{range}{part}"))
    });
    let words: Vec<String> = words.collect();
    if words.is_empty() { "-".to_owned() } else { words.join(" ") }
}

fn table(head: &str, columns: &[&str], rows: Vec<(String, Vec<String>)>, out: &mut String) {
    let first =
        rows.iter().map(|(name, _)| name.chars().count()).chain([head.chars().count()]).max().unwrap_or(0);
    let widths: Vec<usize> = columns
        .iter()
        .enumerate()
        .map(|(i, name)| rows.iter().map(|(_, cells)| cells[i].len()).chain([name.len()]).max().unwrap_or(0))
        .collect();
    let line = |name: &str, cells: &mut dyn Iterator<Item = &str>, out: &mut String| {
        let _ = write!(out, "  {name:first$}");
        for (cell, width) in cells.zip(&widths) {
            let _ = write!(out, "  {cell:>width$}");
        }
        out.push('\n');
    };
    line(head, &mut columns.iter().copied(), out);
    for (name, cells) in &rows {
        line(name, &mut cells.iter().map(String::as_str), out);
    }
}

fn lines_text(study: &StressStudy, out: &mut String) {
    let mut columns = vec!["rank", "on it"];
    columns.extend(Way::ALL.map(Way::name));
    let rows = study.lines.iter().map(|line| {
        let end = match &line.end {
            LineLimit::Ranks { ranks, .. } => ranks_text(ranks.iter()),
            LineLimit::Pole(_) => "undefined".to_owned(),
            LineLimit::Infinity => "infinite".to_owned(),
        };
        let mut cells = vec![ranks_text(line.ranks.iter()), end];
        cells.extend(Way::ALL.map(|way| cell(line, way)));
        (line.title.chars().take(64).collect(), cells)
    });
    table("into", &columns, rows.collect(), out);
    out.push('\n');
    on_the_sets_text(study, out);
    for (title, why) in &study.skipped {
        let _ = writeln!(out, "  no line: {title}: {why}");
    }
    if !study.lines.iter().all(|line| line.certified) {
        let _ =
            writeln!(out, "  not every true rank is certified: there is no exact arithmetic for these rows");
    }
}

/// How many verdicts are right on the sets themselves: whoever always says "full" is never wrong beside a set, and always wrong here.
fn on_the_sets_text(study: &StressStudy, out: &mut String) {
    let right = |found: &OnTheSet| match found.states() {
        0 => "-".to_owned(),
        states => format!("{}/{states}", found.right),
    };
    let mut all = vec![OnTheSet::default(); Way::ALL.len()];
    let mut rows = Vec::new();
    for line in &study.lines {
        let LineLimit::Ranks { ranks, .. } = &line.end else { continue };
        let mut cells = vec![ranks_text(ranks.iter())];
        for (way, sum) in line.ways.iter().zip(&mut all) {
            cells.push(right(&way.on_the_set));
            sum.add(&way.on_the_set);
        }
        rows.push((line.title.chars().take(64).collect(), cells));
    }
    rows.push((
        "all of them".to_owned(),
        std::iter::once(String::new()).chain(all.iter().map(right)).collect(),
    ));
    let mut columns = vec!["rank"];
    columns.extend(Way::ALL.map(Way::name));
    table("on the set, right at", &columns, rows, out);
}

fn scalings_text(study: &StressStudy, out: &mut String) {
    let rows = study.scalings.iter().map(|scaling| {
        let range = |way: Way| match scaling.ways[way.place()].right {
            Some((low, high)) => format!("{low}..{high}"),
            None => "nowhere".to_owned(),
        };
        (scaling.quantity.clone(), Way::ALL.map(range).to_vec())
    });
    table("exponents of ten", &Way::ALL.map(Way::name), rows.collect(), out);
    for scaling in &study.scalings {
        for way in [Way::Double, Way::DoubleDouble] {
            let found = &scaling.ways[way.place()];
            for (side, said) in [("below", &found.below), ("above", &found.above)] {
                // that rounding has mixed up the sizes needs no line of its own; the JSON has it
                if let Some(said) = said.as_ref().filter(|said| !said.ends_with("rounding")) {
                    let _ = writeln!(out, "  {} {side} that, {}: {said}", scaling.quantity, way.name());
                }
            }
        }
    }
}

fn units_text(study: &StressStudy, out: &mut String) {
    let rows = study.units.iter().map(|row| {
        let count = |way: Way| {
            let found = row.ways[way.place()];
            let mut text = format!("{} ~{}", found.wrong, found.changed);
            if found.open + found.refused > 0 {
                let _ = write!(text, " ({})", found.open + found.refused);
            }
            text
        };
        (row.name.clone(), Way::ALL.map(count).to_vec())
    });
    table("units", &Way::ALL.map(Way::name), rows.collect(), out);
    for (states, found) in [
        ("states of the box", &study.conditioning),
        ("states on the sets and near them", &study.conditioning_near),
    ] {
        conditioning_text(states, found, out);
    }
}

fn conditioning_text(states: &str, found: &Conditioning, out: &mut String) {
    let decades = |histogram: &BTreeMap<i32, usize>| {
        let words = histogram.iter().map(|(decade, count)| match *decade {
            i32::MAX => format!("infinite: {count}"),
            decade => format!("1e{decade}: {count}"),
        });
        words.collect::<Vec<_>>().join(", ")
    };
    let _ = writeln!(out, "  {} {states}; the condition numbers of those of full rank", found.states);
    let _ = writeln!(out, "    rows of length one: {}", decades(&found.old));
    let _ = writeln!(out, "    equilibrated:       {}", decades(&found.new));
    let wrong: Vec<String> = found
        .thresholds
        .iter()
        .map(|(threshold, old, new)| format!("{threshold:.0e}: {old} / {new}"))
        .collect();
    let _ = writeln!(
        out,
        "    wrong ranks by a fixed part of the largest singular value (rows of length one / equilibrated): {}",
        wrong.join(", ")
    );
}

/// What was found, as tables.
pub fn stress_text(studies: &[StressStudy]) -> String {
    let mut out = String::from(
        "Lines: the distance at which a way first reports a wrong rank (w), has lost more than half of an entry's\n\
         digits (d), says that it cannot decide (?), refuses and names why (!), as a range over the states from which\n\
         lines go (at how many of them, where not at all); '-' none of it down to 9e-16.\n\
         Ranks are those of the rows: the file's own, or the Lie derivatives that suffice at generic states. On a set\n\
         that the motion leaves, Lie derivatives of higher order may raise the rank: 'rank --singular-set' says so.\n\
         On the set: at how many of the states on the set itself the verdict is the exact rank of the rows there.\n\
         'always full' looks at nothing. numpy's rule: all rows, of length one and not equilibrated; what exceeds\n\
         max(rows, columns) * 2^-52 of the largest singular value counts.\n\
         Scaling: the exponents of ten within which the rank is right.\n\
         Units: wrong ranks; ~ verdicts that differ from those in the file's units; (n) of no rank, but not wrong.\n",
    );
    for study in studies {
        let (rows, columns) = study.remaining;
        let _ = writeln!(
            out,
            "\n{} ({}): {}, {}, {rows} by {columns} without unit rows",
            study.title,
            study.file,
            counted(study.dimension, "state"),
            study.rows
        );
        if !study.by_default.is_empty() {
            let _ = writeln!(out, "  {}", by_default_text(&study.by_default));
        }
        lines_text(study, &mut out);
        out.push('\n');
        scalings_text(study, &mut out);
        let states = study.units.first().map_or(0, |row| row.states);
        let _ = writeln!(out, "\n  at {} of the box and of the sets", counted(states, "state"));
        units_text(study, &mut out);
        if study.interrupted {
            let _ = writeln!(out, "  interrupted: this is what was finished until then");
        }
    }
    out.trim_end().to_owned()
}

/// The pictures of a system: a name for the file, and the SVG.
pub fn stress_pictures(study: &StressStudy) -> Vec<(String, String)> {
    let path = std::path::Path::new(&study.file);
    let stem = path.file_stem().map_or_else(|| "system".into(), |stem| stem.to_string_lossy().into_owned());
    let mut found = Vec::new();
    if !study.lines.is_empty() {
        found.push((format!("{stem}-lines"), lines_picture(study)));
    }
    if !study.scalings.is_empty() {
        found.push((format!("{stem}-scaling"), scalings_picture(study)));
    }
    if study.conditioning.states > 0 {
        let title = format!("{}: conditioning", study.title);
        found.push((format!("{stem}-conditioning"), conditioning_picture(study, &title)));
    }
    found
}
