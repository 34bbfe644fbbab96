//! Fractions of products, as an [`Arithmetic`]: what a rational expression is over its common denominator, without
//! multiplying out more than each sum needs.
//!
//! Over [`Polynomial`](super::polynomial::Polynomial) this is the expansion that a computer-algebra system performs;
//! over [`Size`](super::polynomial::Size) it bounds the degree and the coefficients of the numerator that such an
//! expansion would have, in no time.

use super::polynomial::Ring;
use super::{Arithmetic, Function, Refusal};
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_budget as budget;
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};

/// A product of powers of factors, by their places in a table.
pub type Factors = BTreeMap<u32, u32>;

/// One product above another; no factor in both.
#[derive(Clone, Debug, Default)]
pub struct Fraction {
    /// What stands above.
    pub top: Factors,
    /// What stands below.
    pub bottom: Factors,
}

/// Fractions whose factors are elements of a ring.
pub struct Fractions<R> {
    table: RefCell<Vec<R>>,
    products: RefCell<HashMap<Factors, R>>,
    normal: Box<dyn Fn(R) -> R>,
}

impl<R: Ring> Default for Fractions<R> {
    fn default() -> Self {
        Fractions::with_normal_form(|value| value)
    }
}

impl<R: Ring> Fractions<R> {
    /// Fractions over a ring with relations: `normal` brings what was multiplied out to its normal form.
    pub fn with_normal_form(normal: impl Fn(R) -> R + 'static) -> Self {
        Fractions { table: RefCell::default(), products: RefCell::default(), normal: Box::new(normal) }
    }

    /// An element of the ring as a fraction.
    pub fn element(&self, value: R) -> Fraction {
        Fraction { top: Factors::from([(self.place(value), 1)]), bottom: Factors::new() }
    }

    /// The factor at a place of the table.
    pub fn factor(&self, place: u32) -> R {
        self.table.borrow()[place as usize].clone()
    }

    fn place(&self, value: R) -> u32 {
        let mut table = self.table.borrow_mut();
        // most of them differ in their first terms
        budget::steps(table.len() / 8);
        if let Some(known) = table.iter().position(|other| other.is_same(&value)) {
            return known as u32;
        }
        table.push(value);
        table.len() as u32 - 1
    }

    /// A product of factors, multiplied out.
    pub fn expand(&self, factors: &Factors) -> Result<R, Refusal> {
        if let Some(known) = self.products.borrow().get(factors) {
            return Ok(known.clone());
        }
        let mut product = R::integer(&IBig::ONE);
        for (place, power) in factors {
            let (mut square, mut rest) = (self.factor(*place), *power);
            while rest > 0 {
                if rest & 1 == 1 {
                    product = (self.normal)(product.mul(&square).ok_or(Refusal::TooLarge)?);
                }
                rest >>= 1;
                if rest > 0 {
                    square = (self.normal)(square.mul(&square).ok_or(Refusal::TooLarge)?);
                }
            }
        }
        self.products.borrow_mut().insert(factors.clone(), product.clone());
        Ok(product)
    }

    fn reduced(mut top: Factors, mut bottom: Factors) -> Fraction {
        // each of them was looked at several times until here
        budget::steps(16 * (1 + top.len() + bottom.len()));
        let common = meet(&top, &bottom);
        remove(&mut top, &common);
        remove(&mut bottom, &common);
        Fraction { top, bottom }
    }
}

/// The greatest product that divides both.
fn meet(a: &Factors, b: &Factors) -> Factors {
    a.iter().filter_map(|(f, n)| b.get(f).map(|m| (*f, *n.min(m)))).collect()
}

fn remove(from: &mut Factors, what: &Factors) {
    for (factor, power) in what {
        if let Some(n) = from.get_mut(factor) {
            *n -= power;
        }
    }
    from.retain(|_, n| *n > 0);
}

fn join(a: &Factors, b: &Factors) -> Option<Factors> {
    let mut product = a.clone();
    for (factor, power) in b {
        let n = product.entry(*factor).or_insert(0);
        *n = n.checked_add(*power)?;
    }
    Some(product)
}

impl<R: Ring> Arithmetic for Fractions<R> {
    type Number = Fraction;

    fn rational(&self, value: &RBig) -> Result<Fraction, Refusal> {
        let mut fraction = Fraction::default();
        if !value.is_one() {
            fraction = self.element(R::integer(value.numerator()));
        }
        if !value.denominator().is_one() {
            fraction.bottom.insert(self.place(R::integer(&IBig::from(value.denominator().clone()))), 1);
        }
        Ok(fraction)
    }
    fn pi(&self) -> Result<Fraction, Refusal> {
        Err(Refusal::NoExactPi)
    }
    fn add(&self, a: &Fraction, b: &Fraction) -> Result<Fraction, Refusal> {
        // what both have above the bar stays in front; below it stands the least common multiple
        let front = meet(&a.top, &b.top);
        let shared = meet(&a.bottom, &b.bottom);
        let over = |own: &Fraction, other: &Fraction| -> Result<R, Refusal> {
            let (mut top, mut missing) = (own.top.clone(), other.bottom.clone());
            remove(&mut top, &front);
            remove(&mut missing, &shared);
            self.expand(&join(&top, &missing).ok_or(Refusal::TooLarge)?)
        };
        let sum = over(a, b)?.add(&over(b, a)?);
        let mut missing = b.bottom.clone();
        remove(&mut missing, &shared);
        let bottom = join(&a.bottom, &missing).ok_or(Refusal::TooLarge)?;
        let top = join(&front, &self.element(sum).top).ok_or(Refusal::TooLarge)?;
        Ok(Self::reduced(top, bottom))
    }
    fn sub(&self, a: &Fraction, b: &Fraction) -> Result<Fraction, Refusal> {
        self.add(a, &self.neg(b)?)
    }
    fn mul(&self, a: &Fraction, b: &Fraction) -> Result<Fraction, Refusal> {
        let top = join(&a.top, &b.top).ok_or(Refusal::TooLarge)?;
        let bottom = join(&a.bottom, &b.bottom).ok_or(Refusal::TooLarge)?;
        Ok(Self::reduced(top, bottom))
    }
    fn div(&self, a: &Fraction, b: &Fraction) -> Result<Fraction, Refusal> {
        if self.is_zero(b) == Some(true) {
            return Err(Refusal::DivisionByZero);
        }
        self.mul(a, &Fraction { top: b.bottom.clone(), bottom: b.top.clone() })
    }
    fn neg(&self, a: &Fraction) -> Result<Fraction, Refusal> {
        // the sign goes into one factor, so that the others can still cancel
        let minus = self.place(R::integer(&-IBig::ONE));
        let mut top = a.top.clone();
        match top.remove(&minus) {
            Some(n) if n % 2 == 1 => {}
            _ => {
                top.insert(minus, 1);
            }
        }
        Ok(Fraction { top, bottom: a.bottom.clone() })
    }
    fn apply(&self, function: Function, _: &Fraction) -> Result<Fraction, Refusal> {
        Err(Refusal::NoExactValue(function))
    }
    fn is_zero(&self, a: &Fraction) -> Option<bool> {
        let table = self.table.borrow();
        a.top.keys().any(|place| table[*place as usize].is_zero()).then_some(true)
    }
    fn power(&self, a: &Fraction, n: i32) -> Result<Fraction, Refusal> {
        let raise = |factors: &Factors| -> Result<Factors, Refusal> {
            let times = |p: &u32| p.checked_mul(n.unsigned_abs()).ok_or(Refusal::TooLarge);
            factors.iter().filter(|_| n != 0).map(|(f, p)| Ok((*f, times(p)?))).collect()
        };
        let (top, bottom) = (raise(&a.top)?, raise(&a.bottom)?);
        Ok(if n < 0 { Fraction { top: bottom, bottom: top } } else { Fraction { top, bottom } })
    }
}

#[cfg(test)]
mod tests {
    use super::super::polynomial::{Polynomial, Size};
    use super::*;

    /// `1/(x - y) - 1/(x + y) = 2y / ((x - y)(x + y))`
    #[test]
    fn a_sum_stands_over_the_common_denominator() {
        let all = Fractions::<Polynomial>::default();
        let (x, y) = (all.element(Polynomial::variable(0)), all.element(Polynomial::variable(1)));
        let one = all.rational(&RBig::ONE).unwrap();
        let (minus, plus) = (all.sub(&x, &y).unwrap(), all.add(&x, &y).unwrap());
        let value = all.sub(&all.div(&one, &minus).unwrap(), &all.div(&one, &plus).unwrap()).unwrap();
        let two = Polynomial::integer(&IBig::from(2));
        assert_eq!(Some(all.expand(&value.top).unwrap()), Polynomial::variable(1).mul(&two));
        assert_eq!(value.bottom.len(), 2);
    }

    /// The same degree as by hand: the numerator of `x^3/(x - y) + y` has degree 3.
    #[test]
    fn the_degree_is_bounded_without_expanding() {
        let all = Fractions::<Size>::default();
        let variable = || all.element(Size { degree: 1.0, bits: 0.0 });
        let (x, y) = (variable(), variable());
        let quotient = all.div(&all.power(&x, 3).unwrap(), &all.sub(&x, &y).unwrap()).unwrap();
        let sum = all.add(&quotient, &y).unwrap();
        assert_eq!(all.expand(&sum.top).unwrap().degree, 3.0);
    }
}
