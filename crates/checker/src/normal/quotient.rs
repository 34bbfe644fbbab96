//! Quotients of products of polynomials: factors stay separate, so that they cancel without a greatest common divisor.

use super::super::doubt::{Effort, Missing};
use super::polynomial::{IntegerPolynomial, Relations, Sum};
use dashu::base::Gcd;
use dashu::integer::IBig;
use dashu::rational::RBig;
use std::collections::{BTreeMap, HashMap};

/// A number times powers of factors, which are known by their numbers in a [`QuotientField`]; zero where the number is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quotient {
    pub number: RBig,
    pub powers: BTreeMap<u32, i32>,
}

impl From<RBig> for Quotient {
    fn from(number: RBig) -> Self {
        Quotient { number, powers: BTreeMap::new() }
    }
}

impl Quotient {
    pub fn is_zero(&self) -> bool {
        self.number.is_zero()
    }

    pub fn neg(&self) -> Quotient {
        Quotient { number: -self.number.clone(), powers: self.powers.clone() }
    }
}

/// No power of a factor is greater.
const LARGEST_POWER: i32 = 1 << 12;

/// The arithmetic of quotients: variables with their relations, and the factors that were met.
#[derive(Debug)]
pub struct QuotientField<'e> {
    pub relations: Relations,
    factors: Vec<IntegerPolynomial>,
    known: HashMap<IntegerPolynomial, u32>,
    /// The squares of factors that are roots.
    squares: HashMap<u32, Quotient>,
    pub effort: &'e Effort,
}

impl<'e> QuotientField<'e> {
    pub fn new(effort: &'e Effort) -> Self {
        let (factors, known, squares) = (Vec::new(), HashMap::new(), HashMap::new());
        QuotientField { relations: Relations::default(), factors, known, squares, effort }
    }

    /// Puts the square of a variable that is a root in the place of its powers.
    pub fn is_root(&mut self, variable: u32, square: IntegerPolynomial) {
        let number = self.number_of(IntegerPolynomial::variable(variable));
        let square = self.quotient(square);
        self.squares.insert(number, square);
    }

    pub fn variable(&mut self, square: Option<IntegerPolynomial>) -> u32 {
        self.relations.variable(square)
    }

    pub fn factor(&self, number: u32) -> &IntegerPolynomial {
        &self.factors[number as usize]
    }

    fn number_of(&mut self, factor: IntegerPolynomial) -> u32 {
        if let Some(known) = self.known.get(&factor) {
            return *known;
        }
        let number = self.factors.len() as u32;
        self.factors.push(factor.clone());
        self.known.insert(factor, number);
        number
    }

    /// A polynomial, its content and the powers of variables that divide it separated.
    pub fn quotient(&mut self, polynomial: IntegerPolynomial) -> Quotient {
        if let Some(number) = polynomial.number() {
            return Quotient::from(RBig::from(number));
        }
        let (number, common, rest) = polynomial.content();
        let mut powers = BTreeMap::new();
        for (variable, exponent) in common.powers() {
            powers.insert(self.number_of(IntegerPolynomial::variable(*variable)), *exponent as i32);
        }
        let is_one = rest.number().is_some();
        if !is_one {
            let number = self.number_of(rest);
            *powers.entry(number).or_default() += 1;
        }
        Quotient { number: RBig::from(number), powers }
    }

    /// The product.
    ///
    /// # Errors
    /// Where a power becomes too great.
    pub fn times(&self, a: &Quotient, b: &Quotient) -> Result<Quotient, Missing> {
        self.effort.spend(4 + (a.powers.len() + b.powers.len()) as u64 / 4)?;
        if a.is_zero() || b.is_zero() {
            return Ok(Quotient::from(RBig::ZERO));
        }
        let (mut powers, more) = if a.powers.len() < b.powers.len() {
            (b.powers.clone(), &a.powers)
        } else {
            (a.powers.clone(), &b.powers)
        };
        for (factor, exponent) in more {
            let power = powers.entry(*factor).or_default();
            *power += exponent;
            match *power {
                0 => drop(powers.remove(factor)),
                power if power.abs() > LARGEST_POWER => return Err(Missing::Effort),
                _ => {}
            }
        }
        let mut product = Quotient { number: &a.number * &b.number, powers };
        while let Some((root, power)) = self.reducible(&product) {
            let pairs = power.div_euclid(2);
            product.powers.remove(&root);
            if power - 2 * pairs == 1 {
                product.powers.insert(root, 1);
            }
            let square = self.power(&self.squares[&root], pairs)?.ok_or(Missing::Effort)?;
            product = self.times(&product, &square)?;
        }
        Ok(product)
    }

    fn reducible(&self, quotient: &Quotient) -> Option<(u32, i32)> {
        if self.squares.is_empty() {
            return None;
        }
        let mut powers = quotient.powers.iter().map(|(factor, power)| (*factor, *power));
        powers.find(|(factor, power)| !(0..=1).contains(power) && self.squares.contains_key(factor))
    }

    /// A power; `None` for a negative one of zero.
    ///
    /// # Errors
    /// Where a power becomes too great.
    pub fn power(&self, base: &Quotient, exponent: i32) -> Result<Option<Quotient>, Missing> {
        if exponent == 0 {
            return Ok(Some(Quotient::from(RBig::ONE)));
        }
        if base.is_zero() {
            return Ok((exponent > 0).then(|| base.clone()));
        }
        if exponent.abs() > LARGEST_POWER {
            return Err(Missing::Effort);
        }
        let mut powers = BTreeMap::new();
        for (factor, power) in &base.powers {
            let power = power.checked_mul(exponent).filter(|power| power.abs() <= LARGEST_POWER);
            powers.insert(*factor, power.ok_or(Missing::Effort)?);
        }
        let number = base.number.clone().pow(exponent.unsigned_abs() as isize);
        Ok(Some(Quotient { number: if exponent < 0 { RBig::ONE / number } else { number }, powers }))
    }

    /// The product of the factors with positive powers, or with negative ones, multiplied out.
    ///
    /// # Errors
    /// Where it takes too much work.
    pub fn expanded(&self, powers: &BTreeMap<u32, i32>, sign: i32) -> Result<IntegerPolynomial, Missing> {
        let mut product = IntegerPolynomial::constant(IBig::ONE);
        let mut wanted: Vec<(&IntegerPolynomial, u32)> = powers
            .iter()
            .filter(|(_, power)| power.signum() == sign)
            .map(|(factor, power)| (self.factor(*factor), power.unsigned_abs()))
            .collect();
        // short ones first
        wanted.sort_by_key(|(factor, _)| factor.terms().len());
        for (factor, power) in wanted {
            for _ in 0..power {
                product = self.relations.times(&product, factor, self.effort)?;
            }
        }
        Ok(product)
    }

    /// The sum: what all terms have in common stands before it, the rest is multiplied out.
    ///
    /// # Errors
    /// Where it takes too much work.
    pub fn sum(&mut self, terms: &[Quotient]) -> Result<Quotient, Missing> {
        let terms: Vec<&Quotient> = terms.iter().filter(|term| !term.is_zero()).collect();
        match terms.as_slice() {
            [] => return Ok(Quotient::from(RBig::ZERO)),
            [one] => return Ok((*one).clone()),
            _ => {}
        }
        self.effort.spend(terms.iter().map(|term| term.powers.len() as u64).sum::<u64>() / 4)?;
        let common = common(&terms);
        let mut denominator = IBig::ONE;
        for term in &terms {
            let below = IBig::from(term.number.denominator().clone());
            let shared = IBig::from(denominator.clone().gcd(&below));
            denominator *= below / shared;
        }
        let mut sum = Sum::default();
        for term in terms {
            let part = self.without(term, &common)?;
            let scale = term.number.numerator().clone()
                * (&denominator / IBig::from(term.number.denominator().clone()));
            self.effort.spend(2 * part.terms().len() as u64)?;
            for (monomial, value) in part.terms() {
                sum.add(monomial.clone(), value * &scale);
            }
        }
        let mut found = self.quotient(sum.finish());
        if found.is_zero() {
            return Ok(found);
        }
        found.number /= RBig::from(denominator);
        let common = common.into_iter().filter(|(_, power)| *power != 0).collect();
        self.cancelled(self.times(&found, &Quotient { number: RBig::ONE, powers: common })?)
    }

    /// Quotients without what they have in common: a number and a polynomial each.
    ///
    /// # Errors
    /// Where it takes too much work.
    pub fn above(&self, terms: &[&Quotient]) -> Result<Vec<(RBig, IntegerPolynomial)>, Missing> {
        let present: Vec<&Quotient> = terms.iter().copied().filter(|term| !term.is_zero()).collect();
        let common = common(&present);
        let one = |term: &&Quotient| match term.is_zero() {
            true => Ok((RBig::ZERO, IntegerPolynomial::default())),
            false => Ok((term.number.clone(), self.without(term, &common)?)),
        };
        terms.iter().map(one).collect()
    }

    /// The factors of a term over those that all terms have, multiplied out.
    fn without(&self, term: &Quotient, common: &BTreeMap<u32, i32>) -> Result<IntegerPolynomial, Missing> {
        let mut powers = term.powers.clone();
        for (factor, least) in common {
            *powers.entry(*factor).or_insert(0) -= least;
        }
        self.expanded(&powers, 1)
    }

    /// Factors below the bar that divide a factor above it are taken out of both.
    ///
    /// # Errors
    /// Where it takes too much work.
    pub fn cancelled(&mut self, mut quotient: Quotient) -> Result<Quotient, Missing> {
        let of_sign = |quotient: &Quotient, sign: i32| -> Vec<u32> {
            quotient.powers.iter().filter(|(_, power)| power.signum() == sign).map(|(f, _)| *f).collect()
        };
        for below in of_sign(&quotient, -1) {
            if self.factor(below).terms().len() < 2 {
                // powers of variables are separate already
                continue;
            }
            for above in of_sign(&quotient, 1) {
                if self.factor(above).terms().len() < 2 {
                    continue;
                }
                while quotient.powers.contains_key(&above) && quotient.powers.contains_key(&below) {
                    let divided = self.factor(above).over(self.factor(below), self.effort)?;
                    let Some(divided) = divided else { break };
                    let mut by = self.quotient(divided);
                    by.powers.entry(below).and_modify(|power| *power += 1).or_insert(1);
                    // one power of the factor above becomes the factor below times the rest
                    let mut rest = quotient.clone();
                    let power = rest.powers.entry(above).or_default();
                    *power -= 1;
                    if *power == 0 {
                        rest.powers.remove(&above);
                    }
                    by.powers.retain(|_, power| *power != 0);
                    quotient = self.times(&rest, &by)?;
                }
            }
        }
        Ok(quotient)
    }
}

/// The least power of each factor.
fn common(terms: &[&Quotient]) -> BTreeMap<u32, i32> {
    let mut common: BTreeMap<u32, i32> = BTreeMap::new();
    for (place, term) in terms.iter().enumerate() {
        for (factor, power) in common.iter_mut() {
            *power = (*power).min(term.powers.get(factor).copied().unwrap_or(0));
        }
        for (factor, power) in &term.powers {
            // what came before has none of it
            let before = if place == 0 { *power } else { 0 };
            let least = common.entry(*factor).or_insert(before);
            *least = (*least).min(*power);
        }
    }
    common
}
