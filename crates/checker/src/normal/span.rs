//! Ranks of matrices of expressions, by elimination among quotients: generic ones, on each part of the set on which conditions hold.

use super::super::doubt::{Effort, Missing};
use super::conditions::{Equations, on_each_part};
use super::{Atom, Normal, Quotient, Stop};
use std::collections::BTreeMap;

/// A row by the places of its entries.
pub type RowPlaces = Vec<usize>;

/// What is asked of rows at almost all states at which conditions hold.
#[derive(Clone, Copy, Debug)]
pub struct Spans<'l> {
    /// The listing, the conditions and the requirements; no sides.
    pub states: Equations<'l>,
    /// Rows whose rank is asked.
    pub rows: &'l [RowPlaces],
    /// The rank that they have to have.
    pub rank: usize,
}

/// Whether all that is asked holds at almost all states of each part of the set. `false` says nothing.
///
/// # Errors
/// Where it takes too much work, or an operation has no value.
pub fn span(asked: Spans<'_>, effort: &Effort) -> Result<bool, Missing> {
    on_each_part(asked.states, effort, |normal, _| normal.spans(asked))
}

pub(super) fn entries(row: &RowPlaces, values: &BTreeMap<usize, Quotient>) -> Result<Vec<Quotient>, Missing> {
    row.iter().map(|place| values.get(place).cloned().ok_or(Missing::Place { place: *place })).collect()
}

/// Rows in echelon form: each has a one in a column of its own, where all others have a zero.
#[derive(Default)]
pub(super) struct Echelon {
    pub rows: Vec<(usize, Vec<Quotient>)>,
}

impl Normal<'_> {
    fn spans(&mut self, asked: Spans<'_>) -> Result<bool, Stop> {
        let wanted = asked.rows.concat();
        let mut values = BTreeMap::new();
        // what has no value here has none at any state of this part, and no rank is claimed
        self.forms(asked.states.listing, &wanted, &mut values)?;
        let mut echelon = Echelon::default();
        for row in asked.rows {
            let left = self.reduced(&echelon, entries(row, &values)?)?;
            if left.iter().all(Quotient::is_zero) {
                continue;
            }
            if echelon.rows.len() == asked.rank || !self.enter(&mut echelon, left)? {
                return Ok(false);
            }
        }
        Ok(echelon.rows.len() == asked.rank)
    }

    /// The rest of a row when multiples of those in echelon form are subtracted.
    pub(super) fn reduced(
        &mut self,
        echelon: &Echelon,
        row: Vec<Quotient>,
    ) -> Result<Vec<Quotient>, Missing> {
        let mut left = Vec::with_capacity(row.len());
        for column in 0..row.len() {
            if echelon.rows.iter().any(|(pivot, _)| *pivot == column) {
                left.push(Quotient::from(dashu::rational::RBig::ZERO));
                continue;
            }
            let mut terms = vec![row[column].clone()];
            for (pivot, other) in &echelon.rows {
                terms.push(self.field.times(&row[*pivot], &other[column])?.neg());
            }
            left.push(self.field.sum(&terms)?);
        }
        Ok(left)
    }

    /// Takes a row that is not zero into an echelon form; `false` where none of its entries is certainly not zero at almost all states.
    pub(super) fn enter(&mut self, echelon: &mut Echelon, row: Vec<Quotient>) -> Result<bool, Missing> {
        let free = (0..row.len()).filter(|column| !row[*column].is_zero() && self.is_free(&row[*column]));
        let Some(pivot) = free.min_by_key(|column| self.size(&row[*column])) else { return Ok(false) };
        let below = self.field.power(&row[pivot], -1)?.ok_or(Missing::Effort)?;
        let row: Vec<Quotient> =
            row.iter().map(|entry| self.field.times(entry, &below)).collect::<Result<_, _>>()?;
        for (_, other) in &mut echelon.rows {
            let by = other[pivot].neg();
            if by.is_zero() {
                continue;
            }
            for column in 0..row.len() {
                let term = self.field.times(&by, &row[column])?;
                other[column] = self.field.sum(&[other[column].clone(), term])?;
            }
        }
        echelon.rows.push((pivot, row));
        Ok(true)
    }

    /// How long a quotient is: the terms of its factors, each as often as its power says.
    pub(super) fn size(&self, entry: &Quotient) -> usize {
        let of = |(factor, power): (&u32, &i32)| {
            self.field.factor(*factor).terms().len() * power.unsigned_abs() as usize
        };
        entry.powers.iter().map(of).sum()
    }

    /// Whether a quotient that is not zero is one of functions no two of which depend on each other algebraically, so that it is not zero at almost all states: symbols, and sines, cosines and exponentials of different
    /// products of symbols (J. Ax, *On Schanuel's conjectures*, Ann. of Math. 93, 1971).
    pub(super) fn is_free(&self, quotient: &Quotient) -> bool {
        // where an angle is one of some there is no open set of its values
        let is_held = |variable: u32| {
            let mut terms = self.part.angles.iter().map(|(term, _)| term);
            terms.any(|term| term.0.powers().iter().any(|(inner, _)| self.depends(*inner, variable)))
        };
        let is_symbol =
            |variable: u32| matches!(self.atom_of(variable), Some(Atom::Symbol(_))) && !is_held(variable);
        let is_free = |variable: u32| match self.atom_of(variable) {
            Some(Atom::Symbol(_)) => is_symbol(variable),
            Some(Atom::Sine(term) | Atom::Cosine(term) | Atom::Exponential(term)) => {
                let of = term.0.powers();
                !of.is_empty() && of.iter().all(|(inner, _)| is_symbol(*inner)) && term.1.number().is_some()
            }
            _ => false,
        };
        let factors = quotient.powers.keys().map(|factor| self.field.factor(*factor));
        factors
            .flat_map(|factor| factor.terms())
            .all(|(monomial, _)| monomial.powers().iter().all(|(variable, _)| is_free(*variable)))
    }
}
