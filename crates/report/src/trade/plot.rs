//! Speed against accuracy, as a picture.

use crate::drawing::{INK, MESH, svg};
use palmistry_workbench::tradeoff::{Combination, CorrectDigits, Derivative, Number, Trade};
use plotters::coord::CoordTranslate;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// All digits are drawn here.
const ALL_DIGITS: f64 = 35.0;
/// What is exact modulo a prime, and has no digits, here.
const NO_DIGITS: f64 = -1.5;

fn colour(number: Number) -> RGBColor {
    match number {
        Number::Single => RGBColor(230, 159, 0),
        Number::Double => RGBColor(0, 114, 178),
        Number::Bounded => RGBColor(86, 180, 233),
        Number::DoubleDouble => RGBColor(0, 158, 115),
        Number::Interval => RGBColor(204, 121, 167),
        Number::Residue => RGBColor(120, 120, 120),
        Number::Rational => RGBColor(213, 94, 0),
    }
}

fn height(combination: &Combination) -> f64 {
    match combination.digits {
        CorrectDigits::Exact => ALL_DIGITS,
        CorrectDigits::Modular => NO_DIGITS,
        CorrectDigits::Measured { worst, .. } => worst,
    }
}

/// Every combination by its time a state (logarithmic) and the digits of its worst state: colours are kinds of numbers,
/// shapes ways to a derivative; filled where every verdict is right, with a rim where every one is certain. The line joins those that no other combination
/// whose every verdict is right beats in time and digits.
pub fn trade_plot(trade: &Trade) -> String {
    let timed: Vec<&Combination> = trade.combinations.iter().filter(|c| c.seconds.is_finite()).collect();
    let ends = |f: fn(f64, f64) -> f64, start| timed.iter().map(|c| c.seconds * 1e9).fold(start, f);
    let (fastest, slowest) = (ends(f64::min, f64::INFINITY), ends(f64::max, 0.0));
    if timed.is_empty() {
        return "<p>nothing was timed</p>".to_owned();
    }
    let names =
        distinct(timed.iter().map(|c| c.number)).len() + distinct(timed.iter().map(|c| c.derivative)).len();
    let tall = 330 + 18 * names.div_ceil(2) as i32 + 48;
    svg((420, tall as u32), &trade.title, |area| {
        let (plot, legend) = area.split_vertically(330);
        let mut chart = ChartBuilder::on(&plot)
            .caption(&trade.title, ("sans-serif", 14).into_font().color(&INK))
            .margin(8)
            .margin_right(26)
            .x_label_area_size(38)
            .y_label_area_size(46)
            .build_cartesian_2d((fastest / 1.5..slowest * 1.5).log_scale(), -3.0..ALL_DIGITS + 2.0)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(MESH)
            .x_labels(6)
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_label_formatter(&|v| time_label(*v))
            .y_labels(8)
            .y_label_formatter(&|v| if *v == ALL_DIGITS { "all".to_owned() } else { format!("{v:.0}") })
            .x_desc("time a state, derivative and rank")
            .y_desc("digits at the worst state")
            .axis_desc_style(("sans-serif", 13))
            .draw()?;
        // the front in two criteria, of those that are always right
        let mut best = f64::NEG_INFINITY;
        let mut line: Vec<(f64, f64)> = Vec::new();
        let mut right: Vec<&Combination> = timed.iter().copied().filter(|c| c.not_right() == 0).collect();
        right.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        for combination in right {
            if height(combination) > best {
                best = height(combination);
                line.push((combination.seconds * 1e9, best));
            }
        }
        chart.draw_series(LineSeries::new(line, INK.stroke_width(1)))?;
        // those of one look together
        let mut marks: Vec<&Combination> = timed.clone();
        marks.sort_by_key(|c| (c.number, c.not_right() == 0, c.certified == trade.states));
        let look = |combination: &Combination| {
            let colour = colour(combination.number);
            let inside = if combination.not_right() == 0 { colour } else { WHITE };
            (inside, if combination.certified == trade.states { INK } else { colour })
        };
        for alike in marks.chunk_by(|a, b| look(a) == look(b)) {
            let (inside, rim) = look(alike[0]);
            let at = |c: &Combination| (c.seconds * 1e9, height(c));
            for combination in alike {
                filled(chart.plotting_area(), at(combination), combination.derivative, inside)?;
            }
            for combination in alike.iter().filter(|_| rim != inside) {
                rimmed(chart.plotting_area(), at(combination), combination.derivative, rim)?;
            }
        }
        if timed.iter().any(|c| c.digits == CorrectDigits::Modular) {
            let at = (slowest * 1.3, NO_DIGITS);
            let right = Pos::new(HPos::Right, VPos::Center);
            let words = ("sans-serif", 12).into_font().color(&INK).pos(right);
            chart.plotting_area().draw(&Text::new("modulo a prime: no digits", at, words))?;
        }
        let key = |place: usize| (16 + 205 * (place % 2) as i32, 12 + 18 * (place / 2) as i32);
        let words = ("sans-serif", 12).into_font().color(&INK);
        let numbers: Vec<Number> = distinct(timed.iter().map(|c| c.number));
        for (place, number) in numbers.iter().enumerate() {
            let (x, y) = key(place);
            legend.draw(&Rectangle::new([(x - 5, y - 5), (x + 5, y + 5)], colour(*number).filled()))?;
            legend.draw(&Text::new(number.name(), (x + 12, y - 5), words.clone()))?;
        }
        for (place, derivative) in distinct(timed.iter().map(|c| c.derivative)).into_iter().enumerate() {
            let (x, y) = key(place + numbers.len());
            filled(&legend, (x, y), derivative, INK)?;
            legend.draw(&Text::new(derivative.name(), (x + 12, y - 5), words.clone()))?;
        }
        let below = 18 * names.div_ceil(2) as i32 + 8;
        for (row, text) in
            ["hollow: some verdicts are not right", "with a rim: all verdicts are certain"].iter().enumerate()
        {
            legend.draw(&Text::new(*text, (10, below + 17 * row as i32), words.clone()))?;
        }
        Ok(())
    })
}

/// The corners of a shape about a point, in pixels.
fn corners(derivative: Derivative) -> Vec<(i32, i32)> {
    match derivative {
        Derivative::Graph => vec![(-2, -5), (2, -5), (5, -2), (5, 2), (2, 5), (-2, 5), (-5, 2), (-5, -2)],
        Derivative::Blocks => {
            vec![(0, -7), (2, -2), (7, -2), (3, 1), (5, 6), (0, 3), (-5, 6), (-3, 1), (-7, -2), (-2, -2)]
        }
        Derivative::Series => vec![(0, -6), (6, 0), (0, 6), (-6, 0)],
        Derivative::Duals => vec![(-5, -5), (5, -5), (5, 5), (-5, 5)],
        Derivative::Forward => vec![(-6, -4), (6, -4), (0, 6)],
        Derivative::Central => vec![(-6, 4), (6, 4), (0, -6)],
        Derivative::Expanded => vec![
            (-2, -6),
            (2, -6),
            (2, -2),
            (6, -2),
            (6, 2),
            (2, 2),
            (2, 6),
            (-2, 6),
            (-2, 2),
            (-6, 2),
            (-6, -2),
            (-2, -2),
        ],
    }
}

fn filled<C: CoordTranslate>(
    area: &DrawingArea<SVGBackend<'_>, C>,
    at: C::From,
    derivative: Derivative,
    inside: RGBColor,
) -> Result<(), Box<dyn std::error::Error>> {
    let shape = EmptyElement::at(at) + Polygon::new(corners(derivative), inside.filled());
    Ok(area.draw(&shape).map_err(|error| error.to_string())?)
}

fn rimmed<C: CoordTranslate>(
    area: &DrawingArea<SVGBackend<'_>, C>,
    at: C::From,
    derivative: Derivative,
    rim: RGBColor,
) -> Result<(), Box<dyn std::error::Error>> {
    let mut outline = corners(derivative);
    outline.extend(outline.first().copied());
    Ok(area
        .draw(&(EmptyElement::at(at) + PathElement::new(outline, rim)))
        .map_err(|error| error.to_string())?)
}

fn distinct<T: PartialEq>(items: impl Iterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for item in items {
        if !found.contains(&item) {
            found.push(item);
        }
    }
    found
}

fn time_label(nanoseconds: f64) -> String {
    match nanoseconds {
        t if t < 1e3 => format!("{t:.0} ns"),
        t if t < 1e6 => format!("{:.0} us", t / 1e3),
        t => format!("{:.0} ms", t / 1e6),
    }
}
