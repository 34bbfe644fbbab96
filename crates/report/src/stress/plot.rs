//! Pictures of the extremes: for every set and every way a bar from far to near, coloured by what its verdict is worth.

use crate::drawing::{INK, MESH, SOFT, svg};
use palmistry_workbench::tradeoff::stress::{LineLimit, Mark, StressStudy, Way};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::collections::BTreeMap;
use std::ops::Range;

/// Colours that all eyes distinguish: from blue over yellow to red, greys for what is not said.
fn colour(mark: Option<Mark>) -> RGBColor {
    match mark {
        Some(Mark::Right) => RGBColor(120, 170, 220),
        Some(Mark::Lost) => RGBColor(250, 215, 90),
        Some(Mark::Open) => RGBColor(222, 226, 231),
        Some(Mark::Refused) => RGBColor(120, 126, 135),
        Some(Mark::Wrong) => RGBColor(200, 40, 60),
        None => WHITE,
    }
}

const LEGEND: [(Mark, &str); 5] = [
    (Mark::Right, "right"),
    (Mark::Lost, "right, half of the digits lost"),
    (Mark::Open, "cannot tell"),
    (Mark::Refused, "refused, and named"),
    (Mark::Wrong, "wrong rank"),
];

/// A row of the chart: its title, what is below it, and the marks of each way.
struct Bars<'a> {
    title: String,
    below: Vec<String>,
    marks: Vec<&'a [Option<Mark>]>,
}

impl Bars<'_> {
    /// Nothing happens to any way: one bar says it.
    fn is_calm(&self) -> bool {
        self.marks.iter().all(|marks| marks.iter().all(|mark| matches!(mark, Some(Mark::Right))))
    }

    /// The ways to which something happens, and one bar for those to which nothing does.
    fn ways(&self) -> Vec<(&'static str, &[Option<Mark>])> {
        let is_right = |marks: &&[Option<Mark>]| marks.iter().all(|mark| matches!(mark, Some(Mark::Right)));
        let named = Way::ALL.iter().zip(&self.marks).map(|(way, marks)| (way.name(), *marks));
        let mut found: Vec<_> = named.filter(|(_, marks)| !is_right(marks)).collect();
        if let Some(marks) = self.marks.iter().find(|marks| is_right(marks)) {
            found.push((if found.is_empty() { "all of them" } else { "all others" }, marks));
        }
        found
    }

    /// Its title, in as many lines as it needs.
    fn titles(&self) -> Vec<String> {
        in_lines(&self.title, 54)
    }

    /// What stands below the title, line by line: nothing where nothing happens.
    fn remarks(&self) -> Vec<String> {
        let below = self.below.iter().filter(|_| !self.is_calm());
        below.flat_map(|text| in_lines(text, 60)).collect()
    }

    /// What is written over the bars.
    fn head(&self) -> i32 {
        3 + 15 * (self.titles().len() + self.remarks().len()) as i32
    }

    fn height(&self) -> i32 {
        self.head() + BAR * self.ways().len() as i32 + 10
    }
}

const BAR: i32 = 13;
const LEFT: i32 = 134;
const WIDTH: i32 = 400;
const RIGHT: i32 = WIDTH - 14;
const TOP: i32 = 84;

/// The chart of some rows; `ticks` are texts at parts of the width between zero and one.
fn bars(title: &str, axis: &str, ticks: &[(f64, String)], rows: &[Bars<'_>]) -> String {
    let titles = in_lines(title, 50);
    let down = 17 * (titles.len() as i32 - 1);
    let bottom = TOP + down + rows.iter().map(Bars::height).sum::<i32>();
    svg((WIDTH as u32, (bottom + 44) as u32), title, |area| {
        let text = |size: i32| ("sans-serif", size).into_font().color(&INK);
        let anchored = |size: i32, h: HPos| text(size).pos(Pos::new(h, VPos::Center));
        for (line, title) in titles.iter().enumerate() {
            area.draw(&Text::new(title.clone(), (8, 6 + 17 * line as i32), text(13)))?;
        }
        let (mut x, mut y) = (8, 34 + down);
        for (mark, words) in LEGEND {
            let width = 26 + 6 * words.len() as i32;
            if x + width > RIGHT {
                (x, y) = (8, y + 17);
            }
            area.draw(&Rectangle::new([(x, y - 5), (x + 12, y + 6)], colour(Some(mark)).filled()))?;
            area.draw(&Text::new(words, (x + 16, y), anchored(11, HPos::Left)))?;
            x += width;
        }
        for (part, label) in ticks {
            let x = LEFT + (f64::from(RIGHT - LEFT) * part).round() as i32;
            area.draw(&PathElement::new([(x, TOP + down - 4), (x, bottom)], MESH))?;
            area.draw(&Text::new(label.clone(), (x, bottom + 10), anchored(11, HPos::Center)))?;
        }
        let middle = ((LEFT + RIGHT) / 2, bottom + 30);
        area.draw(&Text::new(axis.to_owned(), middle, anchored(12, HPos::Center)))?;
        let mut next = TOP + down;
        for row in rows {
            let (top, first) = (next, next + row.head());
            next += row.height();
            let titles = row.titles();
            for (line, title) in titles.iter().enumerate() {
                area.draw(&Text::new(title.clone(), (8, top + 2 + 15 * line as i32), text(12)))?;
            }
            for (line, below) in row.remarks().into_iter().enumerate() {
                let style = ("sans-serif", 11).into_font().color(&SOFT);
                let line = (titles.len() + line) as i32;
                area.draw(&Text::new(below, (8, top + 2 + 15 * line), style))?;
            }
            for (place, (way, marks)) in row.ways().into_iter().enumerate() {
                let (high, low) = (first + BAR * place as i32, first + BAR * (place as i32 + 1) - 2);
                area.draw(&Text::new(way, (LEFT - 6, (high + low) / 2), anchored(11, HPos::Right)))?;
                let at = |i: usize| LEFT + (RIGHT - LEFT) * i as i32 / marks.len().max(1) as i32;
                let mut start = 0;
                for run in marks.chunk_by(|a, b| a == b) {
                    // neighbours of one colour are one rectangle
                    let corners = [(at(start), high), (at(start + run.len()), low)];
                    if run[0].is_some() {
                        area.draw(&Rectangle::new(corners, colour(run[0]).filled()))?;
                    }
                    start += run.len();
                }
            }
        }
        Ok(())
    })
}

/// A text in lines of so many letters, none of which is left out; at least one line.
fn in_lines(text: &str, most: usize) -> Vec<String> {
    let lines = textwrap::wrap(text, most);
    if lines.is_empty() { vec![String::new()] } else { lines.into_iter().map(Into::into).collect() }
}

/// The bars from far to near.
pub fn lines_picture(study: &StressStudy) -> String {
    let rows: Vec<Bars<'_>> = study
        .lines
        .iter()
        .map(|line| {
            let end = match &line.end {
                LineLimit::Ranks { ranks, .. } => {
                    format!("on the set: rows of rank {}", ranks_text(ranks.iter()))
                }
                LineLimit::Pole(why) => why.clone(),
                LineLimit::Infinity => "the set is at infinity".to_owned(),
            };
            let near = format!("true rank on the way: {}", ranks_text(line.ranks.iter()));
            Bars {
                title: line.title.clone(),
                below: vec![near, end],
                marks: line.ways.iter().map(|way| way.marks.as_slice()).collect(),
            }
        })
        .collect();
    let distances = study.lines.first().map_or(&[][..], |line| &line.distances);
    let count = distances.len().max(1) as f64;
    let last = distances.last().copied().unwrap_or(1.0).log10();
    // the middle of a point's part of the bar is its place
    let place = |log: i32| ((f64::from(log) / last) * (count - 1.0) + 0.5) / count;
    let ticks: Vec<(f64, String)> = (0..=5).map(|i| -3 * i).map(|log| (place(log), power(log))).collect();
    bars(&format!("{}: into every singular set", study.title), "distance from the set", &ticks, &rows)
}

fn power(exponent: i32) -> String {
    if exponent == 0 { "1".to_owned() } else { format!("1e{exponent}") }
}

/// Ranks, as text.
pub(super) fn ranks_text<'a>(ranks: impl Iterator<Item = &'a usize>) -> String {
    ranks.map(ToString::to_string).collect::<Vec<_>>().join(" or ")
}

/// The bars from small to large.
pub fn scalings_picture(study: &StressStudy) -> String {
    let rows: Vec<Bars<'_>> = study
        .scalings
        .iter()
        .map(|scaling| Bars {
            title: scaling.quantity.clone(),
            below: Vec::new(),
            marks: scaling.ways.iter().map(|way| way.marks.as_slice()).collect(),
        })
        .collect();
    let exponents = study.scalings.first().map_or(&[][..], |scaling| &scaling.exponents);
    let count = exponents.len().max(1) as f64;
    let ticks: Vec<(f64, String)> = exponents
        .iter()
        .enumerate()
        .filter(|(_, exponent)| **exponent % 50 == 0)
        .map(|(i, exponent)| ((i as f64 + 0.5) / count, power(*exponent)))
        .collect();
    bars(&format!("{}: every quantity scaled", study.title), "times the quantity's value", &ticks, &rows)
}

/// How the states (of the box, on the sets and near them) are conditioned with rows of length one, and equilibrated.
pub fn conditioning_picture(study: &StressStudy, title: &str) -> String {
    let mut found = study.conditioning.clone();
    for (all, near) in
        [(&mut found.old, &study.conditioning_near.old), (&mut found.new, &study.conditioning_near.new)]
    {
        for (decade, count) in near {
            *all.entry(*decade).or_insert(0) += count;
        }
    }
    let decades = || found.old.keys().chain(found.new.keys()).filter(|decade| **decade < i32::MAX).copied();
    let (Some(least), Some(most)) = (decades().min(), decades().max()) else {
        return String::new();
    };
    let tallest = found.old.values().chain(found.new.values()).copied().max().unwrap_or(1) as f64 * 2.0;
    let (from, to) = (f64::from(least), f64::from(most) + 1.0);
    svg((420, 300), title, |area| {
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 14).into_font().color(&INK))
            .margin(10)
            .margin_right(26)
            .x_label_area_size(38)
            .y_label_area_size(56)
            .build_cartesian_2d(from..to, (0.7..tallest).log_scale())?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .light_line_style(WHITE)
            .bold_line_style(MESH)
            .x_labels((most - least + 2).clamp(2, 7) as usize)
            .x_label_formatter(&|v| format!("1e{v:.0}"))
            .y_label_formatter(&|v| format!("{v:.0}"))
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_desc("condition number of the state")
            .y_desc("states")
            .axis_desc_style(("sans-serif", 12))
            .draw()?;
        let mut draw = |histogram: &BTreeMap<i32, usize>, part: Range<f64>, mark: Mark, name: &str| {
            let style = colour(Some(mark)).filled();
            let finite = histogram.iter().filter(|(decade, _)| **decade < i32::MAX);
            let drawn = chart.draw_series(finite.map(|(decade, count)| {
                let left = f64::from(*decade);
                Rectangle::new([(left + part.start, 0.7), (left + part.end, *count as f64)], style)
            }));
            drawn.map(|series| {
                series.label(name).legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 14, y + 5)], style));
            })
        };
        draw(&found.old, 0.06..0.5, Mark::Lost, "rows scaled to length one")?;
        draw(&found.new, 0.5..0.94, Mark::Right, "equilibrated, without unit rows")?;
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE)
            .label_font(("sans-serif", 12).into_font().color(&INK))
            .draw()?;
        Ok(())
    })
}
