//! One round: the points of a random fibre, by what can be solved and by a Groebner basis of the rest.

use super::SolutionsQuestion;
use super::basis::{Basis, Limits, Row, Stop};
use super::eliminate::Solved;
use super::jets::Jet;
use super::model::{Model, Motion, Quotient};
use super::monomials::Monomials;
use super::point::{Fibre, Numbering, Source, Trouble};
use super::quotient::{Algebra, NoAlgebra, distinct_roots};
use crate::observability::generic::Orders;
use palmistry_math::number::PrimeField;
use rand_chacha::ChaCha8Rng;
use std::cell::Cell;
use std::collections::HashMap;
use std::sync::atomic::Ordering;

/// As often a pole is met, another point is drawn.
const ATTEMPTS: usize = 20;
/// No more points are counted.
const MOST_POINTS: usize = 600;
/// The widest matrix.
const MOST_COLUMNS: usize = 60_000;
const HIGHEST_DEGREE: u32 = 120;

/// What one round shows.
pub(super) struct Round {
    pub points: usize,
    /// Of each unknown and of each expression.
    pub values: Vec<usize>,
    pub polynomials: Vec<Vec<u64>>,
}

/// The fibre through one random point.
pub(super) fn round(
    model: &Model,
    orders: &Orders,
    question: &SolutionsQuestion,
    course: &Course,
    rng: &mut ChaCha8Rng,
) -> Result<Round, String> {
    let mut met = None;
    for _ in 0..ATTEMPTS {
        let field = PrimeField::random(rng);
        match Fibre::new(model, orders, field, &mut Source { rng, given: HashMap::new() }) {
            Ok(fibre) => {
                met = Some(fibre);
                break;
            }
            Err(Trouble::Pole) => {}
            Err(Trouble::TooLarge(why)) => return Err(why),
        }
    }
    let Some(fibre) = met else { return Err(format!("{ATTEMPTS} random points were poles")) };
    analysed(model, fibre, question, course, rng)
}

/// What nobody should ever read.
const ASTRAY: &str = "a random point does not lie on its own fibre";

/// The points of a fibre, and the minimal polynomials of what is asked.
pub(super) fn analysed(
    model: &Model,
    fibre: Fibre,
    question: &SolutionsQuestion,
    course: &Course,
    rng: &mut ChaCha8Rng,
) -> Result<Round, String> {
    let is_over = || question.interrupt.load(Ordering::Relaxed) || course.work.get() > question.work;
    let field = fibre.field;
    let solved = Solved::new(&field, fibre.equations, &is_over);
    let variables = solved.variables();
    // derivatives of high order are the greatest
    let place: HashMap<u32, usize> = variables.iter().rev().copied().zip(0..).collect();
    let basis = basis_of(model, question, &solved, &place, field, course)?;
    let mut algebra = Algebra::new(basis, MOST_POINTS).map_err(|why| match why {
        NoAlgebra::Infinite => "the fibre of a random point is not finite".to_owned(),
        NoAlgebra::MoreThan(most) => format!("more than {most} states and constants give the same outputs"),
    })?;
    if algebra.dimension() == 0 {
        return Err(ASTRAY.to_owned());
    }
    let mut minimal = |jet: Jet| -> Result<Vec<u64>, String> {
        let mut polynomial = Vec::new();
        for (monomial, coefficient) in &jet.terms {
            let powers: Option<Vec<(usize, u16)>> =
                monomial.iter().map(|(variable, power)| Some((*place.get(variable)?, *power))).collect();
            let powers = powers.ok_or("the fibre of a random point leaves an unknown open")?;
            polynomial.push((powers, *coefficient));
        }
        if polynomial.iter().all(|(powers, _)| powers.is_empty()) {
            let value = polynomial.first().map_or(0, |(_, value)| *value);
            return Ok(vec![if value == 0 { 0 } else { field.modulus() - value }, field.one()]);
        }
        Ok(algebra.minimal_polynomial(&polynomial))
    };
    let mut polynomials = Vec::new();
    for of_it in &fibre.unknowns {
        // of an angle a combination of its cosine and its sine that tells any two points of finitely many apart
        let (mut jet, mut own) = (Jet::default(), 0);
        for variable in of_it {
            let factor = if of_it.len() > 1 { field.draw(rng) } else { field.one() };
            jet.add_multiple(&field, &solved.express(&field, *variable), factor);
            own = field.sum(own, field.product(factor, fibre.values[variable]));
        }
        polynomials.push((minimal(jet)?, own));
    }
    for variable in &fibre.asked {
        polynomials.push((minimal(solved.express(&field, *variable))?, fibre.values[variable]));
    }
    // the point lies on its own fibre: its values are roots
    for (polynomial, own) in &polynomials {
        let value = polynomial.iter().rev().fold(0, |sum, c| field.sum(field.product(sum, *own), *c));
        if value != 0 {
            return Err(ASTRAY.to_owned());
        }
    }
    let polynomials: Vec<Vec<u64>> = polynomials.into_iter().map(|(polynomial, _)| polynomial).collect();
    let values = polynomials.iter().map(|polynomial| distinct_roots(&field, polynomial)).collect();
    Ok(Round { points: algebra.dimension(), values, polynomials })
}

/// What is done so far.
pub(super) struct Course {
    /// In products of residues.
    pub work: Cell<u64>,
    /// Whether the weights that led to a basis first were those of levels.
    pub by_level: Cell<Option<bool>>,
}

/// The basis, by the first weights that lead to one: all are one, or they grow with the distance from the outputs. None is the
/// better one always,
/// so both are tried with little work and then with more.
///
/// # Errors
/// In words, where all is too much.
fn basis_of(
    model: &Model,
    question: &SolutionsQuestion,
    solved: &Solved,
    place: &HashMap<u32, usize>,
    field: PrimeField,
    course: &Course,
) -> Result<Basis, String> {
    let stride = Numbering { variables: model.variables.len(), asked: model.asked.len() }.stride();
    let levels = levels(model);
    let most = levels.iter().copied().max().unwrap_or(0);
    let weights = |by_level: bool| {
        let mut weights = vec![1; place.len()];
        for (variable, place) in place {
            let variable = (variable % stride) as usize;
            weights[*place] = match model.variables.get(variable).map(|variable| &variable.motion) {
                _ if !by_level => 1,
                None => most + 2,
                Some(Motion::Rests) => 1,
                Some(_) => levels[variable] + 1,
            };
        }
        weights
    };
    let sizes = || format!("{} equations in {} variables", solved.equations.len(), place.len());
    let mut stopped = String::new();
    for share in SHARES {
        for by_level in [false, true] {
            if course.by_level.get().is_some_and(|known| known != by_level) {
                continue;
            }
            let end = (course.work.get() + question.work / share).min(question.work);
            let is_over = || question.interrupt.load(Ordering::Relaxed) || course.work.get() > end;
            let limits = Limits {
                columns: MOST_COLUMNS,
                degree: HIGHEST_DEGREE,
                work: &course.work,
                is_over: &is_over,
            };
            let mut monomials = Monomials::new(weights(by_level));
            let rows = solved.equations.iter().map(|equation| row(equation, place, &mut monomials)).collect();
            match Basis::of(field, monomials, rows, &limits) {
                Ok(basis) => {
                    course.by_level.set(Some(by_level));
                    return Ok(basis);
                }
                Err(_) if question.interrupt.load(Ordering::Relaxed) => {
                    return Err("it was cut off".to_owned());
                }
                Err(Stop::TimeIsUp) if course.work.get() > question.work => {
                    return Err(format!(
                        "the Groebner basis of {} takes more than {:.0e} products",
                        sizes(),
                        question.work as f64
                    ));
                }
                Err(Stop::TimeIsUp) => stopped = format!("the Groebner basis of {} takes too long", sizes()),
                Err(Stop::TooWide(columns)) => {
                    stopped = format!(
                        "the Groebner basis of {} needs a matrix of {columns} columns and more",
                        sizes()
                    );
                }
                Err(Stop::DegreeTooHigh(degree)) => {
                    stopped =
                        format!("the Groebner basis of {} needs polynomials of degree {degree}", sizes());
                }
            }
        }
    }
    Err(stopped)
}

/// The shares of all work that are spent on one try, as their inverses.
const SHARES: [u64; 3] = [100, 10, 2];

/// A polynomial as a row of a basis.
fn row(equation: &Jet, place: &HashMap<u32, usize>, monomials: &mut Monomials) -> Row {
    let mut terms: Vec<(u32, u64)> = Vec::new();
    for (monomial, coefficient) in &equation.terms {
        let powers: Vec<(usize, u16)> =
            monomial.iter().map(|(variable, power)| (place[variable], *power)).collect();
        terms.push((monomials.of(&powers), *coefficient));
    }
    terms.sort_by(|a, b| monomials.compare(b.0, a.0));
    let (monomials, coefficients) = terms.into_iter().unzip();
    Row { monomials, coefficients }
}

/// After how many derivatives an output first mentions a variable.
fn levels(model: &Model) -> Vec<u32> {
    let mut level: Vec<Option<u32>> = vec![None; model.variables.len()];
    let of = |quotient: &Quotient| -> Vec<usize> {
        let monomials = quotient.top.terms.keys().chain(quotient.bottom.terms.keys());
        monomials.flatten().map(|(variable, _)| *variable as usize).collect()
    };
    let mut now: Vec<usize> = model.outputs.iter().flat_map(of).collect();
    let mut depth = 0;
    while !now.is_empty() {
        let mut next = Vec::new();
        for variable in now {
            if level[variable].is_none() {
                level[variable] = Some(depth);
                if let Motion::Moves(rate) = &model.variables[variable].motion {
                    next.extend(of(rate));
                }
            }
        }
        now = next;
        depth += 1;
    }
    level.into_iter().map(|level| level.unwrap_or(0)).collect()
}
