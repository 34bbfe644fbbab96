//! The value of an expression at a point, to as many digits as are asked for, by the cheapest numbers that suffice.

use crate::expression::{Failure, Graph, Input, NodeId, Program, Symbol};
use crate::number::{
    Arithmetic, DoubleDouble, Enclosure, Enclosures, Floats, Interval, Rationals, Real, Refusal, Rung,
    common_decimal, rational_from_f64, round_to_decimal,
};
use crate::observability::Certainty;
use dashu::rational::RBig;
use std::collections::HashMap;

/// A value at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct PointValue {
    /// Rounded to the digits that were asked for.
    pub decimal: String,
    /// The value itself, where it is rational and was computed exactly.
    pub exact: Option<RBig>,
    /// Whether all digits are certain, or two rungs of the ladder agree on them.
    pub certainty: Certainty,
    /// The numbers that sufficed.
    pub rung: Rung,
    /// How many rungs had been tried before and did not suffice.
    pub climbed: usize,
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

/// Up to so many decimal digits doubles are tried.
const DIGITS_OF_A_DOUBLE: usize = 15;

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

/// The program over an arithmetic at a point.
fn evaluate<A: Arithmetic + Copy>(
    graph: &Graph,
    program: &Program,
    values: &HashMap<Symbol, RBig>,
    arithmetic: A,
) -> Result<Option<A::Number>, ValueError> {
    let inputs = inputs(graph, program, &arithmetic, values)?;
    let Ok(loaded) = program.load(arithmetic) else { return Ok(None) };
    match loaded.run(&inputs, &mut Vec::new()) {
        Ok(found) => Ok(found.into_iter().next()),
        Err(failure) if failure.refusal == Refusal::DivisionByZero => Err(undefined(graph, &failure, 0)),
        Err(_) => Ok(None),
    }
}

/// The value of an expression at a point given by rational numbers (angles in radians), to `digits` significant
/// decimal digits that are all certain: by intervals of doubles if they suffice, else exactly if there is an exact
/// value, else by enclosures of more and more bits.
///
/// # Errors
/// Where the point lacks a value, is a pole, or lies outside a function's domain; or where more than 65 thousand bits
/// would be needed.
pub fn certified_value(
    graph: &Graph,
    expression: NodeId,
    values: &HashMap<Symbol, RBig>,
    digits: usize,
) -> Result<PointValue, ValueError> {
    let program = Program::new(graph, &[expression], |_| false, false);
    let mut climbed = 0;
    let found = |decimal, exact, rung, climbed| {
        Ok(PointValue { decimal, exact, certainty: Certainty::Certified, rung, climbed })
    };
    if digits <= DIGITS_OF_A_DOUBLE {
        let interval = evaluate(graph, &program, values, Floats::<Interval>::new())?;
        let ends = interval
            .and_then(|value| Some((rational_from_f64(value.low())?, rational_from_f64(value.high())?)));
        if let Some((low, high)) = ends
            && let Some(decimal) = common_decimal(&low, &high, digits)
        {
            let exact = (low == high).then_some(low);
            return found(decimal, exact, Rung::Intervals, climbed);
        }
        climbed += 1;
    }
    if let Some(value) = evaluate(graph, &program, values, Rationals::default())? {
        return found(round_to_decimal(&value, digits), Some(value), Rung::Exact, climbed);
    }
    let mut bits = digits * 7 / 2 + 64;
    loop {
        let last = bits >= MOST_BITS;
        let complaint = match enclose(graph, &program, values, bits) {
            Ok(enclosure) => match enclosure[0].decimal(digits) {
                Some(decimal) => return found(decimal, None, Rung::Enclosures(bits), climbed),
                None if enclosure[0].contains_zero() => {
                    let bound = round_to_decimal(&enclosure[0].high().max(-enclosure[0].low()), 2);
                    ValueError::NotSeparated(format!("smaller than {bound} in magnitude"))
                }
                None => ValueError::NotSeparated(format!("near {}", enclosure[0].midpoint())),
            },
            Err(error @ (ValueError::Missing(_) | ValueError::Pole(_))) => return Err(error),
            Err(error) => error,
        };
        if last {
            return Err(complaint);
        }
        climbed += 1;
        bits = (bits * 2).min(MOST_BITS);
    }
}

/// The value of an expression at a point to `digits` significant decimal digits, as far as two rungs of the ladder
/// agree on them: doubles and double-doubles. Where these do not agree, or where more digits are wanted, it is taken
/// from [`certified_value`].
///
/// # Errors
/// As for [`certified_value`].
pub fn computed_value(
    graph: &Graph,
    expression: NodeId,
    values: &HashMap<Symbol, RBig>,
    digits: usize,
) -> Result<PointValue, ValueError> {
    let program = Program::new(graph, &[expression], |_| false, false);
    let mut climbed = 0;
    if digits <= DIGITS_OF_A_DOUBLE {
        let rough = evaluate(graph, &program, values, Floats)?;
        let fine = evaluate(graph, &program, values, Floats::<DoubleDouble>::new())?.map(Real::to_f64);
        if let (Some(rough), Some(fine)) = (rough, fine)
            && (rough - fine).abs() <= 0.5 * 10f64.powi(-(digits as i32)) * fine.abs()
            && let Some(value) = rational_from_f64(fine)
        {
            let decimal = round_to_decimal(&value, digits);
            let certainty = Certainty::Computed;
            return Ok(PointValue { decimal, exact: None, certainty, rung: Rung::DoubleDoubles, climbed });
        }
        climbed = 1;
    }
    let found = certified_value(graph, expression, values, digits)?;
    Ok(PointValue { climbed: found.climbed + climbed, ..found })
}
