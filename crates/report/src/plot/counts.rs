//! Numbers in print, and how fast Lie derivatives grow.

use super::RED;
use crate::axis::room;
use crate::drawing::{INK, MESH, svg};
use palmistry_workbench::tradeoff::{Growth, RoundingStudy};
use plotters::prelude::{
    ChartBuilder, Circle, Color, IntoFont, IntoLogRange, LineSeries, RGBColor, Rectangle, WHITE,
};

/// What is counted or measured.
const BAR: RGBColor = RGBColor(0, 114, 178);

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
    svg((420, 260), title, |area| {
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 14).into_font().color(&INK))
            .margin(8)
            .x_label_area_size(38)
            .y_label_area_size(50)
            .build_cartesian_2d(-reach..reach, 0.0..tallest)?;
        chart
            .configure_mesh()
            .disable_mesh()
            .x_labels(5)
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_label_formatter(&|v| format!("{v:.1e}"))
            .x_desc("error of the sum")
            .y_desc("orders")
            .axis_desc_style(("sans-serif", 12))
            .draw()?;
        let width = 2.0 * reach / BINS as f64;
        chart.draw_series(bins.iter().enumerate().map(|(i, count)| {
            let left = -reach + width * i as f64;
            Rectangle::new([(left, 0.0), (left + width, f64::from(*count))], BAR.filled())
        }))?;
        let line = [(printed_error, 0.0), (printed_error, tallest)];
        chart.draw_series(LineSeries::new(line, RED.stroke_width(2)))?;
        Ok(())
    })
}

/// Operations against order, both axes logarithmic, beside a line of slope three.
pub(crate) fn growth(growth: &[Growth], title: &str) -> String {
    let points: Vec<(f64, f64)> = growth.iter().map(|g| (g.order as f64, g.operations as f64)).collect();
    let Some(last) = points.last().copied() else {
        return String::new();
    };
    // a derivative may cost less than the one before it
    let sizes = || points.iter().map(|point| point.1.max(1.0));
    let (least, most) = (sizes().fold(f64::INFINITY, f64::min) / 2.0, sizes().fold(1.0, f64::max) * 4.0);
    svg((420, 300), title, |area| {
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 14).into_font().color(&INK))
            .margin(8)
            .x_label_area_size(38)
            .y_label_area_size(room((least, most), |v| format!("{v:.0}")))
            .build_cartesian_2d((1.0..last.0 * 1.1).log_scale(), (least..most).log_scale())?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(MESH)
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_labels(6)
            .y_labels(6)
            .x_label_formatter(&|v| format!("{v:.0}"))
            .y_label_formatter(&|v| format!("{v:.0}"))
            .x_desc("order of the Lie derivative")
            .y_desc("operations")
            .axis_desc_style(("sans-serif", 12))
            .draw()?;
        let cubic =
            points.iter().map(|(k, _)| (*k, last.1 * (k / last.0).powi(3))).filter(|(_, v)| *v >= least);
        chart.draw_series(LineSeries::new(cubic, RGBColor(150, 155, 162).stroke_width(1)))?;
        chart.draw_series(LineSeries::new(points.iter().copied(), BAR.stroke_width(2)))?;
        chart.draw_series(points.iter().map(|point| Circle::new(*point, 3, BAR.filled())))?;
        Ok(())
    })
}
