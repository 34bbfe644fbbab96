//! Is an expression identically zero? Exact arithmetic at random points of random prime fields.
//!
//! Let the expression be `N/D` with `N` of degree `d` whose coefficients have sums of magnitudes below `2^b`. If `N`
//! is not zero, then one round misses it with a probability of at most
//!
//! - `(b/61) / 2^55.5`, that a prime between 2^61 and 2^62, of which there are so many, divides all its coefficients;
//! - plus `d / 2^61 / (1 - d / 2^61)`, that it vanishes at a random point at which `D` does not.
//!
//! Reference: J. T. Schwartz, *Fast probabilistic algorithms for verification of polynomial identities*, J. ACM 27
//! (1980); R. Zippel, *Probabilistic algorithms for sparse polynomials* (1979).

use super::graph::{Graph, NodeId, Symbol};
use super::input::Input;
use super::program::Program;
use crate::number::polynomial::Size;
use crate::number::{Arithmetic, Fractions, LOG2_PRIMES, PrimeField, Refusal};
use dashu::rational::RBig;
use rand::Rng;
use std::collections::HashMap;

/// The error probability that a proof has to get below, as a power of two.
pub const LOG2_ERROR: f64 = -100.0;

/// How often a point is drawn anew because it is a pole.
const ATTEMPTS: usize = 40;

/// What a test of expressions has found.
#[derive(Clone, Debug, PartialEq)]
pub enum ZeroTest {
    /// All are identically zero, error probability below `2^log2_error`.
    Zero {
        /// Zero itself if the expressions were the constant zero and nothing had to be tested.
        log2_error: f64,
        /// The number of random points.
        points: usize,
        /// The bound on the degree.
        degree: f64,
    },
    /// The one of this index is not zero as an expression in its inputs; this is certain.
    Nonzero(usize),
    /// Every point was a pole; this divisor was zero.
    Pole(NodeId),
    /// Nothing was found out.
    Unknown(String),
}

/// Tests whether all of `roots` are identically zero. Functions other than sines and cosines of angles are treated
/// as unknowns of their own: what is zero for all their values is zero for the right ones, but not the other way.
pub fn identically_zero(
    graph: &Graph,
    roots: &[NodeId],
    is_angle: impl Fn(Symbol) -> bool,
    rng: &mut impl Rng,
) -> ZeroTest {
    if roots.iter().all(|root| graph.constant_value(*root).is_some_and(|c| c.is_zero())) {
        return ZeroTest::Zero { log2_error: f64::NEG_INFINITY, points: 0, degree: 0.0 };
    }
    let mut program = Program::with_unknown_functions(graph, roots, is_angle);
    if program.bare_angle().is_some() {
        // an angle is a number like others then, and its sine and cosine are unknowns beside it
        program = Program::with_unknown_functions(graph, roots, |_| false);
    }
    let is_nonzero = |values: Vec<u64>| values.iter().position(|value| *value != 0).map(ZeroTest::Nonzero);
    // what is not zero shows it at once, and needs no bound
    match round(&program, rng).map(is_nonzero) {
        Ok(None) => {}
        Ok(Some(nonzero)) => return nonzero,
        Err(stop) => return stop,
    }
    let size = match sizes(&program) {
        Ok(sizes) => sizes.into_iter().fold(Size::default(), |a, (top, _)| Size {
            degree: a.degree.max(top.degree),
            bits: a.bits.max(top.bits),
        }),
        Err(why) => return ZeroTest::Unknown(why.to_string()),
    };
    let Some((rounds, log2_error)) = failure_bound(size) else {
        return ZeroTest::Unknown(format!(
            "the degree may be {:.1e}, too large for the prime fields",
            size.degree
        ));
    };
    for _ in 1..rounds {
        match round(&program, rng).map(is_nonzero) {
            Ok(None) => {}
            Ok(Some(nonzero)) => return nonzero,
            Err(stop) => return stop,
        }
    }
    ZeroTest::Zero { log2_error, points: rounds, degree: size.degree }
}

/// The number of rounds that bring the probability of an error below `2^-100`, and the bound that they reach. `None`
/// where one round says next to nothing.
pub fn failure_bound(size: Size) -> Option<(usize, f64)> {
    let at_a_point = size.degree / 2f64.powi(61);
    if at_a_point > 0.5 {
        return None;
    }
    let miss = (size.bits / 61.0) / LOG2_PRIMES.exp2() + at_a_point / (1.0 - at_a_point);
    // a sum of logarithms near zero: rounding cannot lift the bound by more than the guard of one bit
    let each = miss.max(f64::MIN_POSITIVE).log2() + 1.0;
    if each > -2.0 {
        return None;
    }
    let rounds = (LOG2_ERROR / each).ceil().max(1.0);
    Some((rounds as usize, rounds * each))
}

/// The values of a program at one random point of one random field.
fn round(program: &Program, rng: &mut impl Rng) -> Result<Vec<u64>, ZeroTest> {
    let mut registers = Vec::new();
    let mut divisor = None;
    for _ in 0..ATTEMPTS {
        let field = PrimeField::random(rng);
        let Ok(loaded) = program.load(field) else { continue };
        let inputs = draw_residues(program, &field, rng);
        match loaded.run(&inputs, &mut registers) {
            Ok(values) => return Ok(values),
            Err(failure) => match failure.divisor {
                Some(zero) => divisor = Some(zero),
                None => return Err(ZeroTest::Unknown(failure.refusal.to_string())),
            },
        }
    }
    Err(divisor.map_or_else(|| ZeroTest::Unknown("no prime field fits".to_owned()), ZeroTest::Pole))
}

/// Random inputs for a program; sine and cosine of one angle come from one random tangent of its half.
pub fn draw_residues(program: &Program, field: &PrimeField, rng: &mut impl Rng) -> Vec<u64> {
    let mut angles: HashMap<Symbol, (u64, u64)> = HashMap::new();
    let mut inputs = Vec::with_capacity(program.inputs().len());
    for input in program.inputs() {
        inputs.push(match input {
            Input::Plain(_) | Input::Opaque(_) => field.draw(rng),
            Input::Sine(symbol) => angles.entry(*symbol).or_insert_with(|| unit_residue(field, rng)).0,
            Input::Cosine(symbol) => angles.entry(*symbol).or_insert_with(|| unit_residue(field, rng)).1,
        });
    }
    inputs
}

/// A random point of the unit circle modulo the prime.
pub(super) fn unit_residue(field: &PrimeField, rng: &mut impl Rng) -> (u64, u64) {
    loop {
        if let Ok(pair) = half_tangent(field, &field.draw(rng)) {
            return pair;
        }
    }
}

/// Sine and cosine from the tangent `t` of the half angle.
fn half_tangent<A: Arithmetic>(arithmetic: &A, t: &A::Number) -> Result<(A::Number, A::Number), Refusal> {
    let one = arithmetic.rational(&RBig::ONE)?;
    let square = arithmetic.mul(t, t)?;
    let bottom = arithmetic.add(&one, &square)?;
    let sine = arithmetic.div(&arithmetic.add(t, t)?, &bottom)?;
    let cosine = arithmetic.div(&arithmetic.sub(&one, &square)?, &bottom)?;
    Ok((sine, cosine))
}

/// Bounds on the numerators and the denominators of a program's expressions, as polynomials in its inputs and in the
/// tangents of the half angles.
///
/// # Errors
/// Where no bound is found: a division by the constant zero.
pub fn sizes(program: &Program) -> Result<Vec<(Size, Size)>, Refusal> {
    let fractions = Fractions::<Size>::default();
    let mut angles = HashMap::new();
    let mut inputs = Vec::new();
    for input in program.inputs() {
        // 2t/(1+t^2) and (1-t^2)/(1+t^2), over one common factor for each angle
        let mut circle = |symbol: Symbol| {
            angles.entry(symbol).or_insert_with(|| fractions.element(Size { degree: 2.0, bits: 1.0 })).clone()
        };
        let (top, bottom) = match input {
            Input::Plain(_) | Input::Opaque(_) => (Size { degree: 1.0, bits: 0.0 }, None),
            Input::Sine(symbol) => (Size { degree: 1.0, bits: 1.0 }, Some(circle(*symbol))),
            Input::Cosine(symbol) => (Size { degree: 2.0, bits: 1.0 }, Some(circle(*symbol))),
        };
        let top = fractions.element(top);
        inputs.push(match bottom {
            Some(bottom) => fractions.div(&top, &bottom)?,
            None => top,
        });
    }
    let loaded = program.load(&fractions)?;
    let values = loaded.run(&inputs, &mut Vec::new()).map_err(|failure| failure.refusal)?;
    values.iter().map(|value| Ok((fractions.expand(&value.top)?, fractions.expand(&value.bottom)?))).collect()
}
