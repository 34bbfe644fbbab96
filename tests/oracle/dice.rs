//! Random numbers and random expressions, the same for the same seed and case on every machine.

use super::expression::{Binary, Expression, Function, Symbol};
use super::number::Number;
use super::point::{Coordinate, Point};
use super::system::Model;
use dashu::rational::RBig;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A source of random things.
pub struct Dice(ChaCha8Rng);

impl Dice {
    /// Those of one case.
    pub fn new(seed: u64, case: u64) -> Dice {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(case);
        Dice(rng)
    }

    /// From zero to `n - 1`.
    pub fn below(&mut self, n: usize) -> usize {
        self.0.random_range(0..n.max(1))
    }

    /// From `low` to `high`, both included.
    pub fn between(&mut self, low: i64, high: i64) -> i64 {
        self.0.random_range(low..=high)
    }

    /// Once in `n` times.
    pub fn once_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    /// One of some things, of which there has to be one.
    pub fn one_of<T: Clone>(&mut self, things: &[T]) -> T {
        things[self.below(things.len())].clone()
    }

    /// A small integer that is not zero.
    pub fn factor(&mut self) -> i64 {
        self.one_of(&[1, 1, 1, 2, 3, 5, -1, -1, -2, -3])
    }

    /// A short rational, hardly ever on a special set: short, since series multiply what they are given.
    pub fn generic(&mut self) -> RBig {
        let top = self.between(3, 43) * self.one_of(&[1i64, -1]);
        RBig::from(top) / RBig::from(self.one_of(&[1i64, 1, 2, 7]))
    }

    /// A positive one.
    pub fn positive(&mut self) -> RBig {
        RBig::from(self.between(1, 43)) / RBig::from(self.one_of(&[2i64, 3, 7]))
    }

    /// A rational at which something may happen.
    pub fn special(&mut self) -> RBig {
        match self.below(8) {
            0..=3 => RBig::ZERO,
            4 => RBig::ONE,
            5 => RBig::from(-1),
            6 => RBig::from(2),
            _ => RBig::from(1) / RBig::from(2),
        }
    }

    /// A state at which nothing is special; plain numbers positive now and then, for roots and logarithms.
    pub fn generic_point(&mut self, model: &Model) -> Point {
        let positive = self.once_in(2);
        let mut point = Point::default();
        for name in model.symbols() {
            let number = if positive { self.positive() } else { self.generic() };
            let coordinate = if model.angles.contains(&name) {
                Coordinate::from_half_tangent(&number)
            } else {
                Coordinate::Number(Number::Rational(number))
            };
            point.put(name, coordinate);
        }
        point
    }

    /// A monomial of degree at most `degree` with a small coefficient.
    pub fn monomial(&mut self, symbols: &[Symbol], degree: usize) -> Expression {
        let mut found = Expression::integer(self.factor());
        for _ in 0..self.below(degree + 1) {
            let name = self.one_of(symbols);
            let factor = Expression::Symbol(name);
            found = match self.below(4) {
                0 => found.times(factor.power(2)),
                _ => found.times(factor),
            };
        }
        found
    }

    /// A polynomial of at most `terms` terms.
    pub fn polynomial(&mut self, symbols: &[Symbol], degree: usize, terms: usize) -> Expression {
        let mut found = self.monomial(symbols, degree);
        for _ in 1..1 + self.below(terms) {
            let term = self.monomial(symbols, degree);
            found = if self.once_in(2) { found.plus(term) } else { found.minus(term) };
        }
        found
    }

    /// A divisor: a symbol, a sum that vanishes somewhere, or one that never does.
    pub fn divisor(&mut self, symbols: &[Symbol]) -> Expression {
        let one = Expression::integer(1);
        let first = Expression::Symbol(self.one_of(symbols));
        let second = Expression::Symbol(self.one_of(symbols));
        match self.below(6) {
            0 => first,
            1 => first.minus(one),
            2 => one.plus(first.power(2)),
            3 => first.plus(second.times(Expression::integer(2))),
            4 => first.power(2).minus(second.plus(one)),
            _ => self.polynomial(symbols, 2, 3).plus(Expression::integer(3)),
        }
    }

    /// A sine or cosine of an integer combination of angles.
    pub fn wave(&mut self, angles: &[Symbol]) -> Expression {
        let name = self.one_of(angles);
        let first = Expression::Symbol(name);
        let other = Expression::Symbol(self.one_of(angles));
        let inner = match self.below(5) {
            0 if angles.len() > 1 => first.minus(other),
            1 if angles.len() > 1 => first.plus(other),
            2 => Expression::integer(2).times(first),
            _ => first,
        };
        let function = self.one_of(&[Function::Sin, Function::Cos]);
        inner.of(function)
    }

    /// An expression of plain symbols with functions, that exists on a good part of all states.
    pub fn transcendental(&mut self, symbols: &[Symbol]) -> Expression {
        let which = self.below(16);
        self.of_functions(symbols, which)
    }

    /// The same of one formula on all states: a rank may be another one where an extreme is another one.
    pub fn of_one_part(&mut self, symbols: &[Symbol]) -> Expression {
        // and tanh is flat to more digits than the oracle has
        let which = self.one_of(&[0, 1, 2, 3, 4, 5, 6, 7, 13, 15]);
        self.of_functions(symbols, which)
    }

    fn of_functions(&mut self, symbols: &[Symbol], which: usize) -> Expression {
        let inner = Expression::Symbol(self.one_of(symbols));
        let other = self.polynomial(symbols, 1, 2);
        match which {
            8 => other.of(Function::Tanh),
            9 => inner.of(Function::Abs).plus(other),
            10 => inner.with_other(Binary::Max, other),
            11 => inner.with_other(Binary::Min, other),
            12 => inner.with_other(Binary::Atan2, other),
            13 => inner.with_other(Binary::RealPower, Expression::Symbol(self.one_of(symbols))),
            14 => inner.with_other(Binary::RealPower, Expression::Number(RBig::from(1) / RBig::from(3))),
            15 => inner.of(Function::Sinh),
            0 => inner.of(Function::Exp),
            1 => inner.of(Function::Log),
            2 => inner.of(Function::Sqrt),
            3 => inner.of(Function::Sin),
            4 => other.of(Function::Atan),
            5 => inner.power(2).plus(Expression::integer(1)).of(Function::Sqrt),
            6 => other.of(Function::Cos),
            _ => inner.of(Function::Tan),
        }
    }
}
