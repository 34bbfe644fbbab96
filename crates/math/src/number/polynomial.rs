//! Polynomials in several variables with integer coefficients, fully expanded: a sum of monomials, as a
//! computer-algebra system prints it. And what a [`Ring`] has to offer to stand above and below a fraction bar.

use dashu::base::{BitTest, Gcd, Sign};
use dashu::integer::{IBig, UBig};
use palmistry_budget as budget;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// The most variables that a polynomial may have.
pub const LARGEST_ARITY: usize = 24;

/// What a pair of monomials takes, in steps: as long as so many products of residues.
const PAIR: usize = 16;

/// Products of more pairs of monomials than this are not multiplied out.
const MOST_PAIRS: usize = 1 << 24;

/// The exponents of a monomial, one for each variable.
pub type Exponents = [u8; LARGEST_ARITY];

/// Something that can be added and multiplied.
pub trait Ring: Clone {
    /// The image of an integer.
    fn integer(value: &IBig) -> Self;
    /// `self + other`
    fn add(&self, other: &Self) -> Self;
    /// `self * other`; `None` where the product cannot be written down.
    fn mul(&self, other: &Self) -> Option<Self>;
    /// `-self`
    fn neg(&self) -> Self;
    /// Whether it is known to be zero.
    fn is_zero(&self) -> bool;
    /// Whether two of them are known to be equal.
    fn is_same(&self, other: &Self) -> bool;
}

/// A sum of monomials, none of them zero.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Polynomial {
    terms: BTreeMap<Exponents, IBig>,
}

impl Polynomial {
    /// The variable of an index below [`LARGEST_ARITY`].
    pub fn variable(index: usize) -> Self {
        let mut exponents = Exponents::default();
        exponents[index] = 1;
        Polynomial { terms: BTreeMap::from([(exponents, IBig::ONE)]) }
    }

    /// One monomial with its coefficient.
    pub fn term(exponents: Exponents, coefficient: IBig) -> Self {
        let mut polynomial = Polynomial::default();
        polynomial.insert(exponents, coefficient);
        polynomial
    }

    /// The monomials and their coefficients, in the order of their exponents.
    pub fn terms(&self) -> impl DoubleEndedIterator<Item = (&Exponents, &IBig)> {
        self.terms.iter()
    }

    /// The number of monomials.
    pub fn len(&self) -> usize {
        self.terms.len()
    }

    /// Whether it is zero.
    pub fn is_empty(&self) -> bool {
        self.terms.is_empty()
    }

    /// The total degree; zero for zero.
    pub fn degree(&self) -> u32 {
        self.terms.keys().map(|exponents| exponents.iter().map(|e| u32::from(*e)).sum()).max().unwrap_or(0)
    }

    /// The greatest common divisor of the coefficients, with the sign of the leading one.
    pub fn content(&self) -> IBig {
        let magnitude = self.terms.values().fold(UBig::ZERO, |g, c| {
            let c = c.clone().into_parts().1;
            if g.is_zero() { c } else { g.gcd(c) }
        });
        let negative = self.terms.values().next_back().is_some_and(|c| c.sign() == Sign::Negative);
        if negative { -IBig::from(magnitude) } else { IBig::from(magnitude) }
    }

    /// The length of the longest coefficient in machine words, at least one.
    fn words(&self) -> usize {
        self.terms.values().map(|coefficient| coefficient.bit_len() / 64 + 1).max().unwrap_or(1)
    }

    fn insert(&mut self, exponents: Exponents, coefficient: IBig) {
        match self.terms.entry(exponents) {
            Entry::Vacant(place) if !coefficient.is_zero() => {
                place.insert(coefficient);
            }
            Entry::Vacant(_) => {}
            Entry::Occupied(mut place) => {
                *place.get_mut() += coefficient;
                if place.get().is_zero() {
                    place.remove();
                }
            }
        }
    }

    /// Replaces the square of one variable by a polynomial, until its exponent is at most one: with `s^2 = 1 - c^2`
    /// the sine is left at most to the first power.
    pub fn reduce_square(&self, variable: usize, square: &Polynomial) -> Option<Polynomial> {
        let mut parts: BTreeMap<u8, Polynomial> = BTreeMap::new();
        for (exponents, coefficient) in &self.terms {
            let mut rest = *exponents;
            let halves = rest[variable] / 2;
            rest[variable] %= 2;
            parts.entry(halves).or_default().insert(rest, coefficient.clone());
        }
        let mut total = Polynomial::default();
        for (halves, part) in parts {
            let power = (0..halves).try_fold(Polynomial::integer(&IBig::ONE), |p, _| p.mul(square))?;
            total = total.add(&part.mul(&power)?);
        }
        Some(total)
    }

    /// The highest power of a variable.
    pub fn degree_in(&self, variable: usize) -> u8 {
        self.terms.keys().map(|exponents| exponents[variable]).max().unwrap_or(0)
    }

    /// The polynomial as one in a single variable: its coefficients, which are free of that variable, by their power.
    pub fn coefficients_in(&self, variable: usize) -> BTreeMap<u8, Polynomial> {
        budget::steps(PAIR * self.len());
        let mut parts: BTreeMap<u8, Polynomial> = BTreeMap::new();
        for (exponents, coefficient) in &self.terms {
            let mut rest = *exponents;
            let power = std::mem::take(&mut rest[variable]);
            parts.entry(power).or_default().terms.insert(rest, coefficient.clone());
        }
        parts
    }

    /// The greatest monomial that divides it.
    pub fn common_monomial(&self) -> Exponents {
        let mut common = [u8::MAX; LARGEST_ARITY];
        for exponents in self.terms.keys() {
            for (least, exponent) in common.iter_mut().zip(exponents) {
                *least = (*least).min(*exponent);
            }
        }
        if self.terms.is_empty() { Exponents::default() } else { common }
    }

    /// The quotient by a divisor that divides it without remainder; `None` if it does not.
    pub fn divide_exactly(&self, divisor: &Polynomial) -> Option<Polynomial> {
        let quotient_of = |a: &Exponents, b: &Exponents| -> Option<Exponents> {
            let mut difference = Exponents::default();
            for (d, (a, b)) in difference.iter_mut().zip(a.iter().zip(b)) {
                *d = a.checked_sub(*b)?;
            }
            Some(difference)
        };
        let (lead, lead_coefficient) = divisor.terms.iter().next_back()?;
        let (least, _) = divisor.terms.iter().next()?;
        if let Some((exponents, _)) = self.terms.iter().next() {
            // the last terms divide one another, as the first ones do
            quotient_of(exponents, least)?;
        }
        let (mut rest, mut quotient) = (self.clone(), Polynomial::default());
        while let Some((exponents, coefficient)) = rest.terms.iter().next_back() {
            let difference = quotient_of(exponents, lead)?;
            budget::steps(PAIR * divisor.len());
            let factor = coefficient / lead_coefficient;
            if &(&factor * lead_coefficient) != coefficient {
                return None;
            }
            for (exponents, coefficient) in &divisor.terms {
                let mut product = Exponents::default();
                for (e, (x, y)) in product.iter_mut().zip(exponents.iter().zip(&difference)) {
                    *e = x.checked_add(*y)?;
                }
                rest.insert(product, -(coefficient * &factor));
            }
            quotient.insert(difference, factor);
        }
        Some(quotient)
    }
}

impl Ring for Polynomial {
    fn integer(value: &IBig) -> Self {
        let mut constant = Polynomial::default();
        constant.insert(Exponents::default(), value.clone());
        constant
    }

    fn add(&self, other: &Self) -> Self {
        let (long, short) = if self.len() >= other.len() { (self, other) } else { (other, self) };
        budget::steps(PAIR * (long.len() + short.len()));
        let mut sum = long.clone();
        for (exponents, coefficient) in &short.terms {
            sum.insert(*exponents, coefficient.clone());
        }
        sum
    }

    fn mul(&self, other: &Self) -> Option<Self> {
        if self.len().saturating_mul(other.len()) > MOST_PAIRS {
            return None;
        }
        budget::steps(PAIR * self.len() * other.len() * self.words() * other.words());
        let mut product = std::collections::HashMap::new();
        for (left, a) in &self.terms {
            for (right, b) in &other.terms {
                let mut exponents = Exponents::default();
                for (e, (x, y)) in exponents.iter_mut().zip(left.iter().zip(right)) {
                    *e = x.checked_add(*y)?;
                }
                *product.entry(exponents).or_insert(IBig::ZERO) += a * b;
            }
        }
        let terms = product.into_iter().filter(|(_, coefficient)| !coefficient.is_zero()).collect();
        Some(Polynomial { terms })
    }

    fn neg(&self) -> Self {
        Polynomial { terms: self.terms.iter().map(|(e, c)| (*e, -c)).collect() }
    }

    fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    fn is_same(&self, other: &Self) -> bool {
        self == other
    }
}

/// Bounds on a polynomial that is never written down: its total degree, and the binary logarithm of the sum of the
/// magnitudes of its coefficients.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Size {
    /// At least the total degree.
    pub degree: f64,
    /// At least the logarithm of the sum of magnitudes.
    pub bits: f64,
}

impl Ring for Size {
    fn integer(value: &IBig) -> Self {
        Size { degree: 0.0, bits: value.bit_len() as f64 }
    }
    fn add(&self, other: &Self) -> Self {
        // log2(2^a + 2^b) <= max + 1, and that is bound enough
        Size { degree: self.degree.max(other.degree), bits: self.bits.max(other.bits) + 1.0 }
    }
    fn mul(&self, other: &Self) -> Option<Self> {
        Some(Size { degree: self.degree + other.degree, bits: self.bits + other.bits })
    }
    fn neg(&self) -> Self {
        *self
    }
    fn is_zero(&self) -> bool {
        false
    }
    fn is_same(&self, _: &Self) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn x(index: usize) -> Polynomial {
        Polynomial::variable(index)
    }

    #[test]
    fn a_difference_of_squares_has_its_factors() {
        let product = x(0).add(&x(1)).mul(&x(0).add(&x(1).neg())).unwrap();
        assert_eq!(product.len(), 2);
        assert_eq!(product.divide_exactly(&x(0).add(&x(1))), Some(x(0).add(&x(1).neg())));
        assert_eq!(product.divide_exactly(&x(0)), None);
    }

    #[test]
    fn a_sine_is_left_at_most_to_the_first_power() {
        let one = Polynomial::integer(&IBig::ONE);
        let square = one.add(&x(1).mul(&x(1)).unwrap().neg());
        let cube = x(0).mul(&x(0)).unwrap().mul(&x(0)).unwrap();
        assert_eq!(cube.reduce_square(0, &square), x(0).mul(&square));
    }
}
