//! A random point modulo a random prime, and the values of a listing there.

use super::super::listing::{Listing, Step};
use super::form::{FunctionArgument, FunctionForms};
use dashu::base::UnsignedAbs;
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_math::number::Function;
use rand::{Rng, RngExt};
use std::collections::HashMap;

/// So many bits a point tells: primes are drawn between `2^60` and `2^61`, and there are more than `2^54` of them.
pub const BITS_OF_PRIMES: f64 = 55.0;
const LOWEST: u64 = 1 << 60;

/// Why a listing has no values at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointError {
    /// A divisor vanishes there.
    Pole,
    /// It refers to what is not there.
    Listing,
}

/// Values at a point, by place.
pub struct RandomPoint {
    prime: u64,
    values: HashMap<usize, u64>,
}

/// The functions that are variables of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Drawn {
    Tangent,
    Exponential,
    Logarithm,
    Arctangent,
}

/// A point as it is drawn.
struct Drawing<'d, R> {
    prime: u64,
    rng: &'d mut R,
    symbols: HashMap<&'d str, u64>,
    /// Functions by the values of their arguments: equal arguments have equal functions.
    functions: HashMap<(Drawn, u64), u64>,
    pi: Option<u64>,
}

impl RandomPoint {
    /// Draws a prime, and a value for everything that is free.
    pub fn draw(
        listing: &Listing,
        forms: &FunctionForms,
        rng: &mut impl Rng,
    ) -> Result<RandomPoint, PointError> {
        let prime = prime(rng);
        let mut drawing =
            Drawing { prime, rng, symbols: HashMap::new(), functions: HashMap::new(), pi: None };
        let mut values: HashMap<usize, u64> = HashMap::with_capacity(forms.order.len());
        for place in &forms.order {
            let at = |operand: &usize| values.get(operand).copied().ok_or(PointError::Listing);
            let step = listing.steps().get(*place).ok_or(PointError::Listing)?;
            let value = match step {
                Step::Constant(number) => residue(number, prime)?,
                Step::Pi => drawing.pi(),
                Step::Symbol(name) => match forms.given.get(place) {
                    Some(by) => at(by)?,
                    None => drawing.symbol(name),
                },
                Step::Add(a, b) => add(at(a)?, at(b)?, prime),
                Step::Sub(a, b) => add(at(a)?, prime - at(b)?, prime),
                Step::Mul(a, b) => mul(at(a)?, at(b)?, prime),
                Step::Div(a, b) => mul(at(a)?, inverse(at(b)?, prime)?, prime),
                Step::Neg(a) => add(0, prime - at(a)?, prime),
                Step::Power(a, n) => {
                    let power = pow(at(a)?, u64::from(n.unsigned_abs()), prime);
                    if *n < 0 { inverse(power, prime)? } else { power }
                }
                Step::Apply(Function::Log, a) => drawing.function(Drawn::Logarithm, at(a)?),
                Step::Apply(Function::Atan, a) => drawing.function(Drawn::Arctangent, at(a)?),
                Step::Apply(function, _) => {
                    let argument = forms.arguments.get(place).ok_or(PointError::Listing)?;
                    let terms = argument.terms.iter().map(|(term, multiple)| Ok((at(term)?, *multiple)));
                    let mut terms = terms.collect::<Result<Vec<(u64, i64)>, PointError>>()?;
                    if argument.number != 0 {
                        terms.push((1, argument.number));
                    }
                    match function {
                        Function::Exp => drawing.exponential(&terms)?,
                        Function::Sin => drawing.turn(&terms, argument)?.1,
                        Function::Cos => drawing.turn(&terms, argument)?.0,
                        _ => return Err(PointError::Listing),
                    }
                }
            };
            values.insert(*place, value);
        }
        Ok(RandomPoint { prime, values })
    }

    /// The value of an operation that was asked for.
    pub fn value(&self, place: usize) -> Option<u64> {
        self.values.get(&place).copied()
    }

    /// The rank of rows.
    pub fn rank(&self, rows: &[Vec<usize>]) -> usize {
        let p = self.prime;
        let mut basis: Vec<(usize, Vec<u64>)> = Vec::new();
        for row in rows {
            let Some(mut row) = row.iter().map(|place| self.value(*place)).collect::<Option<Vec<u64>>>()
            else {
                return usize::MAX;
            };
            for (column, other) in &basis {
                let factor = row[*column];
                if factor != 0 {
                    for (entry, known) in row.iter_mut().zip(other) {
                        *entry = add(*entry, p - mul(factor, *known, p), p);
                    }
                }
            }
            let Some(column) = row.iter().position(|entry| *entry != 0) else { continue };
            let Ok(scale) = inverse(row[column], p) else { return usize::MAX };
            row.iter_mut().for_each(|entry| *entry = mul(*entry, scale, p));
            basis.push((column, row));
        }
        basis.len()
    }
}

impl<'d, R: Rng> Drawing<'d, R> {
    fn symbol(&mut self, name: &'d str) -> u64 {
        let (prime, rng) = (self.prime, &mut *self.rng);
        *self.symbols.entry(name).or_insert_with(|| rng.random_range(0..prime))
    }

    fn pi(&mut self) -> u64 {
        let (prime, rng) = (self.prime, &mut *self.rng);
        *self.pi.get_or_insert_with(|| rng.random_range(0..prime))
    }

    fn function(&mut self, function: Drawn, argument: u64) -> u64 {
        let (prime, rng) = (self.prime, &mut *self.rng);
        *self.functions.entry((function, argument)).or_insert_with(|| rng.random_range(0..prime))
    }

    /// The exponential of a sum of multiples of parts.
    fn exponential(&mut self, terms: &[(u64, i64)]) -> Result<u64, PointError> {
        let mut product = 1;
        for (argument, multiple) in terms {
            let base = self.function(Drawn::Exponential, *argument);
            let base = if *multiple < 0 { inverse(base, self.prime)? } else { base };
            product = mul(product, pow(base, multiple.unsigned_abs(), self.prime), self.prime);
        }
        Ok(product)
    }

    /// Cosine and sine of a sum of multiples of parts and of quarter turns.
    fn turn(&mut self, terms: &[(u64, i64)], argument: &FunctionArgument) -> Result<(u64, u64), PointError> {
        let p = self.prime;
        let mut total = (1, 0);
        let turned = |a: (u64, u64), b: (u64, u64)| {
            let cosine = add(mul(a.0, b.0, p), p - mul(a.1, b.1, p), p);
            (cosine, add(mul(a.0, b.1, p), mul(a.1, b.0, p), p))
        };
        for (angle, multiple) in terms {
            // of the half of a part
            let tangent = self.function(Drawn::Tangent, *angle);
            let square = mul(tangent, tangent, p);
            let below = inverse(add(1, square, p), p)?;
            let sine = mul(add(tangent, tangent, p), below, p);
            let sine = if *multiple < 0 { add(0, p - sine, p) } else { sine };
            let part = (mul(add(1, p - square, p), below, p), sine);
            for _ in 0..multiple.unsigned_abs() {
                total = turned(total, part);
            }
        }
        for _ in 0..argument.quarters {
            total = turned(total, (0, 1));
        }
        Ok(total)
    }
}

fn add(a: u64, b: u64, p: u64) -> u64 {
    ((u128::from(a) + u128::from(b)) % u128::from(p)) as u64
}

fn mul(a: u64, b: u64, p: u64) -> u64 {
    (u128::from(a) * u128::from(b) % u128::from(p)) as u64
}

fn pow(a: u64, mut n: u64, p: u64) -> u64 {
    let (mut result, mut square) = (1, a);
    while n > 0 {
        if n & 1 == 1 {
            result = mul(result, square, p);
        }
        square = mul(square, square, p);
        n >>= 1;
    }
    result
}

/// By Fermat's theorem.
fn inverse(a: u64, p: u64) -> Result<u64, PointError> {
    if a.is_multiple_of(p) { Err(PointError::Pole) } else { Ok(pow(a, p - 2, p)) }
}

fn residue(number: &RBig, p: u64) -> Result<u64, PointError> {
    let whole = |n: IBig| -> Result<u64, PointError> {
        let rest: IBig = ((n % IBig::from(p)) + IBig::from(p)) % IBig::from(p);
        u64::try_from(rest.unsigned_abs()).map_err(|_| PointError::Listing)
    };
    let below = whole(IBig::from(number.denominator().clone()))?;
    Ok(mul(whole(number.numerator().clone())?, inverse(below, p)?, p))
}

/// A prime, each as likely as the others.
fn prime(rng: &mut impl Rng) -> u64 {
    loop {
        let candidate = rng.random_range(LOWEST..2 * LOWEST) | 1;
        if is_prime(candidate) {
            return candidate;
        }
    }
}

/// Miller and Rabin's test, with the bases that decide it below `2^64` (J. Sorenson, J. Webster, Strong pseudoprimes to twelve prime bases, 2017).
pub(super) fn is_prime(n: u64) -> bool {
    const BASES: [u64; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];
    if n < 2 || BASES.iter().any(|prime| n != *prime && n.is_multiple_of(*prime)) {
        return false;
    }
    let (odd, twos) = ((n - 1) >> (n - 1).trailing_zeros(), (n - 1).trailing_zeros());
    BASES.iter().all(|base| {
        let mut power = pow(base % n, odd, n);
        (power <= 1 || power == n - 1)
            || (1..twos).any(|_| {
                power = mul(power, power, n);
                power == n - 1
            })
    })
}
