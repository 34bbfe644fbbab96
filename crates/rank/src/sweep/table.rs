//! A row for each state of a sweep, for those who want to look at all of them.

use crate::observability::{Coordinate, LocusError, State};
use palmistry_budget::Share;
use palmistry_math::expression::Symbol;
use rayon::prelude::*;

/// What was found at one state.
#[derive(Clone, Debug, PartialEq)]
pub struct StateRow {
    /// The index of its draw: the same state for the same seed, whoever draws it.
    pub index: u64,
    /// The rank; nothing at a pole.
    pub rank: Option<usize>,
    /// Whether it is proved for this very state.
    pub certified: bool,
    /// The smallest singular value of the matrix that remains without unit rows, equilibrated; nothing where there is none. It says how
    /// hard the rank is to decide, and nothing of how well a state is observable.
    pub smallest_singular_value: Option<f64>,
    /// The largest over the smallest; infinite where the smallest is zero. Equilibration ends where another round gains little, so that it is
    /// good to some percent.
    pub condition: Option<f64>,
    /// The coordinates that were asked for, in their units, angles in radians; NaN where the state says nothing of one.
    pub coordinates: Vec<f64>,
}

impl StateRow {
    /// That of a state of which nothing is known.
    pub(super) fn of_nothing(index: u64) -> StateRow {
        StateRow {
            index,
            rank: None,
            certified: false,
            smallest_singular_value: None,
            condition: None,
            coordinates: Vec::new(),
        }
    }
}

/// Who takes the rows of a table, block after block in the order of the indices.
pub struct StateTable<'a> {
    /// The coordinates that are reported of each state.
    pub coordinates: Vec<Symbol>,
    /// Takes some rows of the branch of the conditions of a number, counted from zero.
    pub take: &'a mut dyn FnMut(usize, &[StateRow]),
}

/// The same for one sweep, where anybody takes them.
pub(super) struct TableOf<'a, 't>(pub Option<(usize, &'a mut StateTable<'t>)>);

impl TableOf<'_, '_> {
    pub fn nobody() -> Self {
        TableOf(None)
    }

    pub fn is_wanted(&self) -> bool {
        self.0.is_some()
    }

    /// Hands on some rows, with the coordinates that are asked for.
    pub fn write(
        &mut self,
        mut rows: Vec<StateRow>,
        state: impl Fn(u64) -> Result<State, LocusError> + Sync,
    ) -> Result<(), LocusError> {
        let Some((branch, table)) = &mut self.0 else { return Ok(()) };
        let StateTable { coordinates, take } = &mut **table;
        if !coordinates.is_empty() {
            let share = Share::here();
            rows.par_iter_mut().try_for_each(|row| {
                let state = share.carry(|| state(row.index))?;
                let of = |symbol| state.values.get(symbol).map_or(f64::NAN, Coordinate::to_f64);
                row.coordinates = coordinates.iter().map(of).collect();
                Ok(())
            })?;
        }
        take(*branch, &rows);
        Ok(())
    }
}

/// Puts rows in the places of those of the same index; both are in the order of their indices.
pub(super) fn put_in(rows: &mut [StateRow], decided: Vec<StateRow>) {
    for row in decided {
        if let Ok(place) = rows.binary_search_by_key(&row.index, |row| row.index) {
            rows[place] = row;
        }
    }
}
