//! What vanishes at random points modulo random primes: equations and upper bounds of ranks that are too long to be multiplied out.
//!
//! Symbols, sines with their cosines, exponentials and other functions are drawn, each as a variable of its own; what holds between them so
//! holds between the functions. A polynomial that is not zero vanishes at a random point with a probability of at most its degree over the
//! prime (J. T. Schwartz, Fast probabilistic algorithms for verification of polynomial identities, 1980), and modulo a random prime with one
//! of at most the bits of its coefficients over the number of primes. Degrees and coefficients are bounded first (`bound`), and as many points are
//! drawn as make the probability of an error less than `2^-100`. Points and primes come from the operating system: no file can be written for them.
//!
//! That a minor does not vanish is never concluded from here.

mod bound;
mod form;
mod point;

use super::doubt::{Effort, Missing};
use super::listing::{Listing, Step};
use super::witness::{Sides, SidesRelation};
use bound::NumeratorBounds;
use form::{EvaluationOrder, FunctionForms};
use point::{PointError, RandomPoint};
use rand::rngs::SysRng;
use rand::{SeedableRng, TryRng};
use rand_chacha::ChaCha8Rng;

/// The probability of an error is below two to minus this.
const BITS: f64 = 100.0;
/// No more points are drawn than this, nor so many more that have no value.
const MOST_POINTS: f64 = 8.0;
const ATTEMPTS: usize = 8;
/// No more symbols are given: with each one all operations are put in order again.
const MOST_GIVEN: usize = 64;

/// What the conditions of a claim give: symbols, each by an operation, in an order in which each follows from what is free.
pub struct GivenSymbols {
    pub symbols: Vec<(String, usize)>,
}

/// The symbols that equations give, where each equation says what one symbol is; nothing where one says something else. Inequalities that
/// leave an open set say nothing of equations; whether others may do so as well is asked for.
pub fn given_by(listing: &Listing, conditions: &[Sides], is_closed_allowed: bool) -> Option<GivenSymbols> {
    let mut symbols: Vec<(String, usize)> = Vec::new();
    for sides in conditions {
        match sides.relation {
            SidesRelation::Equal => {}
            SidesRelation::AtMost | SidesRelation::AtLeast if !is_closed_allowed => return None,
            _ => continue,
        }
        if symbols.len() >= MOST_GIVEN {
            return None;
        }
        let mut found = false;
        for (left, right) in [(sides.left, sides.right), (sides.right, sides.left)] {
            let Some(Step::Symbol(name)) = listing.steps().get(left) else { continue };
            if symbols.iter().any(|(known, _)| known == name) {
                continue;
            }
            symbols.push((name.clone(), right));
            if EvaluationOrder::of(listing, &symbols, &[]).is_some() {
                found = true;
                break;
            }
            symbols.pop();
        }
        if !found {
            return None;
        }
    }
    Some(GivenSymbols { symbols })
}

/// Whether differences of two operations vanish identically where the symbols are given so, with an error probability below `2^-100`.
/// `false` says nothing.
///
/// # Errors
/// Where it takes too much work.
pub fn vanish(
    listing: &Listing,
    given: &GivenSymbols,
    differences: &[(usize, usize)],
    effort: &Effort,
) -> Result<bool, Missing> {
    let places: Vec<usize> = differences.iter().flat_map(|(left, right)| [*left, *right]).collect();
    let Some(forms) = FunctionForms::of(listing, given, &places) else { return Ok(false) };
    let bounds = NumeratorBounds::of(listing, &forms);
    let size =
        differences.iter().map(|(left, right)| bounds.of_difference(*left, *right)).fold(0.0, f64::max);
    at_points(listing, &forms, size, effort, |point| {
        differences
            .iter()
            .all(|(left, right)| point.value(*left).is_some_and(|value| Some(value) == point.value(*right)))
    })
}

/// Whether rows have a rank of at most so many at almost all states where the symbols are given so, but for a probability of an error below
/// `2^-100`. `false` says nothing.
///
/// # Errors
/// Where it takes too much work.
pub fn have_rank_of_at_most(
    listing: &Listing,
    given: &GivenSymbols,
    rows: &[Vec<usize>],
    rank: usize,
    effort: &Effort,
) -> Result<bool, Missing> {
    let places: Vec<usize> = rows.iter().flatten().copied().collect();
    let Some(forms) = FunctionForms::of(listing, given, &places) else { return Ok(false) };
    let bounds = NumeratorBounds::of(listing, &forms);
    let size = bounds.of_minors(rows, rank + 1);
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let elimination = (rows.len() * columns * (rank + 1)) as u64;
    at_points(listing, &forms, size, effort, |point| {
        effort.spend(elimination).is_ok() && point.rank(rows) <= rank
    })
}

/// Whether something holds at as many points as a polynomial of this size needs; `false` where it fails at one, or too few have a value.
fn at_points(
    listing: &Listing,
    forms: &FunctionForms,
    size: f64,
    effort: &Effort,
    holds: impl Fn(&RandomPoint) -> bool,
) -> Result<bool, Missing> {
    let bits = point::BITS_OF_PRIMES - 2.0 - (1.0 + size).log2();
    let count = (BITS / bits).ceil();
    // of a size that is no number nothing is known
    if !(bits > 0.0 && count <= MOST_POINTS) {
        return Ok(false);
    }
    let mut seed = [0u8; 32];
    if SysRng.try_fill_bytes(&mut seed).is_err() {
        return Ok(false);
    }
    let mut rng = ChaCha8Rng::from_seed(seed);
    let (mut left, mut failures) = (count as usize, 0);
    while left > 0 {
        effort.spend(forms.cost())?;
        match RandomPoint::draw(listing, forms, &mut rng) {
            Ok(point) if !holds(&point) => return Ok(false),
            Ok(_) => left -= 1,
            Err(PointError::Pole) if failures < ATTEMPTS => failures += 1,
            Err(_) => return Ok(false),
        }
    }
    Ok(true)
}

#[cfg(test)]
mod tests;
