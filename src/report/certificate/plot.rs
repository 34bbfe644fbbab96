//! Certificates on regions, as pictures.

use crate::certificate::{RegionAnswer, RegionMap, Standing};
use crate::report::plot::{INK, svg};
use plotters::prelude::*;

const LINE: RGBColor = RGBColor(0, 114, 178);

/// What is not proved against the number of boxes, both axes logarithmic. Boxes and not seconds: the same picture on every
/// machine.
pub fn region_curve(answer: &RegionAnswer, title: &str) -> String {
    let open = |proved: f64| (1.0 - proved).max(SMALLEST);
    let points: Vec<(f64, f64)> = answer.curve.iter().map(|p| (p.boxes as f64, open(p.proved))).collect();
    let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else {
        return "<p>no box was looked at</p>".to_owned();
    };
    svg((420, 300), |area| {
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 14).into_font().color(&INK))
            .margin(8)
            .x_label_area_size(34)
            .y_label_area_size(58)
            .build_cartesian_2d(
                (first.0..last.0.max(first.0 * 10.0)).log_scale(),
                (last.1.min(0.1) / 1.5..1.2).log_scale(),
            )?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(225, 228, 232))
            .x_label_formatter(&|v| format!("{v:.0e}"))
            .y_label_formatter(&|v| format!("{v:.0e}"))
            .x_labels(6)
            .y_labels(7)
            .x_desc("boxes")
            .y_desc("part of the volume that is open")
            .axis_desc_style(("sans-serif", 12))
            .draw()?;
        chart.draw_series(LineSeries::new(points.iter().copied(), LINE.stroke_width(2)))?;
        Ok(())
    })
}

/// Less is not drawn.
const SMALLEST: f64 = 1e-12;

fn colour(standing: Standing) -> RGBColor {
    match standing {
        Standing::Proved => RGBColor(205, 228, 240),
        Standing::MinorVanishes => RGBColor(213, 94, 0),
        Standing::Pole => RGBColor(40, 44, 52),
        Standing::Undecided => RGBColor(150, 150, 150),
    }
}

/// The boxes in a plane, each with its border: pale where full rank is proved, red where a minor is proved to vanish
/// somewhere in the box, black where a pole runs through it, grey where nothing is known.
pub fn region_map(map: &RegionMap, title: &str) -> String {
    let drawn = svg((580, 400), |area| {
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 14).into_font().color(&INK))
            .margin(8)
            .x_label_area_size(36)
            .y_label_area_size(46)
            .build_cartesian_2d(map.x.1..map.x.2, map.y.1..map.y.2)?;
        let smallest = ((map.x.2 - map.x.1) / 300.0, (map.y.2 - map.y.1) / 200.0);
        for patch in &map.patches {
            let corners = [(patch.x.0, patch.y.0), (patch.x.1, patch.y.1)];
            chart.draw_series([Rectangle::new(corners, colour(patch.standing).filled())])?;
            let wide = patch.x.1 - patch.x.0 > smallest.0 && patch.y.1 - patch.y.0 > smallest.1;
            if wide {
                let border = RGBColor(255, 255, 255).stroke_width(1);
                chart.draw_series([Rectangle::new(corners, border)])?;
            }
        }
        chart
            .configure_mesh()
            .disable_mesh()
            .x_desc(&map.x.0)
            .y_desc(&map.y.0)
            .axis_desc_style(("sans-serif", 13))
            .draw()?;
        Ok(())
    });
    drawn.replacen("<svg ", "<svg shape-rendering=\"crispEdges\" ", 1)
}
