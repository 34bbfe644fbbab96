//! What is known of a scene before its measurements: the system, the constants given to observers, the columns that they need.

use super::channels;
use super::known_motion::KnownMotion;
use super::least::{self, ConstantColumns};
use super::scene::hints::near;
use super::scene::{Guess, Scene, SceneError};
use super::simulation::{Simulation, body, constants};
use super::system_motion::{SystemMotion, known_signals};
use super::unguided::Unguided;
use palmistry_lang::{Kind, System};
use palmistry_math::expression::{NodeId, Symbol};
use palmistry_math::number::rational_to_f64;
use palmistry_observe::{
    CalibrationKind, ColumnNames, EmptyCells, EstimateQuestion, FaultRules, ModelError, Signals,
};
use std::collections::BTreeMap;

/// A scene with its system.
#[derive(Clone)]
pub(super) struct Groundwork {
    pub scene: Scene,
    pub system: System,
    /// The names of a recording's columns.
    pub names: ColumnNames,
    pub simulation: Option<Simulation>,
    /// The initial state of the body that the scene describes, where measurements come from elsewhere and guesses are off its values.
    pub begun: Option<Simulation>,
    /// The motion that the scene describes, whether it is measured or not; where it is not, only its initial sample.
    pub described: Option<SystemMotion>,
    /// Whether the measurements are simulated.
    pub simulates: bool,
    /// The constants that observers know.
    pub known: BTreeMap<String, f64>,
}

impl Groundwork {
    /// Of a scene whose measurements are simulated, or come from elsewhere.
    ///
    /// # Errors
    /// What is wrong with the scene or its model, with the place in the scene.
    pub fn of(scene: Scene, simulates: bool) -> Result<Groundwork, SceneError> {
        let system = System::read_named(&scene.model)?;
        Groundwork::with_system(scene, system, simulates)
    }

    /// The same with a system that is no file's.
    ///
    /// # Errors
    /// As for [`Groundwork::of`].
    pub fn with_system(scene: Scene, system: System, simulates: bool) -> Result<Groundwork, SceneError> {
        let names = scene.column_names(&system)?;
        let simulation = match (&scene.simulated, simulates) {
            (Some(simulated), true) => Some(Simulation::of(&scene, simulated)?),
            _ => None,
        };
        known_states(&scene, &system)?;
        let begun = match (&scene.simulated, &scene.observer.guess, simulates) {
            (Some(simulated), Guess::Off(_), false) => Some(Simulation::of_first_samples(&scene, simulated)?),
            _ => None,
        };
        // a recording of what the scene describes gets the same constants
        let described = match (&scene.system, &scene.robot) {
            (Some(own), _) if simulates => Some(SystemMotion::of(&scene, &system, own)?),
            (Some(own), _) => Some(SystemMotion::of_first_samples(&scene, &system, own)?),
            (None, Some(robot)) => Some(SystemMotion::of_robot(&scene, robot, simulates)?),
            (None, None) => None,
        };
        let known = known_constants(&scene, &system, simulation.as_ref(), described.as_ref())?;
        Ok(Groundwork { scene, system, names, simulation, begun, described, simulates, known })
    }

    /// The simulated motion, if there is one.
    pub fn simulated(&self) -> Option<&dyn KnownMotion> {
        match (&self.simulation, &self.described) {
            (Some(simulation), _) => Some(simulation),
            (None, Some(motion)) if self.simulates => Some(motion),
            _ => None,
        }
    }

    /// The columns without which the model is not determined.
    pub fn needed(&self) -> Vec<String> {
        needed(&self.scene, &self.system, &self.known)
    }

    /// The scene's rules for faulty rows, with the resolution of this system's sensors, and the meaning of empty cells.
    pub fn fault_rules(&self) -> FaultRules {
        let mut rules = fault_rules(&self.scene, &self.system);
        let outputs = compared(&self.scene, &self.system);
        let is_output = |name: &str| self.system.outputs.iter().any(|(output, _)| output == name);
        // an output that is compared and drives the model as well is neither left out nor interpolated
        for name in self.needed() {
            let empty = match (outputs.contains(&name), is_output(&name)) {
                (true, _) => EmptyCells::NotMeasured,
                (false, false) => EmptyCells::Interpolated,
                (false, true) => continue,
            };
            rules.empty.insert(name, empty);
        }
        rules
    }
}

/// Checks that everything estimated is a state of the system, before measurements or a first guess are asked for.
fn known_states(scene: &Scene, system: &System) -> Result<(), SceneError> {
    let signals = known_signals(system);
    let states = system.states.iter().filter(|state| !signals.contains(state));
    let states: Vec<&str> = states.map(|state| system.symbol_name(*state)).collect();
    for (index, name) in scene.observer.estimate.iter().enumerate() {
        let is_signal = system.find_symbol(name).is_some_and(|symbol| signals.contains(&symbol));
        if is_signal || scene.system.as_ref().is_some_and(|own| own.inputs.contains_key(name)) {
            let message =
                format!("'{name}' is an input: it is measured, or a function of time, and not estimated");
            let help = format!("leave it out; states are {}", states.join(", "));
            return Err(scene.error_at(
                &format!("observer.estimate[{index}]"),
                message,
                "estimated here",
                help,
            ));
        }
        if !states.contains(&name.as_str()) && !channels::is_calibration(system, name) {
            let help = match near(name, &states) {
                _ if name.contains(',') => {
                    "each name stands in quotation marks of its own, as in [\"x\", \"y\"]".to_owned()
                }
                _ if name == "all" => format!("name each: {}", states.join(", ")),
                Some(near) => format!("perhaps you meant '{near}'"),
                None => "an observer estimates states; constants are given".to_owned(),
            };
            let error = ModelError::NoState { name: name.clone(), states: states.join(", ") };
            let place = format!("observer.estimate[{index}]");
            return Err(scene.error_at(&place, error.to_string(), "estimated here", help));
        }
    }
    Ok(())
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
    let outputs = compared(scene, system);
    let symbols = system.symbols().filter(|(symbol, info)| {
        let name = system.symbol_name(*symbol);
        // where outputs tie signals these have derivatives for the rank, which no model has
        let is_for_the_rank = system.highest_lie_order().is_some()
            && system.derivative_of_signal(*symbol).is_some_and(|k| k > 0);
        unknown(name)
            && !is_for_the_rank
            && match info.kind {
                Kind::State => true,
                Kind::Parameter => info.default.is_none() || driven.iter().any(|other| *other == name),
                Kind::Imported => false,
            }
    });
    symbols.map(|(symbol, _)| system.symbol_name(symbol).to_owned()).chain(outputs).collect()
}

/// The outputs that are compared with the estimate, and drive nothing.
fn compared(scene: &Scene, system: &System) -> Vec<String> {
    let settings = &scene.observer;
    let is_sought =
        |symbol: &Symbol| settings.estimate.iter().any(|name| system.symbol_name(*symbol) == name);
    // a state that is both estimated and measured has to be there as any other output
    let is_sought_by = |name: &str| settings.estimate.iter().any(|other| other == name);
    let is_read = |node: &NodeId| system.graph.symbols_of([*node]).iter().any(is_sought);
    // an output that is zero measures nothing
    let zeros = system.zero_outputs();
    let outputs = system.outputs.iter().filter(|(_, node)| !zeros.contains(node));
    let outputs = outputs
        .filter(|(name, node)| (system.find_symbol(name).is_none() || is_sought_by(name)) && is_read(node));
    outputs.map(|(name, _)| name.clone()).collect()
}

/// The scene's rules for faulty rows, with the resolution of this system's sensors.
fn fault_rules(scene: &Scene, system: &System) -> FaultRules {
    let mut rules = scene.fault_rules();
    let outputs = system.outputs.iter().map(|(name, _)| name.clone());
    rules.resolution.extend(outputs.map(|name| (name, scene.sensor.resolution)));
    rules
}

/// How a column is treated that never changes in the measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Steady {
    /// A constant: the model then has only the terms of this regime.
    AreConstants,
    /// A column like others: what comes after is not known.
    AreColumns,
}

/// The range from which a state is drawn.
pub(super) fn sample_range(system: &System, name: &str) -> Option<[f64; 2]> {
    let symbol = system.find_symbol(name)?;
    let range = system.symbol_info(symbol)?.range.clone().or_else(|| system.default_range(symbol))?;
    Some([&range.low, &range.high].map(rational_to_f64))
}

pub(super) fn estimate_question(
    scene: &Scene,
    system: &System,
    truth: &dyn Fn(&str) -> Option<f64>,
    mut known: BTreeMap<String, f64>,
    signals: &Signals,
    steady: Steady,
) -> Result<EstimateQuestion, SceneError> {
    let settings = &scene.observer;
    // a column that never changes is a constant: the model then has only the terms of this regime
    if steady == Steady::AreConstants {
        known.extend(least::constants(scene, system, &known, signals, ConstantColumns::Driving));
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
