//! The rank at states that are handed over as doubles, wherever they lie: by blocks where these can decide, else state by state by one
//! number type after the other. A row says of a state what the table of a sweep says of a drawn one.

use super::certainty::Certainty;
use super::escalation::RankDecider;
use super::prepared::row_of;
use super::stream::{StateVerdict, StatesError, Stream, Verdicts, held};
use super::table::StateRow;
use crate::observability::{Coordinate, Locus, Source, State};
use palmistry_budget::Share;
use palmistry_math::expression::Symbol;
use palmistry_math::number::rational_from_f64;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// States that one thread takes at a time; between them, and between any two that are decided one by one, an interrupt is looked at.
const CHUNK: usize = 512;

/// What decides states that are handed over.
pub struct GivenStates {
    stream: Option<Stream>,
    decider: RankDecider<'static>,
    locus: Locus,
    coordinates: Vec<Symbol>,
    /// No state's rank is higher, for certain.
    most: usize,
    wanted: Certainty,
}

impl GivenStates {
    /// `stream` and `decider` are those of the rows that suffice at almost all states, the decider's with all rows behind them.
    pub(super) fn new(
        stream: Option<Stream>,
        decider: RankDecider<'static>,
        locus: Locus,
        most: usize,
        wanted: Certainty,
    ) -> GivenStates {
        let drawn = |(symbol, source): (&Symbol, &Source)| {
            let has_one_value = matches!(source, Source::Fixed(_)) || held(source).is_some();
            (!has_one_value).then_some(*symbol)
        };
        let coordinates: Vec<Symbol> = locus.sources.iter().filter_map(drawn).collect();
        // a range between two doubles that holds none is drawn by nobody, and a state may lie there all the same
        let stream = stream.filter(|stream| stream.coordinates().eq(coordinates.iter().copied()));
        GivenStates { stream, decider, locus, coordinates, most, wanted }
    }

    /// The coordinates that have to be given for a state, in this order; all others follow from these or have one value.
    pub fn coordinates(&self) -> &[Symbol] {
        &self.coordinates
    }

    /// A row for each state, without coordinates; the states are given by a slice for each of [`GivenStates::coordinates`], angles in
    /// radians. Whether they lie in the sample box is not asked. Where something is infinite, not a number or a pole there is no rank.
    /// `None` where it was interrupted.
    ///
    /// # Errors
    /// Where there are more or fewer slices than coordinates, or where they are not of one length.
    pub fn decide(
        &self,
        states: &[&[f64]],
        interrupt: &AtomicBool,
    ) -> Result<Option<Vec<StateRow>>, StatesError> {
        let chunks = self.decide_by_chunks(states, interrupt, |rows| rows)?;
        Ok(chunks.map(|chunks| chunks.into_iter().flatten().collect()))
    }

    /// The same by chunks of states, in their order, each as soon as it is decided turned into what is kept of it: a row is larger than
    /// what most want to know.
    ///
    /// # Errors
    /// As for [`GivenStates::decide`].
    pub fn decide_by_chunks<T: Send>(
        &self,
        states: &[&[f64]],
        interrupt: &AtomicBool,
        kept: impl Fn(Vec<StateRow>) -> T + Sync,
    ) -> Result<Option<Vec<T>>, StatesError> {
        let count = states.first().map_or(0, |values| values.len());
        if states.len() != self.coordinates.len() {
            return Err(StatesError::Coordinates { expected: self.coordinates.len(), found: states.len() });
        }
        if let Some(other) = states.iter().find(|values| values.len() != count) {
            return Err(StatesError::Lengths { first: count, other: other.len() });
        }
        let share = Share::here();
        (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let range = chunk * CHUNK..count.min((chunk + 1) * CHUNK);
                let part: Vec<&[f64]> = states.iter().map(|values| &values[range.clone()]).collect();
                let rows = share.carry(|| self.chunk(&part, range.start, interrupt)).transpose()?;
                Some(rows.map(&kept))
            })
            // the first chunk without rows ends it
            .collect::<Option<Result<Vec<T>, StatesError>>>()
            .transpose()
    }

    fn chunk(
        &self,
        states: &[&[f64]],
        first: usize,
        interrupt: &AtomicBool,
    ) -> Result<Option<Vec<StateRow>>, StatesError> {
        if interrupt.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let count = states.first().map_or(0, |values| values.len());
        let index = |place: usize| (first + place) as u64;
        let mut rows: Vec<StateRow> = (0..count).map(|place| StateRow::of_nothing(index(place))).collect();
        let mut left: Vec<usize> = (0..count).collect();
        if let Some(stream) = &self.stream {
            let mut found = Verdicts::default();
            // with bounds on all errors whatever is wanted, as a stream of drawn states: what is proved is reported
            stream.verdicts(states, Certainty::Certified, &mut found)?;
            let full = stream.full_rank();
            let value = |values: Option<&Vec<f64>>, place: usize| values.map(|values| values[place]);
            left.retain(|place| {
                let certified = match found.verdicts[*place] {
                    // that these rows have full rank is a lower bound, and all that there is where no rank is higher
                    StateVerdict::Full(certainty) if full == self.most => certainty == Certainty::Certified,
                    _ => return true,
                };
                if !certified && self.wanted == Certainty::Certified {
                    return true;
                }
                let smallest = value(found.singular_values.last(), *place);
                let largest = value(found.singular_values.first(), *place);
                rows[*place] = StateRow {
                    rank: Some(full),
                    certified,
                    smallest_singular_value: smallest,
                    // as a stream of drawn states rounds it
                    condition: largest.zip(smallest).map(|(large, small)| 1.0 / (small / large)),
                    ..StateRow::of_nothing(index(*place))
                };
                false
            });
        }
        for place in left {
            if interrupt.load(Ordering::Relaxed) {
                return Ok(None);
            }
            if let Some(state) = self.state(states, place) {
                rows[place] = row_of(index(place), &self.decider.decide(&state));
            }
        }
        Ok(Some(rows))
    }

    /// A state in exact numbers: doubles are, angles are in radians. None where one is infinite or not a number.
    fn state(&self, states: &[&[f64]], place: usize) -> Option<State> {
        let mut state = State::default();
        for (symbol, source) in &self.locus.sources {
            if let Source::Fixed(value) = source {
                state.values.insert(*symbol, value.clone());
            } else if let Some(value) = held(source) {
                state.values.insert(*symbol, Coordinate::Number(value));
            }
        }
        for (symbol, values) in self.coordinates.iter().zip(states) {
            state.values.insert(*symbol, Coordinate::Number(rational_from_f64(values[place])?));
        }
        self.locus.complete(&mut state).ok()?;
        Some(state)
    }
}
