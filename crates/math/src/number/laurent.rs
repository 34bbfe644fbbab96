//! Laurent series in one small quantity, as an [`Arithmetic`] over any other: the order of a zero or a pole, and the
//! coefficient in front of it.

use super::{Arithmetic, Function, Refusal};
use dashu::rational::RBig;
use palmistry_budget as budget;

/// `e^valuation * (c[0] + c[1] e + ... + O(e^n))`, `n` the number of coefficients; `c[0]` is not zero.
///
/// With no coefficients left it is `O(e^valuation)`; the exact zero has the valuation `i32::MAX`.
#[derive(Clone, Debug)]
pub struct Series<N> {
    /// The exponent of the leading term.
    pub valuation: i32,
    /// The known coefficients, leading one first.
    pub coefficients: Vec<N>,
}

/// Series over the numbers of `base` that keep at most `terms` coefficients.
#[derive(Clone, Copy, Debug)]
pub struct Laurent<A> {
    /// The arithmetic of the coefficients.
    pub base: A,
    /// The greatest number of coefficients kept.
    pub terms: usize,
}

impl<A: Arithmetic> Laurent<A> {
    /// The small quantity itself.
    pub fn small(&self) -> Result<Series<A::Number>, Refusal> {
        let mut coefficients = vec![self.base.rational(&RBig::ZERO)?; self.terms];
        coefficients[0] = self.base.rational(&RBig::ONE)?;
        Ok(Series { valuation: 1, coefficients })
    }

    /// A number that does not depend on the small quantity.
    pub fn constant(&self, value: A::Number) -> Result<Series<A::Number>, Refusal> {
        if self.base.is_zero(&value) == Some(true) {
            return Ok(Series { valuation: i32::MAX, coefficients: Vec::new() });
        }
        let mut coefficients = vec![self.base.rational(&RBig::ZERO)?; self.terms];
        coefficients[0] = value;
        Ok(Series { valuation: 0, coefficients })
    }

    /// Moves leading coefficients that are known to be zero into the valuation.
    fn normal(&self, mut series: Series<A::Number>) -> Series<A::Number> {
        let zeros = series.coefficients.iter().take_while(|c| self.base.is_zero(c) == Some(true)).count();
        series.coefficients.drain(..zeros);
        series.valuation = series.valuation.saturating_add(zeros as i32);
        series.coefficients.truncate(self.terms);
        series
    }
}

fn is_exact_zero<N>(series: &Series<N>) -> bool {
    series.valuation == i32::MAX
}

impl<A: Arithmetic> Arithmetic for Laurent<A> {
    type Number = Series<A::Number>;

    fn rational(&self, value: &RBig) -> Result<Self::Number, Refusal> {
        self.constant(self.base.rational(value)?)
    }
    fn pi(&self) -> Result<Self::Number, Refusal> {
        self.constant(self.base.pi()?)
    }
    fn add(&self, a: &Self::Number, b: &Self::Number) -> Result<Self::Number, Refusal> {
        if is_exact_zero(a) {
            return Ok(b.clone());
        }
        if is_exact_zero(b) {
            return Ok(a.clone());
        }
        let start = a.valuation.min(b.valuation);
        let end = |s: &Self::Number| s.valuation.saturating_add(s.coefficients.len() as i32);
        let end = end(a).min(end(b)); // beyond this one of the two is unknown
        let zero = self.base.rational(&RBig::ZERO)?;
        let term = |s: &Self::Number, exponent: i32| -> A::Number {
            usize::try_from(exponent - s.valuation)
                .ok()
                .and_then(|i| s.coefficients.get(i).cloned())
                .unwrap_or_else(|| zero.clone())
        };
        let mut coefficients = Vec::new();
        for exponent in start..end.max(start) {
            coefficients.push(self.base.add(&term(a, exponent), &term(b, exponent))?);
        }
        let valuation = if coefficients.is_empty() { end } else { start };
        Ok(self.normal(Series { valuation, coefficients }))
    }
    fn sub(&self, a: &Self::Number, b: &Self::Number) -> Result<Self::Number, Refusal> {
        self.add(a, &self.neg(b)?)
    }
    fn mul(&self, a: &Self::Number, b: &Self::Number) -> Result<Self::Number, Refusal> {
        if is_exact_zero(a) || is_exact_zero(b) {
            return Ok(Series { valuation: i32::MAX, coefficients: Vec::new() });
        }
        let length = a.coefficients.len().min(b.coefficients.len());
        budget::steps(length * length);
        let mut coefficients = Vec::with_capacity(length);
        for n in 0..length {
            let mut sum = self.base.mul(&a.coefficients[0], &b.coefficients[n])?;
            for i in 1..=n {
                sum = self.base.add(&sum, &self.base.mul(&a.coefficients[i], &b.coefficients[n - i])?)?;
            }
            coefficients.push(sum);
        }
        Ok(self.normal(Series { valuation: a.valuation + b.valuation, coefficients }))
    }
    fn div(&self, a: &Self::Number, b: &Self::Number) -> Result<Self::Number, Refusal> {
        if is_exact_zero(b) {
            return Err(Refusal::DivisionByZero);
        }
        let leading = b.coefficients.first().ok_or(Refusal::DivisorNotSeparated)?;
        if is_exact_zero(a) {
            return Ok(a.clone());
        }
        let length = a.coefficients.len().min(b.coefficients.len());
        let mut coefficients: Vec<A::Number> = Vec::with_capacity(length);
        for n in 0..length {
            let mut rest = a.coefficients[n].clone();
            for (known, divisor) in coefficients.iter().zip(b.coefficients[1..=n].iter().rev()) {
                rest = self.base.sub(&rest, &self.base.mul(known, divisor)?)?;
            }
            coefficients.push(self.base.div(&rest, leading)?);
        }
        Ok(self.normal(Series { valuation: a.valuation - b.valuation, coefficients }))
    }
    fn neg(&self, a: &Self::Number) -> Result<Self::Number, Refusal> {
        let coefficients = a.coefficients.iter().map(|c| self.base.neg(c)).collect::<Result<_, _>>()?;
        Ok(Series { valuation: a.valuation, coefficients })
    }
    /// Only of a constant: nothing so far asks for more.
    fn apply(&self, function: Function, a: &Self::Number) -> Result<Self::Number, Refusal> {
        let tail_is_zero = a.coefficients.iter().skip(1).all(|c| self.base.is_zero(c) == Some(true));
        if is_exact_zero(a) {
            self.constant(self.base.apply(function, &self.base.rational(&RBig::ZERO)?)?)
        } else if a.valuation == 0 && tail_is_zero && !a.coefficients.is_empty() {
            self.constant(self.base.apply(function, &a.coefficients[0])?)
        } else {
            Err(Refusal::NoExactValue(function))
        }
    }
    fn is_zero(&self, a: &Self::Number) -> Option<bool> {
        match a.coefficients.first() {
            None => is_exact_zero(a).then_some(true),
            Some(leading) => (self.base.is_zero(leading) == Some(false)).then_some(false),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Rationals;

    /// `1/(e^2 (1 - e)) = e^-2 + e^-1 + 1 + ...`, and the difference `1/e^2 - 1/(e^2 (1 - e))` has a simple pole.
    #[test]
    fn a_geometric_series_has_its_pole() {
        let all = Laurent { base: Rationals::default(), terms: 6 };
        let (e, one) = (all.small().unwrap(), all.rational(&RBig::ONE).unwrap());
        let square = all.mul(&e, &e).unwrap();
        let value = all.div(&one, &all.mul(&square, &all.sub(&one, &e).unwrap()).unwrap()).unwrap();
        assert_eq!(value.valuation, -2);
        assert!(value.coefficients.iter().all(|c| c.is_one()));
        let rest = all.sub(&all.div(&one, &square).unwrap(), &value).unwrap();
        assert_eq!((rest.valuation, rest.coefficients[0].clone()), (-1, RBig::from(-1)));
    }

    #[test]
    fn what_is_lost_to_cancellation_is_not_divided_by() {
        let all = Laurent { base: Rationals::default(), terms: 3 };
        let e = all.small().unwrap();
        let nothing = all.sub(&e, &e).unwrap();
        assert_eq!(all.is_zero(&nothing), None);
        assert_eq!(all.div(&e, &nothing).unwrap_err(), Refusal::DivisorNotSeparated);
    }
}
