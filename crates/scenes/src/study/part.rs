//! Stretches of a scene's studies: the results of some of their trials, and how they are merged.
//!
//! The trials of all studies of a scene stand one after the other: draws of noise, then first guesses, then bounds between other palms.

use super::super::run::Experiment;
use super::super::scene::SceneError;
use super::basin::{Basin, BasinTrials};
use super::curvature::{CurvatureMap, CurvatureTrials, WindowBound};
use super::noise::{NoiseLevel, NoiseTrials, Trial};
use palmistry_io::parts::{NoCover, in_order};
use palmistry_rank::sweep::Fingerprint;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// The results of some trials of a scene's studies.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyPart {
    /// Fingerprints of the question and of the measurements.
    pub(super) asked: u64,
    pub(super) measurements: u64,
    /// The number of trials of all studies.
    pub(super) trials: u64,
    /// The first of those that were made, and the one after the last.
    pub(super) first: u64,
    pub(super) last: u64,
    pub(super) noise: Vec<Trial>,
    pub(super) arrives: Vec<bool>,
    pub(super) bounds: Vec<WindowBound>,
}

/// The results of all trials of a scene's studies; empty for studies that it does not have.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Studied {
    /// The error over noise.
    pub noise: Vec<NoiseLevel>,
    /// From where each method converges to the truth.
    pub basins: Vec<Basin>,
    /// The bounds between palms of other curvatures.
    pub curvature: Option<CurvatureMap>,
}

impl Studied {
    /// Whether nothing was studied.
    pub fn is_empty(&self) -> bool {
        self.noise.is_empty() && self.basins.is_empty() && self.curvature.is_none()
    }
}

impl StudyPart {
    /// The indices of its trials.
    pub fn range(&self) -> Range<u64> {
        self.first..self.last
    }

    /// The fingerprint of the question, as [`Studies::fingerprint`] gives it.
    pub fn fingerprint(&self) -> u64 {
        self.asked
    }
}

/// Why parts cannot be merged. Parts are called by the names that they were given.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)] // names and messages say it
pub enum StudyMergeError {
    #[error("there are no parts")]
    NoParts,
    #[error(
        "{0} belongs to another question: another scene, model or seed, or another version of this program"
    )]
    OtherQuestion(String),
    #[error(
        "{0} was made from other measurements: by another build of this program, or on a machine whose arithmetic rounds otherwise"
    )]
    OtherReadings(String),
    #[error("no part has the trials {} to {}", .0.start, .0.end.saturating_sub(1))]
    Gap(Range<u64>),
    #[error("{one} and {other} both have the trials {} to {}", .trials.start, .trials.end.saturating_sub(1))]
    Overlap { one: String, other: String, trials: Range<u64> },
    #[error("{0} is damaged: its numbers contradict each other")]
    Contradicts(String),
}

impl From<NoCover> for StudyMergeError {
    fn from(why: NoCover) -> StudyMergeError {
        match why {
            NoCover::Gap(trials) => StudyMergeError::Gap(trials),
            NoCover::Overlap { one, other, both } => StudyMergeError::Overlap { one, other, trials: both },
        }
    }
}

/// The studies of a scene, ready to make trials of any stretch, and to merge the results of all.
pub struct Studies<'a> {
    experiment: &'a Experiment,
    noise: Option<NoiseTrials<'a>>,
    basins: Option<BasinTrials<'a>>,
    curvature: Option<CurvatureTrials<'a>>,
    asked: u64,
    measurements: u64,
}

impl<'a> Studies<'a> {
    /// The studies of a scene, possibly none. They need the truth: with measurements from a file there is none.
    ///
    /// # Errors
    /// As [`Experiment::task`], or where a study asks for states that are not estimated.
    pub fn new(experiment: &'a Experiment, interrupt: &'a AtomicBool) -> Result<Studies<'a>, SceneError> {
        let study = &experiment.scene.study;
        let of_noise = experiment.simulated().zip(study.noise.as_ref());
        let noise = of_noise
            .map(|(simulation, study)| NoiseTrials::new(experiment, simulation, study, interrupt))
            .transpose()?;
        let of_guesses = study.basin.as_ref().filter(|_| experiment.simulated().is_some());
        let basins = of_guesses.map(|study| BasinTrials::new(experiment, study, interrupt)).transpose()?;
        let of_palms = study.curvature.as_ref().filter(|_| experiment.simulated().is_some());
        let curvature = of_palms.map(|study| CurvatureTrials::new(experiment, study)).transpose()?;
        let (asked, measurements) = (asked(experiment), measurements(experiment));
        Ok(Studies { experiment, noise, basins, curvature, asked, measurements })
    }

    /// The fingerprint of the question: the version of the program, the text of the scene and of its model with the other files that it
    /// imports, and the seed.
    pub fn fingerprint(&self) -> u64 {
        self.asked
    }

    /// The number of trials.
    pub fn trials(&self) -> u64 {
        (self.draws() + self.guesses() + self.curvature.as_ref().map_or(0, CurvatureTrials::count)) as u64
    }

    /// The number of draws of noise among them.
    fn draws(&self) -> usize {
        self.noise.as_ref().map_or(0, NoiseTrials::count)
    }

    /// The number of first guesses.
    fn guesses(&self) -> usize {
        self.basins.as_ref().map_or(0, BasinTrials::count)
    }

    /// The draws of noise, the first guesses and the bounds of a stretch of trials, each by their indices among all.
    fn kinds(&self, places: &Range<usize>) -> [Range<usize>; 3] {
        let ends = [0, self.draws(), self.draws() + self.guesses(), self.trials() as usize];
        [0, 1, 2].map(|kind| {
            places.start.clamp(ends[kind], ends[kind + 1])..places.end.clamp(ends[kind], ends[kind + 1])
        })
    }

    /// Makes a stretch of trials, side by side; nothing where that was interrupted. The result of each depends on its place alone.
    /// `done` is called once a trial.
    pub fn part(
        &self,
        places: Range<u64>,
        interrupt: &AtomicBool,
        done: &(dyn Fn() + Sync),
    ) -> Option<StudyPart> {
        let [first, last] = [places.start, places.end].map(|place| place.min(self.trials()));
        let places = first as usize..last as usize;
        let [draws, guesses, bounds] = self.kinds(&places);
        let goes_on = || !interrupt.load(Ordering::Relaxed);
        let of_noise = |place: usize| {
            let trial = self.noise.as_ref().filter(|_| goes_on())?.trial(place);
            done();
            Some(trial)
        };
        let of_guess = |place: usize| {
            let arrives = self.basins.as_ref().filter(|_| goes_on())?.trial(place - self.draws());
            done();
            Some(arrives)
        };
        let of_palms = |place: usize| {
            let of = self.curvature.as_ref().filter(|_| goes_on())?;
            let bounds = of.trial(place - self.draws() - self.guesses());
            done();
            Some(bounds)
        };
        let noise = draws.into_par_iter().map(of_noise).collect::<Option<Vec<Trial>>>()?;
        let arrives = guesses.into_par_iter().map(of_guess).collect::<Option<Vec<bool>>>()?;
        let bounds = bounds.into_par_iter().map(of_palms).collect::<Option<Vec<WindowBound>>>()?;
        // an interrupted trial has another result
        goes_on().then_some(StudyPart {
            asked: self.asked,
            measurements: self.measurements,
            trials: self.trials(),
            first,
            last,
            noise,
            arrives,
            bounds,
        })
    }

    /// Merges parts that together are all trials, each once and in any order: the results of [`noise_study`](super::noise_study),
    /// [`basins`](super::basins) and [`curvature_map`](super::curvature_map) in one run, to the last bit.
    ///
    /// # Errors
    /// Parts with gaps or overlaps, of another question, or from other measurements.
    pub fn merge(&self, parts: Vec<(String, StudyPart)>) -> Result<Studied, StudyMergeError> {
        if parts.is_empty() {
            return Err(StudyMergeError::NoParts);
        }
        let sought = self.experiment.names().len();
        for (name, part) in &parts {
            if part.asked != self.asked || part.trials != self.trials() {
                return Err(StudyMergeError::OtherQuestion(name.clone()));
            }
            if part.measurements != self.measurements {
                return Err(StudyMergeError::OtherReadings(name.clone()));
            }
            let kinds = self.kinds(&(part.first as usize..part.last as usize));
            let lengths = [part.noise.len(), part.arrives.len(), part.bounds.len()];
            let has_all = |trial: &Trial| trial.estimate().is_none_or(|estimate| estimate.len() == sought);
            if kinds.map(|places| places.len()) != lengths || !part.noise.iter().all(has_all) {
                return Err(StudyMergeError::Contradicts(name.clone()));
            }
        }
        let (mut noise, mut arrives, mut bounds) = (Vec::new(), Vec::new(), Vec::new());
        for (_, part) in in_order(parts, StudyPart::range, self.trials())? {
            noise.extend(part.noise);
            arrives.extend(part.arrives.into_iter().map(Some));
            bounds.extend(part.bounds.into_iter().map(Some));
        }
        Ok(Studied {
            noise: self.noise.as_ref().map_or_else(Vec::new, |all| all.levels(&noise)),
            basins: self.basins.as_ref().map_or_else(Vec::new, |all| all.basins(&arrives)),
            curvature: self.curvature.as_ref().map(|all| all.map(&bounds)),
        })
    }
}

/// The fingerprint of the question.
fn asked(experiment: &Experiment) -> u64 {
    let mut found = Fingerprint::default();
    found.system(&experiment.system);
    found.text(experiment.scene.text());
    found.text(&experiment.scene.seed.to_string());
    found.value()
}

/// The fingerprint of the measurements and the truth: where it differs, trials have other results.
fn measurements(experiment: &Experiment) -> u64 {
    let mut found = Fingerprint::default();
    let mut numbers = |name: &str, values: &[f64]| {
        found.text(name);
        values.iter().for_each(|value| found.number(*value));
    };
    let signals = &experiment.signals;
    numbers("time", signals.times());
    for (place, name) in signals.names().iter().enumerate() {
        numbers(name, signals.column(place));
    }
    for (name, value) in &experiment.question.guess {
        numbers(name, &[*value]);
    }
    for (name, value) in &experiment.question.known {
        numbers(name, &[*value]);
    }
    for time in signals.times() {
        numbers("truth", &experiment.truth_at(*time).unwrap_or_default());
    }
    found.value()
}
