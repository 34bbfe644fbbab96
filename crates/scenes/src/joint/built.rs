//! From a scene and its measurements to a problem: the settings of each experiment are put into the model's equations.

use super::keys::{Formula, JointScene};
use super::rows::{MeasuredRow, MeasuredRows};
use super::unused::{refuse_unknown_errors, refuse_unused};
use palmistry_fit::{EstimatedParameter, JointExperiment, JointMeasurement, JointProblem, Phase};
use palmistry_lang::{Kind, ReadError, SymbolInfo, System, nearest};
use palmistry_math::expression::{NodeId, Symbol};
use palmistry_math::number::rational_from_f64;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::Path;

type Values = HashMap<Symbol, NodeId>;

impl JointScene {
    /// The problem, with the measurements of the scene or of another file.
    ///
    /// # Errors
    /// What is wrong with the model, the scene or the measurements, and where.
    pub fn problem(&self, data: Option<&Path>) -> Result<JointProblem, ReadError> {
        let mut system = System::read(&self.model)?;
        let rows = MeasuredRows::read(data.unwrap_or(&self.measurements))?;
        refuse_unknown_errors(self, &mut system, &rows)?;
        let unused = |rows: &MeasuredRows| refuse_unused(self, &system, rows, data.is_none());
        // a mistake in a formula may leave a name in none
        Building::new(self, system.clone())?.problem(rows, &unused)
    }
}

struct Building<'s> {
    scene: &'s JointScene,
    system: System,
    /// The estimated parameters.
    parameters: Vec<EstimatedParameter>,
    /// Parameters whose values are known, by the scene or by the file.
    known: Values,
    rates: Vec<NodeId>,
    states: Vec<Symbol>,
}

impl<'s> Building<'s> {
    fn new(scene: &'s JointScene, mut system: System) -> Result<Building<'s>, ReadError> {
        let no_motion = |why: String| scene.error_at("model", why, "a drift says how the states move");
        system
            .require_continuous("several experiments are followed in continuous time")
            .map_err(no_motion)?;
        let Some(drift) = system.drift() else {
            return Err(no_motion("the model has no drift".to_owned()));
        };
        let mut sought = BTreeSet::new();
        let mut parameters = Vec::new();
        for own in &scene.parameters {
            let place = format!("parameters.{}", own.name);
            let symbol = declared(scene, &mut system, &own.name, &place)?;
            sought.insert(symbol);
            parameters.push(EstimatedParameter {
                name: own.name.clone(),
                symbol,
                scale: own.scale,
                bounds: own.bounds,
                starts: own.starts,
                nominal: own.nominal,
                prior: own.prior,
            });
        }
        let mut known = Values::new();
        for (name, value) in &scene.known {
            let place = format!("known.{name}");
            let symbol = declared(scene, &mut system, name, &place)?;
            if sought.contains(&symbol) {
                return Err(scene.error_at(
                    &place,
                    format!("'{name}' is estimated, and cannot be known"),
                    "take it out of [parameters], or from here",
                ));
            }
            known.insert(symbol, number(&mut system, *value));
        }
        let defaults: Vec<_> = system
            .symbols()
            .filter(|(symbol, info)| {
                info.kind == Kind::Parameter && !sought.contains(symbol) && !known.contains_key(symbol)
            })
            .filter_map(|(symbol, info)| Some((symbol, info.default.clone()?)))
            .collect();
        for (symbol, value) in defaults {
            let node = system.graph.rational(value);
            known.insert(symbol, node);
        }
        // unknown parameters of the file are among its states, and have no dynamics
        let moves = |state: &Symbol| {
            system.fields[drift].components.iter().any(|(other, _)| other == state)
                || scene.initial.contains_key(system.symbol_name(*state))
        };
        let states: Vec<Symbol> =
            system.states.iter().copied().filter(|state| !sought.contains(state) && moves(state)).collect();
        let component = |system: &System, state: Symbol| {
            let found = system.fields[drift].components.iter().find(|(other, _)| *other == state);
            found.map(|(_, node)| *node)
        };
        let rates = states
            .iter()
            .map(|state| component(&system, *state).unwrap_or_else(|| system.graph.integer(0)))
            .collect();
        Ok(Building { scene, system, parameters, known, rates, states })
    }

    /// The value of a formula, at a place of the scene.
    fn value(&mut self, formula: &Formula, place: &str) -> Result<NodeId, ReadError> {
        match formula {
            Formula::Number(value) if value.is_finite() => Ok(number(&mut self.system, *value)),
            Formula::Number(value) => {
                Err(self.scene.error_at(place, format!("{value} is no finite number"), "give one"))
            }
            Formula::Text(text) => self.formula(text).map_err(|why| {
                let help = if why.1.is_empty() {
                    "a formula of names of the model and of [parameters]".to_owned()
                } else {
                    why.1
                };
                self.scene.error_at(place, why.0, help)
            }),
        }
    }

    /// The value of a formula; as an error, what is wrong with it and what to do, as text.
    fn formula(&mut self, text: &str) -> Result<NodeId, (String, String)> {
        let found = self
            .system
            .evaluate_text(text)
            .map_err(|why| (why.message.clone(), why.help.clone().unwrap_or_default()))?;
        found
            .as_number()
            .ok_or_else(|| (format!("'{text}' is {}, and no number", found.describe()), String::new()))
    }

    /// The settings of parameters, and of states at the start.
    fn settings(
        &mut self,
        set: &BTreeMap<String, Formula>,
        place: &str,
    ) -> Result<(Values, HashMap<Symbol, NodeId>), ReadError> {
        let (mut parameters, mut starts) = (Values::new(), HashMap::new());
        for (name, formula) in set {
            let at = format!("{place}.{name}");
            let Some(symbol) = self.system.find_symbol(name) else {
                let all: Vec<&str> =
                    self.system.symbols().map(|(symbol, _)| self.system.symbol_name(symbol)).collect();
                let help = match nearest(name, all.iter().copied()) {
                    Some(near) => format!("perhaps you meant '{near}'"),
                    None => "parameters and states of the model can be set".to_owned(),
                };
                return Err(self.scene.error_at(&at, format!("the model knows no '{name}'"), help));
            };
            let value = self.value(formula, &at)?;
            match self.states.contains(&symbol) {
                true => starts.insert(symbol, value),
                false => parameters.insert(symbol, value),
            };
        }
        Ok((parameters, starts))
    }

    /// A phase: its own settings take precedence over those known everywhere.
    fn phase(
        &mut self,
        (parameters, starts): &(Values, HashMap<Symbol, NodeId>),
        goes_on: bool,
    ) -> Result<Phase, ReadError> {
        let mut first: HashMap<Symbol, NodeId> = starts.clone();
        if !goes_on {
            for state in self.states.clone() {
                if first.contains_key(&state) {
                    continue;
                }
                let name = self.system.symbol_name(state).to_owned();
                let scene = self.scene;
                let Some(formula) = scene.initial.get(&name) else {
                    let help =
                        format!("add '{name} = 0' or a formula to [initial], or set it in the experiment");
                    return Err(scene.error_at(
                        "initial",
                        format!("nothing says what '{name}' is at the start"),
                        help,
                    ));
                };
                let value = self.value(formula, &format!("initial.{name}"))?;
                first.insert(state, value);
            }
        }
        // a start may be a formula of other starts
        let mut nodes: Vec<Option<NodeId>> =
            self.states.iter().map(|state| first.get(state).copied()).collect();
        for _ in 0..=self.states.len() {
            let depends = self.system.graph.symbols_of(nodes.iter().flatten().copied());
            if !depends.iter().any(|symbol| first.contains_key(symbol)) {
                break;
            }
            let given: Vec<NodeId> = nodes.iter().flatten().copied().collect();
            let mut moved = self.system.graph.substitute(&given, &first).into_iter();
            for node in nodes.iter_mut().flatten() {
                *node = moved.next().unwrap_or(*node);
            }
        }
        let start: Vec<NodeId> = nodes.iter().flatten().copied().collect();
        let depends = self.system.graph.symbols_of(start.iter().copied());
        if let Some(state) = self.states.iter().find(|state| depends.contains(state)) {
            let name = self.system.symbol_name(*state).to_owned();
            return Err(match goes_on && !first.contains_key(state) {
                true => self.scene.error_at(
                    "experiments",
                    format!("a start is a formula of '{name}', which goes on from what was before"),
                    format!("set '{name}' in the experiment as well, or give a formula of parameters"),
                ),
                false => self.scene.error_at(
                    &format!("initial.{name}"),
                    format!("the start of '{name}' depends on itself"),
                    "give it a value, or a formula of parameters",
                ),
            });
        }
        let mut start = self.put_in(&start, parameters)?.into_iter();
        let rates = self.put_in(&self.rates.clone(), parameters)?;
        let start = nodes.iter().map(|node| node.and_then(|_| start.next())).collect();
        Ok(Phase { rates, start })
    }

    /// Puts settings and known values into formulas.
    fn put_in(&mut self, nodes: &[NodeId], settings: &Values) -> Result<Vec<NodeId>, ReadError> {
        let mut all = nodes.to_vec();
        for values in [settings, &self.known] {
            if let Some(divisor) = self.system.graph.vanishing_divisor(&all, values) {
                let text = self.system.graph.text(divisor);
                return Err(self.scene.error_at(
                    "experiments",
                    format!("with what is set a formula is divided by zero: {text}"),
                    "set another value",
                ));
            }
            all = self.system.graph.substitute(&all, values);
        }
        Ok(all)
    }

    /// The problem; `unused` refuses what it does not need, once all else is right.
    fn problem(
        mut self,
        rows: MeasuredRows,
        unused: &dyn Fn(&MeasuredRows) -> Result<(), ReadError>,
    ) -> Result<JointProblem, ReadError> {
        let scene = self.scene;
        let unknown_state = scene
            .initial
            .keys()
            .find(|name| !self.system.find_symbol(name).is_some_and(|symbol| self.states.contains(&symbol)));
        if let Some(name) = unknown_state {
            let all: Vec<&str> = self.states.iter().map(|state| self.system.symbol_name(*state)).collect();
            return Err(scene.error_at(
                &format!("initial.{name}"),
                format!("'{name}' is no state of the model"),
                format!("its states are {}", all.join(", ")),
            ));
        }
        let mut experiments = Vec::new();
        let mut settings = Vec::new();
        for (name, own) in &scene.experiments {
            let place = format!("experiments.{name}");
            let before = match &own.before {
                Some(set) => {
                    let set = self.settings(set, &format!("{place}.before"))?;
                    Some(self.phase(&set, false)?)
                }
                None => None,
            };
            let set = self.settings(&own.set, &format!("{place}.set"))?;
            let phase = self.phase(&set, before.is_some())?;
            settings.push(set.0);
            experiments.push(JointExperiment { name: name.clone(), before, phase });
        }
        let places: HashMap<&str, usize> =
            scene.experiments.iter().enumerate().map(|(at, (name, _))| (name.as_str(), at)).collect();
        let mut measurements = Vec::new();
        let moving = self.symbols_of_the_motion()?;
        let mut known: HashMap<(usize, String, String), [NodeId; 2]> = HashMap::new();
        for row in &rows.rows {
            let Some(experiment) = places.get(row.experiment.as_str()).copied() else {
                let all = scene.experiments.iter().map(|(name, _)| name.as_str());
                let help = match nearest(&row.experiment, all.clone()) {
                    Some(near) => format!("perhaps you meant '{near}'"),
                    None => format!("the scene has {}", all.take(20).collect::<Vec<_>>().join(", ")),
                };
                let message = format!(
                    "the scene has no experiment '{}'",
                    palmistry_io::foreign::shown(&row.experiment)
                );
                return Err(rows.error(row, message, help));
            };
            let Some(error) = scene.errors.get(&row.output) else {
                let message = format!(
                    "the scene says nothing of the errors of '{}'",
                    palmistry_io::foreign::shown(&row.output)
                );
                let help = match nearest(&row.output, scene.errors.keys().map(String::as_str)) {
                    Some(near) => format!("perhaps you meant '{near}'; or add it to [errors]"),
                    None => "add it to [errors], for instance: y = { size = 0.1 }".to_owned(),
                };
                return Err(rows.error(row, message, help));
            };
            if error.scale() != palmistry_fit::ErrorScale::Linear && row.value <= 0.0 {
                return Err(rows.error(
                    row,
                    format!("{} has no logarithm, and '{}' is compared by it", row.value, row.output),
                    "leave the row out, or compare on = \"linear\"",
                ));
            }
            let key = (experiment, row.output.clone(), row.set.clone());
            let formulas = match known.get(&key) {
                Some(formulas) => *formulas,
                None => {
                    let found = self.measured((row, &rows), &settings[experiment], &error.size, &moving)?;
                    known.insert(key, found);
                    found
                }
            };
            measurements.push(JointMeasurement {
                experiment,
                output: row.output.clone(),
                time: row.time,
                value: row.value,
                expected: formulas[0],
                size: formulas[1],
                scale: error.scale(),
                law: error.law(),
            });
        }
        unused(&rows)?;
        let one = self.system.graph.integer(1);
        let clock = self.rates.iter().position(|rate| *rate == one);
        Ok(JointProblem {
            clock,
            states: self.states,
            parameters: self.parameters,
            experiments,
            measurements,
            system: self.system,
        })
    }

    /// What the rates and the states at the start depend on.
    fn symbols_of_the_motion(&mut self) -> Result<HashSet<Symbol>, ReadError> {
        let mut nodes = self.rates.clone();
        let scene = self.scene;
        for (name, formula) in &scene.initial {
            nodes.push(self.value(formula, &format!("initial.{name}"))?);
        }
        Ok(self.system.graph.symbols_of(nodes).into_iter().collect())
    }

    /// The expected value of a row, and the size of its error.
    fn measured(
        &mut self,
        (row, rows): (&MeasuredRow, &MeasuredRows),
        settings: &Values,
        size: &Formula,
        moving: &HashSet<Symbol>,
    ) -> Result<[NodeId; 2], ReadError> {
        let at_row = |why: (String, String)| rows.error(row, why.0, why.1);
        let mut own = Values::new();
        for part in row.set.split(';').map(str::trim).filter(|part| !part.is_empty()) {
            let Some((name, value)) = part.split_once('=') else {
                return Err(rows.error(
                    row,
                    format!("'{}' sets nothing", palmistry_io::foreign::shown(part)),
                    "write name = value, several apart by ;",
                ));
            };
            let name = name.trim();
            let symbol = self.system.find_symbol(name).filter(|symbol| !self.states.contains(symbol));
            // a name that only formulas of this scene have
            let symbol = match symbol {
                Some(symbol) => symbol,
                None => declared(self.scene, &mut self.system, name, "errors")?,
            };
            let value = match value.trim().parse::<f64>() {
                Ok(value) if value.is_finite() => number(&mut self.system, value),
                _ => self.formula(value.trim()).map_err(at_row)?,
            };
            own.insert(symbol, value);
        }
        let expected = self.formula(&row.output).map_err(at_row)?;
        let size = self.value(size, &format!("errors.{}", row.output))?;
        let needed = self.system.graph.symbols_of([expected, size]);
        for symbol in own.keys() {
            let name = palmistry_io::foreign::shown(self.system.symbol_name(*symbol));
            if moving.contains(symbol) {
                return Err(rows.error(
                    row,
                    format!("'{name}' is a part of the motion, and a row sets what belongs to its output and its error alone"),
                    "set it in an experiment of its own",
                ));
            }
            if !needed.contains(symbol) {
                return Err(rows.error(
                    row,
                    format!(
                        "'{name}' is set, and neither '{}' nor its error has it",
                        palmistry_io::foreign::shown(&row.output)
                    ),
                    "leave it out, or set it in the experiment",
                ));
            }
        }
        let both = self.system.graph.substitute(&[expected, size], &own);
        let both = self.put_in(&both, settings)?;
        Ok([both[0], both[1]])
    }
}

fn number(system: &mut System, value: f64) -> NodeId {
    match rational_from_f64(value) {
        Some(value) => system.graph.rational(value),
        // finite numbers are fractions
        None => system.graph.integer(0),
    }
}

/// A parameter of the model, or a new one.
fn declared(scene: &JointScene, system: &mut System, name: &str, place: &str) -> Result<Symbol, ReadError> {
    if let Some(symbol) = system.find_symbol(name) {
        return match system.symbol_info(symbol).is_some_and(|info| info.kind == Kind::State)
            && system.fields.iter().any(|field| field.components.iter().any(|(state, _)| *state == symbol))
        {
            true => Err(scene.error_at(
                place,
                format!("'{name}' is a state that moves, and no parameter"),
                "its start is set under [initial]",
            )),
            false => Ok(symbol),
        };
    }
    let is_name = name.chars().next().is_some_and(|c| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !is_name || system.definitions.contains_key(name) {
        let message = match is_name {
            true => format!("'{name}' is defined by the model, and no parameter"),
            false => format!("'{}' is no name", palmistry_io::foreign::shown(name)),
        };
        return Err(scene.error_at(
            place,
            message,
            "a name begins with a letter, and has letters, digits and underscores",
        ));
    }
    let symbol = system.graph.intern(name);
    system
        .symbols
        .insert(symbol, SymbolInfo { kind: Kind::Parameter, is_angle: false, default: None, range: None });
    Ok(symbol)
}
