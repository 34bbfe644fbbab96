//! Polynomials with integer coefficients, as sorted lists of terms.

use super::super::doubt::{Effort, Missing};
use dashu::base::{Abs, BitTest, Gcd, Signed, SquareRoot};
use dashu::integer::{IBig, UBig};
use std::collections::{BTreeMap, HashMap};

/// A product of powers of variables: variables in their order, exponents from one on.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Monomial(Vec<(u32, u32)>);

/// Exponents are no greater: a sum of two of them is still far from the end of its type.
const LARGEST_EXPONENT: u32 = 1 << 16;
/// Polynomials have no more terms: so many take some tens of megabytes.
const MOST_TERMS: usize = 1 << 17;
/// Coefficients are no longer, in bits.
const LONGEST_COEFFICIENT: usize = 1 << 16;

impl Monomial {
    /// A power of one variable; the empty product where the exponent is zero.
    pub fn power(variable: u32, exponent: u32) -> Monomial {
        Monomial(if exponent == 0 { Vec::new() } else { vec![(variable, exponent)] })
    }

    /// The variables with their exponents.
    pub fn powers(&self) -> &[(u32, u32)] {
        &self.0
    }

    pub fn is_one(&self) -> bool {
        self.0.is_empty()
    }

    pub fn exponent(&self, variable: u32) -> u32 {
        self.0.binary_search_by_key(&variable, |power| power.0).map_or(0, |place| self.0[place].1)
    }

    /// Both factors joined by variable, exponents by `join`, which is shown zero where a factor lacks the variable.
    fn joined(&self, other: &Monomial, mut join: impl FnMut(u32, u32) -> u32) -> Monomial {
        let (mut left, mut right) = (self.0.iter().peekable(), other.0.iter().peekable());
        let mut powers = Vec::with_capacity(self.0.len() + other.0.len());
        loop {
            let variable = match (left.peek(), right.peek()) {
                (None, None) => return Monomial(powers),
                (Some(a), None) => a.0,
                (None, Some(b)) => b.0,
                (Some(a), Some(b)) => a.0.min(b.0),
            };
            let of = |powers: &mut std::iter::Peekable<std::slice::Iter<'_, (u32, u32)>>| {
                powers.next_if(|power| power.0 == variable).map_or(0, |power| power.1)
            };
            let exponent = join(of(&mut left), of(&mut right));
            if exponent > 0 {
                powers.push((variable, exponent));
            }
        }
    }

    pub fn times(&self, other: &Monomial) -> Monomial {
        self.joined(other, |a, b| a + b)
    }

    fn common(&self, other: &Monomial) -> Monomial {
        self.joined(other, u32::min)
    }

    /// The quotient, where the other one divides this one.
    pub fn over(&self, other: &Monomial) -> Option<Monomial> {
        let mut divides = true;
        let quotient = self.joined(other, |a, b| {
            divides &= a >= b;
            a.saturating_sub(b)
        });
        divides.then_some(quotient)
    }
}

/// A sum of monomials with coefficients that are not zero, sorted by monomial.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct IntegerPolynomial(Vec<(Monomial, IBig)>);

impl IntegerPolynomial {
    pub fn constant(value: IBig) -> IntegerPolynomial {
        IntegerPolynomial::term(Monomial::default(), value)
    }

    pub fn variable(variable: u32) -> IntegerPolynomial {
        IntegerPolynomial::term(Monomial::power(variable, 1), IBig::ONE)
    }

    pub fn term(monomial: Monomial, value: IBig) -> IntegerPolynomial {
        IntegerPolynomial(if value.is_zero() { Vec::new() } else { vec![(monomial, value)] })
    }

    pub fn terms(&self) -> &[(Monomial, IBig)] {
        &self.0
    }

    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// The number, where it is one.
    pub fn number(&self) -> Option<IBig> {
        match self.0.as_slice() {
            [] => Some(IBig::ZERO),
            [(monomial, value)] if monomial.is_one() => Some(value.clone()),
            _ => None,
        }
    }

    /// The common content of all terms, with the sign of the last one, and the rest: the greatest common divisor of the coefficients and of the monomials.
    pub fn content(mut self) -> (IBig, Monomial, IntegerPolynomial) {
        let Some((monomial, value)) = self.0.last() else {
            return (IBig::ZERO, Monomial::default(), self);
        };
        let (mut common, mut divisor) = (monomial.clone(), value.clone().abs());
        for (monomial, value) in &self.0 {
            common = common.common(monomial);
            if !divisor.is_one() {
                divisor = IBig::from(divisor.gcd(value));
            }
        }
        if value.is_negative() {
            divisor = -divisor;
        }
        if !divisor.is_one() {
            self.0.iter_mut().for_each(|term| term.1 = &term.1 / &divisor);
        }
        if !common.is_one() {
            // dividing by one monomial keeps the order of some terms and not of all
            self.0.iter_mut().for_each(|term| term.0 = term.0.over(&common).unwrap_or_default());
            self.0.sort_unstable_by(|a, b| a.0.cmp(&b.0));
        }
        (divisor, common, self)
    }

    /// The variables that it has.
    pub fn variables(&self) -> Vec<u32> {
        let all = self.terms().iter().flat_map(|(monomial, _)| monomial.powers());
        let mut variables: Vec<u32> = all.map(|(variable, _)| *variable).collect();
        variables.sort_unstable();
        variables.dedup();
        variables
    }

    /// The derivative by a variable, others kept.
    pub fn slope(&self, variable: u32) -> IntegerPolynomial {
        let mut sum = Sum::default();
        for (monomial, value) in self.terms() {
            let exponent = monomial.exponent(variable);
            if let Some(rest) = monomial.over(&Monomial::power(variable, 1)) {
                sum.add(rest, value * IBig::from(exponent));
            }
        }
        sum.finish()
    }

    /// The polynomials by which the powers of a variable are multiplied.
    pub fn parts(&self, variable: u32) -> BTreeMap<u32, IntegerPolynomial> {
        let mut parts: BTreeMap<u32, Sum> = BTreeMap::new();
        for (monomial, value) in &self.0 {
            let exponent = monomial.exponent(variable);
            if let Some(rest) = monomial.over(&Monomial::power(variable, exponent)) {
                parts.entry(exponent).or_default().add(rest, value.clone());
            }
        }
        parts.into_iter().map(|(exponent, sum)| (exponent, sum.finish())).collect()
    }

    /// The remainder when multiples of some polynomials are subtracted, as long as the greatest monomial of one divides the greatest
    /// that remains; up to a factor that is a number.
    ///
    /// # Errors
    /// Where it takes too much work.
    pub fn remainder(
        &self,
        divisors: &[IntegerPolynomial],
        effort: &Effort,
    ) -> Result<IntegerPolynomial, Missing> {
        let mut rest: BTreeMap<Graded, IBig> = self.0.iter().cloned().map(|(m, c)| (Graded(m), c)).collect();
        let mut left = Sum::default();
        let ends: Vec<_> =
            divisors.iter().filter_map(|by| Some((by, by.0.iter().max_by(by_degree)?))).collect();
        while let Some((Graded(monomial), value)) = rest.pop_last() {
            let found = ends.iter().find_map(|(by, end)| Some((by, end, monomial.over(&end.0)?)));
            let Some((by, end, factor)) = found else {
                left.add(monomial, value);
                // what cannot be divided is enough to know that the remainder is not zero
                break;
            };
            effort.spend((4 * by.0.len() + rest.len()) as u64)?;
            if !(&value % &end.1).is_zero() {
                rest.values_mut().for_each(|value| *value *= &end.1);
            }
            let value = if (&value % &end.1).is_zero() { value / &end.1 } else { value };
            for (other, times) in by.0.iter().filter(|term| !std::ptr::eq(*term, *end)) {
                let key = Graded(factor.times(other));
                let place = rest.entry(key.clone()).or_default();
                *place -= &value * times;
                if place.is_zero() {
                    rest.remove(&key);
                }
            }
        }
        Ok(left.finish())
    }

    /// The quotient of a division without a remainder, in the ring without relations.
    ///
    /// # Errors
    /// Where it takes too much work.
    pub fn over(
        &self,
        divisor: &IntegerPolynomial,
        effort: &Effort,
    ) -> Result<Option<IntegerPolynomial>, Missing> {
        let (Some(last), Some(first)) =
            (divisor.0.iter().max_by(by_degree), divisor.0.iter().min_by(by_degree))
        else {
            return Ok(None);
        };
        effort.spend((self.0.len() + divisor.0.len()) as u64 / 4)?;
        // the terms of the greatest and of the least monomial have to divide each other
        let ends = [(self.0.iter().max_by(by_degree), last), (self.0.iter().min_by(by_degree), first)];
        for (end, by) in ends {
            let Some(end) = end else { return Ok(Some(IntegerPolynomial::default())) };
            if end.0.over(&by.0).is_none() || !(&end.1 % &by.1).is_zero() {
                return Ok(None);
            }
        }
        let mut rest: BTreeMap<Graded, IBig> = self.0.iter().cloned().map(|(m, c)| (Graded(m), c)).collect();
        let mut quotient = Vec::new();
        while let Some((Graded(monomial), value)) = rest.pop_last() {
            let Some(monomial) = monomial.over(&last.0).filter(|_| (&value % &last.1).is_zero()) else {
                return Ok(None);
            };
            let value = value / &last.1;
            effort.spend(4 * divisor.0.len() as u64)?;
            for (other, by) in divisor.0.iter().filter(|term| !std::ptr::eq(*term, last)) {
                let place = rest.entry(Graded(monomial.times(other))).or_default();
                *place -= &value * by;
                if place.is_zero() {
                    rest.remove(&Graded(monomial.times(other)));
                }
            }
            quotient.push((monomial, value));
        }
        quotient.sort_unstable_by(|a, b| a.0.cmp(&b.0));
        Ok(Some(IntegerPolynomial(quotient)))
    }
}

/// An order that multiplication keeps: by degree, then by the variables.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Graded(Monomial);

impl Ord for Graded {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let degree = |of: &Monomial| of.0.iter().map(|power| power.1).sum::<u32>();
        degree(&self.0).cmp(&degree(&other.0)).then_with(|| {
            // the first variable in which the exponents differ
            for (a, b) in self.0.0.iter().zip(&other.0.0) {
                if a != b {
                    return b.0.cmp(&a.0).then(a.1.cmp(&b.1));
                }
            }
            self.0.0.len().cmp(&other.0.0.len())
        })
    }
}

impl PartialOrd for Graded {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

fn by_degree(a: &&(Monomial, IBig), b: &&(Monomial, IBig)) -> std::cmp::Ordering {
    Graded(a.0.clone()).cmp(&Graded(b.0.clone()))
}

/// Terms that are added up.
#[derive(Debug, Default)]
pub struct Sum(HashMap<Monomial, IBig>);

impl Sum {
    pub fn add(&mut self, monomial: Monomial, value: IBig) {
        *self.0.entry(monomial).or_default() += value;
    }

    pub fn finish(self) -> IntegerPolynomial {
        let mut terms: Vec<_> = self.0.into_iter().filter(|term| !term.1.is_zero()).collect();
        terms.sort_unstable_by(|a, b| a.0.cmp(&b.0));
        IntegerPolynomial(terms)
    }
}

/// What the squares of some variables are: polynomials in variables that came before them, or beside them.
#[derive(Debug, Default)]
pub struct Relations(Vec<Option<IntegerPolynomial>>);

impl Relations {
    /// A further variable.
    pub fn variable(&mut self, square: Option<IntegerPolynomial>) -> u32 {
        self.0.push(square);
        self.0.len() as u32 - 1
    }

    /// The product, with no square of a variable that has a relation.
    ///
    /// # Errors
    /// Where it takes too much work.
    pub fn times(
        &self,
        a: &IntegerPolynomial,
        b: &IntegerPolynomial,
        effort: &Effort,
    ) -> Result<IntegerPolynomial, Missing> {
        effort.spend(2 * (a.0.len() * b.0.len()) as u64)?;
        let mut sum = Sum::default();
        for (first, by) in &a.0 {
            for (second, value) in &b.0 {
                self.collect(&mut sum, first.times(second), by * value, effort)?;
            }
            if sum.0.len() > MOST_TERMS {
                return Err(Missing::Effort);
            }
        }
        Ok(sum.finish())
    }

    /// Adds a term, with squares put in.
    fn collect(
        &self,
        sum: &mut Sum,
        monomial: Monomial,
        value: IBig,
        effort: &Effort,
    ) -> Result<(), Missing> {
        let bits = value.bit_len();
        if bits > LONGEST_COEFFICIENT {
            return Err(Missing::Effort);
        }
        if bits > 256 {
            effort.spend(bits as u64 / 64)?;
        }
        let mut open = vec![(monomial, value)];
        while let Some((monomial, value)) = open.pop() {
            if monomial.0.iter().any(|power| power.1 > LARGEST_EXPONENT) {
                return Err(Missing::Effort);
            }
            let square = monomial.0.iter().find_map(|(variable, exponent)| {
                self.0[*variable as usize]
                    .as_ref()
                    .filter(|_| *exponent > 1)
                    .map(|square| (*variable, square))
            });
            let Some((variable, square)) = square else {
                sum.add(monomial, value);
                continue;
            };
            let left = monomial.over(&Monomial::power(variable, 2)).unwrap_or_default();
            effort.spend(2 * square.0.len() as u64)?;
            open.extend(square.0.iter().map(|(factor, by)| (left.times(factor), &value * by)));
        }
        Ok(())
    }
}

/// The largest square that divides a positive number, by its root, and the primes that remain; of a number with a large factor that factor stands for a prime.
pub fn square_part(value: &UBig) -> (UBig, Vec<UBig>) {
    let (mut root, mut primes, mut rest) = (UBig::ONE, Vec::new(), value.clone());
    let mut divisor = 2u32;
    while divisor < 1000 && !rest.is_one() {
        let prime = UBig::from(divisor);
        let mut times = 0u32;
        while (&rest % &prime).is_zero() {
            rest = &rest / &prime;
            times += 1;
        }
        root *= prime.pow((times / 2) as usize);
        if times % 2 == 1 {
            primes.push(prime);
        }
        divisor += 1;
    }
    if !rest.is_one() {
        let whole = rest.sqrt();
        if &whole * &whole == rest { root *= whole } else { primes.push(rest) }
    }
    (root, primes)
}
