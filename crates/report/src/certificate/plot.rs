//! Certificates on regions, as pictures.

use crate::axis::{axis, number, room};
use crate::drawing::{Canvas, Cells, INK, MESH, svg};
use palmistry_prove::certificate::{BoxStanding, Patch, RegionAnswer, RegionMap};

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
            .margin_right(28)
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
        BoxStanding::Pole => "a singularity in it",
        BoxStanding::Undecided => "not decided",
    }
}

const STANDINGS: [BoxStanding; 4] =
    [BoxStanding::Proved, BoxStanding::MinorVanishes, BoxStanding::Pole, BoxStanding::Undecided];

/// More boxes than these are drawn as cells on a page.
const MOST_PATCHES: usize = 200;
/// Cells across and up.
const GRID: [usize; 2] = [84, 60];

/// What is in each cell, by rows from the top: of several boxes the one that a reader must not miss.
fn cells(map: &RegionMap) -> Vec<BoxStanding> {
    let weight = |standing: &BoxStanding| match standing {
        BoxStanding::Proved => 0,
        BoxStanding::Undecided => 1,
        BoxStanding::MinorVanishes => 2,
        BoxStanding::Pole => 3,
    };
    let mut found = vec![BoxStanding::Proved; GRID[0] * GRID[1]];
    // all that a box touches: a cell is pale only where nothing else reaches into it
    let touched = |(low, high): (f64, f64), (from, to): (f64, f64), count: usize| {
        let place = |value: f64| ((value - from) / (to - from) * count as f64).clamp(0.0, count as f64);
        let first = (place(low).floor() as usize).min(count - 1);
        first..(place(high).ceil() as usize).clamp(first + 1, count)
    };
    for patch in &map.patches {
        for row in touched(patch.y, (map.y.low, map.y.high), GRID[1]) {
            for column in touched(patch.x, (map.x.low, map.x.high), GRID[0]) {
                let cell = &mut found[(GRID[1] - 1 - row) * GRID[0] + column];
                *cell = [*cell, patch.standing].into_iter().max_by_key(weight).unwrap_or(*cell);
            }
        }
    }
    found
}

/// The boxes with their borders: most is proved, so that it is drawn as one and the rest on it.
fn draw_patches(map: &RegionMap, mut draw: impl FnMut(Rectangle<(f64, f64)>) -> Drawn) -> Drawn {
    let smallest = ((map.x.high - map.x.low) / 100.0, (map.y.high - map.y.low) / 70.0);
    let whole = [(map.x.low, map.y.low), (map.x.high, map.y.high)];
    draw(Rectangle::new(whole, colour(BoxStanding::Proved).filled()))?;
    let corners = |patch: &Patch| [(patch.x.0, patch.y.0), (patch.x.1, patch.y.1)];
    for standing in STANDINGS.into_iter().filter(|standing| *standing != BoxStanding::Proved) {
        for patch in map.patches.iter().filter(|patch| patch.standing == standing) {
            draw(Rectangle::new(corners(patch), colour(standing).filled()))?;
        }
    }
    let is_large = |patch: &&Patch| patch.x.1 - patch.x.0 > smallest.0 && patch.y.1 - patch.y.0 > smallest.1;
    for patch in map.patches.iter().filter(is_large) {
        draw(Rectangle::new(corners(patch), RGBColor(254, 254, 254).stroke_width(1)))?;
    }
    Ok(())
}

type Drawn = Result<(), Box<dyn std::error::Error>>;

/// The boxes in a plane, each with its border: pale where full rank is proved, red where a minor is proved to vanish
/// somewhere in the box, black where a pole runs through it, grey where nothing is known.
pub fn region_map(map: &RegionMap, title: &str, units: [Option<&str>; 2]) -> String {
    drawn(map, title, units, usize::MAX)
}

/// The same for a page: where boxes are too many their plane is drawn in cells, without borders.
pub(crate) fn region_map_in_short(map: &RegionMap, title: &str, units: [Option<&str>; 2]) -> String {
    drawn(map, title, units, MOST_PATCHES)
}

fn drawn(map: &RegionMap, title: &str, units: [Option<&str>; 2], most_patches: usize) -> String {
    let by_colour = STANDINGS.map(|standing| (colour(standing), meaning(standing).to_owned()));
    Canvas { size: (420, 320), title, by_colour: &by_colour, is_crisp: true }.draw(|area, extras| {
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 14).into_font().color(&INK))
            .margin(8)
            .margin_right(28)
            .x_label_area_size(38)
            .y_label_area_size(room((map.y.low, map.y.high), |v| number(v, map.y.high - map.y.low)))
            .build_cartesian_2d(map.x.low..map.x.high, map.y.low..map.y.high)?;
        if map.patches.len() > most_patches {
            let low = chart.backend_coord(&(map.x.low, map.y.low));
            let high = chart.backend_coord(&(map.x.high, map.y.high));
            let colours = cells(map).into_iter().map(colour).collect();
            extras.cells = Some(Cells { corners: [low.0, high.1, high.0, low.1], columns: GRID[0], colours });
        } else {
            draw_patches(map, |rectangle| {
                chart.draw_series([rectangle])?;
                Ok(())
            })?;
        }
        chart
            .configure_mesh()
            .disable_mesh()
            .x_labels(5)
            .y_labels(6)
            .x_label_formatter(&|v| number(*v, map.x.high - map.x.low))
            .y_label_formatter(&|v| number(*v, map.y.high - map.y.low))
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_desc(axis(&map.x.name, units[0]))
            .y_desc(axis(&map.y.name, units[1]))
            .axis_desc_style(("sans-serif", 13))
            .draw()?;
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use palmistry_lang::CoordinateRange;

    /// A cell is pale only where nothing else reaches into it: a small box on the border of two cells shows in both.
    #[test]
    fn a_cell_shows_what_reaches_into_it() {
        let patch = |x, y, standing| Patch { x, y, standing };
        let wide = (1.0 - 0.01, 1.0 + 0.01);
        let patches = vec![
            patch((0.0, GRID[0] as f64), (0.0, GRID[1] as f64), BoxStanding::Proved),
            patch(wide, (0.0, 0.5), BoxStanding::Undecided),
            patch((5.0, 5.0), (GRID[1] as f64, GRID[1] as f64), BoxStanding::Pole),
        ];
        let axis = |name: &str, count: usize| CoordinateRange {
            name: name.to_owned(),
            low: 0.0,
            high: count as f64,
        };
        let map = RegionMap { x: axis("x", GRID[0]), y: axis("y", GRID[1]), patches, at: Vec::new() };
        let found = cells(&map);
        let lowest = (GRID[1] - 1) * GRID[0];
        assert_eq!(
            found[lowest..lowest + 3],
            [BoxStanding::Undecided, BoxStanding::Undecided, BoxStanding::Proved]
        );
        assert_eq!(found[4..6], [BoxStanding::Proved, BoxStanding::Pole]);
        assert_eq!(found.iter().filter(|standing| **standing != BoxStanding::Proved).count(), 3);
    }
}
