//! The equations of a system as polynomials over the integers: `Q x' = P` for each variable, `M y = N` for each output.
//!
//! An angle is a point of the circle: two variables, its cosine and its sine, which move by its rate.

use super::exact::Exact;
use crate::observability::driven::{Driven, driven, told_constants};
use dashu::base::BitTest;
use palmistry_lang::{Assignment, System, Time};
use palmistry_math::expression::{Graph, Input, NodeId, Program, Symbol, expand_angles};
use palmistry_math::number::{Arithmetic, Fraction, Fractions, Function, Refusal};

use std::collections::{HashMap, HashSet};

/// A quotient of two polynomials in the variables of a model.
#[derive(Clone, Debug)]
pub(super) struct Quotient {
    pub top: Exact,
    pub bottom: Exact,
    /// What the bottom is a product of.
    pub factors: Vec<Exact>,
}

/// How a variable moves.
#[derive(Clone, Debug)]
pub(super) enum Motion {
    /// It is a constant.
    Rests,
    /// By this rate.
    Moves(Quotient),
    /// It is a known signal, and moves freely.
    Driven,
}

/// One variable.
#[derive(Clone, Debug)]
pub(super) struct Variable {
    pub input: Input,
    pub motion: Motion,
    /// Whether its initial condition is known.
    pub is_known: bool,
}

/// A system as polynomials.
#[derive(Clone, Debug)]
pub(super) struct Model {
    pub graph: Graph,
    pub variables: Vec<Variable>,
    pub outputs: Vec<Quotient>,
    /// Further expressions of which the values are counted.
    pub asked: Vec<Quotient>,
    /// The unknowns in the order of the file, with the places of their variables: one, or cosine and sine of an angle.
    pub unknowns: Vec<(Symbol, Vec<usize>)>,
    /// The initial conditions that the file gives, as expressions of known parameters.
    pub given: Vec<(usize, NodeId)>,
    pub angles: HashSet<Symbol>,
    /// The rates and the outputs as expressions.
    pub rates: Vec<(Symbol, NodeId)>,
    pub measured: Vec<NodeId>,
}

impl Model {
    /// The model where the conditions are met, with expressions that are asked for.
    ///
    /// # Errors
    /// In words: what is no rational function, and where time goes in steps.
    pub fn new(system: &System, conditions: &Assignment, asked: &[NodeId]) -> Result<Model, String> {
        if system.time == Time::Discrete {
            return Err("the values of an unknown are counted in continuous time alone, and this system goes in steps".to_owned());
        }
        if !system.zero_outputs().is_empty() || system.highest_lie_order().is_some() {
            return Err("outputs that are zero tie known signals to states, of which values are not counted"
                .to_owned());
        }
        let mut graph = system.graph.clone();
        let angles = system.angles();
        let is_angle = |symbol: Symbol| angles.contains(&symbol);
        let fixed = told_constants(system, &graph, conditions);
        let Driven { rates, drives } = driven(system, &mut graph);
        let moved: Vec<Symbol> = rates.iter().map(|(state, _)| *state).collect();
        let mut roots: Vec<NodeId> = rates.iter().map(|(_, rate)| *rate).collect();
        roots.extend(system.outputs.iter().map(|(_, node)| *node));
        roots.extend(asked);
        let roots = graph.substitute(&roots, &fixed);
        let roots = expand_angles(&mut graph, &roots, is_angle);
        let expressions: Vec<(Symbol, NodeId)> = moved.iter().copied().zip(roots.iter().copied()).collect();
        let seen = roots[moved.len()..moved.len() + system.outputs.len()].to_vec();
        let program = Program::with_unknown_functions(&graph, &roots, is_angle);
        if let Some(angle) = program.bare_angle() {
            let name = system.symbol_name(angle);
            return Err(format!("'{name}' is declared as an angle but stands outside sin, cos and tan"));
        }
        if let Some(function) = program.unknown_function(&graph) {
            return Err(format!("{} is no rational function", graph.text(function)));
        }

        // the states first, in the order of the file, then what is mentioned
        let mut inputs: Vec<Input> = Vec::new();
        let pair = |symbol: Symbol| [Input::Cosine(symbol), Input::Sine(symbol)];
        for state in &system.states {
            if is_angle(*state) { inputs.extend(pair(*state)) } else { inputs.push(Input::Plain(*state)) }
        }
        for input in program.inputs() {
            let of_it: Vec<Input> = match input {
                Input::Sine(symbol) | Input::Cosine(symbol) => pair(*symbol).to_vec(),
                other => vec![*other],
            };
            let new: Vec<Input> = of_it.into_iter().filter(|input| !inputs.contains(input)).collect();
            inputs.extend(new);
        }
        let place: HashMap<Input, usize> = inputs.iter().copied().zip(0..).collect();
        let fractions = Fractions::<Exact>::default();
        let elements: Vec<Fraction> = program
            .inputs()
            .iter()
            .map(|input| fractions.element(Exact::variable(place[input] as u32)))
            .collect();
        let refused =
            |refusal: Refusal| format!("the equations could not be written as polynomials: {refusal}");
        let loaded = program.load(&fractions).map_err(refused)?;
        let values = loaded.run(&elements, &mut Vec::new()).map_err(|failure| refused(failure.refusal))?;
        let rate_of: HashMap<Symbol, &Fraction> = moved.iter().copied().zip(&values).collect();
        let quotient = |fraction: &Fraction| -> Result<Quotient, String> {
            let factors = fraction.bottom.keys().map(|place| fractions.factor(*place));
            Ok(Quotient {
                top: fractions.expand(&fraction.top).map_err(refused)?,
                bottom: fractions.expand(&fraction.bottom).map_err(refused)?,
                factors: factors.filter(|factor| factor.as_constant().is_none()).collect(),
            })
        };
        let mut variables = Vec::new();
        for input in &inputs {
            let symbol = input.symbol();
            let rate = symbol.and_then(|symbol| rate_of.get(&symbol));
            let motion = match (rate, input, symbol) {
                (_, _, Some(symbol)) if drives.contains(&symbol) => Motion::Driven,
                (None, ..) => Motion::Rests,
                (Some(rate), Input::Sine(symbol), _) => {
                    let cosine = fractions.element(Exact::variable(place[&Input::Cosine(*symbol)] as u32));
                    Motion::Moves(quotient(&fractions.mul(&cosine, rate).map_err(refused)?)?)
                }
                (Some(rate), Input::Cosine(symbol), _) => {
                    let sine = fractions.element(Exact::variable(place[&Input::Sine(*symbol)] as u32));
                    let minus = fractions.neg(&sine).map_err(refused)?;
                    Motion::Moves(quotient(&fractions.mul(&minus, rate).map_err(refused)?)?)
                }
                (Some(rate), ..) => Motion::Moves(quotient(rate)?),
            };
            let motion = match motion {
                Motion::Moves(rate) if rate.top.as_constant().is_some_and(|top| top.is_zero()) => {
                    Motion::Rests
                }
                other => other,
            };
            let is_known = symbol
                .is_none_or(|symbol| system.known.contains(&symbol) || !system.states.contains(&symbol));
            variables.push(Variable { input: *input, motion, is_known });
        }
        let (outputs, asked) = values[moved.len()..].split_at(system.outputs.len());
        let outputs = outputs.iter().map(quotient).collect::<Result<_, _>>()?;
        let asked = asked.iter().map(quotient).collect::<Result<_, _>>()?;
        let mut given = Vec::new();
        for (symbol, value) in conditions.iter().filter(|(symbol, _)| !fixed.contains_key(symbol)) {
            let sides: Vec<(Input, NodeId)> = match is_angle(*symbol) {
                true => vec![
                    (Input::Cosine(*symbol), graph.apply(Function::Cos, *value)),
                    (Input::Sine(*symbol), graph.apply(Function::Sin, *value)),
                ],
                false => vec![(Input::Plain(*symbol), *value)],
            };
            for (input, value) in sides {
                let value = graph.substitute(&[value], &fixed)[0];
                let value = expand_angles(&mut graph, &[value], is_angle)[0];
                if let Some(place) = place.get(&input) {
                    given.push((*place, value));
                }
            }
        }
        given.sort_unstable();
        let places = |symbol: Symbol| -> Vec<usize> {
            let of_it = if is_angle(symbol) { pair(symbol).to_vec() } else { vec![Input::Plain(symbol)] };
            of_it.iter().filter_map(|input| place.get(input).copied()).collect()
        };
        let unknowns = system.unknowns().into_iter().map(|symbol| (symbol, places(symbol))).collect();
        Ok(Model {
            graph,
            variables,
            outputs,
            asked,
            unknowns,
            given,
            angles,
            rates: expressions,
            measured: seen,
        })
    }

    /// Whether initial conditions are given by numbers or expressions, and not free.
    pub fn is_on_a_set(&self) -> bool {
        !self.given.is_empty()
    }

    /// How many bits the numbers have that are given as initial conditions, numerator and denominator of the longest; nothing where one is no number.
    pub fn bits_of_given_numbers(&self) -> Option<f64> {
        let bits = |(_, node): &(usize, NodeId)| {
            let number = self.graph.constant_value(*node)?;
            Some(number.numerator().bit_len() as f64 + number.denominator().bit_len() as f64)
        };
        self.given.iter().map(bits).try_fold(0.0, |most, bits| Some(f64::max(most, bits?)))
    }

    /// The values that the file gives, as a program.
    pub fn given_program(&self) -> Program {
        let nodes: Vec<NodeId> = self.given.iter().map(|(_, node)| *node).collect();
        Program::with_unknown_functions(&self.graph, &nodes, |symbol| self.angles.contains(&symbol))
    }
}
