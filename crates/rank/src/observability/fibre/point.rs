//! The equations of a fibre: all initial values of the unknowns, and values of all derivatives, for which the outputs have
//! the derivatives
//! that they have at one random point.

use super::exact::Exact;
use super::jets::Jet;
use super::model::{Model, Motion, Quotient};
use crate::observability::generic::Orders;
use palmistry_math::expression::{Input, draw_residues};
use palmistry_math::number::PrimeField;

use rand_chacha::ChaCha8Rng;
use std::collections::HashMap;

/// More terms than this are not written down.
const MOST_TERMS: usize = 300_000;

/// Why there are no equations.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Trouble {
    /// The point is a pole, or the prime divides a denominator: another one may do.
    Pole,
    /// In words.
    TooLarge(String),
}

/// Where the values of a point come from.
pub(super) struct Source<'a> {
    pub rng: &'a mut ChaCha8Rng,
    /// Values of variables; of those that are not among them they are random.
    pub given: HashMap<u32, i64>,
}

impl Source<'_> {
    fn value(&mut self, field: &PrimeField, jet: u32) -> u64 {
        match self.given.get(&jet) {
            Some(value) => field.integer(&(*value).into()),
            None => field.draw(self.rng),
        }
    }

    fn random(&mut self) -> &mut ChaCha8Rng {
        self.rng
    }
}

/// Polynomials that vanish on a fibre, and a point of it.
pub(super) struct Fibre {
    pub field: PrimeField,
    pub equations: Vec<Jet>,
    /// Of each unknown its variables, or of each expression that is asked for.
    pub unknowns: Vec<Vec<u32>>,
    pub asked: Vec<u32>,
    /// Values of variables at the point.
    pub values: HashMap<u32, u64>,
}

/// What a variable is among those of the fibre.
pub(super) struct Numbering {
    pub variables: usize,
    pub asked: usize,
}

impl Numbering {
    /// How many numbers an order takes.
    pub fn stride(&self) -> u32 {
        // each expression that is asked for, and for each denominator its inverse
        (self.variables + self.asked) as u32 + INVERSES
    }

    /// A derivative of a variable.
    pub fn jet(&self, variable: usize, order: usize) -> u32 {
        variable as u32 + order as u32 * self.stride()
    }

    pub fn asked(&self, place: usize) -> u32 {
        (self.variables + place) as u32
    }

    pub fn inverse(&self, place: usize) -> u32 {
        (self.variables + self.asked + place) as u32
    }
}

/// No more denominators than these are met.
const INVERSES: u32 = 256;

/// Up to which order each variable is needed for the outputs' derivatives.
fn needed(model: &Model, orders: &Orders) -> Vec<Option<usize>> {
    let mut needed: Vec<Option<usize>> = vec![None; model.variables.len()];
    let mut waiting: Vec<(usize, usize)> = Vec::new();
    let of = |quotient: &Quotient| -> Vec<usize> {
        let monomials = quotient.top.terms.keys().chain(quotient.bottom.terms.keys());
        let mut met: Vec<usize> = monomials.flatten().map(|(variable, _)| *variable as usize).collect();
        met.sort_unstable();
        met.dedup();
        met
    };
    for (output, last) in model.outputs.iter().zip(&orders.last) {
        waiting.extend(of(output).into_iter().map(|variable| (variable, *last)));
    }
    for (_, places) in &model.unknowns {
        waiting.extend(places.iter().map(|place| (*place, 0)));
    }
    for asked in &model.asked {
        waiting.extend(of(asked).into_iter().map(|variable| (variable, 0)));
    }
    while let Some((variable, order)) = waiting.pop() {
        if needed[variable].is_some_and(|known| known >= order) {
            continue;
        }
        needed[variable] = Some(order);
        if let (Motion::Moves(rate), true) = (&model.variables[variable].motion, order > 0) {
            waiting.extend(of(rate).into_iter().map(|other| (other, order - 1)));
        }
    }
    needed
}

/// Where the free unknowns are fixed, which makes a fibre finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Held {
    /// At the values that the point has.
    AtThePoint,
    /// At other random values: what has one value there and at the point has it on the whole fibre.
    Elsewhere,
}

impl Fibre {
    /// The fibre through a point, with the free unknowns fixed.
    pub fn new(
        model: &Model,
        orders: &Orders,
        field: PrimeField,
        source: &mut Source,
        held: Held,
    ) -> Result<Fibre, Trouble> {
        let numbering = Numbering { variables: model.variables.len(), asked: model.asked.len() };
        let needed = needed(model, orders);
        let next = |jet: u32| -> Option<u32> {
            let variable = (jet % numbering.stride()) as usize;
            match model.variables.get(variable)?.motion {
                Motion::Rests => None,
                _ => Some(jet + numbering.stride()),
            }
        };
        let mut values: HashMap<u32, u64> = random_point(model, field, source)?;
        // derivatives of drives are anything
        for (variable, order) in needed.iter().enumerate() {
            if let (Motion::Driven, Some(order)) = (&model.variables[variable].motion, order) {
                for k in 0..=*order {
                    let jet = numbering.jet(variable, k);
                    values.entry(jet).or_insert_with(|| source.value(&field, jet));
                }
            }
        }
        let too_large = || Trouble::TooLarge("the derivatives of the equations are too long".to_owned());
        // how each variable moves, differentiated order by order, and the values that follow
        let mut equations = Vec::new();
        let mut moving: Vec<(usize, usize, Jet)> = Vec::new();
        for (variable, order) in needed.iter().enumerate() {
            if let (Motion::Moves(rate), Some(order)) = (&model.variables[variable].motion, order) {
                let moved = Jet::variable(&field, numbering.jet(variable, 1));
                let mut equation =
                    Jet::of(&field, &rate.bottom).times(&field, &moved, MOST_TERMS).ok_or_else(too_large)?;
                let minus_one = field.modulus() - field.one();
                equation.add_multiple(&field, &Jet::of(&field, &rate.top), minus_one);
                moving.push((variable, *order, equation));
            }
        }
        let mut terms = 0;
        let deepest = needed.iter().flatten().copied().max().unwrap_or(0);
        for k in 0..deepest {
            for (variable, order, equation) in &mut moving {
                if k >= *order {
                    continue;
                }
                if k > 0 {
                    *equation = equation.derivative(&field, next).ok_or_else(too_large)?;
                }
                terms += equation.terms.len();
                if terms > MOST_TERMS {
                    return Err(too_large());
                }
                let target = numbering.jet(*variable, k + 1);
                let value = solve(&field, equation, target, &values).ok_or(Trouble::Pole)?;
                values.insert(target, value);
                equations.push(equation.clone());
            }
        }
        for (output, last) in model.outputs.iter().zip(&orders.last) {
            // an output as a variable of its own, whose derivatives are known
            let own = numbering.stride() - 1;
            let next = |jet: u32| {
                if jet % numbering.stride() == own { Some(jet + numbering.stride()) } else { next(jet) }
            };
            let seen = Jet::variable(&field, own);
            let mut equation =
                Jet::of(&field, &output.bottom).times(&field, &seen, MOST_TERMS).ok_or_else(too_large)?;
            equation.add_multiple(&field, &Jet::of(&field, &output.top), field.modulus() - field.one());
            let mut of_output = HashMap::new();
            for k in 0..=*last {
                if k > 0 {
                    equation = equation.derivative(&field, next).ok_or_else(too_large)?;
                }
                terms += equation.terms.len();
                if terms > MOST_TERMS {
                    return Err(too_large());
                }
                let target = own + k as u32 * numbering.stride();
                let mut all = values.clone();
                all.extend(&of_output);
                of_output.insert(target, solve(&field, &equation, target, &all).ok_or(Trouble::Pole)?);
                equations.push(equation.with_values(&field, |jet| of_output.get(&jet).copied()));
            }
        }
        let mut fibre = Fibre { field, equations, unknowns: Vec::new(), asked: Vec::new(), values };
        let free = match held {
            Held::AtThePoint => HashMap::new(),
            Held::Elsewhere => elsewhere(model, orders, &field, source),
        };
        fibre.ties(model, orders, &numbering, &free)?;
        Ok(fibre)
    }

    /// What is known, what is fixed (at values of the point, but where others are given), that denominators do not vanish, that angles
    /// are points of the circle; and what is asked.
    fn ties(
        &mut self,
        model: &Model,
        orders: &Orders,
        numbering: &Numbering,
        elsewhere: &HashMap<u32, u64>,
    ) -> Result<(), Trouble> {
        let field = self.field;
        let too_large = || Trouble::TooLarge("the equations are too long".to_owned());
        let minus_one = field.modulus() - field.one();
        let at_first = |place: usize| numbering.jet(place, 0);
        let mut held: Vec<usize> =
            (0..model.variables.len()).filter(|place| model.variables[*place].is_known).collect();
        held.extend(orders.free.iter().flat_map(|free| model.unknowns[*free].1.clone()));
        held.extend(model.given.iter().map(|(place, _)| *place));
        let mut known: HashMap<u32, u64> = held
            .into_iter()
            .filter_map(|place| {
                let jet = at_first(place);
                Some((jet, *elsewhere.get(&jet).or_else(|| self.values.get(&jet))?))
            })
            .collect();
        for (place, variable) in model.variables.iter().enumerate() {
            if let Motion::Driven = variable.motion {
                let jets =
                    self.values.iter().filter(|(jet, _)| (**jet % numbering.stride()) as usize == place);
                known.extend(jets.map(|(jet, value)| (*jet, *value)));
            }
        }
        let mut bottoms: Vec<Exact> = Vec::new();
        let rates = model.variables.iter().filter_map(|variable| match &variable.motion {
            Motion::Moves(rate) => Some(rate),
            _ => None,
        });
        for factor in rates.chain(&model.outputs).chain(&model.asked).flat_map(|quotient| &quotient.factors) {
            if !bottoms.contains(factor) {
                bottoms.push(factor.clone());
            }
        }
        if bottoms.len() as u32 + 1 >= INVERSES {
            return Err(too_large());
        }
        for (place, bottom) in bottoms.iter().enumerate() {
            let inverse = Jet::variable(&field, numbering.inverse(place));
            let mut equation =
                Jet::of(&field, bottom).times(&field, &inverse, MOST_TERMS).ok_or_else(too_large)?;
            equation.add_term(&field, Vec::new(), minus_one);
            self.equations.push(equation);
        }
        for (place, variable) in model.variables.iter().enumerate() {
            if let Input::Cosine(_) = variable.input {
                let mut circle = Jet::constant(minus_one);
                for part in [place, place + 1] {
                    circle.add_term(&field, vec![(at_first(part), 2)], field.one());
                }
                self.equations.push(circle);
            }
        }
        for (place, asked) in model.asked.iter().enumerate() {
            let own = Jet::variable(&field, numbering.asked(place));
            let mut equation =
                Jet::of(&field, &asked.bottom).times(&field, &own, MOST_TERMS).ok_or_else(too_large)?;
            equation.add_multiple(&field, &Jet::of(&field, &asked.top), minus_one);
            let value =
                solve(&field, &equation, numbering.asked(place), &self.values).ok_or(Trouble::Pole)?;
            self.values.insert(numbering.asked(place), value);
            self.equations.push(equation);
            self.asked.push(numbering.asked(place));
        }
        for equation in &mut self.equations {
            *equation = equation.with_values(&field, |jet| known.get(&jet).copied());
        }
        // what is known has an equation too, so that whoever asks for it finds it
        for (jet, value) in known {
            let mut equation = Jet::variable(&field, jet);
            equation.add_term(&field, Vec::new(), field.modulus() - value);
            if value == 0 {
                equation = Jet::variable(&field, jet);
            }
            self.equations.push(equation);
        }
        self.unknowns = model
            .unknowns
            .iter()
            .map(|(_, places)| places.iter().map(|place| at_first(*place)).collect())
            .collect();
        Ok(())
    }
}

/// Other random values of the unknowns that are free.
fn elsewhere(model: &Model, orders: &Orders, field: &PrimeField, source: &mut Source) -> HashMap<u32, u64> {
    let mut values = HashMap::new();
    for free in &orders.free {
        match model.unknowns[*free].1.as_slice() {
            [cosine, sine] => {
                let unit = field.draw_unit(source.random());
                values.extend([(*sine as u32, unit.0), (*cosine as u32, unit.1)]);
            }
            places => values.extend(places.iter().map(|place| (*place as u32, field.draw(source.random())))),
        }
    }
    values
}

/// Random initial conditions, or those that the file gives.
pub(super) fn random_point(
    model: &Model,
    field: PrimeField,
    source: &mut Source,
) -> Result<HashMap<u32, u64>, Trouble> {
    let mut values = HashMap::new();
    for (place, variable) in model.variables.iter().enumerate() {
        match variable.input {
            Input::Cosine(_) => {
                let (sine, cosine) = field.draw_unit(source.random());
                values.insert(place as u32, cosine);
                values.insert(place as u32 + 1, sine);
            }
            Input::Sine(_) => {}
            _ => {
                values.insert(place as u32, source.value(&field, place as u32));
            }
        }
    }
    let program = model.given_program();
    let by_input: HashMap<Input, u64> = model
        .variables
        .iter()
        .zip(0u32..)
        .map(|(variable, place)| (variable.input, values[&place]))
        .collect();
    let drawn = draw_residues(&program, &field, source.random());
    let inputs: Vec<u64> = program
        .inputs()
        .iter()
        .zip(drawn)
        .map(|(input, drawn)| by_input.get(input).copied().unwrap_or(drawn))
        .collect();
    let loaded = program.load(field).map_err(|_| Trouble::Pole)?;
    let given = loaded.run(&inputs, &mut Vec::new()).map_err(|_| Trouble::Pole)?;
    for ((place, _), value) in model.given.iter().zip(given) {
        values.insert(*place as u32, value);
    }
    Ok(values)
}

/// The value of a variable that stands in an equation in first power, from those of the others.
fn solve(field: &PrimeField, equation: &Jet, variable: u32, values: &HashMap<u32, u64>) -> Option<u64> {
    let (mut slope, mut rest) = (0, 0);
    for (monomial, coefficient) in &equation.terms {
        let (mut factor, mut has_it) = (*coefficient, false);
        for (other, power) in monomial {
            if *other == variable {
                has_it = true;
                continue;
            }
            let value = *values.get(other)?;
            for _ in 0..*power {
                factor = field.product(factor, value);
            }
        }
        if has_it {
            slope = field.sum(slope, factor);
        } else {
            rest = field.sum(rest, factor);
        }
    }
    let minus = if rest == 0 { 0 } else { field.modulus() - rest };
    Some(field.product(minus, field.inverse(slope)?))
}
