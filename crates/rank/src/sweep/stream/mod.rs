//! A stream of states: a hundred million of them, drawn, evaluated and decided by the block, in a memory that does not
//! grow.
//!
//! Each state gets a verdict from doubles that know their errors: the entries of the matrix come with rigorous bounds
//! ([`Bounded`]), elimination with these bounds proves a full rank (*certified*), and singular values after equilibration
//! show how far the state is from a lower one (*computed*, where half of the digits are left). What neither decides is
//! left to slower numbers: its index is handed over, and [`Stream::state`] draws it again, exactly.
//!
//! The states are other ones than those of [`Locus::draw`]: they lie on a finer grid.

mod certain;
mod decide;
mod draw;
mod equilibrate;
mod given;
mod jacobi;
mod lane;
mod random;
mod report;

use crate::observability::{Coordinate, Locus, LocusError, Reduction, Source, State};
use crate::sweep::certainty::Certainty;
use crate::sweep::table::StateRow;
pub use certain::Elimination;
use dashu::rational::RBig;
use decide::Decider;
use draw::{Axis, BlockOf, Drawer, DrawnProgram};
pub(super) use equilibrate::Equilibrium;
pub use given::{StateVerdict, StatesError, Verdicts};
pub use jacobi::Jacobi;
use lane::{LaneFound, decide_lane};
use palmistry_budget::Share;
use palmistry_lang::System;
use palmistry_math::expression::{BlockProgram, Graph, Guard, Input, Need, Node, NodeId, expand_angles};
use palmistry_math::number::{
    Bounded, Function, Instructions, Lanes, MOST_LANES, Vectorised, rational_from_f64,
};
use rayon::prelude::*;
pub use report::StreamReport;
use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, Ordering};

/// States that one thread takes at a time.
const CHUNK: u64 = 4096;
/// Chunks between two looks at the interrupt.
const CHUNKS: u64 = 32;

/// How to stream.
#[derive(Clone, Copy)]
pub struct StreamOptions<'a> {
    /// How many states are drawn.
    pub states: u64,
    /// The seed from which they are drawn.
    pub seed: u64,
    /// How certain a rank has to be: whether a merely computed one will do.
    pub wanted: Certainty,
    /// Set from outside to stop early; what was found is kept.
    pub interrupt: &'a AtomicBool,
    /// Called now and then with the number of states done.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

/// Rows whose rank is decided at the states of a locus.
#[derive(Clone, Debug)]
pub struct Stream {
    locus: Locus,
    axes: Vec<Axis>,
    reduction: Reduction,
    matrix: DrawnProgram,
    avoid: DrawnProgram,
    instructions: Instructions,
}

impl Stream {
    /// Prepares the rows, by entries of as many columns as the system has states. `None` where something is needed that
    /// is not drawn: an angle outside of sines and cosines; where a range is wider than doubles are; and where inequalities cut
    /// the box, which are decided in exact numbers, state by state.
    pub fn new(system: &mut System, locus: &Locus, rows: &[NodeId]) -> Option<Stream> {
        if locus.is_cut {
            return None;
        }
        let is_angle = &system.angle_test();
        let axes: Vec<Axis> =
            locus.sources.iter().filter_map(|(symbol, source)| Axis::new(*symbol, source)).collect();
        if axes.iter().any(|axis| !axis.is_held_by_doubles()) {
            return None;
        }
        // what has one value is put in, before unit rows are looked for
        let mut values = locus.values.clone();
        for (symbol, source) in &locus.sources {
            if let Some(value) = held(source) {
                values.insert(*symbol, system.graph.rational(value));
            }
        }
        let outputs: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
        let put_in = |system: &mut System, nodes: &[NodeId]| {
            let nodes = system.graph.substitute(nodes, &values);
            // once more: what the conditions give may mention what has one value
            let nodes = system.graph.substitute(&nodes, &values);
            expand_angles(&mut system.graph, &nodes, is_angle)
        };
        let (entries, avoided) = (put_in(system, rows), put_in(system, &locus.avoided));
        let mut watched = put_in(system, &outputs);
        let guards = system.smooth_guards(&system.moving_fields());
        let nodes: Vec<NodeId> = guards.iter().map(|guard| guard.node).collect();
        let nodes = put_in(system, &nodes);
        let there = guards.iter().zip(nodes).map(|(guard, node)| Guard { node, need: guard.need });
        watched.extend(watches(&mut system.graph, there, &[&watched[..], &entries].concat()));
        let reduction = Reduction::new(&system.graph, &entries, system.unknown_count());
        watched.extend(&entries);
        let known = |input: Input| match (input, locus.sources.get(&input.symbol()?)?) {
            (Input::Sine(_), Source::Fixed(Coordinate::Angle { sine, .. })) => Some(sine.clone()),
            (Input::Cosine(_), Source::Fixed(Coordinate::Angle { cosine, .. })) => Some(cosine.clone()),
            _ => None,
        };
        let matrix = BlockProgram::new(&system.graph, &reduction.entries, &watched, is_angle, known);
        let avoid = BlockProgram::new(&system.graph, &avoided, &[], is_angle, known);
        Some(Stream {
            locus: locus.clone(),
            matrix: DrawnProgram::new(matrix, &axes)?,
            avoid: DrawnProgram::new(avoid, &axes)?,
            axes,
            reduction,
            instructions: Instructions::detect(),
        })
    }

    /// The same with chosen instructions, which change nothing but the time it takes.
    pub fn with(self, instructions: Instructions) -> Stream {
        Stream { instructions, ..self }
    }

    /// The state of an index in exact numbers: the very one that [`Stream::run`] looks at.
    ///
    /// # Errors
    /// Where nothing is found that keeps clear of what is avoided, or where the conditions have no solution there.
    pub fn state(&self, seed: u64, index: u64) -> Result<State, LocusError> {
        // this state alone: whether one is found must not depend on those after it
        let mut drawer = Drawer::new(&self.axes, &self.avoid, seed, BlockOf { zero: 0.0f64, lanes: 1 });
        drawer.draw(index).map_err(|_| self.empty())?;
        let mut state = State::default();
        for (symbol, source) in &self.locus.sources {
            if let Source::Fixed(value) = source {
                state.values.insert(*symbol, value.clone());
            } else if let Some(value) = held(source) {
                state.values.insert(*symbol, Coordinate::Number(value));
            }
        }
        for (axis, value) in self.axes.iter().zip(drawer.coordinates(0)) {
            let value = rational_from_f64(value).ok_or_else(|| self.empty())?;
            let coordinate =
                if axis.is_turn { Coordinate::from_half_tangent(&value) } else { Coordinate::Number(value) };
            state.values.insert(axis.symbol, coordinate);
        }
        self.locus.complete(&mut state).map_err(|why| LocusError::Empty(why.to_string()))?;
        Ok(state)
    }

    /// The largest rank that the shape of the rows allows.
    pub fn full_rank(&self) -> usize {
        self.nothing().full()
    }

    /// Rows and columns of what remains without unit rows.
    pub fn remaining(&self) -> (usize, usize) {
        (self.reduction.rows.len(), self.reduction.columns.len())
    }

    fn empty(&self) -> LocusError {
        LocusError::Empty("what is to be avoided leaves nothing".to_owned())
    }

    /// Decides all states. The indices of those that are left for slower numbers go to `left`, in ascending order, as
    /// many as come up between two calls of `progress`.
    ///
    /// The same seed gives the same result bit for bit, on any number of threads and on any processor.
    ///
    /// # Errors
    /// Where states cannot be drawn.
    pub fn run(
        &self,
        options: &StreamOptions<'_>,
        left: &mut dyn FnMut(&[u64]),
    ) -> Result<StreamReport, LocusError> {
        self.run_from(0, options, false, &mut |indices, _| left(indices))
    }

    /// The same from the state of an index on: a stream that is cut anywhere adds up to the whole. Where rows are wanted there is
    /// one for each state, handed on with the indices of those among them that are left, whose rows say nothing yet.
    ///
    /// # Errors
    /// Where states cannot be drawn.
    pub(in crate::sweep) fn run_from(
        &self,
        begin: u64,
        options: &StreamOptions<'_>,
        wants_rows: bool,
        left: &mut dyn FnMut(&[u64], Vec<StateRow>),
    ) -> Result<StreamReport, LocusError> {
        let mut report = self.nothing();
        let mut done = 0;
        while done < options.states && !options.interrupt.load(Ordering::Relaxed) {
            let chunks = options.states.saturating_sub(done).div_ceil(CHUNK).min(CHUNKS);
            let share = Share::here();
            let found: Vec<Result<ChunkFound, LocusError>> = (0..chunks)
                .into_par_iter()
                .map(|chunk| {
                    let first = done + chunk * CHUNK;
                    let count = CHUNK.min(options.states - first);
                    let first = begin + first;
                    let chunk = Chunk { stream: self, options, first, count, wants_rows };
                    share.carry(|| self.instructions.run(chunk))
                })
                .collect();
            for part in found {
                let ChunkFound { report: part, left: indices, rows } = part?;
                report.append(&part);
                if !indices.is_empty() || wants_rows {
                    left(&indices, rows);
                }
            }
            done = report.states;
            (options.progress)(done);
        }
        report.interrupted = done < options.states;
        Ok(report)
    }

    fn nothing(&self) -> StreamReport {
        StreamReport {
            eliminated: self.reduction.eliminated,
            remaining: (self.reduction.rows.len(), self.reduction.columns.len()),
            ..StreamReport::default()
        }
    }
}

/// Expressions that have a finite value only where guards hold, but for divisors that are divided by anyway.
fn watches(graph: &mut Graph, guards: impl Iterator<Item = Guard>, computed: &[NodeId]) -> Vec<NodeId> {
    let divisors: HashSet<NodeId> = graph
        .reachable(computed.iter().copied())
        .into_iter()
        .filter_map(|id| match graph.node(id) {
            Node::Div(_, divisor) => Some(divisor),
            Node::Power(base, n) if n < 0 => Some(base),
            _ => None,
        })
        .collect();
    let one = graph.integer(1);
    let mut found = Vec::new();
    for guard in guards {
        if guard.is_obvious(graph) == Some(true)
            || guard.need == Need::NotZero && divisors.contains(&guard.node)
        {
            continue;
        }
        let divisor = match guard.need {
            Need::NotZero => guard.node,
            Need::Positive | Need::NotNegative => graph.apply(Function::Sqrt, guard.node),
            Need::InsideOne | Need::WithinOne => {
                let square = graph.power(guard.node, 2);
                let rest = graph.sub(one, square);
                graph.apply(Function::Sqrt, rest)
            }
        };
        found.push(graph.div(one, divisor));
    }
    found
}

/// The one value of a plain coordinate, where there is only one.
pub(in crate::sweep) fn held(source: &Source) -> Option<RBig> {
    match source {
        Source::Fixed(Coordinate::Number(value)) => Some(value.clone()),
        Source::Between(low, high) if low == high => Some(low.clone()),
        _ => None,
    }
}

/// Some states in a row, on one thread.
struct Chunk<'a, 'o> {
    stream: &'a Stream,
    options: &'a StreamOptions<'o>,
    first: u64,
    count: u64,
    wants_rows: bool,
}

/// What was found at them.
struct ChunkFound {
    report: StreamReport,
    /// The indices of those that are left for slower numbers.
    left: Vec<u64>,
    /// A row for each, where these are wanted.
    rows: Vec<StateRow>,
}

impl Vectorised for Chunk<'_, '_> {
    type Output = Result<ChunkFound, LocusError>;

    #[inline(always)]
    fn run<L: Lanes>(self, zero: L) -> Self::Output {
        let Chunk { stream, options, first, count, wants_rows } = self;
        let mut report = stream.nothing();
        let (mut left, mut rows_of_states) = (Vec::new(), Vec::new());
        let mut machine = stream.matrix.program.machine(Bounded::exact(zero));
        let lanes = machine.lanes();
        let mut drawer = Drawer::new(&stream.axes, &stream.avoid, options.seed, BlockOf { zero, lanes });
        let (rows, columns) = report.remaining;
        let mut decider = Decider::new(rows, columns, zero);
        let mut done = 0;
        while done < count {
            // a state beyond the last one is drawn too, and may fail without harm
            if let Err(place) = drawer.draw(first + done)
                && done + (place as u64) < count
            {
                return Err(stream.empty());
            }
            for input in &stream.matrix.inputs {
                let Some(room) = machine.input(input.place) else { continue };
                for (lane, value) in room.iter_mut().enumerate() {
                    *value = drawer.value(input.function, lane);
                }
            }
            machine.run();
            for lane in 0..lanes {
                let here = done + (lane * L::COUNT) as u64;
                if here >= count {
                    break;
                }
                let LaneFound { found, finite } =
                    decide_lane(&stream.matrix.program, &machine, lane, &mut decider, true);
                let mut smallest = [0.0; MOST_LANES];
                if wants_rows && let Some(value) = decider.singular_values().last() {
                    value.store(&mut smallest);
                }
                for (i, finite) in finite.into_iter().enumerate().take(L::COUNT.min((count - here) as usize))
                {
                    let index = first + here + i as u64;
                    let is_left = report.add(index, &found, i, finite, options.wanted);
                    if is_left {
                        left.push(index);
                    }
                    if wants_rows {
                        rows_of_states.push(StateRow {
                            index,
                            rank: (!is_left).then(|| report.full()),
                            certified: !is_left && found.certain[i] > 0.0,
                            smallest_singular_value: (!is_left).then_some(smallest[i]),
                            condition: (!is_left).then(|| 1.0 / found.ratio[i]),
                            coordinates: Vec::new(),
                        });
                    }
                }
            }
            done += machine.states() as u64;
        }
        Ok(ChunkFound { report, left, rows: rows_of_states })
    }
}

#[cfg(test)]
mod tests;
