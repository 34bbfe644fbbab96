//! Curves of several observers in one frame: their looks, the axes, and what of a curve fits between these.

use crate::axis::number;
use crate::drawing::{Drawing, INK, MESH, svg};
use palmistry_scenes::Method;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

const TRUTH: RGBColor = RGBColor(190, 196, 206);
/// Where a window ends and the next begins.
const LIMIT: RGBColor = RGBColor(200, 204, 210);
/// Twice the size in which they are shown: places are whole pixels.
const WIDTH: i32 = 800;
const CHART: i32 = 500;
/// No picture needs more places along its axis.
const PLACES: usize = 130;

/// Of outputs, with their marks.
const OUTPUTS: [(RGBColor, usize); 5] = [
    (RGBColor(0, 114, 178), 0),
    (RGBColor(213, 94, 0), 1),
    (RGBColor(0, 158, 115), 3),
    (RGBColor(204, 121, 167), 4),
    (RGBColor(86, 180, 233), 2),
];

/// What a curve shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    Truth,
    Method(Method),
    /// One of several outputs.
    Output(usize),
}

pub(super) struct Curve {
    pub shown: Shown,
    pub name: String,
    pub points: Vec<(f64, f64)>,
}

impl Curve {
    pub fn of_method(method: Method, points: Vec<(f64, f64)>) -> Curve {
        Curve { shown: Shown::Method(method), name: method.name().to_owned(), points }
    }

    pub fn truth(points: Vec<(f64, f64)>) -> Curve {
        Curve { shown: Shown::Truth, name: "true".to_owned(), points }
    }
}

/// Colours that all eyes distinguish; so do the marks' shapes.
fn look(shown: Shown) -> (RGBColor, u32, Option<usize>) {
    match shown {
        Shown::Truth => (TRUTH, 6, None),
        Shown::Method(Method::Newton) => (RGBColor(0, 114, 178), 2, Some(0)),
        Shown::Method(Method::TrustRegion) => (RGBColor(230, 159, 0), 1, Some(1)),
        Shown::Method(Method::MultipleShooting) => (RGBColor(86, 180, 233), 1, Some(0)),
        Shown::Method(Method::Integration) => (RGBColor(110, 110, 110), 1, Some(2)),
        Shown::Method(Method::Kalman) => (RGBColor(0, 158, 115), 1, Some(3)),
        Shown::Method(Method::Unscented) => (RGBColor(0, 90, 70), 1, Some(3)),
        Shown::Method(Method::Smoother) => (RGBColor(120, 190, 60), 1, Some(2)),
        Shown::Method(Method::HighGain) => (RGBColor(204, 80, 150), 1, Some(4)),
        Shown::Output(output) => {
            let (colour, mark) = OUTPUTS[output % OUTPUTS.len()];
            (colour, 1, Some(mark))
        }
    }
}

/// The colour of what is shown.
pub(super) fn colour(shown: Shown) -> RGBColor {
    look(shown).0
}

/// The corners of a mark about a point, in pixels.
fn corners(mark: usize) -> Vec<(i32, i32)> {
    match mark {
        0 => vec![(-4, -8), (4, -8), (8, -4), (8, 4), (4, 8), (-4, 8), (-8, 4), (-8, -4)],
        1 => vec![(-8, -8), (8, -8), (8, 8), (-8, 8)],
        2 => vec![(-10, 8), (10, 8), (0, -10)],
        3 => vec![(0, -12), (10, 0), (0, 12), (-10, 0)],
        _ => vec![(-10, -8), (10, -8), (0, 10)],
    }
}

/// A frame over time.
pub(super) struct Frame<'a> {
    pub title: String,
    /// What stands along the vertical axis.
    pub vertical: String,
    pub times: (f64, f64),
    /// From the lowest to the highest; decimal logarithms where the axis is logarithmic.
    pub range: (f64, f64),
    pub logarithmic: bool,
    /// Where windows end.
    pub limits: &'a [f64],
    /// Error bars: whose, time, lower and upper end.
    pub bars: &'a [(Shown, f64, f64, f64)],
    /// Single dots: whose, time, height.
    pub dots: &'a [(Shown, f64, f64)],
    /// What the single dots are, for the legend.
    pub dots_are: &'a str,
    /// A band of heights, and what it is.
    pub band: Option<((f64, f64), &'a str)>,
}

impl Default for Frame<'_> {
    fn default() -> Self {
        Frame {
            title: String::new(),
            vertical: String::new(),
            times: (0.0, 1.0),
            range: (0.0, 1.0),
            logarithmic: false,
            limits: &[],
            bars: &[],
            dots: &[],
            dots_are: "",
            band: None,
        }
    }
}

/// Draws curves into a frame. What lies above or below the frame is cut off.
pub(super) fn draw(frame: &Frame<'_>, curves: &[Curve]) -> String {
    let (low, high) = frame.range;
    let inside = |y: f64| (low..=high).contains(&y);
    let legend = legend(frame, curves);
    let head = 44 + LINE * legend.last().map_or(0, |entry| entry.0.1 + 1);
    svg((WIDTH as u32, (head + CHART) as u32), &frame.title, |area| {
        let (top, plot) = area.split_vertically(head);
        top.draw(&Text::new(frame.title.clone(), (16, 10), ("sans-serif", 27).into_font().color(&INK)))?;
        for ((x, row), name, sign) in &legend {
            entry(&top, (*x, 60 + LINE * row), name, *sign)?;
        }
        let mut chart = ChartBuilder::on(&plot)
            .margin(16)
            .margin_right(30)
            .x_label_area_size(70)
            .y_label_area_size(120)
            .build_cartesian_2d(frame.times.0..frame.times.1, low..high)?;
        let span = high - low;
        let label = |value: f64| {
            if frame.logarithmic { format!("{:.0e}", 10f64.powf(value)) } else { number(value, span) }
        };
        if let Some(((from, to), _)) = frame.band {
            let corners = [(frame.times.0, from.max(low)), (frame.times.1, to.min(high))];
            chart.draw_series([Rectangle::new(corners, BAND.filled())])?;
        }
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(MESH)
            .x_labels(7)
            .y_labels(7)
            .label_style(("sans-serif", 24).into_font().color(&INK))
            .x_label_formatter(&|v| number(*v, frame.times.1 - frame.times.0))
            .y_label_formatter(&|v| label(*v))
            .x_desc("time, s")
            .y_desc(&frame.vertical)
            .axis_desc_style(("sans-serif", 24))
            .draw()?;
        for limit in frame.limits {
            chart.draw_series(LineSeries::new([(*limit, low), (*limit, high)], LIMIT.stroke_width(2)))?;
        }
        for (place, curve) in curves.iter().enumerate() {
            let (colour, width, mark) = look(curve.shown);
            let points = thinned(&curve.points, frame.times);
            for run in cut(&points, frame.range) {
                chart.draw_series(LineSeries::new(run, colour.stroke_width(2 * width)))?;
            }
            // marks of different curves stand at different times: one curve hides the other, but not its marks
            let Some(mark) = mark else { continue };
            for step in 0..6 {
                let part = (step as f64 + (place as f64 + 0.5) / (curves.len() as f64 + 0.5)) / 6.0;
                let time = frame.times.0 + part * (frame.times.1 - frame.times.0);
                let at = points.iter().find(|point| point.0 >= time).filter(|point| inside(point.1));
                if let Some(at) = at {
                    let shape = EmptyElement::at(*at) + Polygon::new(corners(mark), colour.filled());
                    chart.draw_series([shape])?;
                }
            }
        }
        for (shown, time, from, to) in frame.bars {
            let (from, to) = (from.max(low), to.min(high));
            if (to - from) / span > 0.01 {
                let style = colour(*shown).stroke_width(2);
                chart.draw_series(LineSeries::new([(*time, from), (*time, to)], style))?;
                let cap =
                    |end: f64| EmptyElement::at((*time, end)) + PathElement::new([(-8, 0), (8, 0)], style);
                chart.draw_series([cap(from), cap(to)])?;
            }
        }
        for (shown, time, height) in frame.dots.iter().filter(|dot| inside(dot.2)) {
            chart.draw_series([Circle::new((*time, *height), 8, colour(*shown).stroke_width(4))])?;
        }
        Ok(())
    })
}

/// The sign before a name of the legend.
#[derive(Clone, Copy)]
enum LegendSign {
    Curve(Shown),
    Band,
    Dot,
}

/// The height of a row of the legend.
const LINE: i32 = 30;

/// The entries of the legend, each with its place from the left and its row.
fn legend<'a>(frame: &Frame<'a>, curves: &'a [Curve]) -> Vec<((i32, i32), &'a str, LegendSign)> {
    let curves = curves.iter().map(|curve| (curve.name.as_str(), LegendSign::Curve(curve.shown)));
    let band = frame.band.map(|(_, name)| (name, LegendSign::Band));
    let dots = (!frame.dots.is_empty()).then_some((frame.dots_are, LegendSign::Dot));
    let (mut x, mut row) = (20, 0);
    let mut place = |(name, sign): (&'a str, LegendSign)| {
        let width = 84 + 12 * name.chars().count() as i32;
        if x > 20 && x + width > WIDTH {
            (x, row) = (20, row + 1);
        }
        x += width;
        ((x - width, row), name, sign)
    };
    curves.chain(band).chain(dots).map(&mut place).collect()
}

fn entry(
    area: &Drawing<'_>,
    (x, y): (i32, i32),
    name: &str,
    sign: LegendSign,
) -> Result<(), Box<dyn std::error::Error>> {
    match sign {
        LegendSign::Curve(shown) => {
            let (colour, width, mark) = look(shown);
            area.draw(&PathElement::new([(x, y), (x + 48, y)], colour.stroke_width(2 * width)))?;
            if let Some(mark) = mark {
                area.draw(&(EmptyElement::at((x + 24, y)) + Polygon::new(corners(mark), colour.filled())))?;
            }
        }
        LegendSign::Band => area.draw(&Rectangle::new([(x, y - 12), (x + 48, y + 12)], BAND.filled()))?,
        LegendSign::Dot => area.draw(&Circle::new((x + 24, y), 8, INK.stroke_width(4)))?,
    }
    let words = ("sans-serif", 24).into_font().color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
    area.draw(&Text::new(name.to_owned(), (x + 56, y), words))?;
    Ok(())
}

/// Half transparent, so that it is visible on light and on dark pages.
const BAND: RGBAColor = RGBAColor(200, 170, 80, 0.25);

/// Fewer points that draw the same picture: of each piece of time the first, the lowest, the highest and the last.
fn thinned(points: &[(f64, f64)], times: (f64, f64)) -> Vec<(f64, f64)> {
    if points.len() <= 2 * PLACES {
        return points.to_vec();
    }
    let piece = |time: f64| ((time - times.0) / (times.1 - times.0) * PLACES as f64).floor();
    let mut found = Vec::new();
    for run in points.chunk_by(|a, b| piece(a.0) == piece(b.0)) {
        let by_height = |a: &usize, b: &usize| run[*a].1.total_cmp(&run[*b].1);
        let (lowest, highest) = ((0..run.len()).min_by(by_height), (0..run.len()).max_by(by_height));
        let mut kept = vec![0, lowest.unwrap_or(0), highest.unwrap_or(0), run.len() - 1];
        kept.sort_unstable();
        kept.dedup();
        found.extend(kept.into_iter().map(|place| run[place]));
    }
    found
}

/// The pieces of a curve that lie within a range of heights, cut where it leaves and enters it. A point that has no number ends a
/// piece.
fn cut(points: &[(f64, f64)], (low, high): (f64, f64)) -> Vec<Vec<(f64, f64)>> {
    let inside = |y: f64| (low..=high).contains(&y);
    let mut runs: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut run: Vec<(f64, f64)> = Vec::new();
    for (place, point) in points.iter().enumerate() {
        let before = place.checked_sub(1).map(|place| points[place]);
        let crossing = |from: (f64, f64), to: (f64, f64)| {
            let edge = if from.1 > high || to.1 > high { high } else { low };
            let part = (edge - from.1) / (to.1 - from.1);
            (from.0 + part * (to.0 - from.0), edge)
        };
        let entered = before.filter(|before| !inside(before.1) && before.1.is_finite());
        match (inside(point.1), before.filter(|before| inside(before.1))) {
            (true, _) => {
                run.extend(entered.map(|before| crossing(before, *point)));
                run.push(*point);
            }
            (false, Some(before)) => {
                if point.1.is_finite() {
                    run.push(crossing(before, *point));
                }
                runs.push(std::mem::take(&mut run));
            }
            (false, None) => {}
        }
    }
    runs.push(run);
    runs.retain(|run| run.len() > 1);
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line from 0 to 4 within one and three, by hand: cut at the times one and three.
    #[test]
    fn a_curve_is_cut_at_the_edges() {
        let points: Vec<(f64, f64)> = vec![(0.0, 0.0), (2.0, 2.0), (4.0, 4.0)];
        assert_eq!(cut(&points, (1.0, 3.0)), [vec![(1.0, 1.0), (2.0, 2.0), (3.0, 3.0)]]);
        let gap = [(0.0, 1.0), (1.0, 2.0), (2.0, f64::NAN), (3.0, 2.0), (4.0, 1.0)];
        assert_eq!(cut(&gap, (0.0, 3.0)), [vec![(0.0, 1.0), (1.0, 2.0)], vec![(3.0, 2.0), (4.0, 1.0)]]);
    }

    #[test]
    fn a_thinned_curve_keeps_its_spikes() {
        let mut points: Vec<(f64, f64)> = (0..10_000).map(|i| (f64::from(i) / 1e4, 0.0)).collect();
        (points[4321].1, points[7777].1) = (1.0, -2.0);
        let kept = thinned(&points, (0.0, 1.0));
        assert!(kept.len() <= 4 * PLACES, "{}", kept.len());
        assert!(kept.contains(&points[4321]) && kept.contains(&points[7777]));
        assert!(kept.contains(&points[0]) && kept.contains(&points[9999]));
        assert!(kept.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}
