//! Pictures of the body between its palms, and of the outline that was recovered.

use crate::drawing::{Drawing, INK, svg};
use crate::motion::answers::Observed;
use palmistry_bodies::mechanics::Palm;
use palmistry_bodies::mechanics::moving::Shape;
use palmistry_scenes::{TouchInstant, TouchTrack, on_palm, turned};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// What each palm touched, recovered.
pub(super) const PALM_COLOURS: [RGBColor; 2] = [RGBColor(0, 114, 178), RGBColor(213, 94, 0)];
pub(super) const TRUE_OUTLINE: RGBColor = RGBColor(150, 156, 165);
/// Recovered where the state was unobservable.
const UNSEEN: RGBColor = RGBColor(205, 209, 215);
/// Twice the size in which they are shown: places are whole pixels, and a curve of few pixels is not smooth.
const CELL: (u32, u32) = (400, 336);

/// Pieces of a palm that is an arc.
const ARC: u32 = 48;

/// A place in the world or the body's frame as a pixel.
pub(super) struct View {
    scale: f64,
    middle: [f64; 2],
    centre: [f64; 2],
}

impl View {
    /// Shows all of some places in a rectangle of pixels, `x` and `y` to one scale.
    pub fn of(places: impl Iterator<Item = [f64; 2]>, size: (f64, f64)) -> View {
        let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for place in places {
            for (end, value) in ends.iter_mut().zip(place) {
                *end = [end[0].min(value), end[1].max(value)];
            }
        }
        let spread = ends.map(|[low, high]| (high - low).max(1e-9));
        View {
            scale: (size.0 / spread[0]).min(size.1 / spread[1]),
            middle: ends.map(|[low, high]| f64::midpoint(low, high)),
            centre: [size.0 / 2.0, size.1 / 2.0],
        }
    }

    pub fn pixel(&self, [x, y]: [f64; 2], corner: (f64, f64)) -> (i32, i32) {
        let at = [x - self.middle[0], self.middle[1] - y];
        let [x, y] = [0, 1].map(|i| self.centre[i] + self.scale * at[i]);
        ((corner.0 + x).round() as i32, (corner.1 + y).round() as i32)
    }
}

/// Where the body is at a sample: as it truly was where that is known, as recovered otherwise.
fn pose(observed: &Observed<'_>, instant: &TouchInstant) -> ([f64; 2], f64) {
    let moments = observed.experiment.simulation.as_ref().map(|simulation| &simulation.trajectory.moments);
    let row = |moments: &Vec<palmistry_bodies::mechanics::moving::Moment>| {
        moments.partition_point(|moment| moment.time < instant.time).min(moments.len() - 1)
    };
    match moments.filter(|moments| !moments.is_empty()) {
        Some(moments) => (moments[row(moments)].centre, moments[row(moments)].phi0),
        None => (instant.centre, instant.orientation),
    }
}

fn placed(point: [f64; 2], (centre, angle): ([f64; 2], f64)) -> [f64; 2] {
    let [x, y] = turned(point, angle);
    [centre[0] + x, centre[1] + y]
}

/// Small dots for what was recovered by each palm; dots that would cover each other are left out.
fn dots(
    area: &Drawing<'_>,
    instants: &[TouchInstant],
    size: i32,
    pixel: impl Fn([f64; 2]) -> (i32, i32),
) -> Result<(), Box<dyn std::error::Error>> {
    for (palm, colour) in PALM_COLOURS.into_iter().enumerate() {
        let mut last: Option<(i32, i32)> = None;
        for instant in instants {
            let (x, y) = pixel(instant.points[palm]);
            if last.is_none_or(|(a, b)| (x - a).abs().max((y - b).abs()) > size) {
                let colour = if instant.is_observed { colour } else { UNSEEN };
                area.draw(&Circle::new((x, y), size, colour.filled()))?;
                last = Some((x, y));
            }
        }
    }
    Ok(())
}

/// As figure 4.3: the palms, the true outline, the contacts and the centre of mass at some samples, the last among them, and
/// the part of the outline that is recovered by then, a picture each; at most `most`.
pub(super) fn frames(observed: &Observed<'_>, outline: &TouchTrack, most: usize) -> Vec<String> {
    let instants = &outline.instants;
    let count = most.min(instants.len());
    let rows: Vec<usize> = (1..=count).map(|frame| frame * instants.len() / count - 1).collect();
    let (contacts, sensed) =
        (instants.iter().flat_map(|i| i.contacts), instants.iter().flat_map(|i| i.sensed));
    let longest = contacts.map(|[x, y]| x.hypot(y)).fold(0.0, f64::max);
    let farthest = sensed.fold(0.0, f64::max);
    // from the joint to its end
    let palm = |instant: &TouchInstant, i: usize| -> Vec<[f64; 2]> {
        let angle = instant.palms[i];
        match outline.forms[i] {
            Palm::Flat => vec![[0.0; 2], [1.15 * longest * angle.cos(), 1.15 * longest * angle.sin()]],
            form => (0..=ARC)
                .map(|k| on_palm(&form, i, angle, 1.15 * farthest * f64::from(k) / f64::from(ARC)))
                .collect(),
        }
    };
    let shape = observed.experiment.simulation.as_ref().map(|simulation| &simulation.shape);
    let sides: Vec<[f64; 2]> = shape.map(|shape| shape.outline(180)).unwrap_or_default();
    let everywhere = rows.iter().flat_map(|row| {
        let instant = &instants[*row];
        let pose = pose(observed, instant);
        let palms = [palm(instant, 0), palm(instant, 1)].concat();
        let points = instants[..=*row].iter().flat_map(|instant| instant.points).chain(sides.clone());
        palms.into_iter().chain(points.map(move |point| placed(point, pose)))
    });
    let view = View::of(everywhere, (f64::from(CELL.0) - 48.0, f64::from(CELL.1) - 80.0));
    let frame = |row: &usize| {
        let instant = &instants[*row];
        let time = format!("{:.3} s", instant.time);
        svg(CELL, &format!("the body between its palms at {time}"), |area| {
            let pixel = |place: [f64; 2]| view.pixel(place, (24.0, 56.0));
            let pose = pose(observed, instant);
            let style = ("sans-serif", 26).into_font().color(&INK);
            area.draw(&Text::new(time.clone(), (20, 10), style))?;
            for i in 0..2 {
                let points: Vec<(i32, i32)> = palm(instant, i).into_iter().map(pixel).collect();
                area.draw(&PathElement::new(points, INK.stroke_width(5)))?;
            }
            closed(area, sides.iter().map(|point| pixel(placed(*point, pose))), 2)?;
            dots(area, &instants[..=*row], 3, |point| pixel(placed(point, pose)))?;
            for place in [pose.0, instant.contacts[0], instant.contacts[1]] {
                area.draw(&Circle::new(pixel(place), 8, INK.filled()))?;
            }
            Ok(())
        })
    };
    rows.iter().map(frame).collect()
}

fn closed(
    area: &Drawing<'_>,
    points: impl Iterator<Item = (i32, i32)>,
    width: u32,
) -> Result<(), Box<dyn std::error::Error>> {
    let mut points: Vec<(i32, i32)> = points.collect();
    points.extend(points.first().copied());
    if points.len() > 2 {
        area.draw(&PathElement::new(points, TRUE_OUTLINE.stroke_width(width)))?;
    }
    Ok(())
}

/// The true outline, where it is known, and the recovered points, in the frame of the body.
pub(super) fn recovered_outline(shape: Option<&Shape>, outline: &TouchTrack) -> String {
    const SIZE: (u32, u32) = (800, 720);
    let sides: Vec<[f64; 2]> = shape.map(|shape| shape.outline(360)).unwrap_or_default();
    let everywhere = sides.iter().copied().chain(outline.instants.iter().flat_map(|i| i.points));
    let view = View::of(everywhere.chain([[0.0; 2]]), (f64::from(SIZE.0) - 120.0, f64::from(SIZE.1) - 250.0));
    let pixel = |place: [f64; 2]| view.pixel(place, (60.0, 150.0));
    svg(SIZE, "the outline in the body's frame", |area| {
        let words = |size: i32| ("sans-serif", size).into_font().color(&INK);
        let left = |size: i32| words(size).pos(Pos::new(HPos::Left, VPos::Center));
        area.draw(&Text::new("outline in the body's frame", (20, 10), words(28)))?;
        let mut x = 28;
        for (text, colour) in [("touched by palm 1", PALM_COLOURS[0]), ("touched by palm 2", PALM_COLOURS[1])]
        {
            area.draw(&Circle::new((x, 68), 6, colour.filled()))?;
            area.draw(&Text::new(text, (x + 16, 68), left(24)))?;
            x += 280;
        }
        let x = 28;
        if shape.is_some() {
            area.draw(&PathElement::new([(x, 104), (x + 44, 104)], TRUE_OUTLINE.stroke_width(6)))?;
            area.draw(&Text::new("true", (x + 56, 104), left(24)))?;
        }
        if !outline.instants.iter().all(|instant| instant.is_observed) {
            area.draw(&Circle::new((x + 160, 104), 6, UNSEEN.filled()))?;
            area.draw(&Text::new("not observable", (x + 178, 104), left(24)))?;
        }
        closed(area, sides.iter().map(|point| pixel(*point)), 6)?;
        dots(area, &outline.instants, 4, pixel)?;
        area.draw(&Circle::new(pixel([0.0; 2]), 10, INK.filled()))?;
        let (x, y) = pixel([0.0; 2]);
        area.draw(&Text::new("centre of mass", (x + 20, y), left(24)))?;
        // a rule of a round length
        let wide = f64::from(SIZE.0) / 4.0 / view.scale;
        let power = 10f64.powf(wide.log10().floor());
        let length = [5.0, 2.0, 1.0].into_iter().map(|k| k * power).find(|length| *length <= wide);
        let length = length.unwrap_or(power);
        let (right, low) = (60 + (length * view.scale).round() as i32, SIZE.1 as i32 - 52);
        area.draw(&PathElement::new([(60, low), (right, low)], INK.stroke_width(4)))?;
        area.draw(&Text::new(format!("{length} m"), (right + 16, low), left(24)))?;
        Ok(())
    })
}
