//! What is asked of an expression while conditions are solved: whether it is zero, identically, as numbers or as a constant,
//! and whether it is determined by its derivatives.

use palmistry_lang::System;
use palmistry_math::expression::{
    Guard, Node, NodeId, Program, Related, Symbol, ZeroTest, expand_angles, identically_zero,
    zero_by_relations,
};
use palmistry_math::number::{Enclosure, Enclosures};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The precision at which a constant is distinguished from zero.
const CONSTANT_BITS: usize = 512;

/// Whether an expression is identically zero, by exact arithmetic at random points.
pub fn vanishes(system: &mut System, expression: NodeId) -> bool {
    all_vanish(system, &[expression])
}

/// Whether all of some expressions are.
pub(crate) fn all_vanish(system: &mut System, expressions: &[NodeId]) -> bool {
    vanish_where(system, expressions, &[])
}

/// Whether all of some expressions are zero wherever they exist and the guards hold.
pub(super) fn vanish_where(system: &mut System, expressions: &[NodeId], guards: &[Guard]) -> bool {
    matches!(test_where(system, expressions, guards), ZeroTest::Zero { .. })
}

pub(super) fn test(system: &mut System, expressions: &[NodeId]) -> ZeroTest {
    test_where(system, expressions, &[])
}

/// The test for zero: functions as unknowns, and if these do not cancel, by what the functions satisfy.
fn test_where(system: &mut System, expressions: &[NodeId], guards: &[Guard]) -> ZeroTest {
    let is_angle = &system.angle_test();
    let expanded = expand_angles(&mut system.graph, expressions, is_angle);
    let mut rng = ChaCha8Rng::seed_from_u64(0x7a65_726f); // any fixed seed: the same file gives the same answer
    let found = identically_zero(&system.graph, &expanded, is_angle, &mut rng);
    if matches!(found, ZeroTest::Zero { .. } | ZeroTest::Pole(_)) {
        return found;
    }
    match zero_by_relations(&mut system.graph, &expanded, guards, is_angle, &mut rng) {
        Related::Zero { log2_error, points, degree, .. } => ZeroTest::Zero { log2_error, points, degree },
        Related::NotShown(_) | Related::NoFunctions => found,
    }
}

/// The value of an expression that mentions no symbol.
pub(super) fn enclosed_constant(system: &System, expression: NodeId) -> Option<Enclosure> {
    if !system.graph.symbols_of([expression]).is_empty() {
        return None;
    }
    let program = Program::plain(&system.graph, &[expression]);
    let loaded = program.load(Enclosures::new(CONSTANT_BITS)).ok()?;
    loaded.run(&[], &mut Vec::new()).ok()?.pop()
}

/// Whether an expression mentions no symbol and is certainly not zero.
pub(super) fn is_a_constant_but_zero(system: &System, expression: NodeId) -> bool {
    enclosed_constant(system, expression).is_some_and(|value| !value.contains_zero())
}

/// Whether a combination of angles, taken as numbers, is zero whatever they are.
pub(super) fn vanishes_as_numbers(system: &System, expression: NodeId) -> bool {
    let mut rng = ChaCha8Rng::seed_from_u64(0x6e75_6d62);
    let test = identically_zero(&system.graph, &[expression], |_| false, &mut rng);
    matches!(test, ZeroTest::Zero { .. })
}

/// Whether a symbol stands inside no function's argument, so that derivatives by it determine the dependence.
pub(super) fn inside_no_function(system: &System, expression: NodeId, symbol: Symbol) -> bool {
    let arguments: Vec<NodeId> = system
        .graph
        .reachable([expression])
        .into_iter()
        .filter_map(|id| match system.graph.node(id) {
            Node::Apply(_, argument) => Some(argument),
            _ => None,
        })
        .collect();
    !system.graph.symbols_of(arguments).contains(&symbol)
}
