//! Verdicts at states that are handed over: what [`Stream::run`] does with the states that it draws, with the numbers
//! that it found.
//!
//! The states are doubles, structure of arrays, angles in radians. Whether they lie in the sample box is not asked.

use super::decide::Decider;
use super::draw::AxisFunction;
use super::lane::{Entry, LaneFound, decide_lane};
use super::{Stream, StreamReport};
use crate::sweep::Certainty;
use palmistry_math::expression::{Machine, Symbol};
use palmistry_math::number::{Bounded, Lanes, MOST_LANES, Vectorised};

/// The verdict for one state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StateVerdict {
    /// The rank is full, unit rows included: proved by elimination with bounds on all errors, or computed with half of
    /// the digits to spare.
    Full(Certainty),
    /// Slower numbers have to decide; the singular values suggest this rank, unit rows included.
    Open(usize),
    /// Something is infinite or not a number.
    NotFinite,
}

/// Verdicts with the numbers behind them, structure of arrays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdicts {
    /// One a state.
    pub verdicts: Vec<StateVerdict>,
    /// The singular values of `r_i a_ij c_j`, the largest of all states first. `a` is the matrix that remains without
    /// unit rows.
    pub singular_values: Vec<Vec<f64>>,
    /// The factors `r_i` by row, all states of the first row first.
    pub row_factors: Vec<Vec<f64>>,
    /// The factors `c_j` by column.
    pub column_factors: Vec<Vec<f64>>,
}

/// Why states that are handed over cannot be looked at.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)] // names and messages say it
pub enum StatesError {
    /// There is one slice for each of [`Stream::coordinates`].
    #[error("{expected} coordinates are needed, and {found} were handed over")]
    Coordinates { expected: usize, found: usize },
    /// All slices are as long as there are states.
    #[error("the first coordinate has {first} values and another one {other}: one a state is needed")]
    Lengths { first: usize, other: usize },
}

impl Stream {
    /// The coordinates that have to be given for a state, in this order; all others follow from these or have one
    /// value.
    pub fn coordinates(&self) -> impl Iterator<Item = Symbol> + '_ {
        self.axes.iter().map(|axis| axis.symbol)
    }

    /// Decides states that are handed over, one slice for each of [`Stream::coordinates`], on this thread. Where
    /// `wanted` is *computed*, entries are plain doubles of whose errors nothing is known, and nothing is proved.
    /// `found` is overwritten; its room is used again.
    ///
    /// # Errors
    /// Where there are more or fewer slices than coordinates, or where they are not of one length.
    pub fn verdicts(
        &self,
        states: &[&[f64]],
        wanted: Certainty,
        found: &mut Verdicts,
    ) -> Result<(), StatesError> {
        if states.len() != self.axes.len() {
            return Err(StatesError::Coordinates { expected: self.axes.len(), found: states.len() });
        }
        let count = states.first().map_or(0, |values| values.len());
        if let Some(other) = states.iter().find(|values| values.len() != count) {
            return Err(StatesError::Lengths { first: count, other: other.len() });
        }
        let (rows, columns) = self.remaining();
        let decided = if rows * columns == 0 { (0, 0) } else { (rows, columns) };
        for (arrays, length) in [
            (&mut found.singular_values, decided.0.min(decided.1)),
            (&mut found.row_factors, decided.0),
            (&mut found.column_factors, decided.1),
        ] {
            arrays.resize(length, Vec::new());
            arrays.iter_mut().for_each(|array| array.resize(count, 0.0));
        }
        found.verdicts.resize(count, StateVerdict::NotFinite);
        self.instructions.run(Given { stream: self, states, wanted, found });
        Ok(())
    }
}

struct Given<'a> {
    stream: &'a Stream,
    states: &'a [&'a [f64]],
    wanted: Certainty,
    found: &'a mut Verdicts,
}

impl Vectorised for Given<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, zero: L) {
        let matrix = &self.stream.matrix.program;
        match self.wanted {
            Certainty::Computed => self.decide(matrix.machine(zero), zero, zero),
            Certainty::Certified => {
                let exact = Bounded::exact(zero);
                self.decide(matrix.machine(exact), exact, zero);
            }
        }
    }
}

impl Given<'_> {
    #[inline(always)]
    fn decide<N: Entry<L>, L: Lanes>(self, mut machine: Machine<'_, N>, number: N, zero: L) {
        let Given { stream, states, wanted, found } = self;
        let certify = wanted == Certainty::Certified;
        let report = stream.nothing();
        let (rows, columns) = report.remaining;
        let mut decider = Decider::new(rows, columns, zero);
        let (count, lanes) = (found.verdicts.len(), machine.lanes());
        let mut start = 0;
        while start < count {
            for input in &stream.matrix.inputs {
                let Some(room) = machine.input(input.place) else { continue };
                for (lane, value) in room.iter_mut().enumerate() {
                    *value = value_of(input.function, states, start + lane * L::COUNT, number);
                }
            }
            machine.run();
            for lane in 0..lanes {
                let first = start + lane * L::COUNT;
                if first >= count {
                    break;
                }
                let LaneFound { found: decided, finite } =
                    decide_lane(&stream.matrix.program, &machine, lane, &mut decider, certify);
                let here = L::COUNT.min(count - first);
                for (i, finite) in finite.into_iter().enumerate().take(here) {
                    found.verdicts[first + i] = verdict(&report, &decided, i, finite);
                }
                let range = first..first + here;
                write(decider.singular_values(), &mut found.singular_values, range.clone());
                write(decider.row_factors(), &mut found.row_factors, range.clone());
                write(decider.column_factors(), &mut found.column_factors, range);
            }
            start += machine.states();
        }
    }
}

/// The same cases as [`StreamReport`] counts.
fn verdict(report: &StreamReport, found: &super::decide::Found, lane: usize, finite: bool) -> StateVerdict {
    if !finite {
        StateVerdict::NotFinite
    } else if found.certain[lane] > 0.0 {
        StateVerdict::Full(Certainty::Certified)
    } else if found.separated[lane] > 0.0 {
        StateVerdict::Full(Certainty::Computed)
    } else {
        StateVerdict::Open(report.eliminated + found.rank[lane] as usize)
    }
}

/// The values of a function at the states from `first` on; at the last one again, where there are no more.
#[inline(always)]
fn value_of<N: Lanes>(function: AxisFunction, states: &[&[f64]], first: usize, number: N) -> N {
    let (AxisFunction::Plain(axis) | AxisFunction::Sine(axis) | AxisFunction::Cosine(axis)) = function;
    let values = states[axis];
    let value = if first + N::COUNT <= values.len() {
        number.load(&values[first..])
    } else {
        let mut room = [0.0; MOST_LANES];
        for (i, value) in room.iter_mut().enumerate() {
            *value = values[(first + i).min(values.len() - 1)];
        }
        number.load(&room)
    };
    match function {
        AxisFunction::Plain(_) => value,
        AxisFunction::Sine(_) => value.sin_cos().0,
        AxisFunction::Cosine(_) => value.sin_cos().1,
    }
}

/// What is not a number is written as [`f64::NAN`], whatever bits it has: they depend on which instructions made it.
#[inline(always)]
fn write<L: Lanes>(values: &[L], arrays: &mut [Vec<f64>], range: std::ops::Range<usize>) {
    let mut room = [0.0; MOST_LANES];
    for (value, array) in values.iter().zip(arrays) {
        let (zero, unknown) = (value.splat(0.0), value.splat(f64::NAN));
        zero.smaller(*value).where_less(value.splat(f64::INFINITY), *value, unknown).store(&mut room);
        array[range.clone()].copy_from_slice(&room[..range.len()]);
    }
}
