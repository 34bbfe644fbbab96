//! A state of a case in exact numbers.

use super::algebra::Algebra;
use super::case::Case;
use super::explore::Search;
use crate::expression::{NodeId, Program, Symbol, expand_angles};
use crate::number::{Arithmetic, Rationals};
use crate::observability::{Coordinate, State};
use dashu::rational::RBig;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// So many states are tried.
const ATTEMPTS: u64 = 80;
/// The length to which exact values may grow.
const BITS: usize = 1 << 14;

/// A state at which all equations of a case hold, exactly, the rows exist, and not all expressions of any of some lists are
/// zero. `None` where none was found: that says nothing.
pub(super) fn state_on(
    algebra: &mut Algebra<'_>,
    search: &Search<'_>,
    case: &Case,
    off: &[Vec<NodeId>],
) -> Option<State> {
    if !case.relations.is_empty() {
        return None;
    }
    let mut all: Vec<NodeId> = search.rows.rows.iter().flatten().copied().collect();
    all.extend(search.guards.iter().map(|guard| guard.node));
    all.extend(off.iter().flatten());
    let everything = algebra.in_chart(&case.chart, &all);
    let mut symbols = algebra.system.graph.symbols_of(everything);
    symbols.extend(algebra.system.graph.symbols_of(case.values.values().copied()));
    symbols.extend(case.values.keys());
    symbols.sort_unstable();
    symbols.dedup();
    let mut solved: Vec<(Symbol, NodeId)> = case.values.iter().map(|(s, v)| (*s, *v)).collect();
    solved.sort_unstable();
    let mut rng = ChaCha8Rng::seed_from_u64(0x7374_6174_65); // any fixed seed
    for attempt in 0..ATTEMPTS {
        let mut values: BTreeMap<Symbol, RBig> = BTreeMap::new();
        for symbol in symbols.iter().filter(|symbol| !case.values.contains_key(symbol)) {
            values.insert(*symbol, drawn(algebra, *symbol, attempt, &mut rng));
        }
        let nodes: Vec<NodeId> = solved.iter().map(|(_, node)| *node).collect();
        let Some(found) = at(algebra, &nodes, &values) else { continue };
        values.extend(solved.iter().map(|(symbol, _)| *symbol).zip(found));
        let Some(state) = in_the_file(algebra, case, values) else { continue };
        if is_inside(algebra, search, &state, off) == Some(true) {
            return Some(state);
        }
    }
    None
}

/// A simple number, within the range that the file gives where it gives one.
fn drawn(algebra: &Algebra<'_>, symbol: Symbol, attempt: u64, rng: &mut ChaCha8Rng) -> RBig {
    let simple = RBig::from(rng.random_range(1..=12i64)) / RBig::from(rng.random_range(1..=4i64));
    let sign = if attempt % 2 == 1 && rng.random_range(0..3u8) == 0 { -RBig::ONE } else { RBig::ONE };
    match algebra.system.symbol_info(symbol) {
        Some(info) if attempt < ATTEMPTS / 2 => match (&info.range, &info.default) {
            (Some(range), _) => {
                let part = RBig::from(rng.random_range(1..=15i64)) / RBig::from(16);
                &range.low + (&range.high - &range.low) * part
            }
            (None, Some(value)) if attempt < ATTEMPTS / 4 => value.clone(),
            _ => simple * sign,
        },
        _ => simple * sign,
    }
}

/// Expressions of plain symbols at rational values.
fn at(algebra: &Algebra<'_>, nodes: &[NodeId], values: &BTreeMap<Symbol, RBig>) -> Option<Vec<RBig>> {
    let program = Program::plain(&algebra.system.graph, nodes);
    let exact = Rationals { bits: BITS };
    let mut inputs = Vec::new();
    for input in program.inputs() {
        inputs.push(exact.rational(values.get(&input.symbol()?)?).ok()?);
    }
    program.load(exact).ok()?.run(&inputs, &mut Vec::new()).ok()
}

/// The values of a chart's symbols as a state of the file.
fn in_the_file(algebra: &mut Algebra<'_>, case: &Case, values: BTreeMap<Symbol, RBig>) -> Option<State> {
    let changed = algebra.coordinates.changed.clone();
    let olds: Vec<NodeId> = changed.iter().map(|(old, ..)| algebra.coordinates.values[old]).collect();
    let olds = algebra.in_chart(&case.chart, &olds);
    let found = at(algebra, &olds, &values)?;
    let mut state = State::default();
    for (symbol, value) in values {
        let angle = algebra.tangents.iter().find(|(_, tangent)| **tangent == symbol).map(|(angle, _)| *angle);
        if let Some(angle) = angle {
            state.values.insert(angle, Coordinate::from_half_tangent(&value));
        } else if !changed.iter().any(|(_, new, _)| *new == symbol) {
            state.values.insert(symbol, Coordinate::Number(value));
        }
    }
    for ((old, ..), value) in changed.iter().zip(found) {
        state.values.insert(*old, Coordinate::Number(value));
    }
    for angle in &case.chart {
        state.values.insert(*angle, Coordinate::Angle { sine: RBig::ZERO, cosine: -RBig::ONE });
    }
    // what no row mentions may be anything
    for symbol in algebra.system.states.clone() {
        let anything = match algebra.tangents.contains_key(&symbol) || algebra.system.is_angle(symbol) {
            true => Coordinate::from_half_tangent(&(RBig::ONE / RBig::from(2))),
            false => Coordinate::Number(RBig::ONE),
        };
        state.values.entry(symbol).or_insert(anything);
    }
    Some(state)
}

/// Whether all guards hold at a state, and not all expressions of a list vanish.
fn is_inside(
    algebra: &mut Algebra<'_>,
    search: &Search<'_>,
    state: &State,
    off: &[Vec<NodeId>],
) -> Option<bool> {
    let nodes: Vec<NodeId> = search.guards.iter().map(|guard| guard.node).collect();
    let values = exact_values(algebra, &nodes, state)?;
    let holds = search.guards.iter().zip(&values).all(|(guard, value)| guard.need.is_met_by(value));
    if !holds {
        return Some(false);
    }
    for list in off {
        if exact_values(algebra, list, state)?.iter().all(RBig::is_zero) {
            return Some(false);
        }
    }
    Some(true)
}

/// Expressions of the file at a state.
pub(super) fn exact_values(algebra: &mut Algebra<'_>, nodes: &[NodeId], state: &State) -> Option<Vec<RBig>> {
    let tangents = &algebra.tangents;
    let is_angle = |symbol: Symbol| tangents.contains_key(&symbol);
    let expanded = expand_angles(&mut algebra.system.graph, nodes, is_angle);
    let program = Program::new(&algebra.system.graph, &expanded, is_angle);
    let exact = Rationals { bits: BITS };
    let inputs = state.inputs(&program, &exact).ok()?;
    program.load(exact).ok()?.run(&inputs, &mut Vec::new()).ok()
}
