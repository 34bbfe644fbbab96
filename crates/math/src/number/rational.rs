//! Exact rationals (the crate dashu) as an [`Arithmetic`], and the two ways between them and machine floats.

use super::{Arithmetic, Function, Refusal};
use dashu::base::{BitTest, SquareRoot};
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use palmistry_budget as budget;

/// The field of rational numbers, with a bound on how long a number may become.
#[derive(Clone, Copy, Debug)]
pub struct Rationals {
    /// The greatest length, in bits, of a numerator or a denominator.
    pub bits: usize,
}

impl Default for Rationals {
    /// Room for any honest computation; a tower of powers is stopped before it fills the memory.
    fn default() -> Self {
        Rationals { bits: 1 << 20 }
    }
}

impl Rationals {
    fn bounded(&self, value: RBig) -> Result<RBig, Refusal> {
        // to cancel what numerator and denominator share takes as long as to multiply them
        let words = (value.numerator().bit_len() + value.denominator().bit_len()) / 64;
        budget::steps(words * words / 4);
        if value.numerator().bit_len() > self.bits || value.denominator().bit_len() > self.bits {
            Err(Refusal::TooLarge)
        } else {
            Ok(value)
        }
    }
}

impl Arithmetic for Rationals {
    type Number = RBig;

    fn rational(&self, value: &RBig) -> Result<RBig, Refusal> {
        Ok(value.clone())
    }
    fn pi(&self) -> Result<RBig, Refusal> {
        Err(Refusal::NoExactPi)
    }
    fn add(&self, a: &RBig, b: &RBig) -> Result<RBig, Refusal> {
        self.bounded(a + b)
    }
    fn sub(&self, a: &RBig, b: &RBig) -> Result<RBig, Refusal> {
        self.bounded(a - b)
    }
    fn mul(&self, a: &RBig, b: &RBig) -> Result<RBig, Refusal> {
        self.bounded(a * b)
    }
    fn div(&self, a: &RBig, b: &RBig) -> Result<RBig, Refusal> {
        if b.is_zero() { Err(Refusal::DivisionByZero) } else { self.bounded(a / b) }
    }
    fn neg(&self, a: &RBig) -> Result<RBig, Refusal> {
        Ok(-a)
    }
    /// Only the values that everybody knows: at zero (and one), and square roots of squares.
    fn apply(&self, function: Function, a: &RBig) -> Result<RBig, Refusal> {
        let refuse = Err(Refusal::NoExactValue(function));
        match function {
            Function::Sin | Function::Asin | Function::Atan if a.is_zero() => Ok(RBig::ZERO),
            Function::Cos | Function::Exp if a.is_zero() => Ok(RBig::ONE),
            Function::Log | Function::Acos if a.is_one() => Ok(RBig::ZERO),
            Function::Log if *a <= RBig::ZERO => Err(Refusal::OutsideDomain(function)),
            Function::Sqrt if *a < RBig::ZERO => Err(Refusal::OutsideDomain(function)),
            Function::Sqrt => exact_root(a).map_or(refuse, Ok),
            _ => refuse,
        }
    }
    fn is_zero(&self, a: &RBig) -> Option<bool> {
        Some(a.is_zero())
    }
}

/// The square root of a rational that is the square of a rational.
fn exact_root(value: &RBig) -> Option<RBig> {
    let numerator: UBig = value.numerator().clone().try_into().ok()?;
    let (top, bottom) = (numerator.sqrt(), value.denominator().sqrt());
    let root = RBig::from_parts(top.into(), bottom);
    (&root * &root == *value).then_some(root)
}

/// The double nearest to a rational.
pub fn rational_to_f64(value: &RBig) -> f64 {
    value.to_f64().value()
}

/// The rational that a double *is*: its significand times a power of two. `None` for an infinity or a NaN.
pub fn rational_from_f64(value: f64) -> Option<RBig> {
    RBig::try_from(value).ok()
}

/// A decimal literal as the exact rational that it denotes: `0.5` and `.5` are one half, `1e-3` is a thousandth, and
/// `1/3` is a third. `None` where the text is no such number or its exponent is beyond plus or minus 4096.
pub fn parse_decimal(text: &str) -> Option<RBig> {
    let text = text.trim();
    if let Some((top, bottom)) = text.split_once('/') {
        // one bar is a fraction; two are two meanings, and a hundred thousand would fill the stack
        let bottom = if bottom.contains('/') { None } else { parse_decimal(bottom) }?;
        return if bottom.is_zero() { None } else { Some(parse_decimal(top)? / bottom) };
    }
    let (negative, digits) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let (mantissa, exponent) = match digits.find(['e', 'E']) {
        Some(at) => (&digits[..at], digits[at + 1..].parse::<i64>().ok()?),
        None => (digits, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let all = format!("{whole}{fraction}");
    if all.is_empty() || all.len() > 4096 || !all.bytes().all(|b| b.is_ascii_digit()) || exponent.abs() > 4096
    {
        return None;
    }
    let significand = IBig::from_str_radix(&all, 10).ok()?;
    let shift = exponent - fraction.len() as i64;
    let scale = UBig::from(10u8).pow(shift.unsigned_abs() as usize);
    let value = if shift >= 0 {
        RBig::from(significand * IBig::from(scale))
    } else {
        RBig::from_parts(significand, scale)
    };
    Some(if negative { -value } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn q(n: i64, d: u64) -> RBig {
        RBig::from_parts(n.into(), d.into())
    }

    #[test]
    fn decimals_are_exact() {
        for (text, value) in [
            ("0.5", q(1, 2)),
            (".5", q(1, 2)),
            ("1/2", q(1, 2)),
            ("-9.81", q(-981, 100)),
            ("1e-3", q(1, 1000)),
            ("2.5E2", q(250, 1)),
            ("-.5/.25", q(-2, 1)),
        ] {
            assert_eq!(parse_decimal(text), Some(value), "{text}");
        }
        assert_eq!(parse_decimal(&"1/".repeat(1_000_000)), None);
        for text in ["", ".", "e5", "1/0", "1e99999999999", "0x10", "1..2", "--1", "1/2/0", "1/2/3"] {
            assert_eq!(parse_decimal(text), None, "{text}");
        }
    }

    #[test]
    fn a_float_is_the_rational_that_it_is() {
        assert_eq!(rational_from_f64(0.1), Some(q(3602879701896397, 36028797018963968)));
        assert_eq!(rational_from_f64(f64::NAN), None);
    }

    #[test]
    fn roots_of_squares_are_exact_and_others_are_refused() {
        let all = Rationals::default();
        assert_eq!(all.apply(Function::Sqrt, &q(9, 4)), Ok(q(3, 2)));
        assert_eq!(all.apply(Function::Sqrt, &q(2, 1)), Err(Refusal::NoExactValue(Function::Sqrt)));
        assert_eq!(all.apply(Function::Sqrt, &q(-4, 1)), Err(Refusal::OutsideDomain(Function::Sqrt)));
        assert_eq!(all.div(&q(1, 1), &RBig::ZERO), Err(Refusal::DivisionByZero));
    }

    #[test]
    fn a_number_that_grows_without_end_is_refused() {
        let small = Rationals { bits: 100 };
        assert_eq!(small.power(&q(3, 2), 1000), Err(Refusal::TooLarge));
    }
}
