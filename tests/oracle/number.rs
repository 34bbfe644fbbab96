//! Numbers of the witness: rational, rational functions of pi with rational coefficients, and else floats of 240 digits.
//!
//! Pi is transcendental (Lindemann 1882), so that a quotient of polynomials in pi is zero only where its numerator is
//! the zero polynomial: with such numbers states like `x = 2 pi` are exact. Floats are never called zero: what is
//! smaller than 2^-300 is [`Sign::Unclear`].

use dashu::base::{Abs, Sign as Signum, UnsignedAbs};
use dashu::float::FBig;
use dashu::float::round::mode::HalfEven;
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use std::cmp::Ordering;

/// A binary float of [`BITS`] bits.
pub type Float = FBig<HalfEven, 2>;

/// The precision of floats in bits, some 240 decimal digits.
pub const BITS: usize = 800;
/// A float below two to minus this may be a zero that rounding has blurred.
const BLURRED: usize = 300;
/// Powers of pi beyond this are left to floats: nobody needs them exactly.
const HIGHEST: usize = 24;

/// Why there is no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// Certainly none: something is divided by zero, or lies outside of a function's domain.
    Undefined,
    /// There is a value, but no derivative: a root at zero, an inverse sine at one.
    NotSmooth,
    /// 240 digits do not tell.
    Unclear,
    /// More work than a test should do.
    TooLarge,
}

/// What is known of a number's sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    Negative,
    Zero,
    Positive,
    Unclear,
}

/// A real number.
#[derive(Clone, Debug)]
pub enum Number {
    Rational(RBig),
    /// Numerator and denominator, lowest power of pi first; at least one of them is no constant.
    Pi(Vec<RBig>, Vec<RBig>),
    Digits(Float),
}

impl Number {
    pub const ZERO: Number = Number::Rational(RBig::ZERO);
    pub const ONE: Number = Number::Rational(RBig::ONE);

    pub fn integer(value: i64) -> Number {
        Number::Rational(RBig::from(value))
    }

    /// A rational multiple of pi.
    pub fn turns(multiple: RBig) -> Number {
        quotient(vec![RBig::ZERO, multiple], vec![RBig::ONE])
    }

    /// As a float.
    pub fn digits(&self) -> Float {
        match self {
            Number::Rational(value) => float(value),
            Number::Pi(top, bottom) => at_pi(top) / at_pi(bottom),
            Number::Digits(value) => value.clone(),
        }
    }

    pub fn sign(&self) -> Sign {
        let of = |float: &Float| match float.repr().sign() {
            Signum::Negative => Sign::Negative,
            Signum::Positive => Sign::Positive,
        };
        match self {
            Number::Rational(value) => match value.cmp(&RBig::ZERO) {
                Ordering::Less => Sign::Negative,
                Ordering::Equal => Sign::Zero,
                Ordering::Greater => Sign::Positive,
            },
            Number::Pi(..) => of(&self.digits()), // not zero, and far from it: the coefficients are short
            Number::Digits(value) if is_blurred(value) => Sign::Unclear,
            Number::Digits(value) => of(value),
        }
    }

    pub fn is_exact(&self) -> bool {
        !matches!(self, Number::Digits(_))
    }

    pub fn is_exact_zero(&self) -> bool {
        matches!(self, Number::Rational(value) if value.is_zero())
    }

    pub fn add(&self, other: &Number) -> Number {
        match (self, other) {
            (Number::Rational(a), Number::Rational(b)) => Number::Rational(a + b),
            (Number::Digits(_), _) | (_, Number::Digits(_)) => {
                if other.is_exact_zero() {
                    return self.clone();
                }
                if self.is_exact_zero() {
                    return other.clone();
                }
                Number::Digits(self.digits() + other.digits())
            }
            _ => {
                let ((a, b), (c, d)) = (self.parts(), other.parts());
                quotient(sum(&product(&a, &d), &product(&c, &b)), product(&b, &d))
            }
        }
    }

    pub fn negative(&self) -> Number {
        match self {
            Number::Rational(value) => Number::Rational(-value.clone()),
            Number::Pi(top, bottom) => Number::Pi(top.iter().map(|c| -c.clone()).collect(), bottom.clone()),
            Number::Digits(value) => Number::Digits(-value.clone()),
        }
    }

    pub fn subtract(&self, other: &Number) -> Number {
        self.add(&other.negative())
    }

    pub fn multiply(&self, other: &Number) -> Number {
        if self.is_exact_zero() || other.is_exact_zero() {
            return Number::ZERO;
        }
        match (self, other) {
            (Number::Rational(a), Number::Rational(b)) => Number::Rational(a * b),
            (Number::Digits(_), _) | (_, Number::Digits(_)) => Number::Digits(self.digits() * other.digits()),
            _ => {
                let ((a, b), (c, d)) = (self.parts(), other.parts());
                quotient(product(&a, &c), product(&b, &d))
            }
        }
    }

    pub fn divide(&self, other: &Number) -> Result<Number, Trouble> {
        match other.sign() {
            Sign::Zero => return Err(Trouble::Undefined),
            Sign::Unclear => return Err(Trouble::Unclear),
            Sign::Negative | Sign::Positive => {}
        }
        Ok(match (self, other) {
            (Number::Rational(a), Number::Rational(b)) => Number::Rational(a / b),
            (Number::Digits(_), _) | (_, Number::Digits(_)) => {
                if self.is_exact_zero() {
                    return Ok(Number::ZERO);
                }
                Number::Digits(self.digits() / other.digits())
            }
            _ => {
                let ((a, b), (c, d)) = (self.parts(), other.parts());
                quotient(product(&a, &d), product(&b, &c))
            }
        })
    }

    fn parts(&self) -> (Vec<RBig>, Vec<RBig>) {
        match self {
            Number::Rational(value) => (vec![value.clone()], vec![RBig::ONE]),
            Number::Pi(top, bottom) => (top.clone(), bottom.clone()),
            Number::Digits(_) => (Vec::new(), Vec::new()), // not met: floats are taken care of before
        }
    }

    /// The rational `q` of which the number is `q pi`, if it is a multiple of pi by a rational.
    pub fn as_turns(&self) -> Option<RBig> {
        match self {
            Number::Rational(value) if value.is_zero() => Some(RBig::ZERO),
            Number::Pi(top, bottom) => match (top.as_slice(), bottom.as_slice()) {
                ([zero, slope], [unit]) if zero.is_zero() => Some(slope / unit),
                _ => None,
            },
            _ => None,
        }
    }
}

/// Whether a float may be a zero.
pub fn is_blurred(value: &Float) -> bool {
    value.repr().significand().is_zero() || value.clone().abs() < threshold(BLURRED)
}

/// Two to a negative power.
pub fn threshold(power: usize) -> Float {
    float(&(RBig::ONE / RBig::from(IBig::ONE << power)))
}

/// A rational rounded to [`BITS`] bits.
pub fn float(value: &RBig) -> Float {
    // zero would come with no precision at all, which functions refuse
    value.to_float::<HalfEven, 2>(BITS).value().with_precision(BITS).value()
}

/// Pi as a float.
pub fn pi() -> Float {
    Float::pi(BITS)
}

/// The exact root of a rational, where that is rational.
pub fn exact_root(value: &RBig) -> Option<RBig> {
    let root = |n: &UBig| {
        let root = dashu::base::SquareRoot::sqrt(n);
        (&root * &root == *n).then_some(root)
    };
    let top = root(&value.numerator().clone().unsigned_abs())?;
    let bottom = root(value.denominator())?;
    Some(RBig::from_parts(top.into(), bottom))
}

fn at_pi(polynomial: &[RBig]) -> Float {
    let pi = pi();
    polynomial.iter().rev().fold(float(&RBig::ZERO), |sum, c| sum * &pi + float(c))
}

fn trimmed(mut polynomial: Vec<RBig>) -> Vec<RBig> {
    while polynomial.last().is_some_and(RBig::is_zero) {
        polynomial.pop();
    }
    polynomial
}

fn sum(a: &[RBig], b: &[RBig]) -> Vec<RBig> {
    let zero = RBig::ZERO;
    let at = |p: &[RBig], i: usize| p.get(i).unwrap_or(&zero).clone();
    trimmed((0..a.len().max(b.len())).map(|i| at(a, i) + at(b, i)).collect())
}

fn product(a: &[RBig], b: &[RBig]) -> Vec<RBig> {
    let mut found = vec![RBig::ZERO; (a.len() + b.len()).max(1) - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            found[i + j] += x * y;
        }
    }
    trimmed(found)
}

/// Quotient and remainder of polynomials; the divisor is not zero.
fn division(top: &[RBig], bottom: &[RBig]) -> (Vec<RBig>, Vec<RBig>) {
    let (mut rest, mut found) = (top.to_vec(), vec![RBig::ZERO; top.len()]);
    while rest.len() >= bottom.len() && !rest.is_empty() {
        let shift = rest.len() - bottom.len();
        let factor = &rest[rest.len() - 1] / &bottom[bottom.len() - 1];
        for (i, c) in bottom.iter().enumerate() {
            let less = c * &factor;
            rest[i + shift] -= less;
        }
        found[shift] = factor;
        rest = trimmed(rest);
    }
    (trimmed(found), rest)
}

/// A quotient of polynomials in pi in lowest terms, its denominator's first coefficient one.
fn quotient(top: Vec<RBig>, bottom: Vec<RBig>) -> Number {
    let (top, bottom) = (trimmed(top), trimmed(bottom));
    if top.is_empty() {
        return Number::ZERO;
    }
    let (mut a, mut b) = (top.clone(), bottom.clone());
    while !b.is_empty() {
        let rest = division(&a, &b).1;
        (a, b) = (b, rest);
    }
    let (top, bottom) = (division(&top, &a).0, division(&bottom, &a).0);
    if top.len().max(bottom.len()) > HIGHEST {
        return Number::Digits(at_pi(&top) / at_pi(&bottom));
    }
    let unit = bottom[bottom.len() - 1].clone();
    let scaled = |p: Vec<RBig>| p.into_iter().map(|c| c / &unit).collect::<Vec<_>>();
    let (top, bottom) = (scaled(top), scaled(bottom));
    match (top.as_slice(), bottom.as_slice()) {
        ([a], [b]) => Number::Rational(a / b),
        _ => Number::Pi(top, bottom),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (pi^2 - 1)/(pi - 1) - pi = 1, exactly.
    #[test]
    fn a_quotient_of_polynomials_in_pi_is_exact() {
        let pi = Number::turns(RBig::ONE);
        let one = Number::ONE;
        let top = pi.multiply(&pi).subtract(&one);
        let found = top.divide(&pi.subtract(&one)).unwrap().subtract(&pi);
        assert!(matches!(found, Number::Rational(value) if value.is_one()));
        assert_eq!(pi.subtract(&Number::integer(3)).sign(), Sign::Positive);
        assert_eq!(pi.subtract(&pi).sign(), Sign::Zero);
    }

    #[test]
    fn roots_are_exact_or_none() {
        let value = RBig::from(9) / RBig::from(4);
        assert_eq!(exact_root(&value), Some(RBig::from(3) / RBig::from(2)));
        assert_eq!(exact_root(&RBig::from(2)), None);
    }
}
