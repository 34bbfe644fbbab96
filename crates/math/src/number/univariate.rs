//! Polynomials in one variable modulo one prime, for the one question whether two of them have a factor in common.

use super::polynomial::Ring;
use super::{Arithmetic, PrimeField};
use dashu::integer::IBig;
use palmistry_budget as budget;

/// The least prime above 2^61.
const PRIME: u64 = (1 << 61) + 15;

/// The highest degree that is multiplied out.
const HIGHEST: usize = 4000;

/// Coefficients modulo the prime, constant first; the last is not zero.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Univariate(Vec<u64>);

fn field() -> PrimeField {
    PrimeField::new(PRIME)
}

impl Univariate {
    /// `constant + slope * x`, from residues.
    pub fn line(constant: u64, slope: u64) -> Self {
        Univariate(vec![constant, slope]).trimmed()
    }

    /// The prime field of the coefficients.
    pub fn field() -> PrimeField {
        field()
    }

    /// The degree; zero for constants.
    pub fn degree(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    fn trimmed(mut self) -> Self {
        while self.0.last() == Some(&0) {
            self.0.pop();
        }
        self
    }

    /// Quotient and remainder by a divisor that is not zero.
    fn divide(&self, divisor: &Univariate) -> Option<(Univariate, Univariate)> {
        let f = field();
        let lead = f.inverse(*divisor.0.last()?)?;
        let mut rest = self.0.clone();
        let mut quotient = vec![0; (self.0.len() + 1).saturating_sub(divisor.0.len())];
        budget::steps(quotient.len() * divisor.0.len());
        for at in (0..quotient.len()).rev() {
            let factor = f.mul(&rest[at + divisor.0.len() - 1], &lead).ok()?;
            for (i, d) in divisor.0.iter().enumerate() {
                rest[at + i] = f.sub(&rest[at + i], &f.mul(&factor, d).ok()?).ok()?;
            }
            quotient[at] = factor;
        }
        Some((Univariate(quotient).trimmed(), Univariate(rest).trimmed()))
    }

    /// A greatest common divisor (Euclid).
    pub fn gcd(&self, other: &Univariate) -> Univariate {
        let (mut a, mut b) = (self.clone(), other.clone());
        while let Some((_, rest)) = a.divide(&b) {
            (a, b) = (b, rest);
        }
        a
    }

    /// The quotient by a divisor that leaves no remainder.
    pub fn quotient(&self, divisor: &Univariate) -> Option<Univariate> {
        let (quotient, rest) = self.divide(divisor)?;
        rest.0.is_empty().then_some(quotient)
    }
}

impl Ring for Univariate {
    fn integer(value: &IBig) -> Self {
        Univariate(vec![field().integer(value)]).trimmed()
    }
    fn add(&self, other: &Self) -> Self {
        let f = field();
        let at = |p: &Self, i: usize| p.0.get(i).copied().unwrap_or(0);
        let sum =
            (0..self.0.len().max(other.0.len())).map(|i| f.add(&at(self, i), &at(other, i)).unwrap_or(0));
        Univariate(sum.collect()).trimmed()
    }
    fn mul(&self, other: &Self) -> Option<Self> {
        let f = field();
        if self.0.is_empty() || other.0.is_empty() {
            return Some(Univariate(Vec::new()));
        }
        if self.degree() + other.degree() > HIGHEST {
            return None;
        }
        budget::steps(self.0.len() * other.0.len());
        let mut product = vec![0; self.0.len() + other.0.len() - 1];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in other.0.iter().enumerate() {
                product[i + j] = f.add(&product[i + j], &f.mul(a, b).ok()?).ok()?;
            }
        }
        Some(Univariate(product).trimmed())
    }
    fn neg(&self) -> Self {
        let f = field();
        Univariate(self.0.iter().map(|c| f.neg(c).unwrap_or(0)).collect())
    }
    fn is_zero(&self) -> bool {
        self.0.is_empty()
    }
    fn is_same(&self, other: &Self) -> bool {
        self == other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `(x - 1)(x - 2)` and `(x - 1)(x + 5)` share `x - 1`; `x - 1` and `x + 5` share nothing.
    #[test]
    fn common_factors_are_found() {
        let linear = |n: i64| Univariate::line(field().integer(&n.into()), field().integer(&1.into()));
        let (a, b) = (linear(-1).mul(&linear(-2)).unwrap(), linear(-1).mul(&linear(5)).unwrap());
        assert_eq!(a.gcd(&b).degree(), 1);
        assert_eq!(a.quotient(&linear(-2)), Some(linear(-1)));
        assert_eq!(linear(-1).gcd(&linear(5)).degree(), 0);
    }
}
