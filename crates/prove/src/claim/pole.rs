//! The order of a pole: how an expression grows where a factor of its denominator vanishes.
//!
//! The factor is made the small quantity of a Laurent series. Over random prime fields the leading exponent is found
//! for all points of the set at once; at a point whose angles are not rational multiples of anything (the thesis
//! takes `phi2 = 2`), an enclosure shows that the leading coefficient does not vanish there.

use super::identity::RANDOM_PRIMES;
use super::verdict::{Verdict, Witness};
use dashu::rational::RBig;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{
    Input, Node, NodeId, Program, Symbol, SymbolInput, draw_residues, expand_angles,
};
use palmistry_math::number::polynomial::Size;
use palmistry_math::number::{Arithmetic, Enclosures, Function, Laurent, PrimeField, Refusal, Series};
use palmistry_rank::observability::NamedCoordinate;
use rand::Rng;
use std::collections::HashMap;

/// The order of a pole and how it is known.
#[derive(Clone, Debug, PartialEq)]
pub enum PoleOrder {
    /// The order (negative for a zero of the expression).
    Order {
        order: i32,
        /// The argument that it is not less fails with at most this probability, as a power of two.
        log2_error: f64,
    },
    /// Why it is not known.
    Unknown(String),
}

/// Coefficients kept of a series; a pole within a pole costs as many as its order.
const TERMS: usize = 24;
const ATTEMPTS: usize = 40;

/// Where the factor becomes the small quantity.
struct Approach {
    /// The expression with the symbol written in terms of the small one (or the same, for the sine of an angle).
    expression: NodeId,
    small: Symbol,
    /// Whether the small quantity is the tangent of half an angle.
    by_angle: bool,
}

/// The order of the pole of `expression` where `factor` vanishes. Symbols in `point` are fixed at rational values
/// (angles in radians); all others are generic.
pub fn pole_order(
    system: &mut System,
    expression: NodeId,
    factor: NodeId,
    point: &HashMap<Symbol, RBig>,
    rng: &mut impl Rng,
) -> PoleOrder {
    let numbers: Assignment = point
        .iter()
        .filter(|(symbol, _)| !system.is_angle(**symbol))
        .map(|(symbol, value)| (*symbol, value.clone()))
        .collect::<Vec<_>>()
        .into_iter()
        .map(|(symbol, value)| (symbol, system.graph.rational(value)))
        .collect();
    let both = system.graph.substitute(&[expression, factor], &numbers);
    let Some(approach) = approach(system, both[0], both[1]) else {
        return PoleOrder::Unknown(
            "the factor is not linear in any symbol that is free, nor the sine of an angle".into(),
        );
    };
    let is_angle = &system.angle_test();
    let expanded = expand_angles(&mut system.graph, &[approach.expression], is_angle);
    let program = Program::new(&system.graph, &expanded, is_angle);
    // the leading coefficients of numerator and denominator are polynomials of no greater degree than these
    let bound = match palmistry_math::expression::sizes(&program) {
        Ok(sizes) => {
            let (top, bottom) = sizes[0];
            Size { degree: top.degree + bottom.degree, bits: top.bits + bottom.bits }
        }
        Err(refusal) => return PoleOrder::Unknown(refusal.to_string()),
    };
    let Some((rounds, log2_error)) = palmistry_math::expression::failure_bound(bound) else {
        return PoleOrder::Unknown("the degree is too large for the prime fields".to_owned());
    };
    if approach.by_angle && point.contains_key(&approach.small) {
        return PoleOrder::Unknown("the angle whose sine is to vanish has a value already".to_owned());
    }
    let generic = match generic_valuation(&program, &approach, false, rounds, rng) {
        Ok(valuation) => valuation,
        Err(why) => return PoleOrder::Unknown(why),
    };
    if approach.by_angle && generic_valuation(&program, &approach, true, rounds, rng) != Ok(generic) {
        return PoleOrder::Unknown(
            "the orders at the angle zero and at half a turn are not the same".to_owned(),
        );
    }
    let fixed_angles: Vec<Symbol> = point.keys().copied().filter(|symbol| system.is_angle(*symbol)).collect();
    if fixed_angles.is_empty() {
        return PoleOrder::Order { order: -generic, log2_error };
    }
    match leading_coefficient_is_nonzero(&program, &approach, point, generic) {
        Ok(true) => PoleOrder::Order { order: -generic, log2_error },
        Ok(false) => PoleOrder::Unknown(
            "the leading coefficient cannot be distinguished from zero at this point".to_owned(),
        ),
        Err(why) => PoleOrder::Unknown(why),
    }
}

fn approach(system: &mut System, expression: NodeId, factor: NodeId) -> Option<Approach> {
    if let Node::Apply(Function::Sin, argument) = system.graph.node(factor)
        && let Some(small) = system.graph.as_symbol(argument)
        && system.is_angle(small)
    {
        return Some(Approach { expression, small, by_angle: true });
    }
    let small = system.graph.intern("'small'");
    let small_node = system.graph.symbol(small);
    let equation = system.graph.sub(factor, small_node);
    for symbol in system.graph.symbols_of([factor]) {
        if system.is_angle(symbol) {
            continue;
        }
        // a factor that vanishes on several sets may have a pole of another order on each
        if let Some(root) = palmistry_rank::observability::linear_solution(system, equation, symbol)
            && !palmistry_rank::observability::also_met_otherwise(system, factor, symbol)
        {
            let expression = system.graph.substitute(&[expression], &Assignment::from([(symbol, root)]))[0];
            return Some(Approach { expression, small, by_angle: false });
        }
    }
    None
}

/// The inputs of a program as series, from those of the coefficients.
fn series<A: Arithmetic + Clone>(
    program: &Program,
    all: &Laurent<A>,
    approach: &Approach,
    half_a_turn_on: bool,
    constants: impl Fn(usize) -> Result<A::Number, Refusal>,
) -> Result<Vec<Series<A::Number>>, Refusal> {
    let small = all.small()?;
    let one = all.rational(&RBig::ONE)?;
    let square = all.mul(&small, &small)?;
    // half a turn further on, sine and cosine change their signs
    let bottom = all.add(&one, &square)?;
    let bottom = if half_a_turn_on { all.neg(&bottom)? } else { bottom };
    let mut inputs = Vec::new();
    for (index, input) in program.inputs().iter().enumerate() {
        inputs.push(match input {
            Input::Plain(symbol) if *symbol == approach.small => small.clone(),
            Input::Sine(symbol) if *symbol == approach.small => {
                all.div(&all.add(&small, &small)?, &bottom)?
            }
            Input::Cosine(symbol) if *symbol == approach.small => {
                all.div(&all.sub(&one, &square)?, &bottom)?
            }
            _ => all.constant(constants(index)?)?,
        });
    }
    debug_assert!(approach.by_angle || !inputs.is_empty());
    Ok(inputs)
}

/// The leading exponent that random points of random fields agree upon.
fn generic_valuation(
    program: &Program,
    approach: &Approach,
    half_a_turn_on: bool,
    wanted: usize,
    rng: &mut impl Rng,
) -> Result<i32, String> {
    let (mut found, mut rounds) = (None, 0);
    let mut complaint = "no random point could be evaluated".to_owned();
    for _ in 0..ATTEMPTS {
        let field = PrimeField::random(rng);
        let residues = draw_residues(program, &field, rng);
        let all = Laurent { base: field, terms: TERMS };
        let Ok(inputs) = series(program, &all, approach, half_a_turn_on, |index| Ok(residues[index])) else {
            continue;
        };
        let Ok(loaded) = program.load(all) else { continue };
        match loaded.run(&inputs, &mut Vec::new()) {
            Ok(values) if values[0].coefficients.is_empty() => {
                complaint = "all coefficients that were kept are zero".to_owned();
            }
            Ok(values) if *found.get_or_insert(values[0].valuation) != values[0].valuation => {
                return Err("random points do not agree on the order".to_owned());
            }
            Ok(_) => rounds += 1,
            Err(failure) => complaint = failure.refusal.to_string(),
        }
        if let (Some(valuation), true) = (found, rounds >= wanted) {
            return Ok(valuation);
        }
    }
    Err(complaint)
}

/// Whether the coefficient of a given exponent differs from zero at a point. Coefficients before it are known to
/// vanish identically; their enclosures have to contain zero.
fn leading_coefficient_is_nonzero(
    program: &Program,
    approach: &Approach,
    point: &HashMap<Symbol, RBig>,
    valuation: i32,
) -> Result<bool, String> {
    let base = Enclosures::new(600);
    let all = Laurent { base, terms: TERMS };
    let number = |index: usize| -> Result<_, Refusal> {
        let SymbolInput { symbol, function } =
            program.inputs()[index].of_symbol().ok_or(Refusal::NoExactPi)?;
        function.of(&base, base.rational(point.get(&symbol).ok_or(Refusal::NotFinite)?)?)
    };
    let inputs = series(program, &all, approach, false, number)
        .map_err(|_| "at a point with fixed angles, all other symbols need values too".to_owned())?;
    let loaded = program.load(all).map_err(|refusal| refusal.to_string())?;
    let value =
        loaded.run(&inputs, &mut Vec::new()).map_err(|failure| failure.refusal.to_string())?.remove(0);
    let Ok(index) = usize::try_from(valuation - value.valuation) else {
        return Ok(false);
    };
    let before = value.coefficients.iter().take(index).all(|c| c.contains_zero());
    Ok(before && value.coefficients.get(index).is_some_and(|c| !c.contains_zero()))
}

/// Decides `pole(e, factor) = claimed`.
pub(crate) fn decide_pole(
    system: &mut System,
    expression: NodeId,
    factor: NodeId,
    point: &HashMap<Symbol, RBig>,
    claimed: i32,
    rng: &mut impl Rng,
) -> Verdict {
    match pole_order(system, expression, factor, point, rng) {
        PoleOrder::Order { order, log2_error } if order == claimed => {
            Verdict::Proved { engine: format!("Laurent series; {RANDOM_PRIMES}"), log2_error }
        }
        PoleOrder::Order { order, .. } => Verdict::Refuted {
            engine: format!("Laurent series; {RANDOM_PRIMES}"),
            witness: Witness {
                state: point
                    .iter()
                    .map(|(symbol, value)| NamedCoordinate {
                        name: system.symbol_name(*symbol).to_owned(),
                        exact: value.to_string(),
                        value: value.to_f64().value(),
                    })
                    .collect(),
                left: order.to_string(),
                right: claimed.to_string(),
                entry: None,
                refutation: None,
            },
        },
        PoleOrder::Unknown(why) => Verdict::undecided(why),
    }
}
