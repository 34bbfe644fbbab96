//! A certified rank, by a minor that is not zero and by a kernel that all rows annihilate.

use super::doubt::{Doubt, Effort, Finding, Missing};
use super::evaluation::{Evaluation, PRECISIONS};
use super::exact::{Exact, Form, work_on};
use super::listing::Listing;
use super::state::{ExactState, Ratio};
use super::witness::{Requirement, Sides, holds};
use dashu::rational::RBig;
use palmistry_math::number::{Arithmetic, Enclosure, Enclosures, Rationals, Refusal};
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
    /// The rows of the minor.
    pub rows: Vec<usize>,
    /// Its columns.
    pub columns: Vec<usize>,
}

/// The rank at one state, and what shows it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RankedState {
    /// The state in exact numbers.
    pub state: ExactState,
    /// The rank that is claimed there.
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
    /// The matrix as a listing of steps.
    pub listing: Listing,
    /// What the columns stand for: the names of the states.
    pub columns: Vec<String>,
    /// What the rows stand for: the differentials of these Lie derivatives.
    pub row_names: Vec<String>,
    /// The entries, as places of the listing; a row for each name.
    pub rows: Vec<Vec<usize>>,
    /// What the states have to meet.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conditions: Vec<Sides>,
    /// Where the rows exist.
    pub requirements: Vec<Requirement>,
    /// The states with their ranks.
    pub states: Vec<RankedState>,
}

impl CertifiedRank {
    /// Checks the rank at every state.
    pub fn check(&self, effort: &Effort, interrupt: &AtomicBool) -> Finding {
        if let Err(doubt) = self.shape() {
            return Finding::NotConfirmed(doubt);
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

    /// Whether there are states, and every row has an entry a column.
    pub(super) fn shape(&self) -> Result<(), Doubt> {
        let width = self.columns.len();
        let ragged = self.rows.len() != self.row_names.len()
            || self.rows.iter().any(|row| row.len() != width)
            || !(1..=MOST_COLUMNS).contains(&width);
        match self.states.is_empty() {
            _ if ragged => Err(Doubt::Ragged),
            _ if self.rows.is_empty() => Err(Doubt::NoRows),
            true => Err(Doubt::Empty),
            false => Ok(()),
        }
    }

    /// Whether the rank at a state is at least what is said: its minor is not zero.
    pub(super) fn is_at_least<'c>(
        &'c self,
        state: usize,
        found: &'c RankedState,
        effort: &'c Effort,
    ) -> Result<Evaluation<'c>, Doubt> {
        let rank = found.rank;
        let different = |places: &[usize], below: usize| {
            let distinct: BTreeSet<usize> = places.iter().copied().filter(|place| *place < below).collect();
            places.len() == rank && distinct.len() == rank
        };
        let (rows, columns) = (&found.minor.rows, &found.minor.columns);
        if !different(rows, self.rows.len()) || !different(columns, self.columns.len()) {
            return Err(Doubt::NoMinor { state, rank });
        }
        let values = Evaluation::new(&self.listing, &found.state, effort)?;
        holds(&values, &self.conditions, &self.requirements)?;
        self.minor_differs_from_zero(state, &found.minor, &values, effort)?;
        Ok(values)
    }

    /// A rank that the matrix has at least at any state; it is the rank where all entries are rational there.
    pub(super) fn rank_at(&self, state: &ExactState, effort: &Effort) -> Result<usize, Doubt> {
        let values = Evaluation::new(&self.listing, state, effort)?;
        holds(&values, &self.conditions, &self.requirements)?;
        let refused = |refusal| Missing::Refused { place: self.listing.steps().len(), refusal };
        effort.spend((self.rows.len() * self.columns.len() * self.columns.len()) as u64)?;
        let rational = |place: &usize| values.rational(*place).cloned();
        let exact: Option<Vec<Vec<RBig>>> =
            self.rows.iter().map(|row| row.iter().map(rational).collect()).collect();
        if let Some(rows) = exact {
            return Ok(rank(&NUMBERS, rows, paid_from(effort)).map_err(refused)?);
        }
        let enclosed = |place: &usize| values.enclosed(*place, 1).cloned();
        let rows: Vec<Vec<Enclosure>> =
            self.rows.iter().map(|row| row.iter().map(enclosed).collect()).collect::<Result<_, _>>()?;
        Ok(rank(&Enclosures::new(PRECISIONS[1]), rows, |_| Ok(())).map_err(refused)?)
    }

    fn check_state(&self, state: usize, found: &RankedState, effort: &Effort) -> Result<(), Doubt> {
        let values = self.is_at_least(state, found, effort)?;
        let width = self.columns.len();
        let wanted = width - found.rank;
        if found.kernel.len() != wanted || found.kernel.iter().any(|vector| vector.len() != width) {
            return Err(Doubt::KernelSize { state, found: found.kernel.len(), wanted });
        }
        let kernel = &found.kernel;
        let square: Vec<Vec<RBig>> =
            kernel.iter().map(|vector| vector.iter().map(|part| part.0.clone()).collect()).collect();
        effort.spend((wanted * wanted * width) as u64)?;
        if !has_full_rank(&NUMBERS, square, paid_from(effort)).map_err(|_| Doubt::KernelDependent(state))? {
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
        let enclosed = |precision: usize| {
            let bits = PRECISIONS[precision];
            effort.spend(work * bits as u64 / 8)?;
            let rows: Vec<Vec<Enclosure>> = places
                .iter()
                .map(|row| row.iter().map(|place| values.enclosed(*place, precision).cloned()).collect())
                .collect::<Result<_, _>>()?;
            let full = has_full_rank(&Enclosures::new(bits), rows, |_| Ok(()));
            Ok(full.ok().filter(|full| *full))
        };
        if values.at_first_sight(enclosed) == Some(true) {
            return Ok(());
        }
        let rational = |place: &usize| values.rational(*place).cloned();
        let exact: Option<Vec<Vec<RBig>>> =
            places.iter().map(|row| row.iter().map(rational).collect()).collect();
        // fractions may grow too long to be eliminated; enclosures then may still decide
        if let Some(full) = exact.and_then(|rows| has_full_rank(&NUMBERS, rows, paid_from(effort)).ok()) {
            return if full { Ok(()) } else { Err(Doubt::MinorVanishes(state)) };
        }
        if values.climb(enclosed)? == Some(true) { Ok(()) } else { Err(Doubt::MinorNotTold(state)) }
    }
}

/// Whether the rows of a matrix are independent; see [`rank`].
fn has_full_rank<A: Arithmetic>(
    arithmetic: &A,
    rows: Vec<Vec<A::Number>>,
    pay: impl Fn(&A::Number) -> Result<(), Refusal>,
) -> Result<bool, Refusal> {
    let height = rows.len();
    Ok(rank(arithmetic, rows, pay)? == height)
}

/// Takes the work on fractions, which grow as they are eliminated.
fn paid_from(effort: &Effort) -> impl Fn(&RBig) -> Result<(), Refusal> {
    |value| effort.spend(work_on(value)).map_err(|_| Refusal::TooLarge)
}

/// The rank of a matrix by elimination that takes a pivot only where it is certainly not zero. Over numbers that can always be
/// distinguished from zero it is the rank; over others it is no more than the rank.
fn rank<A: Arithmetic>(
    arithmetic: &A,
    mut rows: Vec<Vec<A::Number>>,
    pay: impl Fn(&A::Number) -> Result<(), Refusal>,
) -> Result<usize, Refusal> {
    for step in 0..rows.len() {
        // any entry will do, of any row and any column: those of earlier pivots are zero
        let nonzero = |entry: &A::Number| arithmetic.is_zero(entry) == Some(false);
        let pivots = rows.iter().enumerate().skip(step);
        let pivot = pivots.filter_map(|(at, row)| Some((at, row.iter().position(nonzero)?))).next();
        let Some((at, column)) = pivot else { return Ok(step) };
        rows.swap(step, at);
        let (above, below) = rows.split_at_mut(step + 1);
        let Some(top) = above.last() else { return Ok(step) };
        for row in below {
            if arithmetic.is_zero(&row[column]) == Some(true) {
                continue;
            }
            let factor = arithmetic.div(&row[column], &top[column])?;
            for (index, (entry, above)) in row.iter_mut().zip(top).enumerate() {
                *entry = if index == column {
                    // what elimination makes zero is zero, however wide its enclosure
                    arithmetic.rational(&RBig::ZERO)?
                } else {
                    arithmetic.sub(entry, &arithmetic.mul(&factor, above)?)?
                };
                pay(entry)?;
            }
        }
    }
    Ok(rows.len())
}

/// Whether the product of a row and a vector is zero; `None` where that is not known.
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
