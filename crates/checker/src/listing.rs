//! A straight-line list of operations as plain data, and its evaluation over any numbers.

use super::doubt::{Effort, Missing};
use super::state::Ratio;
use dashu::rational::RBig;
use palmistry_math::number::{Arithmetic, Function};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// No listing is longer: one of this length takes some hundred megabytes.
pub const MOST_STEPS: usize = 1 << 20;
/// No symbol's name is longer, in bytes.
const LONGEST_NAME: usize = 256;

/// From what work is taken, and how much for each value.
pub struct Expense<'e, N> {
    pub effort: &'e Effort,
    pub of: fn(&N) -> u64,
    pub each: u64,
}

/// One operation; its operands are the places of earlier ones.
///
/// In JSON a list: `["const","1/2"]`, `["pi"]`, `["symbol","x"]`, `["add",0,1]` (likewise `sub`, `mul`, `div`), `["neg",0]`,
/// `["power",0,-2]`, `["apply","sin",0]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    Constant(RBig),
    Pi,
    Symbol(String),
    Add(usize, usize),
    Sub(usize, usize),
    Mul(usize, usize),
    Div(usize, usize),
    Neg(usize),
    Power(usize, i32),
    Apply(Function, usize),
}

impl Step {
    /// The places that it needs.
    pub fn operands(&self) -> impl Iterator<Item = usize> {
        let (a, b) = match *self {
            Step::Constant(_) | Step::Pi | Step::Symbol(_) => (None, None),
            Step::Add(a, b) | Step::Sub(a, b) | Step::Mul(a, b) | Step::Div(a, b) => (Some(a), Some(b)),
            Step::Neg(a) | Step::Power(a, _) | Step::Apply(_, a) => (Some(a), None),
        };
        a.into_iter().chain(b)
    }
}

/// Operations, each of which needs only earlier ones.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listing {
    steps: Vec<Step>,
}

impl Listing {
    /// Adds an operation and says its place.
    ///
    /// # Errors
    /// Where an operand does not come before it, a name is too long, or the list is full.
    pub fn push(&mut self, step: Step) -> Result<usize, Missing> {
        let place = self.steps.len();
        let named = !matches!(&step, Step::Symbol(name) if name.len() > LONGEST_NAME || name.is_empty());
        if place >= MOST_STEPS || !named || step.operands().any(|operand| operand >= place) {
            return Err(Missing::Place { place });
        }
        self.steps.push(step);
        Ok(place)
    }

    /// The operations, in their order.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// The value of every operation, or why it has none here. `known` may give the value of a place; it has to give
    /// those of symbols, for which it is also shown the values before.
    pub fn run<A: Arithmetic>(
        &self,
        arithmetic: &A,
        expense: Expense<'_, A::Number>,
        known: impl Fn(usize, &Step, &[Result<A::Number, Missing>]) -> Option<Result<A::Number, Missing>>,
    ) -> Vec<Result<A::Number, Missing>> {
        let mut values: Vec<Result<A::Number, Missing>> = Vec::with_capacity(self.steps.len());
        for (place, step) in self.steps.iter().enumerate() {
            let value = match expense.effort.spend(expense.each) {
                Ok(()) => {
                    known(place, step, &values).unwrap_or_else(|| one(arithmetic, place, step, &values))
                }
                Err(exhausted) => Err(exhausted),
            };
            // what is long takes longer: as the square of its length
            let paid = |value| match expense.effort.spend((expense.of)(&value)) {
                Ok(()) => Ok(value),
                Err(exhausted) => Err(exhausted),
            };
            values.push(value.and_then(paid));
        }
        values
    }
}

/// The value of one operation.
fn one<A: Arithmetic>(
    arithmetic: &A,
    place: usize,
    step: &Step,
    values: &[Result<A::Number, Missing>],
) -> Result<A::Number, Missing> {
    let at =
        |operand: usize| values.get(operand).ok_or(Missing::Place { place })?.as_ref().map_err(|why| *why);
    match step {
        Step::Constant(value) => arithmetic.rational(value),
        Step::Pi => arithmetic.pi(),
        Step::Symbol(_) => return Err(Missing::Symbol { place }),
        Step::Add(a, b) => arithmetic.add(at(*a)?, at(*b)?),
        Step::Sub(a, b) => arithmetic.sub(at(*a)?, at(*b)?),
        Step::Mul(a, b) => arithmetic.mul(at(*a)?, at(*b)?),
        Step::Div(a, b) => arithmetic.div(at(*a)?, at(*b)?),
        Step::Neg(a) => arithmetic.neg(at(*a)?),
        Step::Power(a, n) => arithmetic.power(at(*a)?, *n),
        Step::Apply(function, a) => arithmetic.apply(*function, at(*a)?),
    }
    .map_err(|refusal| Missing::Refused { place, refusal })
}

impl Serialize for Step {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Step::Constant(value) => ("const", value.to_string()).serialize(serializer),
            Step::Pi => ["pi"].serialize(serializer),
            Step::Symbol(name) => ("symbol", name).serialize(serializer),
            Step::Add(a, b) => ("add", a, b).serialize(serializer),
            Step::Sub(a, b) => ("sub", a, b).serialize(serializer),
            Step::Mul(a, b) => ("mul", a, b).serialize(serializer),
            Step::Div(a, b) => ("div", a, b).serialize(serializer),
            Step::Neg(a) => ("neg", a).serialize(serializer),
            Step::Power(a, n) => ("power", a, n).serialize(serializer),
            Step::Apply(function, a) => ("apply", function.name(), a).serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Step {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(StepReader)
    }
}

struct StepReader;

/// The next part of a step, which has to be there.
fn next<'de, T: Deserialize<'de>, A: SeqAccess<'de>>(parts: &mut A) -> Result<T, A::Error> {
    parts.next_element()?.ok_or_else(|| A::Error::custom("an operation lacks an operand"))
}

impl<'de> Visitor<'de> for StepReader {
    type Value = Step;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an operation such as [\"add\",0,1]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut parts: A) -> Result<Step, A::Error> {
        let word: String = next(&mut parts)?;
        let step = match word.as_str() {
            "const" => Step::Constant(next::<Ratio, A>(&mut parts)?.0),
            "pi" => Step::Pi,
            "symbol" => Step::Symbol(next(&mut parts)?),
            "add" => Step::Add(next(&mut parts)?, next(&mut parts)?),
            "sub" => Step::Sub(next(&mut parts)?, next(&mut parts)?),
            "mul" => Step::Mul(next(&mut parts)?, next(&mut parts)?),
            "div" => Step::Div(next(&mut parts)?, next(&mut parts)?),
            "neg" => Step::Neg(next(&mut parts)?),
            "power" => Step::Power(next(&mut parts)?, next(&mut parts)?),
            "apply" => {
                let name: String = next(&mut parts)?;
                let function = Function::ALL.into_iter().find(|function| function.name() == name);
                Step::Apply(function.ok_or_else(|| A::Error::custom("no such function"))?, next(&mut parts)?)
            }
            _ => return Err(A::Error::custom("no such operation")),
        };
        match parts.next_element::<serde::de::IgnoredAny>()? {
            None => Ok(step),
            Some(_) => Err(A::Error::custom("an operation has an operand too many")),
        }
    }
}

impl Serialize for Listing {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.steps.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Listing {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ListingReader;
        impl<'de> Visitor<'de> for ListingReader {
            type Value = Listing;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of operations")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut steps: A) -> Result<Listing, A::Error> {
                let mut listing = Listing::default();
                while let Some(step) = steps.next_element()? {
                    listing.push(step).map_err(A::Error::custom)?;
                }
                Ok(listing)
            }
        }
        deserializer.deserialize_seq(ListingReader)
    }
}
