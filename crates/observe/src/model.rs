//! What an observer believes: the equations of some states of a system, everything else being given.

use super::{CalibrationKind, Signals, calibration};
use palmistry_lang::{Kind, Role, System};
use palmistry_math::expression::{NodeId, Program, Symbol};
use palmistry_math::number::{rational_from_f64, rational_to_f64};
use std::collections::{BTreeMap, HashMap};

/// Why a system gives no model.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)] // names and messages say it
pub enum ModelError {
    /// A name is no state of the system.
    #[error("'{name}' is no state of the system; its states are {states}")]
    NoState { name: String, states: String },
    /// A field is unknown.
    #[error("the system has no field '{name}'; its fields are {fields}")]
    NoField { name: String, fields: String },
    /// A field that nothing drives.
    #[error(
        "'{role} {name}' is no input of the system; write 'input {name}' in its file if something drives it"
    )]
    NotAnInput { name: String, role: &'static str },
    /// No field says how the states move.
    #[error("{why}")]
    NoMotion { why: String },
    /// A symbol is unknown.
    #[error("the system declares no '{name}'")]
    NoSymbol { name: String },
    /// Nothing gives the value of a symbol.
    #[error(
        "nothing determines '{name}': estimate it, give it under `known`, or hand over a column of that name"
    )]
    NotGiven { name: String },
    /// A value is infinite or none.
    #[error("the value of '{name}' is not finite")]
    NotFinite { name: String },
    /// No output depends on the estimated states.
    #[error(
        "no output depends on the states that are followed: there is nothing to compare with the measurements"
    )]
    Unobservable,
    /// An output is not measured.
    #[error("the output '{name}' is not among the measured columns ({columns})")]
    NotMeasured { name: String, columns: String },
    /// The delay of a column that is no output is to be estimated.
    #[error(
        "the delay of '{column}' cannot be estimated: no output of that name depends on what is followed"
    )]
    DelayOfInput { column: String },
    /// An expression has no value with what is known.
    #[error("with the given values the rate of '{name}' divides by zero")]
    Pole { name: String },
}

/// What a model is made from.
#[derive(Clone, Debug, Default)]
pub struct ModelQuestion {
    /// The states that are followed: their equations are integrated. All others are given.
    pub followed: Vec<String>,
    /// Constants that are known, by the names of states or parameters; they come before columns and defaults.
    pub known: BTreeMap<String, f64>,
    /// Input fields and the symbols that drive them: `x' = f + sum u_j g_j`, `f` being the system's drift.
    pub inputs: Vec<(String, String)>,
}

/// Where an input of a program comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InputSource {
    /// A followed state.
    State(usize),
    /// A column of the signals, by its place in [`Model::columns`].
    Column(usize),
    /// The rate of change of a column.
    Rate(usize),
}

/// Some expressions with the sources of their inputs.
#[derive(Clone, Debug)]
pub(super) struct Formulas {
    pub program: Program,
    pub sources: Vec<InputSource>,
}

/// The equations of the followed states, `x' = F(x, t)` and `y = h(x, t)`, with everything else a constant or a signal.
#[derive(Clone, Debug)]
pub struct Model {
    /// The followed states, in their order.
    pub states: Vec<String>,
    /// The outputs that depend on them, as they are written; each is a column of the signals, too.
    pub outputs: Vec<String>,
    pub(super) rates: Formulas,
    pub(super) output_formulas: Formulas,
    /// The columns of the signals that the formulas need.
    pub columns: Vec<usize>,
    /// The columns of the outputs; none of those that are zero, which tie states to measurements.
    pub(super) measured: Vec<Option<usize>>,
    /// The place of the state that is an output's delay, of those whose delay is estimated.
    pub(super) delays: Vec<Option<usize>>,
    /// The system with what is known put in, the rates and the outputs in its graph: for those who need their derivatives.
    pub system: System,
    /// The states that are followed.
    pub symbols: Vec<Symbol>,
    /// Their rates, one for each of `symbols`.
    pub rate_nodes: Vec<NodeId>,
    /// The outputs.
    pub output_nodes: Vec<NodeId>,
}

impl Model {
    /// The model of a system where these signals are measured.
    ///
    /// # Errors
    /// [`ModelError`].
    pub fn new(system: &System, question: &ModelQuestion, signals: &Signals) -> Result<Model, ModelError> {
        let mut system = system.clone();
        calibration::declare(&mut system, &question.followed);
        let symbols = symbols_of(&system, &question.followed)?;
        let (mut rates, mut outputs) = totals(&mut system, &symbols, &question.inputs)?;
        let zeros = system.zero_outputs();
        let are_zero: Vec<bool> = outputs.iter().map(|(_, node)| zeros.contains(node)).collect();
        calibration::put_in(&mut system, &question.followed, &mut rates, &mut outputs);
        let values = values_of(&mut system, question, &symbols, signals)?;
        for (rate, name) in rates.iter().zip(&question.followed) {
            if system.graph.vanishing_divisor(&[*rate], &values).is_some() {
                return Err(ModelError::Pole { name: name.clone() });
            }
        }
        let rate_nodes = system.graph.substitute(&rates, &values);
        let nodes: Vec<NodeId> = outputs.iter().map(|(_, node)| *node).collect();
        let nodes = system.graph.substitute(&nodes, &values);
        let mut model = Model {
            states: question.followed.clone(),
            outputs: Vec::new(),
            rates: Formulas { program: Program::plain(&system.graph, &[]), sources: Vec::new() },
            output_formulas: Formulas { program: Program::plain(&system.graph, &[]), sources: Vec::new() },
            columns: Vec::new(),
            measured: Vec::new(),
            delays: Vec::new(),
            system,
            symbols,
            rate_nodes,
            output_nodes: Vec::new(),
        };
        for (((name, _), node), is_zero) in outputs.iter().zip(nodes).zip(are_zero) {
            let depends = model.system.graph.symbols_of([node]);
            if model.symbols.iter().any(|symbol| depends.contains(symbol)) {
                let columns = signals.names().join(", ");
                let missing = || ModelError::NotMeasured { name: name.clone(), columns };
                if is_zero {
                    model.measured.push(None);
                    model.outputs.push(format!("0 = {name}"));
                } else {
                    model.measured.push(Some(signals.find(name).ok_or_else(missing)?));
                    model.outputs.push(name.clone());
                }
                model.output_nodes.push(node);
            }
        }
        let delay = |output: &String| model.find(&format!("{output}.{}", CalibrationKind::Delay.word()));
        model.delays = model.outputs.iter().map(delay).collect();
        model.rates = model.formulas(&model.rate_nodes.clone(), &HashMap::new(), signals)?;
        model.output_formulas = model.formulas(&model.output_nodes.clone(), &HashMap::new(), signals)?;
        Ok(model)
    }

    /// Expressions of the model's graph as a program; `rates` are symbols that stand for the rates of others.
    pub(super) fn formulas(
        &mut self,
        nodes: &[NodeId],
        rates: &HashMap<Symbol, Symbol>,
        signals: &Signals,
    ) -> Result<Formulas, ModelError> {
        let program = Program::plain(&self.system.graph, nodes);
        let mut sources = Vec::new();
        for input in program.inputs() {
            let Some(symbol) = input.symbol() else { continue };
            if let Some(place) = self.symbols.iter().position(|other| *other == symbol) {
                sources.push(InputSource::State(place));
                continue;
            }
            let whose = rates.get(&symbol).copied();
            let name = self.system.symbol_name(whose.unwrap_or(symbol));
            let not_given = || ModelError::NotGiven { name: name.to_owned() };
            let column = signals.find(name).ok_or_else(not_given)?;
            let place = self.columns.iter().position(|other| *other == column).unwrap_or_else(|| {
                self.columns.push(column);
                self.columns.len() - 1
            });
            sources.push(if whose.is_some() { InputSource::Rate(place) } else { InputSource::Column(place) });
        }
        Ok(Formulas { program, sources })
    }

    /// The place of a followed state.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.states.iter().position(|other| other == name)
    }

    /// The column that measures a followed state itself, where there is one.
    pub fn column_of(&self, state: usize) -> Option<usize> {
        let place = self.outputs.iter().position(|output| *output == self.states[state])?;
        self.measured[place]
    }

    /// Whether an output is implicit: zero at the true state and measurements, so that it has no measurement of its own.
    pub fn is_implicit(&self, output: usize) -> bool {
        self.measured.get(output).is_some_and(Option::is_none)
    }

    /// The names of the columns that the outputs depend on, directly.
    pub fn read_columns<'s>(&self, signals: &'s Signals) -> Vec<&'s str> {
        let sources = self.output_formulas.sources.iter().filter_map(|source| match source {
            InputSource::Column(place) => Some(signals.names()[self.columns[*place]].as_str()),
            InputSource::State(_) | InputSource::Rate(_) => None,
        });
        sources.collect()
    }

    /// Whether an output is implicit.
    pub fn has_implicit(&self) -> bool {
        self.measured.iter().any(Option::is_none)
    }

    /// Whether a followed state does not move, whatever the others are.
    pub fn is_constant_state(&self, state: usize) -> bool {
        let rate = self.rate_nodes.get(state).and_then(|node| self.system.graph.constant_value(*node));
        rate.is_some_and(|rate| rate.is_zero())
    }

    /// The operations of the equations.
    pub fn operations(&self) -> usize {
        self.rates.program.len()
    }
}

fn symbols_of(system: &System, names: &[String]) -> Result<Vec<Symbol>, ModelError> {
    let list = || system.states.iter().map(|s| system.symbol_name(*s)).collect::<Vec<_>>().join(", ");
    let symbol = |name: &String| {
        let found = system.find_symbol(name).filter(|symbol| system.states.contains(symbol));
        found.ok_or_else(|| ModelError::NoState { name: name.clone(), states: list() })
    };
    names.iter().map(symbol).collect()
}

type Outputs = Vec<(String, NodeId)>;

/// The rates of some states along the drift and the driven input fields, and the outputs.
pub(super) fn totals(
    system: &mut System,
    symbols: &[Symbol],
    inputs: &[(String, String)],
) -> Result<(Vec<NodeId>, Outputs), ModelError> {
    let list = || system.fields.iter().map(|field| field.name.as_str()).collect::<Vec<_>>().join(", ");
    system.require_motion().map_err(|why| ModelError::NoMotion { why })?;
    let flows = system.require_continuous("observers follow flows");
    flows.map_err(|why| ModelError::NoMotion { why })?;
    let mut driven = Vec::new();
    for (field, symbol) in inputs {
        let place = system.fields.iter().position(|other| other.name == *field);
        let place = place.ok_or_else(|| ModelError::NoField { name: field.clone(), fields: list() })?;
        let role = system.fields[place].role;
        if role != Role::Input {
            return Err(ModelError::NotAnInput { name: field.clone(), role: role.name() });
        }
        let missing = || ModelError::NoSymbol { name: symbol.clone() };
        driven.push((place, system.find_symbol(symbol).ok_or_else(missing)?));
    }
    let mut rates = Vec::new();
    for symbol in symbols {
        let component = |system: &System, field: usize| {
            let found = system.fields.get(field)?.components.iter().find(|(other, _)| other == symbol)?;
            Some(found.1)
        };
        let drift = system.drift().and_then(|drift| component(system, drift));
        let mut rate = drift.unwrap_or_else(|| system.graph.integer(0));
        for (field, input) in &driven {
            if let Some(moved) = component(system, *field) {
                let input = system.graph.symbol(*input);
                let term = system.graph.mul(input, moved);
                rate = system.graph.add(rate, term);
            }
        }
        rates.push(rate);
    }
    Ok((rates, system.outputs.clone()))
}

/// The rates of some states along the drift and the driven input fields: `f + sum u_j g_j`, with a field and the symbol that drives it.
///
/// # Errors
/// [`ModelError`]: no motion, no such field, no such symbol.
pub fn total_rates(
    system: &mut System,
    states: &[Symbol],
    inputs: &[(String, String)],
) -> Result<Vec<NodeId>, ModelError> {
    totals(system, states, inputs).map(|(rates, _)| rates)
}

/// The constants among the symbols: what is known, and the file's own values of parameters that no column gives.
fn values_of(
    system: &mut System,
    question: &ModelQuestion,
    followed: &[Symbol],
    signals: &Signals,
) -> Result<HashMap<Symbol, NodeId>, ModelError> {
    let mut values = parameter_values(system, &question.known, |name| signals.find(name).is_some())?;
    values.retain(|symbol, _| !followed.contains(symbol));
    Ok(values)
}

/// The given values of symbols, and the file's own values of parameters without one that are not `given` otherwise.
pub fn parameter_values(
    system: &mut System,
    told: &BTreeMap<String, f64>,
    given: impl Fn(&str) -> bool,
) -> Result<HashMap<Symbol, NodeId>, ModelError> {
    let mut values = HashMap::new();
    for (name, value) in told {
        let missing = || ModelError::NoSymbol { name: name.clone() };
        let symbol = system.find_symbol(name).ok_or_else(missing)?;
        let exact = rational_from_f64(*value);
        let exact = exact.ok_or_else(|| ModelError::NotFinite { name: name.clone() })?;
        values.insert(symbol, system.graph.rational(exact));
    }
    let defaults: Vec<_> = system
        .symbols()
        .filter(|(symbol, info)| info.kind == Kind::Parameter && !values.contains_key(symbol))
        .filter_map(|(symbol, info)| Some((symbol, info.default.clone()?)))
        .filter(|(symbol, _)| !given(system.symbol_name(*symbol)))
        .collect();
    for (symbol, value) in defaults {
        // the nearest double: what a column would have given
        let value = rational_from_f64(rational_to_f64(&value)).unwrap_or(value);
        let value = system.graph.rational(value);
        values.insert(symbol, value);
    }
    Ok(values)
}
