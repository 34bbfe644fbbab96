//! One round: the points of a random fibre, by what can be solved and by a Groebner basis of the rest.

use super::SolutionsQuestion;
use super::basis::{Basis, Limits, Row, Stop};
use super::eliminate::{Solved, TERM, terms};
use super::jets::Jet;
use super::model::{Model, Motion, Quotient};
use super::monomials::Monomials;
use super::point::{Fibre, Held, Numbering, Source, Trouble};
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
const MOST_COLUMNS: usize = 200_000;
/// The fullest: its rows take twelve bytes an entry, some gigabyte.
const MOST_ENTRIES: usize = 60_000_000;
const HIGHEST_DEGREE: u32 = 120;

/// What one round shows.
pub(super) struct Round {
    pub points: usize,
    /// Of each unknown and of each expression.
    pub values: Vec<usize>,
    pub polynomials: Vec<Vec<u64>>,
    /// What it took, without the ways that led to nothing, in products of residues.
    pub work: u64,
}

/// One of the ways to a basis, none of which is the best one always.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Way {
    /// So many derivatives of each output are taken beyond those that determine all. They are uninformative, but with more equations
    /// than unknowns a basis is found at lower degrees: MAP kinases with five outputs take seconds with some more, and no time suffices
    /// without.
    pub further: usize,
    pub form: Form,
}

/// How the equations are brought before a basis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// All that can be solved in a few terms is solved, and all variables count the same.
    Short,
    /// Linear equations alone are solved, so that the others keep their low degrees, and what moves counts the more the farther it is from the
    /// outputs.
    ///
    /// Reference: M. Bessonov, I. Ilmer, T. Konstantinova, A. Ovchinnikov, G. Pogudin and P. Soto, *Faster Groebner bases for Lie derivatives of
    /// ODE systems via monomial orderings*, ISSAC 2024, doi 10.1145/3666000.3669695. Theirs are `level + 1`; twice that was faster on the three
    /// models on which it was measured (Goodwin, SIWR with two outputs, SLIQR).
    Graded,
}

/// What decides small systems at once.
const FIRST: Way = Way { further: 0, form: Form::Short };

/// In the order in which they are tried then.
pub(super) const WAYS: [Way; 8] = [
    Way { further: 4, form: Form::Graded },
    Way { further: 8, form: Form::Graded },
    Way { further: 6, form: Form::Short },
    Way { further: 12, form: Form::Graded },
    Way { further: 12, form: Form::Short },
    FIRST,
    Way { further: 0, form: Form::Graded },
    Way { further: 24, form: Form::Graded },
];

/// The shares of all work that are spent on one try, as their inverses: little first, then more.
const SHARES: [u64; 3] = [1000, 100, 10];
/// A try with less work than this says little.
const LEAST_WORK: u64 = 1_000_000;

/// What is done so far.
pub(super) struct Course {
    /// In products of residues.
    pub work: Cell<u64>,
    /// The way that led to a basis first.
    pub way: Cell<Option<Way>>,
}

/// Why a round has no answer.
pub(super) enum NoRound {
    /// More work may have one, or another way.
    Stopped(String),
    /// This way takes too much room, however much work is done.
    TooLarge(String),
    /// No way has one.
    Failed(String),
}

/// The fibre through one random point.
///
/// # Errors
/// In words, where all ways are too much work.
pub(super) fn round(
    model: &Model,
    orders: &Orders,
    question: &SolutionsQuestion,
    course: &Course,
    rng: &mut ChaCha8Rng,
) -> Result<Round, String> {
    by_ways(orders, question, course, |orders, way| {
        let begin = course.work.get();
        let fibre = random_fibre(model, orders, (None, Held::AtThePoint), rng)?;
        let round = analysed(model, fibre, question, course, way, rng)?;
        Ok(Round { work: course.work.get() - begin, ..round })
    })
}

/// What one way after the other finds, with more and more work for each; the one that led to something first is the way from then on. A try
/// is given the orders and the way with the end of its work.
///
/// # Errors
/// In words, where all ways are too much work.
pub(super) fn by_ways<T>(
    orders: &Orders,
    question: &SolutionsQuestion,
    course: &Course,
    mut attempt: impl FnMut(&Orders, (Way, u64)) -> Result<T, NoRound>,
) -> Result<T, String> {
    let tries: Vec<(Way, u64)> = match course.way.get() {
        Some(way) => vec![(way, 1)],
        None => {
            let later = SHARES.into_iter().flat_map(|share| WAYS.map(|way| (way, share)));
            std::iter::once((FIRST, SHARES[0])).chain(later).collect()
        }
    };
    let (mut stopped, mut too_large) = (String::new(), Vec::new());
    for (way, share) in tries {
        if too_large.contains(&way) {
            continue;
        }
        let end = (course.work.get() + (question.work / share).max(LEAST_WORK)).min(question.work);
        stopped = match attempt(&orders.and_further(way.further), (way, end)) {
            Ok(found) => {
                course.way.set(Some(way));
                return Ok(found);
            }
            Err(NoRound::Failed(why)) => return Err(why),
            Err(_) if question.interrupt.load(Ordering::Relaxed) => {
                return Err("it was cut off".to_owned());
            }
            Err(NoRound::Stopped(why)) if course.work.get() > question.work => {
                return Err(format!("{why}: more than {:e} products", question.work));
            }
            Err(NoRound::Stopped(why)) => why,
            Err(NoRound::TooLarge(why)) => {
                too_large.push(way);
                why
            }
        };
    }
    Err(stopped)
}

/// A random point that is no pole, and its fibre, modulo a prime that is given or drawn.
pub(super) fn random_fibre(
    model: &Model,
    orders: &Orders,
    (field, held): (Option<PrimeField>, Held),
    rng: &mut ChaCha8Rng,
) -> Result<Fibre, NoRound> {
    for _ in 0..ATTEMPTS {
        let field = field.unwrap_or_else(|| PrimeField::random(rng));
        match Fibre::new(model, orders, field, &mut Source { rng, given: HashMap::new() }, held) {
            Ok(fibre) => return Ok(fibre),
            Err(Trouble::Pole) => {}
            Err(Trouble::TooLarge(why)) => return Err(NoRound::TooLarge(why)),
        }
    }
    Err(NoRound::Failed(format!("{ATTEMPTS} random points were singularities")))
}

/// An error that should never occur.
const ASTRAY: &str = "a random point does not lie on its own fibre";

/// A polynomial in the variables of an algebra: of each term the powers of variables, by their places, and the coefficient.
pub(super) type Element = Vec<(Vec<(usize, u16)>, u64)>;

/// The functions on the points of a fibre: what was solved, and the algebra of what remains.
pub(super) struct Functions {
    solved: Solved,
    place: HashMap<u32, usize>,
    pub algebra: Algebra,
}

impl Functions {
    /// The algebra of a fibre, one way.
    ///
    /// # Errors
    /// Where this way takes too much, or no way has one.
    pub fn of(
        model: &Model,
        field: PrimeField,
        equations: Vec<Jet>,
        question: &SolutionsQuestion,
        work: &Cell<u64>,
        (way, end): (Way, u64),
    ) -> Result<Functions, NoRound> {
        let is_over = || question.interrupt.load(Ordering::Relaxed) || work.get() > end;
        let highest_degree = match way.form {
            Form::Short => u32::MAX,
            Form::Graded => 1,
        };
        // the equations were differentiated, and evaluated at the point
        work.set(work.get() + 2 * TERM * terms(&equations));
        let solved = Solved::new(&field, equations, highest_degree, work, &is_over);
        let variables = solved.variables();
        // derivatives of high order are the greatest
        let place: HashMap<u32, usize> = variables.iter().rev().copied().zip(0..).collect();
        let basis = basis_of(model, &solved, &place, field, way, work, &is_over)?;
        let algebra = Algebra::new(basis, MOST_POINTS).map_err(|why| match why {
            NoAlgebra::Infinite => NoRound::Failed("the fibre of a random point is not finite".to_owned()),
            NoAlgebra::MoreThan(most) => {
                NoRound::Failed(format!("more than {most} states and constants give the same outputs"))
            }
        })?;
        Ok(Functions { solved, place, algebra })
    }

    /// A variable in the variables of the algebra.
    pub fn express(&self, field: &PrimeField, variable: u32) -> Jet {
        self.solved.express(field, variable)
    }

    /// A polynomial in the variables of the algebra.
    ///
    /// # Errors
    /// Where a variable has any value.
    pub fn element(&self, jet: Jet) -> Result<Element, NoRound> {
        let mut polynomial = Vec::new();
        for (monomial, coefficient) in &jet.terms {
            let powers: Option<Vec<(usize, u16)>> =
                monomial.iter().map(|(variable, power)| Some((*self.place.get(variable)?, *power))).collect();
            let powers = powers.ok_or_else(|| {
                NoRound::Failed("the fibre of a random point leaves an unknown open".to_owned())
            })?;
            polynomial.push((powers, *coefficient));
        }
        Ok(polynomial)
    }
}

/// The points of a fibre, and the minimal polynomials of what is asked.
pub(super) fn analysed(
    model: &Model,
    fibre: Fibre,
    question: &SolutionsQuestion,
    course: &Course,
    way: (Way, u64),
    rng: &mut ChaCha8Rng,
) -> Result<Round, NoRound> {
    let field = fibre.field;
    let mut functions = Functions::of(model, field, fibre.equations, question, &course.work, way)?;
    if functions.algebra.dimension() == 0 {
        return Err(NoRound::Failed(ASTRAY.to_owned()));
    }
    let minimal = |functions: &mut Functions, jet: Jet| -> Result<Vec<u64>, NoRound> {
        let polynomial = functions.element(jet)?;
        if polynomial.iter().all(|(powers, _)| powers.is_empty()) {
            let value = polynomial.first().map_or(0, |(_, value)| *value);
            return Ok(vec![if value == 0 { 0 } else { field.modulus() - value }, field.one()]);
        }
        Ok(functions.algebra.minimal_polynomial(&polynomial))
    };
    let mut polynomials = Vec::new();
    for of_it in &fibre.unknowns {
        // of an angle a combination of its cosine and its sine that distinguishes any two of finitely many points
        let (mut jet, mut own) = (Jet::default(), 0);
        for variable in of_it {
            let factor = if of_it.len() > 1 { field.draw(rng) } else { field.one() };
            jet.add_multiple(&field, &functions.express(&field, *variable), factor);
            own = field.sum(own, field.product(factor, fibre.values[variable]));
        }
        polynomials.push((minimal(&mut functions, jet)?, own));
    }
    for variable in &fibre.asked {
        let jet = functions.express(&field, *variable);
        polynomials.push((minimal(&mut functions, jet)?, fibre.values[variable]));
    }
    // the point lies on its own fibre: its values are roots
    for (polynomial, own) in &polynomials {
        let value = polynomial.iter().rev().fold(0, |sum, c| field.sum(field.product(sum, *own), *c));
        if value != 0 {
            return Err(NoRound::Failed(ASTRAY.to_owned()));
        }
    }
    let polynomials: Vec<Vec<u64>> = polynomials.into_iter().map(|(polynomial, _)| polynomial).collect();
    let values = polynomials.iter().map(|polynomial| distinct_roots(&field, polynomial)).collect();
    Ok(Round { points: functions.algebra.dimension(), values, polynomials, work: 0 })
}

/// The basis, one way.
fn basis_of(
    model: &Model,
    solved: &Solved,
    place: &HashMap<u32, usize>,
    field: PrimeField,
    way: Way,
    work: &Cell<u64>,
    is_over: &dyn Fn() -> bool,
) -> Result<Basis, NoRound> {
    let limits =
        Limits { columns: MOST_COLUMNS, entries: MOST_ENTRIES, degree: HIGHEST_DEGREE, work, is_over };
    let mut monomials = Monomials::new(weights(model, place, way.form));
    let rows = solved.equations.iter().map(|equation| row(equation, place, &mut monomials)).collect();
    Basis::of(field, monomials, rows, &limits).map_err(|stop| {
        let sizes = format!("{} equations in {} variables", solved.equations.len(), place.len());
        let larger = |what: String| NoRound::TooLarge(format!("the Groebner basis of {sizes} needs {what}"));
        match stop {
            Stop::TimeIsUp => NoRound::Stopped(format!("the Groebner basis of {sizes} takes too long")),
            Stop::TooWide(columns) => larger(format!("a matrix of {columns} columns and more")),
            Stop::TooFull(entries) => larger(format!("a matrix of {entries} entries and more")),
            Stop::DegreeTooHigh(degree) => larger(format!("polynomials of degree {degree}")),
        }
    })
}

/// The weights of variables, by their places among the monomials: what a variable counts in the degree by which a basis is sorted.
fn weights(model: &Model, place: &HashMap<u32, usize>, form: Form) -> Vec<u32> {
    let mut weights = vec![1; place.len()];
    if form == Form::Short {
        return weights;
    }
    let stride = Numbering { variables: model.variables.len(), asked: model.asked.len() }.stride();
    let levels = levels(model);
    let most = levels.iter().copied().max().unwrap_or(0);
    for (variable, place) in place {
        let variable = (variable % stride) as usize;
        weights[*place] = match model.variables.get(variable).map(|variable| &variable.motion) {
            // the inverse of a denominator, or an expression that is asked for
            None => most + 2,
            Some(Motion::Rests) => 1,
            Some(_) => 2 * (levels[variable] + 1),
        };
    }
    weights
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
