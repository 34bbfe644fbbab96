//! Exact values: rational combinations of products of pi, roots, angles and values of functions that have no shorter name.
//!
//! Zero in this form is zero for certain. What is not zero in this form may still be zero (`sin(1)^2 + cos(1)^2 - 1`), unless
//! it is rational: the checker then does not know.

use crate::number::{Arithmetic, Function, Rationals, Refusal};
use dashu::base::BitTest;
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use std::cell::Cell;
use std::collections::BTreeMap;

/// A number that is not known to be rational.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Atom {
    Pi,
    /// An angle of which sine and cosine are given, by its place among them.
    Angle(usize),
    /// The square root of an integer that is no square; at most one in each product.
    Root(UBig),
    /// The value of a function, which exists.
    Value(Function, Form),
}

impl Atom {
    /// Whether it is certainly not zero, so that it may be divided by.
    fn is_positive(&self) -> bool {
        matches!(self, Atom::Pi | Atom::Root(_) | Atom::Value(Function::Exp, _))
    }
}

/// Powers of atoms, multiplied.
type Product = BTreeMap<Atom, i32>;

/// A rational number plus rational multiples of products of atoms.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Form {
    rational: RBig,
    /// None of them with the empty product or the factor zero.
    rest: BTreeMap<Product, RBig>,
}

/// Sums have at most so many products, and products powers of at most so much.
const MOST_TERMS: usize = 256;
const LARGEST_POWER: i32 = 256;
/// Functions of functions nest no deeper.
const DEEPEST: usize = 16;
/// Multiples of an angle beyond this have no exact sine.
const LARGEST_MULTIPLE: i64 = 256;
/// Numerators and denominators are no longer, in bits.
const LONGEST: usize = 1 << 17;
/// All numbers of one evaluation together have no more bits.
const ROOM: usize = 1 << 30;

impl Form {
    /// The number, where it is rational.
    pub fn rational(&self) -> Option<&RBig> {
        self.rest.is_empty().then_some(&self.rational)
    }

    /// Whether it is zero for certain.
    pub fn is_zero(&self) -> bool {
        self.rest.is_empty() && self.rational.is_zero()
    }

    fn depth(&self) -> usize {
        let of = |atom: &Atom| match atom {
            Atom::Value(_, form) => 1 + form.depth(),
            _ => 1,
        };
        self.rest.keys().flat_map(BTreeMap::keys).map(of).max().unwrap_or(0)
    }
}

impl From<RBig> for Form {
    fn from(rational: RBig) -> Self {
        Form { rational, rest: BTreeMap::new() }
    }
}

/// Exact arithmetic at one state.
#[derive(Debug)]
pub struct Exact {
    numbers: Rationals,
    /// Sines and cosines of the angles that are given by them.
    circle: Vec<(RBig, RBig)>,
    room: Cell<usize>,
}

impl Exact {
    /// Arithmetic in which some angles are known by sine and cosine, whose squares add up to one.
    pub fn new(circle: Vec<(RBig, RBig)>) -> Self {
        Exact { numbers: Rationals { bits: LONGEST }, circle, room: Cell::new(ROOM) }
    }

    /// An angle by its place among those that are known by sine and cosine.
    pub fn angle(place: usize) -> Form {
        Exact::atom(Atom::Angle(place))
    }

    fn atom(atom: Atom) -> Form {
        Form { rational: RBig::ZERO, rest: BTreeMap::from([(Product::from([(atom, 1)]), RBig::ONE)]) }
    }

    /// A form that is not too long, its bits taken from what is left.
    fn kept(&self, form: Form) -> Result<Form, Refusal> {
        let length = |value: &RBig| value.numerator().bit_len() + value.denominator().bit_len();
        let bits = form.rest.values().map(length).sum::<usize>() + length(&form.rational) + 64;
        let left = self.room.get().checked_sub(bits).filter(|_| form.rest.len() <= MOST_TERMS);
        self.room.set(left.ok_or(Refusal::TooLarge)?);
        Ok(form)
    }

    /// `a + factor b`
    fn combine(&self, a: &Form, b: &Form, factor: &RBig) -> Result<Form, Refusal> {
        let part = |x: &RBig, y: &RBig| self.numbers.add(x, &self.numbers.mul(y, factor)?);
        let mut sum = Form { rational: part(&a.rational, &b.rational)?, rest: a.rest.clone() };
        for (product, value) in &b.rest {
            let entry = sum.rest.entry(product.clone()).or_insert(RBig::ZERO);
            *entry = part(entry, value)?;
        }
        sum.rest.retain(|_, value| !value.is_zero());
        self.kept(sum)
    }

    /// A product of two products: a factor, and what remains.
    fn join(&self, a: &Product, b: &Product) -> Result<(RBig, Product), Refusal> {
        let (mut product, mut root) = (Product::new(), UBig::ONE);
        for (atom, power) in a.iter().chain(b) {
            match atom {
                // sqrt(a) sqrt(b) = sqrt(a b)
                Atom::Root(inner) if *power == 1 => root *= inner,
                _ => *product.entry(atom.clone()).or_insert(0) += power,
            }
        }
        product.retain(|_, power| *power != 0);
        if product.values().any(|power| power.abs() > LARGEST_POWER) || root.bit_len() > LONGEST {
            return Err(Refusal::TooLarge);
        }
        let (outer, inner) = square_part(root);
        if !inner.is_one() {
            product.insert(Atom::Root(inner), 1);
        }
        Ok((RBig::from(outer), product))
    }

    /// One over a form that is a number times a product of positive atoms.
    fn reciprocal(&self, a: &Form) -> Result<Form, Refusal> {
        if let Some(value) = a.rational() {
            return Ok(Form::from(self.numbers.div(&RBig::ONE, value)?));
        }
        let mut terms = a.rest.iter();
        let (Some((product, value)), None, true) = (terms.next(), terms.next(), a.rational.is_zero()) else {
            return Err(Refusal::DivisorNotSeparated);
        };
        let mut factor = self.numbers.div(&RBig::ONE, value)?;
        let mut inverse = Product::new();
        for (atom, power) in product {
            match atom {
                // 1/sqrt(a) = sqrt(a)/a
                Atom::Root(inner) => {
                    factor = self.numbers.div(&factor, &RBig::from(inner.clone()))?;
                    inverse.insert(atom.clone(), 1);
                }
                _ if atom.is_positive() => {
                    inverse.insert(atom.clone(), -power);
                }
                _ => return Err(Refusal::DivisorNotSeparated),
            }
        }
        Ok(Form { rational: RBig::ZERO, rest: BTreeMap::from([(inverse, factor)]) })
    }

    /// Sine and cosine of whole multiples of known angles and of quarter turns, by the addition theorems.
    fn circular(&self, a: &Form) -> Option<Result<(RBig, RBig), Refusal>> {
        if !a.rational.is_zero() {
            return None;
        }
        let mut turns = Vec::new();
        for (product, value) in &a.rest {
            let mut atoms = product.iter();
            let (Some((atom, 1)), None) = (atoms.next(), atoms.next()) else { return None };
            let (unit, count) = match atom {
                Atom::Pi => ((RBig::ONE, RBig::ZERO), value * RBig::from(2)),
                Atom::Angle(place) => (self.circle.get(*place)?.clone(), value.clone()),
                _ => return None,
            };
            let whole = i64::try_from(IBig::clone(count.numerator())).ok()?;
            if !count.denominator().is_one() || whole.abs() > LARGEST_MULTIPLE {
                return None;
            }
            turns.push((unit, whole));
        }
        let mut total = (RBig::ZERO, RBig::ONE);
        for ((sine, cosine), count) in turns {
            let unit = if count < 0 { (-sine, cosine) } else { (sine, cosine) };
            for _ in 0..count.abs() {
                total = match self.turn(&total, &unit) {
                    Ok(total) => total,
                    Err(refusal) => return Some(Err(refusal)),
                };
            }
        }
        Some(Ok(total))
    }

    /// `sin(a+b) = sin a cos b + cos a sin b`, `cos(a+b) = cos a cos b - sin a sin b`
    fn turn(&self, a: &(RBig, RBig), b: &(RBig, RBig)) -> Result<(RBig, RBig), Refusal> {
        let q = &self.numbers;
        let sine = q.add(&q.mul(&a.0, &b.1)?, &q.mul(&a.1, &b.0)?)?;
        let cosine = q.sub(&q.mul(&a.1, &b.1)?, &q.mul(&a.0, &b.0)?)?;
        Ok((sine, cosine))
    }
}

/// An integer as a square times what remains; squares of greater primes than 100 are left in what remains, unless all of
/// it is a square.
fn square_part(mut inner: UBig) -> (UBig, UBig) {
    let mut outer = UBig::ONE;
    for prime in 2u8..100 {
        let square = UBig::from(u32::from(prime).pow(2));
        while (&inner % &square).is_zero() && !inner.is_zero() {
            inner /= &square;
            outer *= prime;
        }
    }
    let root = dashu::base::SquareRoot::sqrt(&inner);
    if &root * &root == inner { (outer * root, UBig::ONE) } else { (outer, inner) }
}

impl Arithmetic for Exact {
    type Number = Form;

    fn rational(&self, value: &RBig) -> Result<Form, Refusal> {
        self.kept(Form::from(value.clone()))
    }
    fn pi(&self) -> Result<Form, Refusal> {
        Ok(Exact::atom(Atom::Pi))
    }
    fn add(&self, a: &Form, b: &Form) -> Result<Form, Refusal> {
        self.combine(a, b, &RBig::ONE)
    }
    fn sub(&self, a: &Form, b: &Form) -> Result<Form, Refusal> {
        self.combine(a, b, &RBig::from(-1))
    }
    fn mul(&self, a: &Form, b: &Form) -> Result<Form, Refusal> {
        let q = &self.numbers;
        let mut product = Form::from(q.mul(&a.rational, &b.rational)?);
        for (form, factor) in [(a, &b.rational), (b, &a.rational)] {
            let scaled = Form { rational: RBig::ZERO, rest: form.rest.clone() };
            if !form.rest.is_empty() && !factor.is_zero() {
                product = self.combine(&product, &scaled, factor)?;
            }
        }
        for (first, x) in &a.rest {
            for (second, y) in &b.rest {
                let (outer, joined) = self.join(first, second)?;
                let value = q.mul(&q.mul(x, y)?, &outer)?;
                let term = if joined.is_empty() {
                    Form::from(value)
                } else {
                    Form { rational: RBig::ZERO, rest: BTreeMap::from([(joined, value)]) }
                };
                product = self.combine(&product, &term, &RBig::ONE)?;
            }
        }
        self.kept(product)
    }
    fn div(&self, a: &Form, b: &Form) -> Result<Form, Refusal> {
        self.mul(a, &self.reciprocal(b)?)
    }
    fn neg(&self, a: &Form) -> Result<Form, Refusal> {
        self.combine(&Form::default(), a, &RBig::from(-1))
    }

    fn apply(&self, function: Function, a: &Form) -> Result<Form, Refusal> {
        if let Some(value) = a.rational() {
            match self.numbers.apply(function, value) {
                Err(Refusal::NoExactValue(_)) => {}
                found => return self.kept(Form::from(found?)),
            }
            let beyond_one = value * value > RBig::ONE;
            match function {
                Function::Asin | Function::Acos if beyond_one => {
                    return Err(Refusal::OutsideDomain(function));
                }
                Function::Sqrt => {
                    // sqrt(n/d) = sqrt(n d)/d, and the root of what has no square in it
                    let top = UBig::try_from(value.numerator().clone());
                    let top = top.map_err(|_| Refusal::OutsideDomain(function))?;
                    let (outer, inner) = square_part(top * value.denominator());
                    let factor = RBig::from_parts(outer.into(), value.denominator().clone());
                    let root = Product::from([(Atom::Root(inner), 1)]);
                    return self.kept(Form { rational: RBig::ZERO, rest: BTreeMap::from([(root, factor)]) });
                }
                _ => return self.kept(Exact::atom(Atom::Value(function, a.clone()))),
            }
        }
        match function {
            // whether these exist is a question of sign, which a form does not answer
            Function::Sqrt | Function::Log | Function::Asin | Function::Acos => {
                return Err(Refusal::NoExactValue(function));
            }
            Function::Sin | Function::Cos => {
                if let Some(found) = self.circular(a) {
                    let (sine, cosine) = found?;
                    return self.kept(Form::from(if function == Function::Sin { sine } else { cosine }));
                }
            }
            Function::Atan | Function::Exp => {}
        }
        if a.depth() >= DEEPEST {
            return Err(Refusal::TooLarge);
        }
        self.kept(Exact::atom(Atom::Value(function, a.clone())))
    }

    /// `None` for a form that is not rational.
    fn is_zero(&self, a: &Form) -> Option<bool> {
        a.rational().map(RBig::is_zero)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(value: i64) -> Form {
        Form::from(RBig::from(value))
    }

    /// By hand: sqrt(2) sqrt(8) = 4, 1/sqrt(2) = sqrt(2)/2, (1 + sqrt(2)) (1 - sqrt(2)) = -1.
    #[test]
    fn roots_multiply_to_numbers() {
        let all = Exact::new(Vec::new());
        let root = |n| all.apply(Function::Sqrt, &number(n)).unwrap();
        assert_eq!(all.mul(&root(2), &root(8)).unwrap(), number(4));
        let half = all.div(&root(2), &number(2)).unwrap();
        assert_eq!(all.div(&number(1), &root(2)).unwrap(), half);
        let (plus, minus) = (all.add(&number(1), &root(2)).unwrap(), all.sub(&number(1), &root(2)).unwrap());
        assert_eq!(all.mul(&plus, &minus).unwrap(), number(-1));
        assert_eq!(all.power(&root(2), -4).unwrap(), Form::from(RBig::ONE / RBig::from(4)));
    }

    /// By hand: sin(2 a - pi/2) = -cos(2 a), and 3-4-5: cos(2 a) = (16 - 9)/25.
    #[test]
    fn angles_turn_by_the_addition_theorems() {
        let ratio = |n: i64, d: u64| RBig::from_parts(n.into(), d.into());
        let all = Exact::new(vec![(ratio(3, 5), ratio(4, 5))]);
        let twice = all.mul(&number(2), &Exact::angle(0)).unwrap();
        let quarter = all.div(&all.pi().unwrap(), &number(2)).unwrap();
        let argument = all.sub(&twice, &quarter).unwrap();
        assert_eq!(all.apply(Function::Sin, &argument).unwrap(), Form::from(ratio(-7, 25)));
        assert_eq!(all.apply(Function::Sin, &all.pi().unwrap()).unwrap(), number(0));
    }

    #[test]
    fn what_is_not_known_is_not_said() {
        let all = Exact::new(Vec::new());
        let (sine, cosine) =
            (all.apply(Function::Sin, &number(1)).unwrap(), all.apply(Function::Cos, &number(1)).unwrap());
        let square = |form: &Form| all.mul(form, form).unwrap();
        let one = all.add(&square(&sine), &square(&cosine)).unwrap();
        assert_eq!(all.is_zero(&all.sub(&one, &number(1)).unwrap()), None);
        assert_eq!(all.div(&number(1), &sine).unwrap_err(), Refusal::DivisorNotSeparated);
        assert!(all.sub(&sine, &all.apply(Function::Sin, &number(1)).unwrap()).unwrap().is_zero());
        for (function, outside) in [(Function::Asin, 2), (Function::Sqrt, -1), (Function::Log, 0)] {
            assert_eq!(all.apply(function, &number(outside)).unwrap_err(), Refusal::OutsideDomain(function));
        }
    }
}
