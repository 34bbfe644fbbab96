//! Sines and cosines, and the functions that undo them.

use super::form::{Form, as_variable};
use super::generators::{Key, Measure};
use super::signs::CONSTANT_BITS;
use super::{Adjunction, Halt};
use crate::expression::NodeId;
use crate::expression::angle::add_multiple;
use crate::number::{Arithmetic, Enclosures, Function, Turn};
use dashu::integer::IBig;
use dashu::rational::RBig;

/// Multiples of an angle beyond this are left alone.
const LARGEST_MULTIPLE: i64 = 1 << 12;
/// Values of inverse functions are looked for among the multiples of pi over numbers up to this.
const MOST_PARTS: u64 = 240;

impl Adjunction<'_> {
    /// Sine and cosine of a form: of each of its terms, by the addition theorems.
    pub(super) fn circular(&mut self, form: &Form) -> Result<(NodeId, NodeId), Halt> {
        let mut total = (self.graph.integer(0), self.graph.integer(1));
        let pi = self.pi();
        for (monomial, factor) in &form.0 {
            let key = as_variable(monomial).map(|variable| self.generators.key(variable).clone());
            let halves = factor * RBig::from(2);
            let (unit, count) = match key {
                _ if pi.0.contains_key(monomial) => {
                    let turns = factor / RBig::from(2);
                    let cosine = self.cosine_of_turns(&turns)?;
                    let quarter = RBig::from_parts(1.into(), 4u8.into());
                    ((self.cosine_of_turns(&(turns - quarter))?, cosine), 1)
                }
                Some(Key::Value(function, inner)) if halves.denominator().is_one() => {
                    let whole = self.circular_of_value(function, &inner)?;
                    match factor.denominator().is_one() {
                        true => (whole, count_of(factor)?),
                        false => (self.half_of_principal(whole)?, count_of(&halves)?),
                    }
                }
                _ => {
                    let count = self.multiple(Measure::Angle, monomial, factor)?;
                    let sine = self.variable(Key::Sine(monomial.clone()));
                    ((self.node_of(sine), self.node_of(sine + 1)), count)
                }
            };
            if count.abs() > LARGEST_MULTIPLE {
                return Err(Halt::Stop(format!("an angle is met {} times", count.abs())));
            }
            total = add_multiple(self.graph, total, unit, count);
        }
        Ok(total)
    }

    /// Pi as a form: where roots of it are met it is a power.
    pub(super) fn pi(&mut self) -> Form {
        let node = self.node_of_key(Key::Pi);
        self.form(node).unwrap_or_default()
    }

    /// The cosine of some turns.
    fn cosine_of_turns(&mut self, turns: &RBig) -> Result<NodeId, Halt> {
        let turns = turns - RBig::from(turns.floor());
        let parts = u64::try_from(turns.denominator().clone()).unwrap_or(u64::MAX);
        let place = u64::try_from(turns.numerator().clone()).unwrap_or(0);
        // half of a + b sqrt(prime) where that is all, so that a turn is not divided for it
        let small = match (parts, place.min(parts - place)) {
            (1, _) => Some((2, 0, 1)),
            (2, _) => Some((-2, 0, 1)),
            (3, _) => Some((-1, 0, 1)),
            (4, _) => Some((0, 0, 1)),
            (6, _) => Some((1, 0, 1)),
            (8, place) => Some((0, if place == 1 { 1 } else { -1 }, 2)),
            (12, place) => Some((0, if place == 1 { 1 } else { -1 }, 3)),
            _ => None,
        };
        let half = RBig::from_parts(1.into(), 2u8.into());
        let two = self.graph.integer(2);
        if let Some((whole, times, prime)) = small {
            let mut form = self.graph.integer(whole);
            if times != 0 {
                let root = self.power_of_number(&RBig::from(prime), &half)?;
                let times = self.graph.integer(times);
                let root = self.graph.mul(times, root);
                form = self.graph.add(form, root);
            }
            return Ok(self.graph.div(form, two));
        }
        let known = self.generators.turn.parts;
        if !known.is_multiple_of(parts) {
            let finer = common_multiple(common_multiple(known, parts), 4);
            let finer = finer.and_then(Turn::new);
            let too_many = || Halt::Stop(format!("a sine or cosine is met of a multiple of 2*pi/{parts}"));
            self.generators.turn = finer.ok_or_else(too_many)?;
            return Err(Halt::Again);
        }
        let twice = self.generators.turn.twice_cosine(place * (known / parts));
        let node = self.in_turn(&twice);
        Ok(self.graph.div(node, two))
    }

    /// Sine and cosine of an inverse sine or an inverse tangent; the cosine is not negative.
    fn circular_of_value(&mut self, function: Function, inner: &Form) -> Result<(NodeId, NodeId), Halt> {
        let too_long = || Halt::Stop("the argument of an inverse function is too long".into());
        let square = self.times(inner, inner).ok_or_else(too_long)?;
        let one = Form::constant(RBig::ONE);
        let sine = self.node_of_form(inner);
        if function == Function::Asin {
            let rest = one.plus(&square, &RBig::from(-1)).ok_or_else(too_long)?;
            return Ok((sine, self.root(&rest)?));
        }
        let sum = one.plus(&square, &RBig::ONE).ok_or_else(too_long)?;
        let root = self.root(&sum)?;
        let cosine = self.graph.power(root, -1);
        Ok((self.graph.mul(sine, cosine), cosine))
    }

    /// Sine and cosine of half of what lies between minus and plus a quarter turn: `cos(v/2) = sqrt((1 + cos v)/2)`, `sin(v/2)
    /// = sin v/(2 cos(v/2))`.
    fn half_of_principal(&mut self, (sine, cosine): (NodeId, NodeId)) -> Result<(NodeId, NodeId), Halt> {
        let (one, two) = (self.graph.integer(1), self.graph.integer(2));
        let sum = self.graph.add(one, cosine);
        let square = self.graph.div(sum, two);
        let too_long = || Halt::Stop("half of an inverse function's value is too long".into());
        let form = self.form(square).ok_or_else(too_long)?;
        let root = self.root(&form)?;
        let double = self.graph.mul(two, root);
        Ok((self.graph.div(sine, double), root))
    }

    /// The value of an inverse function: `acos u = pi/2 - asin u`, odd ones of what has a positive leading factor, and of some
    /// constants a multiple of pi.
    pub(super) fn inverse(&mut self, function: Function, form: &Form) -> Result<NodeId, Halt> {
        if function == Function::Acos {
            let pi = self.node_of_key(Key::Pi);
            let two = self.graph.integer(2);
            let quarter = self.graph.div(pi, two);
            let value = self.inverse(Function::Asin, form)?;
            return Ok(self.graph.sub(quarter, value));
        }
        let Some((content, _)) = form.primitive() else { return Ok(self.graph.integer(0)) };
        if content < RBig::ZERO {
            let value = self.inverse(function, &form.scaled(&RBig::from(-1)))?;
            return Ok(self.graph.neg(value));
        }
        if let Some(factor) = self.multiple_of_pi(function, form)? {
            let pi = self.node_of_key(Key::Pi);
            let factor = self.graph.rational(factor);
            return Ok(self.graph.mul(factor, pi));
        }
        Ok(self.node_of_key(Key::Value(function, form.clone())))
    }

    /// The multiple of pi that an inverse function of a constant is: guessed from an enclosure, and shown.
    fn multiple_of_pi(&mut self, function: Function, form: &Form) -> Result<Option<RBig>, Halt> {
        if let Some(known) = self.multiples.get(&(function, form.clone())) {
            return Ok(known.clone());
        }
        let numbers = Enclosures::new(CONSTANT_BITS);
        let ratio = self.enclosed(form, CONSTANT_BITS).and_then(|value| {
            let edge = form.as_constant().is_none();
            let value = match numbers.apply(function, &value) {
                // an irrational way to write one
                Err(_) if edge && function == Function::Asin => {
                    let top = numbers.rational(&RBig::ONE)?;
                    numbers.apply(function, &top)
                }
                other => other,
            }?;
            numbers.div(&value, &numbers.pi()?)
        });
        let Ok(ratio) = ratio else { return Ok(None) };
        let guess = match ratio.low() == ratio.high() {
            true => ratio.low(),
            false => RBig::simplest_in(ratio.low(), ratio.high()),
        };
        let short = u64::try_from(guess.denominator().clone()).is_ok_and(|parts| parts <= MOST_PARTS);
        let half = RBig::from_parts(1.into(), 2u8.into());
        let mut found = None;
        if short && guess <= half && guess >= -half {
            let angle = self.pi().scaled(&guess);
            match self.circular(&angle) {
                Err(Halt::Again) => return Err(Halt::Again),
                Err(Halt::Stop(_)) => {}
                Ok((sine, cosine)) => {
                    let mut value = self.node_of_form(form);
                    if function == Function::Atan {
                        value = self.graph.mul(value, cosine);
                    }
                    let difference = self.graph.sub(sine, value);
                    if self.is_zero(&[difference]) {
                        found = Some(guess);
                    }
                }
            }
        }
        self.multiples.insert((function, form.clone()), found.clone());
        Ok(found)
    }
}

fn count_of(factor: &RBig) -> Result<i64, Halt> {
    i64::try_from(IBig::clone(factor.numerator()))
        .map_err(|_| Halt::Stop("an angle's factor is too large".into()))
}

fn common_multiple(a: impl Into<Option<u64>>, b: u64) -> Option<u64> {
    let a = a.into()?;
    let (mut x, mut y) = (a, b);
    while y > 0 {
        (x, y) = (y, x % y);
    }
    (a / x).checked_mul(b)
}
