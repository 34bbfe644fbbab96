//! The observer that needs no guess near the truth: multiple shooting from several places of the sample box, and all that fits.
//!
//! A window is cut into segments (`nodes`), whose states are found with joints that stiffen (`stiff_joints`): from the guess, and from
//! states drawn from the model's sample box, whose ranges bound the search and not the answer. What they come to is where the region of
//! trust begins on the whole window, and its update is the answer, with its bound and its test of fit. Where several states fit as well, all are
//! given: the outputs do not distinguish them, as where a mirror image fits too.

use super::ending::{LAST_STEPS, is_refuted};
use super::nodes::Segments;
use super::starts::{bounds, first_nodes, is_angle, range};
use super::stiff_joints::{Found, seek};
use super::task::{Observer, Task};
use super::trace::{is_asked, suspects};
use super::track::{Track, Update, UpdateEnd};
use super::{MovingWindow, WindowSearch, inversion, weights};
use rayon::prelude::*;
use serde::Deserialize;
use std::f64::consts::{PI, TAU};
use std::ops::Range;
use std::time::Instant;

/// A state at the first of the rows to which segments have led.
#[derive(Clone)]
struct Candidate {
    state: Vec<f64>,
    steps: u64,
    refused: usize,
    /// Its residual is far above what noise explains.
    is_far: bool,
}

/// The states to which the segments of some rows led.
struct Candidates {
    /// Those of least residual first.
    all: Vec<Candidate>,
    /// Whether most starts came to the least residual: then that is no false minimum, as far as starts can tell.
    is_met_by_most: bool,
}

/// Segments and starts of multiple shooting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Shooting {
    /// Segments of a window, at most; no segment is shorter than from one sample to the next.
    pub segments: usize,
    /// How often it starts: from the guess and from states of the sample box, each second one with signs kept.
    pub starts: usize,
    /// Whether it starts from inverted Lie derivatives of the outputs as well, where the system is observable by them.
    pub derivatives: bool,
}

impl Default for Shooting {
    fn default() -> Self {
        Shooting { segments: 24, starts: 8, derivatives: false }
    }
}

/// The observer by multiple shooting.
#[derive(Clone, Copy, Debug)]
pub struct MultipleShooting {
    /// Windows, and what ends the search on each: by a region of trust, with so many steps at least as [`LAST_STEPS`].
    pub window: MovingWindow,
    /// Segments and starts.
    pub shooting: Shooting,
}

/// The tolerance of the integration while nodes are searched for, relative to one, or to the smallest size of a state where that is less: a hundredth of the
/// difference that ends the search.
const TOLERANCE: f64 = 1e-6;

/// Of the different states that were found, so many of the best are followed to their end.
const MOST_ENDS: usize = 4;

/// A mean square of the differences, in units of the spreads, that is enough for a search, beside the noise.
const ENOUGH: f64 = 1e-8;

/// A mean square of the differences, in units of the spreads, from which on a search has hardly explained anything; and so often what is enough.
const FAR: f64 = 0.05;
const ENOUGH_FAR: f64 = 100.0;

/// A state with so many times the residual of the best one is followed after all others.
const FAR_FROM_BEST: f64 = 100.0;

/// Two searches came to the same end whose residuals agree but for this part.
const ALIKE: f64 = 0.05;

/// States that are no farther from each other than this part of the sizes are in one basin: a search by segments ends before it knows its end better.
const SAME_BASIN: f64 = 1e-3;

/// A window is halved as long as a half has so many measurements for each unknown.
const FEWEST: usize = 4;

/// Two states are the same that differ by no more than this part of the sizes, or than so many of their deviations.
const SAME: (f64, f64) = (1e-5, 6.0);

impl MultipleShooting {
    /// Windows of so many samples, with the segments and starts that are taken where nothing else is said.
    pub fn new(window: usize) -> MultipleShooting {
        MultipleShooting { window: MovingWindow::new(window), shooting: Shooting::default() }
    }

    fn ending(&self) -> MovingWindow {
        let steps = self.window.steps.max(LAST_STEPS);
        MovingWindow { method: WindowSearch::TrustRegion, steps, ..self.window }
    }

    /// The states that explain the rows: the best first, then others that fit as well.
    ///
    /// Where nothing fits on the whole window, segments half as long may meet fewer false minima, and what fits on its first half is where the search on the whole
    /// begins next: over a shorter time there are fewer as well. Segments whose residual is far above the noise mostly met one, and are followed to their end
    /// only after that. Where most starts came to one end, by these segments and by those, and a known noise does not explain its residual, the model is wrong:
    /// nothing more is tried.
    pub fn solutions(
        &self,
        task: &Task<'_>,
        belief: &[f64],
        rows: &Range<usize>,
        clamped: &[usize],
    ) -> Vec<Update> {
        let segments = 2 * self.shooting.segments;
        let finer = Shooting { segments, ..self.shooting };
        let finer = (segments < rows.len()).then_some(MultipleShooting { shooting: finer, ..*self });
        self.solutions_by(finer, task, belief, rows, clamped)
    }

    /// The same, with other segments where these come to nothing.
    fn solutions_by(
        &self,
        finer: Option<MultipleShooting>,
        task: &Task<'_>,
        belief: &[f64],
        rows: &Range<usize>,
        clamped: &[usize],
    ) -> Vec<Update> {
        let begin = Instant::now();
        let told = (rows, clamped);
        let found = self.candidates(task, belief, rows, clamped);
        let (far, near): (Vec<Candidate>, Vec<Candidate>) =
            found.all.into_iter().partition(|candidate| candidate.is_far);
        let mut updates = Vec::new();
        self.end_all(task, near, told, &mut updates);
        let is_answered = |updates: &[Update]| updates.iter().any(|update| is_answer(task, update));
        let mut is_met_by_most = found.is_met_by_most;
        if let Some(finer) = finer.filter(|_| !is_answered(&updates) && !task.interrupted()) {
            let mut found = finer.candidates(task, belief, rows, clamped);
            found.all.retain(|candidate| !candidate.is_far);
            self.end_all(task, found.all, told, &mut updates);
            is_met_by_most &= found.is_met_by_most;
        }
        if is_met_by_most && !updates.is_empty() && updates.iter().all(|update| is_refuted(task, update)) {
            return timed(best_first(task, updates), begin);
        }
        let half = rows.start..rows.start + rows.len() / 2 + 1;
        let is_long = half.len() * task.full.outputs.len() > FEWEST * task.full.states.len();
        if !is_answered(&updates) && is_long && !task.interrupted() {
            // segments of a half are finer already
            let shorter = self.solutions_by(None, task, belief, &half, clamped);
            for update in shorter.into_iter().filter(Update::is_borne_out) {
                keep(task, &mut updates, self.window.end(task, &update.estimate, told, None));
            }
        }
        if !is_answered(&updates) {
            let belief = Candidate { state: belief.to_vec(), steps: 0, refused: 0, is_far: true };
            self.end_all(task, [far, vec![belief]].concat(), told, &mut updates);
        }
        timed(best_first(task, updates), begin)
    }

    /// Follows candidates to their ends on the whole window: the first one at least, if nothing is known yet.
    fn end_all(
        &self,
        task: &Task<'_>,
        candidates: Vec<Candidate>,
        told: (&Range<usize>, &[usize]),
        updates: &mut Vec<Update>,
    ) {
        for candidate in candidates {
            if task.interrupted() && !updates.is_empty() {
                break;
            }
            let answers = || updates.iter().filter(|update| is_answer(task, update));
            if answers().any(|update| is_near(task, &update.estimate, &candidate.state, &[], SAME_BASIN)) {
                continue;
            }
            let answer = answers().map(|update| update.rms_residual).reduce(f64::min);
            let mut update = self.window.end(task, &candidate.state, told, answer);
            update.steps += candidate.steps;
            update.troubled += candidate.refused;
            keep(task, updates, update);
        }
    }

    /// The states to which the segments of the whole window lead, those of least residual first.
    fn candidates(
        &self,
        task: &Task<'_>,
        belief: &[f64],
        rows: &Range<usize>,
        clamped: &[usize],
    ) -> Candidates {
        let segments = self.segments(task, belief, rows, clamped);
        if segments.moving.is_empty() {
            return Candidates { all: Vec::new(), is_met_by_most: false };
        }
        let bounds = [true, false].map(|are_signs_kept| bounds(task, are_signs_kept));
        let spreads = segments.spread.iter().map(|spread| (task.sigma / spread).powi(2));
        let enough = ENOUGH + 2.0 * spreads.fold(0.0, f64::max);
        let starts = self.shooting.starts.max(1);
        let one = |start: usize| {
            let told = (belief, rows, clamped);
            // the last one is that of the derivatives: signs are kept where they are inverted, and not in the search
            let (nodes, bounds) = match start < starts {
                true => (first_nodes(task, &segments, &bounds[start % 2], told, start), &bounds[start % 2]),
                false => (inversion::nodes(task, &segments, &bounds[0], told)?, &bounds[1]),
            };
            seek(&segments, nodes, bounds, enough, &|| task.interrupted()).ok()
        };
        let all = starts + usize::from(self.shooting.derivatives);
        let found: Vec<Option<Found>> = (0..all).into_par_iter().map(one).collect();
        let mut found: Vec<Found> = found.into_iter().flatten().collect();
        found.sort_by(|a, b| (a.rms_residual + a.gaps).total_cmp(&(b.rms_residual + b.gaps)));
        let compared = segments.measured.iter().flatten().filter(|read| !read.is_nan()).count() as f64;
        let least = found.first().map_or(0.0, |best| best.rms_residual);
        let alike = found.iter().filter(|other| other.rms_residual <= (1.0 + ALIKE) * least).count();
        let is_met_by_most = alike >= 2 && 2 * alike >= all;
        let mut candidates: Vec<Candidate> = Vec::new();
        for found in found {
            let state = segments.state(&found.nodes, 0)[..task.estimated()].to_vec();
            if candidates.len() < MOST_ENDS
                && !candidates.iter().any(|other| is_near(task, &other.state, &state, &[], SAME_BASIN))
            {
                let mean = found.rms_residual / compared;
                let is_far = mean > FAR.max(ENOUGH_FAR * enough)
                    || mean > FAR_FROM_BEST * enough.max(least / compared);
                candidates.push(Candidate { state, steps: found.steps, refused: found.refused, is_far });
            }
        }
        Candidates { all: candidates, is_met_by_most }
    }

    pub(super) fn segments<'t>(
        &self,
        task: &'t Task<'_>,
        belief: &[f64],
        rows: &Range<usize>,
        clamped: &[usize],
    ) -> Segments<'t> {
        let (model, times) = (&task.full, task.signals.times());
        let base = task.full_state(belief, rows.start);
        let at_rest = |place: &usize| model.is_constant_state(*place);
        let free: Vec<usize> =
            (0..base.len()).filter(|place| !clamped.contains(place) || !at_rest(place)).collect();
        let (constant, moving) = free.into_iter().partition(at_rest);
        let read: Vec<Vec<f64>> = rows.clone().map(|row| task.measurements(row)).collect();
        let spread_of = |values: Vec<f64>| {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let least = (1e-6 * low.abs().max(high.abs())).max(task.sigma);
            // nothing is known of an output that was not measured here
            if high < low { task.sigma } else { ((high - low) / 2.0).max(least) }
        };
        // an implicit output has no measurement: its size is that at the guess
        let first = task.full_flow().follow(&base, &[], &times[rows.start..=rows.start], super::Order::Value);
        let guessed = first.ok().and_then(|mut samples| Some(samples.pop()?.outputs)).unwrap_or_default();
        let spread = (0..model.outputs.len()).map(|output| match guessed.get(output) {
            Some(size) if model.is_implicit(output) && *size != 0.0 => size.abs().max(task.sigma),
            _ if model.is_implicit(output) => 1.0,
            _ => spread_of(read.iter().map(|row| row[output]).collect()),
        });
        let size = |place: usize| {
            let own = task.sizes.get(place).copied();
            let sampled = range(task, place).map(|([low, high], _)| (high - low) / 2.0);
            let column = || {
                let column = task.signals.column(model.column_of(place)?);
                Some(spread_of(column[rows.clone()].to_vec()))
            };
            // measurements may go far beyond their first value
            let size = sampled.or(own).unwrap_or(0.0).max(column().unwrap_or(0.0));
            if size > 0.0 { size } else { 1.0 }
        };
        let sizes: Vec<f64> = (0..base.len()).map(size).collect();
        let least = sizes.iter().copied().fold(1.0, f64::min);
        let steps = rows.len() - 1;
        let count = self.shooting.segments.clamp(1, steps.max(1));
        let joint = |i: usize| steps * i / count;
        Segments {
            flow: super::ModelFlow {
                tolerance: (TOLERANCE * least).max(task.tolerance),
                stride: super::Stride::ByTolerance,
                ..task.full_flow()
            },
            times: &times[rows.clone()],
            spread: spread.collect(),
            measured: read,
            rows: (0..count).map(|i| joint(i)..joint(i + 1) + 1).collect(),
            moving,
            constant,
            sizes,
            base,
        }
    }
}

/// Updates whose first one took the time since then.
fn timed(mut updates: Vec<Update>, begin: Instant) -> Vec<Update> {
    if let Some(update) = updates.first_mut() {
        update.seconds = begin.elapsed().as_secs_f64();
    }
    updates
}

/// Whether two states are one: within a part of the sizes, or some deviations; angles but for whole turns.
fn is_near(task: &Task<'_>, a: &[f64], b: &[f64], deviations: &[f64], part: f64) -> bool {
    (0..a.len()).all(|i| {
        let apart = a[i] - b[i];
        let apart = if is_angle(task, i) { (apart + PI).rem_euclid(TAU) - PI } else { apart };
        let deviation = deviations.get(i).copied().unwrap_or(0.0);
        let room = part * task.sizes[i] + if deviation.is_finite() { SAME.1 * deviation } else { 0.0 };
        apart.abs() <= room
    })
}

/// Whether two updates came to one state.
fn is_one(task: &Task<'_>, a: &Update, b: &Update) -> bool {
    let deviations: Vec<f64> = a.deviations.iter().zip(&b.deviations).map(|(a, b)| a + b).collect();
    is_near(task, &a.estimate, &b.estimate, &deviations, SAME.0)
}

/// Keeps an update that is none of those that are there.
fn keep(task: &Task<'_>, updates: &mut Vec<Update>, update: Update) {
    if !updates.iter().any(|other| is_one(task, other, &update)) {
        updates.push(update);
    }
}

/// How far a state lies outside of the sample box, in widths of it.
fn outside(task: &Task<'_>, update: &Update) -> f64 {
    let one = |(place, value): (usize, &f64)| match range(task, place).filter(|_| !is_angle(task, place)) {
        Some(([low, high], true)) => {
            let deviation =
                update.deviations.get(place).copied().filter(|own| own.is_finite()).unwrap_or(0.0);
            let room = SAME.1 * deviation + SAME.0 * (high - low);
            ((low - value).max(value - high) - room).max(0.0) / (high - low)
        }
        _ => 0.0,
    };
    update.estimate.iter().enumerate().map(one).fold(0.0, f64::max)
}

/// Whether an update ends the search for others: what lies outside of the sample box is an answer only where nothing within is one.
fn is_answer(task: &Task<'_>, update: &Update) -> bool {
    update.is_borne_out() && outside(task, update) <= 0.0
}

/// What fits first, of it what lies in the sample box; by the least error. What fits outside of the box is given only where nothing
/// fits inside, and what does not fit only where nothing does.
fn best_first(task: &Task<'_>, mut updates: Vec<Update>) -> Vec<Update> {
    let key = |update: &Update| {
        let is_out = outside(task, update) > 0.0;
        let standing = match update.end {
            _ if update.is_borne_out() => 0,
            UpdateEnd::DoesNotFit | UpdateEnd::Stuck | UpdateEnd::Converged => 1,
            UpdateEnd::StepsSpent => 2,
            UpdateEnd::Unobservable { .. } => 3,
            UpdateEnd::Lost(_) => 4,
        };
        (standing, is_out)
    };
    updates.sort_by(|a, b| key(a).cmp(&key(b)).then(a.cost.total_cmp(&b.cost)));
    let Some(best) = updates.first().map(key) else { return updates };
    updates.retain(|update| key(update) == best);
    if best.0 > 0 {
        updates.truncate(1);
    }
    updates
}

impl Observer for MultipleShooting {
    fn observe(&self, task: &Task<'_>) -> Track {
        let ending = self.ending();
        let all = MovingWindow { window: task.signals.times().len(), ..ending };
        let windows = if task.whole { &all } else { &ending };
        windows.observe_by(task, |belief, rows, clamped, learned| {
            // what was learned is where the next window begins; it starts anew where that does not fit
            let is_known = task.learned.is_some() || rows.start > 0;
            let inherited = (is_known && learned.sees).then(|| ending.update(task, belief, rows, clamped));
            let mut found = match inherited.filter(Update::is_borne_out) {
                Some(update) => vec![update],
                None => self.solutions(task, belief, rows, clamped),
            };
            let mut update = found.remove(0);
            // what errs in the columns that drive the model is not among the suspects: that is for the windows that weigh it
            if !learned.is_asked && is_asked(&update) && !weights::are_needed(task) {
                let window = MovingWindow::window(task, belief, rows, clamped);
                update.suspects = suspects(task, &window, &update, windows.alarm(task));
            }
            (update, found)
        })
    }
}
