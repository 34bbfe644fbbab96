//! Stretches of a scene's studies: what came of some of their trials, and what all of them add up to.
//!
//! The trials of all studies of a scene stand one after the other: draws of noise, then first guesses, then bounds between other palms.

use super::super::run::Experiment;
use super::super::scene::SceneError;
use super::basin::{Basin, BasinTrials};
use super::curvature::{CurvatureMap, CurvatureTrials, Told};
use super::noise::{NoiseLevel, NoiseTrials, Trial};
use crate::sweep::{Fingerprint, NoCover, in_order};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// What came of some trials of a scene's studies.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyPart {
    /// What was asked, and what was read, as numbers.
    pub(super) asked: u64,
    pub(super) readings: u64,
    /// How many trials all studies have.
    pub(super) trials: u64,
    /// The first of those that were made, and the one after the last.
    pub(super) first: u64,
    pub(super) last: u64,
    pub(super) noise: Vec<Trial>,
    pub(super) arrives: Vec<bool>,
    pub(super) told: Vec<Told>,
}

/// Of an experiment that was not studied.
pub(crate) static NOT_STUDIED: Studied = Studied { noise: Vec::new(), basins: Vec::new(), curvature: None };

/// What all trials of a scene's studies come to; of those that it does not have nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Studied {
    /// The error over noise.
    pub noise: Vec<NoiseLevel>,
    /// From where each method arrives.
    pub basins: Vec<Basin>,
    /// What palms of other curvatures tell.
    pub curvature: Option<CurvatureMap>,
}

impl Studied {
    /// Whether nothing was studied.
    pub fn is_empty(&self) -> bool {
        self.noise.is_empty() && self.basins.is_empty() && self.curvature.is_none()
    }
}

impl StudyPart {
    /// The places of its trials.
    pub fn range(&self) -> Range<u64> {
        self.first..self.last
    }

    /// What was asked, as [`Studies::fingerprint`] tells it.
    pub fn fingerprint(&self) -> u64 {
        self.asked
    }
}

/// Why parts do not make a whole. Parts are called by the names that they were given.
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
        "{0} was made from other readings: by another build of this program, or on a machine whose arithmetic rounds otherwise"
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

/// The studies of a scene, made ready: to make trials of any stretch, and to say what all of them come to.
pub struct Studies<'a> {
    experiment: &'a Experiment,
    noise: Option<NoiseTrials<'a>>,
    basins: Option<BasinTrials<'a>>,
    curvature: Option<CurvatureTrials<'a>>,
    asked: u64,
    readings: u64,
}

impl<'a> Studies<'a> {
    /// The studies that a scene has, of which there may be none. They need the truth: with readings from a file there is none.
    ///
    /// # Errors
    /// As [`Experiment::task`], or where a study asks for states that are not sought.
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
        let (asked, readings) = (asked(experiment), readings(experiment));
        Ok(Studies { experiment, noise, basins, curvature, asked, readings })
    }

    /// What is asked, as a number: the version of the program, the text of the scene and of its model with what it takes from other
    /// files, and the seed.
    pub fn fingerprint(&self) -> u64 {
        self.asked
    }

    /// How many trials there are.
    pub fn trials(&self) -> u64 {
        (self.draws() + self.guesses() + self.curvature.as_ref().map_or(0, CurvatureTrials::count)) as u64
    }

    /// How many of them are draws of noise.
    fn draws(&self) -> usize {
        self.noise.as_ref().map_or(0, NoiseTrials::count)
    }

    /// How many are first guesses.
    fn guesses(&self) -> usize {
        self.basins.as_ref().map_or(0, BasinTrials::count)
    }

    /// Of a stretch of trials the draws of noise, the first guesses and the bounds, each by their places among all.
    fn kinds(&self, places: &Range<usize>) -> [Range<usize>; 3] {
        let ends = [0, self.draws(), self.draws() + self.guesses(), self.trials() as usize];
        [0, 1, 2].map(|kind| {
            places.start.clamp(ends[kind], ends[kind + 1])..places.end.clamp(ends[kind], ends[kind + 1])
        })
    }

    /// Makes a stretch of trials, side by side; nothing where that was interrupted. What comes of each depends on its place alone.
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
            let told = of.trial(place - self.draws() - self.guesses());
            done();
            Some(told)
        };
        let noise = draws.into_par_iter().map(of_noise).collect::<Option<Vec<Trial>>>()?;
        let arrives = guesses.into_par_iter().map(of_guess).collect::<Option<Vec<bool>>>()?;
        let told = bounds.into_par_iter().map(of_palms).collect::<Option<Vec<Told>>>()?;
        // one that was interrupted on its way came to something else
        goes_on().then_some(StudyPart {
            asked: self.asked,
            readings: self.readings,
            trials: self.trials(),
            first,
            last,
            noise,
            arrives,
            told,
        })
    }

    /// What parts that together are all trials, each once and in any order, come to: what [`noise_study`](super::noise_study),
    /// [`basins`](super::basins) and [`curvature_map`](super::curvature_map) find in one run, to the last bit.
    ///
    /// # Errors
    /// Parts with gaps or overlaps, of another question, or from other readings.
    pub fn merge(&self, parts: Vec<(String, StudyPart)>) -> Result<Studied, StudyMergeError> {
        if parts.is_empty() {
            return Err(StudyMergeError::NoParts);
        }
        let sought = self.experiment.names().len();
        for (name, part) in &parts {
            if part.asked != self.asked || part.trials != self.trials() {
                return Err(StudyMergeError::OtherQuestion(name.clone()));
            }
            if part.readings != self.readings {
                return Err(StudyMergeError::OtherReadings(name.clone()));
            }
            let kinds = self.kinds(&(part.first as usize..part.last as usize));
            let lengths = [part.noise.len(), part.arrives.len(), part.told.len()];
            let has_all = |trial: &Trial| trial.estimate().is_none_or(|estimate| estimate.len() == sought);
            if kinds.map(|places| places.len()) != lengths || !part.noise.iter().all(has_all) {
                return Err(StudyMergeError::Contradicts(name.clone()));
            }
        }
        let (mut noise, mut arrives, mut told) = (Vec::new(), Vec::new(), Vec::new());
        for (_, part) in in_order(parts, StudyPart::range, self.trials())? {
            noise.extend(part.noise);
            arrives.extend(part.arrives.into_iter().map(Some));
            told.extend(part.told.into_iter().map(Some));
        }
        Ok(Studied {
            noise: self.noise.as_ref().map_or_else(Vec::new, |all| all.levels(&noise)),
            basins: self.basins.as_ref().map_or_else(Vec::new, |all| all.basins(&arrives)),
            curvature: self.curvature.as_ref().map(|all| all.map(&told)),
        })
    }
}

/// What is asked, as a number.
fn asked(experiment: &Experiment) -> u64 {
    let mut found = Fingerprint::default();
    found.system(&experiment.system);
    found.text(experiment.scene.text());
    found.text(&experiment.scene.seed.to_string());
    found.value()
}

/// What is read and what is true, as a number: where it differs, trials come to something else.
fn readings(experiment: &Experiment) -> u64 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{Scene, basins, curvature_map, noise_study};
    use crate::sweep::UNINTERRUPTED;
    use std::path::PathBuf;

    /// Two curvatures of each palm in one motion, a window of ten samples: five trials.
    #[test]
    fn a_map_over_curvatures_is_one_run_to_the_last_bit() {
        let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/proofs/moll2002/scenes"));
        let text = std::fs::read_to_string(folder.join("circular_palms.toml")).unwrap();
        let text =
            text.split("[study").next().unwrap().replace("window = 80", "guess_off = 0.1\nwindow = 10");
        let study = "\n[study.curvature]\nrange = [-0.2, 0.25]\npoints = 2\norientations = [3.4]\nrates = [-0.8]\nnoise = 1e-4\n";
        let scene = Scene::parse(folder.join("x.toml").to_str().unwrap(), &format!("{text}{study}")).unwrap();
        let experiment = Experiment::new(scene, None).unwrap();
        let studies = Studies::new(&experiment, &UNINTERRUPTED).unwrap();
        assert_eq!(studies.trials(), 5);
        let study = experiment.scene.study.curvature.as_ref().unwrap();
        let whole = curvature_map(&experiment, study, &UNINTERRUPTED, &|| ()).unwrap();
        for of in [1, 2, 7] {
            assert_eq!(studies.merge(parts(&studies, of)).unwrap().curvature.as_ref(), Some(&whole), "{of}");
        }
    }

    /// Two studies of which neither has a number of trials that 7 divides.
    fn experiment() -> Experiment {
        let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/systems/van_der_pol.toml"));
        let text = std::fs::read_to_string(&path).unwrap();
        let short = [
            ("duration = 8\nsamples = 161", "duration = 0.5\nsamples = 11"),
            ("window = 160\nsteps = 50", "window = 10\nsteps = 6"),
            ("\"multiple-shooting\"", "\"newton\""),
        ];
        let text = short.iter().fold(text, |text, (long, short)| {
            assert!(text.contains(long), "{long}");
            text.replace(long, short)
        });
        let study = "\n[study.noise]\nlevels = [1e-4, 1e-3]\nseeds = 3\n\n\
                     [study.basin]\nx = [-2.5, 2.5]\ny = [-2.5, 2.5]\npoints = 2\n";
        let scene = Scene::parse(path.to_str().unwrap(), &format!("{text}{study}")).unwrap();
        Experiment::new(scene, None).unwrap()
    }

    fn parts(studies: &Studies<'_>, of: u64) -> Vec<(String, StudyPart)> {
        let stretch = |number| crate::sweep::shard_of(studies.trials(), number, of);
        let part = |number| studies.part(stretch(number), &UNINTERRUPTED, &|| ()).unwrap();
        // the last first, and each written and read
        let read = |part: StudyPart| StudyPart::read(&part.text().unwrap()).unwrap();
        (1..=of).rev().map(|number| (format!("{number}/{of}"), read(part(number)))).collect()
    }

    /// Oracle: the studies in one run, which know of no parts. More parts than trials are some that are empty.
    #[test]
    fn any_number_of_parts_is_one_run_to_the_last_bit() {
        let experiment = experiment();
        let studies = Studies::new(&experiment, &UNINTERRUPTED).unwrap();
        let (study, simulated) = (&experiment.scene.study, experiment.simulated().unwrap());
        let noise =
            noise_study(&experiment, simulated, study.noise.as_ref().unwrap(), &UNINTERRUPTED, &|| ())
                .unwrap();
        let maps = basins(&experiment, study.basin.as_ref().unwrap(), &UNINTERRUPTED, &|| ()).unwrap();
        assert_eq!(studies.trials(), (2 * 3 + 4 * experiment.scene.observer.methods.len()) as u64);
        assert_eq!(
            (noise.len(), noise[0].converged, maps.len()),
            (2, 3, experiment.scene.observer.methods.len())
        );
        let bits = |levels: &[NoiseLevel]| -> Vec<u64> {
            levels
                .iter()
                .flat_map(|level| level.errors.iter().chain(&level.bounds))
                .map(|x| x.to_bits())
                .collect()
        };
        for of in [1, 3, 7, 20] {
            let found = studies.merge(parts(&studies, of)).unwrap();
            assert_eq!(bits(&found.noise), bits(&noise), "{of}");
            assert_eq!((&found.noise, &found.basins, &found.curvature), (&noise, &maps, &None), "{of}");
        }
    }

    #[test]
    fn what_is_no_whole_is_refused_by_name() {
        let mut experiment = experiment();
        let all = {
            let studies = Studies::new(&experiment, &UNINTERRUPTED).unwrap();
            let all = parts(&studies, 3);
            let trials = studies.trials();
            let third = crate::sweep::shard_of(trials, 2, 3);
            let [a, b, c] = [2, 1, 0].map(|place: usize| all[place].clone());
            let merged = |parts: &[&(String, StudyPart)]| {
                studies.merge(parts.iter().map(|part| (*part).clone()).collect()).err()
            };
            assert_eq!(merged(&[]), Some(StudyMergeError::NoParts));
            assert_eq!(merged(&[&c, &b, &a]), None);
            assert_eq!(merged(&[&c, &a]), Some(StudyMergeError::Gap(third.clone())));
            assert_eq!(merged(&[&a, &b]), Some(StudyMergeError::Gap(third.end..trials)));
            let overlap =
                StudyMergeError::Overlap { one: "2/3".to_owned(), other: "again".to_owned(), trials: third };
            assert_eq!(merged(&[&a, &b, &("again".to_owned(), b.1.clone()), &c]), Some(overlap));
            // numbers that are no whole, under a right checksum
            let mut short = b.clone();
            short.1.noise.pop();
            short.1.arrives.push(true);
            assert_eq!(merged(&[&a, &short, &c]), Some(StudyMergeError::Contradicts("2/3".to_owned())));
            all
        };
        let first = || all.last().unwrap().0.clone();
        // the same question, other readings
        let mut other = experiment.clone();
        let (name, value) = other.question.guess[0].clone();
        other.question.guess[0] = (name, value + 1e-15 * value.abs().max(1.0));
        let studies = Studies::new(&other, &UNINTERRUPTED).unwrap();
        assert_eq!(studies.merge(vec![all[2].clone()]), Err(StudyMergeError::OtherReadings(first())));
        // another seed
        experiment.scene.seed += 1;
        let studies = Studies::new(&experiment, &UNINTERRUPTED).unwrap();
        assert_eq!(studies.merge(vec![all[2].clone()]), Err(StudyMergeError::OtherQuestion(first())));
    }
}
