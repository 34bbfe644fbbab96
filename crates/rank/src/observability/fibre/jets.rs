//! Polynomials modulo a prime in the derivatives of variables, and their derivative along time.

use super::exact::{Exact, Monomial, times};
use palmistry_math::number::PrimeField;
use std::collections::BTreeMap;

/// A polynomial modulo a prime: coefficients in Montgomery's form, none of them zero.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Jet {
    pub terms: BTreeMap<Monomial, u64>,
}

impl Jet {
    pub fn constant(value: u64) -> Jet {
        let mut jet = Jet::default();
        if value != 0 {
            jet.terms.insert(Monomial::new(), value);
        }
        jet
    }

    pub fn variable(field: &PrimeField, variable: u32) -> Jet {
        Jet { terms: BTreeMap::from([(vec![(variable, 1)], field.one())]) }
    }

    /// The image of a polynomial with integer coefficients.
    pub fn of(field: &PrimeField, exact: &Exact) -> Jet {
        let terms = exact.terms.iter().map(|(m, c)| (m.clone(), field.integer(c)));
        Jet { terms: terms.filter(|(_, c)| *c != 0).collect() }
    }

    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// The number that it is, if it is one.
    pub fn as_constant(&self) -> Option<u64> {
        match self.terms.len() {
            0 => Some(0),
            1 => self.terms.get(&Monomial::new()).copied(),
            _ => None,
        }
    }

    pub fn variables(&self) -> std::collections::BTreeSet<u32> {
        self.terms.keys().flatten().map(|(variable, _)| *variable).collect()
    }

    pub fn degree(&self) -> u32 {
        self.terms.keys().map(|m| m.iter().map(|(_, n)| u32::from(*n)).sum()).max().unwrap_or(0)
    }

    pub fn add_term(&mut self, field: &PrimeField, monomial: Monomial, coefficient: u64) {
        use std::collections::btree_map::Entry;
        if coefficient == 0 {
            return;
        }
        match self.terms.entry(monomial) {
            Entry::Vacant(place) => {
                place.insert(coefficient);
            }
            Entry::Occupied(mut place) => {
                let sum = field.sum(*place.get(), coefficient);
                if sum == 0 {
                    place.remove();
                } else {
                    *place.get_mut() = sum;
                }
            }
        }
    }

    /// `self += factor * other`
    pub fn add_multiple(&mut self, field: &PrimeField, other: &Jet, factor: u64) {
        for (monomial, coefficient) in &other.terms {
            self.add_term(field, monomial.clone(), field.product(*coefficient, factor));
        }
    }

    /// `None` where a power is too high or the product too long.
    pub fn times(&self, field: &PrimeField, other: &Jet, most: usize) -> Option<Jet> {
        let mut product = Jet::default();
        for (left, a) in &self.terms {
            for (right, b) in &other.terms {
                product.add_term(field, times(left, right)?, field.product(*a, *b));
            }
            if product.terms.len() > most {
                return None;
            }
        }
        Some(product)
    }

    /// The derivative along time: each variable's next derivative is `next` of it, or zero.
    pub fn derivative(&self, field: &PrimeField, next: impl Fn(u32) -> Option<u32>) -> Option<Jet> {
        let mut sum = Jet::default();
        for (monomial, coefficient) in &self.terms {
            for (place, (variable, power)) in monomial.iter().enumerate() {
                let Some(next) = next(*variable) else { continue };
                let mut rest = monomial.clone();
                rest[place].1 -= 1;
                rest.retain(|(_, n)| *n > 0);
                let times_power = field.product(*coefficient, field.integer(&(*power).into()));
                sum.add_term(field, times(&rest, &[(next, 1)])?, times_power);
            }
        }
        Some(sum)
    }

    /// With values for some variables.
    pub fn with_values(&self, field: &PrimeField, value: impl Fn(u32) -> Option<u64>) -> Jet {
        let mut found = Jet::default();
        for (monomial, coefficient) in &self.terms {
            let (mut rest, mut factor) = (Monomial::new(), *coefficient);
            for (variable, power) in monomial {
                match value(*variable) {
                    Some(value) => {
                        for _ in 0..*power {
                            factor = field.product(factor, value);
                        }
                    }
                    None => rest.push((*variable, *power)),
                }
            }
            found.add_term(field, rest, factor);
        }
        found
    }

    /// Another polynomial in the place of a variable. `None` where it grows beyond `most` terms.
    pub fn substitute(&self, field: &PrimeField, variable: u32, by: &Jet, most: usize) -> Option<Jet> {
        let mut powers: Vec<Jet> = vec![Jet::constant(field.one())];
        let mut found = Jet::default();
        for (monomial, coefficient) in &self.terms {
            let power = monomial.iter().find(|(v, _)| *v == variable).map_or(0, |(_, n)| usize::from(*n));
            if power == 0 {
                found.add_term(field, monomial.clone(), *coefficient);
                continue;
            }
            let rest: Monomial = monomial.iter().copied().filter(|(v, _)| *v != variable).collect();
            while powers.len() <= power {
                let next = powers[powers.len() - 1].times(field, by, most)?;
                powers.push(next);
            }
            for (other, factor) in &powers[power].terms {
                found.add_term(field, times(&rest, other)?, field.product(*coefficient, *factor));
            }
            if found.terms.len() > most {
                return None;
            }
        }
        Some(found)
    }
}
