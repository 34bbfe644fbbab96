//! The motion of a system from a state that is given, under inputs that are functions of time: what observers are tried on where
//! nothing was recorded.
//!
//! It is integrated with the functions themselves; observers get them sampled, as they get everything that is measured.

use super::flow::advance;
use super::model::{parameter_values, totals};
use super::{Lost, ModelError};
use palmistry_lang::{Kind, ReadError, SymbolInfo, System, nearest};
use palmistry_math::expression::{Loaded, NodeId, Program, Symbol, gradient};
use palmistry_math::number::{Duals, Refusal, rational_to_f64};
use std::cell::Cell;
use std::collections::{BTreeMap, HashMap};

/// The name of time in functions of it.
pub const TIME: &str = "t";

/// What moves, and what moves it.
#[derive(Clone, Debug, Default)]
pub struct ResponseQuestion {
    /// States at the first time, and values of parameters that replace those in the file.
    pub start: BTreeMap<String, f64>,
    /// Functions of the time `t`, by the names of the signals or parameters that they stand for.
    pub functions: BTreeMap<String, String>,
    /// Input fields and the symbols that drive them.
    pub inputs: Vec<(String, String)>,
}

/// Why a system does not move.
#[derive(Clone, Debug, thiserror::Error)]
#[allow(missing_docs)] // names and messages say it
pub enum ResponseError {
    /// The system gives no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A name is neither a state nor a parameter of the system.
    #[error("the system declares no '{name}'{near}")]
    NoSymbol { name: String, near: String },
    /// A state has no value at the first time.
    #[error("nothing gives the initial condition of '{name}'")]
    NoStart { name: String },
    /// A state that moves by its equations has a function.
    #[error("'{name}' moves by its own equation, and is no function of time")]
    Moves { name: String },
    /// A function cannot be read.
    #[error("{name} = {text}: {why}")]
    Function { name: String, text: String, why: String, help: Option<String> },
    /// There are no outputs.
    #[error("the system has no outputs: there is nothing to read")]
    NoOutput,
    /// There is no value at the first time.
    #[error(transparent)]
    Lost(#[from] Lost),
}

/// A system's motion, sample by sample.
#[derive(Clone, Debug)]
pub struct Response {
    /// In s.
    pub times: Vec<f64>,
    /// The states, with their values.
    pub states: Vec<(String, Vec<f64>)>,
    /// The outputs as the file writes them, with their values.
    pub outputs: Vec<(String, Vec<f64>)>,
    /// The known inputs with their values, in the file's order.
    pub inputs: Vec<(String, Vec<f64>)>,
    /// Constants with the values that were taken: parameters, and states that do not move.
    pub constants: BTreeMap<String, f64>,
    /// Where it ended before the last time, and why.
    pub ended: Option<Lost>,
}

/// The motion of a system from a state that is given.
///
/// # Errors
/// [`ResponseError`]. A motion that ends before the last time is no error: see [`Response::ended`].
pub fn response(
    given: &System,
    question: &ResponseQuestion,
    times: &[f64],
) -> Result<Response, ResponseError> {
    let mut system = given.clone();
    let moving = moving(&system, question)?;
    known_names(&system, question)?;
    if system.outputs.is_empty() {
        return Err(ResponseError::NoOutput);
    }
    let time = time_symbol(&mut system);
    let (rates, outputs) = totals(&mut system, &moving, &question.inputs)?;
    let start = starts(&system, question, &moving, &rates)?;
    let mut constants =
        parameter_values(&mut system, &question.start, |name| question.functions.contains_key(name))?;
    constants.retain(|symbol, _| !moving.contains(symbol));
    let functions =
        functions(&mut system, question, time, &constants, times.first().copied().unwrap_or_default())?;
    let mut values = constants.clone();
    values.extend(functions.iter().map(|(symbol, node)| (*symbol, *node)));
    let nodes: Vec<NodeId> = rates.iter().copied().chain(outputs.iter().map(|(_, node)| *node)).collect();
    let mut nodes = system.graph.substitute(&nodes, &values);
    nodes.extend(functions.iter().map(|(_, node)| *node));
    let told = |symbol: &Symbol| *symbol == time || moving.contains(symbol);
    if let Some(symbol) = system.graph.symbols_of(nodes.iter().copied()).iter().find(|symbol| !told(symbol)) {
        return Err(ModelError::NotGiven { name: system.symbol_name(*symbol).to_owned() }.into());
    }
    let motion = Motion { system: &system, nodes: &nodes, moving: &moving };
    let (states, seen, ended) = motion.follow(&start, times)?;
    let name = |symbol: &Symbol| system.symbol_name(*symbol).to_owned();
    let column = |rows: &[Vec<f64>], place: usize| rows.iter().map(|row| row[place]).collect::<Vec<f64>>();
    let is_known = |symbol: &Symbol| !system.states.contains(symbol) || system.known.contains(symbol);
    let inputs = functions.iter().enumerate().filter(|(_, (symbol, _))| is_known(symbol));
    let at_rest = moving.iter().zip(&rates).zip(&start).filter(|((_, rate), _)| is_zero(&system, **rate));
    let mut told: BTreeMap<String, f64> =
        at_rest.map(|((symbol, _), value)| (name(symbol), *value)).collect();
    told.extend(constants.iter().filter_map(|(symbol, node)| {
        Some((name(symbol), rational_to_f64(system.graph.constant_value(*node)?)))
    }));
    Ok(Response {
        times: times[..states.len()].to_vec(),
        inputs: inputs
            .map(|(place, (symbol, _))| (name(symbol), column(&seen, outputs.len() + place)))
            .collect(),
        outputs: outputs.iter().enumerate().map(|(i, (text, _))| (text.clone(), column(&seen, i))).collect(),
        states: moving.iter().enumerate().map(|(i, symbol)| (name(symbol), column(&states, i))).collect(),
        constants: told,
        ended,
    })
}

fn is_zero(system: &System, node: NodeId) -> bool {
    system.graph.constant_value(node).is_some_and(|value| value.is_zero())
}

/// The states that move by their equations: all but the signals that functions of time stand for, and their derivatives.
fn moving(system: &System, question: &ResponseQuestion) -> Result<Vec<Symbol>, ResponseError> {
    let signals = system.signal_chains();
    for name in question.functions.keys() {
        let symbol = system.find_symbol(name);
        let is_state = symbol.is_some_and(|symbol| system.states.contains(&symbol));
        if is_state && !signals.iter().any(|chain| chain.first() == symbol.as_ref()) {
            return Err(ResponseError::Moves { name: name.clone() });
        }
    }
    let is_given = |state: &Symbol| {
        let chain = signals.iter().find(|chain| chain.contains(state));
        chain.is_some_and(|chain| question.functions.contains_key(system.symbol_name(chain[0])))
    };
    Ok(system.states.iter().copied().filter(|state| !is_given(state)).collect())
}

fn known_names(system: &System, question: &ResponseQuestion) -> Result<(), ResponseError> {
    for name in question.start.keys().chain(question.functions.keys()) {
        if system.find_symbol(name).is_none() {
            let names: Vec<&str> = system.symbols().map(|(symbol, _)| system.symbol_name(symbol)).collect();
            // a name that differs in capital letters alone before all others
            let same = names.iter().find(|other| other.eq_ignore_ascii_case(name)).copied();
            let near = same.or_else(|| nearest(name, names.iter().copied()));
            let near = near.map_or_else(String::new, |near| format!("; perhaps you meant '{near}'"));
            return Err(ResponseError::NoSymbol { name: name.clone(), near });
        }
    }
    Ok(())
}

/// The symbol of time: a name of its own, unless the file has something else of that name.
fn time_symbol(system: &mut System) -> Symbol {
    let own = system.find_symbol(TIME).is_some();
    let symbol = system.graph.intern(if own { "(time)" } else { TIME });
    let info = SymbolInfo { kind: Kind::Parameter, is_angle: false, default: None, range: None };
    system.symbols.insert(symbol, info);
    symbol
}

fn starts(
    system: &System,
    question: &ResponseQuestion,
    moving: &[Symbol],
    rates: &[NodeId],
) -> Result<Vec<f64>, ResponseError> {
    let start = |(symbol, rate): (&Symbol, &NodeId)| {
        let name = system.symbol_name(*symbol);
        let value = question.start.get(name).copied();
        // what does not move has the value that the file gives as a hint
        let hint = || system.hint(*symbol).filter(|_| is_zero(system, *rate)).map(rational_to_f64);
        value.or_else(hint).ok_or_else(|| ResponseError::NoStart { name: name.to_owned() })
    };
    moving.iter().zip(rates).map(start).collect()
}

/// The functions of time with the symbols that they stand for, derivatives of signals among them.
fn functions(
    system: &mut System,
    question: &ResponseQuestion,
    time: Symbol,
    constants: &HashMap<Symbol, NodeId>,
    first: f64,
) -> Result<Vec<(Symbol, NodeId)>, ResponseError> {
    let mut found = Vec::new();
    let chains = system.signal_chains();
    for (name, text) in &question.functions {
        let wrong_as = |why: String, help: Option<String>| {
            let (name, text) = (name.clone(), text.clone());
            ResponseError::Function { name, text, why, help }
        };
        let wrong = |why: String| wrong_as(why, None);
        let value = system
            .evaluate_text(text)
            .map_err(|error: ReadError| wrong_as(error.to_string(), error.help.clone()))?;
        let node = value.as_number().ok_or_else(|| wrong("it is no number".to_owned()))?;
        let mut node = system.graph.substitute(&[node], constants)[0];
        let others = system.graph.symbols_of([node]);
        if let Some(other) = others.iter().find(|symbol| **symbol != time) {
            let other = system.symbol_name(*other).to_owned();
            return Err(wrong(format!(
                "a function of the time t alone is meant, and it depends on '{other}'"
            )));
        }
        // without this it would be the state that has no value
        if let Some(refusal) = refusal_at(system, node, first) {
            return Err(wrong(format!("it has no value at t = {first}: {refusal}")));
        }
        let Some(symbol) = system.find_symbol(name) else { continue };
        found.push((symbol, node));
        let chain = chains.iter().find(|chain| chain.first() == Some(&symbol)).cloned().unwrap_or_default();
        for derivative in chain.into_iter().skip(1) {
            node = gradient(&mut system.graph, node, &[time])[0];
            found.push((derivative, node));
        }
    }
    Ok(found)
}

/// Why a function of time has no value at a time.
fn refusal_at(system: &System, node: NodeId, time: f64) -> Option<Refusal> {
    let program = Program::plain(&system.graph, &[node]);
    let inputs = vec![time; program.inputs().len()];
    let loaded = program.load(Duals::<f64>::default());
    match loaded.map(|loaded| loaded.run(&inputs, &mut Vec::new()).map(|_| ())) {
        Err(refusal) => Some(refusal),
        Ok(Err(error)) => Some(error.refusal),
        Ok(Ok(())) => None,
    }
}

/// Rates, then outputs, then functions, as expressions of the moving states and time.
struct Motion<'a> {
    system: &'a System,
    nodes: &'a [NodeId],
    moving: &'a [Symbol],
}

/// The error of a step: what observers find has to be theirs, and not this integration's.
const TOLERANCE: f64 = 1e-12;

type Rows = Vec<Vec<f64>>;

impl Motion<'_> {
    /// Where the inputs of a program come from: the place of a state, or none for time.
    fn places(&self, program: &Program) -> Vec<Option<usize>> {
        let symbols = program.inputs().iter().filter_map(|input| input.symbol());
        symbols.map(|symbol| self.moving.iter().position(|other| *other == symbol)).collect()
    }

    /// States, outputs and functions, and where it ended early.
    fn follow(&self, start: &[f64], times: &[f64]) -> Result<(Rows, Rows, Option<Lost>), Lost> {
        let n = self.moving.len();
        let graph = &self.system.graph;
        let rates = Program::plain(graph, &self.nodes[..n]);
        let seen = Program::plain(graph, &self.nodes[n..]);
        let refuse =
            |time: f64, refusal: Refusal| Lost { time, why: format!("the system has no value: {refusal}") };
        let first = |refusal: Refusal| refuse(times[0], refusal);
        let (rate_places, seen_places) = (self.places(&rates), self.places(&seen));
        let rates = rates.load(Duals::<f64>::default()).map_err(first)?;
        let seen = seen.load(Duals::<f64>::default()).map_err(first)?;
        let evaluate =
            |program: &Loaded<'_, Duals<f64>>, places: &[Option<usize>], time: f64, state: &[f64]| {
                let inputs: Vec<f64> =
                    places.iter().map(|place| place.map_or(time, |place| state[place])).collect();
                program.run(&inputs, &mut Vec::new()).map_err(|error| error.refusal)
            };
        let failure: Cell<Option<(f64, Refusal)>> = Cell::new(None);
        let right_hand_side =
            |time: f64, y: &[f64], dy: &mut [f64]| match evaluate(&rates, &rate_places, time, y) {
                Ok(values) => dy.copy_from_slice(&values),
                Err(refusal) => {
                    failure.set(Some((time, refusal)));
                    dy.fill(f64::NAN);
                }
            };
        let (mut states, mut others) = (Vec::new(), Vec::new());
        let mut state = start.to_vec();
        for (i, time) in times.iter().enumerate() {
            if i > 0 {
                failure.set(None);
                match advance(&right_hand_side, times[i - 1], *time, &state, TOLERANCE) {
                    Ok(there) => state = there,
                    Err(lost) => {
                        let lost = failure.get().map_or(lost, |(time, refusal)| refuse(time, refusal));
                        // one sample is no motion
                        return if i == 1 { Err(lost) } else { Ok((states, others, Some(lost))) };
                    }
                }
            }
            let values =
                evaluate(&seen, &seen_places, *time, &state).map_err(|refusal| refuse(*time, refusal));
            match values {
                Ok(values) if values.iter().all(|value| value.is_finite()) => others.push(values),
                Ok(_) if i > 0 => {
                    let why = "an output is not finite".to_owned();
                    return Ok((states, others, Some(Lost { time: *time, why })));
                }
                Err(lost) if i > 0 => return Ok((states, others, Some(lost))),
                Ok(_) => return Err(Lost { time: *time, why: "an output is not finite".to_owned() }),
                Err(lost) => return Err(lost),
            }
            states.push(state.clone());
        }
        Ok((states, others, None))
    }
}

#[cfg(test)]
mod tests;
