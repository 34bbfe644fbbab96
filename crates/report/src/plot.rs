//! Plots as SVG, to be put into a page.

mod counts;

pub(crate) use counts::{growth, rounding};

use crate::axis::{axis, axis_in, number, power, room};
use crate::drawing::{Canvas, Cells, Hover, INK, MESH, escaped, on_the_line};
use palmistry_lang::Looks;
use palmistry_math::expression::notation::in_letters;
use palmistry_workbench::tradeoff::{Map, Slope};
use plotters::prelude::{
    ChartBuilder, Circle, Color, IntoFont, IntoLogRange, LineSeries, RGBColor, Rectangle, Text, WHITE,
};

/// Colours of standard deviations, from large (dark, observable poorly) to small (light, observable well).
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
/// Where a singularity is: nearly white, on light and on dark pages.
const POLE: RGBColor = RGBColor(250, 250, 250);
/// Where a standard deviation is infinite: no colour of the scale, and no pole.
const INFINITE: RGBColor = RGBColor(0, 150, 136);
/// What is said of it: doubles cannot decide more.
const INFINITE_TEXT: &str = "infinite: unobservable, or not distinguishable from it";
/// So many decades above the smallest value have colours of their own.
const DECADES: f64 = 6.0;
const RED: RGBColor = RGBColor(200, 40, 60);

/// The steps of the colour scale: levels of the logarithm, two a decade.
fn level(value: f64, lowest: f64, highest: f64) -> usize {
    let part = (value.log10() - lowest) / (highest - lowest).max(1e-9);
    ((part * SHADES as f64).floor().max(0.0) as usize).min(SHADES - 1)
}

const SHADES: usize = 12;

fn shade(level: usize) -> RGBColor {
    let part = level as f64 / (SHADES - 1) as f64 * (SCALE.len() - 1) as f64;
    let (low, rest) = (part.floor() as usize, part.fract());
    let (a, b) = (SCALE[low], SCALE[(low + 1).min(SCALE.len() - 1)]);
    let mix = |x: u8, y: u8| (f64::from(x) * (1.0 - rest) + f64::from(y) * rest).round() as u8;
    RGBColor(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

/// Values whose logarithms differ by less are one value, and the rest rounding errors.
const NO_DIFFERENCE: f64 = 1e-6;

/// What is said in the place of a picture without finite values.
fn nothing(infinite: usize, points: usize) -> String {
    match infinite {
        0 => "nothing to draw: it is singular everywhere".to_owned(),
        count if count == points => {
            "unobservable at all points: the standard deviation is infinite, as far as doubles show"
                .to_owned()
        }
        count => format!(
            "unobservable at {count} of {points} points (as far as doubles show), singular at the others"
        ),
    }
}

/// The standard deviation of an unknown over its prior one, over two coordinates: light where it is small and the unknown is observable
/// well, dark where it is large, green where it is infinite, white at poles. Under the pointer stand the values between which a cell's
/// lies. `units` are those of the two coordinates.
pub(crate) fn map(map: &Map, title: &str, units: [Option<&str>; 2], looks: &Looks) -> String {
    let all = || map.deviations.iter().flatten().copied();
    let found: Vec<f64> = all().filter(|v| v.is_finite() && *v > 0.0).map(f64::log10).collect();
    let infinite = all().filter(|value| value.is_infinite()).count();
    if found.is_empty() {
        return format!(
            "<p>{}: {}</p>",
            escaped(&on_the_line(title)),
            nothing(infinite, map.deviations.len())
        );
    }
    let lowest = found.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = found.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let highest = largest.min(lowest + DECADES);
    let everywhere = highest - lowest < NO_DIFFERENCE && infinite == 0;
    let span = (highest - lowest).max(NO_DIFFERENCE);
    let at = |step: usize| lowest + span * step as f64 / SHADES as f64;
    let values = |step: usize| match step {
        _ if everywhere => format!("{:.3e} prior deviations", 10f64.powf(highest)),
        step if step + 1 == SHADES => format!("above {} prior deviations", power(at(step), span / 10.0)),
        _ => format!(
            "{} to {} prior deviations",
            power(at(step), span / 10.0),
            power(at(step + 1), span / 10.0)
        ),
    };
    let shade = |step: usize| shade(SHADES - 1 - step);
    let mut by_colour: Vec<(RGBColor, String)> =
        (0..SHADES).map(|step| (shade(step), values(step))).collect();
    by_colour.push((POLE, "a singularity".to_owned()));
    by_colour.push((INFINITE, INFINITE_TEXT.to_owned()));
    let beside: Vec<(RGBColor, &str)> =
        [(INFINITE, "infinite", infinite > 0), (POLE, "singularity", map.deviations.contains(&None))]
            .into_iter()
            .filter_map(|(colour, name, is_there)| is_there.then_some((colour, name)))
            .collect();
    let canvas = Canvas { size: (420, 330), title, by_colour: &by_colour, is_crisp: true };
    canvas.draw(|area, extras| {
        let scale_room = room((lowest, lowest + span), |v| power(v, span));
        // the longest word below the scale needs more room than most of its numbers
        let words_room = if beside.iter().any(|(colour, _)| *colour == POLE) { 78 } else { 60 };
        let (plot, legend) = area.split_horizontally(420 - scale_room.max(words_room) as i32 - 20);
        let spans = [map.x.high - map.x.low, map.y.high - map.y.low];
        let mut chart = ChartBuilder::on(&plot)
            .caption(title, ("sans-serif", 14).into_font().color(&INK))
            .margin(8)
            .margin_right(20)
            .x_label_area_size(38)
            .y_label_area_size(room((map.y.low, map.y.high), |v| number(v, spans[1])))
            .build_cartesian_2d(map.x.low..map.x.high, map.y.low..map.y.high)?;
        let colour = |cell: &Option<f64>| match cell {
            None => POLE,
            Some(_) if everywhere => shade(SHADES / 2),
            Some(value) if value.is_infinite() => INFINITE,
            Some(value) => shade(level(value.max(f64::MIN_POSITIVE), lowest, lowest + span)),
        };
        let (low, high) =
            (chart.backend_coord(&(map.x.low, map.y.low)), chart.backend_coord(&(map.x.high, map.y.high)));
        extras.cells = Some(Cells {
            corners: [low.0, high.1, high.0, low.1],
            columns: map.width.div_ceil(BLOCK),
            colours: blocks(map).iter().map(colour).collect(),
        });
        chart
            .configure_mesh()
            .disable_mesh()
            .x_labels(5)
            .y_labels(6)
            .x_label_formatter(&|v| number(*v, spans[0]))
            .y_label_formatter(&|v| number(*v, spans[1]))
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_desc(axis_in(&map.x.name, units[0], looks))
            .y_desc(axis_in(&map.y.name, units[1], looks))
            .axis_desc_style(("sans-serif", 13))
            .draw()?;
        let words = ("sans-serif", 12).into_font().color(&INK);
        // what is no number has its field below the scale
        for (row, (colour, name)) in beside.iter().enumerate() {
            let top = 330 - 18 * (beside.len() - row) as i32;
            legend.draw(&Rectangle::new([(4, top), (16, top + 10)], colour.filled()))?;
            legend.draw(&Text::new((*name).to_owned(), (20, top), words.clone()))?;
        }
        if everywhere {
            for (row, line) in ["everywhere", &format!("{:.3e}", 10f64.powf(highest))].iter().enumerate() {
                legend.draw(&Text::new((*line).to_owned(), (4, 60 + 18 * row as i32), words.clone()))?;
            }
            return Ok(());
        }
        legend.draw(&Text::new("poorly", (4, 14), words.clone()))?;
        legend.draw(&Text::new("well", (4, 270), words))?;
        let mut scale = ChartBuilder::on(&legend)
            .margin_top(34)
            .margin_bottom(64)
            .margin_right(8)
            .y_label_area_size(scale_room - 18)
            .build_cartesian_2d(0.0..1.0, lowest..lowest + span)?;
        for step in 0..SHADES {
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
            .y_label_style(("sans-serif", 12).into_font().color(&INK))
            .y_label_formatter(&|v| power(*v, span))
            .draw()?;
        Ok(())
    })
}

/// So many cells along each side are drawn as one.
const BLOCK: usize = 2;

/// The cells that are drawn, by rows from the top: of those of a block a pole, else the largest value, so that nothing that is
/// not observable is lost.
fn blocks(map: &Map) -> Vec<Option<f64>> {
    let rows: Vec<&[Option<f64>]> = map.deviations.chunks(map.width).collect();
    let of_band = |band: &[&[Option<f64>]]| -> Vec<Option<f64>> {
        let columns = (0..map.width).step_by(BLOCK);
        let block = |left: usize| {
            let cells = band.iter().flat_map(|row| &row[left..(left + BLOCK).min(row.len())]);
            cells.copied().try_fold(0.0, |most: f64, cell| Some(most.max(cell?)))
        };
        columns.map(block).collect()
    };
    rows.chunks(BLOCK).rev().flat_map(of_band).collect()
}

/// The standard deviations over their prior ones on the way into a singularity, both axes logarithmic: the worst in red, a bar above
/// the scale where one is infinite. Under the pointer stand all of them at a distance.
pub(crate) fn slope(slope: &Slope, title: &str, unit: Option<&str>) -> String {
    let all = || slope.values.iter().flatten().flatten().copied();
    let values: Vec<f64> = all().filter(|v| v.is_finite() && *v > 0.0).collect();
    let infinite =
        slope.values.iter().flatten().filter(|point| point.iter().any(|v| v.is_infinite())).count();
    if values.is_empty() {
        return format!("<p>{}: {}</p>", escaped(title), nothing(infinite, slope.distance.len()));
    }
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(0.0, f64::max);
    let (lowest, top) = (least / 2.0, most * 2.0);
    // what is infinite lies above a line of its own, a tenth of the height
    let room_above = if infinite > 0 { (top / lowest).powf(0.12).max(1.3) } else { 1.0 };
    let highest = top * room_above;
    let above = (top * highest).sqrt();
    let (near, far) =
        (slope.distance.last().copied().unwrap_or(1e-14), slope.distance.first().copied().unwrap_or(1.0));
    Canvas { size: (420, 300), title, by_colour: &[], is_crisp: false }.draw(|area, extras| {
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 14).into_font().color(&INK))
            .margin(8)
            .margin_right(20)
            .x_label_area_size(36)
            .y_label_area_size(62)
            .build_cartesian_2d((near..far).log_scale(), (lowest..highest).log_scale())?;
        let label = |v: &f64| if *v > top && infinite > 0 { String::new() } else { format!("{v:.0e}") };
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(MESH)
            .x_labels(6)
            .y_labels(7)
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_label_formatter(&|v| format!("{v:.0e}"))
            .y_label_formatter(&label)
            .x_desc(axis("distance", unit))
            .y_desc("deviation / prior deviation")
            .axis_desc_style(("sans-serif", 12))
            .draw()?;
        let worst = |point: &Vec<f64>| point.iter().copied().fold(0.0, f64::max);
        let series = |of: &dyn Fn(&Vec<f64>) -> f64| -> Vec<(f64, f64)> {
            let points = slope.distance.iter().zip(&slope.values);
            points.filter_map(|(d, point)| Some((*d, of(point.as_ref()?)))).collect()
        };
        // of lines that lie on each other, as those of measured states do at 1, one is drawn
        let mut drawn: Vec<Vec<Option<(i32, i32)>>> = Vec::new();
        for index in 0..slope.names.len() {
            let (colour, line) = (LINES[index % LINES.len()], series(&|point| point[index]));
            let place = |point: &(f64, f64)| point.1.is_finite().then(|| chart.backend_coord(point));
            let places = line.iter().map(place).collect();
            if drawn.contains(&places) {
                continue;
            }
            drawn.push(places);
            for run in line.split(|(_, value)| value.is_infinite()) {
                chart.draw_series(LineSeries::new(run.iter().copied(), colour.stroke_width(1)))?;
            }
        }
        let worst = series(&worst);
        for run in worst.split(|(_, value)| value.is_infinite()) {
            chart.draw_series(LineSeries::new(run.iter().copied(), RED.stroke_width(2)))?;
        }
        for run in worst.split(|(_, value)| value.is_finite()) {
            let there: Vec<(f64, f64)> = run.iter().map(|(distance, _)| (*distance, above)).collect();
            match there.as_slice() {
                [alone] => {
                    chart.draw_series([Circle::new(*alone, 2, INFINITE.filled())])?;
                }
                [first, .., last] => {
                    chart.draw_series(LineSeries::new([*first, *last], INFINITE.stroke_width(4)))?;
                }
                [] => {}
            }
        }
        if infinite > 0 {
            chart.draw_series(LineSeries::new([(near, top), (far, top)], MESH.stroke_width(1)))?;
            let place = chart.backend_coord(&(near, above));
            let words = ("sans-serif", 12).into_font().color(&INK);
            area.draw(&Text::new("infinite", (place.0 - 48, place.1 - 6), words))?;
        }
        let place = |distance: f64, value: f64| chart.backend_coord(&(distance, value));
        let (top, bottom) = (place(far, highest).1, place(far, lowest).1);
        extras.hovers.extend(columns(slope, |distance| place(distance, lowest).0, [top, bottom]));
        Ok(())
    })
}

/// Colours of all unknowns under the worst, visible on light and dark pages.
const LINES: [RGBColor; 4] =
    [RGBColor(112, 90, 200), RGBColor(0, 135, 190), RGBColor(0, 150, 110), RGBColor(150, 130, 60)];

/// The stripes of a line, which are as wide as a finger.
const STRIPES: usize = 6;

/// More names of one value are said as all others.
const MOST_NAMED: usize = 3;

/// A stripe around every few distances, and what stands there; neighbours are one where all distances between them have the same
/// values, those that have no stripe too.
fn columns(slope: &Slope, place: impl Fn(f64) -> i32, [top, bottom]: [i32; 2]) -> Vec<Hover> {
    let said = |values: &Option<Vec<f64>>| match values {
        None => "a singularity".to_owned(),
        Some(values) => {
            let number =
                |value: &f64| if value.is_finite() { format!("{value:.1e}") } else { "infinite".to_owned() };
            // those of one value together: most are at 1, or infinite
            let mut groups: Vec<(String, Vec<String>)> = Vec::new();
            for (name, value) in slope.names.iter().zip(values) {
                let value = number(value);
                match groups.iter_mut().find(|(known, _)| *known == value) {
                    Some((_, names)) => names.push(in_letters(name)),
                    None => groups.push((value, vec![in_letters(name)])),
                }
            }
            // the most that share a value come last, and need no names
            groups.sort_by_key(|(_, names)| names.len() > MOST_NAMED);
            let texts = groups.iter().enumerate().map(|(place, (value, names))| {
                let are_others = names.len() > MOST_NAMED && place + 1 == groups.len() && place > 0;
                let names = if are_others { "all others".to_owned() } else { names.join(", ") };
                format!("{names} {value}")
            });
            texts.collect::<Vec<_>>().join("; ")
        }
    };
    let all: Vec<(f64, String)> = slope
        .distance
        .iter()
        .zip(&slope.values)
        .map(|(distance, values)| (*distance, said(values)))
        .collect();
    let shown: Vec<usize> = (0..all.len()).step_by(all.len().div_ceil(STRIPES).max(1)).collect();
    let places: Vec<i32> = shown.iter().map(|index| place(all[*index].0)).collect();
    let mut stripes = Vec::new();
    let mut first = 0;
    for run in shown.chunk_by(|a, b| all[*a..=*b].windows(2).all(|pair| pair[0].1 == pair[1].1)) {
        let last = first + run.len() - 1;
        let half = |a: usize, b: usize| (places[a] + places[b]) / 2;
        let ends = [half(first.saturating_sub(1), first), half(last, (last + 1).min(places.len() - 1))];
        let [(from, values), (to, _)] = [&all[shown[first]], &all[shown[last]]];
        let distances = if first == last { format!("{from:.0e}") } else { format!("{from:.0e} to {to:.0e}") };
        let corners = [ends[0].min(ends[1]), top, ends[0].max(ends[1]), bottom];
        if corners[2] > corners[0] {
            stripes.push(Hover { corners, text: format!("{distances}: {values}") });
        }
        first = last + 1;
    }
    stripes
}

#[cfg(test)]
mod tests {
    use super::*;
    use palmistry_lang::CoordinateRange;
    use palmistry_workbench::tradeoff::PictureScales;

    /// Neighbours are one stripe where nothing between them differs: a dip that no stripe shows separates them.
    #[test]
    fn a_stripe_says_what_holds_all_over_it() {
        let stripes = |dip: Option<usize>| {
            let value = |i: usize| Some(if Some(i) == dip { vec![1e-3] } else { vec![1.0] });
            let slope = Slope {
                distance: (0..64).map(|i| 10f64.powi(-i)).collect(),
                names: vec!["x".to_owned()],
                values: (0..64).map(value).collect(),
                scales: no_scales(),
            };
            let place = |distance: f64| (10.0 * -distance.log10()).round() as i32;
            columns(&slope, place, [0, 9]).into_iter().map(|hover| hover.text).collect::<Vec<_>>()
        };
        assert_eq!(stripes(None), ["1e0 to 1e-55: x 1.0e0"]);
        assert_eq!(stripes(Some(17)), ["1e0 to 1e-11: x 1.0e0", "1e-22 to 1e-55: x 1.0e0"]);
        let nothing = Slope { distance: vec![], names: vec![], values: vec![], scales: no_scales() };
        assert!(columns(&nothing, |_| 0, [0, 9]).is_empty());
    }

    /// What differs by rounding alone is one value, said once; what differs by little has a scale that shows it.
    #[test]
    fn a_constant_map_says_its_value() {
        let axis = |name: &str| CoordinateRange { name: name.to_owned(), low: -10_000.0, high: 10_000.0 };
        let of = |deviations: Vec<f64>| {
            let deviations = deviations.into_iter().map(Some).collect();
            super::map(
                &of_cells([axis("x"), axis("y")], 2, deviations),
                "a map",
                [None; 2],
                &Looks::default(),
            )
        };
        let flat = of(vec![0.5, 0.5 + 1e-14, 0.5, 0.5 - 1e-14]);
        assert!(flat.contains(">everywhere<") && flat.contains(">5.000e-1<"), "{flat}");
        assert!(flat.contains(">-10000<") && !flat.contains("5e-1<"), "{flat}");
        let sloped = of(vec![0.5, 0.5001, 0.5002, 0.5003]);
        let labels: Vec<&str> = sloped.split("</text>").filter_map(|part| part.rsplit('>').next()).collect();
        let scale: Vec<&&str> = labels.iter().filter(|label| label.ends_with("e-1")).collect();
        let distinct: std::collections::BTreeSet<_> = scale.iter().collect();
        assert!(scale.len() > 2 && distinct.len() == scale.len(), "{labels:?}");
    }

    fn no_scales() -> PictureScales {
        PictureScales { priors: vec![], noise: vec![] }
    }

    fn of_cells([x, y]: [CoordinateRange<f64>; 2], width: usize, deviations: Vec<Option<f64>>) -> Map {
        let height = deviations.len() / width;
        let worst = vec![None; deviations.len()];
        Map { x, y, width, height, deviations, worst, shown: vec![], scales: no_scales() }
    }

    /// What is infinite is neither the largest number nor a pole, and light is well observable.
    #[test]
    fn what_is_infinite_has_a_colour_of_its_own() {
        let axis = |name: &str| CoordinateRange { name: name.to_owned(), low: 0.0, high: 1.0 };
        let row = [
            Some(1.0),
            Some(1.0),
            Some(1e6),
            Some(1e6),
            Some(f64::INFINITY),
            Some(f64::INFINITY),
            None,
            None,
        ];
        let all: Vec<Option<f64>> = row.into_iter().chain(row).collect();
        let found =
            super::map(&of_cells([axis("x"), axis("y")], 8, all), "a map", [None; 2], &Looks::default());
        let cell = |title: &str, x: usize| {
            let path = found.split("<path stroke=").find(|path| path.contains(&format!("<title>{title}")));
            assert!(path.is_some_and(|path| path.contains(&format!("d=\"m{x} 0h1"))), "{title}: {found}");
        };
        cell("1.0e0 to", 0);
        cell("above", 1);
        cell(INFINITE_TEXT, 2);
        cell("a singularity", 3);
        for word in [">well<", ">poorly<", ">infinite<", ">singularity<"] {
            assert!(found.contains(word), "{word}: {found}");
        }
        let RGBColor(r, g, b) = shade(SHADES - 1);
        assert!(found.contains(&format!("stroke=\"#{r:02x}{g:02x}{b:02x}\" d=\"m0 0h1")), "{found}");
        let only = super::map(
            &of_cells([axis("x"), axis("y")], 2, vec![Some(f64::INFINITY); 4]),
            "a map",
            [None; 2],
            &Looks::default(),
        );
        assert!(only.contains("unobservable at all points"), "{only}");
    }

    /// By hand: three by three cells, of which the lowest row is the last that is drawn.
    #[test]
    fn what_is_not_observable_is_drawn() {
        let deviations = vec![
            Some(1.0),
            Some(2.0),
            Some(f64::INFINITY),
            Some(4.0),
            None,
            Some(6.0),
            Some(7.0),
            Some(8.0),
            Some(9.0),
        ];
        let axis = |name: &str| CoordinateRange { name: name.to_owned(), low: 0.0, high: 1.0 };
        let map = of_cells([axis("x"), axis("y")], 3, deviations);
        assert_eq!(blocks(&map), [Some(8.0), Some(9.0), None, Some(f64::INFINITY)]);
    }
}
