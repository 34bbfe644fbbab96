//! Sums of principal values: a sum is zero exactly if its sine is zero, its cosine one, and it lies between whole turns. And
//! sums of logarithms: one is zero exactly if the product of the powers is one.

use super::form::{Form, as_variable};
use super::generators::Key;
use super::signs::CONSTANT_BITS;
use super::{Adjunction, Halt};
use crate::expression::NodeId;
use crate::number::{Arithmetic, Enclosures, Function};
use dashu::rational::RBig;

impl Adjunction<'_> {
    /// Whether a sum of multiples of inverse sines, inverse tangents and pi is shown to be zero.
    ///
    /// # Errors
    /// Where the pass has to begin anew.
    pub(super) fn is_zero_sum_of_values(&mut self, node: NodeId) -> Result<bool, Halt> {
        let Some(form) = self.form(node) else { return Ok(false) };
        let pi = self.pi();
        let mut whole = RBig::ONE;
        for (monomial, factor) in &form.0 {
            let key = as_variable(monomial).map(|variable| self.generators.key(variable));
            match key {
                _ if pi.0.contains_key(monomial) => {}
                // that many times the sum has sines of whole multiples
                Some(Key::Value(..)) => {
                    let denominator = RBig::from((factor * &whole).denominator().clone());
                    whole *= denominator;
                }
                _ => return Ok(false),
            }
        }
        let form = form.scaled(&whole);
        if !self.is_within_a_turn(&form) {
            return Ok(false);
        }
        let (sine, cosine) = self.circular(&form)?;
        let one = self.graph.integer(1);
        let rest = self.graph.sub(cosine, one);
        Ok(self.is_zero(&[sine, rest]))
    }

    /// Whether a sum of multiples of logarithms is shown to be zero: `c_1 log |b_1| + ...` is, where the even powers `b_1^(2 n
    /// c_1) ...` have the product one.
    pub(super) fn is_zero_sum_of_logarithms(&mut self, node: NodeId) -> bool {
        let Some(form) = self.form(node) else { return false };
        let (mut whole, mut bases) = (RBig::ONE, Vec::new());
        for (monomial, factor) in &form.0 {
            let Some(Key::Log(base)) = as_variable(monomial).map(|variable| self.generators.key(variable))
            else {
                return false;
            };
            bases.push((base.clone(), factor.clone()));
            whole *= RBig::from((factor * &whole).denominator().clone());
        }
        let mut product = self.graph.integer(1);
        for (base, factor) in bases {
            let power = factor * &whole * RBig::from(2);
            let Ok(power) = i32::try_from(power.numerator().clone()) else { return false };
            let base = self.node_of_form(&base);
            let power = self.graph.power(base, power);
            product = self.graph.mul(product, power);
        }
        let one = self.graph.integer(1);
        let difference = self.graph.sub(product, one);
        self.is_zero(&[difference])
    }

    /// Whether a sum of values and multiples of pi lies between minus and plus a whole turn, the ends not counted.
    fn is_within_a_turn(&self, form: &Form) -> bool {
        let (mut low, mut high) = (RBig::ZERO, RBig::ZERO); // in parts of pi
        let (mut open_below, mut open_above) = (false, false);
        for (monomial, factor) in &form.0 {
            let value = as_variable(monomial).map(|variable| self.generators.key(variable));
            let (least, most) = match value {
                Some(Key::Value(function, inner)) => {
                    let (ends, open) = self.range(*function, inner);
                    open_below |= if *factor > RBig::ZERO { open.0 } else { open.1 };
                    open_above |= if *factor > RBig::ZERO { open.1 } else { open.0 };
                    ends
                }
                _ => (RBig::ONE, RBig::ONE),
            };
            let ends = (&least * factor, &most * factor);
            let (least, most) = if ends.0 <= ends.1 { ends } else { (ends.1, ends.0) };
            low += least;
            high += most;
        }
        let two = RBig::from(2);
        (low > -two.clone() || open_below && low == -two.clone()) && (high < two || open_above && high == two)
    }

    /// Between which parts of pi the value of an inverse function lies, and whether it takes neither end.
    fn range(&self, function: Function, inner: &Form) -> ((RBig, RBig), (bool, bool)) {
        let numbers = Enclosures::new(CONSTANT_BITS);
        let constant = self.enclosed(inner, CONSTANT_BITS).and_then(|value| {
            let value = numbers.apply(function, &value)?;
            numbers.div(&value, &numbers.pi()?)
        });
        if let Ok(value) = constant {
            return ((value.low(), value.high()), (false, false));
        }
        let half = RBig::from_parts(1.into(), 2u8.into());
        let open = function == Function::Atan;
        match self.sign(inner) {
            Some(true) => ((RBig::ZERO, half), (false, open)),
            Some(false) => ((-half, RBig::ZERO), (open, false)),
            None => ((-half.clone(), half), (open, open)),
        }
    }
}
