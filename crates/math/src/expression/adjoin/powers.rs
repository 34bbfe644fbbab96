//! Exponentials, logarithms and roots.
//!
//! Wherever `u = q b_1^e_1 ... b_n^e_n` is positive, `log(u)` is `log |q| + e_1 log |b_1| + ...`, and where it is not negative,
//! `sqrt(u)` is `sqrt |q| |b_1|^(e_1/2) ...`: absolute values need no sign. A sign is needed only to say that `|b|` is `b`
//! or `-b`; those bases that have none are left together in one root.

use super::form::{Form, Monomial, as_variable};
use super::generators::{Key, Measure};
use super::signs::Factored;
use super::{Adjunction, Halt};
use crate::expression::NodeId;
use crate::number::Function;
use dashu::base::{RemEuclid, SquareRoot, UnsignedAbs};
use dashu::integer::UBig;
use dashu::rational::RBig;
use std::collections::BTreeMap;

/// Integers are split into primes up to this.
const LARGEST_PRIME: u32 = 1 << 14;

impl Adjunction<'_> {
    /// The exponential of a form.
    pub(super) fn exponential(&mut self, form: &Form) -> Result<NodeId, Halt> {
        let mut product = self.graph.integer(1);
        for (monomial, factor) in &form.0 {
            let logarithm = as_variable(monomial).map(|variable| self.generators.key(variable).clone());
            let power = match logarithm {
                Some(Key::Log(base)) => self.absolute_power(&base, factor)?,
                _ => self.exponential_of(monomial, factor)?,
            };
            product = self.graph.mul(product, power);
        }
        Ok(product)
    }

    fn exponential_of(&mut self, monomial: &Monomial, factor: &RBig) -> Result<NodeId, Halt> {
        let count = self.multiple(Measure::Exponent, monomial, factor)?;
        let count = i32::try_from(count).map_err(|_| Halt::Stop("an exponent is too large".into()))?;
        let base = self.node_of_key(Key::Exp(monomial.clone()));
        Ok(self.graph.power(base, count))
    }

    /// The logarithm of a form that is positive.
    pub(super) fn logarithm(&mut self, form: &Form) -> Option<NodeId> {
        let Factored { unit, bases } = self.factored(form)?;
        let mut sum = self.logarithm_of_number(&unit);
        for (base, power) in bases {
            let logarithm = self.logarithm_of_base(&base)?;
            let power = self.graph.integer(i64::from(power));
            let term = self.graph.mul(power, logarithm);
            sum = self.graph.add(sum, term);
        }
        Some(sum)
    }

    fn logarithm_of_number(&mut self, number: &RBig) -> NodeId {
        let mut sum = self.graph.integer(0);
        for (prime, power) in primes(number) {
            let logarithm = self.node_of_key(Key::Log(Form::constant(RBig::from(prime))));
            let power = self.graph.integer(i64::from(power));
            let term = self.graph.mul(power, logarithm);
            sum = self.graph.add(sum, term);
        }
        sum
    }

    /// `log |base|`
    fn logarithm_of_base(&mut self, base: &Form) -> Option<NodeId> {
        let key = base.as_variable().map(|variable| self.generators.key(variable).clone());
        let (inner, parts) = match key {
            Some(Key::Exp(monomial)) => {
                let parts = self.generators.divisors.get(&(Measure::Exponent, monomial.clone()));
                let parts = RBig::from(parts.copied().unwrap_or(1));
                let exponent = self.node_of_monomial(&monomial);
                let parts = self.graph.rational(parts);
                return Some(self.graph.div(exponent, parts));
            }
            Some(Key::Root(inner)) => (inner, 2),
            Some(Key::Abs(inner)) => (inner, 1),
            Some(Key::Power(inner, parts)) => (inner, i64::from(parts)),
            _ => return Some(self.node_of_key(Key::Log(base.clone()))),
        };
        let logarithm = self.logarithm(&inner)?;
        let parts = self.graph.integer(parts);
        Some(self.graph.div(logarithm, parts))
    }

    /// The square root of a form that is not negative.
    pub(super) fn root(&mut self, form: &Form) -> Result<NodeId, Halt> {
        if form.is_zero() {
            return Ok(self.graph.integer(0));
        }
        if let Some(root) = self.root_of_constant(form)? {
            return Ok(root);
        }
        let too_long = || Halt::Stop("what a root is taken of is too long".into());
        let Factored { unit, bases } = self.factored(form).ok_or_else(too_long)?;
        let half = RBig::from_parts(1.into(), 2u8.into());
        let mut product = self.power_of_number(&unit, &half)?;
        let (mut upward, one) = (unit >= RBig::ZERO, Form::constant(RBig::ONE));
        // what has no sign of its own: under the root, and whole before it
        let (mut below, mut before, mut absolute) = (one.clone(), one, Vec::new());
        for (base, power) in bases {
            let sign = self.sign(&base);
            match sign {
                Some(sign) => upward = upward == (sign || power % 2 == 0),
                None if power % 2 != 0 => below = self.times(&below, &base).ok_or_else(too_long)?,
                None => {}
            }
            let whole = power.div_euclid(2);
            if sign.is_some() {
                let part = self.absolute_power(&base, &(RBig::from(power) * &half))?;
                product = self.graph.mul(product, part);
            } else {
                // an odd power is an even one times the magnitude
                let even = self.node_of_form(&base);
                let even = self.graph.power(even, whole - whole.rem_euclid(2));
                product = self.graph.mul(product, even);
                if whole % 2 != 0 {
                    before = self.times(&before, &base).ok_or_else(too_long)?;
                    absolute.push(base);
                }
            }
        }
        if !absolute.is_empty() {
            // of all of them together the sign may be known: from what is assumed, or since the root exists
            let sign = if before == below { Some(upward) } else { self.sign_of_multiple(&before) };
            let part = match sign {
                Some(sign) => {
                    let node = self.node_of_form(&before);
                    if sign { node } else { self.graph.neg(node) }
                }
                None => {
                    let mut magnitudes = self.graph.integer(1);
                    for base in absolute {
                        let magnitude = self.absolute_power(&base, &RBig::ONE)?;
                        magnitudes = self.graph.mul(magnitudes, magnitude);
                    }
                    magnitudes
                }
            };
            product = self.graph.mul(product, part);
        }
        if below.as_constant().is_none() {
            let known = if upward { below } else { below.scaled(&RBig::from(-1)) };
            let root = match self.root_taken_apart(&known)? {
                Some(root) => root,
                None => self.node_of_key(Key::Root(known)),
            };
            product = self.graph.mul(product, root);
        }
        Ok(product)
    }

    /// `sqrt(a + b) = sqrt((a+d)/2) + sqrt((a-d)/2)` with the sign of `b` before the second, where `b` has a root as a factor,
    /// `d^2 = a^2 - b^2` is a square, `a` is not negative and the sign of `b` (and if that is negative, of `d`) is known: the
    /// two halves add up to `a` and their product is `b^2/4`, so that neither is negative.
    fn root_taken_apart(&mut self, form: &Form) -> Result<Option<NodeId>, Halt> {
        let roots = form.variables().into_iter().filter(|v| matches!(self.generators.key(*v), Key::Root(_)));
        for root in roots.collect::<Vec<_>>() {
            let (mut a, mut b) = (Form::default(), Form::default());
            for (monomial, factor) in &form.0 {
                let part = if monomial.iter().any(|(v, _)| *v == root) { &mut b } else { &mut a };
                part.insert(monomial.clone(), factor.clone());
            }
            let Some((upward, mut d)) = self.halves_of_root(&a, &b) else { continue };
            if !upward {
                match self.sign_of_multiple(&d) {
                    Some(true) => {}
                    Some(false) => d = d.scaled(&RBig::from(-1)),
                    None => continue,
                }
            }
            let half = RBig::from_parts(1.into(), 2u8.into());
            let halves =
                [RBig::ONE, RBig::from(-1)].map(|sign| a.plus(&d, &sign).map(|sum| sum.scaled(&half)));
            let [Some(first), Some(second)] = halves else { continue };
            let (first, second) = (self.root(&first)?, self.root(&second)?);
            let apart = if upward { self.graph.add(first, second) } else { self.graph.sub(first, second) };
            return Ok(Some(apart));
        }
        Ok(None)
    }

    /// The sign of `b` and a root of `a^2 - b^2`, where `a` is not negative and there are such.
    fn halves_of_root(&mut self, a: &Form, b: &Form) -> Option<(bool, Form)> {
        let upward = self.sign_of_multiple(b)?;
        if a.is_zero() || !self.sign_of_multiple(a)? {
            return None;
        }
        let (whole, part) = (self.times(a, a)?, self.times(b, b)?);
        let square = whole.plus(&part, &RBig::from(-1))?;
        if square.is_zero() {
            return Some((upward, square));
        }
        let Factored { unit, bases } = self.factored(&square)?;
        let mut d = Form::constant(rational_root(&unit)?);
        for (base, power) in bases {
            let power = self.form_to(&base, Some(power / 2).filter(|_| power % 2 == 0)?)?;
            d = self.times(&d, &power)?;
        }
        Some((upward, d))
    }

    /// The sign of a form that may be a multiple of one whose sign is assumed.
    fn sign_of_multiple(&mut self, form: &Form) -> Option<bool> {
        let Some((content, primitive)) = form.primitive() else { return Some(true) };
        if let Some(sign) = self.sign(&primitive) {
            return Some(sign == (content > RBig::ZERO));
        }
        let Factored { unit, bases } = self.factored(form)?;
        let mut upward = unit > RBig::ZERO;
        for (base, _) in bases.iter().filter(|(_, power)| power % 2 != 0) {
            upward = upward == self.sign(base)?;
        }
        Some(upward)
    }

    /// `|base|^power`
    fn absolute_power(&mut self, base: &Form, power: &RBig) -> Result<NodeId, Halt> {
        let too_large = || Halt::Stop("an exponent is too large".into());
        let count = i32::try_from(power.numerator().clone()).map_err(|_| too_large())?;
        let parts = u32::try_from(power.denominator().clone()).map_err(|_| too_large())?;
        if let Some(number) = base.as_constant() {
            return self.power_of_number(&number, power);
        }
        let sign = self.sign(base);
        let variable = base.as_variable();
        let key = variable.map(|variable| self.generators.key(variable).clone());
        let mut now = match (key, variable, sign) {
            // exp(m/D)^power
            (Some(Key::Exp(monomial)), ..) => {
                let divisor = self.generators.divisors.get(&(Measure::Exponent, monomial.clone()));
                let divisor = RBig::from(divisor.copied().unwrap_or(1));
                return self.exponential_of(&monomial, &(power / divisor));
            }
            (Some(key), Some(variable), Some(upward)) if parts > 1 && is_free(&key) => {
                return Err(self.divide(variable, upward, power));
            }
            (_, _, Some(true)) => base.clone(),
            (_, _, Some(false)) => base.scaled(&RBig::from(-1)),
            (_, _, None) if parts == 1 && count % 2 == 0 => base.clone(),
            (_, _, None) => Form::variable(self.variable(Key::Abs(base.clone()))),
        };
        if parts == 2
            && let Some(root) = self.root_taken_apart(&now)?
        {
            return Ok(self.graph.power(root, count));
        }
        if parts.is_power_of_two() {
            for _ in 0..parts.trailing_zeros() {
                now = Form::variable(self.variable(Key::Root(now)));
            }
        } else {
            now = Form::variable(self.variable(Key::Power(now, parts)));
        }
        let node = self.node_of_form(&now);
        Ok(self.graph.power(node, count))
    }

    /// `|number|^power`
    pub(super) fn power_of_number(&mut self, number: &RBig, power: &RBig) -> Result<NodeId, Halt> {
        let mut product = self.graph.integer(1);
        for (prime, exponent) in primes(number) {
            let exponent = RBig::from(exponent) * power;
            // the whole part, and what remains
            let (whole, rest) = (exponent.floor(), &exponent - RBig::from(exponent.floor()));
            let whole = i32::try_from(whole).map_err(|_| Halt::Stop("an exponent is too large".into()))?;
            let base = self.graph.rational(RBig::from(prime.clone()));
            let base = self.graph.power(base, whole);
            product = self.graph.mul(product, base);
            if !rest.is_zero() {
                let base = self.root_of_prime(prime, &rest)?;
                product = self.graph.mul(product, base);
            }
        }
        Ok(product)
    }

    /// A power of a prime between zero and one.
    fn root_of_prime(&mut self, prime: UBig, power: &RBig) -> Result<NodeId, Halt> {
        let too_large = |_| Halt::Stop("a root of too high a degree is taken".into());
        let parts = u32::try_from(power.denominator().clone()).map_err(too_large)?;
        let count = i32::try_from(power.numerator().clone())
            .map_err(|_| Halt::Stop("an exponent is too large".into()))?;
        if !parts.is_power_of_two() {
            let node = self.node_of_key(Key::Power(Form::constant(RBig::from(prime)), parts));
            return Ok(self.graph.power(node, count));
        }
        let small = u64::try_from(&prime).ok().filter(|prime| self.generators.turn.has_root_of(*prime));
        let mut root = match small {
            Some(small) => {
                let twice = self.generators.turn.twice_root_of(small);
                let node = self.in_turn(&twice);
                let two = self.graph.integer(2);
                self.graph.div(node, two)
            }
            None => self.node_of_key(Key::Root(Form::constant(RBig::from(prime)))),
        };
        for _ in 1..parts.trailing_zeros() {
            let form = self.form(root).ok_or_else(|| Halt::Stop("a root is too long".into()))?;
            root = self.node_of_key(Key::Root(form));
        }
        Ok(self.graph.power(root, count))
    }

    /// The square root of an irrational constant that is one of these: `sqrt(a + b r) = sqrt((a+d)/2) + sqrt((a-d)/2)` with
    /// the sign of `b r` before the second, where `a^2 - (b r)^2 = d^2` is the square of a rational number; or of a cosine of
    /// half an angle.
    fn root_of_constant(&mut self, form: &Form) -> Result<Option<NodeId>, Halt> {
        if form.as_constant().is_some() || self.enclosed(form, 64).is_err() {
            return Ok(None);
        }
        let half = RBig::from_parts(1.into(), 2u8.into());
        let a = form.0.get(&Monomial::new()).cloned().unwrap_or(RBig::ZERO);
        let rest = form.plus(&Form::constant(a.clone()), &RBig::from(-1)).unwrap_or_default();
        let square = self.times(&rest, &rest).and_then(|square| square.as_constant());
        if let Some(square) = square
            && let Some(d) = rational_root(&(&a * &a - square))
            && let Some(upward) = self.sign(&rest)
            && a >= RBig::ZERO
        {
            let first = self.power_of_number(&((&a + &d) * &half), &half)?;
            let low = (&a - &d) * &half;
            let second =
                if low.is_zero() { self.graph.integer(0) } else { self.power_of_number(&low, &half)? };
            let root = if upward { self.graph.add(first, second) } else { self.graph.sub(first, second) };
            return Ok(Some(root));
        }
        // sqrt((1 + cos 2u)/2) = |cos u|
        let parts = self.generators.turn.parts;
        for place in 0..=parts / 2 {
            if parts <= 2 {
                break;
            }
            let double = self.generators.turn.twice_cosine(2 * place);
            let node = self.in_turn(&double);
            let Some(double) = self.form(node) else { continue };
            let Some(shifted) = double.plus(&Form::constant(RBig::from(2)), &RBig::ONE) else { continue };
            let Some(((own, primitive), (scale, other))) = form.primitive().zip(shifted.primitive()) else {
                continue;
            };
            if primitive == other && own > RBig::ZERO && scale > RBig::ZERO {
                // form = (own/scale) (2 + 2 cos 2u) = (own/scale) (2 cos u)^2
                let front = self.power_of_number(&(own / scale), &half)?;
                let twice = self.generators.turn.twice_cosine(place);
                let mut cosine = self.in_turn(&twice);
                let Some(cosine_form) = self.form(cosine) else { continue };
                match self.sign(&cosine_form) {
                    Some(true) => {}
                    Some(false) => cosine = self.graph.neg(cosine),
                    None => continue,
                }
                return Ok(Some(self.graph.mul(front, cosine)));
            }
        }
        Ok(None)
    }
}

/// Whether a generator may be written as a power of another one.
fn is_free(key: &Key) -> bool {
    matches!(key, Key::Symbol(_) | Key::Part(_) | Key::Pi | Key::Log(_) | Key::Opaque(..))
        || matches!(key, Key::Value(Function::Atan | Function::Asin, _))
}

/// The square root of the square of a rational number.
pub(super) fn rational_root(square: &RBig) -> Option<RBig> {
    let top = UBig::try_from(square.numerator().clone()).ok()?;
    let (n, d) = (top.sqrt(), square.denominator().sqrt());
    (&n * &n == top && &d * &d == *square.denominator()).then(|| RBig::from_parts(n.into(), d))
}

/// The prime factors of the magnitude of a number that is not zero, and their powers. What has no small factor and is no
/// square stands for a prime.
fn primes(number: &RBig) -> BTreeMap<UBig, i32> {
    let mut found = BTreeMap::new();
    for (part, sign) in [(number.numerator().clone().unsigned_abs(), 1), (number.denominator().clone(), -1)] {
        let mut rest = part;
        let mut prime = 2u32;
        while prime < LARGEST_PRIME && UBig::from(prime).sqr() <= rest {
            while (&rest).rem_euclid(UBig::from(prime)).is_zero() {
                rest /= prime;
                *found.entry(UBig::from(prime)).or_insert(0) += sign;
            }
            prime += 1 + (prime & 1);
        }
        let mut power = sign;
        while rest > UBig::ONE && rest.sqrt().sqr() == rest {
            rest = rest.sqrt();
            power *= 2;
        }
        if rest > UBig::ONE {
            *found.entry(rest).or_insert(0) += power;
        }
    }
    found.retain(|_, power| *power != 0);
    found
}
