//! A factor: an expression of which it matters where in a box it is zero.
//!
//! That it is zero nowhere is proved by its range over the box, enclosed three ways: as it is written; with every
//! coordinate in which it is monotone put to the end where it comes nearest to zero (again and again, since others may
//! become monotone on that face); and by the mean value theorem in the coordinates that are left. That it is zero
//! somewhere is proved by two points at which it has opposite signs.

use super::boxes::{Chart, Place, SlotValues};
use super::tape::{Room, Tape};
use crate::number::Interval;

/// An expression with all that is needed to decide whether it vanishes on a box.
#[derive(Clone, Debug)]
pub(super) struct Factor {
    /// As a paper would write it.
    pub text: String,
    pub tape: Tape,
    /// Expressions that are multiples of it by something finite: where one of them is not zero it is not either.
    pub witnesses: Vec<Tape>,
    /// Whether it has to be positive, as the argument of a logarithm, and not only different from zero.
    pub positive: bool,
}

/// Room for the work on one box, to be used again.
#[derive(Default)]
pub(super) struct Desk {
    pub slots: SlotValues,
    pub doubles: Room<f64>,
    intervals: Room<Interval>,
    face: Vec<Interval>,
    slopes: Vec<Interval>,
    places: Vec<Place>,
    /// The derivatives by the coordinates in the middle of the box.
    pub gradient: Vec<f64>,
}

/// What floating point suggests of a factor on a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guess {
    /// The value in the middle.
    pub value: f64,
    /// Its magnitude over the change that the slopes in the middle allow within the box: above one, a zero is unlikely.
    pub ratio: f64,
    /// The coordinate that matters most.
    pub steepest: Option<usize>,
}

impl Factor {
    /// What floating point suggests; `desk.gradient` is left for [`Factor::vanishes`].
    pub fn guess(&self, chart: &Chart, desk: &mut Desk) -> Guess {
        let value = self.tape.gradient(&desk.slots.middle, &mut desk.doubles);
        let (gradient, radii) = (&mut desk.gradient, &desk.slots.radii);
        gradient.resize(radii.len(), 0.0);
        chart.slots().by_coordinates(&self.tape, &desk.doubles.by_slots, &desk.slots.middle, gradient);
        let (mut change, mut most, mut steepest) = (0.0, -1.0, None);
        for coordinate in &self.tape.coordinates {
            let part = (gradient[*coordinate] * radii[*coordinate]).abs();
            change += part;
            if part > most {
                (most, steepest) = (part, Some(*coordinate));
            }
        }
        let ratio = if change > 0.0 { value.abs() / change } else { f64::INFINITY };
        Guess { value, ratio: if ratio.is_nan() { 0.0 } else { ratio }, steepest }
    }

    /// Whether a value shows what is wanted of the factor.
    fn shown_by(&self, value: Interval) -> bool {
        if self.positive { value.low() > 0.0 } else { !value.contains_zero() }
    }

    /// Whether the factor is zero nowhere in the box. `true` is proved; `false` says nothing.
    pub fn excludes_zero(&self, chart: &Chart, desk: &mut Desk, negative: bool) -> bool {
        let all = desk.slots.at(Place::All);
        if self.shown_by(self.tape.value(all, &mut desk.intervals)) {
            return true;
        }
        for witness in &self.witnesses {
            if !witness.value(all, &mut desk.intervals).contains_zero() {
                return true;
            }
        }
        if self.positive && negative {
            return false;
        }
        desk.face.clear();
        desk.face.extend_from_slice(all);
        desk.places.clear();
        desk.places.resize(desk.slots.radii.len(), Place::All);
        desk.slopes.resize(desk.slots.radii.len(), Interval::ZERO);
        loop {
            self.tape.gradient(&desk.face, &mut desk.intervals);
            chart.slots().by_coordinates(&self.tape, &desk.intervals.by_slots, &desk.face, &mut desk.slopes);
            let mut fixed = false;
            for coordinate in &self.tape.coordinates {
                let slope = desk.slopes[*coordinate];
                if desk.places[*coordinate] != Place::All || slope.low() < 0.0 && slope.high() > 0.0 {
                    continue;
                }
                // towards zero: down where it is positive and grows, or is negative and falls
                let place = if (slope.low() >= 0.0) == negative { Place::High } else { Place::Low };
                desk.places[*coordinate] = place;
                put(chart, &desk.slots, *coordinate, place, &mut desk.face);
                fixed = true;
            }
            let left = self.tape.coordinates.iter().any(|c| desk.places[*c] == Place::All);
            if fixed && has_sign(self.tape.value(&desk.face, &mut desk.intervals), negative) {
                return true;
            }
            if left && self.by_mean_value(chart, desk, negative) {
                return true;
            }
            if !fixed || !left {
                return false;
            }
        }
    }

    /// The value in the middle of the coordinates that are left, and their slopes times their distance from it.
    fn by_mean_value(&self, chart: &Chart, desk: &mut Desk, negative: bool) -> bool {
        let mut change = Interval::ZERO;
        let mut face = std::mem::take(&mut desk.face);
        for coordinate in &self.tape.coordinates {
            if desk.places[*coordinate] == Place::All {
                let distance = desk.slots.distance(*coordinate);
                change += desk.slopes[*coordinate] * distance;
                put(chart, &desk.slots, *coordinate, Place::Middle, &mut face);
            }
        }
        let value = self.tape.value(&face, &mut desk.intervals) + change;
        for coordinate in &self.tape.coordinates {
            if desk.places[*coordinate] == Place::All {
                put(chart, &desk.slots, *coordinate, Place::All, &mut face);
            }
        }
        desk.face = face;
        has_sign(value, negative)
    }

    /// Whether the factor is zero somewhere in the box: proved by two corners, at one of which it is not negative and at the
    /// other not positive.
    pub fn vanishes(&self, chart: &Chart, desk: &mut Desk) -> bool {
        self.guess(chart, desk);
        let gradient = std::mem::take(&mut desk.gradient);
        let mut at = |up: bool| {
            desk.face.clear();
            desk.face.extend_from_slice(desk.slots.at(Place::Middle));
            for coordinate in &self.tape.coordinates {
                let place = if (gradient[*coordinate] > 0.0) == up { Place::High } else { Place::Low };
                put(chart, &desk.slots, *coordinate, place, &mut desk.face);
            }
            self.tape.value(&desk.face, &mut desk.intervals)
        };
        let found = at(true).low() >= 0.0 && at(false).high() <= 0.0;
        desk.gradient = gradient;
        found
    }

    /// Whether a factor that has to be positive is so nowhere in the box.
    pub fn is_nowhere_positive(&self, desk: &mut Desk) -> bool {
        self.positive && self.tape.value(desk.slots.at(Place::All), &mut desk.intervals).high() <= 0.0
    }
}

fn has_sign(value: Interval, negative: bool) -> bool {
    if negative { value.high() < 0.0 } else { value.low() > 0.0 }
}

/// Puts a coordinate to a place of its side.
fn put(chart: &Chart, slots: &SlotValues, coordinate: usize, place: Place, face: &mut [Interval]) {
    for slot in chart.slots().of(coordinate) {
        face[slot] = slots.at(place)[slot];
    }
}
