//! A factor: an expression of which it matters where in a box it is zero.
//!
//! That it is zero nowhere is proved by its range over the box, enclosed three ways: as it is written; with every
//! coordinate in which it is monotone put to the end where it comes nearest to zero (again and again, since others may
//! become monotone on that face); and by the mean value theorem in the coordinates that are left. That it is zero
//! somewhere is proved by two points at which it has opposite signs. All but the first of these is true only of what is
//! defined and continuous all over the box, so that this is asked before.

use super::boxes::{Chart, Place, SlotValues};
use super::tape::{Room, Tape};
use crate::expression::Need;
use crate::number::Interval;

/// An expression with all that is needed to decide whether it vanishes on a box.
#[derive(Clone, Debug)]
pub(super) struct Factor {
    /// As a paper would write it.
    pub text: String,
    pub tape: Tape,
    /// Expressions that are multiples of it by something finite: where one of them is not zero it is not either.
    pub witnesses: Vec<Tape>,
    /// What is needed of it: not to be zero, or to be positive, as the argument of a logarithm, or at least not negative.
    pub need: Need,
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
        self.tape.by_coordinates(chart.slots(), &desk.doubles.by_slots, &desk.slots.middle, gradient);
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

    /// Whether a value shows what is needed of the factor.
    fn shown_by(&self, value: Interval) -> bool {
        self.need.is_met_by_interval(value) == Some(true)
    }

    /// Whether it is worth while to try for a proof: where zero is enough, floating point cannot tell.
    pub fn is_worth_trying(&self, guess: Guess) -> bool {
        guess.ratio >= HOPE || self.need != Need::NotZero && self.need != Need::Positive
    }

    /// Whether what is needed of the factor is so all over the box. `true` is proved; `false` says nothing.
    pub fn holds_everywhere(&self, chart: &Chart, desk: &mut Desk, negative: bool) -> bool {
        let all = desk.slots.at(Place::All);
        if self.shown_by(self.tape.value(all, &mut desk.intervals)) {
            return true;
        }
        let continuous = self.tape.is_defined(&desk.intervals);
        for witness in &self.witnesses {
            if !witness.value(all, &mut desk.intervals).contains_zero() {
                return true;
            }
        }
        // beside a zero only a sign can be shown
        let by_sign = match self.need {
            Need::NotZero => true,
            Need::Positive | Need::NotNegative => !negative,
            Need::WithinOne | Need::InsideOne => false,
        };
        if !by_sign || !continuous {
            return false;
        }
        desk.face.clear();
        desk.face.extend_from_slice(all);
        desk.places.clear();
        desk.places.resize(desk.slots.radii.len(), Place::All);
        desk.slopes.resize(desk.slots.radii.len(), Interval::ZERO);
        loop {
            self.tape.gradient(&desk.face, &mut desk.intervals);
            self.tape.by_coordinates(chart.slots(), &desk.intervals.by_slots, &desk.face, &mut desk.slopes);
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
            if fixed && self.has_sign(self.tape.value(&desk.face, &mut desk.intervals), negative) {
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
        self.has_sign(value, negative)
    }

    /// Whether a value has the sign that is to be shown.
    fn has_sign(&self, value: Interval, negative: bool) -> bool {
        match (negative, self.need) {
            (true, _) => value.high() < 0.0,
            (false, Need::NotNegative) => value.low() >= 0.0,
            (false, _) => value.low() > 0.0,
        }
    }

    /// Whether the factor is zero somewhere in the box: proved by two corners, at one of which it is not negative and at the
    /// other not positive.
    pub fn vanishes(&self, chart: &Chart, desk: &mut Desk) -> bool {
        self.tape.value(desk.slots.at(Place::All), &mut desk.intervals);
        if !self.tape.is_defined(&desk.intervals) {
            return false; // it may change its sign at a pole
        }
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

    /// Whether what is needed of the factor is so nowhere in the box, where it is defined.
    pub fn fails_everywhere(&self, desk: &mut Desk) -> bool {
        let value = self.tape.value(desk.slots.at(Place::All), &mut desk.intervals);
        self.need.is_met_by_interval(value) == Some(false)
    }

    /// What is needed of it, in the notation of the proof language; the bare factor where it must not be zero.
    pub fn needed_text(&self) -> String {
        match self.need {
            Need::NotZero => self.text.clone(),
            Need::Positive => format!("{} > 0", self.text),
            Need::NotNegative => format!("{} >= 0", self.text),
            Need::WithinOne => format!("-1 <= {} <= 1", self.text),
            Need::InsideOne => format!("-1 < {} < 1", self.text),
        }
    }
}

/// A factor is tried where floating point gives it this much of a chance.
pub(super) const HOPE: f64 = 0.6;

/// Puts a coordinate to a place of its side.
fn put(chart: &Chart, slots: &SlotValues, coordinate: usize, place: Place, face: &mut [Interval]) {
    for slot in chart.slots().of(coordinate) {
        face[slot] = slots.at(place)[slot];
    }
}
