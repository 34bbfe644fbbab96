//! Polynomials in one variable with rational coefficients, lowest first and the last one not zero: how many real zeros they have
//! and where, which of these are rational, and what two of them have in common.
//!
//! Zeros are counted by Sturm's chain of remainders (J. C. F. Sturm, Mémoire sur la résolution des équations numériques, 1829) and
//! enclosed by halving; everything is exact.

use super::{Arithmetic, Function, Rationals, rational_to_f64, round_to_decimal};
use dashu::base::{BitTest, Gcd, Sign};
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use palmistry_budget as budget;

/// Rational zeros of polynomials of degree three and more are looked for among these numerators and denominators.
const LARGEST: (i64, i64) = (12, 5);

/// Leading coefficients of more bits are not asked whether a zero is rational.
const LONGEST_LEAD: usize = 256;

/// An interval with rational ends that holds one zero of a polynomial. The ends are no zeros, and the polynomial without its
/// multiple factors has different signs there; or both are the zero itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RealRoot {
    /// The zero is greater, or it is this number.
    pub low: RBig,
    /// The zero is less, or it is this number.
    pub high: RBig,
}

impl RealRoot {
    /// The zero, where it is known to be rational.
    pub fn exact(&self) -> Option<&RBig> {
        (self.low == self.high).then_some(&self.low)
    }

    /// Halves the interval, of which this must be a polynomial without multiple factors and no other zero.
    pub fn halve(&mut self, polynomial: &[RBig]) {
        if self.exact().is_some() {
            return;
        }
        let middle = (&self.low + &self.high) / RBig::from(2);
        match sign_at(polynomial, &middle) {
            None => (self.low, self.high) = (middle.clone(), middle),
            there if there == sign_at(polynomial, &self.low) => self.low = middle,
            _ => self.high = middle,
        }
    }
}

/// The bits to which a zero is enclosed before it is shown, and the digits that are shown.
const BITS: usize = 64;
const DIGITS: usize = 12;

impl RealRoot {
    /// Halves the interval until it is as narrow as what is shown.
    pub fn narrow(&mut self, polynomial: &[RBig]) {
        let narrow = RBig::ONE / RBig::from(IBig::ONE << BITS);
        while &self.high - &self.low > narrow {
            self.halve(polynomial);
        }
    }

    /// A double near it, once it is [narrow](RealRoot::narrow).
    pub fn near(&self) -> f64 {
        rational_to_f64(&((&self.low + &self.high) / RBig::from(2)))
    }

    /// The zero as it is printed: its digits, and its polynomial in a variable of this name.
    pub fn text(&self, name: &str, polynomial: &[RBig]) -> String {
        format!("{} (a zero of {})", round_to_decimal(&self.low, DIGITS), text(name, polynomial))
    }
}

/// A polynomial as one writes it, highest power first.
pub fn text(name: &str, coefficients: &[RBig]) -> String {
    let mut text = String::new();
    for (power, value) in coefficients.iter().enumerate().rev().filter(|(_, value)| !value.is_zero()) {
        let negative = *value < RBig::ZERO;
        text.push_str(match (text.is_empty(), negative) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        });
        let size = if negative { -value } else { value.clone() };
        let factor = match power {
            0 => String::new(),
            1 => name.to_owned(),
            _ => format!("{name}^{power}"),
        };
        match (power, size.is_one()) {
            (0, _) => text.push_str(&size.to_string()),
            (_, true) => text.push_str(&factor),
            (_, false) => text.push_str(&format!("{size}*{factor}")),
        }
    }
    text
}

/// The value at a number (Horner).
pub fn value_at(polynomial: &[RBig], x: &RBig) -> RBig {
    budget::steps(polynomial.len());
    polynomial.iter().rev().fold(RBig::ZERO, |sum, c| sum * x + c)
}

/// The sign of the value at a number; `None` where it is zero.
pub fn sign_at(polynomial: &[RBig], x: &RBig) -> Option<Sign> {
    let value = value_at(polynomial, x);
    (!value.is_zero()).then(|| value.sign())
}

/// How many different real zeros there are; none are counted of what vanishes everywhere.
pub fn zeros_of(polynomial: &[RBig]) -> usize {
    if polynomial.len() < 2 { 0 } else { Chain::new(polynomial).everywhere() }
}

/// Enclosures of all real zeros, each once, from left to right. They have no inner point in common; of two that touch, the end
/// that they share is no zero.
pub fn real_roots(polynomial: &[RBig]) -> Vec<RealRoot> {
    if polynomial.len() < 2 {
        return Vec::new();
    }
    let simple = square_free(polynomial);
    let chain = Chain::new(&simple);
    let far = bound(&simple);
    let mut open = vec![(-far.clone(), far)];
    let mut found = Vec::new();
    while let Some((low, high)) = open.pop() {
        match chain.changes(&low) - chain.changes(&high) {
            0 => {}
            1 => found.push(RealRoot { low, high }),
            _ => {
                let middle = between(&simple, &low, &high);
                // the left one is looked at first
                open.push((middle.clone(), high));
                open.push((low, middle));
            }
        }
    }
    found.iter_mut().for_each(|root| make_exact(root, &simple));
    found
}

/// A number between two others that is no zero: near the middle, and of few bits.
fn between(polynomial: &[RBig], low: &RBig, high: &RBig) -> RBig {
    let width = high - low;
    // one of so many different numbers is no zero
    let parts = (1..=polynomial.len()).map(|k| RBig::from(k) / RBig::from(2 * k + usize::from(k > 1)));
    let mut places = parts.map(|part| low + &width * part);
    places.find(|place| sign_at(polynomial, place).is_some()).unwrap_or_else(|| low + width / RBig::from(2))
}

/// A zero that is a rational number becomes that number: its denominator divides the leading coefficient, so that it is the
/// simplest number of an interval that is short enough.
fn make_exact(root: &mut RealRoot, simple: &[RBig]) {
    let whole = primitive(simple);
    let Some(lead) = whole.last().map(|lead| lead.numerator().clone().into_parts().1) else { return };
    if lead.bit_len() > LONGEST_LEAD {
        return;
    }
    let narrow = RBig::from_parts(IBig::ONE, &lead * &lead * UBig::from(4u8));
    while &root.high - &root.low > narrow {
        root.halve(&whole);
        if root.exact().is_some() {
            return;
        }
    }
    let simplest = RBig::simplest_in(root.low.clone(), root.high.clone());
    if sign_at(&whole, &simplest).is_none() {
        (root.low, root.high) = (simplest.clone(), simplest);
    }
}

/// All zeros lie between minus this and this (Cauchy); a power of two, and no zero.
fn bound(polynomial: &[RBig]) -> RBig {
    let Some(lead) = polynomial.last() else { return RBig::ONE };
    let mut far = RBig::from(2);
    let beyond = |value: &RBig, far: &RBig| {
        let ratio = value / lead;
        let ratio = if ratio.sign() == Sign::Negative { -ratio } else { ratio };
        ratio + RBig::ONE >= *far
    };
    while polynomial.iter().any(|value| beyond(value, &far)) {
        far = &far + &far;
    }
    far
}

/// Sturm's chain.
struct Chain(Vec<Vec<RBig>>);

impl Chain {
    /// Of a polynomial that is no constant.
    fn new(polynomial: &[RBig]) -> Chain {
        let mut chain = vec![primitive(polynomial), primitive(&slope(polynomial))];
        while let [.., a, b] = &chain[..] {
            let rest: Vec<RBig> = remainder(a, b).into_iter().map(|value| -value).collect();
            if rest.is_empty() {
                break;
            }
            chain.push(primitive(&rest));
        }
        Chain(chain)
    }

    /// The changes of sign at a number that is no zero.
    fn changes(&self, x: &RBig) -> usize {
        changes(self.0.iter().filter_map(|polynomial| sign_at(polynomial, x)))
    }

    /// The number of different zeros.
    fn everywhere(&self) -> usize {
        let at_infinity = |negative: bool| {
            changes(self.0.iter().filter_map(|values| {
                let turned = negative && values.len().is_multiple_of(2);
                values.last().map(|lead| if turned { -lead.sign() } else { lead.sign() })
            }))
        };
        at_infinity(true) - at_infinity(false)
    }
}

fn changes(signs: impl Iterator<Item = Sign>) -> usize {
    let signs: Vec<Sign> = signs.collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

/// The derivative.
pub fn slope(polynomial: &[RBig]) -> Vec<RBig> {
    polynomial.iter().enumerate().skip(1).map(|(power, value)| value * RBig::from(power)).collect()
}

/// A positive multiple whose coefficients are integers without a common divisor.
fn primitive(polynomial: &[RBig]) -> Vec<RBig> {
    let (mut tops, mut bottoms) = (UBig::ZERO, UBig::ONE);
    for value in polynomial.iter().filter(|value| !value.is_zero()) {
        let top = value.numerator().clone().into_parts().1;
        tops = if tops.is_zero() { top } else { tops.gcd(top) };
        let common = (&bottoms).gcd(value.denominator());
        bottoms = bottoms / common * value.denominator();
    }
    if tops.is_zero() {
        return polynomial.to_vec();
    }
    let factor = RBig::from_parts(IBig::from(bottoms), tops);
    polynomial.iter().map(|value| value * &factor).collect()
}

/// The same zeros, each of them once.
pub fn square_free(polynomial: &[RBig]) -> Vec<RBig> {
    let repeated = common(polynomial, &slope(polynomial));
    if repeated.len() < 2 { primitive(polynomial) } else { primitive(&quotient(polynomial, &repeated)) }
}

/// The product.
pub fn product(a: &[RBig], b: &[RBig]) -> Vec<RBig> {
    if a.is_empty() || b.is_empty() {
        return Vec::new();
    }
    budget::steps(a.len() * b.len());
    let mut product = vec![RBig::ZERO; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] += x * y;
        }
    }
    product
}

/// The greatest common divisor, up to a factor; of one coefficient where there is none.
pub fn common(a: &[RBig], b: &[RBig]) -> Vec<RBig> {
    let (mut a, mut b) = (primitive(a), primitive(b));
    while !b.is_empty() {
        let rest = primitive(&remainder(&a, &b));
        (a, b) = (b, rest);
    }
    a
}

/// Rational zeros: all of them up to degree two, else those that are simple.
pub fn rational_zeros(polynomial: &[RBig]) -> Vec<RBig> {
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
                    if sign_at(polynomial, &candidate).is_none() && !found.contains(&candidate) {
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
    divide(a, b).1
}

/// The quotient of a division.
pub fn quotient(a: &[RBig], b: &[RBig]) -> Vec<RBig> {
    divide(a, b).0
}

fn divide(a: &[RBig], b: &[RBig]) -> (Vec<RBig>, Vec<RBig>) {
    let mut rest = a.to_vec();
    let mut quotient = vec![RBig::ZERO; (a.len() + 1).saturating_sub(b.len())];
    while rest.len() >= b.len() {
        let (Some(top), Some(lead)) = (rest.last().cloned(), b.last()) else { break };
        let words = 1 + (top.numerator().bit_len() + lead.numerator().bit_len()) / 64;
        budget::steps(b.len() * words * words);
        let factor = top / lead;
        let shift = rest.len() - b.len();
        for (at, value) in b.iter().enumerate() {
            rest[shift + at] -= &factor * value;
        }
        quotient[shift] = factor;
        rest.pop();
        while rest.last().is_some_and(RBig::is_zero) {
            rest.pop();
        }
    }
    (quotient, rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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

    /// `(x^2 - 2)^2 (3x - 1) (x - 5)^3`: two irrational zeros and two rational ones, though three of them are multiple.
    #[test]
    fn zeros_are_enclosed_and_rational_ones_are_exact() {
        let square = numbers(&[4, 0, -4, 0, 1]);
        let cube = product(&product(&numbers(&[-5, 1]), &numbers(&[-5, 1])), &numbers(&[-5, 1]));
        let all = product(&product(&square, &numbers(&[-1, 3])), &cube);
        let found = real_roots(&all);
        assert_eq!(found.len(), 4);
        let third = RBig::ONE / RBig::from(3);
        assert_eq!([found[1].exact(), found[3].exact()], [Some(&third), Some(&RBig::from(5))]);
        for root in [&found[0], &found[2]] {
            let simple = numbers(&[-2, 0, 1]);
            assert_ne!(sign_at(&simple, &root.low), sign_at(&simple, &root.high), "{root:?}");
        }
    }

    /// Wilkinson's polynomial, whose zeros no double finds from its coefficients.
    #[test]
    fn twenty_zeros_in_a_row() {
        let all = (1..=20).fold(numbers(&[1]), |p, k| product(&p, &numbers(&[-k, 1])));
        let found = real_roots(&all);
        let exact: Vec<RBig> = found.iter().filter_map(|root| root.exact().cloned()).collect();
        assert_eq!(exact, (1..=20).map(RBig::from).collect::<Vec<_>>());
    }

    proptest! {
        /// A product of drawn linear factors, some of them repeated, and of `x^2 + c` with `c > 0`, has the zeros that were drawn.
        #[test]
        fn drawn_zeros_are_found(
            mut drawn in prop::collection::vec((-40i64..40, 1i64..9), 0..6),
            twice in any::<bool>(),
            without in 1i64..50,
        ) {
            let mut all = numbers(&[without, 0, 1]);
            for (top, bottom) in drawn.iter().chain(drawn.first().filter(|_| twice)) {
                all = product(&all, &numbers(&[-top, *bottom]));
            }
            let mut expected: Vec<RBig> = drawn.drain(..).map(|(top, bottom)| RBig::from(top) / RBig::from(bottom)).collect();
            expected.sort();
            expected.dedup();
            let found: Vec<RBig> = real_roots(&all).iter().map(|root| root.exact().unwrap().clone()).collect();
            prop_assert_eq!(found, expected);
        }
    }
}
