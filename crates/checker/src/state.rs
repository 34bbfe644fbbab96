//! A state in exact numbers, as plain data.

use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Numerators and denominators have at most so many decimal digits.
const MOST_DIGITS: usize = 20_000;

/// A rational number; in JSON its text, `"-3/2"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ratio(pub RBig);

impl Ratio {
    /// Reads `-3/2` or `7`: digits, no more than one sign, no zero below the bar.
    pub fn parse(text: &str) -> Option<Ratio> {
        let (sign, digits) = match text.strip_prefix('-') {
            Some(rest) => (-1, rest),
            None => (1, text),
        };
        let (top, bottom) = digits.split_once('/').unwrap_or((digits, "1"));
        let whole = |part: &str| -> Option<UBig> {
            let plain =
                !part.is_empty() && part.len() <= MOST_DIGITS && part.bytes().all(|b| b.is_ascii_digit());
            if plain { UBig::from_str_radix(part, 10).ok() } else { None }
        };
        let (top, bottom) = (whole(top)?, whole(bottom)?);
        if bottom.is_zero() {
            return None;
        }
        Some(Ratio(RBig::from_parts(IBig::from(sign) * IBig::from(top), bottom)))
    }
}

impl Serialize for Ratio {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0.to_string())
    }
}

impl<'de> Deserialize<'de> for Ratio {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = Cow::<str>::deserialize(deserializer)?;
        Ratio::parse(&text).ok_or_else(|| D::Error::custom("a number is written as digits, such as \"-3/2\""))
    }
}

/// The exact value of one symbol.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExactCoordinate {
    /// A rational number; of an angle, in radians.
    Number(Ratio),
    /// An angle by its sine and cosine: the one between minus pi and pi, pi counted.
    Angle {
        /// Its sine.
        sin: Ratio,
        /// Its cosine.
        cos: Ratio,
    },
    /// The value of an operation of the listing, which has to come before all that mention the symbol: `sqrt(2)`, `pi/2`.
    Step(usize),
}

impl ExactCoordinate {
    /// A value of the kind that a symbol has, where only the kind is asked: an angle of zero, or one.
    pub(super) fn unit(is_angle: bool) -> ExactCoordinate {
        let [none, one] = [RBig::ZERO, RBig::ONE].map(Ratio);
        if is_angle { ExactCoordinate::Angle { sin: none, cos: one } } else { ExactCoordinate::Number(one) }
    }

    /// Whether sine and cosine, where it is given by them, lie on the unit circle.
    pub fn is_on_the_circle(&self) -> bool {
        match self {
            ExactCoordinate::Angle { sin, cos } => (&sin.0 * &sin.0 + &cos.0 * &cos.0).is_one(),
            ExactCoordinate::Number(_) | ExactCoordinate::Step(_) => true,
        }
    }
}

/// Values for symbols, by name.
pub type ExactState = BTreeMap<String, ExactCoordinate>;
