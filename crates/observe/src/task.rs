//! What every observer is given: signals, models of what made them, and what is known beside them.

use super::fit::Noise;
use super::flow::Stride;
use super::learned::{Arrival, Learned};
use super::loss::Loss;
use super::track::Track;
use super::{
    CalibrationKind, Lost, MeasurementErrors, Model, ModelError, ModelFlow, ModelQuestion, Order, Signals,
};
use palmistry_lang::System;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Signals, models of what made them, and a first guess.
#[derive(Clone, Debug)]
pub struct Task<'a> {
    /// What was measured.
    pub signals: &'a Signals,
    /// The model that follows the estimated states, first, and then the outputs that are states themselves.
    pub full: Arc<Model>,
    /// The model that follows the estimated states alone and takes the outputs from the signals.
    pub reduced: Arc<Model>,
    /// The first guess of the estimated states.
    pub guess: Vec<f64>,
    /// The magnitudes of the estimated states; by custom those of the first guess.
    pub sizes: Vec<f64>,
    /// The states that an observer may not change in its first window, by place among the estimated ones.
    pub clamped: Vec<usize>,
    /// The standard deviation of the measurements of the outputs, in their unit; positive. Where no noise is stated the least that is
    /// believed of any measurement.
    pub sigma: f64,
    /// What is known of the measurements' errors: by it a residual is judged.
    pub noise: Noise,
    /// What is known of the errors of single columns, by name: of an output in the place of `noise`, of a column that drives the model
    /// beside it. A column that is not there drives the model without error.
    pub errors: BTreeMap<String, MeasurementErrors>,
    /// What the rounding of the samples' times may add to a measurement, in the outputs' unit.
    pub timing: f64,
    /// Whether the measurements are taken as they are for the first values of the outputs, because they have no error.
    pub exact: bool,
    /// Whether a window begins with what the ones before it have learned.
    pub inherit: bool,
    /// For each estimated state the range in which it is known to lie.
    pub bounds: Vec<[f64; 2]>,
    /// How residuals are weighed.
    pub loss: Loss,
    /// Whether all samples are one window, however many a window has otherwise: it grows from that many to all.
    pub whole: bool,
    /// The probability of a false alarm of each update; where none is given it is such that all of a run have [`super::FALSE_ALARMS`].
    pub alarm: Option<f64>,
    /// What was learned from earlier samples of a recording of which these are the next: its last sample is the first here.
    pub learned: Option<Arc<Learned>>,
    /// What is known of the state at the first sample of a window from those before it.
    pub(super) arrival: Option<Arc<Arrival>>,
    /// Whether a first window whose search comes to nothing is searched again from other states: within the bounds, or else the ranges of the file.
    pub restarts: bool,
    /// The tolerance of the integration.
    pub tolerance: f64,
    /// How it goes from one sample to the next.
    pub(super) stride: Stride,
    /// Set from outside to stop: what is done by then is given back.
    pub interrupt: &'a AtomicBool,
    /// What the models were made from, for those who ask what else they could have been.
    pub source: Arc<(System, EstimateQuestion)>,
}

/// Which states are to be estimated, and what is known beside the signals.
#[derive(Clone, Debug, Default)]
pub struct EstimateQuestion {
    /// The states that are estimated, and the first guess of each.
    pub guess: Vec<(String, f64)>,
    /// Those that are not changed in the first window.
    pub clamped: Vec<String>,
    /// Constants that are known.
    pub known: BTreeMap<String, f64>,
    /// Input fields and the symbols that drive them.
    pub inputs: Vec<(String, String)>,
}

/// The tolerance of a search that is far from its end, relative to one, or to the smallest size of an estimated state where that is less.
const ROUGH: f64 = 1e-8;

/// The default of [`Task::tolerance`].
pub const TOLERANCE: f64 = 1e-11;

impl<'a> Task<'a> {
    /// The task of estimating some states of a system from signals.
    ///
    /// # Errors
    /// [`ModelError`].
    pub fn new(
        system: &System,
        wanted: &EstimateQuestion,
        signals: &'a Signals,
        interrupt: &'a AtomicBool,
    ) -> Result<Task<'a>, ModelError> {
        let names: Vec<String> = wanted.guess.iter().map(|(name, _)| name.clone()).collect();
        let is_state = |name: &str| system.states.iter().any(|state| system.symbol_name(*state) == name);
        let outputs = system.outputs.iter().map(|(name, _)| name).filter(|name| is_state(name));
        let question = |followed: Vec<String>| ModelQuestion {
            followed,
            known: wanted.known.clone(),
            inputs: wanted.inputs.clone(),
        };
        let reduced = Model::new(system, &question(names.clone()), signals)?;
        // an output is followed where its rate depends on the estimated states: the others say nothing
        let mut followed = names.clone();
        for name in outputs {
            if !names.contains(name) && signals.find(name).is_some() && !wanted.known.contains_key(name) {
                let alone = Model::new(
                    system,
                    &question([&names[..], std::slice::from_ref(name)].concat()),
                    signals,
                )?;
                let depends = alone.system.graph.symbols_of([alone.rate_nodes[names.len()]]);
                if alone.symbols[..names.len()].iter().any(|symbol| depends.contains(symbol)) {
                    followed.push(name.clone());
                }
            }
        }
        let full = Model::new(system, &question(followed), signals)?;
        if full.outputs.is_empty() {
            return Err(ModelError::Unobservable);
        }
        let no_output = |name: &&String| match CalibrationKind::of(name) {
            Some((column, CalibrationKind::Delay)) => !full.outputs.iter().any(|output| output == column),
            _ => false,
        };
        if let Some((column, _)) = names.iter().find(no_output).and_then(|name| CalibrationKind::of(name)) {
            return Err(ModelError::DelayOfInput { column: column.to_owned() });
        }
        let guess: Vec<f64> = wanted.guess.iter().map(|(_, value)| *value).collect();
        let largest = guess.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        let size = |(name, value): &(String, f64)| match CalibrationKind::of(name) {
            // a delay is compared with the time between two samples
            Some((_, CalibrationKind::Delay)) => signals.between(),
            // a bias is compared with the measurements
            Some((column, CalibrationKind::Bias)) => {
                let read = signals.find(column).map_or(&[][..], |place| signals.column(place));
                let most = read.iter().fold(0.0f64, |most, value| most.max(value.abs()));
                if most > 0.0 { most } else { 1.0 }
            }
            _ if *value != 0.0 => value.abs(),
            _ if largest > 0.0 => largest,
            _ => 1.0,
        };
        Ok(Task {
            signals,
            full: Arc::new(full),
            reduced: Arc::new(reduced),
            sizes: wanted.guess.iter().map(size).collect(),
            clamped: (0..names.len()).filter(|i| wanted.clamped.contains(&names[*i])).collect(),
            guess,
            sigma: 1e-9,
            noise: Noise::Unstated,
            errors: BTreeMap::new(),
            timing: 0.0,
            exact: true,
            inherit: true,
            bounds: vec![[f64::NEG_INFINITY, f64::INFINITY]; names.len()],
            loss: Loss::Squares,
            whole: false,
            alarm: None,
            learned: None,
            arrival: None,
            restarts: false,
            tolerance: TOLERANCE,
            stride: Stride::BySample,
            interrupt,
            source: Arc::new((system.clone(), wanted.clone())),
        })
    }

    /// The same task with other measurements: the columns are those of the signals that it was made for, in their order.
    pub fn with_signals<'b>(&self, signals: &'b Signals) -> Task<'b>
    where
        'a: 'b,
    {
        Task { signals, ..self.clone() }
    }

    /// The errors of an output without errors of its own.
    pub(super) fn common_errors(&self) -> MeasurementErrors {
        match self.noise {
            Noise::Stated { normal, rounding } => MeasurementErrors { normal, rounding },
            Noise::Unstated => MeasurementErrors { normal: self.sigma, rounding: 0.0 },
        }
    }

    /// How many states are estimated.
    pub fn estimated(&self) -> usize {
        self.guess.len()
    }

    /// Whether someone asked to stop.
    pub fn interrupted(&self) -> bool {
        self.interrupt.load(Ordering::Relaxed)
    }

    /// The same, for a search that is still far from its end: less exact, in longer steps.
    pub(super) fn roughly(&self) -> Task<'a> {
        let tolerance = (ROUGH * self.sizes.iter().copied().fold(1.0, f64::min)).max(self.tolerance);
        Task { tolerance, stride: Stride::ByTolerance, ..self.clone() }
    }

    pub(super) fn full_flow(&self) -> ModelFlow<'_> {
        ModelFlow { model: &self.full, signals: self.signals, tolerance: self.tolerance, stride: self.stride }
    }

    /// The full state at a sample: the estimated states as believed, the outputs as measured there.
    pub fn full_state(&self, sought: &[f64], row: usize) -> Vec<f64> {
        let read = |place: usize| self.full.column_of(place).map_or(0.0, |c| self.signals.column(c)[row]);
        (0..self.full.states.len()).map(|i| if i < sought.len() { sought[i] } else { read(i) }).collect()
    }

    /// A full state whose estimated part is moved within the bounds.
    pub(super) fn within_bounds(&self, mut state: Vec<f64>) -> Vec<f64> {
        for (value, [low, high]) in state.iter_mut().zip(&self.bounds) {
            *value = value.max(*low).min(*high);
        }
        state
    }

    /// The estimated states that lie at a bound, by place, and the bound.
    pub(super) fn at_bounds(&self, sought: &[f64]) -> Vec<(usize, f64)> {
        let at = |(place, (value, bounds)): (usize, (&f64, &[f64; 2]))| {
            bounds.iter().find(|bound| *bound == value).map(|bound| (place, *bound))
        };
        sought.iter().zip(&self.bounds).enumerate().filter_map(at).collect()
    }

    /// The standard deviations that a filter begins with: of an estimated state a part of its size, none of what is clamped, and of outputs that
    /// are states the measurements' own.
    pub(super) fn prior_deviations(&self, part: f64, sigma: f64) -> Vec<f64> {
        let deviation = |place: usize| match self.sizes.get(place) {
            Some(_) if self.clamped.contains(&place) => 0.0,
            Some(size) => part * size,
            None => sigma,
        };
        (0..self.full.states.len()).map(deviation).collect()
    }

    /// What is believed of the errors of an output: one that is zero has none of its own, but those of the measurements in it.
    pub(super) fn output_errors(&self, output: usize) -> MeasurementErrors {
        if self.full.is_implicit(output) {
            return MeasurementErrors::default();
        }
        self.errors.get(&self.full.outputs[output]).copied().unwrap_or_else(|| self.common_errors())
    }

    /// Why a method that allows errors of measurements only refuses: some outputs are implicit.
    pub(super) fn refuses_implicit(&self) -> Option<String> {
        let names = self.full.outputs.iter().enumerate().filter(|(place, _)| self.full.is_implicit(*place));
        let names: Vec<&str> = names.map(|(_, name)| name.as_str()).collect();
        (!names.is_empty()).then(|| {
            format!(
                "it compares outputs with measurements, and {} is not measured: use a moving-horizon method",
                names.join(", ")
            )
        })
    }

    /// Why a method that needs the curves of all outputs refuses: some were not measured at each sample.
    pub(super) fn refuses_sparse(&self) -> Option<String> {
        let is_sparse =
            |name: &&String| self.signals.find(name).is_some_and(|place| !self.signals.is_whole(place));
        let names: Vec<&str> = self.full.outputs.iter().filter(is_sparse).map(String::as_str).collect();
        (!names.is_empty()).then(|| {
            format!(
                "it needs all outputs in each sample, and {} was not measured in some: use another method",
                names.join(", ")
            )
        })
    }

    /// The measurements of the outputs at a sample; zero of implicit outputs, NaN of those that were not measured then.
    pub(super) fn measurements(&self, row: usize) -> Vec<f64> {
        let read = |column: &Option<usize>| column.map_or(0.0, |column| self.signals.column(column)[row]);
        self.full.measured.iter().map(read).collect()
    }

    /// The estimated states, from one sample to a later one by the equations alone, with the outputs as measured.
    ///
    /// # Errors
    /// Where the equations have no value.
    pub fn integrate(&self, sought: &[f64], rows: std::ops::Range<usize>) -> Result<Vec<Vec<f64>>, Lost> {
        let flow = ModelFlow {
            model: &self.reduced,
            signals: self.signals,
            tolerance: self.tolerance,
            stride: Stride::BySample,
        };
        let samples = flow.follow(sought, &[], &self.signals.times()[rows], Order::Value)?;
        Ok(samples.into_iter().map(|sample| sample.state).collect())
    }
}

/// A way to estimate states from what is measured.
pub trait Observer: Sync {
    /// Works through the signals of a task. Whatever goes wrong on the way is part of the answer.
    fn observe(&self, task: &Task<'_>) -> Track;
}
