//! Where the search of a first window comes to nothing: searches from other states, within what is said of where the state lies.
//!
//! A search goes down into the basin in which it begins, and along a valley to its end by second derivatives. Where its end does not explain the measurements it begins again: in the middle of the bounds or the file's
//! ranges, and then at points that fill them evenly (J. H. Halton, 1960). The first end that explains the measurements is the answer. Where three
//! searches have come to one least error that does not, the model has no other that they would find, and they stop.

use super::MovingWindow;
use super::ending::{LAST_STEPS, added};
use super::starts::range;
use super::task::Task;
use super::track::{Update, UpdateEnd};
use std::ops::Range;

/// So many other states are tried, at most.
const STARTS: usize = 12;

/// No more steps are taken in all of them.
const MOST_STEPS: u64 = 6 * LAST_STEPS;

/// So many other searches that come to the same error end them.
const AGREE: usize = 2;

/// Two errors are the same that differ by less than this part.
const SAME: f64 = 1e-4;

const BASES: [usize; 10] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29];

/// A number in [0, 1), evenly filling it (Halton).
fn filling(mut number: usize, base: usize) -> f64 {
    let (mut part, mut sum) = (1.0, 0.0);
    while number > 0 {
        part /= base as f64;
        sum += part * (number % base) as f64;
        number /= base;
    }
    sum
}

/// The interval of an unknown: its bounds, and else the range that the file says.
fn within(task: &Task<'_>, place: usize) -> Option<[f64; 2]> {
    let [low, high] = task.bounds.get(place).copied().unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    if low.is_finite() && high.is_finite() {
        return Some([low, high]);
    }
    let ([from, to], _) = range(task, place).filter(|(_, is_own)| *is_own)?;
    let [from, to] = [from.max(low), to.min(high)];
    (from < to).then_some([from, to])
}

/// The states from which a search begins again, the middle first.
fn starts(task: &Task<'_>, belief: &[f64], clamped: &[usize]) -> Vec<Vec<f64>> {
    let ranges: Vec<Option<[f64; 2]>> = (0..task.estimated())
        .map(|place| within(task, place).filter(|_| !clamped.contains(&place)))
        .collect();
    if ranges.iter().all(Option::is_none) {
        return Vec::new();
    }
    let start = |number: usize| -> Vec<f64> {
        let value = |(place, believed): (usize, &f64)| match ranges[place] {
            Some([low, high]) => {
                let part = if number == 0 { 0.5 } else { filling(number, BASES[place % BASES.len()]) };
                low + part * (high - low)
            }
            None => *believed,
        };
        belief.iter().enumerate().map(value).collect()
    };
    let all = (0..STARTS).map(start);
    all.filter(|start| start != belief).collect()
}

impl MovingWindow {
    /// An update, or what another search has found where that comes to nothing: only where nothing was known before the window, and the task allows it.
    /// With whether it was another one.
    pub(super) fn restarted(
        &self,
        task: &Task<'_>,
        update: Update,
        belief: &[f64],
        rows: &Range<usize>,
        clamped: &[usize],
    ) -> (Update, bool) {
        let is_known = rows.start > 0 || task.learned.is_some();
        if !task.restarts || is_known {
            return (update, false);
        }
        // a search that has spent many steps is on its way along a valley: to the end of that first
        let update = match update.end {
            UpdateEnd::StepsSpent if self.steps >= LAST_STEPS && !task.interrupted() => {
                let there = added(&update, self.end(task, &update.estimate, (rows, clamped), None));
                if there.is_borne_out() {
                    return (self.confirmed(task, there, rows, clamped), false);
                }
                if there.cost < update.cost { there } else { update }
            }
            _ => update,
        };
        if !self.came_to_nothing(&update) {
            return (update, false);
        }
        let (mut least, mut agree, mut steps) = (least_error(&update), 0, 0);
        for start in starts(task, belief, clamped) {
            if task.interrupted() || agree >= AGREE || steps >= MOST_STEPS {
                break;
            }
            let found = self.end(task, &start, (rows, clamped), None);
            // of a search that met a pole nobody knows how far it came
            let is_lost = matches!(found.end, UpdateEnd::Lost(_));
            steps += if is_lost { LAST_STEPS / 2 } else { found.steps };
            if found.is_borne_out() {
                return (self.confirmed(task, found, rows, clamped), true);
            }
            let Some(error) = least_error(&found) else { continue };
            match least {
                Some(known) if (error - known).abs() <= SAME * known => agree += 1,
                Some(known) if error > known => {}
                _ => (least, agree) = (Some(error), 0),
            }
        }
        (update, false)
    }

    /// What was found, by the search that was asked for, with its suspects.
    fn confirmed(&self, task: &Task<'_>, found: Update, rows: &Range<usize>, clamped: &[usize]) -> Update {
        let own = MovingWindow { steps: self.steps.max(LAST_STEPS), ..*self };
        let again = own.update_and_ask(task, &found.estimate, rows, clamped, true);
        if again.is_borne_out() { again } else { found }
    }

    /// Whether a search is at an end that is no answer. A state that explains the measurements is an answer even where they do not determine it: another basin
    /// would be another explanation, and not the better one. A search whose few steps are spent is at no end.
    fn came_to_nothing(&self, update: &Update) -> bool {
        let explains = update.fit.is_some_and(|fit| fit.fits);
        match update.end {
            UpdateEnd::Converged => false,
            UpdateEnd::StepsSpent => !explains && self.steps >= LAST_STEPS,
            UpdateEnd::Lost(_) => true,
            UpdateEnd::DoesNotFit | UpdateEnd::Stuck | UpdateEnd::Unobservable { .. } => !explains,
        }
    }
}

/// The error at the end of a search, where that is a least one.
fn least_error(update: &Update) -> Option<f64> {
    let is_least = matches!(update.end, UpdateEnd::DoesNotFit | UpdateEnd::Stuck);
    Some(update.cost).filter(|cost| is_least && cost.is_finite())
}
