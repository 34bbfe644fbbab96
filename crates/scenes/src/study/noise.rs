//! The error over many draws of noise, at several levels of it.

use super::super::channels::corrected;
use super::super::known_motion::KnownMotion;
use super::super::run::Experiment;
use super::super::scene::{NoiseStudy, SceneError, Sensor};
use super::super::simulation::deviation;
use palmistry_observe::{MovingWindow, Noise, Signals, Task, UpdateEnd, WindowSearch};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// The error over many seeds at one level of noise.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseLevel {
    /// The standard deviation of the measurements, in their unit: in m for contacts.
    pub noise: f64,
    /// The number of estimates that converged.
    pub converged: usize,
    /// The number of those that failed the chi-square test: false alarms.
    pub unfit: usize,
    /// The number of draws of noise.
    pub seeds: usize,
    /// The root mean square error of the estimated states at the first sample, over the seeds that converged.
    pub errors: Vec<f64>,
    /// The Cramér-Rao bound there: at the truth, and for outputs that are states at their first measurement.
    pub bounds: Vec<f64>,
}

/// The result of one draw of noise.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Trial {
    /// There was no estimate, or it did not converge.
    Failed,
    Converged {
        estimate: Vec<f64>,
        fits: bool,
    },
}

impl Trial {
    /// The estimate, if it converged.
    pub fn estimate(&self) -> Option<&Vec<f64>> {
        match self {
            Trial::Converged { estimate, .. } => Some(estimate),
            Trial::Failed => None,
        }
    }
}

/// The draws of a study, one after the other: all of the first level, then those of the next.
pub(super) struct NoiseTrials<'a> {
    experiment: &'a Experiment,
    simulation: &'a dyn KnownMotion,
    study: &'a NoiseStudy,
    task: Task<'a>,
    observer: MovingWindow,
}

impl<'a> NoiseTrials<'a> {
    /// # Errors
    /// As [`Experiment::task`].
    pub fn new(
        experiment: &'a Experiment,
        simulation: &'a dyn KnownMotion,
        study: &'a NoiseStudy,
        interrupt: &'a AtomicBool,
    ) -> Result<NoiseTrials<'a>, SceneError> {
        let task = experiment.task(interrupt)?;
        let observer = MovingWindow {
            steps: 50,
            unobservable_above: f64::INFINITY,
            ..experiment.window(WindowSearch::TrustRegion)
        };
        Ok(NoiseTrials { experiment, simulation, study, task, observer })
    }

    /// The number of trials.
    pub fn count(&self) -> usize {
        self.study.levels.len() * self.study.seeds
    }

    /// The result of one of them, which depends on its place alone.
    pub fn trial(&self, place: usize) -> Trial {
        let estimate = || -> Option<Trial> {
            let noise = *self.study.levels.get(place / self.study.seeds.max(1))?;
            // every level has errors of its own
            let seed = self.experiment.scene.seed.wrapping_add(1 + place as u64);
            let signals = noisy(self.experiment, self.simulation, noise, seed)?;
            let task = at_level(self.experiment, &self.task.with_signals(&signals), noise);
            let rows = first_window(&task, &self.observer);
            let update = self.observer.update(&task, &task.guess, &rows, &task.clamped);
            let fits = update.fit.is_some_and(|fit| fit.fits);
            matches!(update.end, UpdateEnd::Converged | UpdateEnd::DoesNotFit | UpdateEnd::Stuck)
                .then_some(Trial::Converged { estimate: update.estimate, fits })
        };
        estimate().unwrap_or(Trial::Failed)
    }

    /// The results of a level's draws, in their order: nothing where there is no truth.
    pub fn level(&self, level: usize, trials: &[Trial]) -> Option<NoiseLevel> {
        let noise = *self.study.levels.get(level)?;
        let truth = self.experiment.truth_at(*self.task.signals.times().first()?)?;
        let arrived: Vec<&Vec<f64>> = trials.iter().filter_map(Trial::estimate).collect();
        let error = |i: usize| {
            let square: f64 = arrived.iter().map(|estimate| (estimate[i] - truth[i]).powi(2)).sum();
            (square / arrived.len() as f64).sqrt()
        };
        Some(NoiseLevel {
            noise,
            converged: arrived.len(),
            unfit: trials
                .iter()
                .filter(|trial| matches!(trial, Trial::Converged { fits: false, .. }))
                .count(),
            seeds: trials.len(),
            errors: (0..truth.len()).map(error).collect(),
            bounds: bounds(&at_level(self.experiment, &self.task, noise), &self.observer, &truth),
        })
    }

    /// The results of all draws, in their order: a row a level.
    pub fn levels(&self, trials: &[Trial]) -> Vec<NoiseLevel> {
        let each = trials.chunks(self.study.seeds.max(1)).enumerate();
        each.map_while(|(level, trials)| self.level(level, trials)).collect()
    }
}

/// The error of the first window's estimate at the levels of a study, by least squares. Seeds run side by side; the result is the
/// same on any number of threads. `done` is called once a seed.
///
/// # Errors
/// As [`Experiment::task`].
pub fn noise_study(
    experiment: &Experiment,
    simulation: &dyn KnownMotion,
    study: &NoiseStudy,
    interrupt: &AtomicBool,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<NoiseLevel>, SceneError> {
    let all = NoiseTrials::new(experiment, simulation, study, interrupt)?;
    let mut levels = Vec::new();
    for level in 0..study.levels.len() {
        if all.task.interrupted() {
            break;
        }
        let one = |place: usize| -> Option<Trial> {
            if interrupt.load(Ordering::Relaxed) {
                return None;
            }
            let trial = all.trial(place);
            done();
            Some(trial)
        };
        let places = level * study.seeds..(level + 1) * study.seeds;
        // trials that were not started are left out
        let trials: Vec<Option<Trial>> = places.into_par_iter().map(one).collect();
        let trials: Vec<Trial> = trials.into_iter().flatten().collect();
        let Some(found) = all.level(level, &trials) else { break };
        levels.push(found);
    }
    Ok(levels)
}

/// The signals of an experiment with other errors.
fn noisy(experiment: &Experiment, simulation: &dyn KnownMotion, noise: f64, seed: u64) -> Option<Signals> {
    // the levels are those of the outputs that have no noise of their own; all other columns have the errors of the scene
    let sensor = Sensor { noise, ..experiment.scene.sensor };
    let record = simulation.read(&sensor, &experiment.scene.channels, seed).ok()?;
    corrected(Signals::of_record(&record).ok()?, &experiment.scene.observer.known).ok()
}

/// A task whose outputs are measured with errors of one level.
pub(super) fn at_level<'a>(experiment: &Experiment, task: &Task<'a>, noise: f64) -> Task<'a> {
    let mut task = task.clone();
    let rounding = experiment.scene.sensor.resolution;
    if deviation(noise, rounding) == 0.0 && !task.errors.is_empty() {
        // outputs without error, beside columns that have some
        return task;
    }
    (task.exact, task.sigma) = (false, deviation(noise, rounding));
    task.noise = Noise::Stated { normal: noise, rounding };
    let has_own = |name: &str| experiment.scene.channels.get(name).is_some_and(|own| own.noise.is_some());
    let outputs = task.full.outputs.clone();
    for name in outputs.iter().filter(|name| !has_own(name)) {
        if let Some(errors) = task.errors.get_mut(name) {
            errors.normal = noise;
        }
    }
    task
}

pub(super) fn first_window(task: &Task<'_>, observer: &MovingWindow) -> std::ops::Range<usize> {
    0..(observer.window.max(2) + 1).min(task.signals.times().len())
}

/// The Cramér-Rao bound of the estimated states at the first sample, at the truth; outputs that are states start at their measurement, which is wrong where a pole
/// is near.
fn bounds(task: &Task<'_>, observer: &MovingWindow, truth: &[f64]) -> Vec<f64> {
    observer.bounds(task, truth, &first_window(task, observer), &task.clamped)
}
