//! The value of an expression at a point, to as many digits as are asked for, all of them certain.

use crate::expression::{Failure, Graph, Input, NodeId, Program, Symbol};
use crate::number::{Arithmetic, Enclosure, Enclosures, Rationals, Refusal, round_to_decimal};
use dashu::rational::RBig;
use std::collections::HashMap;

/// A value whose digits are all certain.
#[derive(Clone, Debug, PartialEq)]
pub struct CertifiedValue {
    /// Correctly rounded to the digits that were asked for.
    pub decimal: String,
    /// The value itself, where it is rational and was computed exactly.
    pub exact: Option<RBig>,
    /// The precision that was needed, in bits; zero where the value is exact.
    pub bits: usize,
}

/// Why there is no such value.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ValueError {
    /// A symbol has no value.
    #[error("'{0}' has no value")]
    Missing(String),
    /// A divisor is zero.
    #[error("division by zero: {0} = 0 at this point")]
    Pole(String),
    /// A divisor could not be told from zero.
    #[error("{divisor} cannot be told from zero with {bits} bits: the point is a pole, or very near to one")]
    NearPole { divisor: String, bits: usize },
    /// The value could not be told from zero, or from the middle between two decimals.
    #[error("the value is {0}, and could not be fixed to more digits")]
    NotSeparated(String),
    /// An operation is not defined here.
    #[error("{0}")]
    Undefined(String),
}

/// No more bits than this are tried.
const MOST_BITS: usize = 1 << 16;

/// Fills the inputs of a program from rational values (angles in radians).
fn inputs<A: Arithmetic>(
    graph: &Graph,
    program: &Program,
    arithmetic: &A,
    values: &HashMap<Symbol, RBig>,
) -> Result<Vec<A::Number>, ValueError> {
    let value = |input: &Input| match input {
        Input::Plain(symbol) => {
            let missing = || ValueError::Missing(graph.symbol_name(*symbol).to_owned());
            arithmetic
                .rational(values.get(symbol).ok_or_else(missing)?)
                .map_err(|refusal| ValueError::Undefined(refusal.to_string()))
        }
        _ => Err(ValueError::Undefined("an input that is no symbol".to_owned())),
    };
    program.inputs().iter().map(value).collect()
}

fn undefined(graph: &Graph, failure: &Failure, bits: usize) -> ValueError {
    match (failure.refusal, failure.divisor) {
        (Refusal::DivisionByZero, Some(divisor)) => ValueError::Pole(graph.text(divisor)),
        (Refusal::DivisorNotSeparated, Some(divisor)) => {
            ValueError::NearPole { divisor: graph.text(divisor), bits }
        }
        (refusal, _) => ValueError::Undefined(format!("{refusal}, in {}", graph.text(failure.node))),
    }
}

/// Encloses a value with the given precision.
///
/// # Errors
/// Where it is not defined, or cannot be told from undefined at this precision.
pub(crate) fn enclose(
    graph: &Graph,
    program: &Program,
    values: &HashMap<Symbol, RBig>,
    bits: usize,
) -> Result<Vec<Enclosure>, ValueError> {
    let arithmetic = Enclosures::new(bits);
    let inputs = inputs(graph, program, &arithmetic, values)?;
    let loaded = program.load(arithmetic).map_err(|refusal| ValueError::Undefined(refusal.to_string()))?;
    loaded.run(&inputs, &mut Vec::new()).map_err(|failure| undefined(graph, &failure, bits))
}

/// The value of an expression at a point given by rational numbers (angles in radians), to `digits` significant
/// decimal digits.
///
/// # Errors
/// Where the point lacks a value, is a pole, or lies outside a function's domain; or where more than 65 thousand bits
/// would be needed.
pub fn certified_value(
    graph: &Graph,
    expression: NodeId,
    values: &HashMap<Symbol, RBig>,
    digits: usize,
) -> Result<CertifiedValue, ValueError> {
    let program = Program::new(graph, &[expression], |_| false, false);
    let exact = Rationals::default();
    let exact_inputs = inputs(graph, &program, &exact, values)?;
    if let Ok(loaded) = program.load(exact) {
        match loaded.run(&exact_inputs, &mut Vec::new()) {
            Ok(value) => {
                let value = value[0].clone();
                return Ok(CertifiedValue {
                    decimal: round_to_decimal(&value, digits),
                    exact: Some(value),
                    bits: 0,
                });
            }
            Err(failure) if failure.refusal == Refusal::DivisionByZero => {
                return Err(undefined(graph, &failure, 0));
            }
            Err(_) => {}
        }
    }
    let mut bits = digits * 7 / 2 + 64;
    loop {
        let last = bits >= MOST_BITS;
        let complaint = match enclose(graph, &program, values, bits) {
            Ok(found) => match found[0].decimal(digits) {
                Some(decimal) => return Ok(CertifiedValue { decimal, exact: None, bits }),
                None if found[0].contains_zero() => {
                    let bound = round_to_decimal(&found[0].high().max(-found[0].low()), 2);
                    ValueError::NotSeparated(format!("smaller than {bound} in magnitude"))
                }
                None => ValueError::NotSeparated(format!("near {}", found[0].midpoint())),
            },
            Err(error @ (ValueError::Missing(_) | ValueError::Pole(_))) => return Err(error),
            Err(error) => error,
        };
        if last {
            return Err(complaint);
        }
        bits = (bits * 2).min(MOST_BITS);
    }
}
