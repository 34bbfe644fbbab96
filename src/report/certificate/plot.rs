//! Certificates on regions, as pictures.

use crate::certificate::{BoxStanding, RegionAnswer, RegionMap};
use crate::report::axis::{axis, number, room};
use crate::report::drawing::{Canvas, INK, MESH, svg};

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
    svg((420, 300), title, |area| {
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 14).into_font().color(&INK))
            .margin(8)
            .x_label_area_size(34)
            .y_label_area_size(62)
            .build_cartesian_2d(
                (first.0..last.0.max(first.0 * 10.0)).log_scale(),
                (last.1.min(0.1) / 1.5..1.2).log_scale(),
            )?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(MESH)
            .x_label_formatter(&|v| format!("{v:.0e}"))
            .y_label_formatter(&|v| format!("{v:.0e}"))
            .x_labels(6)
            .y_labels(7)
            .label_style(("sans-serif", 12).into_font().color(&INK))
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

fn colour(standing: BoxStanding) -> RGBColor {
    match standing {
        BoxStanding::Proved => RGBColor(205, 228, 240),
        BoxStanding::MinorVanishes => RGBColor(213, 94, 0),
        BoxStanding::Pole => RGBColor(20, 24, 32),
        BoxStanding::Undecided => RGBColor(150, 150, 150),
    }
}

/// What a box of a colour is.
fn meaning(standing: BoxStanding) -> &'static str {
    match standing {
        BoxStanding::Proved => "full rank is proved",
        BoxStanding::MinorVanishes => "a minor vanishes somewhere in here",
        BoxStanding::Pole => "a pole runs through",
        BoxStanding::Undecided => "not decided",
    }
}

/// The boxes in a plane, each with its border: pale where full rank is proved, red where a minor is proved to vanish
/// somewhere in the box, black where a pole runs through it, grey where nothing is known.
pub fn region_map(map: &RegionMap, title: &str, units: [Option<&str>; 2]) -> String {
    let meanings =
        [BoxStanding::Proved, BoxStanding::MinorVanishes, BoxStanding::Pole, BoxStanding::Undecided];
    let by_colour = meanings.map(|standing| (colour(standing), meaning(standing).to_owned()));
    Canvas { size: (420, 320), title, by_colour: &by_colour, is_crisp: true }.draw(|area, _| {
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 14).into_font().color(&INK))
            .margin(8)
            .x_label_area_size(38)
            .y_label_area_size(room((map.y.1, map.y.2), |v| number(v, map.y.2 - map.y.1)))
            .build_cartesian_2d(map.x.1..map.x.2, map.y.1..map.y.2)?;
        let smallest = ((map.x.2 - map.x.1) / 100.0, (map.y.2 - map.y.1) / 70.0);
        // all of one standing together, so that they are one path, and then their borders
        // most is proved: the whole first, and then the rest on it
        let whole = [(map.x.1, map.y.1), (map.x.2, map.y.2)];
        chart.draw_series([Rectangle::new(whole, colour(BoxStanding::Proved).filled())])?;
        for standing in meanings.into_iter().filter(|standing| *standing != BoxStanding::Proved) {
            for patch in map.patches.iter().filter(|patch| patch.standing == standing) {
                let corners = [(patch.x.0, patch.y.0), (patch.x.1, patch.y.1)];
                chart.draw_series([Rectangle::new(corners, colour(standing).filled())])?;
            }
        }
        for patch in &map.patches {
            if patch.x.1 - patch.x.0 > smallest.0 && patch.y.1 - patch.y.0 > smallest.1 {
                let corners = [(patch.x.0, patch.y.0), (patch.x.1, patch.y.1)];
                chart.draw_series([Rectangle::new(corners, RGBColor(254, 254, 254).stroke_width(1))])?;
            }
        }
        chart
            .configure_mesh()
            .disable_mesh()
            .x_labels(5)
            .y_labels(6)
            .x_label_formatter(&|v| number(*v, map.x.2 - map.x.1))
            .y_label_formatter(&|v| number(*v, map.y.2 - map.y.1))
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_desc(axis(&map.x.0, units[0]))
            .y_desc(axis(&map.y.0, units[1]))
            .axis_desc_style(("sans-serif", 13))
            .draw()?;
        Ok(())
    })
}
