//! From which first guesses the methods of a scene converge to the truth.

use super::super::run::{Experiment, error};
use super::super::scene::{self, BasinStudy, SceneError};
use super::noise::first_window;
use palmistry_observe::Task;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// The first guesses from which one method converges to the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Basin {
    /// The observer.
    pub method: scene::Method,
    /// The states that span the grid.
    pub names: [String; 2],
    /// The values of each along its side.
    pub values: [Vec<f64>; 2],
    /// Whether it converges to the truth, rows by the second state; none where it was interrupted before.
    pub arrives: Vec<Option<bool>>,
}

impl Basin {
    /// The fraction of the tried guesses from which it converges to the truth.
    pub fn fraction(&self) -> f64 {
        let tried = self.arrives.iter().flatten().count();
        self.arrives.iter().flatten().filter(|arrives| **arrives).count() as f64 / tried.max(1) as f64
    }
}

/// The relative error below which an estimate counts as the truth.
pub const ARRIVED: f64 = 0.01;

/// The first guesses of a study, one after the other: all of the first method, then those of the next.
pub(super) struct BasinTrials<'a> {
    experiment: &'a Experiment,
    task: Task<'a>,
    /// Of the states that span the grid: its index among the estimated states, and its name.
    spanned: [(usize, String); 2],
    values: [Vec<f64>; 2],
}

impl<'a> BasinTrials<'a> {
    /// # Errors
    /// As [`Experiment::task`], or where the study does not span two estimated states.
    pub fn new(
        experiment: &'a Experiment,
        study: &BasinStudy,
        interrupt: &'a AtomicBool,
    ) -> Result<BasinTrials<'a>, SceneError> {
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
        let spanned = [(first.0, first.1), (second.0, second.1)];
        Ok(BasinTrials { experiment, task, spanned, values })
    }

    /// The number of guesses of each method.
    fn of_each(&self) -> usize {
        self.values[0].len() * self.values[1].len()
    }

    /// The number of trials.
    pub fn count(&self) -> usize {
        self.of_each() * self.experiment.scene.observer.methods.len()
    }

    /// Whether a method converges to the truth from one of them; the result depends on its place alone.
    pub fn trial(&self, place: usize) -> bool {
        let (method, place) = (place / self.of_each(), place % self.of_each());
        let Some(&method) = self.experiment.scene.observer.methods.get(method) else { return false };
        let (mut task, width) = (self.task.clone(), self.values[0].len());
        task.guess[self.spanned[0].0] = self.values[0][place % width];
        task.guess[self.spanned[1].0] = self.values[1][place / width];
        arrives(self.experiment, &task, method).unwrap_or(false)
    }

    /// The basins from the results of all guesses, in their order: one a method.
    pub fn basins(&self, arrives: &[Option<bool>]) -> Vec<Basin> {
        let methods = self.experiment.scene.observer.methods.iter();
        let each = methods.zip(arrives.chunks(self.of_each()));
        each.map(|(&method, arrives)| Basin {
            method,
            names: self.spanned.each_ref().map(|(_, name)| name.clone()),
            values: self.values.clone(),
            arrives: arrives.to_vec(),
        })
        .collect()
    }
}

/// From which first guesses of two states each method of the scene converges: within [`ARRIVED`] of the truth, after their first
/// window for methods that work by windows and at the last sample for the others. `done` is called once a guess.
///
/// # Errors
/// As [`Experiment::task`], or where the study does not span two estimated states.
pub fn basins(
    experiment: &Experiment,
    study: &BasinStudy,
    interrupt: &AtomicBool,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Basin>, SceneError> {
    let all = BasinTrials::new(experiment, study, interrupt)?;
    let one = |place: usize| -> Option<bool> {
        if interrupt.load(Ordering::Relaxed) {
            return None;
        }
        let arrives = all.trial(place);
        done();
        Some(arrives)
    };
    let arrives: Vec<Option<bool>> = (0..all.count()).into_par_iter().map(one).collect();
    Ok(all.basins(&arrives))
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
