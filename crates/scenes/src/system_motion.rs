//! A system that moves by its own equations, and its measurements.
//!
//! Observers that know the same equations are tested on it: their estimates are compared with the true state of the motion. It is no
//! independent check of the equations, as a body between palms is.

use super::scene::hints;
use super::scene::{Channel, Scene, SceneError, Sensor, SimulatedSystem};
use super::simulation::{FIRST_SAMPLES, read_with_errors};
use palmistry_lang::{Kind, System};
use palmistry_math::expression::Symbol;
use palmistry_observe::{Lost, ModelError, Record, RecordError, Response, ResponseError, ResponseQuestion};
use std::collections::BTreeMap;

/// What `[inputs]` is for.
const INPUTS: &str =
    "[inputs] has a function of the time t for each known signal, or for a parameter that a signal drives";

/// Why a system cannot move as a scene says, at its place in the scene.
fn refused(scene: &Scene, system: &System, simulated: &SimulatedSystem, error: &ResponseError) -> SceneError {
    let at = |place: &str, help: &str| scene.error_at(place, error.to_string(), "here", help);
    let at_key = |place: [&str; 2], help: &str| scene.error_at_key(&place, error.to_string(), "here", help);
    match error {
        ResponseError::NoSymbol { name, .. } if simulated.start.contains_key(name) => {
            let signals = known_signals(system);
            let of = |kind: Kind| {
                let all =
                    system.symbols().filter(|(symbol, info)| info.kind == kind && !signals.contains(symbol));
                all.map(|(symbol, _)| system.symbol_name(symbol)).take(20).collect::<Vec<_>>().join(", ")
            };
            let help = format!(
                "[start] has a value for each state, and for constants; states: {}; parameters: {}",
                of(Kind::State),
                of(Kind::Parameter)
            );
            at_key(["start", name], &help)
        }
        ResponseError::NoSymbol { name, .. } | ResponseError::Moves { name } => {
            at_key(["inputs", name], INPUTS)
        }
        ResponseError::Function { name, text, help, .. } => at(
            &format!("inputs.{name}"),
            &hints::of_function(text, help.as_deref()).unwrap_or_else(|| INPUTS.to_owned()),
        ),
        ResponseError::Model(
            ModelError::NoField { .. } | ModelError::NoSymbol { .. } | ModelError::NotAnInput { .. },
        ) => at("observer.inputs", "inputs = { field = \"symbol\" } says what drives a field"),
        ResponseError::Model(ModelError::NotGiven { .. }) => at(
            "start",
            "give constants a value here, and what changes a function of the time t under [inputs]",
        ),
        ResponseError::NoStart { name } => {
            let is_signal = system.known_signals().iter().any(|symbol| system.symbol_name(*symbol) == name);
            if is_signal {
                let place = if simulated.inputs.is_empty() { "start" } else { "inputs" };
                let help = format!("add a function of the time t to [inputs], as in {name} = \"0.1*sin(t)\"");
                return scene.error_at(place, format!("nothing says what drives '{name}'"), "here", help);
            }
            at(
                "start",
                &format!("add {name} = ... below [start]; a constant may have a value in the proof file too"),
            )
        }
        ResponseError::Lost(_) => at("start", "each state begins at a value at which the equations exist"),
        ResponseError::Model(_) | ResponseError::NoOutput => {
            at("model", "what is simulated has a drift or inputs, and outputs")
        }
    }
}

/// A system's motion.
#[derive(Clone, Debug)]
pub struct SystemMotion {
    /// States, outputs, inputs, constants.
    pub response: Response,
}

impl SystemMotion {
    /// Moves the system of a scene.
    ///
    /// # Errors
    /// Where the system cannot move so, with the place in the scene.
    pub fn of(
        scene: &Scene,
        system: &System,
        simulated: &SimulatedSystem,
    ) -> Result<SystemMotion, SceneError> {
        SystemMotion::of_samples(scene, system, simulated, usize::MAX)
    }

    /// The start of the same motion: its first sample is that of the whole motion.
    ///
    /// # Errors
    /// As [`SystemMotion::of`].
    pub(super) fn of_first_samples(
        scene: &Scene,
        system: &System,
        simulated: &SimulatedSystem,
    ) -> Result<SystemMotion, SceneError> {
        SystemMotion::of_samples(scene, system, simulated, FIRST_SAMPLES)
    }

    fn of_samples(
        scene: &Scene,
        system: &System,
        simulated: &SimulatedSystem,
        most: usize,
    ) -> Result<SystemMotion, SceneError> {
        if !system.zero_outputs().is_empty() {
            let help = "simulate with these measurements as outputs, solved for, and hand over the record as `[data] record` here";
            let message =
                "an output that is zero ties measurements to states, and nothing here solves it for them";
            return Err(scene.error_at("model", message.to_owned(), "has such an output", help));
        }
        let inputs = &scene.observer.inputs;
        let question = ResponseQuestion {
            start: simulated.start.clone(),
            functions: simulated.inputs.clone(),
            inputs: inputs.iter().map(|(field, symbol)| (field.clone(), symbol.clone())).collect(),
        };
        let mut times = simulated.times(scene.sensor.jitter, scene.seed);
        times.truncate(most);
        let response = palmistry_observe::response(system, &question, &times)
            .map_err(|error| refused(scene, system, simulated, &error))?;
        Ok(SystemMotion { response })
    }

    /// Where the motion ended before its last sample, and why.
    pub fn ended(&self) -> Option<&Lost> {
        self.response.ended.as_ref()
    }

    /// The true values of a state or a constant, sample by sample.
    pub fn truth(&self, name: &str) -> Option<Vec<f64>> {
        let states = &self.response.states;
        let constant = || Some(vec![*self.response.constants.get(name)?; self.response.times.len()]);
        states.iter().find(|(other, _)| other == name).map(|(_, values)| values.clone()).or_else(constant)
    }

    /// All of the motion, as a table: states, outputs and inputs in the units of the file, times in s.
    ///
    /// # Errors
    /// Where two columns have one name.
    pub fn table(&self) -> Result<Record, RecordError> {
        let response = &self.response;
        let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
        for (name, values) in response.states.iter().chain(&response.outputs).chain(&response.inputs) {
            // an output that is a state is one column
            if !columns.iter().any(|(other, _)| other == name) {
                columns.push((name.clone(), values.clone()));
            }
        }
        Record::new(response.times.clone(), columns)
    }

    /// The measurements: the outputs with the errors of the sensor, in their own unit, the inputs without error; columns that have a sensor of
    /// their own with its errors. The same seed gives the same errors, whatever their size.
    ///
    /// # Errors
    /// Where two columns have one name.
    pub fn read(
        &self,
        sensor: &Sensor,
        channels: &BTreeMap<String, Channel>,
        seed: u64,
    ) -> Result<Record, RecordError> {
        let response = &self.response;
        let mut columns: Vec<(String, Vec<f64>)> =
            response.outputs.iter().chain(&response.inputs).cloned().collect();
        let is_output = |name: &str| response.outputs.iter().any(|(output, _)| output == name);
        read_with_errors(&response.times, &mut columns, &is_output, sensor, channels, seed);
        Record::new(response.times.clone(), columns)
    }
}

/// The signals that somebody knows, with their derivatives.
pub(super) fn known_signals(system: &System) -> Vec<Symbol> {
    let known = system.known_signals();
    let chains = system.signal_chains().into_iter();
    chains.filter(|chain| chain.first().is_some_and(|first| known.contains(first))).flatten().collect()
}
