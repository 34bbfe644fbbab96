//! The value of an expression at a point, to as many digits as are asked for, by the cheapest numbers that suffice.

use dashu::rational::RBig;
use palmistry_math::expression::{Failure, Graph, Guard, Input, Need, Node, NodeId, Program, Symbol};
use palmistry_math::number::{
    Arithmetic, DoubleDouble, Enclosure, Enclosures, Floats, Interval, NumberType, Rationals, Refusal,
    common_decimal, rational_from_f64, round_to_decimal,
};
use palmistry_rank::sweep::Certainty;
use std::collections::HashMap;

/// A value at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct PointValue {
    /// Rounded to the digits that were asked for.
    pub decimal: String,
    /// The value itself, where it is rational and was computed exactly.
    pub exact: Option<RBig>,
    /// Whether all digits are certain, or two number types agree on them.
    pub certainty: Certainty,
    /// The numbers that sufficed.
    pub number_type: NumberType,
    /// How wide the interval is that encloses the value, both ends of which round to the decimal, to two digits; zero where the value is
    /// known exactly. Nothing where no interval was needed: two kinds of numbers that round agree.
    pub width: Option<String>,
    /// How many number types had been tried before and did not suffice.
    pub climbed: usize,
}

/// Why there is no such value.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)] // names and messages say it
pub enum ValueError {
    /// A symbol has no value.
    #[error("'{0}' has no value")]
    Missing(String),
    /// A divisor is zero.
    #[error("division by zero: {0} = 0 at this point")]
    Pole(String),
    /// A divisor could not be distinguished from zero.
    #[error(
        "{divisor} cannot be distinguished from zero with {bits} bits: the point is singular, or very near to that"
    )]
    NearPole { divisor: String, bits: usize },
    /// The value could not be distinguished from zero, nor be proved to be zero.
    #[error(
        "the value is smaller than {bound} in magnitude: with {bits} bits it could neither be distinguished from zero nor be proved to be zero"
    )]
    PerhapsZero { bound: String, bits: usize },
    /// The value could not be distinguished from the middle between two decimals.
    #[error("the value is near {near}, and with {bits} bits could not be fixed to more digits")]
    NotSeparated { near: String, bits: usize },
    /// An argument could not be distinguished from one outside a function's domain.
    #[error("{why}, in {term}: with {bits} bits the point is at the edge of the domain, or very near to it")]
    NearEdge { why: String, term: String, bits: usize },
    /// A value on the way is beyond what can be held, at this precision.
    #[error("{0}")]
    NotHeld(String),
    /// What the term needs does not hold here.
    #[error("it has no value at this point: it needs {0}")]
    Outside(String),
    /// An operation is not defined here.
    #[error("{0}")]
    Undefined(String),
}

/// Up to so many decimal digits doubles are tried.
const DIGITS_OF_A_DOUBLE: usize = 15;

/// So many bits are tried before a value that is not separated from zero, from a pole or from the edge of a domain is
/// given up; for more digits than these hold, twice the bits that they need.
const MOST_BITS: usize = 1 << 12;

/// With how many bits a value is tried first: those of the digits, and some for what is lost on the way.
fn bits_of(digits: usize) -> usize {
    digits * 7 / 2 + 64
}

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
        (refusal @ Refusal::DomainNotSeparated(_), _) => {
            ValueError::NearEdge { why: refusal.to_string(), term: graph.text(failure.node), bits }
        }
        (refusal @ (Refusal::TooLarge | Refusal::NotFinite), _) => {
            ValueError::NotHeld(format!("{refusal}, in {}", graph.text(failure.node)))
        }
        (refusal, _) => ValueError::Undefined(format!("{refusal}, in {}", graph.text(failure.node))),
    }
}

/// Encloses a value with the given precision.
///
/// # Errors
/// Where it is not defined, or cannot be distinguished from undefined at this precision.
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

/// The factor of a divisor that is zero at a point: through products, powers and quotients to the sum or symbol that
/// vanishes.
fn zero_factor(graph: &Graph, divisor: NodeId, values: &HashMap<Symbol, RBig>) -> NodeId {
    let is_zero = |node: NodeId| {
        let program = Program::plain(graph, &[node]);
        matches!(evaluate(graph, &program, values, Rationals::default()), Ok(Some(value)) if value.is_zero())
    };
    let mut at = divisor;
    loop {
        at = match graph.node(at) {
            Node::Mul(a, b) => {
                if is_zero(a) {
                    a
                } else {
                    b
                }
            }
            Node::Div(a, _) | Node::Neg(a) | Node::Power(a, _) => a,
            _ => return at,
        };
    }
}

/// Whether a term whose guards these are exists at a point given by rational numbers (angles in radians).
///
/// # Errors
/// Where it does not, and why; or where 4096 bits do not decide it.
pub fn exists_at(graph: &Graph, guards: &[Guard], values: &HashMap<Symbol, RBig>) -> Result<(), ValueError> {
    for guard in guards.iter().filter(|guard| guard.is_obvious(graph) != Some(true)) {
        let program = Program::plain(graph, &[guard.node]);
        if let Some(value) = evaluate(graph, &program, values, Rationals::default())? {
            if !guard.need.is_met_by(&value) {
                return Err(match guard.need {
                    Need::NotZero => ValueError::Pole(graph.text(zero_factor(graph, guard.node, values))),
                    _ => ValueError::Outside(guard.text(graph)),
                });
            }
            continue;
        }
        let mut bits = bits_of(0);
        loop {
            let last = bits >= MOST_BITS;
            let complaint = match enclose(graph, &program, values, bits) {
                Ok(value) => match guard.need.is_met_by_enclosure(&value[0]) {
                    Some(true) => break,
                    Some(false) => return Err(ValueError::Outside(guard.text(graph))),
                    None => {
                        let why = "whether the term is defined cannot be decided".to_owned();
                        ValueError::NearEdge { why, term: guard.text(graph), bits }
                    }
                },
                Err(error @ (ValueError::Missing(_) | ValueError::Pole(_) | ValueError::Undefined(_))) => {
                    return Err(error);
                }
                Err(error) => error,
            };
            if last {
                return Err(complaint);
            }
            bits = (bits * 2).min(MOST_BITS);
        }
    }
    Ok(())
}

/// The value of an expression at a point given by rational numbers (angles in radians), to `digits` significant
/// decimal digits that are all certain: by intervals of doubles if they suffice, else exactly if there is an exact
/// value, else by enclosures of more and more bits.
///
/// # Errors
/// Where the point lacks a value, is a pole, or lies outside a function's domain; or where 4096 bits, or twice those of
/// the digits, do not decide.
pub fn certified_value(
    graph: &Graph,
    expression: NodeId,
    values: &HashMap<Symbol, RBig>,
    digits: usize,
) -> Result<PointValue, ValueError> {
    let program = Program::plain(graph, &[expression]);
    let mut climbed = 0;
    let found = |decimal, exact, (number_type, width), climbed| {
        let (certainty, width) = (Certainty::Certified, Some(round_to_decimal(&width, 2)));
        Ok(PointValue { decimal, exact, certainty, number_type, width, climbed })
    };
    if digits <= DIGITS_OF_A_DOUBLE {
        let interval = evaluate(graph, &program, values, Floats::<Interval>::new())?;
        let ends = interval
            .and_then(|value| Some((rational_from_f64(value.low())?, rational_from_f64(value.high())?)));
        if let Some((low, high)) = ends
            && let Some(decimal) = common_decimal(&low, &high, digits)
        {
            let width = &high - &low;
            let exact = width.is_zero().then_some(low);
            return found(decimal, exact, (NumberType::Intervals, width), climbed);
        }
        climbed += 1;
    }
    if let Some(value) = evaluate(graph, &program, values, Rationals::default())? {
        return found(
            round_to_decimal(&value, digits),
            Some(value),
            (NumberType::Exact, RBig::ZERO),
            climbed,
        );
    }
    let mut bits = bits_of(digits);
    let most = MOST_BITS.max(2 * bits);
    loop {
        let complaint = match enclose(graph, &program, values, bits) {
            Ok(enclosure) => match enclosure[0].decimal(digits) {
                Some(decimal) => {
                    let width = enclosure[0].high() - enclosure[0].low();
                    return found(decimal, None, (NumberType::Enclosures(bits), width), climbed);
                }
                None if enclosure[0].contains_zero() => {
                    let bound = round_to_decimal(&enclosure[0].high().max(-enclosure[0].low()), 2);
                    ValueError::PerhapsZero { bound, bits }
                }
                None => ValueError::NotSeparated { near: enclosure[0].midpoint().to_string(), bits },
            },
            // more bits change nothing about these
            Err(error @ (ValueError::Missing(_) | ValueError::Pole(_) | ValueError::Undefined(_))) => {
                return Err(error);
            }
            Err(error) => error,
        };
        if bits >= most {
            return Err(complaint);
        }
        climbed += 1;
        bits = (bits * 2).min(most);
    }
}

/// The value of an expression at a point to `digits` significant decimal digits, as far as two number types
/// agree on them: doubles and double-doubles, both of whose values, rounded from all that they hold, are that decimal.
/// Where these do not agree, or where more digits are wanted, it is taken from [`certified_value`]. So is a zero: that
/// two roundings end at zero says nothing of its digits.
///
/// # Errors
/// As for [`certified_value`].
pub fn computed_value(
    graph: &Graph,
    expression: NodeId,
    values: &HashMap<Symbol, RBig>,
    digits: usize,
) -> Result<PointValue, ValueError> {
    let program = Program::plain(graph, &[expression]);
    let mut climbed = 0;
    if digits <= DIGITS_OF_A_DOUBLE {
        let rough = evaluate(graph, &program, values, Floats)?.and_then(rational_from_f64);
        let fine = evaluate(graph, &program, values, Floats::<DoubleDouble>::new())?;
        let fine = fine.and_then(DoubleDouble::to_rational);
        if let (Some(rough), Some(fine)) = (rough, fine)
            && !fine.is_zero()
            && let Some(decimal) = common_decimal(&rough, &fine, digits)
        {
            let certainty = Certainty::Computed;
            let (exact, width, number_type) = (None, None, NumberType::DoubleDoubles);
            return Ok(PointValue { decimal, exact, certainty, number_type, width, climbed });
        }
        climbed = 1;
    }
    let found = certified_value(graph, expression, values, digits)?;
    Ok(PointValue { climbed: found.climbed + climbed, ..found })
}
