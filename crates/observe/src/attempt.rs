//! One attempt in one window: whether the unknowns are observable, the search, and what its end is worth.

use super::fit::{NoiseFrom, Residuals};
use super::task::Task;
use super::track::{Update, UpdateEnd};
use super::window::{Window, WindowExpansion};
use super::{Fit, MovingWindow, Newton, Order, TrustRegion, WindowSearch, cramer_rao};
use argmin::core::{Executor, State, TerminationReason, TerminationStatus};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;
use std::time::Instant;

/// With a robust loss so many times the steps are allowed.
const ROBUST: u64 = 8;

/// An estimate of so many of its standard deviations or more sets a size of its own.
const SIGNIFICANT: f64 = 3.0;

impl MovingWindow {
    /// An attempt in a window; the state that it begins with, moved within its bounds, stays believed where there is no answer. With the differences at the
    /// estimate.
    pub(super) fn attempt_in(&self, task: &Task<'_>, window: &Window<'_>) -> (Update, Option<DVector<f64>>) {
        let begin = Instant::now();
        let mut left = None;
        let sizes = Self::sizes(task, window);
        let mut update = Update {
            from: window.times[0],
            to: window.times[window.times.len() - 1],
            estimate: window.start[..task.estimated()].to_vec(),
            outputs: window.start[task.estimated()..].to_vec(),
            deviations: vec![f64::INFINITY; task.estimated()],
            covariance: None,
            at_bounds: Vec::new(),
            seam: None,
            condition: f64::INFINITY,
            cost: f64::INFINITY,
            rms_residual: f64::INFINITY,
            steps: 0,
            troubled: 0,
            seconds: 0.0,
            end: UpdateEnd::Stuck,
            fit: None,
            drifting: None,
            suspects: Vec::new(),
            is_heir: false,
            discounted: 0,
        };
        let guess = window.unknowns(&window.start);
        update.end = match window.expand(&guess, Order::First) {
            Err(lost) => UpdateEnd::Lost(lost),
            Ok(expansion) => {
                (update.cost, update.rms_residual) = (expansion.cost, expansion.rms_residual());
                // what is unobservable at the guess may be observable where the search ends
                let blind =
                    self.see(task, task.sigma, window, (&expansion.slopes, &guess), &sizes, &mut update);
                let (end, found) = self.search(task, window, guess, &sizes, &mut update);
                left = found;
                match (end, blind) {
                    (UpdateEnd::Lost(_), Some(blind)) => {
                        update.estimate = window.start[..task.estimated()].to_vec();
                        update.outputs = window.start[task.estimated()..].to_vec();
                        blind
                    }
                    (end, _) => end,
                }
            }
        };
        update.at_bounds = task.at_bounds(&update.estimate);
        update.seconds = begin.elapsed().as_secs_f64();
        (update, left)
    }

    /// How well a state explains a window.
    fn fit(&self, task: &Task<'_>, window: &Window<'_>, expansion: &WindowExpansion) -> Fit {
        let (differences, slopes) = (&expansion.counted, expansion.counted_slopes());
        let read = || window.measured.iter().flatten().filter(|value| !value.is_nan());
        let not_counted = window.not_counted();
        let square: f64 = read().map(|value| value * value).sum();
        // an implicit output is not measured: its size is what the unknowns, at their sizes, make of its terms
        let sizes = Self::sizes(task, window);
        let term = |i: usize| -> f64 {
            slopes.row(i).iter().zip(&sizes).map(|(slope, size)| (slope * size).powi(2)).sum()
        };
        let outputs = task.full.outputs.len().max(1);
        let implicit = (0..differences.len()).filter(|i| task.full.is_implicit(i % outputs));
        let square = match window.weights {
            Some(_) => square,
            None => square + implicit.map(term).sum::<f64>(),
        };
        let taken = if task.exact { task.full.states.len() - task.estimated() } else { 0 };
        let rms_residual = Residuals {
            differences,
            unmeasured: &not_counted,
            slopes: Some(slopes),
            loss: window.loss.0,
            outputs: task.full.outputs.len(),
            relations: window.relations(),
            unknowns: window.free.len() + taken,
            size: (square / read().count().max(1) as f64).sqrt(),
            alarm: self.alarm(task),
            least: task.sigma,
            timing: task.timing,
        };
        match &window.weights {
            Some(weights) => {
                let (computed, degrees) = (rms_residual.computed(), rms_residual.degrees());
                let judged = (rms_residual.loss, rms_residual.alarm);
                weights.fit(differences, slopes, computed, degrees, judged)
            }
            None => rms_residual.fit(task.noise),
        }
    }

    /// Sets the Cramér-Rao bound; reports an unknown as unobservable whose deviation exceeds `unobservable_above` times its size, which is that
    /// of the guess, or follows from the estimate where that is significant.
    fn see(
        &self,
        task: &Task<'_>,
        sigma: f64,
        window: &Window<'_>,
        (slopes, at): (&DMatrix<f64>, &DVector<f64>),
        sizes: &[f64],
        update: &mut Update,
    ) -> Option<UpdateEnd> {
        let bound = cramer_rao(slopes, sigma, sizes);
        let mut blind = false;
        update.deviations = vec![0.0; task.estimated()];
        let known = window.free.iter().zip(&bound.deviations).zip(sizes).zip(at.iter());
        for (((place, deviation), size), value) in known {
            if let Some(own) = update.deviations.get_mut(*place) {
                *own = *deviation;
                let size = size.max(value.abs() / SIGNIFICANT);
                blind |= deviation.is_nan() || *deviation > self.unobservable_above * size;
            }
        }
        update.condition = bound.condition;
        update.covariance =
            bound.covariance.map(|own| Arc::new(of_all(&own, &window.free, window.start.len())));
        blind.then_some(UpdateEnd::Unobservable { weakest: bound.weakest })
    }

    fn search(
        &self,
        task: &Task<'_>,
        window: &Window<'_>,
        guess: DVector<f64>,
        sizes: &[f64],
        update: &mut Update,
    ) -> (UpdateEnd, Option<DVector<f64>>) {
        // beyond the corner of a robust loss the error is no square: each step goes only a part of the way
        let steps = if task.loss == super::Loss::Squares { self.steps } else { ROBUST * self.steps };
        macro_rules! run {
            ($solver:expr) => {
                Executor::new(window.clone(), $solver)
                    .configure(|state| state.param(guess).max_iters(steps))
                    .ctrlc(false)
                    .run()
            };
        }
        // steps of Newton's method know of no bounds
        let method = if window.bounds.is_empty() { self.method } else { WindowSearch::TrustRegion };
        let (state, troubled) = match method {
            WindowSearch::Newton => match run!(Newton::new(sizes.to_vec())) {
                Ok(result) => {
                    let troubled = result.solver.not_convex + result.solver.halved;
                    (result.state, troubled)
                }
                Err(error) => return (lost(error, update.from), None),
            },
            WindowSearch::TrustRegion => match run!(TrustRegion::new(sizes.to_vec())) {
                Ok(result) => (result.state, result.solver.refused),
                Err(error) => return (lost(error, update.from), None),
            },
        };
        update.steps = state.get_iter();
        update.troubled = troubled;
        let Some(found) = state.get_param() else { return (UpdateEnd::Stuck, None) };
        let whole = window.state(found);
        update.estimate = whole[..task.estimated()].to_vec();
        update.outputs = whole[task.estimated()..].to_vec();
        // the Cramér-Rao bound belongs to the estimate, where there is one
        let left = match window.expand(found, Order::First) {
            Err(lost) => return (UpdateEnd::Lost(lost), None),
            Ok(expansion) => {
                (update.cost, update.rms_residual) = (expansion.cost, expansion.rms_residual());
                let fit = self.fit(task, window, &expansion);
                update.fit = Some(fit);
                update.drifting = fit.drift.map(|own| task.full.outputs[own.output].clone());
                let (loss, sigma) = window.loss;
                let left = window.weighted(expansion.left.clone());
                update.discounted = left.iter().filter(|value| loss.is_discounted(**value, sigma)).count();
                let here = (&expansion.slopes, found);
                // a residual that is no noise says nothing of how well the measurements determine the unknowns
                let is_noise = fit.fits || fit.from != NoiseFrom::Residual;
                let may_be_blind =
                    is_noise || self.see(task, task.sigma, window, here, sizes, update).is_some();
                if let Some(blind) = self.see(task, fit.sigma, window, here, sizes, update)
                    && may_be_blind
                {
                    update.estimate = window.start[..task.estimated()].to_vec();
                    update.outputs = window.start[task.estimated()..].to_vec();
                    return (blind, None);
                }
                expansion.differences
            }
        };
        let fits = update.fit.is_some_and(|fit| fit.fits);
        let end = match state.get_termination_status() {
            TerminationStatus::Terminated(TerminationReason::SolverConverged) if fits => UpdateEnd::Converged,
            TerminationStatus::Terminated(TerminationReason::SolverConverged) => UpdateEnd::DoesNotFit,
            TerminationStatus::Terminated(TerminationReason::MaxItersReached) => UpdateEnd::StepsSpent,
            _ => UpdateEnd::Stuck,
        };
        (end, Some(left))
    }
}

/// The covariance of all followed states, from that of the unknowns.
fn of_all(unknowns: &DMatrix<f64>, free: &[usize], states: usize) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(states, states);
    for (i, row) in free.iter().enumerate() {
        for (j, column) in free.iter().enumerate() {
            all[(*row, *column)] = unknowns[(i, j)];
        }
    }
    all
}

fn lost(error: argmin::core::Error, time: f64) -> UpdateEnd {
    let why = error.to_string();
    UpdateEnd::Lost(error.downcast::<super::Lost>().unwrap_or(super::Lost { time, why }))
}

#[cfg(test)]
mod tests;
