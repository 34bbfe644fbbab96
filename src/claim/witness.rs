//! States at which two sides differ, in numbers that a pocket calculator takes.

use super::verdict::Witness;
use crate::expression::{Graph, Input, NodeId, Program, Symbol};
use crate::number::{Enclosure, Enclosures, Rationals, round_to_decimal};
use crate::observability::{Coordinate, State};
use crate::system::System;
use dashu::base::BitTest;
use dashu::rational::RBig;
use rand::{Rng, RngExt};

/// The first so many states have the file's values and positive numbers; later ones any.
const SIMPLE: usize = 10;
/// How many states are tried.
const ATTEMPTS: usize = 300;
/// After so many states at which the sides agree the search ends.
const STATES: usize = 30;
/// Agreement is counted up to so many digits.
const MOST_DIGITS: usize = 100;
/// The precision of enclosures where there is no exact arithmetic.
const BITS: usize = 400;
/// The digits to which irrational or long values are written.
const DIGITS: usize = 20;

/// What a search for a witness came to.
pub(crate) enum Search {
    Found(Witness),
    /// The sides agree to so many digits at so many states.
    Agrees {
        digits: usize,
        states: usize,
    },
}

/// Looks for a state at which `left` and `right` certainly differ.
pub(crate) fn search(
    system: &System,
    graph: &Graph,
    left: NodeId,
    right: NodeId,
    rng: &mut impl Rng,
) -> Search {
    let angles = |symbol: Symbol| system.is_angle(symbol);
    let exact_program = Program::new(graph, &[left, right], angles, false);
    // an angle outside sines and cosines has no exact value: then angles are numbers like all others
    let plain = exact_program.bare_angle().is_some();
    let program = if plain { Program::new(graph, &[left, right], |_| false, false) } else { exact_program };
    let (mut least, mut states) = (MOST_DIGITS, 0);
    for attempt in 0..ATTEMPTS {
        let state = draw(system, &program, !plain, attempt, rng);
        match compare(&program, &state) {
            Some(Comparison::Differ(left, right)) => {
                return Search::Found(Witness { state: state.describe(system), left, right, entry: None });
            }
            Some(Comparison::Agree(digits)) => (least, states) = (least.min(digits), states + 1),
            None => {}
        }
        if states == STATES {
            break;
        }
    }
    Search::Agrees { digits: if states == 0 { 0 } else { least }, states }
}

/// Two sides at one state.
enum Comparison {
    Differ(String, String),
    /// To so many digits, at most [`MOST_DIGITS`].
    Agree(usize),
}

/// Compares the two expressions of a program, exactly where that is possible, else by enclosures. `None` where one of
/// them is not defined.
fn compare(program: &Program, state: &State) -> Option<Comparison> {
    if let Some((left, right)) = exact_values(program, state) {
        let shown = |value: &RBig| {
            let short = value.numerator().bit_len() + value.denominator().bit_len() < 100;
            if short { value.to_string() } else { round_to_decimal(value, DIGITS) }
        };
        return Some(if left == right {
            Comparison::Agree(MOST_DIGITS)
        } else {
            Comparison::Differ(shown(&left), shown(&right))
        });
    }
    let (left, right) = enclosed_values(program, state)?;
    if Enclosures::common(&left, &right).is_none() {
        let shown = |value: &Enclosure| value.certain_decimal(DIGITS).unwrap_or_else(|| value.bounds_text());
        return Some(Comparison::Differ(shown(&left), shown(&right)));
    }
    let same = |n: &usize| left.decimal(*n).is_some_and(|text| right.decimal(*n) == Some(text));
    Some(Comparison::Agree((1..=MOST_DIGITS).rev().find(same).unwrap_or(0)))
}

fn exact_values(program: &Program, state: &State) -> Option<(RBig, RBig)> {
    let exact = Rationals { bits: 1 << 16 };
    let inputs = state.inputs(program, &exact).ok()?;
    let values = program.load(exact).ok()?.run(&inputs, &mut Vec::new()).ok()?;
    Some((values[0].clone(), values[1].clone()))
}

fn enclosed_values(program: &Program, state: &State) -> Option<(Enclosure, Enclosure)> {
    let arithmetic = Enclosures::new(BITS);
    let inputs = state.inputs(program, &arithmetic).ok()?;
    let values = program.load(arithmetic).ok()?.run(&inputs, &mut Vec::new()).ok()?;
    Some((values[0].clone(), values[1].clone()))
}

/// A state of simple numbers, inside the sample box where the file has one.
fn draw(system: &System, program: &Program, exact_angles: bool, attempt: usize, rng: &mut impl Rng) -> State {
    let mut state = State::default();
    for input in program.inputs() {
        let symbol = match input {
            Input::Plain(symbol) | Input::Sine(symbol) | Input::Cosine(symbol) => *symbol,
            Input::Opaque(_) => continue,
        };
        if state.values.contains_key(&symbol) {
            continue;
        }
        let angle = exact_angles && system.is_angle(symbol);
        let value = if angle {
            Coordinate::from_half_tangent(&half_tangent(system, symbol, attempt, rng))
        } else {
            Coordinate::Number(number(system, symbol, attempt, rng))
        };
        state.values.insert(symbol, value);
    }
    state
}

/// The value that the file gives to a parameter, or a simple number from its range; after some failures any number.
fn number(system: &System, symbol: Symbol, attempt: usize, rng: &mut impl Rng) -> RBig {
    let info = system.symbol_info(symbol);
    let default = info.and_then(|info| info.default.clone());
    match (info.and_then(|info| info.range.as_ref()), default) {
        (Some(range), _) => simple_between(&range.low, &range.high, attempt, rng),
        (None, Some(default)) if attempt < SIMPLE => default,
        _ if attempt < SIMPLE => simple_between(&RBig::ONE, &RBig::from(3), attempt, rng),
        _ => simple_between(&RBig::from(-3), &RBig::from(3), attempt, rng),
    }
}

/// The tangent of half an angle: a simple number within the angle's range, and neither zero nor one, at which a sine
/// or a cosine vanishes and a calculator has nothing to check.
fn half_tangent(system: &System, symbol: Symbol, attempt: usize, rng: &mut impl Rng) -> RBig {
    let range = system.symbol_info(symbol).and_then(|info| info.range.as_ref());
    let tangent = |bound: &RBig| RBig::try_from((bound.to_f64().value() / 2.0).tan()).ok();
    let bounds =
        range.and_then(|range| Some((tangent(&range.low)?, tangent(&range.high)?))).filter(|(a, b)| a < b);
    let (low, high) = bounds.unwrap_or((RBig::from(-2), RBig::from(2)));
    for _ in 0..50 {
        // halves, thirds and quarters from the start: the sines are then fractions such as 4/5 and 12/13
        let value = simple_between(&low, &high, attempt.max(40), rng);
        if !value.is_zero() && value != RBig::ONE && value != RBig::from(-1) {
            return value;
        }
    }
    RBig::simplest_in(low, high)
}

/// A rational of small numerator and denominator within a range, not zero if that can be avoided; later attempts draw
/// from finer grids.
fn simple_between(low: &RBig, high: &RBig, attempt: usize, rng: &mut impl Rng) -> RBig {
    let denominator = 1 + (attempt / 20) as i64;
    for _ in 0..20 {
        let bottom = RBig::from(rng.random_range(1..=denominator.min(12)));
        let (first, last) = ((low * &bottom).ceil(), (high * &bottom).floor());
        let (Ok(first), Ok(last)) = (i64::try_from(first), i64::try_from(last)) else { break };
        if first > last {
            continue;
        }
        let top = rng.random_range(first..=last.min(first.saturating_add(1000)));
        if top != 0 {
            return RBig::from(top) / bottom;
        }
    }
    if low == high { low.clone() } else { RBig::simplest_in(low.clone(), high.clone()) }
}
