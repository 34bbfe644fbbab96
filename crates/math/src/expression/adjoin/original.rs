//! Forms over generators back in the functions of which they were made.

use super::Adjunction;
use super::form::{Form, Monomial};
use super::generators::{DEEPEST, Key, Measure};
use crate::expression::NodeId;
use crate::number::Function;
use dashu::rational::RBig;

impl Adjunction<'_> {
    /// A form as an expression in the symbols that were given; nothing where a generator is none of these functions.
    pub(super) fn original(&mut self, form: &Form) -> Option<NodeId> {
        self.original_within(form, 0)
    }

    fn original_within(&mut self, form: &Form, depth: usize) -> Option<NodeId> {
        if depth > DEEPEST {
            return None;
        }
        let mut sum = self.graph.integer(0);
        for (monomial, factor) in form.0.iter().rev() {
            let product = self.original_monomial(monomial, depth)?;
            // as somebody would write it
            let size = if *factor < RBig::ZERO { -factor.clone() } else { factor.clone() };
            let size = self.graph.rational(size);
            let term = self.graph.mul(size, product);
            sum = match *factor < RBig::ZERO {
                true => self.graph.sub(sum, term),
                false => self.graph.add(sum, term),
            };
        }
        Some(sum)
    }

    fn original_monomial(&mut self, monomial: &Monomial, depth: usize) -> Option<NodeId> {
        let mut product = self.graph.integer(1);
        for (variable, power) in monomial {
            let base = self.original_generator(*variable, depth + 1)?;
            let power = self.graph.power(base, *power);
            product = self.graph.mul(product, power);
        }
        Some(product)
    }

    pub(super) fn original_generator(&mut self, variable: u32, depth: usize) -> Option<NodeId> {
        if depth > DEEPEST {
            return None;
        }
        match self.generators.key(variable).clone() {
            Key::Symbol(symbol) => Some(self.graph.symbol(symbol)),
            Key::Pi => Some(self.graph.pi()),
            Key::Exp(monomial) => {
                let exponent = self.original_part(&monomial, Measure::Exponent, depth)?;
                Some(self.graph.apply(Function::Exp, exponent))
            }
            Key::Sine(monomial) => {
                let angle = self.original_part(&monomial, Measure::Angle, depth)?;
                Some(self.graph.apply(Function::Sin, angle))
            }
            Key::Cosine(monomial) => {
                let angle = self.original_part(&monomial, Measure::Angle, depth)?;
                Some(self.graph.apply(Function::Cos, angle))
            }
            Key::Root(form) => {
                let inner = self.original_within(&form, depth)?;
                Some(self.graph.apply(Function::Sqrt, inner))
            }
            Key::Abs(form) => {
                let inner = self.original_within(&form, depth)?;
                Some(self.graph.absolute(inner))
            }
            Key::Log(form) => {
                let inner = self.original_magnitude(&form, depth)?;
                Some(self.graph.apply(Function::Log, inner))
            }
            Key::Value(function, form) => {
                let inner = self.original_within(&form, depth)?;
                Some(self.graph.apply(function, inner))
            }
            Key::Inverse(form) => {
                let inner = self.original_within(&form, depth)?;
                Some(self.graph.power(inner, -1))
            }
            Key::Part(whole) => {
                let (parts, upward) = self.generators.parts.get(&whole).copied()?;
                let inner = self.original_generator(whole, depth + 1)?;
                let inner = if upward { inner } else { self.graph.neg(inner) };
                let exponent = self.graph.rational(RBig::from_parts(1.into(), parts.into()));
                Some(self.graph.real_power(inner, exponent))
            }
            Key::Power(form, parts) => {
                let inner = self.original_magnitude(&form, depth)?;
                let exponent = self.graph.rational(RBig::from_parts(1.into(), parts.into()));
                Some(self.graph.real_power(inner, exponent))
            }
            Key::Turn | Key::Opaque(..) => None,
        }
    }

    /// The absolute value of a form: itself or its negative where its sign is known.
    fn original_magnitude(&mut self, form: &Form, depth: usize) -> Option<NodeId> {
        let inner = self.original_within(form, depth)?;
        Some(match self.sign(form) {
            Some(true) => inner,
            Some(false) => self.graph.neg(inner),
            None => self.graph.absolute(inner),
        })
    }

    /// The part of a monomial of which multiples are met in exponents, or in sines.
    fn original_part(&mut self, monomial: &Monomial, measure: Measure, depth: usize) -> Option<NodeId> {
        let parts = self.generators.divisors.get(&(measure, monomial.clone())).copied().unwrap_or(1);
        let whole = self.original_monomial(monomial, depth)?;
        let parts = self.graph.integer(i64::from(parts));
        Some(self.graph.div(whole, parts))
    }

    /// The angle of which a generator is the sine.
    pub(super) fn original_angle(&mut self, variable: u32) -> Option<NodeId> {
        match self.generators.key(variable).clone() {
            Key::Sine(monomial) | Key::Cosine(monomial) => self.original_part(&monomial, Measure::Angle, 0),
            _ => None,
        }
    }
}
