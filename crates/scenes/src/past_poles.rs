//! Windows on which the thesis's state fails, estimated by the constraint instead.
//!
//! Where a palm and the body turn at one rate the contacts' rates have a pole in the thesis's state, and a search on a window that holds such a moment is lost a few
//! thousandths off the truth. The constraint behind it has none: the body's point at the contact does not enter the palm, `0 = v_i - omega0 d_i - w_i s_i`, with `v_i` the
//! velocity of the centre of mass along the palm's normal. So, where a scene between flat palms gives no first guess, a window that none of the measurements
//! bear out is estimated again by itself, from its own measurements without a guess: with the thesis's state, unless the rank shows that this motion meets
//! a pole, and then with the constraint's. The report says which one has answered.

use super::groundwork::{Groundwork, Steady};
use super::run::Experiment;
use super::scene::{Guess, Method};
use crate::motion_rank::MotionRank;
use palmistry_bodies::mechanics::Palm;
use palmistry_lang::System;
use palmistry_observe::{NoiseFrom, Objection, ReadRecord, SampleEstimate, Seam, Track, Update, UpdateEnd};
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// The equations of `proofs/moll2002/constraint/palms.proof`, which proves their relation to those of the thesis.
pub const EQUATIONS: &str = include_str!("palms.proof");

/// What its observer estimates, beside `rho` where that is estimated.
const SOUGHT: [&str; 5] = ["r1", "r2", "omega0", "v1", "v2"];

/// In m/s^2.
const GRAVITY: f64 = 9.81;

/// An observer of a single window.
struct Alone<'a> {
    experiment: &'a Experiment,
    /// The rank of its equations, made at the first window.
    rank: Option<MotionRank>,
}

/// The estimate of a window.
struct Found {
    update: Update,
    /// The states sample by sample, and their deviations.
    moments: Vec<[Vec<f64>; 2]>,
}

impl Experiment {
    /// Estimates again the windows of a track that the measurements do not bear out.
    pub(super) fn pass_poles(&self, method: Method, track: &mut Track, interrupt: &AtomicBool) {
        if !self.may_pass_poles(method) || track.updates.iter().all(Update::is_borne_out) {
            return;
        }
        let Some(other) = self.by_constraint() else { return };
        let mut own = Alone { experiment: self, rank: None };
        let mut other = Alone { experiment: &other, rank: None };
        let mut replaced = Vec::new();
        for place in 0..track.updates.len() {
            let update = &track.updates[place];
            let is_last = track.updates.get(place + 1).is_none_or(|next| next.from > update.from);
            // uninformative where the measurements do not bear it out says nothing of the truth
            let is_unobservable =
                matches!(update.end, UpdateEnd::Unobservable { .. }) && update.fit.is_none_or(|fit| fit.fits);
            let is_lost = !update.is_borne_out() && !is_unobservable;
            let Some(rows) = self.rows(update).filter(|_| is_last && is_lost) else { continue };
            if interrupt.load(Ordering::Relaxed) {
                break;
            }
            let pole = match own.answer(&rows, method, interrupt) {
                Ok(found) => {
                    self.replace(track, place, &rows, found);
                    replaced.push(place);
                    let from = track.updates[place].from;
                    track.remarks.push(format!(
                        "from {from:.3} s begun anew, from what this window determines without a guess"
                    ));
                    continue;
                }
                Err(objection) => objection,
            };
            if let Ok(found) = other.answer(&rows, method, interrupt) {
                self.replace(track, place, &rows, found);
                replaced.push(place);
                let from = track.updates[place].from;
                let why = match pole {
                    Some(objection) => format!("this state has {objection}"),
                    None => "this state was lost".to_owned(),
                };
                track.remarks.push(format!(
                    "from {from:.3} s answered by the one constraint, whose state has no pole there: {why}"
                ));
            }
        }
        self.meet_again(track, &replaced);
    }

    /// Tests the seams at both ends of the windows that were replaced. What their errors have in common with those of their neighbours is not known: the
    /// measurement that two windows share, and what a window has inherited of one that is gone.
    fn meet_again(&self, track: &mut Track, replaced: &[usize]) {
        let seam = |from: usize, to: usize| {
            let [before, after] = [&track.updates[from], &track.updates[to]];
            let is_known = |own: &Update| {
                own.is_borne_out() && own.fit.is_some_and(|fit| fit.from != NoiseFrom::Computation)
            };
            let meet = before.to == after.from && is_known(before) && is_known(after);
            let row = self.rows(after).filter(|_| meet)?.start;
            let end = track.estimates.get(row)?;
            let [end, begin] = [[&end.state[..], &end.deviations], [&after.estimate[..], &after.deviations]];
            Seam::of_any_correlation(after.from, end, begin)
        };
        let last =
            |place: usize| (0..place).rev().find(|own| track.updates[*own].from < track.updates[place].from);
        let pairs = replaced.iter().flat_map(|place| [Some(*place), place.checked_add(1)]).flatten();
        let seams: Vec<(usize, Option<Seam>)> = pairs
            .filter(|place| *place < track.updates.len())
            .map(|place| (place, last(place).and_then(|before| seam(before, place))))
            .collect();
        for (place, seam) in seams {
            track.updates[place].seam = seam;
        }
    }

    /// Whether the scene is one between flat palms without friction, without a first guess, by windows, and estimates no more than the constraint determines.
    fn may_pass_poles(&self, method: Method) -> bool {
        let names = self.names();
        let settings = &self.scene.observer;
        let tells = |name: &&str| ["r1", "r2", "omega0", "rho"].contains(name);
        let smooth = self.scene.simulated.as_ref().is_none_or(|simulated| simulated.palms.friction == 0.0);
        let flat = self.scene.palm_forms == [Palm::Flat; 2]
            && ["b1", "b2"].iter().all(|name| self.system.find_symbol(name).is_none());
        method.search().is_some()
            && settings.guess == Guess::None
            && !settings.whole
            && smooth
            && flat
            && names.iter().all(tells)
            && SOUGHT[..3].iter().all(|name| names.contains(name))
    }

    /// The same measurements with the constraint's system; none where a measurement is missing that it needs.
    fn by_constraint(&self) -> Option<Experiment> {
        let system = System::parse("palms.proof", EQUATIONS, Path::new("")).ok()?;
        let mut scene = self.scene.clone();
        let settings = &mut scene.observer;
        let gyration = settings.estimate.iter().filter(|name| *name == "rho").cloned();
        settings.estimate = SOUGHT.iter().map(|name| (*name).to_owned()).chain(gyration).collect();
        settings.inputs.clear();
        settings.clamp.clear();
        settings.known.retain(|name, _| system.find_symbol(name.split('.').next().unwrap_or(name)).is_some());
        scene.columns.clear();
        let ground = Groundwork::with_system(scene, system, false).ok()?;
        let reading = ReadRecord::whole(self.record.clone());
        Experiment::with_measurements(ground, reading, None, Steady::AreConstants).ok()
    }

    /// The rows of an update's window.
    fn rows(&self, update: &Update) -> Option<Range<usize>> {
        let row = |time: f64| self.signals.times().iter().position(|other| *other == time);
        Some(row(update.from)?..row(update.to)? + 1)
    }

    /// Replaces the update and the estimates of a window by those that were found.
    fn replace(&self, track: &mut Track, place: usize, rows: &Range<usize>, found: Found) {
        let before = &track.updates[place];
        if matches!(before.end, UpdateEnd::Lost(_)) {
            track.unobserved = track.unobserved.saturating_sub(rows.len() - 1);
        }
        let outputs = before.outputs.clone();
        track.updates[place] = Update { outputs, ..found.update };
        // the sample that two windows share belongs to the first of them
        let first = if rows.start == 0 { 0 } else { rows.start + 1 };
        for (row, [state, deviations]) in rows.clone().zip(found.moments) {
            if let Some(own) = track.estimates.get_mut(row).filter(|_| row >= first) {
                *own = SampleEstimate { time: own.time, state, deviations, residual: Vec::new() };
            }
        }
    }
}

impl Alone<'_> {
    /// The state of a window that the measurements bear out, by the thesis's names of the estimated states.
    ///
    /// # Errors
    /// That there is none, and what the rank objects to, if anything.
    fn answer(
        &mut self,
        rows: &Range<usize>,
        method: Method,
        interrupt: &AtomicBool,
    ) -> Result<Found, Option<Objection>> {
        let own = self.experiment.window_of(rows.start, rows.len() - 1).map_err(|_| None)?;
        let start = own.determined_by_palms(true).ok_or(None)?;
        let mut task = own.task(interrupt).map_err(|_| None)?;
        let rank = self.rank.get_or_insert_with(|| MotionRank::new(&task, &start));
        // the bound of the window says how well it is observable
        if let Some(objection) = rank.along(&task, &start).objection(f64::INFINITY) {
            return Err(Some(objection));
        }
        let names = own.names();
        task.guess.clone_from(&start);
        // the rate at which a body of this size swings: a slower turn or motion is as observable
        let rate = (GRAVITY / start[0].abs().max(f64::MIN_POSITIVE)).sqrt();
        for ((name, size), value) in names.iter().zip(&mut task.sizes).zip(&start) {
            let natural = match *name {
                "omega0" => rate,
                "v1" | "v2" => rate * start[0].abs(),
                _ => 0.0,
            };
            *size = natural.max(value.abs());
        }
        let track = own.observer(method).observe(&task);
        let sought: Vec<usize> =
            (0..names.len()).filter(|place| !["v1", "v2"].contains(&names[*place])).collect();
        let part = |all: &[f64]| sought.iter().map(|place| all[*place]).collect::<Vec<f64>>();
        let update = track.updates.iter().find(|update| update.is_borne_out()).ok_or(None)?;
        let estimate = part(&update.estimate);
        let deviations = part(&update.deviations);
        let known = |all: &[f64]| if all.is_empty() { Vec::new() } else { part(all) };
        let moments = track.estimates.iter().map(|at| [part(&at.state), known(&at.deviations)]).collect();
        let at = |(place, bound): &(usize, f64)| Some((sought.iter().position(|own| own == place)?, *bound));
        let at_bounds = update.at_bounds.iter().filter_map(at).collect();
        // the covariance is that of the other state, and the seam is found where all windows are
        let (covariance, seam) = (None, None);
        let update = Update { estimate, deviations, at_bounds, covariance, seam, ..update.clone() };
        Ok(Found { update, moments })
    }
}
