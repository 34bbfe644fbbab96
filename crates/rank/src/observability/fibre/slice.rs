//! What functions of the unknowns have one value on a whole fibre: slices of it, and how many points given functions have in common.
//!
//! Where a fibre is infinite its free unknowns are fixed elsewhere than at the point. The fibre of almost every point is the closure of
//! one point over the field of the outputs, so that all of its components are met by such a slice, and what has the point's value on slices at random
//! has it on all of the fibre.

use super::SolutionsQuestion;
use super::exact::Exact;
use super::jets::Jet;
use super::model::{Model, Motion};
use super::point::Held;
use super::round::{Course, Element, Functions, NoRound, by_ways, random_fibre};
use crate::observability::generic::{Orders, Probe};
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{Input, NodeId};
use palmistry_math::number::PrimeField;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::cell::Cell;
use std::collections::HashMap;

/// The fibres of a system, to be cut at random.
pub(in crate::observability) struct Slicer<'a> {
    model: Model,
    orders: Orders,
    question: &'a SolutionsQuestion<'a>,
    course: Course,
    rng: ChaCha8Rng,
    field: PrimeField,
    variables: Vec<SlicedVariable>,
}

/// A variable: an unknown itself, or cosine or sine of an angle, or a constant that is known.
#[derive(Clone, Copy, Debug)]
pub(in crate::observability) struct SlicedVariable {
    /// Of which unknown, in the order of the file; none of what is known.
    pub unknown: Option<usize>,
    pub input: Input,
    place: usize,
}

/// One slice.
pub(in crate::observability) struct Slice {
    functions: Functions,
    /// The variables of the unknowns in the algebra, and their values at the point.
    images: Vec<Element>,
    pub own: Vec<u64>,
}

/// More terms than this are not multiplied out.
const MOST_TERMS: usize = 20_000;

impl<'a> Slicer<'a> {
    /// The fibres of a system where the question's conditions are met.
    ///
    /// # Errors
    /// In words, where no values are counted of such a system, or initial conditions are given.
    pub fn new(system: &System, question: &'a SolutionsQuestion<'a>) -> Result<Slicer<'a>, String> {
        let model = Model::new(system, &question.conditions, &[])?;
        if model.is_on_a_set() {
            return Err("initial conditions are given: functions are looked for generically alone".to_owned());
        }
        let mut rng = ChaCha8Rng::seed_from_u64(0x736c_6963_6573); // any fixed seed: what is found is counted again
        let orders = Probe::new(system, &question.conditions).orders(&mut rng)?;
        let of_unknown = |(unknown, (_, places)): (usize, &(_, Vec<usize>))| -> Vec<SlicedVariable> {
            let of_place = |place: &usize| SlicedVariable {
                unknown: Some(unknown),
                input: model.variables[*place].input,
                place: *place,
            };
            places.iter().map(of_place).collect()
        };
        let mut variables: Vec<SlicedVariable> =
            model.unknowns.iter().enumerate().flat_map(of_unknown).collect();
        for (place, variable) in model.variables.iter().enumerate() {
            let is_constant =
                matches!(variable.motion, Motion::Rests) && !matches!(variable.input, Input::Opaque(_));
            if variable.is_known && is_constant {
                variables.push(SlicedVariable { unknown: None, input: variable.input, place });
            }
        }
        let course = Course { work: Cell::new(0), way: Cell::new(None) };
        let field = PrimeField::random(&mut rng);
        Ok(Slicer { model, orders, question, course, rng, field, variables })
    }

    /// Modulo which prime all slices are.
    pub fn field(&self) -> PrimeField {
        self.field
    }

    /// The variables of the unknowns in the order of the file, then constants that are known.
    pub fn variables(&self) -> &[SlicedVariable] {
        &self.variables
    }

    /// What was done so far, in products of residues.
    pub fn work(&self) -> u64 {
        self.course.work.get()
    }

    /// Counts work that was done elsewhere for the same question.
    pub fn spend(&self, work: u64) {
        self.course.work.set(self.course.work.get() + work);
    }

    /// How many unknowns are fixed: the others are functions of the outputs and of these.
    pub fn free(&self) -> usize {
        self.orders.free.len()
    }

    /// A slice of the fibre of another random point.
    ///
    /// # Errors
    /// In words, where it takes too much work.
    pub fn next(&mut self) -> Result<Slice, String> {
        let Slicer { model, orders, question, course, rng, field, variables } = self;
        by_ways(orders, question, course, |orders, way| {
            let fibre = random_fibre(model, orders, (Some(*field), Held::Elsewhere), rng)?;
            let own = variables.iter().map(|variable| fibre.values[&(variable.place as u32)]).collect();
            let functions = Functions::of(model, *field, fibre.equations, question, &course.work, way)?;
            let image = |variable: &SlicedVariable| {
                functions.element(functions.express(field, variable.place as u32))
            };
            let images = variables.iter().map(image).collect::<Result<_, NoRound>>()?;
            Ok(Slice { functions, images, own })
        })
    }

    /// How many states and constants have the values that these functions have at a random point, with those fixed that are not locally observable.
    ///
    /// # Errors
    /// In words; infinitely many too.
    pub fn common_points(&mut self, system: &System, functions: &[NodeId]) -> Result<usize, String> {
        let conditions: &Assignment = &self.question.conditions;
        let Model { asked, variables: inputs, .. } = Model::new(system, conditions, functions)?;
        let field = PrimeField::random(&mut self.rng);
        let mut values: HashMap<u32, u64> = HashMap::new();
        let mut equations = Vec::new();
        for variable in self.variables.iter().filter(|variable| variable.unknown.is_some()) {
            let place = variable.place as u32;
            if let Input::Cosine(_) = variable.input {
                let (sine, cosine) = field.draw_unit(&mut self.rng);
                values.extend([(place, cosine), (place + 1, sine)]);
                let mut circle = Jet::constant(field.modulus() - field.one());
                for part in [place, place + 1] {
                    circle.add_term(&field, vec![(part, 2)], field.one());
                }
                equations.push(circle);
            } else if !matches!(variable.input, Input::Sine(_)) {
                values.insert(place, field.draw(&mut self.rng));
            }
        }
        // what is known is any number, or any point of the circle
        let mut known: HashMap<u32, u64> = HashMap::new();
        for (place, variable) in inputs.iter().enumerate() {
            let place = place as u32;
            match variable.input {
                _ if values.contains_key(&place) => {}
                Input::Cosine(_) => {
                    let (sine, cosine) = field.draw_unit(&mut self.rng);
                    known.extend([(place, cosine), (place + 1, sine)]);
                }
                Input::Sine(_) => {}
                _ => {
                    known.insert(place, field.draw(&mut self.rng));
                }
            }
        }
        for (place, quotient) in asked.iter().enumerate() {
            let jet =
                |exact: &Exact| Jet::of(&field, exact).with_values(&field, |jet| known.get(&jet).copied());
            let at_the_point = |jet: &Jet| {
                let value = jet.with_values(&field, |jet| values.get(&jet).copied());
                value.terms.get(&Vec::new()).copied().unwrap_or(0)
            };
            let (top, bottom) = (jet(&quotient.top), jet(&quotient.bottom));
            let (above, below) = (at_the_point(&top), at_the_point(&bottom));
            let mut equation = Jet::default();
            equation.add_multiple(&field, &top, below);
            equation.add_multiple(&field, &bottom, if above == 0 { 0 } else { field.modulus() - above });
            equations.push(equation);
            if quotient.bottom.as_constant().is_none() {
                let inverse = Jet::variable(&field, (self.model.variables.len() + place) as u32);
                let too_long = || "a denominator is too long".to_owned();
                let mut tie = bottom.times(&field, &inverse, MOST_TERMS).ok_or_else(too_long)?;
                tie.add_term(&field, Vec::new(), field.modulus() - field.one());
                equations.push(tie);
            }
        }
        for free in &self.orders.free {
            for place in &self.model.unknowns[*free].1 {
                let place = *place as u32;
                let mut held = Jet::variable(&field, place);
                held.add_term(&field, Vec::new(), field.modulus() - values[&place]);
                equations.push(held);
            }
        }
        let Slicer { model, question, .. } = self;
        // the way that is best for the fibres need not be for these
        let course = Course { work: Cell::new(self.course.work.get()), way: Cell::new(None) };
        let found = by_ways(&self.orders, question, &course, |_, way| {
            let functions = Functions::of(model, field, equations.clone(), question, &course.work, way)?;
            // what stands in no equation that is left has any value
            for unknown in values.keys() {
                functions.element(functions.express(&field, *unknown))?;
            }
            Ok(functions.algebra.dimension())
        });
        self.course.work.set(course.work.get());
        found
    }
}

impl Slice {
    /// The function that is one everywhere, as a combination of standard monomials.
    pub fn one(&self) -> Vec<u64> {
        self.functions.algebra.one()
    }

    /// The product of a variable, by its place among all, and a function.
    pub fn times(&mut self, variable: usize, function: &[u64]) -> Vec<u64> {
        self.functions.algebra.apply(&self.images[variable], function)
    }
}
