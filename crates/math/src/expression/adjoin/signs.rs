//! Factors of arguments, and their signs: what is read off, what the assumptions say, and what follows where all factors of
//! a product but one have known signs.

use super::form::{Form, Monomial};
use super::generators::{Key, Measure};
use super::{Adjunction, Halt};
use crate::expression::{Guard, Need};
use crate::number::polynomial::{Exponents, LARGEST_ARITY, Polynomial, Ring};
use crate::number::{Arithmetic, Enclosure, Enclosures, Function, Refusal, split};
use dashu::rational::RBig;
use std::collections::BTreeMap;

/// The precision at which the sign of a constant is looked at.
pub(super) const CONSTANT_BITS: usize = 256;

/// A number times powers of generators and of sums.
#[derive(Clone, Debug)]
pub(super) struct Factored {
    pub unit: RBig,
    /// The bases are primitive, each of them once, their powers not zero.
    pub bases: Vec<(Form, i32)>,
}

impl Adjunction<'_> {
    /// A form as a product, as far as that is cheap; nothing for zero and for what is too long.
    pub(super) fn factored(&mut self, form: &Form) -> Option<Factored> {
        let mut bases: BTreeMap<Form, i32> = BTreeMap::new();
        // over one denominator
        let mut top = form.clone();
        for variable in form.variables() {
            let Key::Inverse(bottom) = self.generators.key(variable).clone() else { continue };
            let power = |m: &Monomial| m.iter().find(|(v, _)| *v == variable).map_or(0, |(_, power)| *power);
            let most = top.0.keys().map(power).max().unwrap_or(0);
            let mut sum = Form::default();
            for (monomial, factor) in &top.0 {
                let missing = self.form_to(&bottom, most - power(monomial))?;
                let rest = monomial.iter().copied().filter(|(v, _)| *v != variable).collect();
                let term = self.times(&Form::term(rest, factor.clone()), &missing)?;
                sum = sum.plus(&term, &RBig::ONE)?;
            }
            *bases.entry(bottom).or_insert(0) -= most;
            top = sum;
        }
        let mut common: BTreeMap<u32, i32> = BTreeMap::new();
        for variable in top.variables() {
            let power = |m: &Monomial| m.iter().find(|(v, _)| *v == variable).map_or(0, |(_, power)| *power);
            let least = top.0.keys().map(power).min().unwrap_or(0);
            *bases.entry(Form::variable(variable)).or_insert(0) += least;
            common.insert(variable, -least);
        }
        let (unit, rest) = top
            .times(&Form::term(common.into_iter().filter(|c| c.1 != 0).collect(), RBig::ONE))?
            .primitive()?;
        let mut unit = unit;
        if rest.as_constant().is_none() {
            match self.split(&rest) {
                Some((sign, factors)) => {
                    unit *= sign;
                    factors.into_iter().for_each(|(base, power)| *bases.entry(base).or_insert(0) += power);
                }
                None => *bases.entry(rest).or_insert(0) += 1,
            }
        }
        if self.join_sines(&mut bases) {
            unit = -unit;
        }
        bases.retain(|_, power| *power != 0);
        // a factor of one is looked for in others
        self.factors.extend(bases.keys().filter(|base| base.0.len() > 1).cloned());
        Some(Factored { unit, bases: bases.into_iter().collect() })
    }

    /// `(cos - 1) (cos + 1)` is minus the square of the sine; whether a factor minus one is left over.
    fn join_sines(&self, bases: &mut BTreeMap<Form, i32>) -> bool {
        let mut negative = false;
        let cosines = bases
            .keys()
            .flat_map(Form::variables)
            .filter(|v| matches!(self.generators.key(*v), Key::Cosine(_)));
        for cosine in cosines.collect::<Vec<_>>() {
            // both with a positive last coefficient, as primitive forms have it
            let above = Form::constant(RBig::ONE).plus(&Form::variable(cosine), &RBig::ONE);
            let below = Form::variable(cosine).plus(&Form::constant(RBig::ONE), &RBig::from(-1));
            let (Some(above), Some(below)) = (above, below) else { continue };
            if let Some(n) = above.times(&below).and_then(|product| bases.remove(&product)) {
                negative ^= n % 2 != 0;
                *bases.entry(Form::variable(cosine - 1)).or_insert(0) += 2 * n;
            }
            if let (Some(m), Some(n)) = (bases.get(&above).copied(), bases.get(&below).copied())
                && m == n
            {
                negative ^= m % 2 != 0;
                bases.remove(&above);
                bases.remove(&below);
                *bases.entry(Form::variable(cosine - 1)).or_insert(0) += 2 * m;
            }
        }
        negative
    }

    /// A primitive sum as a product; nothing where it has too many generators.
    fn split(&self, form: &Form) -> Option<(RBig, Vec<(Form, i32)>)> {
        let variables = form.variables();
        if variables.len() > LARGEST_ARITY {
            return None;
        }
        let polynomial = |form: &Form| -> Option<Polynomial> {
            let mut sum = Polynomial::default();
            for (monomial, factor) in &form.0 {
                let mut exponents = Exponents::default();
                for (variable, power) in monomial {
                    let place = variables.iter().position(|known| known == variable)?;
                    exponents[place] = u8::try_from(*power).ok().filter(|power| *power < 128)?;
                }
                if !factor.denominator().is_one() {
                    return None;
                }
                sum = sum.add(&Polynomial::term(exponents, factor.numerator().clone()));
            }
            Some(sum)
        };
        // what has a sign is a factor that is looked for
        let mut known: Vec<Polynomial> =
            self.signs.keys().chain(&self.factors).filter_map(polynomial).collect();
        // the shortest first: a product may be known beside its factors
        known.sort_by(|a, b| {
            (a.degree(), a.len()).cmp(&(b.degree(), b.len())).then_with(|| a.terms().cmp(b.terms()))
        });
        let found = split(&polynomial(form)?, &known);
        let back = |polynomial: &Polynomial| {
            let mut form = Form::default();
            for (exponents, factor) in polynomial.terms() {
                let places = exponents.iter().enumerate().filter(|(_, power)| **power > 0);
                let monomial = places.map(|(place, power)| (variables[place], i32::from(*power))).collect();
                form.insert(monomial, RBig::from(factor.clone()));
            }
            form
        };
        let mut unit = RBig::from(found.unit);
        let mut factors = Vec::new();
        for (factor, power) in found.factors {
            // primitive in the order of forms, which is not that of polynomials
            let (content, form) = back(&factor).primitive()?;
            unit *= RBig::from_parts(
                content.numerator().pow(power as usize),
                content.denominator().pow(power as usize),
            );
            factors.push((form, i32::try_from(power).ok()?));
        }
        Some((unit, factors))
    }

    /// Whether a form is nowhere negative (`true`) or nowhere positive (`false`), where the assumptions hold.
    pub fn sign(&self, form: &Form) -> Option<bool> {
        self.sign_term_by_term(form).or_else(|| self.sign_by_parts(form))
    }

    fn sign_term_by_term(&self, form: &Form) -> Option<bool> {
        if let Some(sign) = self.signs.get(form) {
            return Some(*sign);
        }
        if let Some(value) = form.as_constant() {
            return Some(value >= RBig::ZERO);
        }
        let mut all = None;
        for (monomial, factor) in &form.0 {
            let mut upward = *factor >= RBig::ZERO;
            for (variable, power) in monomial {
                if power % 2 != 0 {
                    upward = upward == self.sign_of_generator(*variable)?;
                }
            }
            if *all.get_or_insert(upward) != upward {
                return self.sign_of_constant(form);
            }
        }
        all
    }

    /// The same, also of a known form and what is added to it.
    fn sign_by_parts(&self, form: &Form) -> Option<bool> {
        self.signs.iter().find_map(|(known, upward)| {
            let (monomial, factor) = known.0.iter().next_back()?;
            let times = form.0.get(monomial)? / factor;
            let rest = form.plus(known, &-times.clone())?;
            let sign = *upward == (times > RBig::ZERO);
            (self.sign_term_by_term(&rest)? == sign || rest.is_zero()).then_some(sign)
        })
    }

    fn sign_of_generator(&self, variable: u32) -> Option<bool> {
        match self.generators.key(variable) {
            Key::Pi | Key::Exp(_) | Key::Root(_) | Key::Abs(_) | Key::Power(..) | Key::Part(_) => Some(true),
            Key::Value(Function::Asin | Function::Atan, form) | Key::Inverse(form) => self.sign(form),
            _ => {
                let form = Form::variable(variable);
                self.signs.get(&form).copied().or_else(|| self.sign_of_constant(&form))
            }
        }
    }

    fn sign_of_constant(&self, form: &Form) -> Option<bool> {
        let value = self.enclosed(form, CONSTANT_BITS).ok()?;
        match (value.low() > RBig::ZERO, value.high() < RBig::ZERO) {
            (true, _) => Some(true),
            (_, true) => Some(false),
            _ => None,
        }
    }

    /// The value of a form in which only constants are met.
    ///
    /// # Errors
    /// Where something else is met, or the value cannot be distinguished from undefined.
    pub(super) fn enclosed(&self, form: &Form, bits: usize) -> Result<Enclosure, Refusal> {
        let numbers = Enclosures::new(bits);
        let mut sum = numbers.rational(&RBig::ZERO)?;
        for (monomial, factor) in &form.0 {
            let mut product = numbers.rational(factor)?;
            for (variable, power) in monomial {
                let base = self.enclosed_generator(*variable, bits)?;
                product = numbers.mul(&product, &numbers.power(&base, *power)?)?;
            }
            sum = numbers.add(&sum, &product)?;
        }
        Ok(sum)
    }

    fn enclosed_generator(&self, variable: u32, bits: usize) -> Result<Enclosure, Refusal> {
        let numbers = Enclosures::new(bits);
        let number = |value: u64| numbers.rational(&RBig::from(value));
        let none = Refusal::NoExactValue(Function::Sin);
        let measure = |monomial: &Monomial, measure| -> Result<Enclosure, Refusal> {
            let parts = self.generators.divisors.get(&(measure, monomial.clone())).copied().unwrap_or(1);
            let whole = self.enclosed(&Form::term(monomial.clone(), RBig::ONE), bits)?;
            numbers.div(&whole, &number(u64::from(parts))?)
        };
        match self.generators.key(variable) {
            Key::Symbol(_) | Key::Part(_) | Key::Opaque(..) | Key::Power(..) => Err(none),
            Key::Pi => numbers.pi(),
            Key::Turn => {
                let part = numbers.div(&numbers.pi()?, &number(self.generators.turn.parts)?)?;
                let cosine = numbers.apply(Function::Cos, &numbers.add(&part, &part)?)?;
                numbers.add(&cosine, &cosine)
            }
            Key::Exp(monomial) => numbers.apply(Function::Exp, &measure(monomial, Measure::Exponent)?),
            Key::Sine(monomial) => numbers.apply(Function::Sin, &measure(monomial, Measure::Angle)?),
            Key::Cosine(monomial) => numbers.apply(Function::Cos, &measure(monomial, Measure::Angle)?),
            Key::Root(form) => numbers.apply(Function::Sqrt, &self.enclosed(form, bits)?),
            Key::Abs(form) => {
                let value = self.enclosed(form, bits)?;
                match numbers.is_zero(&value) {
                    Some(false) if value.high() < RBig::ZERO => numbers.neg(&value),
                    Some(_) => Ok(value),
                    None => Err(none),
                }
            }
            Key::Log(form) => {
                let value = self.enclosed(form, bits)?;
                let positive = value.low() > RBig::ZERO;
                numbers.apply(Function::Log, &if positive { value } else { numbers.neg(&value)? })
            }
            Key::Value(function, form) => numbers.apply(*function, &self.enclosed(form, bits)?),
            Key::Inverse(form) => numbers.div(&number(1)?, &self.enclosed(form, bits)?),
        }
    }

    /// Whether a base is nowhere zero where the assumptions hold.
    fn is_apart_from_zero(&self, base: &Form) -> bool {
        if self.nonzero.contains(base) {
            return true;
        }
        if let Ok(value) = self.enclosed(base, CONSTANT_BITS) {
            return !value.contains_zero();
        }
        let positive = |variable: u32| {
            matches!(self.generators.key(variable), Key::Exp(_) | Key::Pi)
                || self.nonzero.contains(&Form::variable(variable))
        };
        // no term draws against the others, and one of them is not zero
        self.sign(base).is_some()
            && self.has_one_sign(base)
            && base.0.keys().any(|monomial| monomial.iter().all(|(variable, _)| positive(*variable)))
    }

    /// Takes the signs from what is assumed; whether something is new.
    ///
    /// # Errors
    /// Where the pass has to begin anew.
    pub(super) fn learn(&mut self, assumption: Guard) -> Result<bool, Halt> {
        let node = match self.rewritten(assumption.node) {
            Ok(node) => node,
            Err(Halt::Again) => return Err(Halt::Again),
            Err(Halt::Stop(_)) => return Ok(false),
        };
        let Some(form) = self.form(node) else { return Ok(false) };
        let one = Form::constant(RBig::ONE);
        let inside = assumption.need == Need::InsideOne;
        Ok(match assumption.need {
            Need::NotZero => self.is_not_zero(&form),
            Need::Positive => self.is_not_zero(&form) | self.is_upward(&form),
            Need::NotNegative => self.is_upward(&form),
            Need::WithinOne | Need::InsideOne => {
                let mut new = false;
                for sign in [RBig::ONE, RBig::from(-1)] {
                    let Some(gap) = one.plus(&form, &sign) else { continue };
                    new |= inside && self.is_not_zero(&gap);
                    new |= self.is_upward(&gap);
                }
                new
            }
        })
    }

    /// No factor of what is not zero is.
    fn is_not_zero(&mut self, form: &Form) -> bool {
        let Some(Factored { bases, .. }) = self.factored(form) else { return false };
        bases.into_iter().fold(false, |new, (base, _)| self.nonzero.insert(base) || new)
    }

    /// Takes the sign of what has none from a product that is nowhere negative. Where another factor may be zero this says
    /// nothing.
    fn is_upward(&mut self, form: &Form) -> bool {
        let Some(Factored { unit, bases }) = self.factored(form) else { return false };
        let (mut upward, mut product) = (unit >= RBig::ZERO, Some(Form::constant(RBig::ONE)));
        for (base, power) in &bases {
            let sign = if power % 2 == 0 { Some(true) } else { self.sign(base) };
            match sign {
                Some(sign) if self.is_apart_from_zero(base) => upward = upward == sign,
                Some(_) if power % 2 == 0 => return false,
                // it stays a part of the product
                _ => product = product.and_then(|product| self.times(&product, base)),
            }
        }
        let Some((content, product)) = product.and_then(|product| product.primitive()) else { return false };
        if product.as_constant().is_some() || self.sign(&product).is_some() {
            return false;
        }
        self.signs.insert(product, upward == (content >= RBig::ZERO)).is_none()
    }

    /// Whether it can be read off that no two terms have different signs.
    fn has_one_sign(&self, form: &Form) -> bool {
        let signs =
            |(monomial, factor): (&Monomial, &RBig)| self.sign(&Form::term(monomial.clone(), factor.clone()));
        let all: Vec<Option<bool>> = form.0.iter().map(signs).collect();
        all.iter().all(|sign| sign.is_some() && *sign == all[0])
    }
}
