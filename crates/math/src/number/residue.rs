//! Residues modulo a prime of 62 bits, in Montgomery's form, as an [`Arithmetic`].
//!
//! What holds over the rationals holds modulo every prime that divides no denominator; what differs modulo one prime
//! differs over the rationals. So a nonzero minor found here is a proof of rank, and an identity that survives
//! random points and random primes is wrong with a probability that can be bounded.
//!
//! Reference: P. L. Montgomery, *Modular multiplication without trial division*, Math. Comp. 44 (1985).

use super::{Arithmetic, Function, Refusal};
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_budget as budget;
use rand::{Rng, RngExt};

/// The integers modulo a prime `p`, `2^61 < p < 2^62`. A number is `x * 2^64 mod p`, below `p`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrimeField {
    p: u64,
    /// `-1/p mod 2^64`
    negative_inverse: u64,
    /// `2^128 mod p`, which brings an integer into Montgomery's form
    square: u64,
    /// `2^64 mod p`, which is one
    one: u64,
}

/// A lower bound on the number of primes between 2^61 and 2^62, as a power of two.
///
/// Dusart's bounds (1999) `x/(ln x - 1) < pi(x) < x/(ln x - 1.1)` for large x give more than 5.3e16 > 2^55.5.
pub const LOG2_PRIMES: f64 = 55.5;

impl PrimeField {
    /// The field of `p` elements.
    ///
    /// # Panics
    /// If `p` is not a prime between 2^61 and 2^62.
    pub fn new(p: u64) -> Self {
        assert!((1 << 61..1 << 62).contains(&p) && is_prime(p), "{p} is not a prime between 2^61 and 2^62");
        let mut inverse = p; // Newton's iteration doubles the correct bits: 3, 6, 12, 24, 48, 96
        for _ in 0..5 {
            inverse = inverse.wrapping_mul(2u64.wrapping_sub(p.wrapping_mul(inverse)));
        }
        let one = ((1u128 << 64) % u128::from(p)) as u64;
        let square = (u128::from(one) * u128::from(one) % u128::from(p)) as u64;
        PrimeField { p, negative_inverse: inverse.wrapping_neg(), square, one }
    }

    /// A field whose prime is drawn uniformly from those between 2^61 and 2^62.
    pub fn random(rng: &mut impl Rng) -> Self {
        loop {
            let candidate = rng.random_range(1u64 << 61..1 << 62) | 1;
            if is_prime(candidate) {
                return PrimeField::new(candidate);
            }
        }
    }

    /// The prime.
    pub fn modulus(&self) -> u64 {
        self.p
    }

    /// A residue drawn uniformly.
    pub fn draw(&self, rng: &mut impl Rng) -> u64 {
        rng.random_range(0..self.p)
    }

    /// The residue of an integer of any length.
    pub fn integer(&self, value: &IBig) -> u64 {
        let p = IBig::from(self.p);
        let remainder = ((value % &p) + &p) % &p;
        self.product(u64::try_from(remainder).unwrap_or(0), self.square)
    }

    /// The integer from zero to the prime that a residue is the class of.
    pub fn representative(&self, a: u64) -> u64 {
        self.product(a, 1)
    }

    /// Montgomery's product `a * b / 2^64 mod p`.
    #[inline]
    pub fn product(&self, a: u64, b: u64) -> u64 {
        self.reduced(u128::from(a) * u128::from(b))
    }

    /// `t / 2^64 mod p`, for `t` below `p * 2^64`.
    #[inline]
    pub fn reduced(&self, t: u128) -> u64 {
        let m = (t as u64).wrapping_mul(self.negative_inverse);
        let sum = t + u128::from(m) * u128::from(self.p); // below 2^124 + 2^126
        let high = (sum >> 64) as u64;
        if high >= self.p { high - self.p } else { high }
    }

    /// One.
    pub fn one(&self) -> u64 {
        self.one
    }

    /// `a + b`
    #[inline]
    pub fn sum(&self, a: u64, b: u64) -> u64 {
        let sum = a + b;
        if sum >= self.p { sum - self.p } else { sum }
    }

    /// The sum of `a_i b_(n-1-i)` of two rows of the same length: a coefficient of a product of series. Products are summed before they are
    /// reduced, and a multiple of `p` is taken away whenever the sum has outgrown it.
    pub fn dot_reversed(&self, a: &[u64], b: &[u64]) -> u64 {
        const AT_ONCE: usize = 8;
        let bound = u128::from(self.p) << 64; // below 2^126, and each product is below 2^124: eight of them fit above it
        let mut sum = 0u128;
        for (a, b) in a.chunks(AT_ONCE).zip(b.rchunks(AT_ONCE)) {
            for (a, b) in a.iter().zip(b.iter().rev()) {
                sum += u128::from(*a) * u128::from(*b);
            }
            while sum >= bound {
                sum -= bound;
            }
        }
        self.reduced(sum)
    }

    /// `row -= factor * other`, from one entry to the next.
    pub fn subtract_multiple(&self, row: &mut [u64], factor: u64, other: &[u64]) {
        if factor == 0 {
            return;
        }
        let factor = self.p - factor;
        for (entry, other) in row.iter_mut().zip(other) {
            if *other != 0 {
                *entry = self.sum(*entry, self.product(factor, *other));
            }
        }
    }

    /// A random point of the unit circle, by the tangent of its half angle.
    pub fn draw_unit(&self, rng: &mut impl Rng) -> (u64, u64) {
        loop {
            let tangent = self.draw(rng);
            let square = self.product(tangent, tangent);
            let twice = self.sum(tangent, tangent);
            if let Some(inverse) = self.inverse(self.sum(self.one, square)) {
                let cosine = self.product(self.sum(self.one, self.p - square), inverse);
                return (self.product(twice, inverse), cosine);
            }
        }
    }

    /// A number whose square this is, if there is one (A. Tonelli, 1891; D. Shanks, 1973).
    pub fn square_root(&self, a: u64) -> Option<u64> {
        if a == 0 {
            return Some(0);
        }
        let minus_one = self.p - self.one;
        let (twos, odd) = ((self.p - 1).trailing_zeros(), (self.p - 1) >> (self.p - 1).trailing_zeros());
        let euler = (self.p - 1) / 2;
        if self.raised(a, euler) != self.one {
            return None;
        }
        // any number that is no square; every second one is none
        let mut candidate = self.sum(self.one, self.one);
        while self.raised(candidate, euler) != minus_one {
            candidate = self.sum(candidate, self.one);
        }
        let (mut generator, mut order) = (self.raised(candidate, odd), twos);
        let mut root = self.raised(a, odd.div_ceil(2));
        let mut rest = self.raised(a, odd);
        while rest != self.one {
            // the rest has order 2^k, k below the generator's
            let (mut k, mut power) = (0, rest);
            while power != self.one {
                power = self.product(power, power);
                k += 1;
            }
            for _ in 0..order - k - 1 {
                generator = self.product(generator, generator);
            }
            root = self.product(root, generator);
            generator = self.product(generator, generator);
            rest = self.product(rest, generator);
            order = k;
        }
        Some(root)
    }

    /// `a^exponent`
    fn raised(&self, a: u64, mut exponent: u64) -> u64 {
        let (mut result, mut square) = (self.one, a);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = self.product(result, square);
            }
            square = self.product(square, square);
            exponent >>= 1;
        }
        result
    }

    /// `1/a` by Fermat's theorem; `None` for zero.
    pub fn inverse(&self, a: u64) -> Option<u64> {
        if a == 0 {
            return None;
        }
        Some(self.raised(a, self.p - 2))
    }
}

impl Arithmetic for PrimeField {
    type Number = u64;

    fn rational(&self, value: &RBig) -> Result<u64, Refusal> {
        let top = self.integer(value.numerator());
        if value.denominator().is_one() {
            return Ok(top);
        }
        let bottom = self.integer(&IBig::from(value.denominator().clone()));
        self.div(&top, &bottom)
    }
    fn pi(&self) -> Result<u64, Refusal> {
        Err(Refusal::NoExactPi)
    }
    #[inline]
    fn add(&self, a: &u64, b: &u64) -> Result<u64, Refusal> {
        Ok(self.sum(*a, *b))
    }
    #[inline]
    fn sub(&self, a: &u64, b: &u64) -> Result<u64, Refusal> {
        Ok(if a >= b { a - b } else { a + self.p - b })
    }
    #[inline]
    fn mul(&self, a: &u64, b: &u64) -> Result<u64, Refusal> {
        Ok(self.product(*a, *b))
    }
    fn div(&self, a: &u64, b: &u64) -> Result<u64, Refusal> {
        let inverse = self.inverse(*b).ok_or(Refusal::DivisionByZero)?;
        Ok(self.product(*a, inverse))
    }
    #[inline]
    fn neg(&self, a: &u64) -> Result<u64, Refusal> {
        Ok(if *a == 0 { 0 } else { self.p - a })
    }
    fn apply(&self, function: Function, _: &u64) -> Result<u64, Refusal> {
        Err(Refusal::NoExactValue(function))
    }
    #[inline]
    fn is_zero(&self, a: &u64) -> Option<bool> {
        Some(*a == 0)
    }
}

/// Miller and Rabin's test with the twelve bases that decide it for every number below 2^64
/// (Sorenson and Webster, *Strong pseudoprimes to twelve prime bases*, Math. Comp. 86 (2017)).
fn is_prime(n: u64) -> bool {
    const BASES: [u64; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];
    if n < 2 || BASES.iter().any(|b| n.is_multiple_of(*b)) {
        return BASES.contains(&n);
    }
    // so many products of each base
    budget::steps(BASES.len() * 256);
    let times = |a: u64, b: u64| (u128::from(a) * u128::from(b) % u128::from(n)) as u64;
    let twos = (n - 1).trailing_zeros();
    let odd = (n - 1) >> twos;
    BASES.iter().all(|&base| {
        let (mut x, mut square, mut rest) = (1, base, odd);
        while rest > 0 {
            if rest & 1 == 1 {
                x = times(x, square);
            }
            square = times(square, square);
            rest >>= 1;
        }
        if x == 1 || x == n - 1 {
            return true;
        }
        (1..twos).any(|_| {
            x = times(x, x);
            x == n - 1
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    /// The least prime above 2^61 is 2^61 + 15 (OEIS A014210: next prime after 2^n).
    const LEAST: u64 = (1 << 61) + 15;

    #[test]
    fn primes_are_told_from_composites() {
        assert!(is_prime(LEAST));
        assert!((1..15).all(|k| !is_prime((1 << 61) + k)));
        assert!(!is_prime(3215031751)); // strong pseudoprime to 2, 3, 5 and 7
    }

    #[test]
    fn the_image_of_a_sum_is_the_sum_of_the_images() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        for _ in 0..200 {
            let field = PrimeField::random(&mut rng);
            let mut draw = || {
                let top: i64 = rng.random_range(-1_000_000..1_000_000);
                RBig::from_parts(top.into(), rng.random_range(1u64..1_000_000).into())
            };
            let (a, b) = (draw(), draw());
            let image = |value: &RBig| field.rational(value).unwrap();
            assert_eq!(field.add(&image(&a), &image(&b)), Ok(image(&(&a + &b))));
            assert_eq!(field.sub(&image(&a), &image(&b)), Ok(image(&(&a - &b))));
            assert_eq!(field.mul(&image(&a), &image(&b)), Ok(image(&(&a * &b))));
            if !b.is_zero() {
                assert_eq!(field.div(&image(&a), &image(&b)), Ok(image(&(&a / &b))));
            }
        }
    }

    #[test]
    fn zero_has_no_inverse() {
        assert_eq!(PrimeField::new(LEAST).div(&1, &0), Err(Refusal::DivisionByZero));
    }
}
