//! Polynomials in one variable with rational coefficients, lowest first and the last one not zero: how many real zeros they have,
//! which of these are rational, and what two of them have in common.

use dashu::base::Sign;
use dashu::rational::RBig;
use palmistry_math::number::{Arithmetic, Function, Rationals};

/// Rational zeros of polynomials of degree three and more are looked for among these numerators and denominators.
const LARGEST: (i64, i64) = (12, 5);

/// How many different real zeros there are (Sturm); none are counted of what vanishes everywhere.
pub(super) fn zeros_of(polynomial: &[RBig]) -> usize {
    if polynomial.len() < 2 {
        return 0;
    }
    let slope: Vec<RBig> =
        polynomial.iter().enumerate().skip(1).map(|(power, value)| value * RBig::from(power)).collect();
    let mut chain = vec![polynomial.to_vec(), slope];
    while let [.., a, b] = &chain[..] {
        let rest: Vec<RBig> = remainder(a, b).into_iter().map(|value| -value).collect();
        if rest.is_empty() {
            break;
        }
        chain.push(rest);
    }
    let changes = |negative: bool| {
        let signs: Vec<Sign> = chain
            .iter()
            .filter_map(|values| {
                let turned = negative && values.len().is_multiple_of(2);
                values.last().map(|lead| if turned { -lead.sign() } else { lead.sign() })
            })
            .collect();
        signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
    };
    changes(true) - changes(false)
}

/// The greatest common divisor, up to a factor; of one coefficient where there is none.
pub(super) fn common(a: &[RBig], b: &[RBig]) -> Vec<RBig> {
    let (mut a, mut b) = (a.to_vec(), b.to_vec());
    while !b.is_empty() {
        let rest = remainder(&a, &b);
        (a, b) = (b, rest);
    }
    a
}

/// Rational zeros: all of them up to degree two, else those that are simple.
pub(super) fn rational_zeros(polynomial: &[RBig]) -> Vec<RBig> {
    match polynomial {
        [] | [_] => Vec::new(),
        [c, b] => vec![-c / b],
        [c, b, a] => {
            let below = b * b - a * c * RBig::from(4);
            let Ok(root) = Rationals::default().apply(Function::Sqrt, &below) else { return Vec::new() };
            let twice = a + a;
            let mut found = vec![(-b + &root) / &twice, (-b - &root) / &twice];
            found.dedup();
            found
        }
        _ => {
            let mut found: Vec<RBig> = Vec::new();
            for bottom in 1..=LARGEST.1 {
                for top in -LARGEST.0..=LARGEST.0 {
                    let candidate = RBig::from(top) / RBig::from(bottom);
                    let value = polynomial.iter().rev().fold(RBig::ZERO, |sum, c| sum * &candidate + c);
                    if value.is_zero() && !found.contains(&candidate) {
                        found.push(candidate);
                    }
                }
            }
            found
        }
    }
}

/// The remainder of a division.
fn remainder(a: &[RBig], b: &[RBig]) -> Vec<RBig> {
    let mut rest = a.to_vec();
    while rest.len() >= b.len() {
        let (Some(top), Some(lead)) = (rest.last().cloned(), b.last()) else { break };
        let factor = top / lead;
        let shift = rest.len() - b.len();
        for (at, value) in b.iter().enumerate() {
            rest[shift + at] -= &factor * value;
        }
        rest.pop();
        while rest.last().is_some_and(RBig::is_zero) {
            rest.pop();
        }
    }
    while rest.last().is_some_and(RBig::is_zero) {
        rest.pop();
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(values: &[i64]) -> Vec<RBig> {
        values.iter().map(|value| RBig::from(*value)).collect()
    }

    /// `2x^2 - x - 1 = (2x + 1)(x - 1)`, `x^2 - 2` has no rational zero and two real ones, `x^3 - x = x(x - 1)(x + 1)`; the first and
    /// the last have `x - 1` in common.
    #[test]
    fn zeros_and_common_factors() {
        let sorted = |values: &[i64]| {
            let mut found = rational_zeros(&numbers(values));
            found.sort();
            found
        };
        let half = RBig::from(-1) / RBig::from(2);
        assert_eq!(sorted(&[-1, -1, 2]), [half, RBig::ONE]);
        assert_eq!((sorted(&[-2, 0, 1]), zeros_of(&numbers(&[-2, 0, 1]))), (Vec::new(), 2));
        assert_eq!(sorted(&[0, -1, 0, 1]), numbers(&[-1, 0, 1]));
        assert_eq!(common(&numbers(&[-1, -1, 2]), &numbers(&[0, -1, 0, 1])).len(), 2);
        assert_eq!(common(&numbers(&[-2, 0, 1]), &numbers(&[0, -1, 0, 1])).len(), 1);
        assert_eq!(zeros_of(&numbers(&[3])), 0);
    }
}
