//! `left = right` wherever both sides exist, or within a tolerance at a point.

use super::evidence::refutation;
use super::existence::{Existence, existence};
use super::terms::OnBranch;
use super::value::{ValueError, enclose};
use super::verdict::{Verdict, Witness};
use super::witness::{Search, search, until_they_differ};
use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::expression::{
    Guard, NodeId, Program, Related, Symbol, ZeroTest, expand_angles, identically_zero, zero_by_relations,
};
use rand::Rng;
use std::collections::HashMap;

/// The engine of exact identities, as it is named in reports.
pub(crate) const RANDOM_PRIMES: &str = "exact arithmetic at random points of random prime fields";
/// Of a statement that says one thing twice.
const IDENTICAL: &str = "the two sides are one expression";
/// Of one whose sides come to one expression when they are differentiated, multiplied out or taken at a point.
const CALCULATED: &str = "calculation with expressions: both sides come to the same one";
const EXACT: &str = "exact arithmetic at a state";
const INTERVALS: &str = "interval arithmetic";

/// What a statement comes to on one branch of its conditions.
pub(crate) enum OnOneBranch {
    /// A verdict, and whether the statement's terms were shown to exist somewhere on the branch.
    Verdict(Verdict, Existence),
    /// Nothing is claimed there: the terms exist nowhere on the branch, since this is needed.
    Empty(String),
}

/// Decides an equation between matrices (or numbers, as matrices of one entry) of so many columns.
pub(crate) fn decide_identity(
    system: &mut System,
    on: &OnBranch,
    columns: usize,
    rng: &mut impl Rng,
) -> OnOneBranch {
    let is_angle = &system.angle_test();
    let both: Vec<NodeId> = expand_angles(&mut system.graph, &on.terms.sides, is_angle);
    let (left, right) = both.split_at(both.len() / 2);
    let differences: Vec<NodeId> = left.iter().zip(right).map(|(l, r)| system.graph.sub(*l, *r)).collect();
    let test = identically_zero(&system.graph, &differences, is_angle, rng);
    let proved = |engine: &str, log2_error| Verdict::Proved { engine: engine.to_owned(), log2_error };
    let (suspects, why) = match test {
        ZeroTest::Zero { points, log2_error, .. } => {
            let verdict = match points {
                0 if on.statement.one_thing_twice => proved(IDENTICAL, f64::NEG_INFINITY),
                0 => proved(CALCULATED, f64::NEG_INFINITY),
                _ => proved(RANDOM_PRIMES, log2_error),
            };
            return match existence(system, on, rng) {
                Existence::Nowhere(guard) => OnOneBranch::Empty(guard),
                found => OnOneBranch::Verdict(verdict, found),
            };
        }
        ZeroTest::Pole(divisor) => return OnOneBranch::Empty(format!("{} != 0", system.graph.text(divisor))),
        ZeroTest::Nonzero(index) => {
            (index..index + 1, "the sides differ as expressions in their functions".to_owned())
        }
        ZeroTest::Unknown(why) => (0..differences.len(), why),
    };
    let why = match zero_by_relations(&mut system.graph, &differences, &on.terms.guards, is_angle, rng) {
        Related::Zero { log2_error, used, .. } => {
            let engine = format!("{RANDOM_PRIMES}, with what is known of {used}");
            return match existence(system, on, rng) {
                Existence::Nowhere(guard) => OnOneBranch::Empty(guard),
                found => OnOneBranch::Verdict(proved(&engine, log2_error), found),
            };
        }
        Related::NotShown(why) => why,
        Related::NoFunctions => why,
    };
    match search(system, on, suspects, rng) {
        Search::Found { witness, point, entry, exact } => {
            let refutation = match refutation(system, on, &point, entry, &witness) {
                Ok(refutation) => Some(refutation),
                Err(doubt) => {
                    let why = format!(
                        "{why}; a state was found at which they differ, which the checker does not confirm"
                    );
                    return OnOneBranch::Verdict(
                        Verdict::undecided(format!("{why}: {doubt}")),
                        Existence::Shown,
                    );
                }
            };
            let entry = (differences.len() > 1).then_some((entry / columns + 1, entry % columns + 1));
            let engine = if exact { EXACT } else { INTERVALS }.to_owned();
            let verdict = Verdict::Refuted { engine, witness: Witness { entry, refutation, ..witness } };
            OnOneBranch::Verdict(verdict, Existence::Shown)
        }
        Search::Agrees { digits, states } => match existence(system, on, rng) {
            Existence::Nowhere(guard) => OnOneBranch::Empty(guard),
            found => {
                let why = match states {
                    0 => format!("{why}; no state was found at which both sides are defined"),
                    _ => format!("{why}; the sides agree to at least {digits} digits at {states} states"),
                };
                OnOneBranch::Verdict(Verdict::undecided(why), found)
            }
        },
    }
}

/// Whether a difference of numbers, or its negative, is a tolerance that is not negative, exactly: the sides are as far from each
/// other as they may be.
fn is_the_tolerance(
    system: &mut System,
    difference: NodeId,
    tolerance: NodeId,
    guards: &[Guard],
    rng: &mut impl Rng,
) -> Option<Verdict> {
    let zero = system.graph.integer(0);
    let back = system.graph.neg(difference);
    let no_tolerance = is_zero_number(system, tolerance, guards, rng);
    for (one, other) in [(difference, tolerance), (back, tolerance), (difference, zero)] {
        let rest = system.graph.sub(one, other);
        if let Some(proved) = is_zero_number(system, rest, guards, rng) {
            match &no_tolerance {
                Some(nothing) => return Some(Verdict::all([proved, nothing.clone()])),
                None if is_positive_number(system, tolerance) => return Some(proved),
                None => {}
            }
        }
    }
    None
}

fn is_positive_number(system: &System, number: NodeId) -> bool {
    let program = Program::plain(&system.graph, &[number]);
    let found = enclose(&system.graph, &program, &HashMap::new(), 512);
    found.is_ok_and(|found| found[0].low() > RBig::ZERO)
}

fn is_zero_number(
    system: &mut System,
    number: NodeId,
    guards: &[Guard],
    rng: &mut impl Rng,
) -> Option<Verdict> {
    if let Some(value) = system.graph.constant_value(number) {
        let engine = "exact arithmetic".to_owned();
        return value.is_zero().then_some(Verdict::Proved { engine, log2_error: f64::NEG_INFINITY });
    }
    match identically_zero(&system.graph, &[number], |_| false, rng) {
        ZeroTest::Zero { log2_error, .. } => {
            return Some(Verdict::Proved { engine: RANDOM_PRIMES.to_owned(), log2_error });
        }
        ZeroTest::Pole(_) => return None,
        ZeroTest::Nonzero(_) | ZeroTest::Unknown(_) => {}
    }
    match zero_by_relations(&mut system.graph, &[number], guards, |_| false, rng) {
        Related::Zero { log2_error, used, .. } => Some(Verdict::Proved {
            engine: format!("{RANDOM_PRIMES}, with what is known of {used}"),
            log2_error,
        }),
        Related::NotShown(_) | Related::NoFunctions => None,
    }
}

/// Decides `|left - right| <= tolerance` where all three are numbers: constants, and what `at {...}` makes constants.
pub(crate) fn decide_nearness(
    system: &mut System,
    left: NodeId,
    right: NodeId,
    tolerance: NodeId,
    guards: &[Guard],
    rng: &mut impl Rng,
) -> Verdict {
    let difference = system.graph.sub(left, right);
    let mut wanted = vec![difference, tolerance, left, right];
    let terms = wanted.len();
    wanted.extend(guards.iter().map(|guard| guard.node));
    let program = Program::plain(&system.graph, &wanted);
    // a value in a file is a default, and never part of a claim
    let values: HashMap<Symbol, RBig> = HashMap::new();
    let (mut bits, mut compared) = (128, false);
    loop {
        let found = match enclose(&system.graph, &program, &values, bits) {
            Ok(found) => found,
            Err(error @ ValueError::Missing(_)) => {
                return Verdict::undecided(format!(
                    "{error}; 'within' compares numbers: give values with 'at {{...}}'"
                ));
            }
            Err(error) if bits >= 1 << 14 => return Verdict::undecided(error.to_string()),
            Err(ValueError::Pole(divisor)) => {
                return Verdict::undecided(format!("undefined: a division by {divisor} = 0"));
            }
            Err(_) => {
                bits *= 4;
                continue;
            }
        };
        let mut exists = true;
        for (guard, value) in guards.iter().zip(&found[terms..]) {
            match guard.need.is_met_by_enclosure(value) {
                Some(true) => {}
                Some(false) => {
                    let text = guard.text(&system.graph);
                    return Verdict::undecided(format!("it has no value there: {text} does not hold"));
                }
                None => exists = false,
            }
        }
        let (low, high) = (found[0].low(), found[0].high());
        let largest = if -low.clone() > high { -low.clone() } else { high.clone() };
        let smallest = if low > RBig::ZERO { low } else { -high };
        if exists && largest <= found[1].low() {
            return Verdict::Proved { engine: INTERVALS.to_owned(), log2_error: f64::NEG_INFINITY };
        }
        if exists && smallest > found[1].high() {
            let shown = |index: usize, digits: usize| {
                found[index].certain_decimal(digits).unwrap_or_else(|| found[index].bounds_text())
            };
            let [left, right] = until_they_differ(|digits| [2, 3].map(|index| shown(index, digits)));
            let state = Vec::new();
            let witness = Witness { state, left, right, entry: None, refutation: None };
            return Verdict::Refuted { engine: INTERVALS.to_owned(), witness };
        }
        if exists
            && !std::mem::replace(&mut compared, true)
            && let Some(proved) = is_the_tolerance(system, difference, tolerance, guards, rng)
        {
            return proved;
        }
        if bits >= 1 << 14 {
            return Verdict::undecided("the difference is within rounding of the tolerance");
        }
        bits *= 4;
    }
}
