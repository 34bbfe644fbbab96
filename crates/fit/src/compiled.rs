//! Formulas with their exact derivatives, as programs.

use super::problem::{JointProblem, Phase};
use palmistry_lang::System;
use palmistry_math::expression::{Node, NodeId, Program, Symbol};
use palmistry_math::number::{Floats, Function};
use std::collections::HashMap;

/// A state that has become negative by less than this has done so by rounding.
const ROUNDING: f64 = 1e-7;

/// A little more than zero, and how little it may matter by how much.
const TINY: [f64; 2] = [1e-150, 1e-75];
const SAME: f64 = 1e-9;

/// Where an input of a program comes from.
#[derive(Clone, Copy, Debug)]
enum Source {
    State(usize),
    Parameter(usize),
}

/// Some expressions of states and parameters.
#[derive(Clone, Debug)]
pub(super) struct Formulas {
    program: Program,
    sources: Vec<Source>,
}

/// Room for the numbers of a program.
#[derive(Default)]
pub(super) struct Room {
    inputs: Vec<f64>,
    registers: Vec<f64>,
}

/// What the symbols of a problem are.
pub(super) struct Names {
    places: HashMap<Symbol, Source>,
    states: Vec<Symbol>,
    parameters: Vec<Symbol>,
}

impl Names {
    pub fn of(problem: &JointProblem) -> Names {
        let parameters: Vec<Symbol> = problem.parameters.iter().map(|one| one.symbol).collect();
        let mut places = HashMap::new();
        places.extend(parameters.iter().enumerate().map(|(at, symbol)| (*symbol, Source::Parameter(at))));
        places.extend(problem.states.iter().enumerate().map(|(at, symbol)| (*symbol, Source::State(at))));
        Names { places, states: problem.states.clone(), parameters }
    }
}

impl Formulas {
    fn new(system: &System, nodes: &[NodeId], names: &Names) -> Result<Formulas, String> {
        let program = Program::plain(&system.graph, nodes);
        let source = |symbol: Symbol| {
            let found = names.places.get(&symbol).copied();
            found.ok_or_else(|| system.symbol_name(symbol).to_owned())
        };
        let sources = program
            .inputs()
            .iter()
            .filter_map(|input| input.symbol())
            .map(source)
            .collect::<Result<_, _>>()?;
        Ok(Formulas { program, sources })
    }

    /// The values at states and parameters; numbers that are none where one has no value.
    pub fn run(&self, states: &[f64], parameters: &[f64], room: &mut Room, out: &mut [f64]) {
        room.inputs.clear();
        room.inputs.extend(self.sources.iter().map(|source| match source {
            Source::State(place) => states[*place],
            Source::Parameter(place) => parameters[*place],
        }));
        // constants of doubles have an image, whatever they are
        let Ok(loaded) = self.program.load(Floats) else {
            out.fill(f64::NAN);
            return;
        };
        Formulas::fill(&loaded, room, out);
        if out.first().is_some_and(|value| value.is_nan()) {
            self.fill_beside(&loaded, room, out);
        }
    }

    /// What is a root of zero or of a little less than zero by rounding has a value all the same: that at a little more than zero, where it does not
    /// matter how little. A pole has none.
    fn fill_beside(
        &self,
        loaded: &palmistry_math::expression::Loaded<'_, Floats>,
        room: &mut Room,
        out: &mut [f64],
    ) {
        let is_zero = |(input, source): (&f64, &Source)| {
            matches!(source, Source::State(_)) && (-ROUNDING..=0.0).contains(input)
        };
        let zeros: Vec<usize> =
            (0..room.inputs.len()).filter(|at| is_zero((&room.inputs[*at], &self.sources[*at]))).collect();
        let mut other = vec![f64::NAN; out.len()];
        for (tiny, out) in TINY.into_iter().zip([&mut *out, other.as_mut_slice()]) {
            zeros.iter().for_each(|at| room.inputs[*at] = tiny);
            Formulas::fill(loaded, room, out);
        }
        for (out, other) in out.iter_mut().zip(other) {
            if (*out - other).abs() > SAME * (1.0 + out.abs()) {
                *out = f64::NAN;
            }
        }
    }

    fn fill(loaded: &palmistry_math::expression::Loaded<'_, Floats>, room: &mut Room, out: &mut [f64]) {
        match loaded.run_in(&room.inputs, &mut room.registers) {
            Ok(values) => out.iter_mut().zip(values).for_each(|(out, value)| *out = *value),
            Err(_) => out.fill(f64::NAN),
        }
    }

    /// The same, many times over.
    pub fn loaded(&self) -> Option<LoadedFormulas<'_>> {
        Some(LoadedFormulas { formulas: self, loaded: self.program.load(Floats).ok()? })
    }
}

/// Formulas whose constants are at hand.
pub(super) struct LoadedFormulas<'f> {
    formulas: &'f Formulas,
    loaded: palmistry_math::expression::Loaded<'f, Floats>,
}

impl LoadedFormulas<'_> {
    /// As [`Formulas::run`].
    pub fn run(&self, states: &[f64], parameters: &[f64], room: &mut Room, out: &mut [f64]) {
        room.inputs.clear();
        room.inputs.extend(self.formulas.sources.iter().map(|source| match source {
            Source::State(place) => states[*place],
            Source::Parameter(place) => parameters[*place],
        }));
        Formulas::fill(&self.loaded, room, out);
        if out.first().is_some_and(|value| value.is_nan()) {
            self.formulas.fill_beside(&self.loaded, room, out);
        }
    }
}

/// Some expressions, and those of their derivatives that are not zero, each with its row and column.
#[derive(Clone, Debug)]
pub(super) struct Sloped {
    pub values: Formulas,
    pub slopes: Formulas,
    /// By states.
    pub by_states: Vec<[usize; 2]>,
    /// By parameters; these stand behind those by states.
    pub by_parameters: Vec<[usize; 2]>,
    pub rows: usize,
}

impl Sloped {
    /// # Errors
    /// The name of a symbol without a meaning.
    pub fn new(system: &mut System, nodes: &[NodeId], names: &Names) -> Result<Sloped, String> {
        let values = Formulas::new(system, nodes, names)?;
        let mut derivatives = Vec::new();
        let mut by = |symbols: &[Symbol], system: &mut System| {
            let mut places = Vec::new();
            for (row, node) in nodes.iter().enumerate() {
                let depends = system.graph.symbols_of([*node]);
                for (column, symbol) in symbols.iter().enumerate() {
                    if !depends.contains(symbol) {
                        continue;
                    }
                    let slope = system.partial(*node, *symbol);
                    if system.graph.constant_value(slope).is_some_and(|value| value.is_zero()) {
                        continue;
                    }
                    places.push([row, column]);
                    derivatives.push(slope);
                }
            }
            places
        };
        let by_states = by(&names.states, system);
        let by_parameters = by(&names.parameters, system);
        let slopes = Formulas::new(system, &derivatives, names)?;
        Ok(Sloped { values, slopes, by_states, by_parameters, rows: nodes.len() })
    }
}

/// A phase as programs.
#[derive(Clone, Debug)]
pub(super) struct CompiledPhase {
    pub rates: Sloped,
    /// The initial states that are given.
    pub start: Sloped,
    /// For each state the row of its initial value, where it is given.
    pub given: Vec<Option<usize>>,
    /// What is zero where a rate has a kink or a jump at some time: formulas of time and parameters.
    pub switches: Sloped,
    /// The state that is time.
    pub clock: Option<usize>,
}

impl CompiledPhase {
    /// # Errors
    /// The name of a symbol without a meaning.
    pub fn new(
        system: &mut System,
        phase: &Phase,
        names: &Names,
        clock: Option<usize>,
    ) -> Result<CompiledPhase, String> {
        let rates = Sloped::new(system, &phase.rates, names)?;
        let nodes: Vec<NodeId> = phase.start.iter().flatten().copied().collect();
        let start = Sloped::new(system, &nodes, names)?;
        let mut row = 0;
        let given = phase
            .start
            .iter()
            .map(|start| {
                start.map(|_| {
                    row += 1;
                    row - 1
                })
            })
            .collect();
        let switches = switches(system, &phase.rates, names, clock);
        let switches = Sloped::new(system, &switches, names)?;
        Ok(CompiledPhase { rates, start, given, switches, clock })
    }
}

/// The arguments of absolute values and signs that depend on time and parameters alone.
fn switches(system: &System, rates: &[NodeId], names: &Names, clock: Option<usize>) -> Vec<NodeId> {
    let Some(time) = clock.map(|clock| names.states[clock]) else { return Vec::new() };
    let graph = &system.graph;
    let mut found = Vec::new();
    for id in graph.reachable(rates.iter().copied()) {
        // an absolute value is the root of a square
        let Node::Apply(Function::Sqrt, square) = graph.node(id) else { continue };
        let Node::Power(inner, 2) = graph.node(square) else { continue };
        let symbols = graph.symbols_of([inner]);
        let is_of_time = symbols.contains(&time);
        let is_of_others = symbols.iter().any(|symbol| *symbol != time && names.states.contains(symbol));
        if is_of_time && !is_of_others && !found.contains(&inner) {
            found.push(inner);
        }
    }
    found
}
