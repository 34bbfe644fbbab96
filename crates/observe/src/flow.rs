//! The flow of a model: its states followed through time, with their first and second derivatives by the unknown parts
//! of the first state.
//!
//! Sensitivities are integrated along: num-dual evaluates the equations on states that carry their derivatives, which is
//! the right-hand side of the variational equations of that order, and ode_solvers integrates all of it with one step
//! control (Dormand and Prince, order 8(5,3)). Nothing is differenced.

use super::jet::{Jet, triangle};
use super::late::states_before;
use super::model::{Formulas, InputSource};
use super::quick_step::{QuickSteps, Stopped};
use super::{Model, Signals};
use nalgebra::DMatrix;
use num_dual::{Dual2SVec64, DualSVec64};
use ode_solvers::dop_shared::{IntegrationError, OutputType};
use ode_solvers::{DVector, Dop853, System};
use palmistry_math::number::{Duals, Refusal};
use std::cell::{Cell, RefCell};

/// How many derivatives are carried along.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// The state alone.
    Value,
    /// Its first derivatives by the unknowns as well.
    First,
    /// The second ones as well.
    Second,
}

/// Where a flow could not be followed, and why.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("at {time:.6} s {why}")]
pub struct Lost {
    /// In s.
    pub time: f64,
    /// The reason, as text.
    pub why: String,
}

/// The model at one time, `p` being the number of unknowns.
#[derive(Clone, Debug)]
pub struct Sample {
    /// In s.
    pub time: f64,
    /// The followed states.
    pub state: Vec<f64>,
    /// Their derivatives by the unknowns, a row a state; empty at order zero.
    pub slopes: DMatrix<f64>,
    /// The outputs.
    pub outputs: Vec<f64>,
    /// Their derivatives, a row an output.
    pub output_slopes: DMatrix<f64>,
    /// Their second derivatives, a matrix an output; none below order two.
    pub output_bends: Vec<DMatrix<f64>>,
}

/// A model with its signals, ready to be integrated.
#[derive(Clone, Copy, Debug)]
pub struct ModelFlow<'a> {
    /// The equations.
    pub model: &'a Model,
    /// What they are given beside the followed states.
    pub signals: &'a Signals,
    /// The relative and absolute error of a step.
    pub tolerance: f64,
    /// How the flow goes from one sample to the next.
    pub stride: Stride,
}

/// How long the steps of the integration may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stride {
    /// From each sample to the next, with so small an error that a recording's thousands of them do not add up.
    BySample,
    /// As long as the tolerance allows, samples between being interpolated: for searches, which compare what is far from the truth.
    ByTolerance,
}

/// The equations are evaluated no more often than this between two samples (one step takes thirteen times): a system that needs
/// more has met a singularity, or has samples that are too far apart.
const MOST_EVALUATIONS: usize = 3000;

/// A step that is not refined has this part of the tolerated error, so that a thousand of them err by no more than one that is refined.
const CAREFUL: f64 = 1e-3;

/// The unknowns that one call can carry.
pub const MOST_UNKNOWNS: usize = 32;

/// The unknowns whose second derivatives one call can carry: they are many.
pub const MOST_BENT: usize = 10;

/// What the samples of one window may take, in bytes: an estimate needs up to four times as much.
const MOST_BYTES: usize = 512 << 20;

/// What a sample takes beside its numbers, in bytes: five tables and their places in memory.
const AROUND: usize = 300;

/// What so many samples take, in bytes, with the derivatives of so many states and outputs by `p` unknowns.
fn bytes_of(samples: usize, [states, outputs]: [usize; 2], p: usize, order: Order) -> usize {
    let numbers = match order {
        Order::Value => states + outputs,
        Order::First => (states + outputs) * (1 + p),
        Order::Second => states * (1 + p) + outputs * (1 + p + p * p),
    };
    samples.saturating_mul(8 * numbers + AROUND)
}

impl ModelFlow<'_> {
    /// That so many samples with the derivatives by `p` unknowns can be kept at once.
    ///
    /// # Errors
    /// They would take too much memory; what to do about it.
    pub fn affordable(&self, samples: &[f64], p: usize, order: Order) -> Result<(), Lost> {
        let sizes = [self.model.states.len(), self.model.outputs.len()];
        let bytes = bytes_of(samples.len(), sizes, p, order);
        if bytes <= MOST_BYTES {
            return Ok(());
        }
        let count = samples.len();
        Err(Lost {
            time: samples.first().copied().unwrap_or(0.0),
            why: format!(
                "{count} samples with derivatives by {p} unknowns would take {} MiB, more than {}: take a smaller window, or a filter",
                bytes >> 20,
                MOST_BYTES >> 20
            ),
        })
    }

    /// The model at some times, from a state at the first of them; `free` are the places of the states whose first values
    /// are unknown, in the order of the derivatives.
    ///
    /// # Errors
    /// Where the equations have no value, the integrator finds no step, or more than [`MOST_UNKNOWNS`] are unknown, or
    /// [`MOST_BENT`] at order two; where the samples would take too much memory.
    pub fn follow(
        &self,
        start: &[f64],
        free: &[usize],
        times: &[f64],
        order: Order,
    ) -> Result<Vec<Sample>, Lost> {
        let p = free.len();
        self.affordable(times, p, order)?;
        // few sizes for all, since each is compiled: what is too large is filled with zeros
        macro_rules! sized {
            ($($size:literal)*; $($bent:literal)*) => {
                match order {
                    Order::Value => self.integrate::<f64>(start, free, times, 0),
                    $(Order::First if p <= $size => self.integrate::<DualSVec64<$size>>(start, free, times, $size),)*
                    $(Order::Second if p <= $bent => self.integrate::<Dual2SVec64<$bent>>(start, free, times, $bent),)*
                    Order::First => Err(Lost { time: times[0], why: format!("{p} unknowns are more than {MOST_UNKNOWNS}") }),
                    Order::Second => Err(Lost { time: times[0], why: format!("{p} unknowns are more than {MOST_BENT}") }),
                }
            };
        }
        sized!(3 4 6 10 16 32; 3 4 6 10)
    }

    fn integrate<J: Jet>(
        &self,
        start: &[f64],
        free: &[usize],
        times: &[f64],
        size: usize,
    ) -> Result<Vec<Sample>, Lost> {
        let model = self.model;
        let refuse =
            |time: f64, refusal: Refusal| Lost { time, why: format!("the model has no value: {refusal}") };
        let arithmetic = Duals::<J>::default;
        let rates = model.rates.program.load(arithmetic()).map_err(|refusal| refuse(times[0], refusal))?;
        let seen =
            model.output_formulas.program.load(arithmetic()).map_err(|refusal| refuse(times[0], refusal))?;
        let (registers, room) = (RefCell::new(Vec::new()), RefCell::new((Vec::new(), Vec::new())));
        type LoadedFormulas<'l, J> = palmistry_math::expression::Loaded<'l, Duals<J>>;
        let input = |source: &InputSource, y: &[f64], given: &[f64]| match *source {
            InputSource::State(place) => J::unpack(&y[place * J::LENGTH..(place + 1) * J::LENGTH]),
            InputSource::Column(place) | InputSource::Rate(place) => J::constant(given[place]),
        };
        let seen_at = |time: f64, y: &[f64]| {
            let mut given = vec![0.0; model.columns.len()];
            self.signals.at(&model.columns, time, &mut given);
            let inputs: Vec<J> =
                model.output_formulas.sources.iter().map(|source| input(source, y, &given)).collect();
            seen.run(&inputs, &mut registers.borrow_mut())
        };
        let evaluate_at = |formulas: &Formulas, loaded: &LoadedFormulas<'_, J>, time: J, states: &[J]| {
            let given = self.signals.along(&model.columns, time);
            let input = |source: &InputSource| match *source {
                InputSource::State(place) => states[place],
                InputSource::Column(place) | InputSource::Rate(place) => given[place],
            };
            let inputs: Vec<J> = formulas.sources.iter().map(input).collect();
            loaded.run(&inputs, &mut registers.borrow_mut())
        };
        // what is expected of the outputs at a sample: of those that are late what they were before
        let expected = |time: f64, y: &[f64]| -> Result<Vec<J>, Lost> {
            let mut values = seen_at(time, y).map_err(|error| refuse(time, error.refusal))?;
            if model.delays.iter().all(Option::is_none) {
                return Ok(values);
            }
            let states: Vec<J> = y.chunks(J::LENGTH).map(J::unpack).collect();
            let followed = |time: J, states: &[J]| {
                evaluate_at(&model.rates, &rates, time, states).map_err(|error| error.refusal)
            };
            for (output, delay) in model.delays.iter().enumerate() {
                let Some(delay) = delay.map(|place| states[place]) else { continue };
                let before = states_before(&followed, time, &states, delay, self.signals.between())
                    .map_err(|why| Lost { time, why })?;
                let then = evaluate_at(&model.output_formulas, &seen, J::constant(time) - delay, &before);
                values[output] = then.map_err(|error| refuse(time, error.refusal))?[output];
            }
            Ok(values)
        };
        let failure: Cell<Option<(f64, Refusal)>> = Cell::new(None);
        // what is held jumps at a sample, and has its old value up to there
        let until = Cell::new(f64::INFINITY);
        // the equations of motion are evaluated most: in the same room each time
        let right_hand_side = |time: f64, y: &[f64], dy: &mut [f64]| {
            let (given, inputs) = &mut *room.borrow_mut();
            given.resize(model.columns.len(), 0.0);
            if !given.is_empty() {
                self.signals.at(&model.columns, time.min(until.get()), given);
            }
            inputs.clear();
            inputs.extend(model.rates.sources.iter().map(|source| input(source, y, given)));
            match rates.run_in(inputs, &mut registers.borrow_mut()) {
                Ok(values) => {
                    for (value, places) in values.zip(dy.chunks_mut(J::LENGTH)) {
                        value.pack(places);
                    }
                }
                Err(error) => {
                    failure.set(Some((time, error.refusal)));
                    dy.fill(f64::NAN);
                }
            }
        };

        let mut y = vec![0.0; start.len() * J::LENGTH];
        for (place, value) in start.iter().enumerate() {
            y[place * J::LENGTH] = *value;
        }
        if size > 0 {
            for (unknown, place) in free.iter().enumerate() {
                y[place * J::LENGTH + 1 + unknown] = 1.0;
            }
        }
        let mut samples = Vec::with_capacity(times.len());
        let mut quick = QuickSteps::default();
        if self.stride == Stride::ByTolerance {
            let mut states = vec![y.clone()];
            let most = MOST_EVALUATIONS.saturating_mul(times.len());
            let tell = |_: usize, y: &[f64]| states.push(y.to_vec());
            let towards = |time: f64| until.set(if self.signals.jump() { time.next_down() } else { time });
            let stops: Option<&dyn Fn(f64)> = if self.signals.is_smooth() { None } else { Some(&towards) };
            let effort = (self.tolerance, most);
            let way = quick.go_through(&right_hand_side, times, &mut y.clone(), effort, stops, tell);
            until.set(f64::INFINITY);
            way.map_err(|(time, stopped)| match (failure.get(), stopped) {
                (Some((time, refusal)), _) => refuse(time, refusal),
                (None, Stopped::Spent) => Lost { time, why: spent() },
                (None, Stopped::TooShort) => Lost { time, why: TOO_SHORT.to_owned() },
            })?;
            for (time, y) in times.iter().zip(states) {
                let values = expected(*time, &y)?;
                samples.push(sample(*time, start.len(), free.len(), size, &y, &values));
            }
            return Ok(samples);
        }
        for (i, time) in times.iter().enumerate() {
            if i > 0 {
                failure.set(None);
                if self.signals.jump() {
                    until.set(time.next_down());
                    quick.begin_anew();
                }
                if quick.take(&right_hand_side, times[i - 1], *time, &mut y, CAREFUL * self.tolerance) {
                    let values = expected(*time, &y)?;
                    samples.push(sample(*time, start.len(), free.len(), size, &y, &values));
                    continue;
                }
                failure.set(None);
                quick.begin_anew();
                y = advance(&right_hand_side, times[i - 1], *time, &y, self.tolerance).map_err(|lost| {
                    match failure.get() {
                        Some((time, refusal)) => refuse(time, refusal),
                        None => lost,
                    }
                })?;
            }
            let values = expected(*time, &y)?;
            samples.push(sample(*time, start.len(), free.len(), size, &y, &values));
        }
        Ok(samples)
    }
}

/// What the integrator stored, as matrices; `size` is the stored number of unknowns, not less than `p`.
fn sample<J: Jet>(time: f64, states: usize, p: usize, size: usize, y: &[f64], outputs: &[J]) -> Sample {
    let mut seen = vec![0.0; outputs.len() * J::LENGTH];
    for (output, places) in outputs.iter().zip(seen.chunks_mut(J::LENGTH)) {
        output.pack(places);
    }
    let p = if size == 0 { 0 } else { p };
    let values = |rows: &[f64]| rows.iter().step_by(J::LENGTH).copied().collect();
    let slopes = |rows: &[f64], n: usize| DMatrix::from_fn(n, p, |i, j| rows[i * J::LENGTH + 1 + j]);
    let bend = |row: &[f64]| DMatrix::from_fn(p, p, |i, j| row[1 + size + triangle(i.max(j), i.min(j))]);
    let second = J::LENGTH > 1 + size;
    Sample {
        time,
        state: values(y),
        slopes: slopes(y, states),
        outputs: values(&seen),
        output_slopes: slopes(&seen, outputs.len()),
        output_bends: if second { seen.chunks(J::LENGTH).map(bend).collect() } else { Vec::new() },
    }
}

/// `f(t, y)`, written into the last argument.
pub(crate) type RightHandSide<'f> = dyn Fn(f64, &[f64], &mut [f64]) + 'f;

/// Equations with time as their last coordinate.
///
/// Dop853 of ode_solvers 0.6.2 takes zero for the twelfth node of the method, which is one: right-hand sides that depend on the
/// time it hands over are integrated wrongly. A coordinate whose rate is one brings the right time.
struct Equations<'f> {
    f: &'f RightHandSide<'f>,
    evaluations: &'f Cell<usize>,
}

impl System<f64, DVector<f64>> for Equations<'_> {
    fn system(&self, _: f64, y: &DVector<f64>, dy: &mut DVector<f64>) {
        let ([y @ .., time], [dy @ .., time_rate]) = (y.as_slice(), dy.as_mut_slice()) else { return };
        *time_rate = 1.0;
        self.evaluations.set(self.evaluations.get() + 1);
        if self.evaluations.get() > MOST_EVALUATIONS {
            // no step is accepted from here on
            return dy.fill(f64::NAN);
        }
        (self.f)(*time, y, dy);
    }
}

/// Why an integration stops at a pole.
const TOO_SHORT: &str = "no step is small enough, as near a singularity or a jump";

/// Why an integration stops that is too long.
fn spent() -> String {
    format!(
        "the equations were evaluated {MOST_EVALUATIONS} times since the sample before, and no more is done: the next sample is too far away, or a singularity is near"
    )
}

/// Integrates `y' = f(t, y)` from one time to a later one.
///
/// # Errors
/// Where no step is small enough, as near a pole; where more evaluations are needed than are made between two samples.
pub fn advance(
    f: &RightHandSide<'_>,
    from: f64,
    to: f64,
    y: &[f64],
    tolerance: f64,
) -> Result<Vec<f64>, Lost> {
    let start = DVector::from_iterator(y.len() + 1, y.iter().copied().chain([from]));
    let evaluations = Cell::new(0);
    let equations = Equations { f, evaluations: &evaluations };
    let mut solver = Dop853::new(equations, 0.0, to - from, to - from, start, tolerance, tolerance);
    solver.set_output(OutputType::Sparse);
    let lost = |after: f64, why: &str| Lost { time: from + after, why: why.to_owned() };
    solver.integrate().map_err(|error| match error {
        // the steps shrink since nothing is evaluated any more: that is no property of the equations
        IntegrationError::StepSizeUnderflow { x } | IntegrationError::MaxNumStepReached { x, .. }
            if evaluations.get() > MOST_EVALUATIONS =>
        {
            lost(x, &spent())
        }
        IntegrationError::StepSizeUnderflow { x } => lost(x, TOO_SHORT),
        IntegrationError::MaxNumStepReached { x, .. } => lost(x, "there are too many steps"),
        IntegrationError::StiffnessDetected { x } => lost(x, "the equations become stiff"),
    })?;
    let end = solver.y_out().last().filter(|end| end.iter().all(|value| value.is_finite()));
    end.map(|end| end.as_slice()[..y.len()].to_vec()).ok_or_else(|| lost(0.0, "a number is not finite"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A window of 10,000 samples of 30 unknown states and 15 outputs was measured to take 120 MB; ten times as many are refused, and a
    /// million of an oscillator are not.
    #[test]
    fn a_window_takes_what_its_derivatives_take() {
        let measured = bytes_of(10_000, [30, 15], 30, Order::First);
        assert!((100_000_000..130_000_000).contains(&measured), "{measured}");
        assert!(measured * 10 > MOST_BYTES);
        assert!(bytes_of(1_000_000, [2, 1], 2, Order::First) < MOST_BYTES);
        assert!(bytes_of(1_000_000, [30, 15], 30, Order::Value) < 2 * MOST_BYTES);
        assert!(bytes_of(10_000, [10, 5], 10, Order::Second) > bytes_of(10_000, [10, 5], 10, Order::First));
        assert_eq!(bytes_of(usize::MAX, [1, 1], 1, Order::Value), usize::MAX);
    }
}
