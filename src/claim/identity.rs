//! `left = right` for all values of the symbols, or within a tolerance at a point.

use super::value::{ValueError, enclose};
use super::verdict::{Verdict, Witness};
use super::witness::{Search, search};
use crate::expression::{NodeId, Program, Symbol, ZeroTest, expand_angles, identically_zero};
use crate::system::{Matrix, System};
use dashu::rational::RBig;
use rand::Rng;
use std::collections::HashMap;

/// The engine of exact identities, as it is named in reports.
pub(crate) const RANDOM_PRIMES: &str = "exact arithmetic at random points of random prime fields";
const IDENTICAL: &str = "the two sides are one expression";
const EXACT: &str = "exact arithmetic at a state";
const INTERVALS: &str = "interval arithmetic";

/// Decides an equation between matrices (or numbers, as matrices of one entry).
pub(crate) fn decide_identity(
    system: &mut System,
    left: &Matrix,
    right: &Matrix,
    rng: &mut impl Rng,
) -> Verdict {
    let angles = system.angles();
    let is_angle = |symbol: Symbol| angles.contains(&symbol);
    let both: Vec<NodeId> = left.entries.iter().chain(&right.entries).copied().collect();
    let both = expand_angles(&mut system.graph, &both, is_angle);
    let (left_entries, right_entries) = both.split_at(left.entries.len());
    let differences: Vec<NodeId> =
        left_entries.iter().zip(right_entries).map(|(l, r)| system.graph.sub(*l, *r)).collect();
    let mut test = identically_zero(&system.graph, &differences, is_angle, rng);
    // the difference of two sides may be zero where neither has a value: both have to have one somewhere
    if matches!(test, ZeroTest::Zero { .. })
        && let pole @ ZeroTest::Pole(_) = identically_zero(&system.graph, &both, is_angle, rng)
    {
        test = pole;
    }
    let (suspects, why) = match test {
        ZeroTest::Zero { points: 0, .. } => {
            return Verdict::Proved { engine: IDENTICAL.to_owned(), log2_error: f64::NEG_INFINITY };
        }
        ZeroTest::Zero { log2_error, .. } => {
            return Verdict::Proved { engine: RANDOM_PRIMES.to_owned(), log2_error };
        }
        ZeroTest::Pole(divisor) => {
            let text = system.graph.text(divisor);
            return Verdict::undecided(format!("every state there is a pole: {text} = 0 is divided by"));
        }
        ZeroTest::Nonzero(index) => {
            (index..index + 1, "the sides differ as expressions in their functions".to_owned())
        }
        ZeroTest::Unknown(why) => (0..differences.len(), why),
    };
    let mut agreement = None;
    for index in suspects {
        match search(system, &system.graph, left_entries[index], right_entries[index], rng) {
            Search::Found(witness) => {
                let exact = witness.left.parse::<RBig>().is_ok() || witness.left.contains('/');
                let engine = if exact { EXACT } else { INTERVALS }.to_owned();
                let entry =
                    (left.entries.len() > 1).then(|| (index / left.columns + 1, index % left.columns + 1));
                return Verdict::Refuted { engine, witness: Witness { entry, ..witness } };
            }
            Search::Agrees { digits, states } => {
                let (d, s): (usize, usize) = agreement.unwrap_or((digits, states));
                agreement = Some((d.min(digits), s.min(states)));
            }
        }
    }
    let (digits, states) = agreement.unwrap_or((0, 0));
    Verdict::undecided(format!("{why}; the sides agree to at least {digits} digits at {states} states"))
}

/// Decides `|left - right| <= tolerance` where all three are numbers: constants, and what `at {...}` makes constants.
pub(crate) fn decide_nearness(
    system: &mut System,
    left: NodeId,
    right: NodeId,
    tolerance: NodeId,
) -> Verdict {
    let difference = system.graph.sub(left, right);
    let program = Program::new(&system.graph, &[difference, tolerance, left, right], |_| false, false);
    // a value in a file is a default, and never part of a claim
    let values: HashMap<Symbol, RBig> = HashMap::new();
    let mut bits = 128;
    loop {
        let found = match enclose(&system.graph, &program, &values, bits) {
            Ok(found) => found,
            Err(error @ ValueError::Missing(_)) => {
                return Verdict::undecided(format!(
                    "{error}; 'within' compares numbers: give values with 'at {{...}}'"
                ));
            }
            Err(error) if bits >= 1 << 14 => return Verdict::undecided(error.to_string()),
            Err(ValueError::Pole(divisor)) => return Verdict::undecided(format!("a pole: {divisor} = 0")),
            Err(_) => {
                bits *= 4;
                continue;
            }
        };
        let (low, high) = (found[0].low(), found[0].high());
        let largest = if -low.clone() > high { -low.clone() } else { high.clone() };
        let smallest = if low > RBig::ZERO { low } else { -high };
        if largest <= found[1].low() {
            return Verdict::Proved { engine: INTERVALS.to_owned(), log2_error: f64::NEG_INFINITY };
        }
        if smallest > found[1].high() {
            let shown =
                |index: usize| found[index].certain_decimal(20).unwrap_or_else(|| found[index].bounds_text());
            let witness = Witness { state: Vec::new(), left: shown(2), right: shown(3), entry: None };
            return Verdict::Refuted { engine: INTERVALS.to_owned(), witness };
        }
        if bits >= 1 << 14 {
            return Verdict::undecided("the difference is within rounding of the tolerance");
        }
        bits *= 4;
    }
}
