//! The cheapest observer that is accurate enough, or the most accurate one within a time.
//!
//! Two windows of half of the samples, all samples at once, and windows of fewer and fewer samples are tried on the measurements themselves, in the order of what they
//! cost as a rule: each window begins a search of its own, short ones tell less, and the search for all samples grows to them. An accuracy is the largest standard
//! deviation of an estimated state at the last sample, in units of the size of that state; only an answer that passes its test of fit has one.
//!
//! Filters are not among them. They are quicker, but their covariance is that of the linearised model from a first guess on: of 60 drawn tasks seven had an estimate more than
//! five of its deviations off although the innovations passed. Newton's method is left out, since the region of trust takes the same steps where these are good; so are the
//! plain integration, which has no deviations, and the high-gain observer, whose gain has to be chosen.

use super::groundwork::sample_range;
use super::run::Experiment;
use super::scene::{Guess, Method, SceneError};
use palmistry_observe::{Track, Update};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// What is asked of an observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sufficient {
    /// The standard deviation of each estimated state at the last sample, in units of its size, is at most this.
    Accuracy(f64),
    /// All of the estimate takes at most this long, in s.
    Within(f64),
}

/// An observer that was tried.
#[derive(Clone, Debug, PartialEq)]
pub struct TriedObserver {
    /// The method.
    pub method: Method,
    /// The samples of a window; none where all samples are one.
    pub window: Option<usize>,
    /// The wall-clock time of its estimates, in s.
    pub seconds: f64,
    /// Whether its answer passes its test of fit.
    pub passes: bool,
    /// Its accuracy; infinite where the measurements do not determine a state, or its answer does not pass.
    pub accuracy: f64,
}

/// The observers that were tried, and which of them suffices.
#[derive(Clone, Debug, PartialEq)]
pub struct ObserverChoice {
    /// What was asked for.
    pub asked: Sufficient,
    /// What was tried, in this order.
    pub tried: Vec<TriedObserver>,
    /// Whether what is chosen is as it was asked for; else it is the nearest to that.
    pub suffices: bool,
    /// Which is chosen: none where no answer passes.
    pub chosen: Option<usize>,
    /// The first that was tried and is more accurate.
    pub better: Option<usize>,
}

/// A window has so many measurements for each unknown at least.
const FEWEST: usize = 4;
/// And so many samples.
const FEWEST_SAMPLES: usize = 8;

/// The steps of a window at most, where the scene allows fewer: a search that ends too early says nothing of what its window could tell.
const STEPS: usize = 50;

/// What takes less than this is timed three times over, in s.
const SHORT: f64 = 0.02;

/// So many observers one after the other may take too long before no further one is tried: a longer window may be quicker.
const TOO_SLOW: usize = 2;

impl Experiment {
    /// Tries observers on the measurements until one suffices, and one more; `done` is called after each. Where an accuracy is asked for the choice does not depend on times.
    ///
    /// # Errors
    /// As [`Experiment::task`].
    pub fn choose(
        &self,
        asked: Sufficient,
        interrupt: &AtomicBool,
        done: &dyn Fn(&TriedObserver),
    ) -> Result<ObserverChoice, SceneError> {
        let mut tried: Vec<TriedObserver> = Vec::new();
        let (mut slow, mut enough) = (0, false);
        for (method, window) in self.observers_to_try()? {
            let found = self.with(method, window).tried(window, interrupt)?;
            done(&found);
            let is_last = enough;
            match asked {
                Sufficient::Accuracy(accuracy) => enough |= found.accuracy <= accuracy,
                Sufficient::Within(time) if found.seconds > time => {
                    slow += 1;
                    enough |= slow == TOO_SLOW;
                }
                Sufficient::Within(_) => slow = 0,
            }
            tried.push(found);
            let is_done = match asked {
                Sufficient::Accuracy(_) => is_last,
                Sufficient::Within(_) => enough,
            };
            if is_done || interrupt.load(Ordering::Relaxed) {
                break;
            }
        }
        Ok(ObserverChoice::of(asked, tried))
    }

    /// The scene with one of the observers that were tried.
    #[must_use]
    pub fn chosen(&self, observer: &TriedObserver) -> Experiment {
        self.with(observer.method, observer.window)
    }

    fn with(&self, method: Method, window: Option<usize>) -> Experiment {
        let mut own = self.clone();
        let settings = &mut own.scene.observer;
        settings.methods = vec![method];
        settings.steps = settings.steps.max(STEPS);
        settings.whole = window.is_none();
        settings.window = window.unwrap_or(settings.window);
        own
    }

    /// Methods with their windows, in the order of what they cost as a rule.
    fn observers_to_try(&self) -> Result<Vec<(Method, Option<usize>)>, SceneError> {
        // without a guess a search begins at several states of the ranges
        let by_windows = match self.scene.observer.guess {
            Guess::Sample => Method::MultipleShooting,
            Guess::Values(_) | Guess::Off(_) | Guess::None => Method::TrustRegion,
        };
        let interrupt = AtomicBool::new(false);
        let task = self.task(&interrupt)?;
        let samples = self.signals.times().len();
        let outputs = task.full.outputs.len().max(1);
        let mut window = (FEWEST * task.full.states.len()).div_ceil(outputs).max(FEWEST_SAMPLES);
        let mut windows = Vec::new();
        while 2 * window < samples {
            windows.push((by_windows, Some(window)));
            window *= 2;
        }
        windows.reverse();
        windows.insert(windows.len().min(1), (by_windows, None));
        Ok(windows)
    }

    /// The scene's first method, tried.
    fn tried(&self, window: Option<usize>, interrupt: &AtomicBool) -> Result<TriedObserver, SceneError> {
        let method = self.scene.observer.methods[0];
        let task = self.task(interrupt)?;
        let observer = self.observer(method);
        let once = || {
            let begin = Instant::now();
            let track = observer.observe(&task);
            (track, begin.elapsed().as_secs_f64())
        };
        let (track, mut seconds) = once();
        if seconds < SHORT {
            seconds = seconds.min(once().1).min(once().1);
        }
        let passes = track.is_sound() && track.updates.last().is_some_and(Update::is_borne_out);
        let accuracy = if passes { self.accuracy(&track) } else { f64::INFINITY };
        Ok(TriedObserver { method, window, seconds, passes, accuracy })
    }

    /// The largest standard deviation at the last sample, in units of the largest absolute value of the state, or of half its range where that is zero.
    fn accuracy(&self, track: &Track) -> f64 {
        let Some(last) = track.last().filter(|last| last.deviations.len() == last.state.len()) else {
            return f64::INFINITY;
        };
        let of = |(place, (name, deviation)): (usize, (&str, &f64))| {
            let values = track.estimates.iter().filter_map(|estimate| estimate.state.get(place));
            let size = values.fold(0.0f64, |size, value| size.max(value.abs()));
            let half = || sample_range(&self.system, name).map_or(0.0, |[low, high]| (high - low) / 2.0);
            let size = if size > 0.0 { size } else { half() };
            match deviation / size {
                part if part.is_nan() => f64::INFINITY,
                part => part,
            }
        };
        self.names().into_iter().zip(&last.deviations).enumerate().map(of).fold(0.0, f64::max)
    }
}

impl ObserverChoice {
    fn of(asked: Sufficient, tried: Vec<TriedObserver>) -> ObserverChoice {
        let passing = || (0..tried.len()).filter(|place| tried[*place].accuracy.is_finite());
        let finest = |places: &mut dyn Iterator<Item = usize>| {
            places.min_by(|a, b| tried[*a].accuracy.total_cmp(&tried[*b].accuracy))
        };
        let (within, otherwise) = match asked {
            Sufficient::Accuracy(accuracy) => {
                let mut within = passing().filter(|place| tried[*place].accuracy <= accuracy);
                // the first: the order is that of costs, and times are no part of an answer
                (within.next(), finest(&mut passing()))
            }
            Sufficient::Within(time) => {
                let within = finest(&mut passing().filter(|place| tried[*place].seconds <= time));
                let quickest = passing().min_by(|a, b| tried[*a].seconds.total_cmp(&tried[*b].seconds));
                (within, quickest)
            }
        };
        let chosen = within.or(otherwise);
        let better =
            chosen.and_then(|chosen| passing().find(|place| tried[*place].accuracy < tried[chosen].accuracy));
        ObserverChoice { asked, suffices: within.is_some(), chosen, better, tried }
    }
}
