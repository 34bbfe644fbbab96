//! Enclosures: intervals with endpoints of any precision, rounded outward, as an [`Arithmetic`].
//!
//! Every operation returns an interval that contains all values of the operation on its arguments. The endpoints are
//! binary floats of the crate dashu, whose directed rounding is correct for the elementary functions too (it repeats
//! at a higher precision until the rounding is certain, and reports when it could not).

use super::{Arithmetic, Function, Refusal, rational_to_f64};
use dashu::base::{BitTest, Sign, UnsignedAbs};
use dashu::float::round::Round;
use dashu::float::round::mode::{Down, Up};
use dashu::float::{Context, FBig, FpError, Repr};
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use palmistry_budget as budget;

type Endpoint = Repr<2>;

/// The closed interval from `low` to `high`.
#[derive(Clone, Debug)]
pub struct Enclosure {
    low: Endpoint,
    high: Endpoint,
}

impl Enclosure {
    /// The left end, exactly.
    pub fn low(&self) -> RBig {
        endpoint_rational(&self.low)
    }

    /// The right end, exactly.
    pub fn high(&self) -> RBig {
        endpoint_rational(&self.high)
    }

    /// Whether zero lies in it.
    pub fn contains_zero(&self) -> bool {
        self.low.sign() == Sign::Negative && self.high.sign() == Sign::Positive
            || self.low.significand().is_zero()
            || self.high.significand().is_zero()
    }

    /// How far it lies from zero in units of its own half width: infinite for one number that is not zero, at most one
    /// where zero is inside.
    pub fn significance(&self) -> f64 {
        let (low, high) = (self.low(), self.high());
        let half_width = &high - &low;
        if half_width.is_zero() {
            return if low.is_zero() { 0.0 } else { f64::INFINITY };
        }
        rational_to_f64(&((low + high) / half_width)).abs()
    }

    /// Whether it consists of one number.
    pub fn is_exact(&self) -> bool {
        self.low == self.high
    }

    /// The double nearest to the middle.
    pub fn midpoint(&self) -> f64 {
        rational_to_f64(&((self.low() + self.high()) / RBig::from(2)))
    }

    /// The value to `digits` significant decimal digits, if every number in the interval rounds to the same ones
    /// (halves away from zero). The text is a plain decimal, or in scientific notation where that is shorter.
    pub fn decimal(&self, digits: usize) -> Option<String> {
        common_decimal(&self.low(), &self.high(), digits)
    }

    /// The interval as text, its ends rounded.
    pub fn bounds_text(&self) -> String {
        format!(
            "between about {} and {}",
            round_to_decimal(&self.low(), 6),
            round_to_decimal(&self.high(), 6)
        )
    }

    /// The value to as many digits as are certain, at most `digits`; `None` where not even one is.
    pub fn certain_decimal(&self, digits: usize) -> Option<String> {
        (1..=digits).rev().find_map(|n| self.decimal(n))
    }
}

fn endpoint_rational(value: &Endpoint) -> RBig {
    let significand = RBig::from(value.significand().clone());
    let scale = RBig::from(UBig::ONE << value.exponent().unsigned_abs());
    if value.exponent() >= 0 { significand * scale } else { significand / scale }
}

/// What all numbers between two rationals round to, if that is one decimal.
pub fn common_decimal(low: &RBig, high: &RBig, digits: usize) -> Option<String> {
    let rounded = round_to_decimal(low, digits);
    (rounded == round_to_decimal(high, digits)).then_some(rounded)
}

/// A rational rounded to `digits` significant decimal digits, halves away from zero.
pub fn round_to_decimal(value: &RBig, digits: usize) -> String {
    if value.is_zero() {
        return "0".to_owned();
    }
    let digits = digits.max(1);
    let negative = *value < RBig::ZERO;
    let top: UBig = value.numerator().clone().unsigned_abs();
    let bottom = value.denominator().clone();
    // the exponent e with 10^e <= |value| < 10^(e+1), guessed from the lengths and then set right
    let mut exponent =
        ((top.bit_len() as f64 - bottom.bit_len() as f64) * std::f64::consts::LOG10_2).floor() as i64;
    let scaled = |exponent: i64| -> (UBig, UBig) {
        let ten = |n: i64| UBig::from(10u8).pow(n.unsigned_abs() as usize);
        let shift = digits as i64 - 1 - exponent;
        if shift >= 0 { (&top * ten(shift), bottom.clone()) } else { (top.clone(), &bottom * ten(shift)) }
    };
    let lower = UBig::from(10u8).pow(digits - 1);
    let upper = UBig::from(10u8).pow(digits);
    let rounded = loop {
        let (n, d) = scaled(exponent);
        let rounded = (&n * 2u8 + &d) / (&d * 2u8);
        if &n / &d >= upper {
            exponent += 1;
        } else if &n / &d < lower {
            exponent -= 1;
        } else if rounded == upper {
            exponent += 1;
            break lower;
        } else {
            break rounded;
        }
    };
    place_point(&rounded.to_string(), exponent, negative)
}

/// Writes `d.ddd * 10^exponent` as a plain decimal where that has few zeros, else with an exponent.
fn place_point(digits: &str, exponent: i64, negative: bool) -> String {
    let sign = if negative { "-" } else { "" };
    let count = digits.len() as i64;
    if (-5..0).contains(&exponent) {
        return format!("{sign}0.{}{digits}", "0".repeat((-exponent - 1) as usize));
    }
    if (0..count.max(21)).contains(&exponent) {
        let whole = exponent + 1;
        if whole >= count {
            return format!("{sign}{digits}{}", "0".repeat((whole - count) as usize));
        }
        return format!("{sign}{}.{}", &digits[..whole as usize], &digits[whole as usize..]);
    }
    let point = if digits.len() > 1 { "." } else { "" };
    format!("{sign}{}{point}{}e{exponent}", &digits[..1], &digits[1..])
}

/// Interval arithmetic whose endpoints carry `precision` bits.
#[derive(Clone, Copy, Debug)]
pub struct Enclosures {
    down: Context<Down>,
    up: Context<Up>,
}

/// Endpoints beyond `2^(2^24)` or that near to zero are refused: as exact numbers they would fill the memory.
const LARGEST_ENDPOINT: usize = 24;

/// Beyond this binary exponent an argument of a function is refused: its reduction would need as many bits of pi.
const LARGEST_EXPONENT: isize = 4096;

impl Enclosures {
    /// Endpoints of `precision` bits (at least 2).
    pub fn new(precision: usize) -> Self {
        let precision = precision.max(2);
        Enclosures { down: Context::new(precision), up: Context::new(precision) }
    }

    /// The intersection of two enclosures of one and the same number. `None` proves that they are not.
    pub fn common(a: &Enclosure, b: &Enclosure) -> Option<Enclosure> {
        let low = if a.low >= b.low { &a.low } else { &b.low };
        let high = if a.high <= b.high { &a.high } else { &b.high };
        (low <= high).then(|| Enclosure { low: low.clone(), high: high.clone() })
    }

    /// The least enclosure that holds two.
    pub fn hull(a: &Enclosure, b: &Enclosure) -> Enclosure {
        let low = if a.low <= b.low { &a.low } else { &b.low };
        let high = if a.high >= b.high { &a.high } else { &b.high };
        Enclosure { low: low.clone(), high: high.clone() }
    }

    /// One number near the middle, as an enclosure that holds no other.
    ///
    /// # Errors
    /// [`Refusal::TooLarge`] where it cannot be held.
    pub fn middle(&self, a: &Enclosure) -> Result<Enclosure, Refusal> {
        let sum = self.down.add(&a.low, &a.high).map_err(refusal)?.value().into_repr();
        let half = Repr::new(sum.significand().clone(), sum.exponent() - 1);
        Ok(Enclosure { low: half.clone(), high: half })
    }

    fn endpoints(low: Rounded<Down>, high: Rounded<Up>) -> Result<Enclosure, Refusal> {
        let (low, high) =
            (low.map_err(refusal)?.value().into_repr(), high.map_err(refusal)?.value().into_repr());
        let words = low.significand().bit_len() / 64 + 1;
        budget::steps(4 * words * words);
        let small = |e: &Endpoint| e.is_finite() && e.exponent().unsigned_abs() < 1 << LARGEST_ENDPOINT;
        if small(&low) && small(&high) { Ok(Enclosure { low, high }) } else { Err(Refusal::TooLarge) }
    }

    /// A non-decreasing function, from its values at the ends.
    fn increasing(
        &self,
        a: &Enclosure,
        low: impl Fn(&Context<Down>, &Endpoint) -> Rounded<Down>,
        high: impl Fn(&Context<Up>, &Endpoint) -> Rounded<Up>,
    ) -> Result<Enclosure, Refusal> {
        Self::endpoints(low(&self.down, &a.low), high(&self.up, &a.high))
    }

    /// Sine or cosine: the value at the left end, give or take the width of the interval, since the slope is at most
    /// one; and never beyond plus or minus one.
    fn circular(
        &self,
        a: &Enclosure,
        low: impl Fn(&Context<Down>, &Endpoint) -> Rounded<Down>,
        high: impl Fn(&Context<Up>, &Endpoint) -> Rounded<Up>,
    ) -> Result<Enclosure, Refusal> {
        let value = Self::endpoints(low(&self.down, &a.low), high(&self.up, &a.low))?;
        let width = self.up.sub(&a.high, &a.low).map_err(refusal)?.value().into_repr();
        let wide = Self::endpoints(self.down.sub(&value.low, &width), self.up.add(&value.high, &width))?;
        let unit = Enclosure { low: Repr::neg_one(), high: Repr::one() };
        Self::common(&wide, &unit).ok_or(Refusal::NotFinite)
    }
}

type Rounded<R> = Result<dashu::base::Approximation<FBig<R, 2>, dashu::float::round::Rounding>, FpError>;

fn refusal(error: FpError) -> Refusal {
    match error {
        FpError::Overflow(_) | FpError::Underflow(_) => Refusal::TooLarge,
        _ => Refusal::NotFinite,
    }
}

fn quotient<R: Round>(context: &Context<R>, value: &RBig) -> Rounded<R> {
    let top = Repr::new(value.numerator().clone(), 0);
    let bottom = Repr::new(IBig::from(value.denominator().clone()), 0);
    context.div(&top, &bottom)
}

impl Arithmetic for Enclosures {
    type Number = Enclosure;

    fn rational(&self, value: &RBig) -> Result<Enclosure, Refusal> {
        Self::endpoints(quotient(&self.down, value), quotient(&self.up, value))
    }

    fn pi(&self) -> Result<Enclosure, Refusal> {
        // a half turn is the arc cosine of minus one, correctly rounded both ways
        Self::endpoints(self.down.acos(&Repr::neg_one(), None), self.up.acos(&Repr::neg_one(), None))
    }

    fn add(&self, a: &Enclosure, b: &Enclosure) -> Result<Enclosure, Refusal> {
        Self::endpoints(self.down.add(&a.low, &b.low), self.up.add(&a.high, &b.high))
    }

    fn sub(&self, a: &Enclosure, b: &Enclosure) -> Result<Enclosure, Refusal> {
        Self::endpoints(self.down.sub(&a.low, &b.high), self.up.sub(&a.high, &b.low))
    }

    fn mul(&self, a: &Enclosure, b: &Enclosure) -> Result<Enclosure, Refusal> {
        let pairs = [(&a.low, &b.low), (&a.low, &b.high), (&a.high, &b.low), (&a.high, &b.high)];
        let mut hull: Option<Enclosure> = None;
        for (x, y) in pairs {
            let next = Self::endpoints(self.down.mul(x, y), self.up.mul(x, y))?;
            hull = Some(match hull {
                None => next,
                Some(all) => Enclosure {
                    low: if next.low < all.low { next.low } else { all.low },
                    high: if next.high > all.high { next.high } else { all.high },
                },
            });
        }
        hull.ok_or(Refusal::NotFinite)
    }

    fn div(&self, a: &Enclosure, b: &Enclosure) -> Result<Enclosure, Refusal> {
        if b.contains_zero() {
            return Err(if b.is_exact() { Refusal::DivisionByZero } else { Refusal::DivisorNotSeparated });
        }
        let one = Repr::one();
        let reciprocal = Self::endpoints(self.down.div(&one, &b.high), self.up.div(&one, &b.low))?;
        self.mul(a, &reciprocal)
    }

    fn neg(&self, a: &Enclosure) -> Result<Enclosure, Refusal> {
        Ok(Enclosure { low: -a.high.clone(), high: -a.low.clone() })
    }

    fn apply(&self, function: Function, a: &Enclosure) -> Result<Enclosure, Refusal> {
        let magnitude = |e: &Endpoint| e.exponent() + e.digits() as isize;
        if magnitude(&a.low).max(magnitude(&a.high)) > LARGEST_EXPONENT {
            return Err(Refusal::TooLarge);
        }
        let end = |bound: i8| Repr::new(IBig::from(bound), 0);
        // every number of the enclosure is outside, or only some: more bits may decide it
        let outside = match function {
            Function::Asin | Function::Acos => a.high < end(-1) || a.low > end(1),
            Function::Sqrt => a.high < end(0),
            Function::Log => a.high <= end(0),
            _ => false,
        };
        if outside {
            return Err(Refusal::OutsideDomain(function));
        }
        let perhaps = Refusal::DomainNotSeparated(function);
        let below = |bound: i8| a.low < end(bound);
        let above = |bound: i8| a.high > end(bound);
        match function {
            Function::Sin => self.circular(a, |c, x| c.sin(x, None), |c, x| c.sin(x, None)),
            Function::Cos => self.circular(a, |c, x| c.cos(x, None), |c, x| c.cos(x, None)),
            Function::Atan => self.increasing(a, |c, x| c.atan(x, None), |c, x| c.atan(x, None)),
            Function::Asin | Function::Acos if below(-1) || above(1) => Err(perhaps),
            Function::Asin => self.increasing(a, |c, x| c.asin(x, None), |c, x| c.asin(x, None)),
            Function::Acos => Self::endpoints(self.down.acos(&a.high, None), self.up.acos(&a.low, None)),
            Function::Sqrt if below(0) => Err(perhaps),
            Function::Sqrt => self.increasing(a, |c, x| c.sqrt(x), |c, x| c.sqrt(x)),
            Function::Exp if magnitude(&a.low).max(magnitude(&a.high)) > 20 => Err(Refusal::TooLarge),
            Function::Exp => self.increasing(a, |c, x| c.exp(x, None), |c, x| c.exp(x, None)),
            Function::Log if a.low.sign() == Sign::Negative || a.low.significand().is_zero() => Err(perhaps),
            Function::Log => self.increasing(a, |c, x| c.ln(x, None), |c, x| c.ln(x, None)),
        }
    }

    fn is_zero(&self, a: &Enclosure) -> Option<bool> {
        if !a.contains_zero() {
            Some(false)
        } else if a.is_exact() {
            Some(true)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::parse_decimal;

    fn at(precision: usize, function: Function, argument: &str) -> Enclosure {
        let all = Enclosures::new(precision);
        all.apply(function, &all.rational(&parse_decimal(argument).unwrap()).unwrap()).unwrap()
    }

    /// Digits of sin 2, cos 2, exp 1, log 2, atan 1/3, sqrt 2 and pi: mpmath 1.3, mp.dps = 40.
    #[test]
    fn functions_agree_with_published_digits() {
        for (function, argument, digits) in [
            (Function::Sin, "2", "0.9092974268256816953960198659117"),
            (Function::Cos, "2", "-0.4161468365471423869975682295008"),
            (Function::Exp, "1", "2.718281828459045235360287471353"),
            (Function::Log, "2", "0.6931471805599453094172321214582"),
            (Function::Atan, "1/3", "0.3217505543966421934014046143587"),
            (Function::Sqrt, "2", "1.414213562373095048801688724210"),
            (Function::Acos, "-1", "3.141592653589793238462643383280"),
        ] {
            assert_eq!(at(160, function, argument).decimal(31).as_deref(), Some(digits), "{function:?}");
        }
    }

    #[test]
    fn a_higher_precision_lies_inside_a_lower_one() {
        for function in Function::ALL {
            for argument in ["1/3", "7/8", "1"] {
                let (coarse, fine) = (at(20, function, argument), at(300, function, argument));
                assert!(
                    coarse.low() <= fine.low() && fine.high() <= coarse.high(),
                    "{function:?} {argument}"
                );
            }
        }
    }

    #[test]
    fn a_divisor_that_may_vanish_is_refused_by_name() {
        let all = Enclosures::new(64);
        let (one, zero) = (all.rational(&RBig::ONE).unwrap(), all.rational(&RBig::ZERO).unwrap());
        let sine = all.apply(Function::Sin, &all.pi().unwrap()).unwrap();
        assert_eq!(all.div(&one, &zero).unwrap_err(), Refusal::DivisionByZero);
        assert_eq!(all.div(&one, &sine).unwrap_err(), Refusal::DivisorNotSeparated);
    }

    /// Which of the two it is decides whether more bits are tried.
    #[test]
    fn outside_for_certain_is_told_from_perhaps_outside() {
        let all = Enclosures::new(64);
        let around = |text: &str| {
            let middle = all.rational(&parse_decimal(text).unwrap()).unwrap();
            let width = all.sub(&all.pi().unwrap(), &all.pi().unwrap()).unwrap();
            all.add(&middle, &width).unwrap()
        };
        for (function, inside, edge, outside) in [
            (Function::Acos, "0.9", "1", "1.1"),
            (Function::Asin, "-0.9", "-1", "-1.1"),
            (Function::Sqrt, "0.1", "0", "-0.1"),
            (Function::Log, "0.1", "0", "-0.1"),
        ] {
            assert!(all.apply(function, &around(inside)).is_ok(), "{function:?}");
            let refused = |text| all.apply(function, &around(text)).unwrap_err();
            assert_eq!(refused(edge), Refusal::DomainNotSeparated(function));
            assert_eq!(refused(outside), Refusal::OutsideDomain(function));
        }
        let zero = all.rational(&RBig::ZERO).unwrap();
        assert_eq!(all.apply(Function::Log, &zero).unwrap_err(), Refusal::OutsideDomain(Function::Log));
    }

    #[test]
    fn decimals_round_at_the_last_digit_asked_for() {
        for (value, digits, text) in [
            ("2/3", 5, "0.66667"),
            ("999.96", 4, "1000"),
            ("-1234567", 3, "-1230000"),
            ("1e-9", 3, "1.00e-9"),
            ("0.05", 1, "0.05"),
            ("1e30", 2, "1.0e30"),
            ("0", 9, "0"),
        ] {
            assert_eq!(round_to_decimal(&parse_decimal(value).unwrap(), digits), text);
        }
    }
}
