//! Parts of a whole turn: `2 cos(2 pi/N)` as an algebraic integer.
//!
//! With a primitive `N`-th root of unity `z` it is `y = z + 1/z`, the cosine of `k` of these parts is half of `V_k(y) = z^k +
//! z^-k`, where `V_0 = 2`, `V_1 = y`, `V_(k+1) = y V_k - V_(k-1)`; and the minimal polynomial of `y` follows from the
//! cyclotomic polynomial, which is palindromic: `sum of a_j z^j = z^(d/2) (a_(d/2) + sum of a_(d/2+k) V_k)`.

/// A polynomial in integers, from the lowest coefficient on.
type Integers = Vec<i64>;

/// The field of the cosines of whole multiples of `2 pi/N`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Turn {
    /// Into how many parts a turn is divided.
    pub parts: u64,
    /// The minimal polynomial of `2 cos(2 pi/N)`, but for its leading coefficient, which is one.
    pub minimal: Integers,
    /// The largest sum of magnitudes of coefficients of a power of `z`, modulo the cyclotomic polynomial.
    pub largest_sum: u64,
}

/// No turn is divided further than into parts whose cosine has this degree. All coefficients then fit by far.
const LARGEST_DEGREE: usize = 24;

impl Turn {
    /// A turn in `parts` parts; `None` where the degree is beyond what is calculated with.
    pub fn new(parts: u64) -> Option<Turn> {
        if parts == 0 || totient(parts) as usize > 2 * LARGEST_DEGREE {
            return None;
        }
        if parts <= 2 {
            // 2 cos 2 pi = 2, 2 cos pi = -2
            let minimal = vec![if parts == 1 { -2 } else { 2 }];
            return Some(Turn { parts, minimal, largest_sum: 1 });
        }
        let cyclotomic = cyclotomic(parts);
        let middle = (cyclotomic.len() - 1) / 2;
        let mut minimal = vec![0; middle + 1];
        minimal[0] = cyclotomic[middle];
        for (k, chebyshev) in chebyshev(middle).iter().enumerate().skip(1) {
            for (i, c) in chebyshev.iter().enumerate() {
                minimal[i] += cyclotomic[middle + k] * c;
            }
        }
        minimal.pop();
        let largest_sum = largest_sum(&cyclotomic, parts);
        Some(Turn { parts, minimal, largest_sum })
    }

    /// Twice the cosine of `k` parts, as a polynomial in `y`.
    pub fn twice_cosine(&self, k: u64) -> Integers {
        let k = (k % self.parts).min(self.parts - k % self.parts);
        let (mut before, mut now) = (self.reduced(vec![2]), self.reduced(vec![0, 1]));
        if k == 0 {
            return before;
        }
        for _ in 1..k {
            let mut next = vec![0];
            next.extend(&now);
            for (i, c) in before.iter().enumerate() {
                next[i] -= c;
            }
            before = now;
            now = self.reduced(next);
        }
        now
    }

    /// A polynomial in `y` modulo the minimal one.
    pub fn reduced(&self, mut all: Integers) -> Integers {
        let degree = self.minimal.len();
        while all.len() > degree {
            let lead = all.pop().unwrap_or(0);
            let start = all.len() - degree;
            for (i, c) in self.minimal.iter().enumerate() {
                all[start + i] -= lead * c;
            }
        }
        all.resize(degree, 0);
        all
    }

    /// Whether the square root of a prime is a sum of cosines of these parts.
    pub fn has_root_of(&self, prime: u64) -> bool {
        let of_parts = |n: u64| self.parts.is_multiple_of(n);
        match prime {
            2 => of_parts(8),
            _ if prime % 4 == 1 => of_parts(prime),
            _ => of_parts(prime) && of_parts(4),
        }
    }

    /// Twice the square root of a prime that [`Turn::has_root_of`] has, by Gauss's sum: over all `a` modulo the prime, of
    /// `(a/p) cos(2 pi a/p)` for a prime that is one more than a multiple of four, of `(a/p) sin(2 pi a/p)` for the others.
    pub fn twice_root_of(&self, prime: u64) -> Integers {
        if prime == 2 {
            // sqrt(2) = 2 cos(2 pi/8)
            return self.twice_cosine(self.parts / 8).iter().map(|c| 2 * c).collect();
        }
        let mut sum = vec![0; self.minimal.len()];
        for a in 1..prime {
            let residue = (1..prime).any(|x| x * x % prime == a);
            let place = a * (self.parts / prime);
            // sin u = cos(u - pi/2)
            let place = if prime % 4 == 1 { place } else { place + self.parts - self.parts / 4 };
            for (s, c) in sum.iter_mut().zip(self.twice_cosine(place)) {
                *s += if residue { c } else { -c };
            }
        }
        sum
    }
}

/// How many numbers up to this are prime to it.
fn totient(n: u64) -> u64 {
    let (mut rest, mut found, mut prime) = (n, n, 2);
    while prime * prime <= rest {
        if rest.is_multiple_of(prime) {
            found -= found / prime;
            while rest.is_multiple_of(prime) {
                rest /= prime;
            }
        }
        prime += 1;
    }
    if rest > 1 { found - found / rest } else { found }
}

/// The polynomials `V_0` to `V_most`, not reduced.
fn chebyshev(most: usize) -> Vec<Integers> {
    let mut all = vec![vec![2], vec![0, 1]];
    for k in 2..=most {
        let mut next = vec![0];
        next.extend(&all[k - 1]);
        for (i, c) in all[k - 2].iter().enumerate() {
            next[i] -= c;
        }
        all.push(next);
    }
    all
}

/// The cyclotomic polynomial: `x^n - 1` divided by those of all proper divisors of `n`.
fn cyclotomic(n: u64) -> Integers {
    let mut all = vec![0; n as usize + 1];
    (all[0], all[n as usize]) = (-1, 1);
    for divisor in (1..n).filter(|d| n.is_multiple_of(*d)) {
        let by = cyclotomic(divisor);
        let mut quotient = vec![0; all.len() - by.len() + 1];
        for i in (0..quotient.len()).rev() {
            quotient[i] = all[i + by.len() - 1];
            for (j, c) in by.iter().enumerate() {
                all[i + j] -= quotient[i] * c;
            }
        }
        all = quotient;
    }
    all
}

/// The largest sum of magnitudes of coefficients of `x^k` modulo a monic polynomial, for `k` below `n`.
fn largest_sum(monic: &[i64], n: u64) -> u64 {
    let degree = monic.len() - 1;
    let mut power = vec![0; degree];
    power[0] = 1i64;
    let mut largest = 1;
    for _ in 1..n {
        let lead = power[degree - 1];
        power.rotate_right(1);
        power[0] = 0;
        for (p, c) in power.iter_mut().zip(monic) {
            *p -= lead * c;
        }
        largest = largest.max(power.iter().map(|c| c.unsigned_abs()).sum());
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(polynomial: &[i64], y: f64) -> f64 {
        polynomial.iter().rev().fold(0.0, |sum, c| sum * y + *c as f64)
    }

    /// 2 cos(2 pi/5) has y^2 + y - 1, 2 cos(2 pi/7) has y^3 + y^2 - 2 y - 1 (any textbook on constructing polygons).
    #[test]
    fn minimal_polynomials_are_those_of_the_textbooks() {
        assert_eq!(Turn::new(5).unwrap().minimal, [-1, 1]);
        assert_eq!(Turn::new(7).unwrap().minimal, [-1, -2, 1]);
        assert_eq!(Turn::new(8).unwrap().minimal, [-2, 0]);
        assert_eq!(Turn::new(4).unwrap().minimal, [0]);
        assert_eq!(Turn::new(1009), None);
    }

    #[test]
    fn cosines_and_roots_have_the_values_of_a_calculator() {
        // no number beyond 210 has fewer than 49 numbers below it that are prime to it
        assert!((211..2000).all(|parts| Turn::new(parts).is_none()));
        for parts in 1..=210 {
            let Some(turn) = Turn::new(parts) else { continue };
            let largest = turn.minimal.iter().map(|c| c.unsigned_abs()).max().unwrap();
            assert!(largest < 1 << 24 && turn.largest_sum < 1 << 8, "{parts}");
            let part = std::f64::consts::TAU / parts as f64;
            let y = 2.0 * part.cos();
            for k in 0..parts {
                let expected = 2.0 * (part * k as f64).cos();
                let cosine = turn.twice_cosine(k);
                assert!(cosine.iter().all(|c| c.unsigned_abs() < 1 << 32));
                assert!((near(&cosine, y) - expected).abs() < 1e-3, "{k} of {parts}");
            }
            for prime in [2u64, 3, 5, 7, 11, 13, 17].into_iter().filter(|prime| turn.has_root_of(*prime)) {
                let expected = 2.0 * (prime as f64).sqrt();
                assert!((near(&turn.twice_root_of(prime), y) - expected).abs() < 1e-4, "{prime} of {parts}");
            }
        }
    }
}
