//! Polynomials in any number of variables with integer coefficients: what rates and outputs are made of, before a prime is chosen.

use dashu::integer::IBig;
use palmistry_math::number::polynomial::Ring;
use std::collections::BTreeMap;

/// Variables and their powers, by variable; no power is zero.
pub(super) type Monomial = Vec<(u32, u16)>;

/// Products of more pairs of monomials than this are not multiplied out.
const MOST_PAIRS: usize = 1 << 20;

/// A sum of monomials, none of them zero.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Exact {
    pub terms: BTreeMap<Monomial, IBig>,
}

impl Exact {
    /// One variable.
    pub fn variable(variable: u32) -> Self {
        Exact { terms: BTreeMap::from([(vec![(variable, 1)], IBig::ONE)]) }
    }

    /// The number that it is, if it is one.
    pub fn as_constant(&self) -> Option<IBig> {
        match self.terms.len() {
            0 => Some(IBig::ZERO),
            1 => self.terms.get(&Monomial::new()).cloned(),
            _ => None,
        }
    }

    fn insert(&mut self, monomial: Monomial, coefficient: IBig) {
        use std::collections::btree_map::Entry;
        match self.terms.entry(monomial) {
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
}

/// The product of two monomials; `None` where a power is too high.
pub(super) fn times(a: &[(u32, u16)], b: &[(u32, u16)]) -> Option<Monomial> {
    let mut product = Monomial::with_capacity(a.len() + b.len());
    let (mut a, mut b) = (a.iter().peekable(), b.iter().peekable());
    loop {
        match (a.peek(), b.peek()) {
            (Some((v, n)), Some((w, m))) if v == w => {
                product.push((*v, n.checked_add(*m)?));
                a.next();
                b.next();
            }
            (Some((v, _)), Some((w, _))) if v < w => product.extend(a.next().copied()),
            (_, Some(_)) => product.extend(b.next().copied()),
            (Some(_), None) => product.extend(a.next().copied()),
            (None, None) => return Some(product),
        }
    }
}

impl Ring for Exact {
    fn integer(value: &IBig) -> Self {
        let mut constant = Exact::default();
        constant.insert(Monomial::new(), value.clone());
        constant
    }
    fn add(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        for (monomial, coefficient) in &other.terms {
            sum.insert(monomial.clone(), coefficient.clone());
        }
        sum
    }
    fn mul(&self, other: &Self) -> Option<Self> {
        if self.terms.len().saturating_mul(other.terms.len()) > MOST_PAIRS {
            return None;
        }
        let mut product = Exact::default();
        for (left, a) in &self.terms {
            for (right, b) in &other.terms {
                product.insert(times(left, right)?, a * b);
            }
        }
        Some(product)
    }
    fn neg(&self) -> Self {
        Exact { terms: self.terms.iter().map(|(m, c)| (m.clone(), -c)).collect() }
    }
    fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }
    fn is_same(&self, other: &Self) -> bool {
        self == other
    }
}
