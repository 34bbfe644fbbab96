//! Arguments of functions written out: sums of rational multiples of products of powers of generators.

use dashu::base::Gcd;
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use palmistry_budget as budget;
use std::collections::BTreeMap;

/// A generator, by its place in the table of them.
pub type Generator = u32;

/// Powers of generators, in the order of these; none of them zero.
pub(super) type Monomial = Vec<(Generator, i32)>;

/// Sums are no longer, and powers no higher.
const MOST_TERMS: usize = 120;
const LARGEST_POWER: i32 = 1 << 12;

/// A sum of monomials, none of them with the factor zero.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Form(pub BTreeMap<Monomial, RBig>);

impl Form {
    pub fn term(monomial: Monomial, factor: RBig) -> Form {
        let mut form = Form::default();
        form.insert(monomial, factor);
        form
    }

    pub fn constant(value: RBig) -> Form {
        Form::term(Monomial::new(), value)
    }

    pub fn variable(variable: Generator) -> Form {
        Form::term(vec![(variable, 1)], RBig::ONE)
    }

    pub fn insert(&mut self, monomial: Monomial, factor: RBig) {
        budget::steps(16);
        let entry = self.0.entry(monomial).or_insert(RBig::ZERO);
        *entry += factor;
        if entry.is_zero() {
            self.0.retain(|_, factor| !factor.is_zero());
        }
    }

    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// The rational number that it is.
    pub fn as_constant(&self) -> Option<RBig> {
        match self.single() {
            Some((monomial, factor)) if monomial.is_empty() => Some(factor.clone()),
            _ => self.is_zero().then_some(RBig::ZERO),
        }
    }

    /// The one term that it has.
    pub fn single(&self) -> Option<(&Monomial, &RBig)> {
        self.0.iter().next().filter(|_| self.0.len() == 1)
    }

    /// The generator that it is.
    pub fn as_variable(&self) -> Option<Generator> {
        match self.single()? {
            (monomial, factor) if factor.is_one() => as_variable(monomial),
            _ => None,
        }
    }

    pub fn variables(&self) -> Vec<Generator> {
        let mut all: Vec<Generator> = self.0.keys().flatten().map(|(variable, _)| *variable).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// `self + factor other`; nothing where that is too long.
    pub fn plus(&self, other: &Form, factor: &RBig) -> Option<Form> {
        let mut sum = self.clone();
        for (monomial, value) in &other.0 {
            sum.insert(monomial.clone(), value * factor);
        }
        (sum.0.len() <= MOST_TERMS).then_some(sum)
    }

    pub fn scaled(&self, factor: &RBig) -> Form {
        match factor.is_zero() {
            true => Form::default(),
            false => Form(self.0.iter().map(|(m, value)| (m.clone(), value * factor)).collect()),
        }
    }

    /// The product, not reduced by what the generators satisfy.
    pub fn times(&self, other: &Form) -> Option<Form> {
        budget::steps(64 * self.0.len() * other.0.len());
        let mut product = Form::default();
        for (left, a) in &self.0 {
            for (right, b) in &other.0 {
                product.insert(joined(left, right)?, a * b);
            }
        }
        (product.0.len() <= MOST_TERMS).then_some(product)
    }

    /// A factor, and what remains: integers without a common divisor, the last of them positive.
    pub fn primitive(&self) -> Option<(RBig, Form)> {
        let (_, last) = self.0.iter().next_back()?;
        let (mut tops, mut bottoms) = (UBig::ZERO, UBig::ONE);
        for value in self.0.values() {
            let top = value.numerator().clone().into_parts().1;
            tops = if tops.is_zero() { top } else { tops.gcd(top) };
            let common = (&bottoms).gcd(value.denominator());
            bottoms = bottoms / common * value.denominator();
        }
        let content = RBig::from_parts(IBig::from(tops), bottoms);
        let content = if *last < RBig::ZERO { -content } else { content };
        let rest = self.scaled(&(RBig::ONE / &content));
        Some((content, rest))
    }
}

/// The generator that a monomial is.
pub(super) fn as_variable(monomial: &Monomial) -> Option<Generator> {
    match monomial.as_slice() {
        [(variable, 1)] => Some(*variable),
        _ => None,
    }
}

/// A product of monomials.
pub(super) fn joined(a: &Monomial, b: &Monomial) -> Option<Monomial> {
    let mut powers: BTreeMap<Generator, i32> = a.iter().copied().collect();
    for (variable, power) in b {
        let entry = powers.entry(*variable).or_insert(0);
        *entry = entry.checked_add(*power)?;
        if entry.abs() > LARGEST_POWER {
            return None;
        }
    }
    Some(powers.into_iter().filter(|(_, power)| *power != 0).collect())
}
