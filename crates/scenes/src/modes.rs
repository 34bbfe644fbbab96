//! Several models side by side: which of them explains the measurements of each window.
//!
//! A body with friction obeys one system while both contacts slide, another while one rolls, and the times of the changes are unknown. Each
//! system of the scene, its own and `[[observer.modes]]`, is estimated on each window by itself; of those whose residual passes the chi-square
//! test the one with the least is taken, and where none passes that is said: the window has a change of modes in it, or no model is right. What was
//! learned in the last window that fits, whatever its mode, is where the next begins.

use super::groundwork::{Groundwork, Steady, sample_range};
use super::run::Experiment;
use super::scene::{Guess, SceneError};
use super::simulation::Simulation;
use palmistry_bodies::mechanics::moving::Ended;
use palmistry_lang::UnknownKind;
use palmistry_observe::{MotionRankFound, NoiseFrom, Objection, ReadRecord, Signals, Update};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

/// A search has this many starts, unless an earlier one fits.
const STARTS: usize = 4;

const BASES: [usize; 9] = [2, 3, 5, 7, 11, 13, 17, 19, 23];

/// The numbers of J. H. Halton (1960) in a base, in [0, 1).
fn halton(mut number: usize, base: usize) -> f64 {
    let (mut part, mut sum) = (1.0, 0.0);
    while number > 0 {
        part /= base as f64;
        sum += part * (number % base) as f64;
        number /= base;
    }
    sum
}

/// The estimate of a window by one mode.
#[derive(Clone, Debug)]
pub struct ModeEstimate {
    /// The mode.
    pub name: String,
    /// The estimated states, in the order of the update's estimate.
    pub estimated: Vec<String>,
    /// The search: none where it was not run.
    pub update: Option<Update>,
    /// The rank along its motion through the window, where it decides who may answer: of the motion that was found, where the measurements bear one
    /// out, and else of the predicted one.
    pub rank: Option<MotionRankFound>,
    /// Why the rank objects to its answer.
    pub objection: Option<Objection>,
}

impl ModeEstimate {
    /// Whether the measurements bear it out.
    pub fn fits(&self) -> bool {
        self.update.as_ref().is_some_and(Update::is_borne_out)
    }

    /// The error that modes are compared by: chi-square per degree of freedom where the noise is stated, else the residual in the outputs' unit.
    fn error(&self) -> f64 {
        let of = |update: &Update| match update.fit {
            Some(fit) if fit.from == NoiseFrom::Stated => fit.chi_square / fit.degrees.max(1) as f64,
            _ => update.rms_residual,
        };
        self.update.as_ref().map_or(f64::INFINITY, of)
    }
}

/// The estimates of one window by all modes.
#[derive(Clone, Debug)]
pub struct ModeWindow {
    /// The time of its first sample, in s.
    pub from: f64,
    /// The time of its last sample, in s.
    pub to: f64,
    /// Each mode, the scene's own first.
    pub estimates: Vec<ModeEstimate>,
    /// The one with the least error of those that fit; where the rank decides, the first of those that may answer and fit.
    pub chosen: Option<usize>,
    /// The contact modes, where a body was simulated with friction: more than one where they changed.
    pub true_modes: Vec<String>,
}

impl Experiment {
    /// The scene's modes on the same measurements, the scene's own first.
    ///
    /// # Errors
    /// What is wrong with a mode's model, with the place in the scene.
    pub(super) fn modes(&self) -> Result<Vec<(String, Experiment)>, SceneError> {
        let mut all = vec![(self.scene.observer.mode.clone(), self.clone())];
        for mode in &self.scene.observer.modes {
            let mut scene = self.scene.clone();
            scene.model.clone_from(&mode.model);
            let settings = &mut scene.observer;
            settings.estimate.clone_from(&mode.estimate);
            settings.known.clone_from(&mode.known);
            settings.bounds.clone_from(&mode.bounds);
            settings.inputs.clone_from(&mode.inputs);
            settings.guess = Guess::Sample;
            settings.clamp.clear();
            let ground = Groundwork::of(scene, false)?;
            let reading = ReadRecord::whole(self.record.clone());
            let mut experiment = Experiment::with_measurements(ground, reading, None, Steady::AreConstants)?;
            experiment.scene.observer.guess = Guess::Values(mode.guess.clone());
            all.push((mode.name.clone(), experiment));
        }
        Ok(all)
    }

    /// The estimates of all modes of the scene, window by window; `done` is called after each window.
    ///
    /// # Errors
    /// As [`Experiment::task`], of any mode.
    pub fn run_modes(&self, interrupt: &AtomicBool, done: &dyn Fn()) -> Result<Vec<ModeWindow>, SceneError> {
        let modes = self.modes()?;
        let times = self.signals.times();
        self.has_windows()?;
        let window = self.steps_of_windows();
        let mut learned: BTreeMap<String, f64> = BTreeMap::new();
        // the state at the end of the window of each mode that fitted
        let mut reached: Vec<Option<Vec<f64>>> = vec![None; modes.len()];
        let mut windows = Vec::new();
        for first in (0..times.len() - window).step_by(window) {
            let one = |(place, (name, mode)): (usize, &(String, Experiment))| {
                let own = mode.window_of(first, window)?;
                let estimated = own.names().into_iter().map(str::to_owned).collect();
                let (update, came_to) =
                    own.search(mode.starts(&learned, reached[place].clone()), interrupt)?;
                let name = name.clone();
                Ok((ModeEstimate { name, estimated, update, rank: None, objection: None }, came_to))
            };
            // each mode by itself: no mode uses another one's estimate in the same window
            let found: Vec<Result<_, SceneError>> = modes.par_iter().enumerate().map(one).collect();
            // of several faults the first mode's, on any number of threads
            let found: Vec<_> = found.into_iter().collect::<Result<_, _>>()?;
            let (estimates, came_to): (Vec<ModeEstimate>, Vec<Option<Vec<f64>>>) = found.into_iter().unzip();
            reached = came_to;
            let fitting = (0..estimates.len()).filter(|place| estimates[*place].fits());
            let chosen = fitting.min_by(|a, b| estimates[*a].error().total_cmp(&estimates[*b].error()));
            for (place, came_to) in reached.iter_mut().enumerate() {
                // one that fits worse than another is no initial state
                came_to.take_if(|_| Some(place) != chosen);
            }
            if let Some(chosen) = chosen
                && let Some(state) = &reached[chosen]
            {
                for (name, value) in estimates[chosen].estimated.iter().zip(state) {
                    learned.insert(name.clone(), *value);
                }
            }
            let (from, to) = (times[first], times[first + window]);
            windows.push(ModeWindow { from, to, estimates, chosen, true_modes: self.true_modes(from, to) });
            done();
            if interrupt.load(Ordering::Relaxed) {
                break;
            }
        }
        Ok(windows)
    }

    /// Whether there is a window at all.
    ///
    /// # Errors
    /// That there is none.
    pub(super) fn has_windows(&self) -> Result<(), SceneError> {
        match self.signals.times().len() {
            samples @ 0..2 => {
                let ended = self.simulation.as_ref().map(Simulation::ended);
                let early = ended.filter(|ended| !matches!(ended, Ended::Completed));
                let early =
                    early.map_or_else(String::new, |ended| format!("the motion ended early, {ended}: "));
                let message = format!("{early}of {samples} samples there is no window");
                let help = "a window has two samples or more, and enough for each unknown to be determined";
                Err(self.scene.error_at("observer.window", message, "such windows", help))
            }
            _ => Ok(()),
        }
    }

    /// How many steps from sample to sample a window has.
    pub(super) fn steps_of_windows(&self) -> usize {
        self.scene.observer.window.min(self.signals.times().len().saturating_sub(1))
    }

    /// How many samples at the end are in no window, since a whole one does not fit there.
    pub fn samples_after_windows(&self) -> usize {
        self.signals.times().len().saturating_sub(1).checked_rem(self.steps_of_windows()).unwrap_or(0)
    }

    /// The experiment of one window.
    pub(super) fn window_of(&self, first: usize, window: usize) -> Result<Experiment, SceneError> {
        let mut own = self.clone();
        let rows = first..=first + window;
        let times = self.signals.times()[rows.clone()].to_vec();
        let columns = self.signals.names().iter().enumerate();
        let columns =
            columns.map(|(place, name)| (name.clone(), self.signals.column(place)[rows.clone()].to_vec()));
        let signals = Signals::sparse(times, columns.collect());
        own.signals = signals
            .map(|signals| signals.interpolated(self.signals.interpolation()))
            .map_err(|error| self.scene.error_at("observer.window", error.to_string(), "such windows", ""))?;
        own.scene.observer.window = window;
        Ok(own)
    }

    /// Where the search of a window begins, one after the other until one fits: with what is known from the last window, and at states of the
    /// sample box (Halton's), constants as far as they were learned.
    pub(super) fn starts(&self, learned: &BTreeMap<String, f64>, reached: Option<Vec<f64>>) -> Vec<Vec<f64>> {
        let settings = &self.scene.observer;
        let guess = match &settings.guess {
            Guess::Values(values) => values.clone(),
            _ => BTreeMap::new(),
        };
        let start = |number: usize| -> Vec<f64> {
            let value = |(place, (name, given)): (usize, &(String, f64))| {
                let part = if number == 0 { 0.5 } else { halton(number, BASES[place % BASES.len()]) };
                let drawn = sample_range(&self.system, name).map(|[low, high]| low + part * (high - low));
                let guessed = guess.get(name).filter(|_| number == 0).copied();
                // a state that moves is drawn anew from the second start on
                let told = learned.get(name).filter(|_| number == 0 || self.is_constant(name)).copied();
                let value = told.or(guessed).or(drawn).unwrap_or(*given);
                let [low, high] =
                    settings.bounds.get(name).copied().unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
                value.clamp(low, high)
            };
            self.question.guess.iter().enumerate().map(value).collect()
        };
        reached.into_iter().chain((0..STARTS).map(start)).collect()
    }

    fn is_constant(&self, name: &str) -> bool {
        let kind = self.system.find_symbol(name).and_then(|symbol| self.system.unknown_kind(symbol));
        kind == Some(UnknownKind::Parameter)
    }

    /// The estimate of a window by one mode, and its state at the end.
    pub(super) fn search(
        &self,
        starts: Vec<Vec<f64>>,
        interrupt: &AtomicBool,
    ) -> Result<(Option<Update>, Option<Vec<f64>>), SceneError> {
        let mut own = self.clone();
        own.scene.observer.guess = Guess::Sample;
        let mut best: Option<Update> = None;
        for start in starts {
            for ((_, value), from) in own.question.guess.iter_mut().zip(start) {
                *value = from;
            }
            // these are the starts of a window
            let mut task = own.task(interrupt)?;
            task.restarts = false;
            let track = own.observer(own.scene.observer.methods[0]).observe(&task);
            let Some(update) = track.updates.first() else { continue };
            if update.is_borne_out() {
                return Ok((Some(update.clone()), track.last().map(|last| last.state.clone())));
            }
            if best
                .as_ref()
                .is_none_or(|best| best.rms_residual.is_nan() || best.rms_residual > update.rms_residual)
            {
                best = Some(update.clone());
            }
            if interrupt.load(Ordering::Relaxed) {
                break;
            }
        }
        Ok((best, None))
    }

    /// The contact modes of a body that was simulated with friction, between two times.
    pub(super) fn true_modes(&self, from: f64, to: f64) -> Vec<String> {
        let Some(simulation) = &self.simulation else { return Vec::new() };
        let all = &simulation.modes;
        let ends = all.iter().skip(1).map(|(time, _)| *time).chain([f64::INFINITY]);
        let during = all.iter().zip(ends).filter(|((begins, _), ends)| *begins < to && *ends > from);
        during.map(|((_, pair), _)| pair.to_string()).collect()
    }
}
