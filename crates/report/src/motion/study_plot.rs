//! Studies of observers as pictures: the error over noise beside its bound, the first guesses from which a method arrives, and the bounds with palms of
//! other curvatures.

use crate::axis::number;
use crate::drawing::{Canvas, INK, MESH, escaped, svg};
use crate::motion::answers::{Observed, noise_unit};
use crate::motion::plot::with_unit;
use crate::motion::studies::ratio_text;
use palmistry_scenes::{Basin, CurvatureMap};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

const ERROR: RGBColor = RGBColor(0, 114, 178);
const BOUND: RGBColor = RGBColor(213, 94, 0);
const ARRIVES: RGBColor = RGBColor(86, 156, 214);
const FAILS: RGBColor = RGBColor(236, 226, 205);

/// The root of the mean square error of a state and its Cramér-Rao bound over the noise of the measurements, both axes logarithmic.
pub(super) fn noise(observed: &Observed<'_>, place: usize) -> String {
    let names = observed.experiment.names();
    let Some(name) = names.get(place) else { return String::new() };
    let unit = noise_unit(observed);
    let drawn = |value: &f64| value.is_finite() && *value > 0.0;
    let points = |of: fn(&palmistry_scenes::NoiseLevel) -> &Vec<f64>| -> Vec<(f64, f64)> {
        let levels = observed.studied.noise.iter().map(|level| (level.noise, of(level)[place]));
        let mut points: Vec<(f64, f64)> =
            levels.filter(|(noise, value)| drawn(noise) && drawn(value)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    };
    let (errors, bounds) = (points(|level| &level.errors), points(|level| &level.bounds));
    let all = || errors.iter().chain(&bounds);
    let ends = |of: fn(&(f64, f64)) -> f64| {
        let values = all().map(of);
        let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), v| (low.min(v), high.max(v)));
        (low / 1.6, high * 1.6)
    };
    let ((left, right), (low, high)) = (ends(|point| point.0), ends(|point| point.1));
    if all().next().is_none() {
        return format!(
            "<p>{}: no estimate converged at any level of noise, and nothing bounds it</p>",
            escaped(name)
        );
    }
    svg((420, 330), &format!("{name} at the first sample: error over noise"), |area| {
        let (head, plot) = area.split_vertically(48);
        let words = |size: i32| ("sans-serif", size).into_font().color(&INK);
        let anchored = words(12).pos(Pos::new(HPos::Left, VPos::Center));
        head.draw(&Text::new(format!("{name} at the first sample"), (10, 6), words(15)))?;
        head.draw(&Circle::new((20, 36), 5, ERROR.filled()))?;
        head.draw(&Text::new("rms error", (30, 36), anchored.clone()))?;
        head.draw(&PathElement::new([(120, 36), (144, 36)], BOUND.stroke_width(2)))?;
        head.draw(&Text::new("bound of Cramér and Rao", (150, 36), anchored))?;
        let mut chart = ChartBuilder::on(&plot)
            .margin(8)
            .margin_right(24)
            .x_label_area_size(36)
            .y_label_area_size(64)
            .build_cartesian_2d((left..right).log_scale(), (low..high).log_scale())?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(MESH)
            .x_labels(5)
            .y_labels(6)
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_label_formatter(&|v| format!("{v:.0e}"))
            .y_label_formatter(&|v| format!("{v:.0e}"))
            .x_desc(format!("standard deviation of a measurement{}", unit.replacen(' ', ", ", 1)))
            .y_desc(with_unit(observed, name))
            .axis_desc_style(("sans-serif", 12))
            .draw()?;
        chart.draw_series(LineSeries::new(bounds.iter().copied(), BOUND.stroke_width(2)))?;
        chart.draw_series(bounds.iter().map(|point| Circle::new(*point, 2, BOUND.filled())))?;
        chart.draw_series(errors.iter().map(|point| Circle::new(*point, 5, ERROR.filled())))?;
        Ok(())
    })
}

/// The first guesses of two states from which one method arrives, and the truth.
pub(super) fn basin(observed: &Observed<'_>, basin: &Basin) -> String {
    let [columns, rows] = basin.values.each_ref().map(Vec::len);
    let side = |values: &[f64]| -> (f64, f64, f64) {
        let (low, high) = (values[0], values[values.len() - 1]);
        let step = (high - low) / (values.len() - 1) as f64;
        (low - step / 2.0, high + step / 2.0, step)
    };
    if columns < 2 || rows < 2 {
        return "<p>a map needs two values along each side</p>".to_owned();
    }
    let (x, y) = (side(&basin.values[0]), side(&basin.values[1]));
    let start = observed.experiment.signals.times().first().copied().unwrap_or(0.0);
    let names = observed.experiment.names();
    let truth = observed.experiment.truth_at(start).and_then(|truth| {
        let of = |name: &String| names.iter().position(|other| other == name).map(|place| truth[place]);
        Some((of(&basin.names[0])?, of(&basin.names[1])?))
    });
    let title = format!("{}: {:.0}% arrive", basin.method.name(), 100.0 * basin.fraction());
    let by_colour = [(ARRIVES, "arrives".to_owned()), (FAILS, "does not arrive".to_owned())];
    Canvas { size: (380, 390), title: &title, by_colour: &by_colour, is_crisp: true }.draw(|area, _| {
        let (head, plot) = area.split_vertically(48);
        let words = |size: i32| ("sans-serif", size).into_font().color(&INK);
        let anchored = words(12).pos(Pos::new(HPos::Left, VPos::Center));
        head.draw(&Text::new(title.clone(), (10, 6), words(15)))?;
        for (at, colour, text) in
            [(14, ARRIVES, "arrives"), (94, FAILS, "does not"), (184, WHITE, "not tried")]
        {
            head.draw(&Rectangle::new([(at, 30), (at + 14, 42)], colour.filled()))?;
            head.draw(&Rectangle::new([(at, 30), (at + 14, 42)], INK))?;
            head.draw(&Text::new(text, (at + 20, 36), anchored.clone()))?;
        }
        head.draw(&(EmptyElement::at((282, 36)) + Cross::new((0, 0), 6, INK.stroke_width(3))))?;
        head.draw(&Text::new("truth", (294, 36), anchored))?;
        let mut chart = ChartBuilder::on(&plot)
            .margin(8)
            .margin_right(24)
            .x_label_area_size(36)
            .y_label_area_size(54)
            .build_cartesian_2d(x.0..x.1, y.0..y.1)?;
        for (index, arrives) in basin.arrives.iter().enumerate() {
            let Some(arrives) = arrives else { continue };
            let corner = |i: usize, j: usize| (x.0 + x.2 * i as f64, y.0 + y.2 * j as f64);
            let (i, j) = (index % columns, index / columns);
            let colour = match arrives {
                true => ARRIVES,
                false => FAILS,
            };
            chart.draw_series([Rectangle::new([corner(i, j), corner(i + 1, j + 1)], colour.filled())])?;
        }
        chart
            .configure_mesh()
            .disable_mesh()
            .x_labels(6)
            .y_labels(6)
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_label_formatter(&|v| number(*v, x.1 - x.0))
            .y_label_formatter(&|v| number(*v, y.1 - y.0))
            .x_desc(format!("first guess of {}", with_unit(observed, &basin.names[0])))
            .y_desc(format!("first guess of {}", with_unit(observed, &basin.names[1])))
            .axis_desc_style(("sans-serif", 12))
            .draw()?;
        if let Some((a, b)) = truth
            && (x.0..=x.1).contains(&a)
            && (y.0..=y.1).contains(&b)
        {
            chart.draw_series([Cross::new((a, b), 8, INK.stroke_width(3))])?;
        }
        Ok(())
    })
}

/// The Cramér-Rao bound over that of flat palms, over the curvatures of both palms: blue where it is less, ochre where it is more.
pub(super) fn curvature(map: &CurvatureMap) -> String {
    const LESS: RGBColor = ARRIVES;
    const MORE: RGBColor = RGBColor(213, 150, 60);
    let side = map.curvatures.len();
    // four times as much, or a fourth, has the full colour
    let colour = |cell: usize| {
        let ratio = map.ratio(cell)?.median;
        let strength = (ratio.ln() / 4f64.ln()).clamp(-1.0, 1.0);
        let end = if strength < 0.0 { LESS } else { MORE };
        let part = |end: u8| (255.0 + (f64::from(end) - 255.0) * strength.abs()).round() as u8;
        Some(RGBColor(part(end.0), part(end.1), part(end.2)))
    };
    let (low, high) = (map.curvatures[0], map.curvatures[side - 1]);
    let step = (high - low) / (side - 1) as f64;
    let ends = low - step / 2.0..high + step / 2.0;
    let title = "the bound over that between flat palms";
    Canvas { size: (430, 440), title, by_colour: &[], is_crisp: true }.draw(|area, _| {
        let (head, plot) = area.split_vertically(48);
        let words = |size: i32| ("sans-serif", size).into_font().color(&INK);
        let anchored = words(12).pos(Pos::new(HPos::Left, VPos::Center));
        head.draw(&Text::new(title, (10, 6), words(15)))?;
        for (at, colour, text) in
            [(14, LESS, "a fourth"), (104, WHITE, "as flat ones"), (214, MORE, "four times, unobservable")]
        {
            head.draw(&Rectangle::new([(at, 30), (at + 14, 42)], colour.filled()))?;
            head.draw(&Rectangle::new([(at, 30), (at + 14, 42)], INK))?;
            head.draw(&Text::new(text, (at + 20, 36), anchored.clone()))?;
        }
        let mut chart = ChartBuilder::on(&plot)
            .margin(8)
            .margin_right(24)
            .x_label_area_size(36)
            .y_label_area_size(54)
            .build_cartesian_2d(ends.clone(), ends.clone())?;
        let corner = |i: usize, j: usize| (ends.start + step * i as f64, ends.start + step * j as f64);
        // on the pale fields in a dark page, too, where ink is light
        let dark = ("sans-serif", 12).into_font().color(&RGBColor(30, 32, 38));
        let middle = dark.pos(Pos::new(HPos::Center, VPos::Center));
        for cell in 0..map.bounds.len() {
            let (i, j) = (cell % side, cell / side);
            if let Some(colour) = colour(cell) {
                chart.draw_series([Rectangle::new([corner(i, j), corner(i + 1, j + 1)], colour.filled())])?;
            }
            if side <= MOST_WORDS {
                let at = (map.curvatures[i], map.curvatures[j]);
                chart.draw_series([Text::new(ratio_text(map, cell), at, middle.clone())])?;
            }
        }
        chart
            .configure_mesh()
            .disable_mesh()
            .x_labels(6)
            .y_labels(6)
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_label_formatter(&|v| number(*v, high - low))
            .y_label_formatter(&|v| number(*v, high - low))
            .x_desc("curvature of palm 1, 1/m (1/b1)")
            .y_desc("curvature of palm 2, 1/m (1/b2)")
            .axis_desc_style(("sans-serif", 12))
            .draw()?;
        Ok(())
    })
}

/// More fields along a side have no texts in them.
const MOST_WORDS: usize = 9;
