//! A system as one flow: drift and inputs together, with its outputs' differentials and the Jacobian of its rates.

use super::adjoined::{Adjoined, pi_in};
use super::covectors::{Covector, Entry};
use crate::observability::driven::{Driven, driven, told_constants};
use crate::observability::flow::Flow;
use dashu::rational::RBig;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{
    Derivation, Graph, Guard, Input, Node, NodeId, Program, Symbol, draw_residues, expand_angles, gradient,
    normal_form, substitute_guards,
};
use palmistry_math::number::{Coefficients, Function, PrimeField, Refusal};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::HashSet;

/// The equations, ready to be run modulo primes.
pub(super) struct Equations {
    /// The graph of the system, and what was derived.
    pub graph: Graph,
    /// The states, and among them the unknowns, by their places.
    pub states: usize,
    pub columns: Vec<usize>,
    /// The unknowns and known initial conditions: the rows of these are what rests when it has stopped growing.
    pub closed: Vec<usize>,
    pub outputs: usize,
    /// How many functions are asked for besides: their differentials come behind those of the outputs.
    pub asked: usize,
    /// What the bound of degrees is taken from: rates, outputs, and how functions move.
    pub measured: Vec<NodeId>,
    /// What the flow is given, from what is free on the set of the conditions.
    pub starts: Program,
    /// How many square roots are met.
    pub roots: usize,
    /// All functions that are met, but sines and cosines of angles.
    pub functions: Vec<NodeId>,
    /// Whether these are written so that they satisfy no relation but those that define them.
    pub related: bool,
    flow: Flow,
    pub angles: HashSet<Symbol>,
    /// The signals that drive the inputs, by their places among what the flow is given.
    driven: Vec<usize>,
    /// Output and column of each differential, then row and column of each entry of the Jacobian, in the order of the flow's roots.
    differentials: Vec<(usize, usize)>,
    entries: Vec<(usize, usize)>,
}

/// What a trajectory gives.
pub(super) struct Trajectory {
    /// `dh` of each output, then of each function that is asked for.
    pub covectors: Vec<Covector>,
    /// The Jacobian of the rates.
    pub entries: Vec<Entry>,
}

impl Equations {
    /// The equations, and the differentials of functions that are asked for.
    pub fn new(system: &System, conditions: &Assignment, asked: &[NodeId]) -> Equations {
        let mut graph = system.graph.clone();
        let angles = system.angles();
        // constants that are given are put in; everything else that a condition says is where the flow begins
        let fixed = told_constants(system, &graph, conditions);
        let Driven { rates, drives } = driven(system, &mut graph);
        let moved: Vec<Symbol> = rates.iter().map(|(state, _)| *state).collect();
        let mut written: Vec<NodeId> = rates.iter().map(|(_, rate)| *rate).collect();
        written.extend(system.outputs.iter().map(|(_, node)| *node).chain(asked.iter().copied()));
        let written = graph.substitute(&written, &fixed);
        let written = expand_angles(&mut graph, &written, |symbol| angles.contains(&symbol));
        let (written, related) = related(&mut graph, system, &written, &fixed, conditions, &angles);
        let (rates, outputs) = written.split_at(moved.len());
        let components: Vec<(Symbol, NodeId)> = moved.iter().copied().zip(rates.iter().copied()).collect();

        let mut roots = Vec::new();
        let mut table = |graph: &mut Graph, nodes: &[(usize, NodeId)]| {
            let mut places = Vec::new();
            for (row, node) in nodes {
                for (column, entry) in gradient(graph, *node, &system.states).into_iter().enumerate() {
                    if !graph.constant_value(entry).is_some_and(RBig::is_zero) {
                        places.push((*row, column));
                        roots.push(entry);
                    }
                }
            }
            places
        };
        let of_outputs: Vec<(usize, NodeId)> = outputs.iter().copied().enumerate().collect();
        let differentials = table(&mut graph, &of_outputs);
        let place_of = |state: &Symbol| system.states.iter().position(|other| other == state);
        let of_rates: Vec<(usize, NodeId)> =
            components.iter().filter_map(|(state, rate)| Some((place_of(state)?, *rate))).collect();
        let entries = table(&mut graph, &of_rates);

        let flow = Flow::new(&graph, &components, &roots, |symbol| angles.contains(&symbol));
        let given = flow.inputs().to_vec();
        let driven = given.iter().enumerate().filter_map(|(place, input)| {
            input.symbol().is_some_and(|symbol| drives.contains(&symbol)).then_some(place)
        });
        let driven: Vec<usize> = driven.collect();
        let starts = starts(&mut graph, &given, conditions, &angles);
        // a state given in terms of functions has other values of them than its equations have
        let related = related && starts.unknown_function(&graph).is_none();
        let (functions, measured) = measured(&mut graph, &components, &written, &angles);
        // the slope of an inverse sine has one too
        let square_root = |node: &NodeId| {
            matches!(graph.node(*node), Node::Apply(Function::Sqrt | Function::Asin | Function::Acos, _))
        };
        Equations {
            states: system.states.len(),
            columns: places(system, &system.unknowns()),
            closed: places(system, &system.closed_coordinates()),
            outputs: system.outputs.len(),
            asked: asked.len(),
            measured,
            starts,
            roots: functions.iter().filter(|node| square_root(node)).count(),
            functions,
            related,
            flow,
            angles,
            driven,
            differentials,
            entries,
            graph,
        }
    }

    /// Whether a symbol is an angle.
    pub fn is_angle(&self) -> impl Fn(Symbol) -> bool + '_ {
        |symbol| self.angles.contains(&symbol)
    }

    /// What the flow is given, in the order of a start.
    pub fn inputs(&self) -> &[Input] {
        self.flow.inputs()
    }

    /// A random start: the value of each input at `t = 0`, and the seed of all that is drawn along the way.
    ///
    /// # Errors
    /// Where the random point is a pole, or the prime divides a denominator.
    pub fn draw(&self, field: PrimeField, rng: &mut ChaCha8Rng) -> Result<Vec<u64>, Refusal> {
        let mut inputs = draw_residues(&self.starts, &field, rng);
        for (input, value) in self.starts.inputs().iter().zip(&mut inputs) {
            if matches!(input, Input::Opaque(node) if self.graph.node(*node) == Node::Pi) {
                *value = pi_in(field);
            }
        }
        self.start(field, &inputs, rng.random())
    }

    /// The value of each input of the flow, from those of [`Equations::starts`].
    pub fn start(&self, field: PrimeField, inputs: &[u64], seed: u64) -> Result<Vec<u64>, Refusal> {
        let loaded = self.starts.load(Adjoined::new(field, seed, None))?;
        loaded.run(inputs, &mut Vec::new()).map_err(|failure| failure.refusal)
    }

    /// The differentials of the outputs and the Jacobian along the trajectory from there, to so many coefficients.
    ///
    /// # Errors
    /// A division by zero, or a root that does not exist.
    pub fn trajectory(
        &self,
        field: PrimeField,
        start: &[u64],
        (seed, signs): (u64, Option<u64>),
        length: usize,
    ) -> Result<Trajectory, Refusal> {
        let order = length.saturating_sub(1);
        let mut signals: Vec<Vec<u64>> = start.iter().map(|value| vec![*value]).collect();
        for (number, place) in self.driven.iter().enumerate() {
            // the same signal, however long it is asked for
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(number as u64 + 1);
            signals[*place] = (0..length.max(1)).map(|_| field.draw(&mut rng)).collect();
        }
        let arithmetic = Adjoined::new(field, seed, signs);
        let series =
            self.flow.coefficients(&arithmetic, &signals, order).map_err(|failure| failure.refusal)?;
        let mut series = series.into_iter().map(residues);
        let blank = || Covector { series: vec![Vec::new(); self.states], length };
        let mut covectors: Vec<Covector> = (0..self.outputs + self.asked).map(|_| blank()).collect();
        for (output, column) in &self.differentials {
            covectors[*output].series[*column] = series.next().unwrap_or_default();
        }
        let entry = |((row, column), series): (&(usize, usize), Vec<u64>)| Entry {
            row: *row,
            column: *column,
            series,
        };
        let mut entries: Vec<Entry> = self.entries.iter().zip(series).map(entry).collect();
        entries.sort_by_key(|entry| (entry.column, entry.row));
        Ok(Trajectory { covectors, entries })
    }
}

/// The places of some states among all.
fn places(system: &System, wanted: &[Symbol]) -> Vec<usize> {
    (0..system.states.len()).filter(|place| wanted.contains(&system.states[*place])).collect()
}

/// Coefficients up to the last that is not zero.
fn residues(series: Coefficients<u64>) -> Vec<u64> {
    let mut values: Vec<u64> = series.into_iter().map(|term| term.unwrap_or(0)).collect();
    let end = values.iter().rposition(|value| *value != 0).map_or(0, |last| last + 1);
    values.truncate(end);
    values
}

/// The values of what a flow is given, on the set of the conditions.
fn starts(graph: &mut Graph, given: &[Input], conditions: &Assignment, angles: &HashSet<Symbol>) -> Program {
    let mut node = |input: &Input| match *input {
        Input::Plain(symbol) => graph.symbol(symbol),
        Input::Sine(symbol) => {
            let angle = graph.symbol(symbol);
            graph.apply(Function::Sin, angle)
        }
        Input::Cosine(symbol) => {
            let angle = graph.symbol(symbol);
            graph.apply(Function::Cos, angle)
        }
        Input::Opaque(node) => node,
    };
    let nodes: Vec<NodeId> = given.iter().map(&mut node).collect();
    let on_the_set = graph.substitute(&nodes, conditions);
    let is_angle = |symbol: Symbol| angles.contains(&symbol);
    let expanded = expand_angles(graph, &on_the_set, is_angle);
    Program::with_unknown_functions(graph, &expanded, is_angle)
}

/// Whether a node is a function, sines and cosines of an angle aside.
fn is_function(graph: &Graph, id: NodeId, angles: &HashSet<Symbol>) -> bool {
    match graph.node(id) {
        Node::Apply(Function::Sin | Function::Cos, a) => {
            !graph.as_symbol(a).is_some_and(|symbol| angles.contains(&symbol))
        }
        Node::Apply(..) => true,
        _ => false,
    }
}

/// Rates and outputs with equal functions under one name; and whether those functions are shown to satisfy no relation but those
/// that define them, nowhere on the set of the conditions.
fn related(
    graph: &mut Graph,
    system: &System,
    written: &[NodeId],
    fixed: &Assignment,
    conditions: &Assignment,
    angles: &HashSet<Symbol>,
) -> (Vec<NodeId>, bool) {
    let is_angle = |symbol: Symbol| angles.contains(&symbol);
    if !graph.reachable(written.iter().copied()).iter().any(|id| is_function(graph, *id, angles)) {
        return (written.to_vec(), true);
    }
    let guards = substitute_guards(graph, &system.smooth_guards(&system.moving_fields()), fixed);
    let nodes: Vec<NodeId> = guards.iter().map(|guard| guard.node).collect();
    let nodes = expand_angles(graph, &nodes, is_angle);
    let guards: Vec<Guard> =
        guards.iter().zip(nodes).map(|(guard, node)| Guard { node, need: guard.need }).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(0x6e6f_726d); // any fixed seed
    let Ok(found) = normal_form(graph, written, &guards, &mut rng) else {
        return (written.to_vec(), false);
    };
    let found_nodes = expand_angles(graph, &found.nodes, is_angle);
    let met = graph.reachable(found_nodes.iter().copied());
    let functions: Vec<NodeId> = met.into_iter().filter(|id| is_function(graph, *id, angles)).collect();
    // an angle has a sine and a cosine here, and no value of its own
    let bare = found_nodes.iter().chain(&functions).copied();
    let is_bare = graph.reachable(bare).into_iter().any(|id| match graph.node(id) {
        Node::Apply(Function::Sin | Function::Cos, _) => false,
        node => node.operands().any(|part| graph.as_symbol(part).is_some_and(is_angle)),
    });
    // on a set of states functions may be related that are not elsewhere
    let mentioned = graph.symbols_of(functions.iter().copied());
    let apart = mentioned.iter().all(|symbol| fixed.contains_key(symbol) || !conditions.contains_key(symbol));
    let known = found.independent && found.constants_known && found.open_signs.is_empty();
    (found_nodes, known && apart && !is_bare)
}

/// The functions that are met, and all that a minor's degree depends on: rates, outputs, slopes of functions along the flow and
/// along each state.
fn measured(
    graph: &mut Graph,
    components: &[(Symbol, NodeId)],
    written: &[NodeId],
    angles: &HashSet<Symbol>,
) -> (Vec<NodeId>, Vec<NodeId>) {
    let met = graph.reachable(written.iter().copied());
    let functions: Vec<NodeId> = met.into_iter().filter(|id| is_function(graph, *id, angles)).collect();
    let mut measured = written.to_vec();
    if !functions.is_empty() {
        let mut flow = Derivation::new(components.iter().copied().collect());
        let states: Vec<Symbol> = graph.symbols_of(functions.iter().copied());
        for function in &functions {
            measured.push(flow.apply(graph, *function));
            measured.extend(gradient(graph, *function, &states));
        }
    }
    (functions, measured)
}
