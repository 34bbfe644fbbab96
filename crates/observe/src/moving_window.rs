//! The observer of section 4.5: after every window of samples some steps towards the state at its first sample that explains
//! it best, from there on by the equations.

use super::fit::{FALSE_ALARMS, Noise};
use super::learned::Spread;
use super::propagated::{deviations, spread};
use super::task::{Observer, Task};
use super::trace::{is_asked, suspects};
use super::track::{SampleEstimate, Track, Update, UpdateEnd};
use super::window::Window;
use super::{Order, weights};
use nalgebra::DMatrix;
use serde::Deserialize;
use std::cell::Cell;
use std::ops::Range;

/// How the smallest error of a window is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WindowSearch {
    /// 4.78, with the exact Hessian.
    Newton,
    /// Gauss and Newton's method within a region of trust.
    TrustRegion,
}

/// What an observer does while the state is not observable.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WhenUnobservable {
    /// `integrate`: the equations, with the outputs as measured.
    #[default]
    Integrate,
    /// `hold`: believe what it believed.
    Hold,
}

/// A window that is lost grows from a part of it with so many measurements for each unknown.
const FEWEST: usize = 4;

/// The observer by windows.
#[derive(Clone, Copy, Debug)]
pub struct MovingWindow {
    /// How the smallest error is found.
    pub method: WindowSearch,
    /// Samples of a window.
    pub window: usize,
    /// Steps a window at most.
    pub steps: u64,
    /// The relative standard deviation, by the Cramér-Rao bound, above which an unknown counts as unobservable.
    pub unobservable_above: f64,
    /// What is done where an unknown is unobservable.
    pub when_unobservable: WhenUnobservable,
}

impl MovingWindow {
    /// Windows of so many samples, five steps each by a region of trust; an unknown that is known no better than its own size counts as
    /// unobservable, and is integrated.
    pub fn new(window: usize) -> MovingWindow {
        let when_unobservable = WhenUnobservable::default();
        MovingWindow {
            method: WindowSearch::TrustRegion,
            window,
            steps: 5,
            unobservable_above: 1.0,
            when_unobservable,
        }
    }
}

impl Observer for MovingWindow {
    fn observe(&self, task: &Task<'_>) -> Track {
        let all = MovingWindow { window: task.signals.times().len(), ..*self };
        let windows = if task.whole { &all } else { self };
        let began_anew = Cell::new(None);
        let mut track = windows.observe_by(task, |belief, rows, clamped, learned| {
            let ask = !learned.is_asked;
            let update = match task.whole {
                true => self.grown(task, belief, rows, clamped, ask),
                false => self.update_and_ask(task, belief, rows, clamped, ask),
            };
            let (update, is_other) = windows.restarted(task, update, belief, rows, clamped);
            if is_other {
                began_anew.set(Some(update.from));
            }
            (update, Vec::new())
        });
        if let Some(from) = began_anew.get() {
            track.remarks.push(format!(
                "from {from:.3} s the search from the guess came to nothing, and one from another state of the ranges has found this"
            ));
        }
        track
    }
}

impl MovingWindow {
    /// The window of some rows, with the unknowns of this task.
    pub fn window<'t>(
        task: &'t Task<'_>,
        belief: &[f64],
        rows: &std::ops::Range<usize>,
        clamped: &[usize],
    ) -> Window<'t> {
        let sought = (0..task.estimated()).filter(|place| !clamped.contains(place));
        let read = task.estimated()..if task.exact { task.estimated() } else { task.full.states.len() };
        Window {
            flow: task.full_flow(),
            times: &task.signals.times()[rows.clone()],
            measured: rows.clone().map(|row| task.measurements(row)).collect(),
            start: task.within_bounds(task.full_state(belief, rows.start)),
            bounds: Self::bounds_of(task, clamped),
            free: sought.chain(read).collect(),
            arrival: task.arrival.clone(),
            loss: (task.loss, task.sigma),
            weights: None,
        }
    }

    /// The bounds of a window's unknowns; empty where none is given.
    fn bounds_of(task: &Task<'_>, clamped: &[usize]) -> Vec<[f64; 2]> {
        if task.bounds.iter().flatten().all(|bound| bound.is_infinite()) {
            return Vec::new();
        }
        let sought = (0..task.estimated()).filter(|place| !clamped.contains(place));
        let read = task.estimated()..if task.exact { task.estimated() } else { task.full.states.len() };
        let anywhere = [f64::NEG_INFINITY, f64::INFINITY];
        sought.chain(read).map(|place| task.bounds.get(place).copied().unwrap_or(anywhere)).collect()
    }

    /// The magnitudes of a window's unknowns.
    pub fn sizes(task: &Task<'_>, window: &Window<'_>) -> Vec<f64> {
        let size = |place: &usize| match task.sizes.get(*place) {
            Some(size) => *size,
            None => window.start[*place].abs().max(1e-3),
        };
        window.free.iter().map(size).collect()
    }

    /// The probability of a false alarm that an update may have for all of a run to have no more than [`FALSE_ALARMS`].
    pub(super) fn alarm(&self, task: &Task<'_>) -> f64 {
        if let Some(alarm) = task.alarm {
            return alarm;
        }
        let samples = task.signals.times().len();
        // all measurements at once are one update, however it came to grow
        let updates = if task.whole { 1 } else { samples.div_ceil(self.window.max(1)) };
        FALSE_ALARMS / updates.max(1) as f64
    }

    /// One update: what is believed of the state at the first of the rows.
    ///
    /// Where no noise is stated measurements are taken as they are first; where a residual remains that the computation does not explain,
    /// the first measurements are in doubt as all others are, and the size of the errors is that of the residual.
    pub fn update(
        &self,
        task: &Task<'_>,
        belief: &[f64],
        rows: &std::ops::Range<usize>,
        clamped: &[usize],
    ) -> Update {
        self.update_and_ask(task, belief, rows, clamped, false)
    }

    /// The same, with the suspects of an update of which they are asked.
    pub(super) fn update_and_ask(
        &self,
        task: &Task<'_>,
        belief: &[f64],
        rows: &std::ops::Range<usize>,
        clamped: &[usize],
        ask: bool,
    ) -> Update {
        if weights::are_needed(task) {
            return self.weighted_update(task, belief, rows, clamped, ask);
        }
        let mut update = self.unweighted_update(task, belief, rows, clamped);
        if ask && is_asked(&update) {
            let window = Self::window(task, belief, rows, clamped);
            update.suspects = suspects(task, &window, &update, self.alarm(task));
        }
        update
    }

    fn unweighted_update(
        &self,
        task: &Task<'_>,
        belief: &[f64],
        rows: &std::ops::Range<usize>,
        clamped: &[usize],
    ) -> Update {
        let update = self.attempt(task, belief, rows, clamped);
        let exactly = task.exact && task.noise == Noise::Unstated;
        let at_best = matches!(update.end, UpdateEnd::Converged | UpdateEnd::DoesNotFit | UpdateEnd::Stuck);
        if !(exactly && at_best) || update.rms_residual <= task.sigma {
            return update;
        }
        let mut task = task.clone();
        task.exact = false;
        let again = self.attempt(&task, &update.estimate, rows, clamped);
        Update { seconds: update.seconds + again.seconds, steps: update.steps + again.steps, ..again }
    }

    pub(super) fn attempt(
        &self,
        task: &Task<'_>,
        belief: &[f64],
        rows: &std::ops::Range<usize>,
        clamped: &[usize],
    ) -> Update {
        let from = |belief: &[f64]| {
            let window = Self::window(task, belief, rows, clamped);
            self.attempt_in(task, &window).0
        };
        let update = from(belief);
        let shorter = rows.start..rows.start + rows.len() / 2;
        if !matches!(update.end, UpdateEnd::Lost(_)) || shorter.len() < self.fewest(task) {
            return update;
        }
        // an unstable flow leaves a long window from a guess; a part of the window makes the guess better
        let half = self.attempt(task, belief, &shorter, clamped);
        let again = from(&half.estimate);
        if matches!(again.end, UpdateEnd::Lost(_)) {
            return update;
        }
        let (steps, seconds) = (half.steps + again.steps, update.seconds + half.seconds + again.seconds);
        Update { steps, seconds, ..again }
    }

    /// The samples of the shortest part of a window that is informative.
    fn fewest(&self, task: &Task<'_>) -> usize {
        (FEWEST * task.full.states.len()).div_ceil(task.full.outputs.len().max(1)).max(8)
    }

    /// An update from all of the rows by windows that grow: the first is as long as this observer's, each further one twice as long, and
    /// what is found is where the next begins.
    fn grown(
        &self,
        task: &Task<'_>,
        belief: &[f64],
        rows: &Range<usize>,
        clamped: &[usize],
        ask: bool,
    ) -> Update {
        let (mut belief, mut length) = (belief.to_vec(), self.window.max(2));
        let (mut steps, mut seconds) = (0, 0.0);
        while length < rows.len() && !task.interrupted() {
            let part = rows.start..rows.start + length;
            let update = self.update_and_ask(task, &belief, &part, clamped, false);
            (steps, seconds) = (steps + update.steps, seconds + update.seconds);
            belief = update.estimate;
            length *= 2;
        }
        let update = self.update_and_ask(task, &belief, rows, clamped, ask);
        Update { steps: steps + update.steps, seconds: seconds + update.seconds, ..update }
    }

    /// The moments of some rows from a state at the first of them, with the covariance that it is known with, where it is.
    pub(super) fn follow(
        &self,
        task: &Task<'_>,
        from: &Known<'_>,
        rows: &std::ops::Range<usize>,
        track: &mut Track,
    ) -> Followed {
        let times = &task.signals.times()[rows.clone()];
        // the sample that two windows share has its moment by now
        let skipped = usize::from(!track.estimates.is_empty());
        let sought = task.estimated();
        let belief = &from.state[..sought];
        // columns that err move the state after the first sample by errors that this covariance does not have
        let carried = from.covariance.filter(|_| weights::noisy_columns(task).is_empty());
        let (free, order): (Vec<usize>, Order) = match carried {
            Some(covariance) => {
                let varies = |place: &usize| covariance.column(*place).iter().any(|value| *value != 0.0);
                ((0..covariance.ncols()).filter(varies).collect(), Order::First)
            }
            None => (Vec::new(), Order::Value),
        };
        let follow = |free: &[usize], order| task.full_flow().follow(from.state, free, times, order);
        let followed = match from.sees {
            // derivatives may grow beyond all numbers where the state does not
            true => follow(&free, order).or_else(|_| follow(&[], Order::Value)),
            false => Ok(Vec::new()),
        };
        let carried = carried.filter(|_| {
            followed.as_ref().is_ok_and(|all| all.iter().all(|at| at.slopes.ncols() == free.len()))
        });
        if let Ok(samples) = &followed
            && let (Some(first), Some(last)) = (samples.first(), samples.last())
        {
            let own = carried.map(|covariance| covariance.select_rows(&free).select_columns(&free));
            for (place, (sample, row)) in samples.iter().zip(rows.clone()).enumerate().skip(skipped) {
                let read = task.measurements(row);
                let residual = sample.outputs.iter().zip(&read).map(|(seen, read)| seen - read).collect();
                let state = sample.state[..sought].to_vec();
                let deviations = match (&own, from.covariance) {
                    (Some(own), _) => deviations(sample, own, sought),
                    (None, Some(all)) if place == 0 => (0..sought).map(|i| all[(i, i)].sqrt()).collect(),
                    _ => Vec::new(),
                };
                track.estimates.push(SampleEstimate { time: sample.time, state, deviations, residual });
            }
            let ends = own.map(|own| {
                [(first, rows.start), (last, rows.end - 1)]
                    .map(|at| spread(task, at, &own, samples.len(), from.is_tested))
            });
            return Followed { belief: last.state[..sought].to_vec(), ends };
        }
        if let Err(lost) = followed {
            track.remarks.push(format!("the model could not be followed: {lost}"));
        }
        track.unobserved += rows.len() - 1;
        let held = || vec![belief.to_vec(); rows.len()];
        let states = match self.when_unobservable {
            WhenUnobservable::Hold => held(),
            WhenUnobservable::Integrate => task.integrate(belief, rows.clone()).unwrap_or_else(|lost| {
                track.remarks.push(format!("could not be integrated either, and was held: {lost}"));
                held()
            }),
        };
        let end = states.last().cloned().unwrap_or_else(|| belief.to_vec());
        for (state, time) in states.into_iter().zip(times).skip(skipped) {
            let deviations = vec![f64::INFINITY; sought];
            track.estimates.push(SampleEstimate { time: *time, state, deviations, residual: Vec::new() });
        }
        Followed { belief: end, ends: None }
    }
}

/// Where some rows begin.
pub(super) struct Known<'a> {
    /// The state with the outputs that are followed.
    pub state: &'a [f64],
    /// Its covariance, where there is one.
    pub covariance: Option<&'a DMatrix<f64>>,
    /// Whether the measurements determined it.
    pub sees: bool,
    /// Whether they bore it out against a noise that was stated.
    pub is_tested: bool,
}

/// What came of following it.
pub(super) struct Followed {
    /// What is believed of the estimated states at the last row.
    pub belief: Vec<f64>,
    /// How well the state is known at the first and the last row, where it is.
    pub ends: Option<[Spread; 2]>,
}
