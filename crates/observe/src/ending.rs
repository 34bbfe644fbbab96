//! The end of a search in a window: roughly first, then exactly, and along a valley that bends by second derivatives.

use super::fit::Noise;
use super::loss::Loss;
use super::task::Task;
use super::track::{Update, UpdateEnd};
use super::{MovingWindow, WindowSearch};
use std::ops::Range;

/// Steps of the region of trust that are allowed at the end of a search.
pub(super) const LAST_STEPS: u64 = 50;

/// A residual of so many times that of an answer, of the noise, or of this part of the largest measurement (the error of a rough search), is no answer.
const FAR_FROM_ANSWER: f64 = 10.0;
const ROUGHLY: f64 = 1e-5;

/// As many steps again after which the residual is above this part of what it was have led nowhere.
const STILL: f64 = 0.99;

impl MovingWindow {
    /// Where a search from a state ends: by a region of trust, with integration that is less exact first, and where that takes all its steps, by
    /// Newton's method, whose second derivatives know how a valley bends. Where there is an answer, with this residual in the measurements' unit, no more is
    /// done for a far larger residual.
    pub(super) fn end(
        &self,
        task: &Task<'_>,
        state: &[f64],
        (rows, clamped): (&Range<usize>, &[usize]),
        answer: Option<f64>,
    ) -> Update {
        let steps = self.steps.max(LAST_STEPS);
        let trusting = MovingWindow { method: WindowSearch::TrustRegion, steps, ..*self };
        let rough = trusting.update(&task.roughly(), state, rows, clamped);
        let read =
            rows.clone().flat_map(|row| task.measurements(row)).fold(0.0, |most: f64, x| most.max(x.abs()));
        let is_far = |left: f64| {
            let most = FAR_FROM_ANSWER * left.max(task.sigma).max(ROUGHLY * read);
            rough.rms_residual.is_nan() || rough.rms_residual > most
        };
        // a least error that is far above a noise that is known will not come down to it
        let is_least = matches!(rough.end, UpdateEnd::DoesNotFit | UpdateEnd::Stuck);
        if answer.map_or_else(|| is_least && is_known(task) && is_far(0.0), is_far) {
            return rough;
        }
        // a search that was cut off goes on, unless as many steps again lead nowhere
        let is_slow = answer.is_none() && rough.end == UpdateEnd::StepsSpent && is_known(task) && is_far(0.0);
        let rough = match is_slow {
            true => {
                let again = added(&rough, trusting.update(&task.roughly(), &rough.estimate, rows, clamped));
                if again.rms_residual > STILL * rough.rms_residual {
                    return again;
                }
                again
            }
            false => rough,
        };
        let is_lost = matches!(rough.end, UpdateEnd::Lost(_));
        let begin = if is_lost { state } else { &rough.estimate };
        let update = added(&rough, trusting.update(task, begin, rows, clamped));
        if answer.is_some() || update.end != UpdateEnd::StepsSpent {
            return update;
        }
        let newton = MovingWindow { method: WindowSearch::Newton, steps, ..*self };
        let again = newton.update(task, &update.estimate, rows, clamped);
        match again.cost <= update.cost {
            true => added(&update, again),
            false => update,
        }
    }
}

/// Whether it is known how large the errors of the measurements are.
fn is_known(task: &Task<'_>) -> bool {
    task.noise != Noise::Unstated && task.loss == Loss::default()
}

/// Whether the residual is far above a noise that is known where the search ended or could not get on.
pub(super) fn is_refuted(task: &Task<'_>, update: &Update) -> bool {
    let is_end = !matches!(update.end, UpdateEnd::Converged | UpdateEnd::Lost(_));
    is_end && is_known(task) && update.rms_residual > FAR_FROM_ANSWER * task.sigma
}

/// An update, with what was done for it before.
pub(super) fn added(before: &Update, update: Update) -> Update {
    Update {
        steps: before.steps + update.steps,
        troubled: before.troubled + update.troubled,
        seconds: before.seconds + update.seconds,
        ..update
    }
}
