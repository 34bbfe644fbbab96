//! The next coefficient of a power series from those before it: the recurrences by which a Taylor series is propagated
//! through sums, products, quotients and elementary functions, over any arithmetic.
//!
//! With `c(t) = c_0 + c_1 t + c_2 t^2 + ...`, and likewise `a` and `b`:
//!
//! | operation | equation | recurrence |
//! |---|---|---|
//! | `c = a b` | | `c_k = sum_{j=0..k} a_j b_{k-j}` |
//! | `c = a/b` | `c b = a` | `c_k = (a_k - sum_{j=1..k} b_j c_{k-j}) / b_0` |
//! | `c = exp a` | `c' = a' c` | `c_k = 1/k sum_{j=1..k} j a_j c_{k-j}` |
//! | `s = sin a, c = cos a` | `s' = a' c, c' = -a' s` | `s_k = 1/k sum j a_j c_{k-j}`, `c_k = -1/k sum j a_j s_{k-j}` |
//! | `c = sqrt a` | `c c = a` | `c_k = (a_k - sum_{j=1..k-1} c_j c_{k-j}) / (2 c_0)` |
//! | log, atan, asin, acos | `c' b = a'` | `c_k = (a_k - 1/k sum_{j=1..k-1} j c_j b_{k-j}) / b_0` |
//!
//! where `b` is `a`, `1 + a^2`, or `+-sqrt(1 - a^2)`. A convolution of order `k` costs `k + 1` products, so that all
//! coefficients up to `k` cost O(k^2) for each operation.
//!
//! Reference: A. Griewank and A. Walther, *Evaluating Derivatives* (2nd ed. 2008), tables 13.1 and 13.2.

use super::{Arithmetic, Refusal};
use dashu::rational::RBig;
use palmistry_budget as budget;

/// The coefficients of a series that are known so far; `None` is one that is zero whatever the values are, and beyond
/// the end all are.
pub type Coefficients<N> = Vec<Option<N>>;

/// A coefficient; `None` where it is zero by its structure.
type Term<N> = Result<Option<N>, Refusal>;

/// The recurrences over one arithmetic, up to some order.
#[derive(Clone, Debug)]
pub struct Recurrences<A: Arithmetic> {
    base: A,
    /// `0, 1, 2, ...`
    integers: Vec<A::Number>,
    /// `1/k`; nothing useful at zero.
    reciprocals: Vec<A::Number>,
}

fn at<N>(series: &[Option<N>], index: usize) -> Option<&N> {
    series.get(index)?.as_ref()
}

impl<A: Arithmetic> Recurrences<A> {
    /// Coefficients up to that of `t^order`.
    ///
    /// # Errors
    /// Where an integer up to the order has no image, or no reciprocal.
    pub fn new(base: A, order: usize) -> Result<Self, Refusal> {
        let order = order as u64;
        let integers = (0..=order).map(|k| base.rational(&RBig::from(k))).collect::<Result<_, _>>()?;
        let reciprocals = (0..=order)
            .map(|k| base.rational(&(RBig::ONE / RBig::from(k.max(1)))))
            .collect::<Result<_, _>>()?;
        Ok(Recurrences { base, integers, reciprocals })
    }

    /// The arithmetic of the coefficients.
    pub fn base(&self) -> &A {
        &self.base
    }

    /// `a_k + b_k`
    pub fn sum(&self, a: Option<&A::Number>, b: Option<&A::Number>) -> Term<A::Number> {
        match (a, b) {
            (Some(a), Some(b)) => self.base.add(a, b).map(Some),
            (one, other) => Ok(one.or(other).cloned()),
        }
    }

    /// `a_k - b_k`
    pub fn difference(&self, a: Option<&A::Number>, b: Option<&A::Number>) -> Term<A::Number> {
        match (a, b) {
            (Some(a), Some(b)) => self.base.sub(a, b).map(Some),
            (None, Some(b)) => self.base.neg(b).map(Some),
            (a, None) => Ok(a.cloned()),
        }
    }

    /// `-a_k`
    pub fn negative(&self, a: Option<&A::Number>) -> Term<A::Number> {
        a.map(|a| self.base.neg(a)).transpose()
    }

    /// `sum of left_j right_(k-j)` over some `j`.
    fn convolution(
        &self,
        k: usize,
        range: impl Iterator<Item = usize>,
        left: &[Option<A::Number>],
        right: &[Option<A::Number>],
    ) -> Term<A::Number> {
        budget::steps(k);
        let mut sum = None;
        for j in range {
            if let (Some(a), Some(b)) = (at(left, j), at(right, k - j)) {
                let product = self.base.mul(a, b)?;
                sum = self.sum(sum.as_ref(), Some(&product))?;
            }
        }
        Ok(sum)
    }

    /// `sum of j left_j right_(k-j)` over some `j`.
    fn weighted(
        &self,
        k: usize,
        range: impl Iterator<Item = usize>,
        left: &[Option<A::Number>],
        right: &[Option<A::Number>],
    ) -> Term<A::Number> {
        budget::steps(2 * k);
        let mut sum = None;
        for j in range {
            if let (Some(a), Some(b)) = (at(left, j), at(right, k - j)) {
                let slope = if j == 1 { a.clone() } else { self.base.mul(&self.integers[j], a)? };
                let product = self.base.mul(&slope, b)?;
                sum = self.sum(sum.as_ref(), Some(&product))?;
            }
        }
        Ok(sum)
    }

    fn times(&self, factor: &A::Number, value: Option<A::Number>) -> Term<A::Number> {
        value.map(|value| self.base.mul(factor, &value)).transpose()
    }

    /// `value / k`
    pub fn over(&self, k: usize, value: Option<A::Number>) -> Term<A::Number> {
        if k == 1 { Ok(value) } else { self.times(&self.reciprocals[k], value) }
    }

    /// The coefficient of `t^k` in `a b`.
    ///
    /// # Errors
    /// Where an operation is refused, here and below.
    pub fn product(&self, k: usize, a: &[Option<A::Number>], b: &[Option<A::Number>]) -> Term<A::Number> {
        self.convolution(k, 0..=k, a, b)
    }

    /// The coefficient of `t^k` in `a^2`, each product of two different coefficients taken once.
    pub fn square(&self, k: usize, a: &[Option<A::Number>]) -> Term<A::Number> {
        self.square_without(0, k, a)
    }

    /// The part of the square's coefficient without `a_j a_(k-j)` for `j` below `skipped`.
    fn square_without(&self, skipped: usize, k: usize, a: &[Option<A::Number>]) -> Term<A::Number> {
        let once = self.convolution(k, skipped..k.div_ceil(2), a, a)?;
        let twice = self.sum(once.as_ref(), once.as_ref())?;
        match at(a, k / 2).filter(|_| k.is_multiple_of(2) && k / 2 >= skipped) {
            Some(middle) => {
                let product = self.base.mul(middle, middle)?;
                self.sum(twice.as_ref(), Some(&product))
            }
            None => Ok(twice),
        }
    }

    /// The coefficient of `t^k` in `c = a/b` from those of `c` below it; `inverse` is `1/b_0`.
    pub fn quotient(
        &self,
        k: usize,
        a: &[Option<A::Number>],
        b: &[Option<A::Number>],
        c: &[Option<A::Number>],
        inverse: &A::Number,
    ) -> Term<A::Number> {
        let known = self.convolution(k, 1..=k, b, c)?;
        self.times(inverse, self.difference(at(a, k), known.as_ref())?)
    }

    /// The coefficient of `t^k`, `k > 0`, in `c = sqrt a` from those of `c` below it; `inverse` is `1/(2 c_0)`.
    pub fn root(
        &self,
        k: usize,
        a: &[Option<A::Number>],
        c: &[Option<A::Number>],
        inverse: &A::Number,
    ) -> Term<A::Number> {
        let known = self.square_without(1, k, c)?;
        self.times(inverse, self.difference(at(a, k), known.as_ref())?)
    }

    /// The coefficient of `t^k`, `k > 0`, in `c` with `c' = a' d`: the exponential with `d = c`, the sine with the
    /// cosine as `d`, the cosine with minus the sine.
    pub fn driven(&self, k: usize, a: &[Option<A::Number>], d: &[Option<A::Number>]) -> Term<A::Number> {
        self.over(k, self.weighted(k, 1..=k, a, d)?)
    }

    /// The coefficient of `t^k`, `k > 0`, in `c` with `c' b = a'` from those of `c` below it; `inverse` is `1/b_0`.
    pub fn integral(
        &self,
        k: usize,
        a: &[Option<A::Number>],
        b: &[Option<A::Number>],
        c: &[Option<A::Number>],
        inverse: &A::Number,
    ) -> Term<A::Number> {
        let known = self.over(k, self.weighted(k, 1..k, c, b)?)?;
        self.times(inverse, self.difference(at(a, k), known.as_ref())?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Rationals;

    fn rationals(values: &[(i64, u64)]) -> Coefficients<RBig> {
        values.iter().map(|(n, d)| (*n != 0).then(|| RBig::from(*n) / RBig::from(*d))).collect()
    }

    fn whole(order: usize, mut next: impl FnMut(usize, &[Option<RBig>]) -> Term<RBig>) -> Coefficients<RBig> {
        let mut series = Vec::new();
        for k in 0..=order {
            let term = next(k, &series).unwrap();
            series.push(term.filter(|c| !c.is_zero()));
        }
        series
    }

    /// `(1 + 2t + 3t^2)^2 = 1 + 4t + 10t^2 + 12t^3 + 9t^4`, by hand; and divided by itself once.
    #[test]
    fn a_square_and_its_quotient() {
        let all = Recurrences::new(Rationals::default(), 5).unwrap();
        let a = rationals(&[(1, 1), (2, 1), (3, 1)]);
        let square = rationals(&[(1, 1), (4, 1), (10, 1), (12, 1), (9, 1), (0, 1)]);
        assert_eq!(whole(5, |k, _| all.square(k, &a)), square);
        assert_eq!(whole(5, |k, _| all.product(k, &a, &a)), square);
        let quotient = whole(5, |k, c| all.quotient(k, &square, &a, c, &RBig::ONE));
        assert_eq!(quotient[..3], a);
        assert!(quotient[3..].iter().all(Option::is_none));
    }

    /// The textbook series at zero: `exp t`, `sqrt(1+t)`, `log(1+t)`, and `atan t` from `1 + t^2`.
    #[test]
    fn the_series_of_every_textbook() {
        let all = Recurrences::new(Rationals::default(), 5).unwrap();
        let t = rationals(&[(0, 1), (1, 1)]);
        let one_more = rationals(&[(1, 1), (1, 1)]);
        let from = |start: (i64, u64), k: usize, rest: Term<RBig>| {
            if k == 0 { Ok(rationals(&[start]).remove(0)) } else { rest }
        };
        let exponential = whole(5, |k, c| from((1, 1), k, all.driven(k, &t, c)));
        assert_eq!(exponential, rationals(&[(1, 1), (1, 1), (1, 2), (1, 6), (1, 24), (1, 120)]));
        let half = RBig::ONE / RBig::from(2);
        let root = whole(5, |k, c| from((1, 1), k, all.root(k, &one_more, c, &half)));
        assert_eq!(root, rationals(&[(1, 1), (1, 2), (-1, 8), (1, 16), (-5, 128), (7, 256)]));
        let logarithm = |k, c: &[_]| from((0, 1), k, all.integral(k, &one_more, &one_more, c, &RBig::ONE));
        let known = rationals(&[(0, 1), (1, 1), (-1, 2), (1, 3), (-1, 4), (1, 5)]);
        assert_eq!(whole(5, logarithm), known);
        let bottom = rationals(&[(1, 1), (0, 1), (1, 1)]);
        let turn = whole(5, |k, c| from((0, 1), k, all.integral(k, &t, &bottom, c, &RBig::ONE)));
        assert_eq!(turn, rationals(&[(0, 1), (1, 1), (0, 1), (-1, 3), (0, 1), (1, 5)]));
    }
}
