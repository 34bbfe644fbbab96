//! The matrix on which the rank is decided.

use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::expression::NodeId;
use palmistry_math::number::Arithmetic;
use palmistry_rank::observability::Reduction;

/// Where an entry of the remaining block comes from.
#[derive(Clone, Debug)]
enum Slot {
    /// The place among the entries that vary.
    Varying(usize),
    Constant(RBig),
}

/// A matrix on which the rank is decided: what remains without unit rows, or all.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub eliminated: usize,
    pub rows: usize,
    pub columns: usize,
    slots: Vec<Slot>,
}

impl Block {
    pub fn new(system: &System, entries: &[NodeId], varying: &[usize]) -> Block {
        let columns = system.unknown_count();
        let found = Reduction::new(&system.graph, entries, columns);
        let places = found.rows.iter().flat_map(|r| found.columns.iter().map(move |c| r * columns + c));
        Block {
            eliminated: found.eliminated,
            rows: found.rows.len(),
            columns: found.columns.len(),
            slots: Self::slots(system, entries, varying, places),
        }
    }

    /// The whole matrix, nothing eliminated.
    pub fn whole(system: &System, entries: &[NodeId], varying: &[usize]) -> Block {
        let columns = system.unknown_count();
        let slots = Self::slots(system, entries, varying, 0..entries.len());
        Block { eliminated: 0, rows: entries.len() / columns, columns, slots }
    }

    fn slots(
        system: &System,
        entries: &[NodeId],
        varying: &[usize],
        places: impl Iterator<Item = usize>,
    ) -> Vec<Slot> {
        let slot = |place: usize| match system.graph.constant_value(entries[place]) {
            Some(value) => Slot::Constant(value.clone()),
            None => Slot::Varying(varying.partition_point(|other| *other < place)),
        };
        places.map(slot).collect()
    }

    /// Whether nothing remains, so that there is nothing to decide.
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// Its entries, one row after the other, from the values of the entries that vary; `None` where a constant has no
    /// image.
    pub fn entries<N: Clone>(&self, constant: impl Fn(&RBig) -> Option<N>, values: &[N]) -> Option<Vec<N>> {
        let entry = |slot: &Slot| match slot {
            Slot::Varying(place) => values.get(*place).cloned(),
            Slot::Constant(value) => constant(value),
        };
        self.slots.iter().map(entry).collect()
    }

    /// The same by rows.
    pub fn rows_of<A: Arithmetic>(
        &self,
        arithmetic: &A,
        values: &[A::Number],
    ) -> Option<Vec<Vec<A::Number>>> {
        let entries = self.entries(|value| arithmetic.rational(value).ok(), values)?;
        Some(entries.chunks(self.columns.max(1)).map(<[A::Number]>::to_vec).collect())
    }
}
