//! The observability codistribution of a system, as forms whose coefficients are quotients: the least space of forms that holds the differentials of the outputs and with each form
//! its Lie derivatives along all fields (R. Hermann and A. J. Krener, *Nonlinear controllability and observability*, IEEE Trans. Automat. Control 22, 1977).
//!
//! Lie derivatives of outputs are not written down: each form is reduced by those before it, and derived as it is then. Once no Lie derivative of a form adds anything none of any order does.

use super::super::doubt::{Effort, Missing};
use super::conditions::{Equations, on_each_part};
use super::polynomial::IntegerPolynomial;
use super::span::{Echelon, RowPlaces, entries};
use super::{Atom, Normal, Quotient, Stop, Term};
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_math::number::Function;
use std::collections::BTreeMap;

/// One field, by the places of its components and of their differentials.
#[derive(Clone, Debug)]
pub struct MovingField {
    /// The symbols that it moves, and how.
    pub rates: Vec<(String, usize)>,
    /// The differential of the rate of each column, in the order of the columns.
    pub slopes: Vec<RowPlaces>,
    /// Those of the rates of symbols that are known.
    pub known_slopes: Vec<RowPlaces>,
}

/// A question about a system at almost all states at which conditions hold; no field leaves the set of these.
#[derive(Clone, Copy, Debug)]
pub struct Closed<'l> {
    /// The listing, the conditions and the requirements; no sides.
    pub states: Equations<'l>,
    /// The differentials of the outputs.
    pub outputs: &'l [RowPlaces],
    /// The fields.
    pub fields: &'l [MovingField],
    /// The rank, where it is asked.
    pub rank: Option<usize>,
    /// Differentials that lie in the codistribution.
    pub inside: &'l [RowPlaces],
    /// Differentials each of which does not.
    pub outside: &'l [RowPlaces],
}

/// Whether all that is asked holds at almost all states of each part of the set. `false` says nothing.
///
/// # Errors
/// Where it takes too much work, or an operation has no value.
pub fn closed(asked: Closed<'_>, effort: &Effort) -> Result<bool, Missing> {
    on_each_part(asked.states, effort, |normal, _| normal.is_closed(asked))
}

/// The rates of symbols along a field.
type Rates = BTreeMap<String, Quotient>;

/// The values of some rows.
type Rows = Vec<Vec<Quotient>>;

impl Normal<'_> {
    fn is_closed(&mut self, asked: Closed<'_>) -> Result<bool, Stop> {
        let mut wanted: Vec<usize> = [asked.outputs, asked.inside, asked.outside].concat().concat();
        for field in asked.fields {
            wanted.extend(field.rates.iter().map(|(_, place)| *place));
            wanted.extend(field.slopes.iter().chain(&field.known_slopes).flatten());
        }
        let mut values = BTreeMap::new();
        self.forms(asked.states.listing, &wanted, &mut values)?;
        let rows = |rows: &[RowPlaces]| -> Result<Rows, Missing> {
            rows.iter().map(|row| entries(row, &values)).collect()
        };
        let mut fields: Vec<(Rates, Rows)> = Vec::new();
        let mut known = Vec::new();
        for field in asked.fields {
            let rate = |(name, place): &(String, usize)| {
                Ok((name.clone(), values.get(place).cloned().ok_or(Missing::Place { place: *place })?))
            };
            let rates = field.rates.iter().map(rate).collect::<Result<Rates, Missing>>()?;
            fields.push((rates, rows(&field.slopes)?));
            known.extend(rows(&field.known_slopes)?);
        }
        let Some(width) = asked.fields.first().map(|field| field.slopes.len()) else { return Ok(false) };
        let mut echelon = Echelon::default();
        let mut open = rows(asked.outputs)?;
        while echelon.rows.len() < width && !open.is_empty() {
            // short forms first
            open.sort_by_cached_key(|row| {
                std::cmp::Reverse(row.iter().map(|entry| self.size(entry)).sum::<usize>())
            });
            let Some(row) = open.pop() else { break };
            let left = self.reduced(&echelon, row)?;
            if left.iter().all(Quotient::is_zero) {
                continue;
            }
            if asked.rank == Some(echelon.rows.len()) || !self.enter(&mut echelon, left)? {
                return Ok(false);
            }
            let Some((_, form)) = echelon.rows.last().cloned() else { return Ok(false) };
            if echelon.rows.len() == width {
                break;
            }
            for (rates, slopes) in &fields {
                let Some(derived) = self.derived(&form, rates, slopes)? else { return Ok(false) };
                open.push(derived);
            }
        }
        if asked.rank.is_some_and(|rank| rank != echelon.rows.len()) {
            return Ok(false);
        }
        for row in known.into_iter().chain(rows(asked.inside)?) {
            if !self.reduced(&echelon, row)?.iter().all(Quotient::is_zero) {
                return Ok(false);
            }
        }
        for row in rows(asked.outside)? {
            let left = self.reduced(&echelon, row)?;
            if !left.iter().any(|entry| !entry.is_zero() && self.is_free(entry)) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The Lie derivative of a form along a field: the derivatives of its coefficients, and the differentials of the rates.
    fn derived(
        &mut self,
        form: &[Quotient],
        rates: &Rates,
        slopes: &Rows,
    ) -> Result<Option<Vec<Quotient>>, Missing> {
        let mut derived = Vec::with_capacity(form.len());
        for (column, entry) in form.iter().enumerate() {
            let Some(own) = self.along(entry, rates)? else { return Ok(None) };
            let mut terms = vec![own];
            for (other, slopes) in form.iter().zip(slopes) {
                terms.push(self.field.times(other, &slopes[column])?);
            }
            derived.push(self.field.sum(&terms)?);
        }
        Ok(Some(derived))
    }

    /// The derivative of a quotient along a field: itself times the sum of those of its factors' logarithms. Nothing where a function takes part whose derivative is not known here.
    fn along(&mut self, quotient: &Quotient, rates: &Rates) -> Result<Option<Quotient>, Missing> {
        let mut terms = Vec::new();
        for (factor, power) in &quotient.powers {
            let factor = self.field.factor(*factor).clone();
            let Some(derived) = self.polynomial_along(&factor, rates)? else { return Ok(None) };
            let logarithm = self.over(&derived, &factor)?;
            let times = Quotient::from(RBig::from(*power));
            let term = self.field.times(&logarithm, &times)?;
            terms.push(self.field.times(quotient, &term)?);
        }
        Ok(Some(self.field.sum(&terms)?))
    }

    fn over(&mut self, above: &Quotient, below: &IntegerPolynomial) -> Result<Quotient, Missing> {
        let below = self.field.quotient(below.clone());
        let below = self.field.power(&below, -1)?.ok_or(Missing::Effort)?;
        self.field.times(above, &below)
    }

    fn polynomial_along(
        &mut self,
        polynomial: &IntegerPolynomial,
        rates: &Rates,
    ) -> Result<Option<Quotient>, Missing> {
        let mut terms = Vec::new();
        for variable in polynomial.variables() {
            let Some(rate) = self.variable_along(variable, rates)? else { return Ok(None) };
            if rate.is_zero() {
                continue;
            }
            let slope = self.field.quotient(polynomial.slope(variable));
            terms.push(self.field.times(&slope, &rate)?);
        }
        Ok(Some(self.field.sum(&terms)?))
    }

    fn variable_along(&mut self, variable: u32, rates: &Rates) -> Result<Option<Quotient>, Missing> {
        let zero = Quotient::from(RBig::ZERO);
        let own = self.field.quotient(IntegerPolynomial::variable(variable));
        let Some(atom) = self.atom_of(variable).cloned() else { return Ok(None) };
        Ok(match atom {
            Atom::Symbol(name) => Some(rates.get(&name).cloned().unwrap_or(zero)),
            Atom::Pi | Atom::Turns(_) => Some(zero),
            Atom::Sine(term) => self.turned_along(&term, &Atom::Cosine(term.clone()), rates, false)?,
            Atom::Cosine(term) => self.turned_along(&term, &Atom::Sine(term.clone()), rates, true)?,
            Atom::Exponential(term) => match self.term_along(&term, rates)? {
                Some(rate) => Some(self.field.times(&own, &rate)?),
                None => None,
            },
            Atom::Root(square, _) => match self.polynomial_along(&square, rates)? {
                // twice the root times its derivative is the derivative of the square
                Some(rate) => {
                    let twice = self.field.times(&own, &Quotient::from(RBig::from(2)))?;
                    let below = self.field.power(&twice, -1)?.ok_or(Missing::Effort)?;
                    Some(self.field.times(&rate, &below)?)
                }
                None => None,
            },
            Atom::Value(Function::Log, above, below) => {
                let above = self.field.quotient(above);
                let of = self.over(&above, &below)?;
                let Some(rate) = self.along(&of, rates)? else { return Ok(None) };
                let below = self.field.power(&of, -1)?.ok_or(Missing::Effort)?;
                Some(self.field.times(&rate, &below)?)
            }
            Atom::Value(..) => None,
        })
    }

    /// The derivative of a sine or a cosine by the other one.
    fn turned_along(
        &mut self,
        term: &Term,
        other: &Atom,
        rates: &Rates,
        is_negative: bool,
    ) -> Result<Option<Quotient>, Missing> {
        let Some(rate) = self.term_along(term, rates)? else { return Ok(None) };
        if rate.is_zero() {
            return Ok(Some(rate));
        }
        let Some(other) = self.known.get(other).copied() else { return Ok(None) };
        let other = self.field.quotient(IntegerPolynomial::variable(other));
        let product = self.field.times(&other, &rate)?;
        Ok(Some(if is_negative { product.neg() } else { product }))
    }

    /// The derivative of the part of a term that is taken as an angle.
    fn term_along(&mut self, term: &Term, rates: &Rates) -> Result<Option<Quotient>, Missing> {
        let above = self.field.quotient(IntegerPolynomial::term(term.0.clone(), IBig::ONE));
        let whole = self.over(&above, &term.1)?;
        let divisor = self.divisors.get(term).copied().unwrap_or(1);
        let part = self.field.times(&whole, &Quotient::from(RBig::ONE / RBig::from(divisor)))?;
        self.along(&part, rates)
    }
}
