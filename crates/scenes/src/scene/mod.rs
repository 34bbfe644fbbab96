//! Scene files: an experiment in TOML, read into plain structures, with errors that point into the text.
//!
//! [`keys`] is the file as it is written, [`check`] checks every value, [`place`] knows where in the
//! text each stands. Nothing here simulates or estimates.

pub(crate) mod check;
mod columns;
pub(crate) mod hints;
mod keys;
mod observing;
pub(crate) mod place;
mod robot;
mod simulated;

pub use columns::SceneColumn;
pub use observing::{
    BasinStudy, Channel, CurvatureStudy, Data, Guess, Method, ModeSettings, NoiseStudy, ObserverSettings,
    Sensor, Study, Switch,
};
pub use palmistry_lang::ReadError as SceneError;
pub use robot::SimulatedRobot;
pub(crate) use simulated::sample_times;
pub use simulated::{Body, LibraryBody, Palms, SceneOutline, Simulated, SimulatedSystem};

use palmistry_bodies::mechanics::Palm;
use palmistry_io::foreign::name_of;
use palmistry_lang::{Code, Problem, System, load};
use palmistry_observe::{ColumnNames, FaultRules, Loss};
use place::Places;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Former names of keys of `[observer]`, which are aliases of the present ones.
const OLD_KEYS: [(&str, &str); 2] = [("blind", "unobservable_above"), ("when_blind", "when_unobservable")];

/// An experiment: what is held and how it moves, or where it was recorded; the sensors; and the observers
/// that are to estimate the state.
#[derive(Clone, Debug)]
pub struct Scene {
    /// `title`: what the experiment is, in a line.
    pub title: String,
    /// `model`: the proof file of the system that the observers know. The file names it relative to itself; here it is
    /// relative to where the program runs.
    pub model: PathBuf,
    /// `seed`: the seed of the random numbers; 1 unless given.
    pub seed: u64,
    /// `duration`, `samples` or `rate`, `[body]` and `[palms]`: what is simulated. Absent where the data is recorded.
    pub simulated: Option<Simulated>,
    /// `duration`, `samples` or `rate`, `[start]` and `[inputs]`: a system that is simulated by its own equations. Absent where a body
    /// is simulated or the data is recorded.
    pub system: Option<SimulatedSystem>,
    /// `duration`, `samples` or `rate`, `[robot]` and `[ground]`: a robot on uneven ground. Absent where anything else is simulated.
    pub robot: Option<SimulatedRobot>,
    /// `radii` of `[palms]`, in m: positive of a hollow circular palm, negative of a bulging one, infinite of a flat one, as both
    /// are unless given.
    pub palm_forms: [Palm<f64>; 2],
    /// `[sensor]`: the errors of the sensors.
    pub sensor: Sensor,
    /// `[sensor.NAME]`: the errors of single columns, by name.
    pub channels: BTreeMap<String, Channel>,
    /// `[columns]`: columns of a recording that have other names or units than in the model, by the model's names.
    pub columns: BTreeMap<String, SceneColumn>,
    /// `[data]`: recorded data, and what to do with a faulty row.
    pub data: Data,
    /// `[observer]`: what is to be estimated, and how.
    pub observer: ObserverSettings,
    /// `[study]`: what to try many times over.
    pub study: Study,
    name: String,
    text: String,
}

impl Scene {
    /// Reads a scene from a file.
    ///
    /// # Errors
    /// What is wrong with the file, and where. The files that it names have to be there.
    pub fn read(path: &Path) -> Result<Scene, SceneError> {
        let name = name_of(path);
        let text = load(path)
            .map_err(|message| Problem::new(Code::SceneValue, &(0..0), message, "").locate(&name, ""))?;
        let scene = Scene::parse(&name, &text)?;
        let named = [("model", Some(&scene.model)), ("data.record", scene.data.record.as_ref())];
        for (place, file) in named.into_iter().filter_map(|(place, file)| Some((place, file?))) {
            let is_stream = place == "data.record" && file == Path::new(check::STREAM_NAME);
            let what = if place == "model" { hints::PROOF_FILE } else { hints::RECORDING };
            if let Some((message, help)) = hints::refused_file(file, what).filter(|_| !is_stream) {
                return Err(scene.error_at(place, message, "named here", help));
            }
        }
        Ok(scene)
    }

    /// Reads a scene from a text. Paths in it are relative to the folder of `name`, the name
    /// under which the text is shown; they are not looked for.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    pub fn parse(name: &str, text: &str) -> Result<Scene, SceneError> {
        let places = Places::of(text).map_err(|problem| problem.locate(name, text))?;
        let keys = keys::read(text, &places).map_err(|problem| problem.locate(name, text))?;
        check::scene(keys, &places, name, text).map_err(|problem| problem.locate(name, text))
    }

    /// An error that marks a value of this scene, for checks after it was read. The place is named by its
    /// keys, as in `observer.estimate[2]` or `body.shape`; where it is not there, the nearest table is marked.
    pub fn error_at(
        &self,
        place: &str,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        // the text was parsed before: it has places
        let span = Places::of(&self.text).map_or(0..0, |places| places.value(place));
        Problem::new(Code::SceneValue, &span, message, label).help(help).locate(&self.name, &self.text)
    }

    /// An error that marks a key of this scene, named by the tables in which it stands and itself.
    pub(crate) fn error_at_key(
        &self,
        place: &[&str],
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        let span = Places::of(&self.text).map_or(0..0, |places| places.key_of(place));
        Problem::new(Code::SceneValue, &span, message, label).help(help).locate(&self.name, &self.text)
    }

    /// Keys of this scene that are written with a former name: each with its present name.
    pub fn old_keys(&self) -> Vec<(&'static str, &'static str)> {
        let Ok(places) = Places::of(&self.text) else { return Vec::new() };
        OLD_KEYS.into_iter().filter(|(old, _)| places.has("observer", old)).collect()
    }

    /// Keys of `[observer]` that this scene gives and no method of it heeds, each with the methods that would.
    pub fn unheeded_keys(&self) -> Vec<(&'static str, &'static str)> {
        let Ok(places) = Places::of(&self.text) else { return Vec::new() };
        let has = |wanted: &[Method]| self.observer.methods.iter().any(|method| wanted.contains(method));
        let by_windows = self.observer.methods.iter().any(|method| method.is_by_windows());
        let windows = "newton, trust-region and multiple-shooting";
        [
            ("loss", windows, by_windows || self.observer.loss == Loss::default()),
            ("whole", windows, by_windows || !self.observer.whole),
            ("shooting", "multiple-shooting", has(&[Method::MultipleShooting])),
            ("kalman", "kalman and smoother", has(&[Method::Kalman, Method::Smoother])),
            ("unscented", "unscented", has(&[Method::Unscented])),
            ("high_gain", "high-gain", has(&[Method::HighGain])),
        ]
        .into_iter()
        .filter(|(key, _, is_heeded)| !is_heeded && places.has("observer", key))
        .map(|(key, methods, _)| (key, methods))
        .collect()
    }

    /// The text of the scene.
    #[doc(hidden)]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The columns of a recording by the names and units of a system.
    ///
    /// # Errors
    /// The model knows no such name, or measures it in a unit of another kind.
    pub fn column_names(&self, system: &System) -> Result<ColumnNames, SceneError> {
        columns::names(&self.columns, system, &self.text)
            .map_err(|problem| problem.locate(&self.name, &self.text))
    }

    /// The rules by which rows of this scene's record count as faulty: those of `[data]`, with the sensors' jitter and
    /// resolution.
    pub fn fault_rules(&self) -> FaultRules {
        let resolution = self.sensor.resolution;
        FaultRules {
            on_fault: self.data.on_fault,
            spike: self.data.spike,
            jitter: self.sensor.jitter,
            empty: BTreeMap::new(),
            interpolation: self.data.interpolation,
            resolution: ["s1", "s2"]
                .map(|column| (column.to_owned(), resolution))
                .into_iter()
                .chain(self.channels.iter().filter_map(|(name, own)| Some((name.clone(), own.resolution?))))
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests;
