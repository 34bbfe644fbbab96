//! A second point with the same outputs, in exact numbers.
//!
//! Where a fibre has two points and the one is rational, so is the other: its coordinates are the sums of the roots of
//! quadratic polynomials
//! less the first ones. They are found modulo some primes and put together, and then the derivatives of the outputs at both points are
//! compared in rational numbers: nothing that was found modulo primes is left in that.

use super::model::{Model, Motion};
use super::point::{Fibre, Held, Numbering, Source};
use super::round::{Course, analysed};
use super::{SecondPoint, SolutionsQuestion};
use crate::observability::flow::Flow;
use crate::observability::generic::Orders;
use dashu::base::{Abs, DivRem, UnsignedAbs};
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_math::expression::Input;
use palmistry_math::number::{PrimeField, Rationals};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::collections::HashMap;

/// Numbers of so many primes are put together.
const PRIMES: usize = 4;
/// So many points are tried.
const ATTEMPTS: usize = 3;
/// So many derivatives beyond those that determine all are compared.
const FURTHER: usize = 3;
/// Longer numbers make no witness: nobody would read them.
const BITS: usize = 1 << 16;

/// Two points of one fibre.
pub(super) fn second_point(
    model: &Model,
    orders: &Orders,
    question: &SolutionsQuestion,
    course: &Course,
    rng: &mut ChaCha8Rng,
) -> Option<SecondPoint> {
    (0..ATTEMPTS).find_map(|_| attempt(model, orders, question, course, rng))
}

fn attempt(
    model: &Model,
    orders: &Orders,
    question: &SolutionsQuestion,
    course: &Course,
    rng: &mut ChaCha8Rng,
) -> Option<SecondPoint> {
    let numbering = Numbering { variables: model.variables.len(), asked: model.asked.len() };
    let way = course.way.get()?;
    let orders = &orders.and_further(way.further);
    let deepest = orders.last.iter().copied().max()? + FURTHER;
    let mut given: HashMap<u32, i64> = HashMap::new();
    for (place, variable) in model.variables.iter().enumerate() {
        let last = if matches!(variable.motion, Motion::Driven) { deepest } else { 0 };
        for order in 0..=last {
            given.insert(numbering.jet(place, order), rng.random_range(1..=12));
        }
    }
    let mut modulus = IBig::ONE;
    let mut residues: Vec<IBig> = vec![IBig::ZERO; model.unknowns.len()];
    for _ in 0..PRIMES {
        let field = PrimeField::random(rng);
        let source = &mut Source { rng, given: given.clone() };
        let fibre = Fibre::new(model, orders, field, source, Held::AtThePoint).ok()?;
        let round = analysed(model, fibre, question, course, (way, question.work), rng).ok()?;
        if round.points != 2 {
            return None;
        }
        let p = IBig::from(field.modulus());
        let inverse = field.inverse(field.integer(&modulus))?;
        for (place, (_, places)) in model.unknowns.iter().enumerate() {
            let own = field.integer(&given[&(*places.first()? as u32)].into());
            let other = match round.polynomials[place].as_slice() {
                [_, _] => own,
                // minus the sum of the roots stands before the first power
                [_, slope, _] => field.modulus() - field.sum(*slope, own),
                _ => return None,
            };
            let other = if other == field.modulus() { 0 } else { other };
            // the next digit in the mixed radix of these primes
            let before = field.integer(&residues[place]);
            let difference = field.sum(other, if before == 0 { 0 } else { field.modulus() - before });
            let digit = field.representative(field.product(difference, inverse));
            residues[place] += IBig::from(digit) * &modulus;
        }
        modulus *= p;
    }
    let own: Vec<RBig> =
        model.unknowns.iter().map(|(_, places)| RBig::from(given[&(places[0] as u32)])).collect();
    let other: Vec<RBig> =
        residues.iter().map(|residue| rational(residue, &modulus)).collect::<Option<_>>()?;
    if own == other {
        return None;
    }
    let first = derivatives(model, &numbering, &given, &own, deepest)?;
    if first != derivatives(model, &numbering, &given, &other, deepest)? {
        return None;
    }
    let names = model.unknowns.iter().map(|(symbol, _)| model.graph.symbol_name(*symbol).to_owned());
    let values = names.zip(own).zip(other).map(|((name, own), other)| (name, own, other)).collect();
    Some(SecondPoint { values, order: deepest })
}

/// The fraction of small numbers that a residue is the image of (P. Wang, 1981).
fn rational(residue: &IBig, modulus: &IBig) -> Option<RBig> {
    let (mut a, mut b) = (modulus.clone(), residue.clone());
    let (mut s, mut t) = (IBig::ZERO, IBig::ONE);
    // both parts are to be below the square root of half the modulus
    while &b * &b * IBig::from(2) > *modulus {
        let (quotient, rest) = (&a).div_rem(&b);
        (a, b) = (b, rest);
        (s, t) = (t.clone(), s - quotient * t);
    }
    if t.is_zero() || (&t * &t).abs() * IBig::from(2) > *modulus {
        return None;
    }
    let sign = if t < IBig::ZERO { -IBig::ONE } else { IBig::ONE };
    Some(RBig::from_parts(b * sign, t.unsigned_abs()))
}

/// The outputs as power series at a point, each up to an order.
fn derivatives(
    model: &Model,
    numbering: &Numbering,
    given: &HashMap<u32, i64>,
    unknowns: &[RBig],
    order: usize,
) -> Option<Vec<Vec<RBig>>> {
    let flow = Flow::new(&model.graph, &model.rates, &model.measured, |_| false);
    let mut signals = Vec::new();
    for input in flow.inputs() {
        let Input::Plain(symbol) = input else { return None };
        if let Some(place) = model.unknowns.iter().position(|(unknown, _)| unknown == symbol) {
            signals.push(vec![unknowns[place].clone()]);
            continue;
        }
        let place = model.variables.iter().position(|variable| variable.input == *input)?;
        let last = if matches!(model.variables[place].motion, Motion::Driven) { order } else { 0 };
        let mut factorial = RBig::ONE;
        let mut series = Vec::new();
        for k in 0..=last {
            if k > 0 {
                factorial *= RBig::from(k as u64);
            }
            series.push(RBig::from(given[&numbering.jet(place, k)]) / &factorial);
        }
        signals.push(series);
    }
    let found = flow.coefficients(&Rationals { bits: BITS }, &signals, order).ok()?;
    let series = found.into_iter().map(|series| {
        let mut values: Vec<RBig> = series.into_iter().map(|term| term.unwrap_or(RBig::ZERO)).collect();
        values.resize(order + 1, RBig::ZERO);
        values
    });
    Some(series.collect())
}
