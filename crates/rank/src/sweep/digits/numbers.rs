//! What is asked of numbers in which singular values are computed to many digits.

use dashu::rational::RBig;
use palmistry_math::number::{
    Arithmetic, DoubleDouble, Enclosure, Enclosures, Floats, Interval, Refusal, rational_from_f64,
};

/// Numbers in which an iteration can go on without losing digits to its own error bounds.
pub trait Approximate: Arithmetic {
    /// One number near all that `a` may be.
    ///
    /// # Errors
    /// Where there is none, or none that can be held.
    fn middle(&self, a: &Self::Number) -> Result<Self::Number, Refusal>;

    /// A double near it.
    fn near(&self, a: &Self::Number) -> f64;
}

/// Numbers that enclose what they stand for.
pub trait Enclosing: Approximate {
    /// The least set that holds two.
    fn hull(&self, a: &Self::Number, b: &Self::Number) -> Self::Number;

    /// Both ends, exactly; `None` where they are not finite.
    fn ends(&self, a: &Self::Number) -> Option<(RBig, RBig)>;
}

impl Approximate for Floats<f64> {
    fn middle(&self, a: &f64) -> Result<f64, Refusal> {
        Ok(*a)
    }
    fn near(&self, a: &f64) -> f64 {
        *a
    }
}

impl Approximate for Floats<DoubleDouble> {
    fn middle(&self, a: &DoubleDouble) -> Result<DoubleDouble, Refusal> {
        Ok(*a)
    }
    fn near(&self, a: &DoubleDouble) -> f64 {
        a.hi()
    }
}

impl Approximate for Floats<Interval> {
    fn middle(&self, a: &Interval) -> Result<Interval, Refusal> {
        let middle = a.mid();
        if middle.is_finite() { Ok(Interval::point(middle)) } else { Err(Refusal::NotFinite) }
    }
    fn near(&self, a: &Interval) -> f64 {
        a.mid()
    }
}

impl Enclosing for Floats<Interval> {
    fn hull(&self, a: &Interval, b: &Interval) -> Interval {
        a.hull(*b)
    }
    fn ends(&self, a: &Interval) -> Option<(RBig, RBig)> {
        Some((rational_from_f64(a.low())?, rational_from_f64(a.high())?))
    }
}

impl Approximate for Enclosures {
    fn middle(&self, a: &Enclosure) -> Result<Enclosure, Refusal> {
        Enclosures::middle(self, a)
    }
    fn near(&self, a: &Enclosure) -> f64 {
        a.midpoint()
    }
}

impl Enclosing for Enclosures {
    fn hull(&self, a: &Enclosure, b: &Enclosure) -> Enclosure {
        Enclosures::hull(a, b)
    }
    fn ends(&self, a: &Enclosure) -> Option<(RBig, RBig)> {
        Some((a.low(), a.high()))
    }
}

/// `sum_k a_k b_k`
pub fn dot<'n, A: Arithmetic>(
    on: &A,
    pairs: impl Iterator<Item = (&'n A::Number, &'n A::Number)>,
) -> Result<A::Number, Refusal>
where
    A::Number: 'n,
{
    let mut sum = on.rational(&RBig::ZERO)?;
    for (a, b) in pairs {
        sum = on.add(&sum, &on.mul(a, b)?)?;
    }
    Ok(sum)
}

/// The inverse of a square matrix by elimination; approximately, and from approximate entries. Refuses where a pivot is
/// zero.
pub fn inverse<A: Approximate>(on: &A, matrix: &[Vec<A::Number>]) -> Result<Vec<Vec<A::Number>>, Refusal> {
    let size = matrix.len();
    let mut work = Vec::with_capacity(size);
    for (i, row) in matrix.iter().enumerate() {
        let mut wide = Vec::with_capacity(2 * size);
        for entry in row {
            wide.push(on.middle(entry)?);
        }
        for j in 0..size {
            wide.push(on.rational(&RBig::from(u8::from(i == j)))?);
        }
        work.push(wide);
    }
    for k in 0..size {
        let magnitude = |row: &usize| on.near(&work[*row][k]).abs();
        let pivot = (k..size).max_by(|a, b| magnitude(a).total_cmp(&magnitude(b))).unwrap_or(k);
        work.swap(k, pivot);
        let divisor = work[k][k].clone();
        for entry in &mut work[k] {
            *entry = on.middle(&on.div(entry, &divisor)?)?;
        }
        let pivot_row = work[k].clone();
        for (i, row) in work.iter_mut().enumerate() {
            if i == k {
                continue;
            }
            let factor = row[k].clone();
            for (entry, above) in row.iter_mut().zip(&pivot_row) {
                *entry = on.middle(&on.sub(entry, &on.mul(&factor, above)?)?)?;
            }
        }
    }
    Ok(work.into_iter().map(|mut row| row.split_off(size)).collect())
}
