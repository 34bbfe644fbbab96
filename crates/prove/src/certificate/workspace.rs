//! Room for the work on one box, to be used again for the next.

use super::boxes::{Chart, Place, Side, SlotValues};
use super::tape::Room;
use palmistry_math::number::Interval;

/// Room for the work on boxes, one after the other.
#[derive(Default)]
pub(super) struct Workspace {
    pub(super) slots: SlotValues,
    /// For one expression at a time: its values as doubles and as intervals.
    pub(super) doubles: Room<f64>,
    pub(super) intervals: Room<Interval>,
    pub(super) face: Vec<Interval>,
    pub(super) slopes: Vec<Interval>,
    pub(super) places: Vec<Place>,
    /// The derivatives by the coordinates in the middle of the box.
    pub(super) gradient: Vec<f64>,
}

/// A box that is being looked at: nothing can be asked of factors before all slots have their values on it.
pub(super) struct BoxAtWork<'w> {
    chart: &'w Chart,
    pub(super) room: &'w mut Workspace,
}

impl Workspace {
    /// Takes up a box.
    pub fn begin<'w>(&'w mut self, chart: &'w Chart, sides: &[Side]) -> BoxAtWork<'w> {
        chart.fill(sides, &mut self.slots);
        BoxAtWork { chart, room: self }
    }
}

impl<'w> BoxAtWork<'w> {
    pub fn chart(&self) -> &'w Chart {
        self.chart
    }

    /// The values of all slots at a place of each side.
    pub fn at(&self, place: Place) -> &[Interval] {
        self.room.slots.at(place)
    }

    /// The same middle with so many times the width: for guesses alone, since no enclosure follows.
    pub fn widen(&mut self, times: f64) {
        self.room.slots.radii.iter_mut().for_each(|radius| *radius *= times);
    }

    /// Puts a coordinate of the face to a place of its side.
    pub fn put(&mut self, coordinate: usize, place: Place) {
        for slot in self.chart.slots().of(coordinate) {
            self.room.face[slot] = self.room.slots.at(place)[slot];
        }
    }
}
