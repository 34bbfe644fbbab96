//! Polynomials in one variable modulo a prime, constant first.

use palmistry_math::number::PrimeField;

/// A greatest common divisor, by Euclid's algorithm; no coefficients where both are zero.
pub(super) fn gcd(field: &PrimeField, mut a: Vec<u64>, mut b: Vec<u64>) -> Vec<u64> {
    let trim = |p: &mut Vec<u64>| {
        while p.last() == Some(&0) {
            p.pop();
        }
    };
    trim(&mut a);
    trim(&mut b);
    while let Some(inverse) = b.last().and_then(|lead| field.inverse(*lead)) {
        while a.len() >= b.len() {
            let shift = a.len() - b.len();
            let factor = field.product(a[a.len() - 1], inverse);
            field.subtract_multiple(&mut a[shift..], factor, &b);
            trim(&mut a);
            if a.is_empty() {
                break;
            }
        }
        std::mem::swap(&mut a, &mut b);
    }
    a
}
