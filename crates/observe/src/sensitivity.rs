//! How what a model expects depends on the single samples of the columns that drive it.
//!
//! Curves are linear in the samples that carry them, so that the derivative of a state by a sample obeys the variational equation
//! `G' = F G + B l(t)`, `F` and `B` being the derivatives of the rates by states and columns and `l` the polynomial that is one at that
//! sample. Between two samples eight polynomials per column are at work; their response over the step is integrated by
//! the classical method of Runge and Kutta, two steps from a sample to the next, along the states that the flow's own
//! integrator gives.

use super::jet::Jet;
use super::model::{Formulas, InputSource};
use super::{Lost, ModelFlow, Order};
use nalgebra::{DMatrix, DVector};
use num_dual::DualSVec64;
use palmistry_math::number::{Duals, Refusal};

/// So many derivatives are taken at once.
const AT_ONCE: usize = 8;
type Number = DualSVec64<AT_ONCE>;

/// Fractions of the time from a sample to the next at which the equations are evaluated.
const FRACTIONS: [f64; 4] = [0.0, 0.25, 0.5, 0.75];

/// The derivatives of what is expected in a window by the samples of some columns: step by step, as a recursion for the error of the state, so that
/// what is done with them grows as the number of samples.
#[derive(Clone, Debug)]
pub(super) struct Sensitivity {
    /// How each sample of the window depends on the state's error and on its own measurements' errors.
    pub samples: Vec<SampleOutputs>,
    /// From each sample of the window to the next.
    pub steps: Vec<Step>,
    /// The columns, by their places in the signals.
    pub columns: Vec<usize>,
    /// The first row of the signals that takes part.
    pub first: usize,
    /// How many rows take part.
    pub rows: usize,
    /// How many states are followed.
    pub states: usize,
    /// How many samples carry a curve at a time.
    pub points: usize,
}

/// What is expected of the outputs at a sample, by the errors.
#[derive(Clone, Debug)]
pub(super) struct SampleOutputs {
    /// A row an output, a column a state.
    pub by_states: DMatrix<f64>,
    /// A row an output, a column one of the columns of the signals at this very sample.
    pub by_columns: DMatrix<f64>,
    /// The sample, counted from the first row that takes part.
    pub own: usize,
    /// The first of the samples that carry the curves from here on, counted alike.
    pub start: usize,
}

/// The error of the state after a step: by the error before it, and by those of the samples that carry the curves in it.
#[derive(Clone, Debug)]
pub(super) struct Step {
    /// A row a state; a column a state, and then `points` for each column of the signals.
    pub response: DMatrix<f64>,
}

/// Derivatives of rates and outputs by states and columns, at one time.
struct Linear {
    by_states: [DMatrix<f64>; 2],
    by_columns: [DMatrix<f64>; 2],
}

impl Sensitivity {
    /// Of a flow at the times of a window, which are samples, from a state at the first of them.
    ///
    /// # Errors
    /// Where the model cannot be followed.
    pub fn of(
        flow: &ModelFlow<'_>,
        start: &[f64],
        times: &[f64],
        columns: Vec<usize>,
    ) -> Result<Sensitivity, Lost> {
        let signals = flow.signals;
        let fine: Vec<f64> = times
            .windows(2)
            .flat_map(|pair| FRACTIONS.map(|part| pair[0] + part * (pair[1] - pair[0])))
            .chain(times.last().copied())
            .collect();
        let along = flow.follow(start, &[], &fine, Order::Value)?;
        let points = signals.carriers();
        let first = signals.first_carrier(times[0]);
        let end = signals.first_carrier(times[times.len() - 1]) + points;
        let (rows, n, k) = (end - first, start.len(), columns.len());
        let linear: Vec<Linear> = along
            .iter()
            .map(|sample| linearise(flow, sample.time, &sample.state, &columns))
            .collect::<Result<_, _>>()?;
        let seen = |(i, time): (usize, &f64)| {
            let here = &linear[i * FRACTIONS.len()];
            SampleOutputs {
                by_states: here.by_states[1].clone(),
                by_columns: here.by_columns[1].clone(),
                own: signals.times().partition_point(|other| other < time) - first,
                start: signals.first_carrier(*time) - first,
            }
        };
        let samples = times.iter().enumerate().map(seen).collect();
        let step = |(i, pair): (usize, &[f64])| {
            let start = signals.first_carrier(pair[0]);
            let along = &linear[i * FRACTIONS.len()..=(i + 1) * FRACTIONS.len()];
            let weights = |part: f64| signals.weights_from(start, pair[0] + part * (pair[1] - pair[0]));
            Step { response: response(along, pair[1] - pair[0], n, k, points, weights) }
        };
        let steps = times.windows(2).enumerate().map(step).collect();
        Ok(Sensitivity { samples, steps, columns, first, rows, states: n, points })
    }

    /// What some errors of the samples change in what is expected.
    pub fn times(&self, errors: &DVector<f64>) -> DVector<f64> {
        let mut state = DVector::zeros(self.states);
        let mut expected = Vec::new();
        for (i, seen) in self.samples.iter().enumerate() {
            let own = DVector::from_fn(self.columns.len(), |column, _| errors[column * self.rows + seen.own]);
            expected.extend((&seen.by_states * &state + &seen.by_columns * own).iter());
            let Some(step) = self.steps.get(i) else { break };
            let mut next = step.response.columns(0, self.states) * &state;
            for column in 0..self.columns.len() {
                let own = errors.rows(column * self.rows + seen.start, self.points);
                next += step.response.columns(self.states + column * self.points, self.points) * own;
            }
            state = next;
        }
        DVector::from_vec(expected)
    }

    /// The transposed of it: how much each error of the samples changes a sum of what is expected, with these weights.
    pub fn transposed_times(&self, weights: &DVector<f64>) -> DVector<f64> {
        let outputs = self.samples.first().map_or(0, |seen| seen.by_states.nrows());
        let mut errors = DVector::zeros(self.columns.len() * self.rows);
        let mut pull = DVector::zeros(self.states);
        for (i, seen) in self.samples.iter().enumerate().rev() {
            if let Some(step) = self.steps.get(i) {
                let back = step.response.tr_mul(&pull);
                for column in 0..self.columns.len() {
                    for j in 0..self.points {
                        errors[column * self.rows + seen.start + j] +=
                            back[self.states + column * self.points + j];
                    }
                }
                pull = back.rows(0, self.states).into_owned();
            }
            let own = weights.rows(i * outputs, outputs);
            pull += seen.by_states.tr_mul(&own);
            let direct = seen.by_columns.tr_mul(&own);
            for column in 0..self.columns.len() {
                errors[column * self.rows + seen.own] += direct[column];
            }
        }
        errors
    }

    /// All of it as a matrix: a row an expected value, sample by sample; a column a sample, those of one column of the signals together.
    #[cfg(test)]
    pub fn dense(&self) -> DMatrix<f64> {
        let count = self.columns.len() * self.rows;
        let unit = |place: usize| DVector::from_fn(count, |i, _| f64::from(u8::from(i == place)));
        DMatrix::from_columns(&(0..count).map(|place| self.times(&unit(place))).collect::<Vec<_>>())
    }
}

/// The state after a step by the state before it, and by the samples that carry the curves in it: `n` columns, and then `points`
/// for each of `k` columns of the signals.
fn response(
    along: &[Linear],
    length: f64,
    n: usize,
    k: usize,
    points: usize,
    weights: impl Fn(f64) -> Vec<f64>,
) -> DMatrix<f64> {
    let mut state = DMatrix::zeros(n, n + k * points);
    state.fill_diagonal(1.0);
    let rate = |place: usize, state: &DMatrix<f64>| {
        let linear = &along[place];
        let mut rate = &linear.by_states[0] * state;
        let carried = weights(place as f64 / FRACTIONS.len() as f64);
        for column in 0..k {
            for (j, weight) in carried.iter().enumerate() {
                let mut own = rate.column_mut(n + column * points + j);
                own.axpy(*weight, &linear.by_columns[0].column(column), 1.0);
            }
        }
        rate
    };
    let step = length / 2.0;
    for half in 0..2 {
        let place = 2 * half;
        let a = rate(place, &state);
        let b = rate(place + 1, &(&state + &a * (step / 2.0)));
        let c = rate(place + 1, &(&state + &b * (step / 2.0)));
        let d = rate(place + 2, &(&state + &c * step));
        state += (a + (b + c) * 2.0 + d) * (step / 6.0);
    }
    state
}

fn linearise(flow: &ModelFlow<'_>, time: f64, state: &[f64], columns: &[usize]) -> Result<Linear, Lost> {
    let model = flow.model;
    let mut given = vec![0.0; model.columns.len()];
    flow.signals.at(&model.columns, time, &mut given);
    let (n, total) = (state.len(), state.len() + columns.len());
    let refuse = |refusal: Refusal| Lost { time, why: format!("the model has no value: {refusal}") };
    let derivatives = |formulas: &Formulas, size: usize| -> Result<DMatrix<f64>, Lost> {
        let loaded = formulas.program.load(Duals::<Number>::default()).map_err(refuse)?;
        let mut registers = Vec::new();
        let mut all = DMatrix::zeros(size, total);
        for chunk in (0..total).step_by(AT_ONCE) {
            let seeded = |value: f64, direction: Option<usize>| {
                let mut places = [0.0; AT_ONCE + 1];
                places[0] = value;
                if let Some(own) = direction.and_then(|d| d.checked_sub(chunk)).filter(|d| *d < AT_ONCE) {
                    places[1 + own] = 1.0;
                }
                Number::unpack(&places)
            };
            let input = |source: &InputSource| match *source {
                InputSource::State(place) => seeded(state[place], Some(place)),
                InputSource::Column(place) | InputSource::Rate(place) => {
                    let noisy = columns.iter().position(|column| *column == model.columns[place]);
                    seeded(given[place], noisy.map(|column| n + column))
                }
            };
            let inputs: Vec<Number> = formulas.sources.iter().map(input).collect();
            let values = loaded.run(&inputs, &mut registers).map_err(|error| refuse(error.refusal))?;
            let mut places = [0.0; AT_ONCE + 1];
            for (row, value) in values.iter().enumerate() {
                value.pack(&mut places);
                for (direction, slope) in (chunk..total.min(chunk + AT_ONCE)).zip(&places[1..]) {
                    all[(row, direction)] = *slope;
                }
            }
        }
        Ok(all)
    };
    let rates = derivatives(&model.rates, n)?;
    let seen = derivatives(&model.output_formulas, model.outputs.len())?;
    let part = |from: usize, count: usize| [&rates, &seen].map(|all| all.columns(from, count).into_owned());
    Ok(Linear { by_states: part(0, n), by_columns: part(n, columns.len()) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Model, ModelQuestion, Signals};
    use palmistry_lang::System;
    use std::path::Path;

    /// A pendulum that is pushed through a moving frame: the model and its curves, from a file and closed forms, with samples as near to each
    /// other as is asked for.
    fn pushed(scale: f64) -> (System, Signals) {
        let text = "system \"A pushed pendulum\"\nstate x, v\nparam a, u\ndrift f\n  x' = v\n  v' = -4*sin(x + a) - v*a^2\n\
                    input g\n  v' = 1 + x^2\n  others' = 0\noutput x + a*u, v\n";
        // uneven times, more than carry one curve
        let times: Vec<f64> =
            (0..25).map(|i| scale * (0.05 * f64::from(i) + 0.01 * f64::from(i * i % 5))).collect();
        let column =
            |name: &str, at: &dyn Fn(f64) -> f64| (name.to_owned(), times.iter().map(|t| at(*t)).collect());
        let columns = vec![
            column("a", &|t| 0.3 * (2.0 * t).sin()),
            column("u", &|t| (3.0 * t).cos()),
            column("x + a*u", &|_| 0.0),
            column("v", &|_| 0.0),
        ];
        let system = System::parse("pushed.proof", text, Path::new("")).unwrap();
        (system, Signals::new(times.clone(), columns).unwrap())
    }

    /// The derivative by every sample against differences of the flow's own integrator, in a window within the recording. A sample acts on the state
    /// for about as long as an interval between samples, of which there are some of 0.09 s; two steps of the fourth order on polynomials of degree
    /// seven err by half a percent of that at most, however near to each other the samples are.
    #[test]
    fn slopes_are_what_a_sample_changes() {
        for scale in [1.0, 0.5, 0.1] {
            let worst = worst(scale);
            assert!(worst < 5e-3 * 0.09 * scale, "{worst:e} at {scale}");
        }
    }

    /// The largest difference between a slope and what is found by changing a sample.
    fn worst(scale: f64) -> f64 {
        let (system, signals) = pushed(scale);
        let question = ModelQuestion {
            followed: ["x", "v"].map(str::to_owned).to_vec(),
            inputs: vec![("g".to_owned(), "u".to_owned())],
            ..ModelQuestion::default()
        };
        let model = Model::new(&system, &question, &signals).unwrap();
        assert_eq!(model.outputs, ["x + a*u", "v"]);
        let flow =
            ModelFlow { model: &model, signals: &signals, tolerance: 1e-11, stride: crate::Stride::BySample };
        let times = signals.times()[6..18].to_vec();
        let start = [0.4, -0.2];
        let columns = vec![signals.find("a").unwrap(), signals.find("u").unwrap()];
        let found = Sensitivity::of(&flow, &start, &times, columns.clone()).unwrap();
        assert_eq!((found.first, found.rows), (3, 19));
        let slopes = found.dense();
        let expected = |signals: &Signals| -> DVector<f64> {
            let flow = ModelFlow { signals, ..flow };
            let samples = flow.follow(&start, &[], &times, Order::Value).unwrap();
            DVector::from_vec(samples.into_iter().flat_map(|sample| sample.outputs).collect())
        };
        const STEP: f64 = 1e-4;
        let (mut largest, mut worst) = (0.0f64, 0.0f64);
        for (place, column) in columns.iter().enumerate() {
            for row in 0..signals.times().len() {
                let moved = |by: f64| {
                    let mut signals = signals.clone();
                    signals.take_off(*column, row, &[-by]);
                    expected(&signals)
                };
                let slope = (moved(STEP) - moved(-STEP)) / (2.0 * STEP);
                let own = row.checked_sub(found.first).filter(|row| *row < found.rows);
                let own = own.map(|row| slopes.column(place * found.rows + row).into_owned());
                let own = own.unwrap_or_else(|| DVector::zeros(slope.len()));
                largest = largest.max(slope.amax());
                worst = worst.max((slope - own).amax());
            }
        }
        // outputs depend on their own sample at once, and on what it did to the state later
        assert!(largest > 0.5, "{largest}");
        worst
    }
}
