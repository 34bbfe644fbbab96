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
mod discrete;
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
use super::generic::{GenericAnswer, Orders, Probe, Seen};
use super::needed::CodistributionError;
use crate::expression::{LOG2_ERROR, NodeId};
use crate::number::PrimeField;
use crate::system::{Assignment, System, UnknownKind};
use basis::{Basis, Limits, Row, Stop};
use dashu::rational::RBig;
use discrete::{Exchange, exchanges, in_words, values_of_expression, values_of_variable};
use eliminate::Solved;
use jets::Jet;
use model::{Model, Motion};
use monomials::Monomials;
use point::{Fibre, Numbering, Trouble};
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
    /// The probability of an error in that, as a power of two.
    pub local_error: f64,
    /// What was found.
    pub solutions: Solutions,
    /// No more values than these, but for an error of probability below two to this power; nothing where there is no bound below `2^-100`.
    pub at_most: Option<(usize, f64)>,
    /// As many values at least, and a map of the unknowns that shows it: proved, without an error.
    pub at_least: Option<(usize, String)>,
}

impl SolutionsOf {
    /// What is proved: that there are so many values and no more, or infinitely many.
    pub fn is_proved(&self) -> bool {
        match self.solutions {
            Solutions::Infinite => true,
            Solutions::Finite(count) => {
                let least = self.at_least.as_ref().map_or(1, |(least, _)| *least);
                self.at_most.is_some_and(|(most, _)| most == count) && least == count
            }
            Solutions::Undecided(_) => false,
        }
    }
}

/// Two sets of states and constants at which the outputs have the same derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct SecondPoint {
    /// Name, value at the one and value at the other point, of all that the file declares.
    pub values: Vec<(String, RBig, RBig)>,
    /// Up to this order the derivatives of all outputs are equal, in exact arithmetic.
    pub order: usize,
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
    /// How much work it was, in products of residues.
    pub work: u64,
    /// Two points with the same outputs, in exact numbers, where there are just two and no symmetry shows it.
    pub second: Option<SecondPoint>,
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
const HIGHEST_DEGREE: u32 = 120;

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
            local_error: generic.log2_error,
            solutions: Solutions::Undecided(String::new()),
            at_most: None,
            at_least: None,
        });
    }
    for (name, expression) in &question.expressions {
        let (local, local_error) = local_of(system, &question.conditions, *expression, &generic)?;
        let solutions = Solutions::Undecided(String::new());
        found.push(SolutionsOf {
            name: name.clone(),
            kind: None,
            local,
            local_error,
            solutions,
            at_most: None,
            at_least: None,
        });
    }
    let mut answer = SolutionsAnswer {
        unknowns: found,
        rounds: 0,
        orders: Vec::new(),
        points: None,
        work: 0,
        second: None,
        orders_are_open: false,
    };
    let counted = match Model::new(system, &question.conditions, &expressions(question)) {
        Ok(model) => {
            by_symmetry(&model, &mut answer);
            count(system, &model, question, &mut answer)
        }
        Err(why) => Err(why),
    };
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
            (Seen::Yes, Ok(())) => {
                let least = of_it.at_least.as_ref().map_or(1, |(least, _)| *least);
                if matches!(of_it.solutions, Solutions::Finite(count) if count < least) {
                    // what is proved stands; the random points were special ones
                    let why = "the random points have fewer values than a symmetry shows".to_owned();
                    (of_it.solutions, of_it.at_most) = (Solutions::Undecided(why), None);
                }
            }
        }
    }
    Ok(answer)
}

/// The logarithm of the sum of two probabilities.
fn sum_of_errors(a: f64, b: f64) -> f64 {
    (a.exp2() + b.exp2()).log2()
}

/// Whether an expression is seen locally: where the rank stays what it is when it is an output.
fn local_of(
    system: &System,
    conditions: &Assignment,
    expression: NodeId,
    generic: &GenericAnswer,
) -> Result<(Seen, f64), CodistributionError> {
    let mut with_it = system.clone();
    with_it.outputs.push((String::new(), expression));
    with_it.output_guards.push(Vec::new());
    let all = Frame::new(&mut with_it, conditions)?.generic;
    let log2_error = sum_of_errors(generic.log2_error, all.log2_error);
    let seen = match (generic.rank(), all.rank()) {
        (Some(rank), Some(with_it)) if rank == with_it => Seen::Yes,
        (Some(_), Some(_)) => Seen::No,
        _ => Seen::Undecided,
    };
    Ok((seen, log2_error))
}

fn expressions(question: &SolutionsQuestion) -> Vec<NodeId> {
    question.expressions.iter().map(|(_, node)| *node).collect()
}

/// Fills in what symmetries show.
fn by_symmetry(model: &Model, answer: &mut SolutionsAnswer) {
    let exchanges = exchanges(model);
    let of_unknowns = model.unknowns.len();
    for (number, of_it) in answer.unknowns.iter_mut().enumerate() {
        if of_it.local != Seen::Yes {
            continue;
        }
        let values = |maps: &[Exchange]| match model.unknowns.get(number) {
            Some((_, places)) => places.first().map_or(1, |place| values_of_variable(maps, *place)),
            None => model
                .asked
                .get(number - of_unknowns)
                .map_or(1, |asked| values_of_expression(model, maps, asked)),
        };
        let count = values(&exchanges);
        // of all maps that change it one that changes little besides
        let changing = exchanges.iter().filter(|map| values(std::slice::from_ref(map)) > 1);
        if let Some(map) = changing.min_by_key(|map| map.size()) {
            of_it.at_least = Some((count, in_words(model, map)));
        }
    }
}

/// Fills the numbers in.
fn count(
    system: &System,
    model: &Model,
    question: &SolutionsQuestion,
    answer: &mut SolutionsAnswer,
) -> Result<(), String> {
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
    let course = Course { work: Cell::new(0), by_level: Cell::new(None) };
    let mut best: Option<Round> = None;
    let mut wanted = LEAST_ROUNDS;
    while answer.rounds < wanted {
        let before = course.work.get();
        let round = round(model, &orders, question, &course, &mut rng);
        answer.work = course.work.get();
        let round = round?;
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
            let cost = (course.work.get() - before).max(1);
            let affordable = (question.work / 2 / cost).min(MOST_ROUNDS as u64) as usize;
            for (place, values) in best.values.iter().enumerate() {
                if let Some(each) = of_a_round(model, &orders, place, *values) {
                    // what is known of the rank may fail as well
                    let needed = ((1.0 - LOG2_ERROR) / -each).ceil() as usize;
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
        if let Some(each) = of_a_round(model, &orders, place, *values) {
            let log2_error = sum_of_errors(answer.rounds as f64 * each, of_it.local_error);
            if log2_error <= LOG2_ERROR {
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
    course: &Course,
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

/// What is done so far.
struct Course {
    /// In products of residues.
    work: Cell<u64>,
    /// Whether the weights that led to a basis first were those of levels.
    by_level: Cell<Option<bool>>,
}

/// The basis, by the first weights that lead to one: all are one, or they grow with the distance from the outputs. None is the better one always,
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
    let of = |quotient: &model::Quotient| -> Vec<usize> {
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
