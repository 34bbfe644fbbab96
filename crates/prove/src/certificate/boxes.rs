//! Boxes that come of halving a box again and again: each side is a dyadic part of the whole range, so that volumes are
//! sums of powers of two and exact.

use super::slots::{CoordinateFunction, Slot, Slots};
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use palmistry_math::expression::Symbol;
use palmistry_math::number::{Interval, RealNumber, rational_to_f64};

/// No side is halved more often than this.
pub(super) const DEEPEST: u8 = 30;

/// The part from `index / 2^depth` to `(index + 1) / 2^depth` of a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Side {
    pub index: u32,
    pub depth: u8,
}

impl Side {
    pub const WHOLE: Side = Side { index: 0, depth: 0 };

    pub fn halves(self) -> [Side; 2] {
        [0, 1].map(|bit| Side { index: 2 * self.index + bit, depth: self.depth + 1 })
    }

    /// Its ends as parts of the range, which doubles hold exactly.
    pub fn ends(self) -> (f64, f64) {
        let scale = f64::from(1u32 << self.depth);
        (f64::from(self.index) / scale, (f64::from(self.index) + 1.0) / scale)
    }

    /// Whether a part of the range that is no end of any side lies in it.
    pub fn meets(self, part: f64) -> bool {
        let (low, high) = self.ends();
        low < part && part < high
    }
}

/// A coordinate of the box.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeCoordinate {
    /// The symbol.
    pub symbol: Symbol,
    /// Its name.
    pub name: String,
    /// The low end of its range.
    pub low: RBig,
    /// The high end.
    pub high: RBig,
}

impl FreeCoordinate {
    /// The point at a part of the range, as a double near it.
    pub(super) fn middle_of(&self, part: f64) -> f64 {
        let (low, high) = self.ends(Side::WHOLE);
        low + (high - low) * part
    }

    /// The ends of a side, exactly.
    pub(super) fn exact_ends(&self, side: Side) -> [RBig; 2] {
        let scale = RBig::from(1u32 << side.depth);
        let width = &self.high - &self.low;
        [side.index, side.index + 1].map(|index| &self.low + RBig::from(index) / &scale * &width)
    }

    /// The ends of a side, as doubles near them.
    pub(super) fn ends(&self, side: Side) -> (f64, f64) {
        let (low, high) = (rational_to_f64(&self.low), rational_to_f64(&self.high));
        let (a, b) = side.ends();
        (low + (high - low) * a, low + (high - low) * b)
    }
}

/// Where in a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    All,
    Low,
    High,
    Middle,
}

const PLACES: usize = 4;

/// The values of all slots on the sides of boxes.
pub(super) struct Chart {
    coordinates: Vec<FreeCoordinate>,
    lows: Vec<Interval>,
    widths: Vec<Interval>,
    slots: Slots,
}

/// The slots of a box, at all four places.
#[derive(Clone, Debug, Default)]
pub(super) struct SlotValues {
    values: [Vec<Interval>; PLACES],
    /// How far a coordinate may lie from the middle of its side, either way.
    distances: Vec<Interval>,
    /// Half the width of each coordinate, and doubles near the values in the middle.
    pub radii: Vec<f64>,
    pub middle: Vec<f64>,
}

impl SlotValues {
    pub fn at(&self, place: Place) -> &[Interval] {
        &self.values[place as usize]
    }

    pub fn distance(&self, coordinate: usize) -> Interval {
        self.distances[coordinate]
    }

    fn push(&mut self, places: [Interval; PLACES]) {
        self.middle.push(places[Place::Middle as usize].mid());
        for (list, value) in self.values.iter_mut().zip(places) {
            list.push(value);
        }
    }

    /// A sine, and its cosine behind it.
    fn push_pairs(&mut self, places: [(Interval, Interval); PLACES]) {
        self.push(places.map(|(sine, _)| sine));
        self.push(places.map(|(_, cosine)| cosine));
    }
}

impl Chart {
    pub fn new(coordinates: Vec<FreeCoordinate>, slots: Slots) -> Self {
        let lows: Vec<Interval> = coordinates.iter().map(|c| Interval::from_rational(&c.low)).collect();
        let widths: Vec<Interval> =
            coordinates.iter().map(|c| Interval::from_rational(&(&c.high - &c.low))).collect();
        Chart { lows, widths, coordinates, slots }
    }

    pub fn slots(&self) -> &Slots {
        &self.slots
    }

    pub fn coordinates(&self) -> &[FreeCoordinate] {
        &self.coordinates
    }

    /// The point at a part of a coordinate's range.
    fn point(&self, coordinate: usize, part: f64) -> Interval {
        self.lows[coordinate] + self.widths[coordinate] * Interval::point(part)
    }

    /// An enclosure of a side.
    pub fn side(&self, coordinate: usize, side: Side) -> Interval {
        let (low, high) = side.ends();
        self.point(coordinate, low).hull(self.point(coordinate, high))
    }

    /// The values of all slots on a box.
    pub fn fill(&self, sides: &[Side], found: &mut SlotValues) {
        found.values.iter_mut().for_each(Vec::clear);
        found.middle.clear();
        found.radii.clear();
        found.distances.clear();
        for Slot { coordinate, function } in self.slots.iter() {
            let (low, high) = sides[coordinate].ends();
            let [first, last, middle] =
                [low, high, 0.5 * (low + high)].map(|part| self.point(coordinate, part));
            let places = [first.hull(last), first, last, middle];
            match function {
                CoordinateFunction::Itself => found.push(places),
                CoordinateFunction::Sine => found.push_pairs(places.map(Interval::sin_cos)),
                CoordinateFunction::HalfSine => {
                    found.push_pairs(places.map(|place| (place * Interval::point(0.5)).sin_cos()));
                }
                CoordinateFunction::Cosine | CoordinateFunction::HalfCosine => {} // came with its sine
            }
        }
        for (width, side) in self.widths.iter().zip(sides) {
            let half = 0.5 / f64::from(1u32 << side.depth); // a power of two: exact
            found.radii.push(width.mid() * half);
            found.distances.push(*width * Interval::new(-half, half));
        }
    }
}

/// A sum of powers of one half: how many boxes of each depth (the number of halvings that led to it).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Volume {
    counts: Vec<u64>,
}

impl Volume {
    pub fn add(&mut self, depth: usize) {
        if self.counts.len() <= depth {
            self.counts.resize(depth + 1, 0);
        }
        self.counts[depth] += 1;
    }

    pub fn boxes(&self) -> u64 {
        self.counts.iter().sum()
    }

    pub fn counts(&self) -> &[u64] {
        &self.counts
    }

    pub fn from_counts(counts: Vec<u64>) -> Self {
        Volume { counts }
    }

    pub fn merge(&mut self, other: &Volume) {
        self.counts.resize(self.counts.len().max(other.counts.len()), 0);
        for (sum, count) in self.counts.iter_mut().zip(&other.counts) {
            *sum += count;
        }
    }

    /// The part of the whole, exactly.
    pub fn exact(&self) -> RBig {
        let depth = self.counts.len();
        let top = self
            .counts
            .iter()
            .enumerate()
            .fold(UBig::ZERO, |sum, (at, count)| sum + (UBig::from(*count) << (depth - at)));
        RBig::from_parts(IBig::from(top), UBig::ONE << depth)
    }

    /// The part of the whole, rounded down.
    pub fn at_least(&self) -> f64 {
        Interval::from_rational(&self.exact()).low().max(0.0)
    }
}
