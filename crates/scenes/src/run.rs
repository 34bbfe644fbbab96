//! A scene from start to end: bodies or a file, the measurements, and the answers of the observers.

use super::channels;
use super::groundwork::{Groundwork, Steady, estimate_question, sample_range};
use super::known_motion::KnownMotion;
use super::recognised::Recognition;
use super::recovered::Reconstruction;
use super::scene::{self, Guess, Scene, SceneError};
use super::simulation::{NOMINAL, Simulation, TOUCH, deviation};
use super::since::Since;
use super::system_motion::SystemMotion;
use super::terrain::Closure;
use super::unguided::{PalmMeasurements, palm_measurements};
use miette::Diagnostic;
use palmistry_io::UNINTERRUPTED;
use palmistry_lang::System;
use palmistry_observe::{
    EstimateQuestion, Fault, ModelError, MovingWindow, Noise, Observer, ReadRecord, Record, RecordError,
    RecordRows, Signals, SparseColumn, Task, Track, Update, WindowSearch,
};
use std::cell::OnceCell;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// A scene with its measurements.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The scene.
    pub scene: Scene,
    /// The observers' model.
    pub system: System,
    /// Absent where the measurements come from a file.
    pub simulation: Option<Simulation>,
    /// Present where a system was simulated by its own equations.
    pub motion: Option<SystemMotion>,
    /// The closure, that wheel 2 rolls where wheel 1 has been, and what it makes observable, where a robot was simulated.
    pub closure: Option<Closure>,
    /// Which body of the library it is, once [`Experiment::recognise`] was called.
    pub recognition: Option<Recognition>,
    /// The measurements.
    pub record: Record,
    /// The same as instruments write them, where the scene gives other names or units than the model.
    pub written: Option<Record>,
    /// The time of the first sample, in s, where times are counted from there because it is far from zero; else zero.
    pub origin: f64,
    /// The faults of a file's rows.
    pub faults: Vec<Fault>,
    /// The first time as it was written, where times of a file are dates: they are counted from it.
    pub began: Option<String>,
    /// Columns of a file with empty cells, and how these are treated.
    pub sparse: Vec<SparseColumn>,
    /// How many rows at the start and at the end of a file are left out, because a column that drives the model is empty there.
    pub outside: [usize; 2],
    /// The measurements as curves of time.
    pub signals: Signals,
    /// The states that the observers estimate, and what they know.
    pub question: EstimateQuestion,
}

/// Measurements from elsewhere.
#[derive(Clone, Debug)]
pub enum Measurements<'a> {
    /// A file, CSV or Parquet.
    File(&'a Path),
    /// Columns under their names, all of one length: the time, in s, and the measurements.
    Columns(Vec<(String, Vec<f64>)>),
}

/// The answer of one observer.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The observer.
    pub method: scene::Method,
    /// Its estimates, sample by sample.
    pub track: Track,
    /// The wall-clock time in s; NaN where no times are kept.
    pub seconds: f64,
    /// The shape estimated from it, where that was asked for: of the answer that is shown.
    pub reconstruction: Option<Box<Reconstruction>>,
}

impl Answer {
    /// Replaces each wall-clock time by NaN.
    pub fn forget_times(&mut self) {
        self.seconds = f64::NAN;
        for update in &mut self.track.updates {
            update.seconds = f64::NAN;
        }
    }
}

impl Experiment {
    /// Simulates a scene, or takes its measurements from a file: `data`, or else the one that the scene names.
    ///
    /// # Errors
    /// What is wrong with the scene, its model or the file, with the place in the scene.
    pub fn new(scene: Scene, data: Option<&Path>) -> Result<Experiment, SceneError> {
        let file = data.map(Path::to_owned).or_else(|| scene.data.record.clone());
        let ground = Groundwork::of(scene, file.is_none())?;
        Experiment::on(ground, file.as_deref())
    }

    /// The experiment with measurements of a system that need not come from a file: the model that the scene names is not read.
    ///
    /// # Errors
    /// As for [`Experiment::new`].
    pub fn measured(
        scene: Scene,
        system: System,
        measured: Measurements<'_>,
    ) -> Result<Experiment, SceneError> {
        let ground = Groundwork::with_system(scene, system, false)?;
        match measured {
            Measurements::File(file) => Experiment::on(ground, Some(file)),
            Measurements::Columns(columns) => {
                let needed = ground.needed();
                let needed: Vec<&str> = needed.iter().map(String::as_str).collect();
                let rows = RecordRows::of_columns("the measurements", columns, &needed, &ground.names);
                let reading = rows.and_then(|rows| rows.settle(&ground.fault_rules()));
                let reading = reading.map_err(|error| unusable(&ground.scene, &error))?;
                Experiment::with_measurements(ground, reading, None, Steady::AreConstants)
            }
        }
    }

    fn on(ground: Groundwork, file: Option<&Path>) -> Result<Experiment, SceneError> {
        let Groundwork { scene, names, .. } = &ground;
        let (reading, written) = match (ground.simulated(), file) {
            (Some(simulated), _) => {
                let place = |error: RecordError| {
                    scene.error_at("sensor", error.to_string(), "these measurements", "")
                };
                let mut record = simulated.read(&scene.sensor, &scene.channels, scene.seed).map_err(place)?;
                let mut written = None;
                if !names.sources.is_empty() {
                    // what is observed is the written record as it would be read again
                    let own = names.written(&record).map_err(place)?;
                    record = names.read(&own, record.names()).map_err(place)?;
                    written = Some(own);
                }
                (ReadRecord::whole(record), written)
            }
            (None, Some(file)) => {
                let needed = ground.needed();
                let needed: Vec<&str> = needed.iter().map(String::as_str).collect();
                let read = Record::read_named(file, &needed, names, &ground.fault_rules());
                (read.map_err(|error| unusable(scene, &error))?, None)
            }
            (None, None) => {
                let help = "give [start] with a value for each state, or a body and palms; or name a file under [data], or hand one over with --data";
                return Err(scene.error_at("title", "there is nothing to observe", "this scene", help));
            }
        };
        Experiment::with_measurements(ground, reading, written, Steady::AreConstants)
    }

    /// The experiment with these measurements.
    ///
    /// # Errors
    /// What is wrong with the measurements or with what is estimated from them, with the place in the scene.
    pub(super) fn with_measurements(
        ground: Groundwork,
        reading: ReadRecord,
        written: Option<Record>,
        steady: Steady,
    ) -> Result<Experiment, SceneError> {
        let Groundwork { scene, system, simulation, begun, described, simulates, known, .. } = ground;
        let ReadRecord { record, faults, sparse, began, outside, .. } = reading;
        let (record, origin) = match simulates {
            // simulated times are counted from zero
            true => (record, 0.0),
            false => {
                let since = Since::first(&record);
                (since.count(&scene, record)?, since.origin)
            }
        };
        let signals = Signals::of_record(&record);
        let signals =
            signals.map_err(|error| scene.error_at("data", error.to_string(), "these measurements", ""))?;
        channels::are_columns(&scene, &signals)?;
        let signals = signals.interpolated(scene.data.interpolation);
        let signals = channels::corrected(signals, &scene.observer.known).map_err(|error| {
            scene.error_at("observer.known", error.to_string(), "measurements without these", "")
        })?;
        let question = {
            // for a recording, the truth is that of the motion that the scene describes
            let truth = |name: &str| match simulation.as_ref().or(begun.as_ref()) {
                Some(simulation) => simulation.truth(name)?.first().copied(),
                None => described.as_ref()?.truth(name)?.first().copied(),
            };
            estimate_question(&scene, &system, &truth, known, &signals, steady)?
        };
        channels::are_determined(&scene, &system, &question, &signals)?;
        let motion = described.filter(|_| simulates);
        let closure = match (&scene.robot, &motion) {
            (Some(robot), Some(motion)) => Closure::of(robot, &motion.response.times),
            _ => None,
        };
        let experiment = Experiment {
            scene,
            system,
            simulation,
            motion,
            closure,
            recognition: None,
            record,
            written,
            origin,
            faults,
            sparse,
            began,
            outside,
            signals,
            question,
        };
        // with the measurements at hand, check that the model can be built
        experiment.task(&UNINTERRUPTED)?;
        Ok(experiment)
    }

    /// The observers' task.
    ///
    /// # Errors
    /// Where the system gives no model, with the place in the scene.
    pub fn task<'a>(&'a self, interrupt: &'a AtomicBool) -> Result<Task<'a>, SceneError> {
        let task = Task::new(&self.system, &self.question, &self.signals, interrupt);
        let mut task = task.map_err(|error| {
            let place = match error {
                ModelError::NoField { .. } | ModelError::NoSymbol { .. } | ModelError::NotAnInput { .. } => {
                    "observer.inputs"
                }
                ModelError::NoMotion { .. } => "model",
                ModelError::Pole { .. } | ModelError::NotFinite { .. } => "observer.known",
                _ => "observer.estimate",
            };
            let help =
                "the model and the columns of the measurements have to determine the rate of all that is estimated";
            self.scene.error_at(place, error.to_string(), "asked for here", help)
        })?;
        if self.scene.observer.guess == Guess::Sample {
            let names = self.names();
            let half = names
                .iter()
                .map(|name| sample_range(&self.system, name).map_or(0.0, |[low, high]| (high - low) / 2.0));
            let sizes: Vec<f64> = half.zip(&task.guess).map(|(half, guess)| half.max(guess.abs())).collect();
            task.sizes
                .iter_mut()
                .zip(sizes)
                .filter(|(_, own)| *own > 0.0)
                .for_each(|(size, own)| *size = own);
        }
        let sensor = &self.scene.sensor;
        let sigma = deviation(sensor.noise, sensor.resolution);
        task.exact = sigma == 0.0;
        task.sigma = if task.exact { NOMINAL } else { sigma };
        if !task.exact {
            task.noise = Noise::Stated { normal: sensor.noise, rounding: sensor.resolution };
        }
        channels::tell(
            (&self.scene, &self.sparse),
            &mut task,
            self.scene.simulated.is_some(),
            self.simulated().is_some(),
        )?;
        let settings = &self.scene.observer;
        (task.inherit, task.whole, task.loss) = (settings.inherit, settings.whole, settings.loss);
        // without a guess there are other ways to restart
        task.restarts = settings.guess != Guess::None;
        for (name, bounds) in self.names().into_iter().zip(&mut task.bounds) {
            *bounds = settings.bounds.get(name).copied().unwrap_or(*bounds);
        }
        task.timing = self.origin.abs() * f64::EPSILON * self.fastest(&task);
        Ok(task)
    }

    /// The largest slope of an output from one sample to the next, per s.
    fn fastest(&self, task: &Task<'_>) -> f64 {
        let times = self.signals.times();
        let columns = task.full.outputs.iter().filter_map(|name| self.signals.find(name));
        let mut fastest = 0.0f64;
        for place in columns {
            let all = times.iter().zip(self.signals.column(place));
            let mut measured = all.filter(|(_, value)| !value.is_nan());
            let Some(mut before) = measured.next() else { continue };
            for now in measured {
                fastest = fastest.max(((now.1 - before.1) / (now.0 - before.0)).abs());
                before = now;
            }
        }
        fastest
    }

    /// The measurements of the first window, for estimators that need no first guess.
    ///
    /// # Errors
    /// The name of what is missing.
    #[doc(hidden)]
    pub fn palm_measurements(&self) -> Result<PalmMeasurements, &'static str> {
        let rows = (self.scene.observer.window + 1).min(self.signals.times().len());
        palm_measurements(&self.scene, &self.system, &self.question.known, &self.signals, rows)
    }

    /// The observer of a name, with the scene's settings.
    pub fn observer(&self, method: scene::Method) -> Box<dyn Observer> {
        self.scene.observer.observer(method)
    }

    /// The observer by windows, with the scene's settings.
    pub fn window(&self, search: WindowSearch) -> MovingWindow {
        self.scene.observer.window(search)
    }

    /// The answers of all observers of the scene.
    ///
    /// # Errors
    /// As [`Experiment::task`].
    pub fn observe(&self) -> Result<Vec<Answer>, SceneError> {
        self.run(&UNINTERRUPTED, &|_| ())
    }

    /// The answers of all observers of the scene; `done` is called after each.
    ///
    /// # Errors
    /// As [`Experiment::task`].
    pub fn run(
        &self,
        interrupt: &AtomicBool,
        done: &dyn Fn(scene::Method),
    ) -> Result<Vec<Answer>, SceneError> {
        let task = self.task(interrupt)?;
        let mut answers = Vec::new();
        // the same for all methods, and not asked for where none has an answer
        let counted = OnceCell::new();
        let steps = self.steps_between_samples(&task);
        for &method in &self.scene.observer.methods {
            let begin = Instant::now();
            let mut track = self.observer(method).observe(&task);
            self.pass_poles(method, &mut track, interrupt);
            self.name_mirrors(&mut track);
            track.remarks.extend(steps.clone());
            if track.others.is_empty() && is_believed(&track) {
                track.remarks.extend(counted.get_or_init(|| self.counted_values(interrupt)).clone());
            }
            let seconds = begin.elapsed().as_secs_f64();
            answers.push(Answer { method, track, seconds, reconstruction: None });
            done(method);
            if task.interrupted() {
                break;
            }
        }
        Ok(answers)
    }

    /// The measurements as instruments write them: what `--record` keeps.
    pub fn as_written(&self) -> &Record {
        self.written.as_ref().unwrap_or(&self.record)
    }

    /// The names of the estimated states.
    pub fn names(&self) -> Vec<&str> {
        self.question.guess.iter().map(|(name, _)| name.as_str()).collect()
    }

    /// The true values of the estimated states at a time: none where the measurements come from a file, or the time is no sample's.
    pub fn truth_at(&self, time: f64) -> Option<Vec<f64>> {
        let row = self.signals.times().iter().position(|other| *other == time)?;
        let truth =
            |name: &&str| channels::truth(&self.scene, name).or_else(|| self.truth(name)?.get(row).copied());
        self.simulated()?;
        self.names().iter().map(truth).collect()
    }

    /// The true values of a state, sample by sample: none where the measurements come from a file.
    pub fn truth(&self, name: &str) -> Option<Vec<f64>> {
        self.simulated()?.truth(name)
    }

    /// The simulated motion: none where the measurements come from a file.
    pub fn simulated(&self) -> Option<&dyn KnownMotion> {
        match (&self.simulation, &self.motion) {
            (Some(simulation), _) => Some(simulation),
            (None, motion) => motion.as_ref().map(|motion| motion as &dyn KnownMotion),
        }
    }

    /// Whether the scene is about a body between palms.
    pub fn is_about_palms(&self) -> bool {
        let outputs = &self.system.outputs;
        let touches = TOUCH.iter().all(|name| outputs.iter().any(|(output, _)| output == name));
        let sought = ["r1", "r2"].iter().all(|name| self.names().contains(name));
        self.scene.simulated.is_some() || (touches && sought)
    }
}

/// Whether an estimate of it fits: of a method by windows some window's, of a filter the last one.
fn is_believed(track: &Track) -> bool {
    match track.updates.is_empty() {
        true => track.passes(),
        false => track.updates.iter().any(Update::is_borne_out),
    }
}

/// The error of an estimate: relative, or absolute where the truth is less than a millionth.
pub fn error(estimate: f64, truth: f64) -> f64 {
    let size = if truth.abs() < 1e-6 { 1.0 } else { truth.abs() };
    ((estimate - truth) / size).abs()
}

/// The error for a file of measurements, with the record's own advice.
pub(super) fn unusable(scene: &Scene, error: &RecordError) -> SceneError {
    let advice = error.help().map(|help| help.to_string()).unwrap_or_default();
    let help = match error {
        RecordError::Column { column, .. }
            if column != palmistry_observe::TIME
                && !advice.contains("perhaps")
                && !advice.contains("separated by commas")
                && !advice.contains("first line")
                && !scene.observer.estimate.contains(column)
                && !scene.columns.values().any(|own| own.from == *column) =>
        {
            format!("{advice}; or give '{column}' under `known`, or estimate it")
        }
        _ => advice,
    };
    scene.error_at("data", error.to_string(), "the measurements of this scene", help)
}
