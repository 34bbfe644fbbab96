//! Several observers of one motion, of which the rank decides in each window who may answer (section 6.2 asks for several, section 4.5 for other
//! methods near singularities).
//!
//! All of them are right, and none is so everywhere: where a palm and the body turn at one rate the state of the thesis has a pole, and the rank of the
//! codistribution falls on sets of its own for each choice of states. So the rank is computed along the motion that is predicted for a window,
//! for one observer after the other in the order of the scene ([`MotionRank`]). One that meets a pole, whose rank is short or whose condition exceeds the
//! scene's limit anywhere in the window is skipped. The first that may answer and whose answer fits the measurements, and whose own motion the rank does not
//! object to either, answers the window; where the measurements do not bear it out the next is tried.

use super::modes::{ModeEstimate, ModeWindow};
use super::run::Experiment;
use super::scene::{Guess, SceneError};
use super::unguided::Unguided;
use crate::motion_rank::MotionRank;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

impl Experiment {
    /// The answers of the observers of the scene, window by window, where the rank decides who answers; `done` is called after each window.
    ///
    /// # Errors
    /// As [`Experiment::task`], of any observer.
    pub fn run_switched(
        &self,
        interrupt: &AtomicBool,
        done: &dyn Fn(),
    ) -> Result<Vec<ModeWindow>, SceneError> {
        let limit = self.scene.observer.switch.unwrap_or_default().condition;
        let modes = self.modes()?;
        self.has_windows()?;
        let (times, window) = (self.signals.times(), self.steps_of_windows());
        let mut ranks: Vec<Option<MotionRank>> = modes.iter().map(|_| None).collect();
        // the last state of the observer that answered last, by the names of its states
        let mut learned: BTreeMap<String, f64> = BTreeMap::new();
        let mut windows = Vec::new();
        for first in (0..times.len() - window).step_by(window) {
            let (mut estimates, mut chosen) = (Vec::new(), None);
            for (place, (name, mode)) in modes.iter().enumerate() {
                let own = mode.window_of(first, window)?;
                let reached: Option<Vec<f64>> =
                    own.names().iter().map(|name| learned.get(*name).copied()).collect();
                let told = own.determined_by_palms(self.scene.observer.guess == Guess::None);
                // the window's own estimate is nearer than any state of the sample box
                let starts: Vec<Vec<f64>> = match told {
                    Some(told) => std::iter::once(told).chain(reached).collect(),
                    None => own.starts(&learned, reached),
                };
                let task = own.task(interrupt)?;
                let rank = ranks[place].get_or_insert_with(|| MotionRank::new(&task, &starts[0]));
                let foretold = rank.along(&task, &starts[0]);
                let mut estimate = ModeEstimate {
                    name: name.clone(),
                    estimated: own.names().into_iter().map(str::to_owned).collect(),
                    update: None,
                    objection: foretold.objection(limit),
                    rank: Some(foretold),
                };
                let mut came_to = None;
                if estimate.objection.is_none() {
                    (estimate.update, came_to) = own.search(starts, interrupt)?;
                    if let Some(update) = estimate.update.as_ref().filter(|update| update.is_borne_out()) {
                        let found = rank.along(&task, &update.estimate);
                        estimate.objection = found.objection(limit);
                        estimate.rank = Some(found);
                    }
                }
                let answers = estimate.objection.is_none() && estimate.fits();
                if answers {
                    chosen = Some(place);
                    learned = estimate.estimated.iter().cloned().zip(came_to.unwrap_or_default()).collect();
                }
                estimates.push(estimate);
                if answers || interrupt.load(Ordering::Relaxed) {
                    break;
                }
            }
            let (from, to) = (times[first], times[first + window]);
            windows.push(ModeWindow { from, to, estimates, chosen, true_modes: self.true_modes(from, to) });
            done();
            if interrupt.load(Ordering::Relaxed) {
                break;
            }
        }
        Ok(windows)
    }

    /// The state at the first sample that the measurements between palms determine without a guess, in this observer's own terms; where that is `asked`, and
    /// all estimated states are among those determined.
    pub(super) fn determined_by_palms(&self, asked: bool) -> Option<Vec<f64>> {
        if !asked {
            return None;
        }
        let found = Unguided::of(&self.scene, &self.system, &self.question.known, &self.signals).ok()?;
        self.names().iter().map(|name| found.value(&self.scene, name).ok()).collect()
    }
}
