//! Where the rows exist: what the terms of the file divide by is not zero, and what they take roots, logarithms and
//! inverse sines of lies where these have a value.
//!
//! The graph has simplified its expressions, and what was cancelled is no longer in it; so all conditions that a box is
//! tested for come from the guards that were noted when the file was read. Lie derivatives divide by powers of the same
//! things and by no others: they exist, and are smooth, where outputs and fields are.

use super::collector::Collector;
use super::minors::{factors_of, half_cosines};
use super::rows::RegionRows;
use palmistry_lang::{Assignment, System, Value};
use palmistry_math::expression::{Graph, Guard, Need, Node, NodeId, add_guard, expand_angles};
use palmistry_math::number::Fraction;
use palmistry_math::number::polynomial::{Polynomial, Ring};
use palmistry_rank::observability::OWN_ROWS;

/// Where the rows exist.
pub(super) struct Domain {
    /// What has to hold, as it was written.
    pub written: Vec<Guard>,
    /// The factors that have to meet their needs, by their places.
    pub guards: Vec<usize>,
    /// What would have to hold and holds nowhere, in the notation of the proof language: with any of it nothing exists.
    pub nowhere: Vec<String>,
}

/// What has to hold for a choice of rows to exist, and for the system that they are rows of.
pub(super) fn domain(
    system: &mut System,
    rows: RegionRows,
    collector: &mut Collector,
    values: &Assignment,
) -> Domain {
    let written = guards_of(system, rows);
    let guards = system.substitute_guards(&written, values);
    let is_angle = &system.angle_test();
    let mut found = Domain { guards: Vec::new(), nowhere: Vec::new(), written };
    for Guard { node, need } in guards {
        let graph = &mut system.graph;
        let node = expand_angles(graph, &[node], is_angle)[0];
        let guard = Guard { node, need };
        match guard.constant(graph) {
            Some(true) => continue,
            Some(false) => {
                found.nowhere.push(guard.text(graph));
                continue;
            }
            None => {}
        }
        match need {
            Need::Positive | Need::NotNegative => found.guards.push(collector.needed(node, need)),
            Need::WithinOne | Need::InsideOne => {
                let (one, square) = (graph.integer(1), graph.power(node, 2));
                let rest = graph.sub(one, square);
                let sign = if need == Need::WithinOne { Need::NotNegative } else { Need::Positive };
                found.guards.push(collector.needed(rest, sign));
            }
            Need::NotZero => match collector.products.read(graph, &[node], is_angle) {
                Ok((value, _)) => match divisor_factors(graph, collector, &value[0]) {
                    Some(factors) => found.guards.extend(factors),
                    None => found.nowhere.push(guard.text(graph)),
                },
                // no product of polynomials: looked at as it is written
                Err(_) => found.guards.push(collector.expression(node)),
            },
        }
    }
    found.guards.sort_unstable();
    found.guards.dedup();
    found
}

/// The guards of outputs and fields, and those of the file's own rows where these are asked for.
fn guards_of(system: &System, rows: RegionRows) -> Vec<Guard> {
    let mut found = system.smooth_guards(&system.moving_fields());
    if rows == RegionRows::Own {
        let mut own = system.definition_guards(OWN_ROWS);
        if let Some(Value::Matrix(matrix)) = system.definition(OWN_ROWS) {
            own.extend(needs_of_nodes(&system.graph, &matrix.entries));
        }
        own.into_iter().for_each(|guard| add_guard(&system.graph, &mut found, guard));
    }
    found
}

/// What the operations of some expressions need as they stand. Rows that were differentiated divide by more than was
/// written: `d(sqrt(x))` by the root.
fn needs_of_nodes(graph: &Graph, roots: &[NodeId]) -> Vec<Guard> {
    let need = |id| match graph.node(id) {
        Node::Div(_, divisor) => Some(Guard { node: divisor, need: Need::NotZero }),
        Node::Power(base, n) if n < 0 => Some(Guard { node: base, need: Need::NotZero }),
        Node::Apply(function, argument) => Need::of(function).map(|need| Guard { node: argument, need }),
        _ => None,
    };
    graph.reachable(roots.iter().copied()).into_iter().filter_map(need).collect()
}

/// What must not be zero for a divisor not to be; `None` where it is zero everywhere.
fn divisor_factors(graph: &mut Graph, collector: &mut Collector, divisor: &Fraction) -> Option<Vec<usize>> {
    let (circles, mut found) = (collector.products.circles(), Vec::new());
    let all: Vec<(Polynomial, i64)> = [(&divisor.top, 1), (&divisor.bottom, -1)]
        .into_iter()
        .flat_map(|(factors, sign)| {
            factors.iter().map(move |(place, power)| (*place, sign * i64::from(*power)))
        })
        .map(|(place, power)| (collector.products.fractions().factor(place), power))
        .collect();
    if all.iter().any(|(polynomial, power)| *power > 0 && polynomial.is_zero()) {
        return None;
    }
    for (polynomial, _) in all.iter().filter(|(_, power)| *power > 0) {
        for (factor, _) in factors_of(polynomial, &mut collector.known) {
            if !circles.contains(&factor) {
                found.push(collector.polynomial(graph, &factor));
            }
        }
    }
    for (place, power) in half_cosines(&collector.products, all.iter().map(|(f, n)| (f, *n))) {
        if power > 0
            && let Some(node) = collector.products.half_cosine(graph, place)
        {
            found.push(collector.expression(node));
        }
    }
    Some(found)
}
