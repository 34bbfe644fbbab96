//! A set of states that is divided until its equations are met: they are solved one after the other, and
//! where that divides by something that may vanish, both cases are followed.
//!
//! Every step is a cover: the states of a case are those of the cases that it is split into. So what is true of all the last
//! cases is true of all states, whichever way was taken; that nothing was forgotten does not depend on any choice here.

use super::algebra::{Algebra, Chart, Reach, Solved, TOO_LONG, normal};
use super::factors::{
    MOST_TERMS, coefficient, derivative, factors, places, pseudo_remainder, real_zeros, semidefinite,
};
use dashu::base::Sign;
use dashu::integer::IBig;
use palmistry_lang::Assignment;
use palmistry_math::number::polynomial::{Polynomial, Ring};
use std::collections::VecDeque;

/// An equation that was not solved: a polynomial of degree two or more in the variable at a place, whose leading coefficient
/// does not vanish.
#[derive(Clone, Debug)]
pub(super) struct Relation {
    pub polynomial: Polynomial,
    pub place: usize,
}

/// An equation that is still to be met, left side only.
#[derive(Clone, Debug)]
struct Pending {
    polynomial: Polynomial,
    /// Whether it is known that its derivatives vanish, too.
    touched: bool,
}

/// A set of states: all equations hold, and what is said not to vanish does not.
#[derive(Clone, Debug, Default)]
pub(super) struct Case {
    pub chart: Chart,
    /// Solved symbols of the chart; no value mentions a solved symbol.
    pub values: Assignment,
    pub relations: Vec<Relation>,
    pending: VecDeque<Pending>,
    /// Primitive, as far as they are factored.
    pub nonzero: Vec<Polynomial>,
    pub positive: Vec<Polynomial>,
    /// What is not negative, as far as it did not become too long: a case may be larger than the set that it stands for.
    pub not_negative: Vec<Polynomial>,
    /// The equations that were met on the way, in the symbols that were left at the time.
    pub equations: Vec<Polynomial>,
    /// What was divided by, and may vanish elsewhere.
    pub divisors: Vec<Polynomial>,
}

/// What one step makes of a case.
pub(super) enum Step {
    /// It has no states.
    Empty,
    /// It is the union of these.
    Split(Vec<Case>),
    /// All equations are met.
    Ready(Box<Case>),
}

impl Case {
    /// All states of a chart.
    pub fn of(chart: &Chart) -> Case {
        Case { chart: chart.clone(), ..Case::default() }
    }

    /// The same with an equation more.
    pub fn with_zero(&self, polynomial: &Polynomial) -> Case {
        let mut next = self.clone();
        next.pending.push_back(Pending { polynomial: normal(polynomial), touched: false });
        next
    }

    /// Whether all of its equations are met by its values and relations.
    pub fn is_met(&self) -> bool {
        self.pending.is_empty()
    }

    /// Notes that something does not vanish. Whether that is possible is checked by [`Case::step`].
    pub fn add_nonzero(&mut self, polynomial: &Polynomial) {
        if polynomial.is_zero() {
            self.nonzero.push(Polynomial::default());
            return;
        }
        for (factor, _) in factors(polynomial, &self.nonzero) {
            if !self.nonzero.contains(&factor) {
                self.nonzero.push(factor);
            }
        }
    }

    /// Notes that something is positive.
    pub fn add_positive(&mut self, polynomial: &Polynomial) {
        self.add_nonzero(polynomial);
        self.positive.push(polynomial.clone());
    }

    /// The same with what is positive everywhere.
    pub fn knowing(mut self, algebra: &Algebra<'_>) -> Case {
        for variable in algebra.positive_variables() {
            if !self.positive.contains(&variable) {
                self.add_positive(&variable);
            }
        }
        self
    }

    /// The factors of a polynomial that may vanish here.
    pub fn doubtful(&self, polynomial: &Polynomial) -> Vec<Polynomial> {
        let found = factors(polynomial, &self.nonzero).into_iter().map(|(factor, _)| factor);
        found.filter(|factor| !self.nonzero.contains(factor) && !never_zero(factor)).collect()
    }

    /// Cases in which one of some factors vanishes, each of them first where those before it do not.
    pub fn where_one_vanishes(&self, factors: &[Polynomial], also: &[Polynomial]) -> Vec<Case> {
        let mut found = Vec::new();
        for (index, factor) in factors.iter().enumerate() {
            let mut next = self.clone();
            factors[..index].iter().for_each(|other| next.add_nonzero(other));
            for polynomial in also.iter().rev().chain([factor]) {
                next.pending.push_front(Pending { polynomial: polynomial.clone(), touched: false });
            }
            found.push(next);
        }
        found
    }

    /// Whether a place is that of a variable that is known to be positive.
    fn is_positive(&self, place: usize) -> bool {
        self.positive.contains(&Polynomial::variable(place))
    }

    /// A polynomial with all relations used.
    pub fn reduced(&self, polynomial: &Polynomial) -> Reach<Polynomial> {
        let mut rest = polynomial.clone();
        for _ in 0..MOST_ROUNDS {
            let mut changed = false;
            for relation in &self.relations {
                if rest.degree_in(relation.place) >= relation.polynomial.degree_in(relation.place) {
                    rest = pseudo_remainder(&rest, &relation.polynomial, relation.place).ok_or(TOO_LONG)?;
                    changed = true;
                }
            }
            if !changed {
                return Ok(rest);
            }
        }
        Ok(rest)
    }

    /// Whether what is known of the case contradicts itself, as far as that can be read off.
    fn contradicts_itself(&self) -> Reach<bool> {
        for factor in &self.nonzero {
            if factor.is_zero() || !self.relations.is_empty() && self.reduced(factor)?.is_zero() {
                return Ok(true);
            }
        }
        let impossible = |positive: &Polynomial| {
            semidefinite(&positive.neg(), &|place| self.is_positive(place)) == Some(Sign::Positive)
                || self.positive.contains(&positive.neg())
        };
        let negative = |value: &Polynomial| {
            semidefinite(&value.neg(), &|place| self.is_positive(place)) == Some(Sign::Positive)
                && !value.is_zero()
                && self.doubtful(value).is_empty()
        };
        Ok(self.positive.iter().any(impossible) || self.not_negative.iter().any(negative))
    }

    /// The cases that it is the union of, with all equations met; those that are found empty are left out.
    ///
    /// # Errors
    /// Where an equation is out of reach, or they are too many.
    pub fn all_ready(self, algebra: &mut Algebra<'_>) -> Reach<Vec<Case>> {
        let (mut open, mut found) = (vec![self], Vec::new());
        for _ in 0..MOST_STEPS {
            let Some(case) = open.pop() else { return Ok(found) };
            match case.step(algebra)? {
                Step::Empty => {}
                Step::Split(cases) => open.extend(cases),
                Step::Ready(case) => found.push(*case),
            }
        }
        Err(TOO_LONG.to_owned())
    }

    /// Meets one more equation.
    pub fn step(self, algebra: &mut Algebra<'_>) -> Reach<Step> {
        self.knowing(algebra).next(algebra)
    }

    fn next(mut self, algebra: &mut Algebra<'_>) -> Reach<Step> {
        if self.contradicts_itself()? {
            return Ok(Step::Empty);
        }
        // what is short is solved first
        let shortest = (0..self.pending.len()).min_by_key(|at| {
            let pending = &self.pending[*at];
            (pending.touched, pending.polynomial.len(), pending.polynomial.degree(), *at)
        });
        let Some(Pending { polynomial, touched }) = shortest.and_then(|at| self.pending.remove(at)) else {
            return Ok(Step::Ready(Box::new(self)));
        };
        let polynomial = self.reduced(&polynomial)?;
        if polynomial.is_zero() {
            return Ok(Step::Split(vec![self]));
        }
        let doubtful = self.doubtful(&polynomial);
        match doubtful.as_slice() {
            [] => Ok(Step::Empty),
            [factor] => self.solve(algebra, factor, touched),
            several => Ok(Step::Split(self.where_one_vanishes(several, &[]))),
        }
    }

    /// Solves an equation whose left side has one factor.
    fn solve(mut self, algebra: &mut Algebra<'_>, factor: &Polynomial, touched: bool) -> Reach<Step> {
        if real_zeros(factor) == Some(0) {
            return Ok(Step::Empty);
        }
        // linear in a symbol: that which asks for the fewest cases, then the shortest
        let mut best: Option<((usize, usize), usize, Vec<Polynomial>)> = None;
        for place in places(factor).into_iter().filter(|place| factor.degree_in(*place) == 1) {
            if algebra.hides(factor, place) {
                continue;
            }
            let slope = coefficient(factor, place, 1);
            let doubtful = self.doubtful(&slope);
            let key = (doubtful.len(), slope.len() + factor.len());
            if best.as_ref().is_none_or(|(least, ..)| key < *least) {
                best = Some((key, place, doubtful));
            }
        }
        let sign = if touched { None } else { semidefinite(factor, &|place| self.is_positive(place)) };
        match best {
            Some((_, place, doubtful)) if doubtful.is_empty() => {
                Ok(Step::Split(vec![self.with_value(algebra, factor, place)?]))
            }
            _ if sign.is_some() => {
                // it vanishes where it is least, or greatest
                for place in places(factor) {
                    let polynomial = derivative(factor, place);
                    self.pending.push_front(Pending { polynomial, touched: false });
                }
                self.pending.push_back(Pending { polynomial: factor.clone(), touched: true });
                Ok(Step::Split(vec![self]))
            }
            Some((_, _, doubtful)) => {
                // where what would be divided by vanishes, and where it does not
                let mut cases = self.where_one_vanishes(&doubtful, std::slice::from_ref(factor));
                let mut main = self;
                for divisor in &doubtful {
                    main.add_nonzero(divisor);
                    main.divisors.push(divisor.clone());
                }
                main.pending.push_front(Pending { polynomial: factor.clone(), touched });
                cases.insert(0, main);
                Ok(Step::Split(cases))
            }
            None => self.relate(factor, touched),
        }
    }

    /// Keeps an equation that cannot be solved.
    fn relate(mut self, factor: &Polynomial, touched: bool) -> Reach<Step> {
        if factor.len() > LONGEST_RELATION || factor.degree() > HIGHEST_RELATION {
            return Err(TOO_LONG.to_owned());
        }
        let place = places(factor)
            .into_iter()
            .min_by_key(|place| {
                let lead = coefficient(factor, *place, factor.degree_in(*place));
                (self.doubtful(&lead).len(), factor.degree_in(*place), lead.len())
            })
            .ok_or(TOO_LONG)?;
        let degree = factor.degree_in(place);
        let doubtful = self.doubtful(&coefficient(factor, place, degree));
        if !doubtful.is_empty() {
            let mut cases = self.where_one_vanishes(&doubtful, std::slice::from_ref(factor));
            let mut main = self;
            for divisor in &doubtful {
                main.add_nonzero(divisor);
                main.divisors.push(divisor.clone());
            }
            main.pending.push_front(Pending { polynomial: factor.clone(), touched });
            cases.insert(0, main);
            return Ok(Step::Split(cases));
        }
        // those of a higher degree in the same variable are reduced by it
        let (higher, kept): (Vec<_>, Vec<_>) = std::mem::take(&mut self.relations)
            .into_iter()
            .partition(|relation| relation.polynomial.degree_in(place) >= degree);
        self.relations = kept;
        for Relation { polynomial, .. } in higher {
            self.pending.push_back(Pending { polynomial, touched: false });
        }
        self.equations.push(factor.clone());
        self.relations.push(Relation { polynomial: factor.clone(), place });
        Ok(Step::Split(vec![self]))
    }

    /// The case with `slope x + rest = 0` solved for a symbol, whose slope does not vanish.
    fn with_value(mut self, algebra: &mut Algebra<'_>, factor: &Polynomial, place: usize) -> Reach<Case> {
        let symbol = algebra.symbol_at(place).ok_or(TOO_LONG)?;
        let (top, bottom) = (coefficient(factor, place, 0), coefficient(factor, place, 1));
        let value = {
            let (above, below) = (algebra.exactly(&top), algebra.exactly(&bottom));
            let quotient = algebra.system.graph.div(above, below);
            algebra.system.graph.neg(quotient)
        };
        let solved = Solved { symbol, place, top, bottom, value };
        let single = Assignment::from([(symbol, value)]);
        for known in self.values.values_mut() {
            *known = algebra.system.graph.substitute(&[*known], &single)[0];
        }
        self.values.insert(symbol, value);
        self.equations.push(factor.clone());
        let mut pending = VecDeque::new();
        for Pending { polynomial, .. } in std::mem::take(&mut self.pending) {
            let polynomial = normal(&algebra.put_in(&polynomial, &solved)?);
            pending.push_back(Pending { polynomial, touched: false });
        }
        for relation in std::mem::take(&mut self.relations) {
            let polynomial = normal(&algebra.put_in(&relation.polynomial, &solved)?);
            if polynomial == relation.polynomial {
                self.relations.push(relation);
            } else {
                pending.push_back(Pending { polynomial, touched: false });
            }
        }
        self.pending = pending;
        for factor in std::mem::take(&mut self.nonzero) {
            let there = algebra.put_in(&factor, &solved)?;
            if there.len() > MOST_TERMS {
                return Err(TOO_LONG.to_owned());
            }
            self.add_nonzero(&there);
        }
        for polynomial in std::mem::take(&mut self.positive) {
            let there = algebra.put_in(&polynomial, &solved)?;
            self.positive.push(there);
        }
        for polynomial in std::mem::take(&mut self.not_negative) {
            self.not_negative.extend(algebra.put_in(&polynomial, &solved).ok());
        }
        Ok(self)
    }
}

/// Equations that cannot be solved are calculated with up to this length and this total degree.
const LONGEST_RELATION: usize = 60;
const HIGHEST_RELATION: u32 = 12;
/// A case is divided in at most so many steps where all of its parts are asked for at once.
const MOST_STEPS: usize = 60;
/// Relations are used in turn so often.
const MOST_ROUNDS: usize = 8;

/// Whether a polynomial is a sum of squares and a positive constant, or the opposite.
fn never_zero(polynomial: &Polynomial) -> bool {
    let mut signs = polynomial.terms().map(|(exponents, value)| {
        (exponents.iter().all(|power| power % 2 == 0), exponents.iter().all(|power| *power == 0), value)
    });
    let (mut constant, mut sign) = (false, None);
    signs.all(|(even, is_constant, value)| {
        constant |= is_constant;
        let here = *value < IBig::ZERO;
        even && *sign.get_or_insert(here) == here
    }) && constant
}
