//! A scene from beginning to end: bodies or a file, what is read of them, and what the observers make of it.

use super::channels;
use super::known_motion::KnownMotion;
use super::recovered::Reconstruction;
use super::scene::{self, Guess, Scene, SceneError};
use super::simulation::{NOMINAL, Simulation, TOUCH, body, constants, deviation};
use super::since::Since;
use super::system_motion::SystemMotion;
use super::unguided::{PalmReadings, Unguided, palm_readings};
use crate::expression::{NodeId, Symbol};
use crate::number::rational_to_f64;
use crate::observer::{
    CalibrationKind, EstimateQuestion, Fault, FaultRules, ModelError, MovingWindow, Noise, Observer, Record,
    RecordError, RecordReading, Signals, Task, Track, WindowSearch,
};
use crate::sweep::UNINTERRUPTED;
use crate::system::{Kind, System, nearest};
use miette::Diagnostic;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// A scene with its readings.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// What was asked for.
    pub scene: Scene,
    /// The system that the observers believe in.
    pub system: System,
    /// Absent where the readings come from a file.
    pub simulation: Option<Simulation>,
    /// Present where a system was simulated by its own equations.
    pub motion: Option<SystemMotion>,
    /// The readings.
    pub record: Record,
    /// The time of the first sample where times are counted from there, because they were counted from another age; else zero. In s.
    pub origin: f64,
    /// What was wrong with the rows of a file.
    pub faults: Vec<Fault>,
    /// The readings as curves of time.
    pub signals: Signals,
    /// What the observers are asked for.
    pub question: EstimateQuestion,
}

/// What one observer made of it.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The observer.
    pub method: scene::Method,
    /// What it believed, sample by sample.
    pub track: Track,
    /// In s; NaN where no times are kept.
    pub seconds: f64,
    /// The shape that it tells, where that was asked for: of the answer that is shown.
    pub reconstruction: Option<Box<Reconstruction>>,
}

impl Answer {
    /// Replaces each time on the wall by NaN.
    pub fn forget_times(&mut self) {
        self.seconds = f64::NAN;
        for update in &mut self.track.updates {
            update.seconds = f64::NAN;
        }
    }
}

impl Experiment {
    /// Simulates a scene, or takes its readings from a file: `data`, or else the one that the scene names.
    ///
    /// # Errors
    /// What is wrong with the scene, its model or the file, with the place in the scene.
    pub fn new(scene: Scene, data: Option<&Path>) -> Result<Experiment, SceneError> {
        let system = System::read(&scene.model)?;
        let file = data.or(scene.data.record.as_deref());
        let simulation = match (&scene.simulated, file) {
            (Some(simulated), None) => Some(Simulation::of(&scene, simulated)?),
            _ => None,
        };
        known_states(&scene, &system)?;
        // a recording of what the scene describes is told the same constants
        let described =
            scene.system.as_ref().map(|own| SystemMotion::of(&scene, &system, own)).transpose()?;
        let known = known_constants(&scene, &system, simulation.as_ref(), described.as_ref())?;
        let motion = described.clone().filter(|_| file.is_none());
        let simulated: Option<&dyn KnownMotion> = match (&simulation, &motion) {
            (Some(simulation), _) => Some(simulation),
            (None, motion) => motion.as_ref().map(|motion| motion as &dyn KnownMotion),
        };
        let RecordReading { record, faults, .. } = match (simulated, file) {
            (Some(simulated), _) => {
                let record = simulated.read(&scene.sensor, &scene.channels, scene.seed);
                let place =
                    |error: RecordError| scene.error_at("sensor", error.to_string(), "these readings", "");
                RecordReading { record: record.map_err(place)?, faults: Vec::new(), left_out: Vec::new() }
            }
            (None, Some(file)) => {
                let needed = needed(&scene, &system, &known);
                let needed: Vec<&str> = needed.iter().map(String::as_str).collect();
                Record::read_checked(file, &needed, &fault_rules(&scene, &system))
                    .map_err(|error| unusable(&scene, &error))?
            }
            (None, None) => {
                let help = "give [start] with a value for each state, or a body and palms; or name a file under [data], or hand one over with --data";
                return Err(scene.error_at("title", "there is nothing to observe", "this scene", help));
            }
        };
        let (record, origin) = match file {
            Some(_) => {
                let since = Since::first(&record);
                (since.count(&scene, record)?, since.origin)
            }
            // simulated times are counted from zero
            None => (record, 0.0),
        };
        let signals = Signals::of_record(&record);
        let signals =
            signals.map_err(|error| scene.error_at("data", error.to_string(), "these readings", ""))?;
        channels::are_columns(&scene, &signals)?;
        let signals = channels::corrected(signals, &scene.observer.known).map_err(|error| {
            scene.error_at("observer.known", error.to_string(), "readings without these", "")
        })?;
        let question = {
            let truth = |name: &str| match &simulation {
                Some(simulation) => simulation.truth(name)?.first().copied(),
                None => described.as_ref()?.truth(name)?.first().copied(),
            };
            estimate_question(&scene, &system, &truth, known, &signals)?
        };
        channels::are_told(&scene, &system, &question, &signals)?;
        let experiment =
            Experiment { scene, system, simulation, motion, record, origin, faults, signals, question };
        // whether the model can be made at all is better known now
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
                "the model and the columns of the readings have to determine the rate of all that is sought";
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
        channels::tell(&self.scene, &mut task, self.simulation.is_some(), self.simulated().is_some())?;
        task.timing = self.origin.abs() * f64::EPSILON * self.fastest(&task);
        Ok(task)
    }

    /// The fastest change of an output from one sample to the next, per s.
    fn fastest(&self, task: &Task<'_>) -> f64 {
        let times = self.signals.times();
        let columns = task.full.outputs.iter().filter_map(|name| self.signals.find(name));
        let steps = columns.flat_map(|place| self.signals.column(place).windows(2).zip(times.windows(2)));
        steps.map(|(value, time)| ((value[1] - value[0]) / (time[1] - time[0])).abs()).fold(0.0, f64::max)
    }

    /// The readings of the first window, for who seeks a state without a first guess.
    ///
    /// # Errors
    /// The name of what is missing.
    #[doc(hidden)]
    pub fn palm_readings(&self) -> Result<PalmReadings, &'static str> {
        let rows = (self.scene.observer.window + 1).min(self.signals.times().len());
        palm_readings(&self.scene, &self.system, &self.question.known, &self.signals, rows)
    }

    /// The observer of a name, with the scene's settings.
    pub fn observer(&self, method: scene::Method) -> Box<dyn Observer> {
        self.scene.observer.observer(method)
    }

    /// The observer by windows, with the scene's settings.
    pub fn window(&self, search: WindowSearch) -> MovingWindow {
        self.scene.observer.window(search)
    }

    /// What every observer of the scene makes of the readings.
    ///
    /// # Errors
    /// As [`Experiment::task`].
    pub fn observe(&self) -> Result<Vec<Answer>, SceneError> {
        self.run(&UNINTERRUPTED, &|_| ())
    }

    /// What every observer of the scene makes of the readings; `done` is told of each that has finished.
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
        for &method in &self.scene.observer.methods {
            let begin = Instant::now();
            let track = self.observer(method).observe(&task);
            let seconds = begin.elapsed().as_secs_f64();
            answers.push(Answer { method, track, seconds, reconstruction: None });
            done(method);
            if task.interrupted() {
                break;
            }
        }
        Ok(answers)
    }

    /// The names of what is sought.
    pub fn names(&self) -> Vec<&str> {
        self.question.guess.iter().map(|(name, _)| name.as_str()).collect()
    }

    /// The true values of what is sought at a time: none where the readings come from a file, or the time is no sample's.
    pub fn truth_at(&self, time: f64) -> Option<Vec<f64>> {
        let row = self.signals.times().iter().position(|other| *other == time)?;
        let truth =
            |name: &&str| channels::truth(&self.scene, name).or_else(|| self.truth(name)?.get(row).copied());
        self.simulated()?;
        self.names().iter().map(truth).collect()
    }

    /// The true values of a state, sample by sample: none where the readings come from a file.
    pub fn truth(&self, name: &str) -> Option<Vec<f64>> {
        self.simulated()?.truth(name)
    }

    /// What was simulated: none where the readings come from a file.
    pub fn simulated(&self) -> Option<&dyn KnownMotion> {
        match (&self.simulation, &self.motion) {
            (Some(simulation), _) => Some(simulation),
            (None, motion) => motion.as_ref().map(|motion| motion as &dyn KnownMotion),
        }
    }

    /// Whether it is about a body between palms.
    pub fn is_about_palms(&self) -> bool {
        let outputs = &self.system.outputs;
        let touches = TOUCH.iter().all(|name| outputs.iter().any(|(output, _)| output == name));
        let sought = ["r1", "r2"].iter().all(|name| self.names().contains(name));
        self.scene.simulated.is_some() || (touches && sought)
    }
}

/// The error of an estimate: relative, or absolute where the truth is less than a millionth.
pub fn error(estimate: f64, truth: f64) -> f64 {
    let size = if truth.abs() < 1e-6 { 1.0 } else { truth.abs() };
    ((estimate - truth) / size).abs()
}

/// Whether all that is sought are states of the system: said before anyone asks for readings or a first guess of them.
fn known_states(scene: &Scene, system: &System) -> Result<(), SceneError> {
    let states: Vec<&str> = system.states.iter().map(|state| system.symbol_name(*state)).collect();
    for (index, name) in scene.observer.estimate.iter().enumerate() {
        if !states.contains(&name.as_str()) && !channels::is_sought(system, name) {
            let help = match nearest(name, states.iter().copied()) {
                Some(near) => format!("perhaps you meant '{near}'"),
                None => "an observer seeks states; constants are told".to_owned(),
            };
            let error = ModelError::NoState { name: name.clone(), states: states.join(", ") };
            let place = format!("observer.estimate[{index}]");
            return Err(scene.error_at(&place, error.to_string(), "sought here", help));
        }
    }
    Ok(())
}

/// What is wrong with a file of readings, with the record's own advice.
fn unusable(scene: &Scene, error: &RecordError) -> SceneError {
    let advice = error.help().map(|help| help.to_string()).unwrap_or_default();
    let help = match error {
        RecordError::Column { column, .. } => {
            format!("{advice}; or give '{column}' under `known`, or estimate it")
        }
        _ => advice,
    };
    scene.error_at("data", error.to_string(), "the readings of this scene", help)
}

/// The constants that the observers know: the scene's own, and those of the bodies that the model knows.
fn known_constants(
    scene: &Scene,
    system: &System,
    simulation: Option<&Simulation>,
    described: Option<&SystemMotion>,
) -> Result<BTreeMap<String, f64>, SceneError> {
    let settings = &scene.observer;
    let mut known = channels::split(&settings.known).0;
    let mut give = |name: &str, value: f64| {
        if system.find_symbol(name).is_some() && !settings.estimate.iter().any(|other| other == name) {
            known.entry(name.to_owned()).or_insert(value);
        }
    };
    if let Some(simulation) = simulation {
        for (name, value) in &simulation.constants {
            give(name, *value);
        }
    } else if let Some(simulated) = &scene.simulated {
        // a recording of what the scene describes
        for (name, value) in constants(scene, simulated, &body(scene, simulated)?.0) {
            give(&name, value);
        }
    } else if let Some(described) = described {
        let read = |name: &str| described.response.outputs.iter().any(|(output, _)| output == name);
        for (name, value) in described.response.constants.iter().filter(|(name, _)| !read(name)) {
            give(name, *value);
        }
    }
    Ok(known)
}

/// The columns without which the model is not determined.
fn needed(scene: &Scene, system: &System, known: &BTreeMap<String, f64>) -> Vec<String> {
    let settings = &scene.observer;
    let driven: Vec<&String> = settings.inputs.values().collect();
    let unknown =
        |name: &str| !known.contains_key(name) && !settings.estimate.iter().any(|other| other == name);
    let is_sought =
        |symbol: &Symbol| settings.estimate.iter().any(|name| system.symbol_name(*symbol) == name);
    let is_read = |node: &NodeId| system.graph.symbols_of([*node]).iter().any(is_sought);
    let outputs =
        system.outputs.iter().filter(|(name, node)| system.find_symbol(name).is_none() && is_read(node));
    let outputs: Vec<String> = outputs.map(|(name, _)| name.clone()).collect();
    let symbols = system.symbols().filter(|(symbol, info)| {
        let name = system.symbol_name(*symbol);
        unknown(name)
            && match info.kind {
                Kind::State => true,
                Kind::Parameter => info.default.is_none() || driven.iter().any(|other| *other == name),
                Kind::Imported => false,
            }
    });
    symbols.map(|(symbol, _)| system.symbol_name(symbol).to_owned()).chain(outputs).collect()
}

/// The scene's rules for faulty rows, with the resolution of what this system's sensors read.
fn fault_rules(scene: &Scene, system: &System) -> FaultRules {
    let mut rules = scene.fault_rules();
    let outputs = system.outputs.iter().map(|(name, _)| name.clone());
    rules.resolution.extend(outputs.map(|name| (name, scene.sensor.resolution)));
    rules
}

/// The range from which a state is drawn.
fn sample_range(system: &System, name: &str) -> Option<[f64; 2]> {
    let symbol = system.find_symbol(name)?;
    let range = system.symbol_info(symbol)?.range.clone().or_else(|| system.default_range(symbol))?;
    Some([&range.low, &range.high].map(rational_to_f64))
}

fn estimate_question(
    scene: &Scene,
    system: &System,
    truth: &dyn Fn(&str) -> Option<f64>,
    mut known: BTreeMap<String, f64>,
    signals: &Signals,
) -> Result<EstimateQuestion, SceneError> {
    let settings = &scene.observer;
    // a signal that never changes is a constant: the model then has only what the regime asks for
    for (place, name) in signals.names().iter().enumerate() {
        let column = signals.column(place);
        let steady = column.iter().all(|value| *value == column[0]);
        let met = system.find_symbol(name).is_some();
        let is_output = system.outputs.iter().any(|(output, _)| output == name);
        if met && steady && !is_output && !TOUCH.contains(&name.as_str()) && !settings.estimate.contains(name)
        {
            known.entry(name.clone()).or_insert(column[0]);
        }
    }
    let unguided = match settings.guess {
        Guess::None => Unguided::of(scene, system, &known, signals)?,
        Guess::Values(_) | Guess::Off(_) | Guess::Sample => Unguided::default(),
    };
    let mut guess = Vec::new();
    for name in &settings.estimate {
        let value = match (&settings.guess, truth(name)) {
            (Guess::Values(values), _) if values.contains_key(name) => values.get(name).copied(),
            // a sensor is taken to be right at first
            _ if CalibrationKind::of(name).is_some() => {
                CalibrationKind::of(name).map(|(_, kind)| kind.nominal())
            }
            (Guess::Sample, _) => sample_range(system, name).map(|[low, high]| (low + high) / 2.0),
            (Guess::None, _) => Some(unguided.value(scene, name)?),
            (Guess::Values(_), _) => None,
            (Guess::Off(off), Some(truth)) => Some(truth * (1.0 + off)),
            (Guess::Off(_), None) => None,
        };
        let missing = || {
            let help = "where there is no truth to be off from, give a value for each state under `guess`";
            scene.error_at(
                "observer.guess_off",
                format!("there is no first guess of '{name}'"),
                "asked for here",
                help,
            )
        };
        guess.push((name.clone(), value.ok_or_else(missing)?));
    }
    let inputs = settings.inputs.iter().map(|(field, symbol)| (field.clone(), symbol.clone())).collect();
    Ok(EstimateQuestion { guess, clamped: settings.clamp.clone(), known, inputs })
}
