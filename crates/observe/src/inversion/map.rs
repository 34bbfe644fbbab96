//! The observability map of a model: outputs and their derivatives along the motion, with the differentials of all of them.

use crate::nodes::Segments;
use crate::task::Task;
use nalgebra::{DMatrix, DVector};
use palmistry_math::expression::{NodeId, Program, Symbol, gradient};
use palmistry_math::number::Duals;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ops::Range;

/// Derivatives of higher order are not asked of measurements.
const MOST_ORDER: usize = 7;

/// Maps of more operations are not evaluated.
const MOST_OPERATIONS: usize = 20_000;

/// The polynomials have so many degrees more than derivatives are asked for.
const MORE_DEGREES: usize = 2;

/// The rank is full where the scaled condition is better than this.
const SINGULAR: f64 = 1e8;

/// Where an input of the map comes from.
enum Source {
    State(usize),
    /// A derivative of a column of the signals.
    Signal(usize, usize),
}

/// Outputs and their derivatives along the motion, with the differentials of all of them by the states.
pub struct ObservabilityMap {
    program: Program,
    sources: Vec<Source>,
    /// Derivatives of outputs, order by order: so many rows.
    pub rows: usize,
    outputs: usize,
    states: usize,
}

/// The derivatives of columns at a time, by the column and the order.
pub type SignalDerivatives = HashMap<usize, Vec<f64>>;

/// The derivatives of a column at a time, by the polynomial of least squares through the rows about it.
fn derivatives(
    times: &[f64],
    column: &[f64],
    time: f64,
    rows: &Range<usize>,
    degree: usize,
) -> Option<Vec<f64>> {
    let times = &times[rows.clone()];
    let far = times.iter().map(|other| (other - time).abs()).fold(0.0, f64::max);
    let degree = degree.min(times.len() - 1);
    let powers = DMatrix::from_fn(times.len(), degree + 1, |i, k| ((times[i] - time) / far).powi(k as i32));
    let right = DVector::from_column_slice(&column[rows.clone()]);
    let factors = powers.qr();
    let right = factors.q().tr_mul(&right);
    let coefficients = factors.r().solve_upper_triangular(&right)?;
    let mut factorial = 1.0;
    let derivative = |(k, value): (usize, &f64)| {
        factorial *= k.max(1) as f64;
        value * factorial / far.powi(k as i32)
    };
    Some(coefficients.iter().enumerate().map(derivative).collect())
}

impl ObservabilityMap {
    /// With as many derivatives as make the rank full at one of the states at the least.
    pub fn new(
        task: &Task<'_>,
        segments: &Segments<'_>,
        rows: &Range<usize>,
        draws: &[Vec<f64>],
    ) -> Option<ObservabilityMap> {
        let model = &task.full;
        let mut graph = model.system.graph.clone();
        let mut signals: HashMap<Symbol, (usize, usize)> = HashMap::new();
        let mut all: Vec<NodeId> = model.output_nodes.clone();
        let mut last = all.clone();
        let middle = rows.start + rows.len() / 2;
        for _ in 0..MOST_ORDER {
            let mut next = Vec::new();
            for node in &last {
                let mut terms = Vec::new();
                let by_states = gradient(&mut graph, *node, &model.symbols);
                for (slope, rate) in by_states.into_iter().zip(&model.rate_nodes) {
                    terms.push(graph.mul(slope, *rate));
                }
                let own: Vec<Symbol> = graph.symbols_of([*node]);
                let own: Vec<Symbol> = own.into_iter().filter(|own| !model.symbols.contains(own)).collect();
                for (slope, signal) in gradient(&mut graph, *node, &own).into_iter().zip(own) {
                    let (column, order) = match signals.get(&signal) {
                        Some(known) => *known,
                        None => (task.signals.find(graph.symbol_name(signal))?, 0),
                    };
                    signals.insert(signal, (column, order));
                    let name = format!("{}'", graph.symbol_name(signal));
                    let rate = graph.intern(&name);
                    signals.insert(rate, (column, order + 1));
                    let rate = graph.symbol(rate);
                    terms.push(graph.mul(slope, rate));
                }
                next.push(graph.sum(terms));
            }
            all.extend(&next);
            last = next;
            if all.len() < segments.moving.len() + segments.constant.len() {
                continue;
            }
            let mut asked = all.clone();
            for node in &all {
                asked.extend(gradient(&mut graph, *node, &model.symbols));
            }
            let program = Program::plain(&graph, &asked);
            if program.len() > MOST_OPERATIONS {
                return None;
            }
            let mut sources = Vec::new();
            for input in program.inputs() {
                let Some(symbol) = input.symbol() else { continue };
                sources.push(match model.symbols.iter().position(|other| *other == symbol) {
                    Some(place) => Source::State(place),
                    None => {
                        let (column, order) = match signals.get(&symbol) {
                            Some(known) => *known,
                            None => (task.signals.find(graph.symbol_name(symbol))?, 0),
                        };
                        Source::Signal(column, order)
                    }
                });
            }
            let map = ObservabilityMap {
                program,
                sources,
                rows: all.len(),
                outputs: model.output_nodes.len(),
                states: model.states.len(),
            };
            let given = map.given(task, rows, middle, (rows.len(), map.degree()))?;
            let free = [&segments.moving[..], &segments.constant].concat();
            if draws.iter().any(|state| map.is_regular(state, &given, segments, &free)) {
                return Some(map);
            }
        }
        None
    }

    /// The derivatives of the measurements near a row, of the columns of the outputs and of what drives the map.
    pub fn given(
        &self,
        task: &Task<'_>,
        rows: &Range<usize>,
        row: usize,
        (stretch, degree): (usize, usize),
    ) -> Option<SignalDerivatives> {
        let half = stretch / 2;
        let first = row.saturating_sub(half).clamp(rows.start, rows.end - stretch);
        let near = first..first + stretch;
        let times = task.signals.times();
        let columns = task.full.measured.iter().flatten().copied();
        let driving = self.sources.iter().filter_map(|source| match source {
            Source::Signal(column, _) => Some(*column),
            Source::State(_) => None,
        });
        let mut given = SignalDerivatives::new();
        for column in columns.chain(driving) {
            if let Entry::Vacant(place) = given.entry(column) {
                let values = task.signals.column(column);
                place.insert(derivatives(times, values, times[row], &near, degree)?);
            }
        }
        Some(given)
    }

    /// The rows at a state, and their derivatives by all states.
    pub fn at(&self, state: &[f64], given: &SignalDerivatives) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let input = |source: &Source| match *source {
            Source::State(place) => state[place],
            Source::Signal(column, order) => given[&column].get(order).copied().unwrap_or(0.0),
        };
        let inputs: Vec<f64> = self.sources.iter().map(input).collect();
        let program = self.program.load(Duals::<f64>::default()).ok()?;
        let values = program.run(&inputs, &mut Vec::new()).ok()?;
        let is_finite = values.iter().all(|value| value.is_finite());
        let (rows, slopes) = values.split_at(self.rows);
        is_finite.then(|| {
            (DVector::from_column_slice(rows), DMatrix::from_row_slice(self.rows, self.states, slopes))
        })
    }

    /// The degree of the polynomials from which its derivatives are taken.
    pub fn degree(&self) -> usize {
        self.rows / self.outputs - 1 + MORE_DEGREES
    }

    fn is_regular(
        &self,
        state: &[f64],
        given: &SignalDerivatives,
        segments: &Segments<'_>,
        free: &[usize],
    ) -> bool {
        let Some((_, slopes)) = self.at(state, given) else { return false };
        let mut scaled =
            DMatrix::from_fn(self.rows, free.len(), |i, j| slopes[(i, free[j])] * segments.sizes[free[j]]);
        for mut row in scaled.row_iter_mut() {
            let length = row.norm();
            if length > 0.0 {
                row /= length;
            }
        }
        let Some(svd) = scaled.try_svd(false, false, f64::EPSILON, 10_000) else { return false };
        svd.singular_values.min() * SINGULAR > svd.singular_values.max()
    }

    /// The measured values of the rows.
    pub fn read(&self, task: &Task<'_>, given: &SignalDerivatives) -> Vec<f64> {
        let one = |row: usize| {
            let column = task.full.measured[row % self.outputs];
            column.and_then(|column| given[&column].get(row / self.outputs).copied()).unwrap_or(0.0)
        };
        (0..self.rows).map(one).collect()
    }
}
