//! The singular values of a matrix after equilibration, and their condition, right to as many decimal digits as are
//! wanted.
//!
//! Doubles scaled until lengths agree to four digits give no more than four digits; here the limit itself
//! is computed ([`equilibrium`]), and singular values are enclosed ([`decomposition`]). The cheapest numbers that suffice
//! are taken. Nothing here knows where the matrix comes from.

mod decomposition;
mod equilibrium;
mod numbers;

use crate::sweep::certainty::Certainty;
use dashu::rational::RBig;
use decomposition::{approximate_values, enclosed_values};
use equilibrium::{approximately_equilibrated, equilibrated};
use numbers::{Approximate, Enclosing};
use palmistry_math::number::{
    Arithmetic, DoubleDouble, Enclosures, Floats, Interval, NumberType, Refusal, common_decimal,
    rational_from_f64, round_to_decimal,
};

/// More digits than this are not asked for.
pub const MOST_DIGITS: usize = 200;

/// Up to so many decimal digits doubles are tried.
const DIGITS_OF_A_DOUBLE: usize = 15;

/// How often the bits are doubled.
const DOUBLINGS: usize = 4;

/// Singular values and their condition to some digits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Digits {
    /// Significant decimal digits of each number.
    pub digits: usize,
    /// The singular values in descending order, rounded to these digits.
    pub values: Vec<String>,
    /// The largest over the smallest.
    pub condition: String,
    /// Whether the digits are certain, or two number types agree on them.
    pub certainty: Certainty,
    /// The numbers that sufficed.
    pub number_type: NumberType,
    /// How many number types had been tried before and did not suffice.
    pub climbed: usize,
}

/// Why there are no such digits.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)] // names and messages say it
pub enum NoDigits {
    /// There is no state of full rank whose singular values could be given.
    #[error("no state of full rank was found")]
    NoState,
    /// Scaling rows and columns in turn does not come to an end: some patterns of zeros have no equilibrium.
    #[error("no equilibrium of rows and columns was found; for some patterns of zeros there is none")]
    NoEquilibrium,
    /// The numbers enclose too widely, or have no entries.
    #[error("enclosures of {bits} bits do not fix the digits")]
    NotFixed { bits: usize },
    /// The numbers refuse.
    #[error("enclosures of {bits} bits do not fix the digits ({why})")]
    Refused { bits: usize, why: Refusal },
}

/// Why a matrix has no entries over an arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoEntries {
    /// The numbers refuse an operation.
    Refused(Refusal),
    /// What the entries are made of has no image there.
    NotInThese,
}

/// Why singular values are not enclosed.
enum NotEnclosed {
    /// The equilibrium or the rotations were not found.
    NoEquilibrium,
    NoEntries,
    Refused(Refusal),
}

impl From<NoEntries> for NotEnclosed {
    fn from(why: NoEntries) -> Self {
        match why {
            NoEntries::Refused(refusal) => NotEnclosed::Refused(refusal),
            NoEntries::NotInThese => NotEnclosed::NoEntries,
        }
    }
}

impl From<Refusal> for NotEnclosed {
    fn from(refusal: Refusal) -> Self {
        NotEnclosed::Refused(refusal)
    }
}

/// A matrix, by rows, over any numbers.
pub trait Matrices {
    /// The entries.
    ///
    /// # Errors
    /// Where there are none.
    fn entries<A: Arithmetic + Copy>(&self, on: A) -> Result<Vec<Vec<A::Number>>, NoEntries>;
}

/// The singular values of the equilibrated matrix to so many digits. `wanted` is as for ranks: *computed* digits are those
/// on which doubles and double-doubles agree.
///
/// # Errors
/// Where digits cannot be had, and why.
pub fn digits_of<M: Matrices>(matrix: &M, digits: usize, wanted: Certainty) -> Result<Digits, NoDigits> {
    let digits = digits.clamp(1, MOST_DIGITS);
    let mut climbed = 0;
    let found = |(values, condition), certainty, number_type, climbed| {
        Ok(Digits { digits, values, condition, certainty, number_type, climbed })
    };
    if digits <= DIGITS_OF_A_DOUBLE {
        if wanted == Certainty::Computed {
            if let Some(agreed) = agreed(matrix, digits) {
                return found(agreed, Certainty::Computed, NumberType::DoubleDoubles, climbed);
            }
            climbed += 1;
        }
        if let Ok(ends) = enclosed(matrix, Floats::<Interval>::new())
            && let Some(decimals) = decimals(&ends, digits)
        {
            return found(decimals, Certainty::Certified, NumberType::Intervals, climbed);
        }
        climbed += 1;
    }
    let mut bits = digits * 7 / 2 + 64;
    for last in (0..=DOUBLINGS).rev() {
        let complaint = match enclosed(matrix, Enclosures::new(bits)) {
            Ok(ends) => match decimals(&ends, digits) {
                Some(decimals) => {
                    return found(decimals, Certainty::Certified, NumberType::Enclosures(bits), climbed);
                }
                None => NoDigits::NotFixed { bits },
            },
            Err(NotEnclosed::NoEquilibrium) => NoDigits::NoEquilibrium,
            Err(NotEnclosed::NoEntries) => NoDigits::NotFixed { bits },
            Err(NotEnclosed::Refused(why)) => NoDigits::Refused { bits, why },
        };
        if last == 0 {
            return Err(complaint);
        }
        climbed += 1;
        bits *= 2;
    }
    Err(NoDigits::NotFixed { bits })
}

/// Lower and upper ends, each in descending order.
struct Ends {
    low: Vec<RBig>,
    high: Vec<RBig>,
}

/// Enclosures of the singular values.
fn enclosed<M: Matrices, A: Enclosing + Copy>(matrix: &M, on: A) -> Result<Ends, NotEnclosed> {
    let (mut low, mut high) = (Vec::new(), Vec::new());
    let parts = connected(&on, matrix.entries(on)?).ok_or(NotEnclosed::NoEquilibrium)?;
    for part in parts {
        let scaled = equilibrated(&on, &part)?.ok_or(NotEnclosed::NoEquilibrium)?;
        let values = enclosed_values(&on, &as_columns(scaled))?.ok_or(NotEnclosed::NoEquilibrium)?;
        for value in values {
            let (left, right) = on.ends(&value).ok_or(Refusal::NotFinite)?;
            low.push(left);
            high.push(right);
        }
    }
    low.sort_by(|a, b| b.cmp(a));
    high.sort_by(|a, b| b.cmp(a));
    Ok(Ends { low, high })
}

/// What all numbers between the ends are rounded to: the values and the condition.
fn decimals(ends: &Ends, digits: usize) -> Option<(Vec<String>, String)> {
    let values: Option<Vec<String>> =
        ends.low.iter().zip(&ends.high).map(|(low, high)| common_decimal(low, high, digits)).collect();
    let (Some(largest), Some(smallest)) = (ends.low.first(), ends.low.last()) else {
        return Some((Vec::new(), "1".to_owned())); // nothing remains to be decided
    };
    if *smallest <= RBig::ZERO {
        return None;
    }
    let (most, least) = (ends.high.first()?, ends.high.last()?);
    Some((values?, common_decimal(&(largest / least), &(most / smallest), digits)?))
}

/// The values on which doubles and double-doubles agree to so many digits.
fn agreed<M: Matrices>(matrix: &M, digits: usize) -> Option<(Vec<String>, String)> {
    let rough = approximate(matrix, Floats::<f64>::new())?;
    let fine = approximate(matrix, Floats::<DoubleDouble>::new())?;
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 0.5 * 10f64.powi(-(digits as i32)) * b.abs();
    let decimal = |value: f64| Some(round_to_decimal(&rational_from_f64(value)?, digits));
    if rough.len() != fine.len() || !rough.iter().zip(&fine).all(near) {
        return None;
    }
    let condition = |values: &[f64]| values.first().zip(values.last()).map_or(1.0, |(a, b)| a / b);
    let (one, other) = (condition(&rough), condition(&fine));
    let values = fine.iter().map(|value| decimal(*value)).collect::<Option<_>>()?;
    near((&one, &other)).then_some((values, decimal(other)?))
}

/// The values in descending order, rounded to doubles, nothing known of their errors.
fn approximate<M: Matrices, A: Approximate + Copy>(matrix: &M, on: A) -> Option<Vec<f64>> {
    let mut all = Vec::new();
    for part in connected(&on, matrix.entries(on).ok()?)? {
        let scaled = approximately_equilibrated(&on, &part).ok()??;
        all.extend(approximate_values(&on, &as_columns(scaled)).ok()?.iter().map(|value| on.near(value)));
    }
    all.sort_by(|a, b| b.total_cmp(a));
    Some(all)
}

/// The parts of a matrix between which all entries are zero, each with its rows and columns; rows of zeros are left out.
/// `None` where a column is zero.
fn connected<A: Arithmetic>(on: &A, matrix: Vec<Vec<A::Number>>) -> Option<Vec<Vec<Vec<A::Number>>>> {
    let filled = |i: usize, j: usize| on.is_zero(&matrix[i][j]) != Some(true);
    let mut columns: Vec<usize> = (0..matrix.first().map_or(0, Vec::len)).collect();
    let mut rows: Vec<usize> = (0..matrix.len()).filter(|i| columns.iter().any(|j| filled(*i, *j))).collect();
    let mut parts = Vec::new();
    while let Some(first) = columns.first().copied() {
        let (mut mine, mut with) = (Vec::new(), vec![first]);
        loop {
            let more: Vec<usize> = rows.extract_if(.., |i| with.iter().any(|j| filled(*i, *j))).collect();
            mine.extend(more);
            let wide: Vec<usize> =
                columns.iter().copied().filter(|j| mine.iter().any(|i| filled(*i, *j))).collect();
            if wide.len() == with.len() {
                break;
            }
            with = wide;
        }
        if mine.is_empty() {
            return None;
        }
        columns.retain(|j| !with.contains(j));
        parts.push(mine.iter().map(|i| with.iter().map(|j| matrix[*i][*j].clone()).collect()).collect());
    }
    Some(parts)
}

/// By columns, or by rows where there are fewer of them: singular values are the same.
fn as_columns<N: Clone>(matrix: Vec<Vec<N>>) -> Vec<Vec<N>> {
    let columns = matrix.first().map_or(0, Vec::len);
    if matrix.len() < columns {
        return matrix;
    }
    (0..columns).map(|j| matrix.iter().map(|row| row[j].clone()).collect()).collect()
}

#[cfg(test)]
mod tests;
