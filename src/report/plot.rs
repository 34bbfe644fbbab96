//! Plots as SVG, to be put into a page.

use crate::tradeoff::{Growth, Map, RoundingStudy, Slope};
use plotters::coord::Shift;
use plotters::prelude::*;

/// Colours of singular values, from small (dark) to large (light).
const SCALE: [(u8, u8, u8); 8] = [
    (13, 8, 60),
    (59, 15, 112),
    (112, 31, 129),
    (163, 48, 126),
    (211, 67, 110),
    (245, 106, 92),
    (253, 166, 104),
    (252, 222, 156),
];
/// Where a pole is.
const POLE: RGBColor = RGBColor(255, 255, 255);
pub(super) const INK: RGBColor = RGBColor(40, 44, 52);

pub(super) type Drawing<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Draws into a string. What cannot be drawn is said in its place.
pub(super) fn svg(
    size: (u32, u32),
    draw: impl FnOnce(&Drawing<'_>) -> Result<(), Box<dyn std::error::Error>>,
) -> String {
    let mut text = String::new();
    let result = {
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        draw(&area).and_then(|()| area.present().map_err(Into::into))
    };
    match result {
        Ok(()) => {
            // what every shape says and nobody needs
            let text =
                text.replace(" opacity=\"1\"", "").replace(" stroke=\"none\"", "").replace(">\n<", "><");
            text.replacen("<svg ", "<svg role=\"img\" ", 1)
        }
        Err(error) => format!("<p>this plot could not be drawn: {error}</p>"),
    }
}

/// The steps of the colour scale: levels of the logarithm, two a decade.
fn level(value: f64, lowest: f64, highest: f64) -> usize {
    let part = (value.log10() - lowest) / (highest - lowest).max(1e-9);
    ((part * SHADES as f64).floor().max(0.0) as usize).min(SHADES - 1)
}

const SHADES: usize = 24;

fn shade(level: usize) -> RGBColor {
    let part = level as f64 / (SHADES - 1) as f64 * (SCALE.len() - 1) as f64;
    let (low, rest) = (part.floor() as usize, part.fract());
    let (a, b) = (SCALE[low], SCALE[(low + 1).min(SCALE.len() - 1)]);
    let mix = |x: u8, y: u8| (f64::from(x) * (1.0 - rest) + f64::from(y) * rest).round() as u8;
    RGBColor(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

/// The smallest singular value over two coordinates; dark where it is small, white at poles.
pub(crate) fn map(map: &Map, title: &str) -> String {
    let found: Vec<f64> =
        map.smallest.iter().flatten().copied().filter(|v| *v > 0.0).map(f64::log10).collect();
    let highest = found.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = found.iter().copied().fold(f64::INFINITY, f64::min).max(highest - 6.0);
    if found.is_empty() {
        return "<p>there is a pole everywhere on this map</p>".to_owned();
    }
    // without smoothing of edges no gaps show between the rectangles
    let drawn = svg((580, 400), |area| {
        let (plot, legend) = area.split_horizontally(490);
        let mut chart = ChartBuilder::on(&plot)
            .caption(title, ("sans-serif", 15).into_font().color(&INK))
            .margin(8)
            .x_label_area_size(36)
            .y_label_area_size(46)
            .build_cartesian_2d(map.x.1..map.x.2, map.y.1..map.y.2)?;
        let (dx, dy) = ((map.x.2 - map.x.1) / map.width as f64, (map.y.2 - map.y.1) / map.height as f64);
        let colour =
            |cell: &Option<f64>| cell.map(|value| level(value.max(f64::MIN_POSITIVE), lowest, highest));
        for (row, cells) in map.smallest.chunks(map.width).enumerate() {
            // neighbours of one colour are one rectangle
            let mut start = 0;
            while start < cells.len() {
                let this = colour(&cells[start]);
                let length = cells[start..].iter().take_while(|cell| colour(cell) == this).count();
                let corner = |i: usize, j: usize| (map.x.1 + dx * i as f64, map.y.1 + dy * j as f64);
                let style = this.map_or(POLE, shade).filled();
                chart.draw_series([Rectangle::new(
                    [corner(start, row), corner(start + length, row + 1)],
                    style,
                )])?;
                start += length;
            }
        }
        chart
            .configure_mesh()
            .disable_mesh()
            .x_desc(&map.x.0)
            .y_desc(&map.y.0)
            .axis_desc_style(("sans-serif", 13))
            .draw()?;
        let mut scale = ChartBuilder::on(&legend)
            .margin_top(34)
            .margin_bottom(44)
            .margin_right(4)
            .y_label_area_size(50)
            .build_cartesian_2d(0.0..1.0, lowest..highest)?;
        for step in 0..SHADES {
            let at = |i: usize| lowest + (highest - lowest) * i as f64 / SHADES as f64;
            scale.draw_series([Rectangle::new(
                [(0.0, at(step)), (1.0, at(step + 1))],
                shade(step).filled(),
            )])?;
        }
        scale
            .configure_mesh()
            .disable_mesh()
            .disable_x_axis()
            .y_labels(7)
            .y_label_style(("sans-serif", 12))
            .y_label_formatter(&|v| format!("{:.0e}", 10f64.powf(*v)))
            .draw()?;
        Ok(())
    });
    drawn.replacen("<svg ", "<svg shape-rendering=\"crispEdges\" ", 1)
}

/// The singular values on the way into a singularity, both axes logarithmic.
pub(crate) fn slope(slope: &Slope, title: &str) -> String {
    let values: Vec<f64> = slope.values.iter().flatten().copied().filter(|v| *v > 1e-20).collect();
    let highest = values.iter().copied().fold(1e-20, f64::max) * 2.0;
    let lowest = values.iter().copied().fold(highest, f64::min).max(1e-18) / 2.0;
    let (near, far) =
        (slope.distance.last().copied().unwrap_or(1e-14), slope.distance.first().copied().unwrap_or(1.0));
    svg((420, 300), |area| {
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 14).into_font().color(&INK))
            .margin(8)
            .x_label_area_size(34)
            .y_label_area_size(52)
            .build_cartesian_2d((near..far).log_scale(), (lowest..highest).log_scale())?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(225, 228, 232))
            .x_labels(6)
            .y_labels(7)
            .x_label_formatter(&|v| format!("{v:.0e}"))
            .y_label_formatter(&|v| format!("{v:.0e}"))
            .x_desc("distance")
            .axis_desc_style(("sans-serif", 12))
            .draw()?;
        let count = slope.values.iter().map(Vec::len).max().unwrap_or(0);
        for index in 0..count {
            let points = slope
                .distance
                .iter()
                .zip(&slope.values)
                .filter_map(|(d, v)| v.get(index).filter(|v| **v >= lowest).map(|v| (*d, *v)));
            let last = index + 1 == count;
            let colour =
                if last { RGBColor(200, 40, 60) } else { shade(index * (SHADES - 8) / count.max(1)) };
            chart.draw_series(LineSeries::new(points, colour.stroke_width(if last { 2 } else { 1 })))?;
        }
        Ok(())
    })
}

/// The errors of a sum in few digits, as a histogram, with the error of the printed number as a line.
pub(crate) fn rounding(study: &RoundingStudy, printed_error: f64, title: &str) -> String {
    let reach = study.errors.iter().fold(printed_error.abs(), |a, e| a.max(e.abs())) * 1.1;
    const BINS: usize = 41;
    let mut bins = [0u32; BINS];
    for error in &study.errors {
        let place = ((error + reach) / (2.0 * reach) * BINS as f64) as usize;
        bins[place.min(BINS - 1)] += 1;
    }
    let tallest = f64::from(bins.iter().copied().max().unwrap_or(1)) * 1.1;
    svg((420, 260), |area| {
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 14).into_font().color(&INK))
            .margin(8)
            .x_label_area_size(34)
            .y_label_area_size(36)
            .build_cartesian_2d(-reach..reach, 0.0..tallest)?;
        chart
            .configure_mesh()
            .disable_mesh()
            .x_labels(5)
            .x_label_formatter(&|v| format!("{v:.1e}"))
            .x_desc("error of the sum")
            .axis_desc_style(("sans-serif", 12))
            .draw()?;
        let width = 2.0 * reach / BINS as f64;
        chart.draw_series(bins.iter().enumerate().map(|(i, count)| {
            let left = -reach + width * i as f64;
            Rectangle::new([(left, 0.0), (left + width, f64::from(*count))], shade(6).filled())
        }))?;
        let line = [(printed_error, 0.0), (printed_error, tallest)];
        chart.draw_series(LineSeries::new(line, RGBColor(200, 40, 60).stroke_width(2)))?;
        Ok(())
    })
}

/// Operations against order, both axes logarithmic, beside a line of slope three.
pub(crate) fn growth(growth: &[Growth], title: &str) -> String {
    let points: Vec<(f64, f64)> = growth.iter().map(|g| (g.order as f64, g.operations as f64)).collect();
    let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else {
        return String::new();
    };
    svg((420, 300), |area| {
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 14).into_font().color(&INK))
            .margin(8)
            .x_label_area_size(34)
            .y_label_area_size(56)
            .build_cartesian_2d((1.0..last.0 * 1.1).log_scale(), (first.1 / 2.0..last.1 * 4.0).log_scale())?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(225, 228, 232))
            .x_label_formatter(&|v| format!("{v:.0}"))
            .y_label_formatter(&|v| format!("{v:.0}"))
            .x_desc("order of the Lie derivative")
            .y_desc("operations")
            .axis_desc_style(("sans-serif", 12))
            .draw()?;
        let cubic = points
            .iter()
            .map(|(k, _)| (*k, last.1 * (k / last.0).powi(3)))
            .filter(|(_, v)| *v >= first.1 / 2.0);
        chart.draw_series(LineSeries::new(cubic, RGBColor(170, 175, 182).stroke_width(1)))?;
        chart.draw_series(LineSeries::new(points.iter().copied(), shade(6).stroke_width(2)))?;
        chart.draw_series(points.iter().map(|point| Circle::new(*point, 3, shade(6).filled())))?;
        Ok(())
    })
}
