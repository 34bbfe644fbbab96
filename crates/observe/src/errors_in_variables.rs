//! The observer by windows where columns that drive the model err: their true values are unknown as well, and are believed to be what
//! the outputs and their errors make most likely.
//!
//! Gauss and Newton's method for all unknowns at once, the samples' errors eliminated: differences are weighted by their covariance
//! ([`Weights`]), a state is estimated, the most likely errors are taken off the columns, and weights are made anew there, until
//! the answer stays. Reference: W. A. Fuller, Measurement Error Models, 1987, section 3.2.

use super::moving_window::MovingWindow;
use super::task::Task;
use super::trace::{is_asked, suspects};
use super::track::{Update, UpdateEnd};
use super::weights::{self, Weights};
use super::window::Window;
use super::{Lost, Order, Signals, cramer_rao};
use nalgebra::DVector;
use std::sync::Arc;
use std::time::Instant;

/// Weights are made so often at most.
const ROUNDS: usize = 6;

/// An answer stays that moves by less than this part of its deviation.
const STAYS: f64 = 1e-3;

/// Weighted steps begin from a state whose residuals have no more than so many variances a measurement.
const EXPLAINED: f64 = 4.0;

impl MovingWindow {
    /// One update by weighted differences, begun at the answer of those that are not weighted; with the suspects of an update of
    /// which they are asked.
    pub(super) fn weighted_update(
        &self,
        task: &Task<'_>,
        belief: &[f64],
        rows: &std::ops::Range<usize>,
        clamped: &[usize],
        ask: bool,
    ) -> Update {
        let begin = Instant::now();
        // an implicit output errs as the measurements in it do, now much and now hardly at all: weighed alike they may lead far away from where one is
        let believed = match task.full.has_implicit() {
            true => self.weighed(task, belief, None, rows, clamped),
            false => None,
        };
        let count = rows.len() * task.full.outputs.len();
        let explains = |square: f64| square <= EXPLAINED * count as f64 * task.sigma * task.sigma;
        let steps = if believed.is_some_and(explains) { 1 } else { self.steps };
        let mut update = MovingWindow { steps, ..*self }.attempt(task, belief, rows, clamped);
        if let Some(believed) = believed {
            let outputs =
                Some(update.outputs.as_slice()).filter(|_| !matches!(update.end, UpdateEnd::Lost(_)));
            let found =
                outputs.and_then(|own| self.weighed(task, &update.estimate, Some(own), rows, clamped));
            if found.is_none_or(|found| believed < found) {
                let start = Self::window(task, belief, rows, clamped).start;
                update.estimate = start[..task.estimated()].to_vec();
                update.outputs = start[task.estimated()..].to_vec();
                update.end = UpdateEnd::Stuck;
            }
        }
        if matches!(update.end, UpdateEnd::Lost(_)) {
            return update;
        }
        let mut signals = task.signals.clone();
        let mut taken_off: Option<DVector<f64>> = None;
        let (mut steps, mut troubled) = (update.steps, update.troubled);
        for round in 0..ROUNDS {
            let own = task.with_signals(&signals);
            let before = update.estimate.clone();
            let mut window = Self::window(&own, &before, rows, clamped);
            window.start[task.estimated()..].clone_from_slice(&update.outputs);
            let weights = match weights_of(&own, &window, taken_off.as_ref(), task.signals) {
                Ok(weights) => Arc::new(weights),
                Err(lost) => {
                    update.end = UpdateEnd::Lost(lost);
                    break;
                }
            };
            window.weights = Some(weights.clone());
            let (next, left) = self.attempt_in(&own, &window);
            update = next;
            steps += update.steps;
            troubled += update.troubled;
            let Some(left) = left else { break };
            let moved = before.iter().zip(&update.estimate).zip(&update.deviations);
            let stays = moved.into_iter().all(|((before, after), d)| (after - before).abs() <= STAYS * d);
            let is_last = round + 1 == ROUNDS || (round > 0 && stays);
            if is_last {
                if ask && is_asked(&update) {
                    update.suspects = suspects(&own, &window, &update, self.alarm(task));
                }
                break;
            }
            let errors = weights.likely_errors(&left);
            signals = weights.without(task.signals, &errors);
            taken_off = Some(errors);
        }
        Update { steps, troubled, seconds: begin.elapsed().as_secs_f64(), ..update }
    }

    /// The sum of the squares of the residuals of a state, weighed by the errors of the measurements there, in units in which each of these is as
    /// large as the task's; nothing where the model cannot be followed.
    fn weighed(
        &self,
        task: &Task<'_>,
        belief: &[f64],
        outputs: Option<&[f64]>,
        rows: &std::ops::Range<usize>,
        clamped: &[usize],
    ) -> Option<f64> {
        let mut window = Self::window(task, belief, rows, clamped);
        if let Some(outputs) = outputs {
            window.start[task.estimated()..].clone_from_slice(outputs);
        }
        window.arrival = None;
        let weights = weights_of(task, &window, None, task.signals).ok()?;
        window.weights = Some(Arc::new(weights));
        let expansion = window.expand(&window.unknowns(&window.start), Order::First).ok()?;
        Some(expansion.differences.norm_squared()).filter(|square| square.is_finite())
    }

    /// The Cramér-Rao bound (1 sigma) of each estimated state at the first of some rows, linearised at this state;
    /// infinite where the model cannot be followed.
    pub fn bounds(
        &self,
        task: &Task<'_>,
        belief: &[f64],
        rows: &std::ops::Range<usize>,
        clamped: &[usize],
    ) -> Vec<f64> {
        self.bounds_and_condition(task, belief, rows, clamped).0
    }

    /// The same, and the condition of the scaled sensitivities.
    pub fn bounds_and_condition(
        &self,
        task: &Task<'_>,
        belief: &[f64],
        rows: &std::ops::Range<usize>,
        clamped: &[usize],
    ) -> (Vec<f64>, f64) {
        let mut window = Self::window(task, belief, rows, clamped);
        let sizes = Self::sizes(task, &window);
        let (mut found, mut condition) = (vec![f64::INFINITY; window.free.len()], f64::INFINITY);
        let weights = weights::are_needed(task).then(|| weights_of(task, &window, None, task.signals));
        if let Ok(weights) = weights.transpose() {
            window.weights = weights.map(Arc::new);
            if let Ok(expansion) = window.expand(&window.unknowns(&window.start), Order::First) {
                let bound = cramer_rao(&expansion.slopes, task.sigma, &sizes);
                (found, condition) = (bound.deviations, bound.condition);
            }
        }
        let mut bounds = vec![0.0; task.estimated()];
        for (place, deviation) in window.free.iter().zip(found) {
            if let Some(own) = bounds.get_mut(*place) {
                *own = deviation;
            }
        }
        (bounds, condition)
    }
}

/// The weights of a window from where it starts.
fn weights_of(
    task: &Task<'_>,
    window: &Window<'_>,
    taken_off: Option<&DVector<f64>>,
    read: &Signals,
) -> Result<Weights, Lost> {
    let unmeasured = window.unmeasured().collect();
    Weights::of(task, (&window.start, window.times), unmeasured, taken_off, read)
}
