//! Window after window, each with what those before it have learned.
//!
//! A window hands on what its measurements determine of the state at its end as the triangular factor of an information matrix: the rows
//! `R (x - m)` have independent errors as large as a measurement's. The next window takes them as measurements beside its own, in the place of the
//! first sample, which both share (C. V. Rao, J. B. Rawlings, D. Q. Mayne, Constrained state estimation for nonlinear discrete-time systems, 2003, who call
//! them the arrival cost; G. J. Bierman, Factorization Methods for Discrete Sequential Estimation, 1977, for the factor). Constants
//! are so shared by all windows.

use super::fit::NoiseFrom;
use super::learned::{Arrival, Learned};
use super::moving_window::Known;
use super::task::Task;
use super::trace::is_asked;
use super::track::{Track, Update, UpdateEnd};
use super::window::Window;
use super::{MovingWindow, Order, seam, weights};
use std::ops::Range;
use std::sync::Arc;

/// What is made of a window that inherits nothing: its update, and other states that fit as well.
pub(super) type Anew<'f> = dyn Fn(&[f64], &Range<usize>, &[usize], &Learned) -> (Update, Vec<Update>) + 'f;

impl MovingWindow {
    /// Window after window: each begins with what those before it have learned, and anew where its measurements contradict that.
    pub(super) fn observe_by(
        &self,
        task: &Task<'_>,
        anew: impl Fn(&[f64], &Range<usize>, &[usize], &Learned) -> (Update, Vec<Update>),
    ) -> Track {
        let anew: &Anew<'_> = &anew;
        let mut track = Track::default();
        let mut learned = Learned::before(task);
        let samples = task.signals.times().len();
        let is_first = task.learned.is_none();
        let fewest = if is_first { self.window.min(samples) } else { self.window };
        // samples that were uninformative by themselves stand before the next window
        let mut row = learned.rows_unobserved();
        while row + 1 < samples && !task.interrupted() {
            // windows share a sample: where one ends the next begins
            let mut rows = row..(row + self.window.max(2)).min(samples - 1) + 1;
            let clamped: &[usize] = if is_first && row == 0 { &task.clamped } else { &[] };
            let mut start = task.full_state(&learned.belief, row);
            let (mut arrival, mut unobserved) = (None, learned.unobserved.take());
            let before = learned.spread.take();
            let mut covariance = before.as_ref().map(|before| Arc::new(before.as_read(task)));
            let (mut is_tested, mut meets) = (false, None);
            // too few samples to compare are only followed, and known if those before were
            if rows.len() >= fewest {
                let grown = self.grown_by_unobservable(
                    task,
                    &rows,
                    unobserved.as_deref(),
                    &learned,
                    anew,
                    &mut track,
                );
                let is_grown = grown.is_some();
                let (own, update, others) = match grown {
                    Some((before, update, others)) => {
                        rows.start -= before.rows;
                        // what was believed there is known better now
                        track.estimates.truncate(if rows.start == 0 { 0 } else { rows.start + 1 });
                        track.unobserved = track.unobserved.saturating_sub(before.rows);
                        (Self::inheriting(task, &before.before, &[]), update, others)
                    }
                    None => {
                        let (update, others) =
                            self.next_update(task, &rows, clamped, &learned, anew, &mut track);
                        (Self::inheriting(task, &learned, clamped), update, others)
                    }
                };
                let is_unobservable = matches!(update.end, UpdateEnd::Unobservable { .. });
                unobserved = match is_unobservable && self.may_grow(task, clamped) {
                    true => {
                        self.unobservable_after(&rows, unobserved.as_deref(), &learned, &update, &mut track)
                    }
                    false => None,
                };
                learned.is_asked |= is_asked(&update);
                learned.sees = !is_unobservable && !matches!(update.end, UpdateEnd::Lost(_));
                start = [&update.estimate[..], &update.outputs].concat();
                // a deviation at a bound is that of a free unknown: the estimate is not spread so
                let is_free = update.at_bounds.is_empty();
                (covariance, is_tested) = (update.covariance.clone(), update.has_tested() && is_free);
                meets = before.filter(|_| !is_grown).map(|before| (before, update.is_heir));
                let own = own.filter(|_| update.is_heir);
                arrival = self.learn(own.as_ref().unwrap_or(task), &update, &rows, clamped);
                self.note_bounds(task, &update, &mut track);
                track.updates.push(update);
                track.others.extend(others);
            }
            let from =
                Known { state: &start, covariance: covariance.as_deref(), sees: learned.sees, is_tested };
            let followed = self.follow(task, &from, &rows, &mut track);
            if let (Some((before, is_heir)), Some([first, _])) = (meets, &followed.ends)
                && let Some(update) = track.updates.last_mut()
            {
                update.seam = seam::between(task, update.from, &before, first, is_heir);
            }
            learned.belief = followed.belief;
            learned.spread = followed.ends.map(|[_, last]| Arc::new(last));
            (learned.arrival, learned.unobserved) = (arrival, unobserved);
            row = rows.end - 1;
        }
        track.hand_on(learned);
        track
    }

    /// The update of the next window. What contradicts what was learned before is an update that does not fit, and another one follows it that
    /// knows nothing of before.
    pub(super) fn next_update(
        &self,
        task: &Task<'_>,
        rows: &Range<usize>,
        clamped: &[usize],
        learned: &Learned,
        anew: &Anew<'_>,
        track: &mut Track,
    ) -> (Update, Vec<Update>) {
        let Some(own) = Self::inheriting(task, learned, clamped) else {
            return anew(&learned.belief, rows, clamped, learned);
        };
        let mut update = self.update_and_ask(&own, &learned.belief, rows, clamped, false);
        update.is_heir = true;
        if update.is_borne_out() {
            return (update, Vec::new());
        }
        let (fresh, others) = anew(&learned.belief, rows, clamped, learned);
        if fresh.is_borne_out() && update.is_contradicted() {
            let time = update.from;
            track.remarks.push(format!(
                "at {time:.3} s the measurements contradict the constants or the state that earlier windows gave: begun anew"
            ));
            track.updates.push(update);
        }
        (fresh, others)
    }

    /// Notes the estimates that lie at a bound that was stated: their deviation is that of a free unknown.
    fn note_bounds(&self, task: &Task<'_>, update: &Update, track: &mut Track) {
        for (place, bound) in &update.at_bounds {
            let name = &task.full.states[*place];
            track.remarks.push(format!("from {:.3} s '{name}' is at its bound {bound}", update.from));
        }
    }
}

impl Arrival {
    /// What the measurements of a window determine of the state at its last sample, linearised at this state at its first, with all states
    /// free; none where differences are fewer than states, or a number is not finite. Where the state is no minimum, since it is held at a bound, what is learned is
    /// the minimum of the linearised sum of squares, beyond the bound: the bound is no measurement, and counts again in each window.
    fn after(window: &Window<'_>, state: &[f64], is_least: bool) -> Option<Arrival> {
        let n = state.len();
        let free: Vec<usize> = (0..n).collect();
        let window = Window { free, ..window.clone() };
        let here = window.expand(&window.unknowns(state), Order::First).ok()?;
        if here.slopes.nrows() < n || here.end.iter().any(|value| !value.is_finite()) {
            return None;
        }
        let triangle = here.slopes.qr();
        let mut mean = here.end;
        if !is_least {
            let mut rotated = here.differences;
            triangle.q_tr_mul(&mut rotated);
            let step = triangle.r().solve_upper_triangular(&rotated.rows(0, n).into_owned())?;
            let moved = &here.end_slopes * step;
            mean.iter_mut().zip(moved.iter()).for_each(|(value, moved)| *value -= moved);
        }
        let factor = triangle.unpack_r();
        // R x at the first sample is R F^-1 x at the last
        let carried = here.end_slopes.transpose().lu().solve(&factor.transpose())?.transpose();
        let factor = carried.qr().unpack_r();
        let is_told = factor.iter().chain(mean.iter()).all(|value| value.is_finite());
        is_told.then_some(Arrival { mean, factor })
    }
}

impl Learned {
    /// What is known before any measurement.
    pub(super) fn nothing(task: &Task<'_>) -> Learned {
        Learned::belief_alone(task.within_bounds(task.guess.clone()))
    }

    /// What is known at the first sample of a task.
    pub(super) fn before(task: &Task<'_>) -> Learned {
        task.learned.as_ref().map_or_else(|| Learned::nothing(task), |learned| (**learned).clone())
    }
}

impl MovingWindow {
    /// A task with what was learned before a window, where it may be taken: a window of which something is clamped, or whose driving columns err,
    /// stands alone.
    pub(super) fn inheriting<'t>(task: &Task<'t>, learned: &Learned, clamped: &[usize]) -> Option<Task<'t>> {
        let arrival = learned.arrival.clone().filter(|_| task.inherit && clamped.is_empty())?;
        Some(Task { arrival: Some(arrival), exact: false, ..task.clone() })
    }

    /// What an update of some rows hands on to the next window: nothing where the measurements do not bear its answer out, where they have
    /// no errors to weigh, or where states are clamped or weights are needed.
    pub(super) fn learn(
        &self,
        task: &Task<'_>,
        update: &Update,
        rows: &Range<usize>,
        clamped: &[usize],
    ) -> Option<Arc<Arrival>> {
        let has_errors = update.fit.is_some_and(|fit| fit.from != NoiseFrom::Computation);
        if !(task.inherit && has_errors && update.is_borne_out() && clamped.is_empty())
            || weights::are_needed(task)
        {
            return None;
        }
        let task = Task { exact: false, ..task.clone() };
        let window = Self::window(&task, &update.estimate, rows, clamped);
        let state = [&update.estimate[..], &update.outputs].concat();
        Arrival::after(&window, &state, update.at_bounds.is_empty()).map(Arc::new)
    }
}

impl Track {
    /// Notes what is handed on.
    pub(super) fn hand_on(&mut self, learned: Learned) {
        self.learned = Some(Arc::new(learned));
    }
}
