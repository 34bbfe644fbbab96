//! An equation on the thin parts of a set that one condition describes.
//!
//! A condition `a x + b = 0`, where polynomials `a` and `b` have no common factor, is irreducible (Gauss's lemma). What vanishes wherever `x = -b/a`
//! is a multiple of it, over divisors that are not zero where the sides exist, and vanishes where `a` and `b` both do as well. Sines and cosines are
//! fractions in the tangent of half an angle, around any angle.

use palmistry_inequality::{Given, holds_by_signs};
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{Guard, Need, NodeId, Program, expand_angles};
use palmistry_rank::observability::{linear_solution, vanishes};

/// Longer slopes are not asked whether they vanish.
const LONGEST_SLOPE: usize = 20;

/// Whether differences that vanish on the parts of a set of the largest dimension vanish on all of it, for this reason. Conditions that give a
/// symbol are put in first; one may be left.
pub(super) fn follows(
    system: &mut System,
    differences: &[NodeId],
    conditions: &[NodeId],
    guards: &[Guard],
) -> bool {
    let (mut differences, mut conditions) = (differences.to_vec(), conditions.to_vec());
    while let Some((place, given)) = given_symbol(system, &conditions, guards) {
        conditions.remove(place);
        for list in [&mut differences, &mut conditions] {
            *list = system.graph.substitute(list, &given);
        }
    }
    conditions.retain(|condition| !vanishes(system, *condition));
    conditions.len() == 1 && is_rational(system, &[differences, conditions].concat())
}

/// A condition that gives a symbol for all values of the others, by its place.
fn given_symbol(system: &mut System, conditions: &[NodeId], guards: &[Guard]) -> Option<(usize, Assignment)> {
    let is_angle = system.angle_test();
    let given = Given { assumed: guards, ..Given::default() };
    for (place, condition) in conditions.iter().enumerate() {
        for symbol in system.graph.symbols_of([*condition]) {
            let slope = system.partial(*condition, symbol);
            // short ones: a slope that is a parameter, or a product of some
            if system.is_angle(symbol) || system.graph.reachable([slope]).len() > LONGEST_SLOPE {
                continue;
            }
            let goal = Guard { node: slope, need: Need::NotZero };
            if holds_by_signs(&mut system.graph, goal, given, &is_angle)
                && let Some(value) = linear_solution(system, *condition, symbol)
            {
                return Some((place, Assignment::from([(symbol, value)])));
            }
        }
    }
    None
}

/// Whether no function is met but sines and cosines of angles.
fn is_rational(system: &mut System, nodes: &[NodeId]) -> bool {
    let is_angle = system.angle_test();
    let expanded = expand_angles(&mut system.graph, nodes, &is_angle);
    let program = Program::with_unknown_functions(&system.graph, &expanded, &is_angle);
    program.unknown_function(&system.graph).is_none() && program.bare_angle().is_none()
}
