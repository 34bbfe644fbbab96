//! States drawn by the block: uniformly from a sample box, away from what is to be avoided.
//!
//! A state is exact: every coordinate is a double, and an angle is given by the double that is the tangent of its half,
//! so that its sine and cosine are rational numbers.

use super::random::{threefry, unit};
use crate::observability::{ATTEMPTS, AVOIDED, Source};
use dashu::rational::RBig;
use palmistry_math::expression::{BlockProgram, Input, Machine, Symbol, SymbolFunction, SymbolInput};
use palmistry_math::number::{Bounded, LaneTask, Lanes, MOST_LANES, rational_from_f64, rational_to_f64};

/// One coordinate that is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    pub symbol: Symbol,
    low: f64,
    high: f64,
    /// Whether it is an angle, in radians here, and then drawn as the tangent of its half.
    pub is_turn: bool,
}

impl Axis {
    /// `None` where a source says one value only, or where no double lies within its range.
    pub fn new(symbol: Symbol, source: &Source) -> Option<Axis> {
        let (low, high, is_turn) = match source {
            Source::Fixed(_) => return None,
            Source::Turn(low, high) => (*low, *high, true),
            Source::Between(low, high) => (inside(low, f64::next_up), inside(high, f64::next_down), false),
        };
        (low < high).then_some(Axis { symbol, low, high, is_turn })
    }

    /// Whether the width of the range is a double.
    pub fn is_held_by_doubles(&self) -> bool {
        (self.high - self.low).is_finite()
    }

    /// The coordinate at parts of the range between zero and one.
    #[inline(always)]
    fn at<L: Lanes>(self, part: L) -> L {
        let high = part.splat(self.high);
        let value = (part.splat(self.low) + part.splat(self.high - self.low) * part).smaller(high);
        if !self.is_turn {
            return value;
        }
        let (sine, cosine) = (part.splat(0.5) * value).sin_cos();
        sine / cosine
    }
}

/// The double nearest to a rational, or the next one if that lies on the wrong side.
fn inside(bound: &RBig, next: fn(f64) -> f64) -> f64 {
    let nearest = rational_to_f64(bound);
    let beyond = next(nearest);
    let outside = rational_from_f64(nearest)
        .is_some_and(|double| if beyond > nearest { double < *bound } else { double > *bound });
    if outside { beyond } else { nearest }
}

/// A function of one coordinate that is drawn, by the coordinate's place among the axes.
#[derive(Clone, Copy, Debug)]
pub(super) enum AxisFunction {
    Plain(usize),
    Sine(usize),
    Cosine(usize),
}

/// Where an input of a program comes from.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrawnInput {
    /// Its place among the inputs.
    pub place: usize,
    pub function: AxisFunction,
}

/// A program whose inputs are drawn.
#[derive(Clone, Debug)]
pub(super) struct DrawnProgram {
    pub program: BlockProgram,
    /// Where those of its inputs come from that have any influence.
    pub inputs: Vec<DrawnInput>,
}

impl DrawnProgram {
    /// `None` where it needs something that is not drawn.
    pub fn new(program: BlockProgram, axes: &[Axis]) -> Option<DrawnProgram> {
        let axis = |symbol: Symbol, is_turn: bool| {
            axes.iter().position(|axis| axis.symbol == symbol).filter(|place| axes[*place].is_turn == is_turn)
        };
        let drawn = |(place, input): (usize, &Input)| {
            let SymbolInput { symbol, function } = input.of_symbol()?;
            let function = match function {
                SymbolFunction::Itself => AxisFunction::Plain(axis(symbol, false)?),
                SymbolFunction::Sine => AxisFunction::Sine(axis(symbol, true)?),
                SymbolFunction::Cosine => AxisFunction::Cosine(axis(symbol, true)?),
            };
            Some(DrawnInput { place, function })
        };
        let used = program.inputs().iter().enumerate().filter(|(place, _)| program.is_used(*place));
        let inputs = used.map(drawn).collect::<Option<_>>()?;
        Some(DrawnProgram { program, inputs })
    }
}

/// In which numbers states are drawn, and how many at a time.
#[derive(Clone, Copy)]
pub(super) struct BlockOf<L> {
    pub zero: L,
    pub lanes: usize,
}

/// A block of drawn states, structure of arrays.
pub(super) struct Drawer<'a, L> {
    axes: &'a [Axis],
    seed: u64,
    zero: L,
    /// By axes, as many values each as there are states in the block.
    values: Vec<f64>,
    states: usize,
    avoid: Machine<'a, L>,
    avoided: usize,
    avoid_inputs: &'a [DrawnInput],
}

impl<'a, L: Lanes> Drawer<'a, L> {
    #[inline(always)]
    pub fn new(axes: &'a [Axis], avoid: &'a DrawnProgram, seed: u64, block: BlockOf<L>) -> Self {
        let BlockOf { zero, lanes } = block;
        let states = lanes * L::COUNT;
        Drawer {
            axes,
            seed,
            zero,
            values: vec![0.0; axes.len() * states],
            states,
            avoid: avoid.program.machine_of(zero, states / L::COUNT),
            avoided: avoid.program.outputs(),
            avoid_inputs: &avoid.inputs,
        }
    }

    /// Draws the states from `first` on. The place in the block of one for which nothing was found, if there is one.
    pub fn draw(&mut self, first: u64) -> Result<(), usize> {
        self.zero.apart(Draw(self, first))
    }

    #[inline(always)]
    fn draw_block(&mut self, first: u64) -> Result<(), usize> {
        let whole = self.states - self.states % MOST_LANES;
        for start in (0..whole).step_by(MOST_LANES) {
            self.draw_some::<MOST_LANES>(first, start, 0);
        }
        for place in whole..self.states {
            self.draw_some::<1>(first, place, 0);
        }
        for attempt in 1..=ATTEMPTS as u64 {
            let Some(rejected) = self.rejected() else { return Ok(()) };
            if attempt == ATTEMPTS as u64 {
                return Err(rejected[0]);
            }
            for place in rejected {
                self.draw_some::<1>(first, place, attempt);
            }
        }
        Ok(())
    }

    /// Draws `N` states from a place in the block on: one, or as many as fill whole lanes.
    #[inline(always)]
    fn draw_some<const N: usize>(&mut self, first: u64, start: usize, attempt: u64) {
        let mut counters = [0; N];
        for (lane, counter) in counters.iter_mut().enumerate() {
            *counter = first.wrapping_add((start + lane) as u64);
        }
        for pair in 0..self.axes.len().div_ceil(2) {
            // which attempt, and which coordinates
            let which = attempt << 32 | pair as u64;
            let (left, right) = threefry(counters, [which; N], [self.seed, 0]);
            for (side, words) in [left, right].into_iter().enumerate() {
                let place = 2 * pair + side;
                let Some(axis) = self.axes.get(place) else { break };
                let parts = unit(words);
                let row = &mut self.values[place * self.states + start..][..N];
                if N.is_multiple_of(L::COUNT) {
                    for lane in (0..N).step_by(L::COUNT) {
                        axis.at(self.zero.load(&parts[lane..])).store(&mut row[lane..]);
                    }
                } else {
                    for (value, part) in row.iter_mut().zip(parts) {
                        *value = axis.at(part);
                    }
                }
            }
        }
    }

    /// The states that come too near to what is avoided; `None` where none does.
    #[inline(always)]
    fn rejected(&mut self) -> Option<Vec<usize>> {
        if self.avoided == 0 {
            return None;
        }
        let lanes = self.avoid.lanes();
        for input in self.avoid_inputs {
            for lane in 0..lanes {
                let value = plain(self.values(lane), input.function, self.zero);
                if let Some(room) = self.avoid.input(input.place) {
                    room[lane] = value;
                }
            }
        }
        self.avoid.run();
        let mut rejected = Vec::new();
        let (bound, one) = (self.zero.splat(AVOIDED), self.zero.splat(1.0));
        for lane in 0..lanes.min(self.states / L::COUNT) {
            // zero where nothing is too near to zero or undefined
            let mut bad = self.avoid.health(lane);
            for place in 0..self.avoided {
                let value = self.avoid.output(place, lane);
                bad = bad + value.zero_if_finite() + value.abs().where_less(bound, one, self.zero);
            }
            let mut marks = [0.0; MOST_LANES];
            bad.store(&mut marks);
            rejected.extend((0..L::COUNT).filter(|i| marks[*i] != 0.0).map(|i| lane * L::COUNT + i));
        }
        (!rejected.is_empty()).then_some(rejected)
    }

    /// All coordinates of the states in one lane.
    #[inline(always)]
    fn values(&self, lane: usize) -> Lane<'_> {
        // the avoid program's block may be one lane longer
        let at = (lane * L::COUNT).min(self.states - L::COUNT);
        Lane { values: &self.values, states: self.states, at }
    }

    /// The values of a function in one lane, with a bound on their errors.
    #[inline(always)]
    pub fn value(&self, function: AxisFunction, lane: usize) -> Bounded<L> {
        let at = self.values(lane);
        match function {
            AxisFunction::Plain(place) => Bounded::exact(self.zero.load(at.row(place))),
            AxisFunction::Sine(place) => sine(Bounded::exact(self.zero.load(at.row(place)))),
            AxisFunction::Cosine(place) => cosine(Bounded::exact(self.zero.load(at.row(place)))),
        }
    }

    /// The coordinates of one state of the block.
    pub fn coordinates(&self, state: usize) -> Vec<f64> {
        (0..self.axes.len()).map(|place| self.values[place * self.states + state]).collect()
    }
}

struct Draw<'d, 'a, L>(&'d mut Drawer<'a, L>, u64);

impl<L: Lanes> LaneTask for Draw<'_, '_, L> {
    type Output = Result<(), usize>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        self.0.draw_block(self.1)
    }
}

struct Lane<'v> {
    values: &'v [f64],
    states: usize,
    at: usize,
}

impl<'v> Lane<'v> {
    #[inline(always)]
    fn row(&self, place: usize) -> &'v [f64] {
        &self.values[place * self.states + self.at..]
    }
}

#[inline(always)]
fn plain<L: Lanes>(values: Lane<'_>, function: AxisFunction, zero: L) -> L {
    match function {
        AxisFunction::Plain(place) => zero.load(values.row(place)),
        AxisFunction::Sine(place) => sine(zero.load(values.row(place))),
        AxisFunction::Cosine(place) => cosine(zero.load(values.row(place))),
    }
}

/// `2t / (1 + t^2)`
#[inline(always)]
fn sine<L: Lanes>(t: L) -> L {
    (t + t) / (t.splat(1.0) + t * t)
}

/// `(1 - t)(1 + t) / (1 + t^2)`
#[inline(always)]
fn cosine<L: Lanes>(t: L) -> L {
    let one = t.splat(1.0);
    (one - t) * (one + t) / (one + t * t)
}
