//! Pictures of a fit: what was measured beside what is expected, the ends of all searches, profiles.

use super::JointObserved;
use crate::axis::number;
use crate::drawing::{Drawing, INK, MESH, svg};
use palmistry_fit::{ParameterProfile, ParameterScale, SimulatedExperiments};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

const MEASURED: RGBColor = RGBColor(0, 114, 178);
const EXPECTED: RGBColor = RGBColor(213, 94, 0);
const OTHER: RGBColor = RGBColor(120, 120, 120);

/// A colour an output.
const COLOURS: [RGBColor; 6] = [
    MEASURED,
    EXPECTED,
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(150, 120, 0),
];

/// More curves than these are in the JSON only.
pub(super) const MOST_PICTURES: usize = 24;

/// A range with some room around it.
fn around(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    match high - low {
        span if span > 0.0 => (low - 0.06 * span, high + 0.06 * span),
        _ if low.is_finite() => (low - 0.5 * low.abs().max(1.0), high + 0.5 * high.abs().max(1.0)),
        _ => (0.0, 1.0),
    }
}

/// A chart of this module as others draw into it.
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// What stands around a picture.
struct Frame<'f> {
    caption: &'f str,
    /// What is along the axes.
    names: [&'f str; 2],
    x: (f64, f64),
    y: (f64, f64),
    /// Whether x is a count.
    is_counted: bool,
}

impl Frame<'_> {
    /// The chart with its axes, ready to be drawn into.
    fn chart<'a, 'b>(&self, area: &'a Drawing<'b>) -> Result<Chart<'a, 'b>, Box<dyn std::error::Error>> {
        let (across, up) = (self.x.1 - self.x.0, self.y.1 - self.y.0);
        let mut chart = ChartBuilder::on(area)
            .caption(self.caption, ("sans-serif", 13).into_font().color(&INK))
            .margin(8)
            .margin_right(16)
            .x_label_area_size(34)
            .y_label_area_size(crate::axis::room(self.y, |v| number(v, up)))
            .build_cartesian_2d(self.x.0..self.x.1, self.y.0..self.y.1)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(MESH)
            .x_labels(if self.is_counted { (across as usize).clamp(1, 10) } else { 6 })
            .y_labels(6)
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_label_formatter(&|v| if self.is_counted { format!("{v:.0}") } else { number(*v, across) })
            .y_label_formatter(&|v| number(*v, up))
            .x_desc(self.names[0])
            .y_desc(self.names[1])
            .axis_desc_style(("sans-serif", 12))
            .draw()?;
        Ok(chart)
    }
}

/// An output of an experiment: points with two deviations of their errors, and what is expected at those times.
pub(super) fn compared(
    observed: &JointObserved<'_>,
    simulated: &SimulatedExperiments,
    experiment: usize,
    output: &str,
) -> String {
    let problem = observed.experiments.problem();
    let mut rows: Vec<(f64, f64, f64, f64)> = problem
        .measurements
        .iter()
        .enumerate()
        .filter(|(_, one)| one.experiment == experiment && one.output == output && one.time.is_finite())
        .map(|(row, one)| (one.time, one.value, simulated.expected[row], simulated.sizes[row]))
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let is_log = problem
        .measurements
        .iter()
        .any(|one| one.output == output && one.scale != palmistry_fit::ErrorScale::Linear);
    let place = |value: f64| if is_log { value.log10() } else { value };
    let bar = |measured: f64, size: f64| -> [f64; 2] {
        match problem.measurements.iter().find(|one| one.output == output).map(|one| one.scale) {
            Some(palmistry_fit::ErrorScale::Log) => {
                let half = 2.0 * size / std::f64::consts::LN_10;
                [place(measured) - half, place(measured) + half]
            }
            Some(palmistry_fit::ErrorScale::Log10) => {
                [place(measured) - 2.0 * size, place(measured) + 2.0 * size]
            }
            _ => [measured - 2.0 * size, measured + 2.0 * size],
        }
    };
    let (left, right) = around(rows.iter().map(|row| row.0));
    let (low, high) =
        around(rows.iter().flat_map(|row| [place(row.1), place(row.2)].into_iter().chain(bar(row.1, row.3))));
    let title = format!("{output}, {}", problem.experiments[experiment].name);
    svg((420, 260), &title, |area| {
        let names = ["time", if is_log { "decimal logarithm" } else { "" }];
        let frame = Frame { caption: &title, names, x: (left, right), y: (low, high), is_counted: false };
        let mut chart = frame.chart(area)?;
        chart.draw_series(rows.iter().map(|row| {
            let [from, to] = bar(row.1, row.3);
            PathElement::new([(row.0, from), (row.0, to)], MEASURED.mix(0.4).stroke_width(1))
        }))?;
        chart.draw_series(LineSeries::new(
            rows.iter().map(|row| (row.0, place(row.2))),
            EXPECTED.stroke_width(2),
        ))?;
        chart.draw_series(rows.iter().map(|row| Circle::new((row.0, place(row.1)), 3, MEASURED.filled())))?;
        Ok(())
    })
}

/// The ends of all searches, the best first: how often the best was found, and what else there is.
pub(super) fn ends(objectives: &[f64]) -> String {
    let mut sorted: Vec<f64> = objectives.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let Some(best) = sorted.first().copied() else { return String::new() };
    let over: Vec<f64> = sorted.iter().map(|value| (value - best + 1.0).log10()).collect();
    let (low, high) = around(over.iter().copied());
    let title = "ends of the searches";
    svg((420, 260), title, |area| {
        let names = ["search, the best first", "log10(1 + loss of log-likelihood)"];
        let x = (0.5, over.len() as f64 + 0.5);
        let mut chart = Frame { caption: title, names, x, y: (low, high), is_counted: true }.chart(area)?;
        chart.draw_series(over.iter().enumerate().map(|(at, value)| {
            let colour = if *value < 1.1f64.log10() { MEASURED } else { OTHER };
            Circle::new((at as f64 + 1.0, *value), 4, colour.filled())
        }))?;
        Ok(())
    })
}

/// The residuals over the sizes of their errors, in the order of the measurements, a colour an output; 95 % lie between the lines.
pub(super) fn residuals(observed: &JointObserved<'_>, simulated: &SimulatedExperiments) -> String {
    let problem = observed.experiments.problem();
    let mut outputs: Vec<&str> = Vec::new();
    for one in &problem.measurements {
        if !outputs.contains(&one.output.as_str()) {
            outputs.push(&one.output);
        }
    }
    let most = simulated.residuals.iter().fold(2.5f64, |most, own| most.max(own.abs())) * 1.1;
    let title = "residuals, in sizes of their errors";
    let count = simulated.residuals.len() as f64;
    svg((420, 260), title, |area| {
        let (x, y) = ((0.0, count + 1.0), (-most, most));
        let frame = Frame { caption: title, names: ["measurement", ""], x, y, is_counted: true };
        let mut chart = frame.chart(area)?;
        for level in [-1.96, 1.96] {
            let line = [(0.0, level), (count + 1.0, level)];
            chart.draw_series(LineSeries::new(line, OTHER.stroke_width(1)))?;
        }
        chart.draw_series(simulated.residuals.iter().zip(&problem.measurements).enumerate().map(
            |(at, (value, one))| {
                let place = outputs.iter().position(|own| *own == one.output).unwrap_or(0);
                Circle::new((at as f64 + 1.0, *value), 3, COLOURS[place % COLOURS.len()].filled())
            },
        ))?;
        Ok(())
    })
}

/// A profile, with the line below which 95 % lie.
pub(super) fn profile(name: &str, scale: ParameterScale, own: &ParameterProfile) -> String {
    let allowed = palmistry_fit::ALLOWED;
    let (left, right) = around(own.points.iter().map(|point| point[0]));
    let top = own.points.iter().map(|point| point[1]).fold(allowed, f64::max).min(3.0 * allowed);
    let bottom = own.points.iter().map(|point| point[1]).fold(0.0, f64::min);
    let (low, high) = (bottom - 0.05 * (top - bottom), top + 0.1 * (top - bottom));
    svg((420, 240), name, |area| {
        let along = match scale {
            ParameterScale::Linear => name.to_owned(),
            scale => format!("{} of {name}", scale.word()),
        };
        let names = [along.as_str(), "loss of log-likelihood"];
        let frame = Frame { caption: name, names, x: (left, right), y: (low, high), is_counted: false };
        let mut chart = frame.chart(area)?;
        chart.draw_series(LineSeries::new([(left, allowed), (right, allowed)], OTHER.stroke_width(1)))?;
        let points = own.points.iter().map(|point| (point[0], point[1].min(high)));
        chart.draw_series(LineSeries::new(points.clone(), MEASURED.stroke_width(2)))?;
        chart.draw_series(points.map(|point| Circle::new(point, 2, MEASURED.filled())))?;
        Ok(())
    })
}
