//! The numbers that a value can be.
//!
//! An [`Arithmetic`] is a set of numbers together with its operations: numbers of fixed size ([`RealNumber`]: single and
//! double precision, double-doubles, intervals), residues modulo a prime, exact rationals, enclosures of any precision,
//! rounded decimals, Laurent series, dual numbers. A straight-line
//! program is evaluated over any of them. An arithmetic may *refuse* an operation, and says why: a residue has no
//! exponential, an enclosure that contains zero is no divisor.
//!
//! This floor knows nothing of expressions, systems or palms.

mod bounded;
mod decimal;
mod double_double;
mod dual;
mod dual_number;
mod enclosure;
mod error_free;
mod extension;
mod factorisation;
mod float;
mod fraction;
mod instructions;
mod interval;
mod lanes;
mod laurent;
mod number_type;
pub mod polynomial;
mod rational;
mod real;
pub mod real_roots;
mod residue;
mod sine;
mod taylor;
mod tower;
mod turn;
pub(crate) mod univariate;

#[doc(hidden)]
pub use bounded::Bounded;
pub use decimal::Decimal;
#[doc(hidden)]
pub use decimal::Decimals;
#[doc(hidden)]
pub use double_double::DoubleDouble;
#[doc(hidden)]
pub use dual::{Differentiable, Duals};
#[doc(hidden)]
pub use enclosure::{Enclosure, Enclosures, common_decimal, round_to_decimal};
pub(crate) use extension::Extension;
#[doc(hidden)]
pub use factorisation::{Factorisation, primitive, split, square_root};
pub use float::Floats;
#[doc(hidden)]
pub use fraction::{Factors, Fraction, Fractions};
#[doc(hidden)]
pub use instructions::Instructions;
pub use interval::Interval;
#[doc(hidden)]
pub use lanes::{LaneTask, Lanes, MOST_LANES, Vectorised};
#[doc(hidden)]
pub use laurent::{Laurent, Series};
pub use number_type::NumberType;
pub use rational::{Rationals, parse_decimal, rational_from_f64, rational_to_f64};
pub use real::RealNumber;
pub(crate) use residue::LOG2_PRIMES;
#[doc(hidden)]
pub use residue::PrimeField;
#[doc(hidden)]
pub use taylor::{Coefficients, Recurrences};
#[doc(hidden)]
pub use tower::Tower;
pub(crate) use turn::Turn;

use dashu::rational::RBig;

/// After so many steps the decomposition of a matrix of doubles is given up: with an entry that is no finite number it would never end, and
/// hundreds suffice where it has an end.
pub const MOST_ITERATIONS: usize = 10_000;

/// A function of one variable that is not a ratio of polynomials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)] // names and messages say it
pub enum Function {
    Sin,
    Cos,
    Asin,
    Acos,
    Atan,
    Sqrt,
    Exp,
    Log,
}

impl Function {
    /// The name by which the proof language calls it.
    pub fn name(self) -> &'static str {
        match self {
            Function::Sin => "sin",
            Function::Cos => "cos",
            Function::Asin => "asin",
            Function::Acos => "acos",
            Function::Atan => "atan",
            Function::Sqrt => "sqrt",
            Function::Exp => "exp",
            Function::Log => "log",
        }
    }

    /// All of them, in the order in which error messages list them.
    pub const ALL: [Function; 8] = [
        Function::Sin,
        Function::Cos,
        Function::Asin,
        Function::Acos,
        Function::Atan,
        Function::Sqrt,
        Function::Exp,
        Function::Log,
    ];
}

/// Why an arithmetic did not give a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// The divisor is exactly zero: a pole, or an expression that is undefined here.
    #[error("division by zero")]
    DivisionByZero,
    /// The divisor cannot be distinguished from zero at this precision.
    #[error("the divisor cannot be distinguished from zero at this precision")]
    DivisorNotSeparated,
    /// The argument lies outside the function's real domain, for certain where the arithmetic has bounds.
    #[error("the argument of {} lies outside its domain", .0.name())]
    OutsideDomain(Function),
    /// The argument cannot be distinguished from one outside the function's real domain at this precision.
    #[error("the argument of {} cannot be distinguished from one outside its domain at this precision", .0.name())]
    DomainNotSeparated(Function),
    /// The value exists but this arithmetic cannot hold it.
    #[error("{} has no exact value here", .0.name())]
    NoExactValue(Function),
    /// The constant pi is not rational.
    #[error("pi has no exact value here")]
    NoExactPi,
    /// The value would need more memory than it is worth.
    #[error("the exact value is too large to write down")]
    TooLarge,
    /// The result overflowed or is not a number.
    #[error("the floating-point value is infinite or not a number")]
    NotFinite,
}

/// Numbers and what can be done with them.
///
/// The operations are methods of the arithmetic and not of the number, so that a number need not carry the modulus or
/// the precision that all of them share.
pub trait Arithmetic {
    /// One value.
    type Number: Clone;

    /// The image of an exact rational.
    fn rational(&self, value: &RBig) -> Result<Self::Number, Refusal>;
    /// The image of pi.
    fn pi(&self) -> Result<Self::Number, Refusal>;
    /// `a + b`
    fn add(&self, a: &Self::Number, b: &Self::Number) -> Result<Self::Number, Refusal>;
    /// `a - b`
    fn sub(&self, a: &Self::Number, b: &Self::Number) -> Result<Self::Number, Refusal>;
    /// `a * b`
    fn mul(&self, a: &Self::Number, b: &Self::Number) -> Result<Self::Number, Refusal>;
    /// `a / b`; refuses where `b` is zero, or may be.
    fn div(&self, a: &Self::Number, b: &Self::Number) -> Result<Self::Number, Refusal>;
    /// `-a`
    fn neg(&self, a: &Self::Number) -> Result<Self::Number, Refusal>;
    /// `f(a)`
    fn apply(&self, function: Function, a: &Self::Number) -> Result<Self::Number, Refusal>;
    /// Whether a value is zero; `None` where this arithmetic cannot decide it.
    fn is_zero(&self, a: &Self::Number) -> Option<bool>;

    /// `a^n` by repeated squaring; a negative power is the reciprocal of the positive one.
    fn power(&self, a: &Self::Number, n: i32) -> Result<Self::Number, Refusal> {
        let one = self.rational(&RBig::ONE)?;
        let (mut result, mut square) = (one.clone(), a.clone());
        let mut rest = n.unsigned_abs();
        while rest > 0 {
            if rest & 1 == 1 {
                result = self.mul(&result, &square)?;
            }
            rest >>= 1;
            if rest > 0 {
                square = self.mul(&square, &square)?;
            }
        }
        if n < 0 { self.div(&one, &result) } else { Ok(result) }
    }
}

impl<A: Arithmetic> Arithmetic for &A {
    type Number = A::Number;

    fn rational(&self, value: &RBig) -> Result<Self::Number, Refusal> {
        (**self).rational(value)
    }
    fn pi(&self) -> Result<Self::Number, Refusal> {
        (**self).pi()
    }
    fn add(&self, a: &Self::Number, b: &Self::Number) -> Result<Self::Number, Refusal> {
        (**self).add(a, b)
    }
    fn sub(&self, a: &Self::Number, b: &Self::Number) -> Result<Self::Number, Refusal> {
        (**self).sub(a, b)
    }
    fn mul(&self, a: &Self::Number, b: &Self::Number) -> Result<Self::Number, Refusal> {
        (**self).mul(a, b)
    }
    fn div(&self, a: &Self::Number, b: &Self::Number) -> Result<Self::Number, Refusal> {
        (**self).div(a, b)
    }
    fn neg(&self, a: &Self::Number) -> Result<Self::Number, Refusal> {
        (**self).neg(a)
    }
    fn apply(&self, function: Function, a: &Self::Number) -> Result<Self::Number, Refusal> {
        (**self).apply(function, a)
    }
    fn is_zero(&self, a: &Self::Number) -> Option<bool> {
        (**self).is_zero(a)
    }
    fn power(&self, a: &Self::Number, n: i32) -> Result<Self::Number, Refusal> {
        (**self).power(a, n)
    }
}
