//! What happens to a determinant when a computer-algebra system multiplies it out and adds up the monomials in ten
//! digits.

use dashu::rational::RBig;
use palmistry_math::expression::{Expansion, Input, Symbol, SymbolInput};
use palmistry_math::number::{Arithmetic, Decimals, Refusal, rational_to_f64};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::HashMap;

/// The errors that an evaluation in few digits makes, over many orders of summation.
#[derive(Clone, Debug)]
pub struct RoundingStudy {
    /// Decimal digits carried by every operation.
    pub digits: usize,
    /// The number of monomials added up.
    pub monomials: usize,
    /// Result minus truth, of every order that was tried, ascending.
    pub errors: Vec<f64>,
    /// The largest magnitude of a monomial over that of the sum: the digits that cancel are its logarithm.
    pub cancellation: f64,
}

impl RoundingStudy {
    /// The root of the mean square error.
    pub fn deviation(&self) -> f64 {
        (self.errors.iter().map(|e| e * e).sum::<f64>() / self.errors.len() as f64).sqrt()
    }

    /// Whether an error lies between the least and the greatest that were found.
    pub fn contains(&self, error: f64) -> bool {
        self.errors.first().is_some_and(|least| *least <= error)
            && self.errors.last().is_some_and(|most| error <= *most)
    }
}

/// Sums an expansion in `digits`-digit decimal arithmetic in `orders` random orders (of the monomials, and of the
/// factors within them) at a point given by rational numbers, angles in radians.
///
/// # Errors
/// Where a symbol has no value or an operation is refused.
pub fn study_rounding(
    expansion: &Expansion,
    point: &HashMap<Symbol, RBig>,
    truth: &RBig,
    digits: usize,
    orders: u64,
    seed: u64,
) -> Result<RoundingStudy, Refusal> {
    let arithmetic = Decimals::new(digits);
    let value = |input: &Input| {
        let SymbolInput { symbol, function } = input.of_symbol().ok_or(Refusal::NotFinite)?;
        function.of(&arithmetic, arithmetic.rational(point.get(&symbol).ok_or(Refusal::NotFinite)?)?)
    };
    let values: Vec<_> = expansion.variables.iter().map(value).collect::<Result<_, _>>()?;
    let monomials = expansion.numerator.len();
    let mut errors: Vec<f64> = (0..orders)
        .into_par_iter()
        .map(|index| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(index);
            let mut order: Vec<usize> = (0..monomials).collect();
            let mut within: Vec<usize> = (0..values.len()).collect();
            order.shuffle(&mut rng);
            within.shuffle(&mut rng);
            let sum = expansion.sum_terms(&arithmetic, &values, &order, &within)?;
            Ok(rational_to_f64(&(Decimals::exactly(&sum) - truth)))
        })
        .collect::<Result<_, Refusal>>()?;
    errors.sort_by(f64::total_cmp);
    Ok(RoundingStudy { digits, monomials, errors, cancellation: cancellation(expansion, &values) })
}

/// The largest monomial over the magnitude of their sum.
fn cancellation(expansion: &Expansion, values: &[palmistry_math::number::Decimal]) -> f64 {
    let values: Vec<f64> = values.iter().map(|v| rational_to_f64(&Decimals::exactly(v))).collect();
    let (mut largest, mut sum) = (0.0f64, 0.0f64);
    for (exponents, coefficient) in expansion.numerator.terms() {
        let coefficient = rational_to_f64(&RBig::from(coefficient.clone()));
        let powers = values.iter().zip(exponents).map(|(v, e)| v.powi(i32::from(*e)));
        let term: f64 = coefficient * powers.product::<f64>();
        largest = largest.max(term.abs());
        sum += term;
    }
    largest / sum.abs()
}
