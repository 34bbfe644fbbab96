//! Exact values: rational combinations of products of pi, roots, angles and values of functions that have no shorter name.
//!
//! Zero in this form is zero for certain. What is not zero in this form may still be zero (`exp(1)^2 - exp(2)`), unless it is
//! rational: the checker then does not know. Twelfths of pi, inverse sines and cosines, and squares of sines have their rule.

use dashu::base::BitTest;
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use palmistry_math::number::{Arithmetic, Function, Rationals, Refusal};
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

/// Sine and cosine.
type Circular = Result<(Form, Form), Refusal>;

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

    /// The work of an operation that makes it: the square of its length in machine words.
    pub fn work(&self) -> u64 {
        std::iter::once(&self.rational).chain(self.rest.values()).map(work_on).sum()
    }

    fn scaled(&self, factor: &RBig) -> Form {
        let rest = self.rest.iter().map(|(product, value)| (product.clone(), value * factor)).collect();
        Form { rational: &self.rational * factor, rest }
    }

    fn depth(&self) -> usize {
        let of = |atom: &Atom| match atom {
            Atom::Value(_, form) => 1 + form.depth(),
            _ => 1,
        };
        self.rest.keys().flat_map(BTreeMap::keys).map(of).max().unwrap_or(0)
    }
}

/// The work of an operation on fractions that makes this one.
pub fn work_on(value: &RBig) -> u64 {
    let words = (value.numerator().bit_len() + value.denominator().bit_len()) as u64 / 64;
    words * words
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

    /// A form that is not too long, its bits taken from the remaining room.
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

    /// Sine and cosine of sums of whole multiples of known angles and of some parts of a turn, by the addition theorems.
    fn circular(&self, a: &Form) -> Option<Circular> {
        if !a.rational.is_zero() {
            return None;
        }
        let mut turns = Vec::new();
        for (product, value) in &a.rest {
            let mut atoms = product.iter();
            let (Some((atom, 1)), None) = (atoms.next(), atoms.next()) else { return None };
            let (unit, count) = match atom {
                Atom::Pi => (self.part_of_turn(value)?, RBig::ONE),
                Atom::Angle(place) => {
                    let (sine, cosine) = self.circle.get(*place)?.clone();
                    (Ok((Form::from(sine), Form::from(cosine))), value.clone())
                }
                Atom::Value(function @ (Function::Asin | Function::Acos), inner) => {
                    (self.undone(*function, inner), value.clone())
                }
                _ => return None,
            };
            let whole = i64::try_from(IBig::clone(count.numerator())).ok()?;
            if !count.denominator().is_one() || whole.abs() > LARGEST_MULTIPLE {
                return None;
            }
            turns.push((unit, whole));
        }
        Some(self.turned(turns))
    }

    fn turned(&self, turns: Vec<(Circular, i64)>) -> Circular {
        let mut total = (Form::default(), Form::from(RBig::ONE));
        for (unit, count) in turns {
            let (sine, cosine) = unit?;
            let unit = if count < 0 { (self.neg(&sine)?, cosine) } else { (sine, cosine) };
            for _ in 0..count.abs() {
                total = self.turn(&total, &unit)?;
            }
        }
        Ok(total)
    }

    /// `sin(a+b) = sin a cos b + cos a sin b`, `cos(a+b) = cos a cos b - sin a sin b`
    fn turn(&self, a: &(Form, Form), b: &(Form, Form)) -> Circular {
        let sine = self.add(&self.mul(&a.0, &b.1)?, &self.mul(&a.1, &b.0)?)?;
        let cosine = self.sub(&self.mul(&a.1, &b.1)?, &self.mul(&a.0, &b.0)?)?;
        Ok((sine, cosine))
    }

    /// Sine and cosine of a multiple of pi that is a sum of quarters, thirds and eighths of a turn.
    fn part_of_turn(&self, times_pi: &RBig) -> Option<Circular> {
        let parts = times_pi * RBig::from(12);
        if !parts.denominator().is_one() {
            return None;
        }
        // in twelfths of pi: whole turns are nothing
        let twenty_four = IBig::from(24);
        let place = ((parts.numerator() % &twenty_four) + &twenty_four) % &twenty_four;
        let place = i64::try_from(place).ok()?;
        // three of them are an eighth of a turn and four a sixth: of the first as many as make the rest a multiple of four
        let eighths = (-place).rem_euclid(4);
        let sixths = (place - 3 * eighths) / 4;
        let half = RBig::ONE / RBig::from(2);
        let of_root = |n: i64| Ok(self.apply(Function::Sqrt, &Form::from(RBig::from(n)))?.scaled(&half));
        let units =
            || Ok::<_, Refusal>([(of_root(2)?, of_root(2)?), (of_root(3)?, Form::from(half.clone()))]);
        Some(
            units().and_then(|[eighth, sixth]| self.turned(vec![(Ok(eighth), eighths), (Ok(sixth), sixths)])),
        )
    }

    /// Sine and cosine of an inverse sine or cosine, which exists: one is the argument `u`, the other `sqrt(1 - u^2)`.
    fn undone(&self, function: Function, u: &Form) -> Circular {
        let rest = self.sub(&Form::from(RBig::ONE), &self.mul(u, u)?)?;
        let other = self.apply(Function::Sqrt, &rest)?;
        Ok(if function == Function::Asin { (u.clone(), other) } else { (other, u.clone()) })
    }

    /// The form with `sin^2 = 1 - cos^2` put in.
    fn without_squares_of_sines(&self, form: Form) -> Result<Form, Refusal> {
        let is_sine = |atom: &Atom| matches!(atom, Atom::Value(Function::Sin, _));
        let mut done = form;
        for _ in 0..MOST_TERMS {
            let square = |product: &Product| {
                product.iter().find(|(atom, n)| is_sine(atom) && **n >= 2).map(|(a, _)| a.clone())
            };
            let Some((product, atom)) = done.rest.keys().find_map(|p| Some((p.clone(), square(p)?))) else {
                return Ok(done);
            };
            let Some(value) = done.rest.remove(&product) else { return Ok(done) };
            let Atom::Value(_, argument) = &atom else { return Ok(done) };
            let mut rest = product;
            rest.entry(atom.clone()).and_modify(|n| *n -= 2);
            rest.retain(|_, n| *n != 0);
            let (_, with_cosine) =
                self.join(&rest, &Product::from([(Atom::Value(Function::Cos, argument.clone()), 2)]))?;
            let one = |product: Product| match product.is_empty() {
                true => Form::from(RBig::ONE),
                false => Form { rational: RBig::ZERO, rest: BTreeMap::from([(product, RBig::ONE)]) },
            };
            done = self.combine(&done, &one(rest), &value)?;
            done = self.combine(&done, &one(with_cosine), &-value)?;
        }
        Err(Refusal::TooLarge)
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
        self.kept(self.without_squares_of_sines(product)?)
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
                    return self.kept(if function == Function::Sin { sine } else { cosine });
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

    /// By hand: all twelfths of pi as a calculator has them; cos(2 acos(1/3)) = 2/9 - 1.
    #[test]
    fn parts_of_a_turn_and_inverse_functions_have_sines() {
        let all = Exact::new(Vec::new());
        let pi = all.pi().unwrap();
        for twelfths in -30..30i64 {
            let angle = all.div(&all.mul(&pi, &number(twelfths)).unwrap(), &number(12)).unwrap();
            for (function, expected) in
                [(Function::Sin, f64::sin as fn(f64) -> f64), (Function::Cos, f64::cos as fn(f64) -> f64)]
            {
                let form = all.apply(function, &angle).unwrap();
                let root = |n: &UBig| n.to_f64().value().sqrt();
                let term = |(product, value): (&Product, &RBig)| {
                    let roots = product.keys().map(|atom| match atom {
                        Atom::Root(inner) => root(inner),
                        other => panic!("{other:?}"),
                    });
                    value.to_f64().value() * roots.product::<f64>()
                };
                let near = form.rational.to_f64().value() + form.rest.iter().map(term).sum::<f64>();
                let angle = twelfths as f64 * std::f64::consts::PI / 12.0;
                assert!((near - expected(angle)).abs() < 1e-12, "{function:?} of {twelfths}");
            }
        }
        let third = all.div(&number(1), &number(3)).unwrap();
        let angle = all.apply(Function::Acos, &third).unwrap();
        let twice = all.mul(&number(2), &angle).unwrap();
        let cosine = all.apply(Function::Cos, &twice).unwrap();
        assert_eq!(cosine, Form::from(RBig::from_parts((-7).into(), 9u8.into())));
    }

    #[test]
    fn what_is_not_known_is_not_said() {
        let all = Exact::new(Vec::new());
        let (sine, cosine) =
            (all.apply(Function::Sin, &number(1)).unwrap(), all.apply(Function::Cos, &number(1)).unwrap());
        let square = |form: &Form| all.mul(form, form).unwrap();
        let one = all.add(&square(&sine), &square(&cosine)).unwrap();
        assert_eq!(one, number(1));
        let e = |n: i64| all.apply(Function::Exp, &number(n)).unwrap();
        assert_eq!(all.is_zero(&all.sub(&square(&e(1)), &e(2)).unwrap()), None);
        assert_eq!(all.div(&number(1), &sine).unwrap_err(), Refusal::DivisorNotSeparated);
        assert!(all.sub(&sine, &all.apply(Function::Sin, &number(1)).unwrap()).unwrap().is_zero());
        for (function, outside) in [(Function::Asin, 2), (Function::Sqrt, -1), (Function::Log, 0)] {
            assert_eq!(all.apply(function, &number(outside)).unwrap_err(), Refusal::OutsideDomain(function));
        }
    }
}
