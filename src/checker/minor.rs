//! A certified rank, by a minor that is not zero and by a kernel that all rows annihilate.

use super::doubt::{Doubt, Effort, Finding};
use super::evaluation::Evaluation;
use super::exact::{Exact, Form};
use super::listing::Listing;
use super::state::{ExactState, Ratio};
use super::witness::{Requirement, holds};
use crate::number::{Arithmetic, Enclosure, Rationals, Refusal};
use dashu::rational::RBig;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};

/// Elimination of rational entries stops where they become longer.
const NUMBERS: Rationals = Rationals { bits: 1 << 15 };
/// No matrix has more columns.
const MOST_COLUMNS: usize = 256;

/// Rows and columns of a matrix, counted from zero.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Minor {
    pub rows: Vec<usize>,
    pub columns: Vec<usize>,
}

/// The rank at one state, and what shows it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RankedState {
    pub state: ExactState,
    pub rank: usize,
    /// As many rows and columns as the rank, whose determinant is not zero.
    pub minor: Minor,
    /// A basis of the vectors that all rows annihilate: as many as the rank falls short of the number of columns.
    pub kernel: Vec<Vec<Ratio>>,
}

/// The rank of some rows at some states.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertifiedRank {
    pub listing: Listing,
    /// What the columns stand for: the names of the states.
    pub columns: Vec<String>,
    /// What the rows stand for: the differentials of these words.
    pub words: Vec<String>,
    /// The entries, as places of the listing; a row for each word.
    pub rows: Vec<Vec<usize>>,
    /// Where the rows exist.
    pub requirements: Vec<Requirement>,
    pub states: Vec<RankedState>,
}

impl CertifiedRank {
    /// Checks the rank at every state.
    pub fn check(&self, effort: &Effort, interrupt: &AtomicBool) -> Finding {
        let ragged = self.rows.len() != self.words.len()
            || self.rows.iter().any(|row| row.len() != self.columns.len())
            || self.columns.is_empty()
            || self.columns.len() > MOST_COLUMNS;
        if ragged || self.states.is_empty() {
            return Finding::NotConfirmed(if ragged { Doubt::Ragged } else { Doubt::Empty });
        }
        let check = |(index, state): (usize, &RankedState)| match interrupt.load(Ordering::Relaxed) {
            true => Some(Doubt::Interrupted),
            false => self.check_state(index, state, effort).err().map(|doubt| doubt.at_state(index)),
        };
        match self.states.par_iter().enumerate().find_map_first(check) {
            Some(doubt) => Finding::NotConfirmed(doubt),
            None => Finding::Confirmed { times: self.states.len() },
        }
    }

    fn check_state(&self, state: usize, found: &RankedState, effort: &Effort) -> Result<(), Doubt> {
        let (rank, width) = (found.rank, self.columns.len());
        let different = |places: &[usize], below: usize| {
            let distinct: BTreeSet<usize> = places.iter().copied().filter(|place| *place < below).collect();
            places.len() == rank && distinct.len() == rank
        };
        if !different(&found.minor.rows, self.rows.len()) || !different(&found.minor.columns, width) {
            return Err(Doubt::NoMinor { state, rank });
        }
        let wanted = width - rank;
        if found.kernel.len() != wanted || found.kernel.iter().any(|vector| vector.len() != width) {
            return Err(Doubt::KernelSize { state, found: found.kernel.len(), wanted });
        }
        let values = Evaluation::new(&self.listing, &found.state, effort)?;
        holds(&values, &[], &self.requirements)?;
        self.minor_differs_from_zero(state, &found.minor, &values, effort)?;
        let kernel = &found.kernel;
        let square: Vec<Vec<RBig>> =
            kernel.iter().map(|vector| vector.iter().map(|part| part.0.clone()).collect()).collect();
        effort.spend((wanted * wanted * width) as u64)?;
        if !has_full_rank(&NUMBERS, square).map_err(|_| Doubt::KernelDependent(state))? {
            return Err(Doubt::KernelDependent(state));
        }
        for (row, entries) in self.rows.iter().enumerate() {
            for (vector, direction) in kernel.iter().enumerate() {
                effort.spend(width as u64)?;
                match annihilates(&values, entries, direction)? {
                    Some(true) => {}
                    Some(false) => return Err(Doubt::NotAnnihilated { state, row, vector }),
                    None => return Err(Doubt::NotShownAnnihilated { state, row, vector }),
                }
            }
        }
        Ok(())
    }

    /// Whether a minor is not zero: exactly where its entries are rational, else by enclosures.
    fn minor_differs_from_zero(
        &self,
        state: usize,
        minor: &Minor,
        values: &Evaluation<'_>,
        effort: &Effort,
    ) -> Result<(), Doubt> {
        let places: Vec<Vec<usize>> = minor
            .rows
            .iter()
            .map(|row| minor.columns.iter().map(|column| self.rows[*row][*column]).collect())
            .collect();
        let work = (places.len() as u64).pow(3);
        effort.spend(work)?;
        let rational = |place: &usize| values.rational(*place).cloned();
        let exact: Option<Vec<Vec<RBig>>> =
            places.iter().map(|row| row.iter().map(rational).collect()).collect();
        // fractions may grow too long to be eliminated; enclosures then still may tell
        if let Some(full) = exact.and_then(|rows| has_full_rank(&NUMBERS, rows).ok()) {
            return if full { Ok(()) } else { Err(Doubt::MinorVanishes(state)) };
        }
        let told = values.climb(|precision| {
            let bits = super::evaluation::PRECISIONS[precision];
            effort.spend(work * bits as u64 / 8)?;
            let rows: Vec<Vec<Enclosure>> = places
                .iter()
                .map(|row| row.iter().map(|place| values.enclosed(*place, precision).cloned()).collect())
                .collect::<Result<_, _>>()?;
            let full = has_full_rank(&crate::number::Enclosures::new(bits), rows);
            Ok(full.ok().filter(|full| *full))
        })?;
        if told == Some(true) { Ok(()) } else { Err(Doubt::MinorNotTold(state)) }
    }
}

/// Whether the rows of a matrix, no more than its columns, are independent, by elimination that takes a pivot only where
/// it is certainly not zero. Over numbers that are always told from zero a *no* is certain; over others only a *yes* is.
fn has_full_rank<A: Arithmetic>(arithmetic: &A, mut rows: Vec<Vec<A::Number>>) -> Result<bool, Refusal> {
    for step in 0..rows.len() {
        // the columns may be taken in any order: the first entry of the row that is not zero
        let mut pivot = None;
        for at in step..rows.len() {
            let nonzero = |entry: &A::Number| arithmetic.is_zero(entry) == Some(false);
            if let Some(column) = rows[at].iter().position(nonzero) {
                pivot = Some((at, column));
                break;
            }
        }
        let Some((at, column)) = pivot else { return Ok(false) };
        rows.swap(step, at);
        let (above, below) = rows.split_at_mut(step + 1);
        let Some(top) = above.last_mut() else { return Ok(false) };
        let top: &Vec<A::Number> = top;
        let pivot = top[column].clone();
        for row in below {
            if arithmetic.is_zero(&row[column]) == Some(true) {
                continue;
            }
            let factor = arithmetic.div(&row[column], &pivot)?;
            for (index, (entry, above)) in row.iter_mut().zip(top).enumerate() {
                *entry = if index == column {
                    // what elimination makes zero is zero, however wide its enclosure
                    arithmetic.rational(&RBig::ZERO)?
                } else {
                    arithmetic.sub(entry, &arithmetic.mul(&factor, above)?)?
                };
            }
        }
    }
    Ok(true)
}

/// Whether the product of a row and a vector is zero; `None` where that is not told.
fn annihilates(
    values: &Evaluation<'_>,
    entries: &[usize],
    direction: &[Ratio],
) -> Result<Option<bool>, Doubt> {
    let exact = Exact::new(Vec::new());
    let mut sum = Form::default();
    for (entry, part) in entries.iter().zip(direction) {
        // entries beside a zero have to exist too
        let product = exact.mul(values.exact(*entry)?, &Form::from(part.0.clone()));
        match product.and_then(|product| exact.add(&sum, &product)) {
            Ok(total) => sum = total,
            Err(_) => return Ok(None),
        }
    }
    Ok(exact.is_zero(&sum))
}
