//! How many values of an unknown give the same outputs: one, finitely many, infinitely many.
//!
//! The outputs of almost every state, as functions of time and of known inputs, are met by the states and constants of a *fibre*. At a random point modulo a random prime
//! its equations are written down: `Q x' = P` and the outputs, differentiated along time as often as tells all
//! ([`Orders`]), with the derivatives of the outputs that the point has. Unknowns that are not even locally determined are held as far as that makes the fibre finite, which leaves the number of values of
//! the others what it is. What can be solved is solved ([`eliminate`]), of the rest a Groebner basis is found ([`basis`]), and each unknown's minimal polynomial in the quotient
//! algebra ([`quotient`]): the number of its distinct roots is that of the values, over the complex numbers.
//!
//! That there are no more values than were met is as certain as [`bound`] says, and for small systems that is beyond doubt. That there
//! are as many is shown by a symmetry ([`discrete`]), or computed.
//!
//! References: H. Hong, A. Ovchinnikov, G. Pogudin and C. Yap, *Global identifiability of differential models*, Comm. Pure Appl. Math. 73
//! (2020), for the fibre at a random point, and for the orders; A. Ovchinnikov, G. Pogudin and P. Thompson, *Parameter identifiability and input-output
//! equations*, AAECC 34 (2023), for what it means.

mod basis;
mod bound;
mod eliminate;
mod exact;
mod jets;
mod model;
mod monomials;
mod point;
mod quotient;
#[cfg(test)]
mod tests;

use super::Frame;
use super::generic::{Orders, Probe, Seen};
use super::needed::CodistributionError;
use crate::expression::NodeId;
use crate::number::PrimeField;
use crate::system::{Assignment, System, UnknownKind};
use basis::{Basis, Limits, Row, Stop};
use eliminate::Solved;
use jets::Jet;
use model::Model;
use monomials::Monomials;
use point::{Fibre, Trouble};
use quotient::{Algebra, NoAlgebra, distinct_roots};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::cell::Cell;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};

/// How many values give the same outputs, at almost all states.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Solutions {
    /// So many, over the complex numbers.
    Finite(usize),
    /// Infinitely many, in any neighbourhood.
    Infinite,
    /// It is not known, and this is why.
    Undecided(String),
}

/// What is known of the values of one unknown, or of one expression.
#[derive(Clone, Debug, PartialEq)]
pub struct SolutionsOf {
    /// Its name, or the expression.
    pub name: String,
    /// What it is; nothing of an expression.
    pub kind: Option<UnknownKind>,
    /// Whether it is seen locally.
    pub local: Seen,
    /// What was found.
    pub solutions: Solutions,
    /// No more values than these, but for an error of probability below two to this power; nothing where there is no bound below `2^-100`.
    pub at_most: Option<(usize, f64)>,
}

/// What is known of the values of all unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct SolutionsAnswer {
    /// The unknowns in the order of the file, then the expressions.
    pub unknowns: Vec<SolutionsOf>,
    /// At how many random points, each modulo a random prime.
    pub rounds: usize,
    /// How many derivatives of each output were taken.
    pub orders: Vec<usize>,
    /// How many states and constants give the same outputs, those held that are not locally seen.
    pub points: Option<usize>,
    /// Whether values at the beginning are given, so that further derivatives might tell more.
    pub orders_are_open: bool,
}

/// What is asked.
pub struct SolutionsQuestion<'a> {
    /// What is fixed or given at the beginning.
    pub conditions: Assignment,
    /// Expressions beside the unknowns.
    pub expressions: Vec<(String, NodeId)>,
    /// How much work may be done, in products of residues.
    pub work: u64,
    /// Set by whoever does not wait any longer.
    pub interrupt: &'a AtomicBool,
}

/// Work for about a minute.
pub const WORK: u64 = 10_000_000_000;

/// A verdict that is computed rests on so many rounds at least.
const LEAST_ROUNDS: usize = 2;
/// And one that is proved on no more than these.
const MOST_ROUNDS: usize = 24;
/// As often a pole is met, another point is drawn.
const ATTEMPTS: usize = 20;
/// No more points are counted.
const MOST_POINTS: usize = 600;
/// The widest matrix.
const MOST_COLUMNS: usize = 60_000;
const HIGHEST_DEGREE: u32 = 60;

/// What one round shows.
struct Round {
    points: usize,
    /// Of each unknown and of each expression.
    values: Vec<usize>,
}

/// How many values of each unknown give the same outputs.
///
/// # Errors
/// In words, where nothing can be asked; and as for the rank.
pub fn solutions(
    system: &mut System,
    question: &SolutionsQuestion,
) -> Result<SolutionsAnswer, CodistributionError> {
    let frame = Frame::new(system, &question.conditions)?;
    let generic = frame.generic;
    let unknowns = system.unknowns();
    let mut found: Vec<SolutionsOf> = Vec::new();
    for symbol in &unknowns {
        let local = generic
            .unknowns
            .iter()
            .find(|(other, _)| other == symbol)
            .map_or(Seen::Undecided, |(_, seen)| *seen);
        found.push(SolutionsOf {
            name: system.symbol_name(*symbol).to_owned(),
            kind: system.unknown_kind(*symbol),
            local,
            solutions: Solutions::Undecided(String::new()),
            at_most: None,
        });
    }
    for (name, expression) in &question.expressions {
        let local = local_of(system, &question.conditions, *expression, generic.rank())?;
        let solutions = Solutions::Undecided(String::new());
        found.push(SolutionsOf { name: name.clone(), kind: None, local, solutions, at_most: None });
    }
    let mut answer = SolutionsAnswer {
        unknowns: found,
        rounds: 0,
        orders: Vec::new(),
        points: None,
        orders_are_open: false,
    };
    let counted = count(system, question, &mut answer);
    for of_it in &mut answer.unknowns {
        match (of_it.local, &counted) {
            (Seen::No, _) => of_it.solutions = Solutions::Infinite,
            (Seen::Undecided, _) => {
                let why = generic
                    .open
                    .clone()
                    .unwrap_or_else(|| "it is not known whether it is seen locally".to_owned());
                of_it.solutions = Solutions::Undecided(why);
                of_it.at_most = None;
            }
            (Seen::Yes, Err(why)) => of_it.solutions = Solutions::Undecided(why.clone()),
            (Seen::Yes, Ok(())) => {}
        }
    }
    Ok(answer)
}

/// Whether an expression is seen locally: where the rank stays what it is when it is an output.
fn local_of(
    system: &System,
    conditions: &Assignment,
    expression: NodeId,
    rank: Option<usize>,
) -> Result<Seen, CodistributionError> {
    let mut with_it = system.clone();
    with_it.outputs.push((String::new(), expression));
    with_it.output_guards.push(Vec::new());
    let all = Frame::new(&mut with_it, conditions)?.generic;
    Ok(match (rank, all.rank()) {
        (Some(rank), Some(with_it)) if rank == with_it => Seen::Yes,
        (Some(_), Some(_)) => Seen::No,
        _ => Seen::Undecided,
    })
}

/// Fills the numbers in.
fn count(system: &System, question: &SolutionsQuestion, answer: &mut SolutionsAnswer) -> Result<(), String> {
    let expressions: Vec<NodeId> = question.expressions.iter().map(|(_, node)| *node).collect();
    let model = Model::new(system, &question.conditions, &expressions)?;
    // any fixed seed: what is true almost everywhere does not depend on the user's
    let mut rng = ChaCha8Rng::seed_from_u64(0x6669_6272_6573);
    let probe = Probe::new(system, &question.conditions);
    let mut orders = probe.orders(&mut rng)?;
    if model.is_on_a_set() {
        // an order at which nothing is added is no last one on a set that the fields leave
        answer.orders_are_open = true;
        let longest = orders.last.iter().copied().max().unwrap_or(0) + 1;
        orders.last.fill(longest);
    }
    answer.orders = orders.last.clone();
    let work = Cell::new(0u64);
    let mut best: Option<Round> = None;
    let mut wanted = LEAST_ROUNDS;
    while answer.rounds < wanted {
        let before = work.get();
        let round = round(&model, &orders, question, &work, &mut rng)?;
        answer.rounds += 1;
        match &mut best {
            None => best = Some(round),
            Some(best) if best.values != round.values => {
                return Err(format!(
                    "two random points disagree: one has {} points in its fibre and another one {}",
                    best.points, round.points
                ));
            }
            Some(_) => {}
        }
        if answer.rounds == 1 {
            // further rounds, where they are cheap and make a proof of it
            let Some(best) = &best else { continue };
            let cost = (work.get() - before).max(1);
            let affordable = (question.work / 2 / cost).min(MOST_ROUNDS as u64) as usize;
            for (place, values) in best.values.iter().enumerate() {
                if let Some(each) = of_a_round(&model, &orders, place, *values) {
                    let needed = (100.0 / -each).ceil() as usize;
                    if needed <= affordable {
                        wanted = wanted.max(needed);
                    }
                }
            }
        }
    }
    let Some(best) = best else { return Ok(()) };
    answer.points = Some(best.points);
    for (place, (of_it, values)) in answer.unknowns.iter_mut().zip(&best.values).enumerate() {
        of_it.solutions = Solutions::Finite(*values);
        if let Some(each) = of_a_round(&model, &orders, place, *values) {
            let log2_error = answer.rounds as f64 * each;
            if log2_error <= -100.0 {
                of_it.at_most = Some((*values, log2_error));
            }
        }
    }
    Ok(())
}

/// The logarithm of the probability that one round shows so few values where there are more.
fn of_a_round(model: &Model, orders: &Orders, place: usize, values: usize) -> Option<f64> {
    let asked = place.checked_sub(model.unknowns.len()).and_then(|place| model.asked.get(place));
    bound::bounds(model, orders, asked)?.of_a_round(values)
}

/// The fibre through one random point.
fn round(
    model: &Model,
    orders: &Orders,
    question: &SolutionsQuestion,
    work: &Cell<u64>,
    rng: &mut ChaCha8Rng,
) -> Result<Round, String> {
    let mut met = None;
    for _ in 0..ATTEMPTS {
        match Fibre::new(model, orders, PrimeField::random(rng), rng) {
            Ok(fibre) => {
                met = Some(fibre);
                break;
            }
            Err(Trouble::Pole) => {}
            Err(Trouble::TooLarge(why)) => return Err(why),
        }
    }
    let Some(fibre) = met else { return Err(format!("{ATTEMPTS} random points were poles")) };
    let is_over = || question.interrupt.load(Ordering::Relaxed) || work.get() > question.work;
    let field = fibre.field;
    let solved = Solved::new(&field, fibre.equations, &is_over);
    let variables = solved.variables();
    // derivatives of high order are the greatest
    let place: HashMap<u32, usize> = variables.iter().rev().copied().zip(0..).collect();
    let mut monomials = Monomials::new(variables.len());
    let rows = solved.equations.iter().map(|equation| row(equation, &place, &mut monomials)).collect();
    let limits = Limits { columns: MOST_COLUMNS, degree: HIGHEST_DEGREE, work, is_over: &is_over };
    let sizes = || format!("{} equations in {} variables", solved.equations.len(), variables.len());
    let basis = Basis::of(field, monomials, rows, &limits).map_err(|stop| match stop {
        Stop::TimeIsUp if question.interrupt.load(Ordering::Relaxed) => "it was cut off".to_owned(),
        Stop::TimeIsUp => {
            format!("the Groebner basis of {} takes more than {:.0e} products", sizes(), question.work as f64)
        }
        Stop::TooWide(columns) => {
            format!("the Groebner basis of {} needs a matrix of more than {columns} columns", sizes())
        }
        Stop::DegreeTooHigh(degree) => {
            format!("the Groebner basis of {} needs polynomials of degree {degree}", sizes())
        }
    })?;
    let mut algebra = Algebra::new(basis, MOST_POINTS).map_err(|why| match why {
        NoAlgebra::Infinite => "the fibre of a random point is not finite".to_owned(),
        NoAlgebra::MoreThan(most) => format!("more than {most} states and constants give the same outputs"),
    })?;
    let mut count_of = |jet: Jet| -> Result<usize, String> {
        let mut polynomial = Vec::new();
        for (monomial, coefficient) in &jet.terms {
            let powers: Option<Vec<(usize, u16)>> =
                monomial.iter().map(|(variable, power)| Some((*place.get(variable)?, *power))).collect();
            let powers = powers.ok_or("the fibre of a random point leaves an unknown open")?;
            polynomial.push((powers, *coefficient));
        }
        if polynomial.iter().all(|(powers, _)| powers.is_empty()) {
            return Ok(1);
        }
        Ok(distinct_roots(&field, &algebra.minimal_polynomial(&polynomial)))
    };
    let mut values = Vec::new();
    for of_it in &fibre.unknowns {
        // of an angle a combination of its cosine and its sine that tells any two points of finitely many apart
        let mut jet = Jet::default();
        for variable in of_it {
            let factor = if of_it.len() > 1 { field.draw(rng) } else { field.one() };
            jet.add_multiple(&field, &solved.express(&field, *variable), factor);
        }
        values.push(count_of(jet)?);
    }
    for variable in &fibre.asked {
        values.push(count_of(solved.express(&field, *variable))?);
    }
    Ok(Round { points: algebra.dimension(), values })
}

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
