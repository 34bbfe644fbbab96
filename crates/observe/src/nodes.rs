//! A window cut into segments, each with an initial state of its own: what the measurements and the joints between segments
//! say of these states, to first order.
//!
//! A segment is short, so that a guess far from the truth can be followed to its end where the whole window could not. The joints
//! are not exact here: they are residuals as the measurements are, with a weight (`stiff_joints` minimises them).

use super::{Lost, ModelFlow, Order};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// The segments of a window, and what is unknown of their states.
pub(super) struct Segments<'a> {
    pub flow: ModelFlow<'a>,
    /// In s; of the window's samples.
    pub times: &'a [f64],
    /// The measurements, a row a sample; NaN where an output was not measured.
    pub measured: Vec<Vec<f64>>,
    /// The samples of each segment; the last one of a segment is the first of the next.
    pub rows: Vec<Range<usize>>,
    /// The places of the states that move.
    pub moving: Vec<usize>,
    /// The places of the constants that are estimated.
    pub constant: Vec<usize>,
    /// What is not estimated, and the first values of the rest: a whole state.
    pub base: Vec<f64>,
    /// The magnitude of each state.
    pub sizes: Vec<f64>,
    /// The magnitude of each output.
    pub spread: Vec<f64>,
}

/// What each state keeps within: at the first node, constants among them, and at the others.
pub(super) struct Bounds {
    pub first: Vec<[f64; 2]>,
    pub later: Vec<[f64; 2]>,
}

impl Bounds {
    /// A value of a state at a node, moved to within.
    pub fn within(&self, node: usize, state: usize, value: f64) -> f64 {
        let [low, high] = if node == 0 { self.first[state] } else { self.later[state] };
        value.clamp(low, high)
    }
}

/// The initial states of all segments, and the constants.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Nodes {
    /// The moving states, a vector a segment.
    pub moving: Vec<DVector<f64>>,
    pub constant: DVector<f64>,
}

/// A segment to first order, in units of the sizes: expected minus measured, and the gap to the next segment.
pub(super) struct Segment {
    pub differences: DVector<f64>,
    pub by_moving: DMatrix<f64>,
    pub by_constant: DMatrix<f64>,
    /// Where the segment ends minus where the next one begins, and its derivatives by the segment's own state; none of the last one.
    pub gap: Option<(DVector<f64>, DMatrix<f64>, DMatrix<f64>)>,
}

impl Segments<'_> {
    /// The segments at some nodes.
    ///
    /// # Errors
    /// Where one of them cannot be followed to its end, or all of them would take too much memory.
    pub fn expand(&self, nodes: &Nodes) -> Result<Vec<Segment>, Lost> {
        self.flow.affordable(self.times, self.moving.len() + self.constant.len(), Order::First)?;
        (0..self.rows.len()).map(|place| self.segment(nodes, place)).collect()
    }

    /// The whole state at the first sample of a segment.
    pub fn state(&self, nodes: &Nodes, place: usize) -> Vec<f64> {
        let mut state = self.base.clone();
        for (i, value) in self.moving.iter().zip(nodes.moving[place].iter()) {
            state[*i] = *value;
        }
        for (i, value) in self.constant.iter().zip(nodes.constant.iter()) {
            state[*i] = *value;
        }
        state
    }

    /// Where a segment ends that begins at a state; none where it cannot be followed.
    pub fn end_of(&self, place: usize, state: &[f64]) -> Option<Vec<f64>> {
        let times = &self.times[self.rows[place].clone()];
        let end = self.flow.follow(state, &[], times, Order::Value).ok()?.pop()?;
        end.state.iter().all(|value| value.is_finite()).then_some(end.state)
    }

    fn segment(&self, nodes: &Nodes, place: usize) -> Result<Segment, Lost> {
        let rows = self.rows[place].clone();
        let is_last = place + 1 == self.rows.len();
        let free = [&self.moving[..], &self.constant].concat();
        let start = self.state(nodes, place);
        let samples = self.flow.follow(&start, &free, &self.times[rows.clone()], Order::First)?;
        // the last sample is compared by the segment that it begins
        let compared = samples.len() - usize::from(!is_last);
        let outputs = self.spread.len();
        let (n, c) = (self.moving.len(), self.constant.len());
        let mut differences = DVector::zeros(compared * outputs);
        let mut slopes = DMatrix::zeros(compared * outputs, n + c);
        for (i, sample) in samples.iter().take(compared).enumerate() {
            for output in 0..outputs {
                let (row, spread) = (i * outputs + output, self.spread[output]);
                let read = self.measured[rows.start + i][output];
                if read.is_nan() {
                    continue;
                }
                differences[row] = (sample.outputs[output] - read) / spread;
                for (j, state) in free.iter().enumerate() {
                    slopes[(row, j)] = sample.output_slopes[(output, j)] * self.sizes[*state] / spread;
                }
            }
        }
        let gap = samples.last().filter(|_| !is_last).map(|end| {
            let next = &nodes.moving[place + 1];
            let size = |i: usize| self.sizes[self.moving[i]];
            let gap = DVector::from_fn(n, |i, _| (end.state[self.moving[i]] - next[i]) / size(i));
            let by = |i: usize, j: usize| end.slopes[(self.moving[i], j)] * self.sizes[free[j]] / size(i);
            (gap, DMatrix::from_fn(n, n, by), DMatrix::from_fn(n, c, |i, j| by(i, n + j)))
        });
        let (by_moving, by_constant) = (slopes.columns(0, n).into_owned(), slopes.columns(n, c).into_owned());
        let segment = Segment { differences, by_moving, by_constant, gap };
        if segment.is_finite() {
            return Ok(segment);
        }
        Err(Lost { time: self.times[rows.start], why: "a number is not finite".to_owned() })
    }

    /// The nodes after a step in units of the sizes, kept within their bounds.
    pub fn stepped(&self, nodes: &Nodes, step: &Nodes, bounds: &Bounds) -> Nodes {
        let along = |node: usize, values: &DVector<f64>, steps: &DVector<f64>, states: &[usize]| {
            let moved = |i: usize| values[i] + steps[i] * self.sizes[states[i]];
            DVector::from_fn(values.len(), |i, _| bounds.within(node, states[i], moved(i)))
        };
        let moving = nodes.moving.iter().zip(&step.moving).enumerate();
        Nodes {
            moving: moving.map(|(node, (values, steps))| along(node, values, steps, &self.moving)).collect(),
            constant: along(0, &nodes.constant, &step.constant, &self.constant),
        }
    }

    /// The step from some nodes to others, in units of the sizes.
    pub fn step_between(&self, from: &Nodes, to: &Nodes) -> Nodes {
        let along = |a: &DVector<f64>, b: &DVector<f64>, states: &[usize]| {
            DVector::from_fn(a.len(), |i, _| (b[i] - a[i]) / self.sizes[states[i]])
        };
        let moving = from.moving.iter().zip(&to.moving);
        Nodes {
            moving: moving.map(|(a, b)| along(a, b, &self.moving)).collect(),
            constant: along(&from.constant, &to.constant, &self.constant),
        }
    }
}

impl Segment {
    fn is_finite(&self) -> bool {
        let gap = self.gap.iter().flat_map(|(gap, a, b)| gap.iter().chain(a.iter()).chain(b.iter()));
        let own = self.differences.iter().chain(self.by_moving.iter()).chain(self.by_constant.iter());
        own.chain(gap).all(|value| value.is_finite())
    }

    /// The sum of the squares of the residuals, the gap with a weight.
    pub fn cost(&self, weight: f64) -> f64 {
        let gap = self.gap.as_ref().map_or(0.0, |(gap, _, _)| weight * weight * gap.norm_squared());
        self.differences.norm_squared() + gap
    }
}

impl Nodes {
    /// The largest entry of a step.
    pub fn longest(&self) -> f64 {
        self.moving
            .iter()
            .flatten()
            .chain(self.constant.iter())
            .fold(0.0, |most, value| value.abs().max(most))
    }
}
