//! A prime field with algebraic numbers adjoined: the cosine of a whole turn's part, and square roots, one upon another.
//!
//! An element is a sum of products of powers of what was adjoined, each below its degree. The product of two elements is
//! reduced by the defining equations and by nothing else, so that an element is zero exactly if it is zero *whatever signs the
//! roots have*: nothing has to be a quadratic residue, and no conjugate has to be chosen. The price are zero divisors where a
//! defining equation has a root already; by these is not divided.

use super::{Arithmetic, Function, PrimeField, Refusal};
use dashu::rational::RBig;
use palmistry_budget as budget;

/// A prime field `F`, extended to `F[y]/(m(y))` and that by square roots.
#[derive(Clone, Debug)]
pub struct Extension {
    field: PrimeField,
    /// The coefficients of the monic `m`, but for the leading one; `[0]`, of degree one, where there is no `y`.
    modulus: Vec<u64>,
    radicands: Vec<Vec<u64>>,
}

impl Extension {
    /// The field with a root `y` of a monic polynomial, whose other coefficients are given from the lowest on.
    pub fn new(field: PrimeField, modulus: &[i64]) -> Self {
        let modulus = modulus.iter().map(|c| field.integer(&(*c).into())).collect();
        Extension { field, modulus, radicands: Vec::new() }
    }

    /// The root `y` of the polynomial.
    pub fn generator(&self) -> Vec<u64> {
        if self.modulus.len() == 1 {
            return vec![self.field.neg(&self.modulus[0]).unwrap_or(0)];
        }
        let mut y = vec![0; self.modulus.len()];
        y[1] = self.field.integer(&1.into());
        y
    }

    /// A new square root of an element.
    pub fn adjoin_root(&mut self, radicand: Vec<u64>) -> Vec<u64> {
        let half = self.modulus.len() << self.radicands.len();
        self.radicands.push(radicand);
        let mut root = vec![0; 2 * half];
        root[half] = self.field.integer(&1.into());
        root
    }

    /// As short as it is: most numbers are rational, and cost what they cost in the prime field.
    fn trimmed(&self, mut a: Vec<u64>) -> Vec<u64> {
        loop {
            let half = match a.len() {
                1 => return a,
                length if length > self.modulus.len() => length / 2,
                _ => 1,
            };
            if a[half..].iter().any(|x| *x != 0) {
                return a;
            }
            a.truncate(half);
        }
    }

    fn add_up(&self, a: &[u64], b: &[u64], sign: bool) -> Vec<u64> {
        let at = |x: &[u64], i: usize| x.get(i).copied().unwrap_or(0);
        (0..a.len().max(b.len()))
            .map(|i| match sign {
                true => self.field.add(&at(a, i), &at(b, i)),
                false => self.field.sub(&at(a, i), &at(b, i)),
            })
            .map(|sum| sum.unwrap_or(0))
            .collect()
    }

    /// The halves before and after the last root of elements of a length.
    fn halves(a: &[u64], length: usize) -> (&[u64], &[u64]) {
        if a.len() < length { (a, &[]) } else { a.split_at(length / 2) }
    }

    /// The square of the root that doubles the length of elements to this.
    fn radicand(&self, length: usize) -> &[u64] {
        let level = (length / self.modulus.len()).trailing_zeros() as usize;
        &self.radicands[level - 1]
    }

    fn product(&self, a: &[u64], b: &[u64]) -> Vec<u64> {
        budget::steps(a.len() * b.len());
        let (short, long) = if a.len() <= b.len() { (a, b) } else { (b, a) };
        let times = |x: &u64, y: &u64| self.field.mul(x, y).unwrap_or(0);
        match (short, long.len()) {
            ([], _) => Vec::new(),
            ([factor], _) => long.iter().map(|x| times(x, factor)).collect(),
            (_, length) if length <= self.modulus.len() => {
                let mut all = vec![0; short.len() + long.len() - 1];
                for (i, x) in short.iter().enumerate() {
                    for (j, y) in long.iter().enumerate() {
                        all[i + j] = self.field.add(&all[i + j], &times(x, y)).unwrap_or(0);
                    }
                }
                self.reduced(all)
            }
            (_, length) => {
                let ((a0, a1), (b0, b1)) = (Self::halves(short, length), Self::halves(long, length));
                let tops = self.product(a1, b1);
                let mut low =
                    self.add_up(&self.product(a0, b0), &self.product(&tops, self.radicand(length)), true);
                let high = self.add_up(&self.product(a0, b1), &self.product(a1, b0), true);
                low.resize(length / 2, 0);
                low.extend(high);
                low.resize(length, 0);
                low
            }
        }
    }

    /// A polynomial in `y` modulo `m`.
    fn reduced(&self, mut all: Vec<u64>) -> Vec<u64> {
        let degree = self.modulus.len();
        while all.len() > degree {
            let lead = all.pop().unwrap_or(0);
            let start = all.len() - degree;
            for (i, c) in self.modulus.iter().enumerate() {
                let part = self.field.mul(&lead, c).unwrap_or(0);
                all[start + i] = self.field.sub(&all[start + i], &part).unwrap_or(0);
            }
        }
        all
    }

    fn inverse(&self, a: &[u64]) -> Option<Vec<u64>> {
        match a.len() {
            0 => None,
            1 => self.field.inverse(a[0]).map(|x| vec![x]),
            length if length <= self.modulus.len() => self.inverse_in_y(a),
            length => {
                // 1/(a + b t) = (a - b t)/(a^2 - b^2 u)
                let (a0, a1) = a.split_at(length / 2);
                let square = self.product(&self.product(a1, a1), self.radicand(length));
                let norm = self.trimmed(self.add_up(&self.product(a0, a0), &square, false));
                let inverse = self.inverse(&norm)?;
                let mut conjugate = a0.to_vec();
                conjugate.extend(self.add_up(&[0], a1, false));
                Some(self.product(&conjugate, &inverse))
            }
        }
    }

    /// By Euclid's algorithm for polynomials in `y`.
    fn inverse_in_y(&self, a: &[u64]) -> Option<Vec<u64>> {
        let one = self.field.integer(&1.into());
        let trim = |mut p: Vec<u64>| {
            while p.last() == Some(&0) {
                p.pop();
            }
            p
        };
        let mut whole = self.modulus.clone();
        whole.push(one);
        let (mut r0, mut r1) = (whole, trim(a.to_vec()));
        let (mut s0, mut s1): (Vec<u64>, Vec<u64>) = (Vec::new(), vec![one]);
        while r1.len() > 1 {
            let lead = self.field.inverse(*r1.last()?)?;
            while r0.len() >= r1.len() {
                let factor = self.field.mul(r0.last()?, &lead).ok()?;
                let shift = r0.len() - r1.len();
                let less = |p: &mut Vec<u64>, q: &[u64]| {
                    if p.len() < q.len() + shift {
                        p.resize(q.len() + shift, 0);
                    }
                    for (i, x) in q.iter().enumerate() {
                        let part = self.field.mul(x, &factor).unwrap_or(0);
                        p[i + shift] = self.field.sub(&p[i + shift], &part).unwrap_or(0);
                    }
                };
                less(&mut r0, &r1);
                less(&mut s0, &s1);
                r0 = trim(r0);
            }
            std::mem::swap(&mut r0, &mut r1);
            std::mem::swap(&mut s0, &mut s1);
        }
        let unit = self.field.inverse(*r1.first()?)?;
        let mut inverse = self.reduced(s1.iter().map(|x| self.field.mul(x, &unit).unwrap_or(0)).collect());
        inverse.resize(self.modulus.len(), 0);
        Some(inverse)
    }
}

impl Arithmetic for Extension {
    type Number = Vec<u64>;

    fn rational(&self, value: &RBig) -> Result<Vec<u64>, Refusal> {
        Ok(vec![self.field.rational(value)?])
    }
    fn pi(&self) -> Result<Vec<u64>, Refusal> {
        Err(Refusal::NoExactPi)
    }
    fn add(&self, a: &Vec<u64>, b: &Vec<u64>) -> Result<Vec<u64>, Refusal> {
        Ok(self.trimmed(self.add_up(a, b, true)))
    }
    fn sub(&self, a: &Vec<u64>, b: &Vec<u64>) -> Result<Vec<u64>, Refusal> {
        Ok(self.trimmed(self.add_up(a, b, false)))
    }
    fn mul(&self, a: &Vec<u64>, b: &Vec<u64>) -> Result<Vec<u64>, Refusal> {
        Ok(self.trimmed(self.product(a, b)))
    }
    fn div(&self, a: &Vec<u64>, b: &Vec<u64>) -> Result<Vec<u64>, Refusal> {
        if self.is_zero(b) == Some(true) {
            return Err(Refusal::DivisionByZero);
        }
        let inverse = self.inverse(b).ok_or(Refusal::DivisorNotSeparated)?;
        Ok(self.trimmed(self.product(a, &inverse)))
    }
    fn neg(&self, a: &Vec<u64>) -> Result<Vec<u64>, Refusal> {
        Ok(self.add_up(&[0], a, false))
    }
    fn apply(&self, function: Function, _: &Vec<u64>) -> Result<Vec<u64>, Refusal> {
        Err(Refusal::NoExactValue(function))
    }
    fn is_zero(&self, a: &Vec<u64>) -> Option<bool> {
        Some(a.iter().all(|x| *x == 0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn golden() -> Extension {
        // y^2 + y - 1, of which 2 cos(2 pi/5) is a root
        Extension::new(PrimeField::new((1 << 61) + 15), &[-1, 1])
    }

    /// By hand: (2 y + 1)^2 = 5, and 1/y = y + 1.
    #[test]
    fn the_golden_ratio_is_calculated_with() {
        let all = golden();
        let number = |n: i64| all.rational(&RBig::from(n)).unwrap();
        let y = all.generator();
        let root = all.add(&all.mul(&number(2), &y).unwrap(), &number(1)).unwrap();
        assert_eq!(all.mul(&root, &root).unwrap(), number(5));
        assert_eq!(all.div(&number(1), &y).unwrap(), all.add(&y, &number(1)).unwrap());
    }

    /// By hand: (1 + sqrt 2) (sqrt 2 - 1) = 1, and with t^2 = 1 + sqrt 2 the fourth power of t is 3 + 2 sqrt 2.
    #[test]
    fn roots_of_roots_are_divided_by() {
        let mut all = golden();
        let number = |n: i64| all.rational(&RBig::from(n)).unwrap();
        let (one, two, three) = (number(1), number(2), number(3));
        let root = all.adjoin_root(two.clone());
        let plus = all.add(&one, &root).unwrap();
        assert_eq!(all.div(&one, &plus).unwrap(), all.sub(&root, &one).unwrap());
        let nested = all.adjoin_root(plus);
        let fourth = all.power(&nested, 4).unwrap();
        assert_eq!(fourth, all.add(&three, &all.mul(&two, &root).unwrap()).unwrap());
        let sum = all.add(&nested, &all.generator()).unwrap();
        let back = all.mul(&all.div(&one, &sum).unwrap(), &sum).unwrap();
        assert_eq!(back, one);
        // another root of two: its difference from the first is no zero, and no divisor
        let other = all.adjoin_root(two);
        let difference = all.sub(&other, &root).unwrap();
        assert_eq!(all.is_zero(&difference), Some(false));
        assert_eq!(all.div(&one, &difference), Err(Refusal::DivisorNotSeparated));
    }
}
