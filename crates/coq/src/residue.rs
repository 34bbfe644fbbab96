//! Numbers modulo one prime.

use dashu::integer::IBig;
use dashu::rational::RBig;

/// The prime.
pub(crate) const PRIME: u64 = (1 << 61) - 1;

/// That of a whole number.
pub(crate) fn residue(value: &IBig) -> u64 {
    let rest = u64::try_from(value % IBig::from(PRIME)).ok();
    let negative = u64::try_from(-(value % IBig::from(PRIME))).ok();
    rest.or(negative.map(|negative| PRIME - negative)).unwrap_or_default() % PRIME
}

/// That of a fraction; nothing where the prime divides what is below.
pub(crate) fn of_fraction(value: &RBig) -> Option<u64> {
    let below = residue(&IBig::from(value.denominator().clone()));
    (below != 0).then(|| times(residue(value.numerator()), inverse(below)))
}

pub(crate) fn times(a: u64, b: u64) -> u64 {
    (u128::from(a) * u128::from(b) % u128::from(PRIME)) as u64
}

pub(crate) fn less(a: u64, b: u64) -> u64 {
    (a + (PRIME - b)) % PRIME
}

/// By Fermat's little theorem.
pub(crate) fn inverse(of: u64) -> u64 {
    let (mut found, mut square, mut power) = (1, of, PRIME - 2);
    while power > 0 {
        if power % 2 == 1 {
            found = times(found, square);
        }
        (square, power) = (times(square, square), power / 2);
    }
    found
}
