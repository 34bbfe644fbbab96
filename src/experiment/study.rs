//! An experiment many times over: with other errors of the readings, and from other first guesses.

use super::channels::corrected;
use super::known_motion::KnownMotion;
use super::run::{Experiment, error};
use super::scene::{self, BasinStudy, NoiseStudy, SceneError, Sensor};
use super::simulation::deviation;
use crate::observer::{MovingWindow, Noise, Signals, Task, UpdateEnd, WindowSearch};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// The error over many seeds at one level of noise.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseLevel {
    /// The standard deviation of the readings, in their unit: in m of contacts.
    pub noise: f64,
    /// Estimates that converged, of how many seeds.
    pub converged: usize,
    /// Those of them of which it was said that they do not fit: false alarms.
    pub unfit: usize,
    /// How many draws of noise.
    pub seeds: usize,
    /// The root of the mean square error of what is sought at the first sample, over the seeds that converged.
    pub errors: Vec<f64>,
    /// The bound of Cramér and Rao there, at the truth.
    pub bounds: Vec<f64>,
}

/// The first guesses from which one method arrives.
#[derive(Clone, Debug, PartialEq)]
pub struct Basin {
    /// The observer.
    pub method: scene::Method,
    /// The states that span the grid, and their values along each side.
    pub names: [String; 2],
    /// The values of each along its side.
    pub values: [Vec<f64>; 2],
    /// Whether it arrives, rows by the second state; none where it was interrupted before.
    pub arrives: Vec<Option<bool>>,
}

impl Basin {
    /// The part of the guesses that were tried from which it arrives.
    pub fn fraction(&self) -> f64 {
        let tried = self.arrives.iter().flatten().count();
        self.arrives.iter().flatten().filter(|arrives| **arrives).count() as f64 / tried.max(1) as f64
    }
}

/// An estimate has arrived that is within one percent of the truth.
pub const ARRIVED: f64 = 0.01;

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
    let task = experiment.task(interrupt)?;
    let observer =
        MovingWindow { steps: 50, blind: f64::INFINITY, ..experiment.window(WindowSearch::TrustRegion) };
    let mut levels = Vec::new();
    for (level, &noise) in study.levels.iter().enumerate() {
        if task.interrupted() {
            break;
        }
        let one = |seed: u64| -> Trial {
            if interrupt.load(Ordering::Relaxed) {
                return Trial::Interrupted;
            }
            let estimate = (|| {
                // every level has errors of its own
                let seed = (level * study.seeds) as u64 + seed;
                let seed = experiment.scene.seed.wrapping_add(1 + seed);
                let signals = noisy(experiment, simulation, noise, seed)?;
                let task = at_level(experiment, &task.with_signals(&signals), noise);
                let rows = first_window(&task, &observer);
                let update = observer.update(&task, &task.guess, &rows, &task.clamped);
                let fits = update.fit.is_some_and(|fit| fit.fits);
                matches!(update.end, UpdateEnd::Converged | UpdateEnd::DoesNotFit | UpdateEnd::Stuck)
                    .then_some((update.estimate, fits))
            })();
            done();
            estimate.map_or(Trial::Failed, |(estimate, fits)| Trial::Converged { estimate, fits })
        };
        let mut trials: Vec<Trial> = (0..study.seeds as u64).into_par_iter().map(one).collect();
        trials.retain(|trial| *trial != Trial::Interrupted);
        let Some(truth) = experiment.truth_at(task.signals.times()[0]) else { break };
        let arrived: Vec<&Vec<f64>> = trials.iter().filter_map(Trial::estimate).collect();
        let error = |i: usize| {
            let square: f64 = arrived.iter().map(|estimate| (estimate[i] - truth[i]).powi(2)).sum();
            (square / arrived.len() as f64).sqrt()
        };
        levels.push(NoiseLevel {
            noise,
            converged: arrived.len(),
            unfit: trials
                .iter()
                .filter(|trial| matches!(trial, Trial::Converged { fits: false, .. }))
                .count(),
            seeds: trials.len(),
            errors: (0..truth.len()).map(error).collect(),
            bounds: bounds(&at_level(experiment, &task, noise), &observer, &truth),
        });
    }
    Ok(levels)
}

/// What came of one draw of noise.
#[derive(Clone, Debug, PartialEq)]
enum Trial {
    /// It was not begun.
    Interrupted,
    /// There was no estimate, or it did not converge.
    Failed,
    Converged {
        estimate: Vec<f64>,
        fits: bool,
    },
}

impl Trial {
    fn estimate(&self) -> Option<&Vec<f64>> {
        match self {
            Trial::Converged { estimate, .. } => Some(estimate),
            Trial::Interrupted | Trial::Failed => None,
        }
    }
}

/// The signals of an experiment with other errors.
fn noisy(experiment: &Experiment, simulation: &dyn KnownMotion, noise: f64, seed: u64) -> Option<Signals> {
    // the levels are those of the outputs that have no noise of their own; all other columns have the errors of the scene
    let sensor = Sensor { noise, ..experiment.scene.sensor };
    let record = simulation.read(&sensor, &experiment.scene.channels, seed).ok()?;
    corrected(Signals::of_record(&record).ok()?, &experiment.scene.observer.known).ok()
}

/// A task whose outputs are read with errors of one level.
fn at_level<'a>(experiment: &Experiment, task: &Task<'a>, noise: f64) -> Task<'a> {
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

fn first_window(task: &Task<'_>, observer: &MovingWindow) -> std::ops::Range<usize> {
    0..(observer.window.max(2) + 1).min(task.signals.times().len())
}

/// The bound of Cramér and Rao for what is sought at the first sample, at the truth.
fn bounds(task: &Task<'_>, observer: &MovingWindow, truth: &[f64]) -> Vec<f64> {
    observer.bounds(task, truth, &first_window(task, observer), &task.clamped)
}

/// From which first guesses of two states each method of the scene arrives: within [`ARRIVED`] of the truth, after their first
/// window for methods that work by windows and at the last sample for the others. `done` is called once a guess.
///
/// # Errors
/// As [`Experiment::task`], or where the study does not span two states that are sought.
pub fn basins(
    experiment: &Experiment,
    study: &BasinStudy,
    interrupt: &AtomicBool,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Basin>, SceneError> {
    let task = experiment.task(interrupt)?;
    let names: Vec<&str> = experiment.names();
    let mut spanned = study.ranges.iter().filter_map(|(name, range)| {
        Some((names.iter().position(|other| other == name)?, name.clone(), *range))
    });
    let (Some(first), Some(second), None) = (spanned.next(), spanned.next(), spanned.next()) else {
        let help = "give the ranges of two states that are estimated";
        let message = format!("a map needs two of the states {}", names.join(", "));
        return Err(experiment.scene.error_at("study.basin", message, "here", help));
    };
    let values = [first.2, second.2].map(|[low, high]| -> Vec<f64> {
        let last = study.points.max(2) - 1;
        (0..=last).map(|i| low + (high - low) * i as f64 / last as f64).collect()
    });
    let mut basins = Vec::new();
    for &method in &experiment.scene.observer.methods {
        let width = values[0].len();
        let one = |index: usize| -> Option<bool> {
            if interrupt.load(Ordering::Relaxed) {
                return None;
            }
            let mut task = task.clone();
            task.guess[first.0] = values[0][index % width];
            task.guess[second.0] = values[1][index / width];
            let arrives = arrives(experiment, &task, method);
            done();
            Some(arrives.unwrap_or(false))
        };
        let arrives = (0..width * values[1].len()).into_par_iter().map(one).collect();
        basins.push(Basin {
            method,
            names: [first.1.clone(), second.1.clone()],
            values: values.clone(),
            arrives,
        });
    }
    Ok(basins)
}

fn arrives(experiment: &Experiment, task: &Task<'_>, method: scene::Method) -> Option<bool> {
    let (time, state) = match method.search() {
        Some(search) => {
            let observer = experiment.window(search);
            let update = observer.update(task, &task.guess, &first_window(task, &observer), &task.clamped);
            (update.from, update.estimate)
        }
        None if method == scene::Method::MultipleShooting => {
            let observer = experiment.scene.observer.multiple_shooting();
            let found =
                observer.solutions(task, &task.guess, &first_window(task, &observer.window), &task.clamped);
            let update = found.into_iter().next()?;
            (update.from, update.estimate)
        }
        None => {
            let track = experiment.observer(method).observe(task);
            let last = track.last()?;
            (last.time, last.state.clone())
        }
    };
    let truth = experiment.truth_at(time)?;
    Some(state.iter().zip(&truth).all(|(state, truth)| error(*state, *truth) < ARRIVED))
}
