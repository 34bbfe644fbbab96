//! A factor: an expression of which it matters where in a box it is zero.
//!
//! That it is zero nowhere is proved by its range over the box, enclosed three ways: as it is written; with every
//! coordinate in which it is monotone put to the end where it comes nearest to zero (again and again, since others may
//! become monotone on that face); and by the mean value theorem in the coordinates that are left. That it is zero
//! somewhere is proved by two points at which it has opposite signs. All but the first of these is true only of what is
//! defined and continuous all over the box, so that this is asked before.

use super::boxes::Place;
use super::tape::{Range, Tape};
use super::workspace::{BoxAtWork, Workspace};
use palmistry_math::expression::Need;
use palmistry_math::number::Interval;

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
    /// What floating point suggests.
    pub fn guess(&self, at: &mut BoxAtWork<'_>) -> Guess {
        let value = self.slopes_in_the_middle(at);
        let (gradient, radii) = (&at.room.gradient, &at.room.slots.radii);
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

    /// The value in the middle, by floating point, and in the room's gradient the derivatives there.
    fn slopes_in_the_middle(&self, at: &mut BoxAtWork<'_>) -> f64 {
        let slots = at.chart().slots();
        let Workspace { slots: values, doubles, gradient, .. } = &mut *at.room;
        let value = self.tape.gradient(&values.middle, doubles);
        gradient.resize(values.radii.len(), 0.0);
        self.tape.by_coordinates(slots, &doubles.by_slots, &values.middle, gradient);
        value
    }

    /// Whether a value shows what is needed of the factor.
    fn shown_by(&self, value: Interval) -> bool {
        self.need.is_met_by_interval(value) == Some(true)
    }

    /// Whether it is worthwhile to try for a proof: where zero is enough, floating point cannot decide.
    pub fn is_worth_trying(&self, guess: Guess) -> bool {
        guess.ratio >= HOPE || self.need != Need::NotZero && self.need != Need::Positive
    }

    /// Whether what is needed of the factor is so all over the box. `true` is proved; `false` says nothing.
    pub fn holds_everywhere(&self, at: &mut BoxAtWork<'_>, negative: bool) -> bool {
        let range = self.range_on_the_box(at);
        if self.shown_by(range.value) {
            return true;
        }
        let continuous = range.is_defined();
        for witness in &self.witnesses {
            let Workspace { slots, intervals, .. } = &mut *at.room;
            if !witness.value(slots.at(Place::All), intervals).contains_zero() {
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
        self.begin_face(at, Place::All);
        let coordinates = at.room.slots.radii.len();
        at.room.places.clear();
        at.room.places.resize(coordinates, Place::All);
        at.room.slopes.resize(coordinates, Interval::ZERO);
        loop {
            self.slopes_on_the_face(at);
            let mut fixed = false;
            for coordinate in &self.tape.coordinates {
                let slope = at.room.slopes[*coordinate];
                if at.room.places[*coordinate] != Place::All || slope.low() < 0.0 && slope.high() > 0.0 {
                    continue;
                }
                // towards zero: down where it is positive and grows, or is negative and falls
                let place = if (slope.low() >= 0.0) == negative { Place::High } else { Place::Low };
                at.room.places[*coordinate] = place;
                at.put(*coordinate, place);
                fixed = true;
            }
            let left = self.tape.coordinates.iter().any(|c| at.room.places[*c] == Place::All);
            if fixed && self.has_sign(self.value_on_the_face(at), negative) {
                return true;
            }
            if left && self.by_mean_value(at, negative) {
                return true;
            }
            if !fixed || !left {
                return false;
            }
        }
    }

    /// The range over the box, enclosed as the factor is written.
    fn range_on_the_box<'r>(&'r self, at: &'r mut BoxAtWork<'_>) -> Range<'r> {
        let Workspace { slots, intervals, .. } = &mut *at.room;
        self.tape.range(slots.at(Place::All), intervals)
    }

    /// The range over the face that is being looked at.
    fn value_on_the_face(&self, at: &mut BoxAtWork<'_>) -> Interval {
        let Workspace { face, intervals, .. } = &mut *at.room;
        self.tape.value(face, intervals)
    }

    fn begin_face(&self, at: &mut BoxAtWork<'_>, place: Place) {
        let Workspace { slots, face, .. } = &mut *at.room;
        face.clear();
        face.extend_from_slice(slots.at(place));
    }

    /// The ranges of the derivatives by the coordinates over the face.
    fn slopes_on_the_face(&self, at: &mut BoxAtWork<'_>) {
        let slots = at.chart().slots();
        let Workspace { face, intervals, slopes, .. } = &mut *at.room;
        self.tape.gradient(face, intervals);
        self.tape.by_coordinates(slots, &intervals.by_slots, face, slopes);
    }

    /// The value in the middle of the coordinates that are left, and their slopes times their distance from it.
    fn by_mean_value(&self, at: &mut BoxAtWork<'_>, negative: bool) -> bool {
        let mut change = Interval::ZERO;
        for coordinate in &self.tape.coordinates {
            if at.room.places[*coordinate] == Place::All {
                change += at.room.slopes[*coordinate] * at.room.slots.distance(*coordinate);
                at.put(*coordinate, Place::Middle);
            }
        }
        let value = self.value_on_the_face(at) + change;
        for coordinate in &self.tape.coordinates {
            if at.room.places[*coordinate] == Place::All {
                at.put(*coordinate, Place::All);
            }
        }
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
    pub fn vanishes(&self, at: &mut BoxAtWork<'_>) -> bool {
        if !self.range_on_the_box(at).is_defined() {
            return false; // it may change its sign at a pole
        }
        self.slopes_in_the_middle(at);
        let mut corner = |up: bool| {
            self.begin_face(at, Place::Middle);
            for coordinate in &self.tape.coordinates {
                let place =
                    if (at.room.gradient[*coordinate] > 0.0) == up { Place::High } else { Place::Low };
                at.put(*coordinate, place);
            }
            self.value_on_the_face(at)
        };
        corner(true).low() >= 0.0 && corner(false).high() <= 0.0
    }

    /// Whether what is needed of the factor is so nowhere in the box, where it is defined.
    pub fn fails_everywhere(&self, at: &mut BoxAtWork<'_>) -> bool {
        self.need.is_met_by_interval(self.range_on_the_box(at).value) == Some(false)
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
