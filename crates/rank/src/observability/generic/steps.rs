//! The generic answer in discrete time: a random state is followed modulo a prime for as many steps as can show anything new
//! ([`crate::observability::saturation`]), a known signal drawn anew at each, and the derivatives by the initial state with it. Nothing is written
//! out, so that the cost of a step is that of the map and of a product with its Jacobian.
//!
//! After `k` steps of a map of degree `d` the outputs are of degree `d^k` in what was drawn, the logarithm of its coefficients
//! likewise; where that is too much for the prime a short rank is left open, and a full one is certain all the same.

use super::bound::Rounds;
use super::echelon::Echelon;
use crate::observability::saturation::most_steps;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{
    Input, NodeId, Program, Symbol, draw_residues, expand_angles, failure_bound, gradient, sizes,
};
use palmistry_math::number::polynomial::Size;
use palmistry_math::number::{Arithmetic, Function, PrimeField, Refusal};
use rand_chacha::ChaCha8Rng;
use std::collections::HashMap;

/// What an input of the program is after a step.
#[derive(Clone, Copy, Debug)]
enum Next {
    /// The value at this place.
    Value(usize),
    /// Anything.
    Fresh,
    /// What it was.
    Same,
}

/// The map, its outputs and their derivatives, ready to be followed.
pub(super) struct Steps {
    /// The initial inputs of `step`, from what is free where the conditions are met.
    start: Program,
    step: Program,
    next: Vec<Next>,
    /// Row and column of each entry of the Jacobian, output and column of each differential, in the order of the step's values.
    entries: Vec<(usize, usize)>,
    differentials: Vec<(usize, usize)>,
    /// Where among the values of a step these begin.
    begin: usize,
    outputs: usize,
    /// How many functions of the initial state are asked for: they come behind the outputs.
    asked: usize,
    /// What the bound of degrees is taken from.
    measured: Program,
    /// All that moves but known signals, and which of it has an unknown initial condition.
    closed: usize,
    columns: Vec<usize>,
    /// How many steps are taken.
    count: usize,
}

impl Steps {
    /// Of a system in discrete time, where conditions are met. `rests` says that the map takes that set into itself.
    ///
    /// # Errors
    /// In words, where something is met that is no rational function of numbers, sines and cosines.
    pub fn new(
        system: &System,
        conditions: &Assignment,
        rests: bool,
        asked: &[NodeId],
    ) -> Result<Steps, String> {
        let mut graph = system.graph.clone();
        let is_angle = system.angle_test();
        let closed = system.closed_coordinates();
        let unknowns = system.unknowns();
        let signals = system.known_signals();
        if let Some(signal) = signals.iter().find(|signal| is_angle(**signal)) {
            return Err(format!("the known signal '{}' is an angle", system.symbol_name(*signal)));
        }
        let fixed: Assignment = conditions
            .iter()
            .filter(|(symbol, value)| {
                !system.states.contains(symbol) && graph.symbols_of([**value]).is_empty()
            })
            .map(|(symbol, value)| (*symbol, *value))
            .collect();
        let on_a_set = conditions.keys().any(|symbol| !fixed.contains_key(symbol));
        let successors: HashMap<Symbol, NodeId> = match system.drift() {
            Some(drift) => system.fields[drift].components.iter().copied().collect(),
            None => HashMap::new(),
        };
        let after: Vec<NodeId> = closed
            .iter()
            .map(|state| successors.get(state).copied().unwrap_or_else(|| graph.symbol(*state)))
            .collect();
        let outputs: Vec<NodeId> =
            system.outputs.iter().map(|(_, node)| *node).chain(asked.iter().copied()).collect();
        let written = graph.substitute(&[after, outputs].concat(), &fixed);
        let written = expand_angles(&mut graph, &written, &is_angle);
        let (after, outputs) = written.split_at(closed.len());

        // what each state is, or of an angle its sine and cosine; then the derivatives
        let (mut roots, mut place_of) = (Vec::new(), HashMap::new());
        for (state, after) in closed.iter().zip(after) {
            if is_angle(*state) {
                place_of.insert(Input::Sine(*state), roots.len());
                roots.push(graph.apply(Function::Sin, *after));
                place_of.insert(Input::Cosine(*state), roots.len());
                roots.push(graph.apply(Function::Cos, *after));
            } else {
                place_of.insert(Input::Plain(*state), roots.len());
                roots.push(*after);
            }
        }
        let begin = roots.len();
        let mut table = |nodes: &[NodeId]| {
            let mut places = Vec::new();
            for (row, node) in nodes.iter().enumerate() {
                for (column, entry) in gradient(&mut graph, *node, &closed).into_iter().enumerate() {
                    if !graph.constant_value(entry).is_some_and(|value| value.is_zero()) {
                        places.push((row, column));
                        roots.push(entry);
                    }
                }
            }
            places
        };
        let (entries, differentials) = (table(after), table(outputs));
        let moved: Vec<NodeId> = roots[..begin].iter().chain(outputs).copied().collect();
        let roots = expand_angles(&mut graph, &roots, &is_angle);
        let step = Program::with_unknown_functions(&graph, &roots, &is_angle);
        let moved = expand_angles(&mut graph, &moved, &is_angle);
        let measured = Program::with_unknown_functions(&graph, &moved, &is_angle);
        for program in [&step, &measured] {
            if let Some(angle) = program.bare_angle() {
                let name = system.symbol_name(angle);
                return Err(format!("'{name}' is declared as an angle but stands outside sin, cos and tan"));
            }
            if program.unknown_function(&graph).is_some() {
                return Err("a function is met that residues do not have".to_owned());
            }
        }
        let mut starts = Vec::new();
        for input in step.inputs() {
            let (symbol, function) = match input {
                Input::Plain(symbol) => (*symbol, None),
                Input::Sine(symbol) => (*symbol, Some(Function::Sin)),
                Input::Cosine(symbol) => (*symbol, Some(Function::Cos)),
                Input::Opaque(_) => return Err("the number pi is met outside of angles".to_owned()),
            };
            let value = conditions.get(&symbol).copied().unwrap_or_else(|| graph.symbol(symbol));
            starts.push(function.map_or(value, |function| graph.apply(function, value)));
        }
        let starts = expand_angles(&mut graph, &starts, &is_angle);
        let start = Program::with_unknown_functions(&graph, &starts, &is_angle);
        if start.bare_angle().is_some() || start.unknown_function(&graph).is_some() {
            return Err("the conditions are no rational functions".to_owned());
        }
        let next = |input: &Input| match (place_of.get(input), input) {
            (Some(place), _) => Next::Value(*place),
            (None, Input::Plain(symbol)) if signals.contains(symbol) => Next::Fresh,
            _ => Next::Same,
        };
        let next = step.inputs().iter().map(next).collect();
        let columns = (0..closed.len()).filter(|place| unknowns.contains(&closed[*place])).collect();
        let count = most_steps(closed.len(), on_a_set || !rests);
        let (outputs, closed) = (system.outputs.len(), closed.len());
        Ok(Steps {
            start,
            step,
            next,
            entries,
            differentials,
            begin,
            outputs,
            asked: asked.len(),
            measured,
            closed,
            columns,
            count,
        })
    }

    /// The span of the differentials at a random start, the differentials of what is asked for, and after how many steps the last
    /// of the span was found.
    ///
    /// # Errors
    /// Where the random sequence meets a pole.
    pub fn follow(
        &self,
        field: PrimeField,
        rng: &mut ChaCha8Rng,
    ) -> Result<(Echelon, Vec<Vec<u64>>, usize), Refusal> {
        let refused = |failure: palmistry_math::expression::Failure| failure.refusal;
        let drawn = draw_residues(&self.start, &field, rng);
        let mut inputs = self.start.load(field)?.run(&drawn, &mut Vec::new()).map_err(refused)?.to_vec();
        let step = self.step.load(field)?;
        let width = self.columns.len();
        let (mut echelon, mut order) = (Echelon::new(field, width), 0);
        // the derivatives of all that moves by the initial unknowns
        let mut slopes = vec![vec![0; width]; self.closed];
        for (column, place) in self.columns.iter().enumerate() {
            slopes[*place][column] = field.one();
        }
        let (mut registers, mut asked) = (Vec::new(), Vec::new());
        for taken in 0..=self.count {
            let values = step.run(&inputs, &mut registers).map_err(refused)?.to_vec();
            let (of_map, of_outputs) = values[self.begin..].split_at(self.entries.len());
            let times = |places: &[(usize, usize)], entries: &[u64], rows: usize| {
                let mut found = vec![vec![0; width]; rows];
                for ((row, column), entry) in places.iter().zip(entries) {
                    let factor = field.neg(entry).unwrap_or(0);
                    field.subtract_multiple(&mut found[*row], factor, &slopes[*column]);
                }
                found
            };
            let mut rows = times(&self.differentials, of_outputs, self.outputs + self.asked);
            let besides = rows.split_off(self.outputs);
            if taken == 0 {
                asked = besides;
            }
            for row in rows {
                if echelon.insert(row) {
                    order = taken;
                }
            }
            if echelon.rank() == width {
                break;
            }
            slopes = times(&self.entries, of_map, self.closed);
            for (input, next) in inputs.iter_mut().zip(&self.next) {
                match next {
                    Next::Value(place) => *input = values[*place],
                    Next::Fresh => *input = field.draw(rng),
                    Next::Same => {}
                }
            }
        }
        Ok((echelon, asked, order))
    }

    /// In how many rounds a rank is known: a minor of rows each of which is of degree `d^k` at the most.
    ///
    /// # Errors
    /// In words, where the degree is too large for any number of rounds.
    pub fn rounds(&self) -> Result<Rounds, String> {
        let map = sizes(&self.measured).map_err(|refusal| refusal.to_string())?;
        let starts = sizes(&self.start).map_err(|refusal| refusal.to_string())?;
        // over one denominator for all components
        let total = |list: &[(Size, Size)], of: fn(&Size) -> f64| {
            let top = list.iter().map(|(top, _)| of(top)).fold(0.0, f64::max);
            top + list.iter().map(|(_, bottom)| of(bottom)).sum::<f64>()
        };
        let degree = total(&map, |size| size.degree).max(1.0);
        let bits = total(&map, |size| size.bits) + 1.0;
        let (mut row, mut powers) = (
            Size {
                degree: total(&starts, |size| size.degree).max(1.0),
                bits: total(&starts, |size| size.bits),
            },
            0,
        );
        // of the outputs after all steps
        while powers <= self.count && row.degree.is_finite() {
            row = Size { degree: row.degree * degree, bits: bits + degree * row.bits };
            powers += 1;
        }
        // the derivative of a quotient
        let row = Size { degree: 2.0 * row.degree, bits: 2.0 * row.bits + row.degree.log2() + 2.0 };
        let rows = self.columns.len().max(1) as f64;
        let minor = Size { degree: rows * row.degree, bits: rows * (row.bits + rows.log2()) };
        failure_bound(minor).map(|(rounds, log2_error)| Rounds { rounds, log2_error }).ok_or_else(|| {
            format!("after {} steps the degree of a minor may be {:.1e}", self.count, minor.degree)
        })
    }
}
