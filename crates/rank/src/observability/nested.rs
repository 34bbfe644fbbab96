//! Lie derivatives by num-dual: the second, independent route.
//!
//! `L_X h (q)` is the derivative of `h(q + e X(q))` by `e` at zero, so a Lie derivative along `k` fields is a dual
//! number nested `k` deep, and its differential one more level, a vector dual. Only the *values* of the fields and of
//! the output are taken from the expression graph; every rule of differentiation is num-dual's. The cost doubles with
//! each level.

use nalgebra::{DVector, Dyn};
use num_dual::{DualNum, DualVec, gradient};
use palmistry_lang::System;
use palmistry_math::expression::{Failure, Input, NodeId, Program, Symbol};
use palmistry_math::number::{Differentiable, Duals, RealNumber, Refusal, Tower};
use std::collections::HashMap;

/// Why a derivative could not be computed.
#[derive(Clone, Debug, PartialEq)]
pub enum NestedError {
    /// An operation of the field or of the function was refused.
    Failure(Failure),
    /// A constant has no image in the number type.
    Refusal(Refusal),
}

/// The value of `L_{X1} L_{X2} ... h` at a point given by all its symbols, over any number that num-dual
/// differentiates over. `word` holds the fields' places in the system, outermost first.
///
/// # Errors
/// Where the point is a pole.
pub fn lie_derivative_by_duals<T: Differentiable>(
    system: &System,
    word: &[usize],
    h: NodeId,
    point: &HashMap<Symbol, T>,
) -> Result<T, NestedError> {
    let point = point.iter().map(|(symbol, value)| (*symbol, Tower::Leaf(value.clone()))).collect();
    climb(system, word, h, &point, 0).map(Tower::leaf)
}

fn climb<T: Differentiable>(
    system: &System,
    word: &[usize],
    h: NodeId,
    point: &HashMap<Symbol, Tower<T>>,
    depth: usize,
) -> Result<Tower<T>, NestedError> {
    let Some((first, rest)) = word.split_first() else {
        return Ok(values(system, &[h], point)?.remove(0));
    };
    let components = &system.fields[*first].components;
    let nodes: Vec<NodeId> = components.iter().map(|(_, node)| *node).collect();
    let mut moved = point.clone();
    for ((symbol, _), rate) in components.iter().zip(values(system, &nodes, point)?) {
        if let Some(value) = moved.get_mut(symbol) {
            *value = Tower::nest(value.clone(), rate);
        }
    }
    Ok(climb(system, rest, h, &moved, depth + 1)?.slope(depth + 1))
}

fn values<T: Differentiable>(
    system: &System,
    nodes: &[NodeId],
    point: &HashMap<Symbol, Tower<T>>,
) -> Result<Vec<Tower<T>>, NestedError> {
    let program = Program::plain(&system.graph, nodes);
    let loaded = program.load(Duals::<Tower<T>>::default()).map_err(NestedError::Refusal)?;
    let missing = Tower::Leaf(T::zero());
    let input = |input: &Input| match input {
        Input::Plain(symbol) => point.get(symbol).unwrap_or(&missing).clone(),
        _ => missing.clone(),
    };
    let inputs: Vec<Tower<T>> = program.inputs().iter().map(input).collect();
    loaded.run(&inputs, &mut Vec::new()).map_err(NestedError::Failure)
}

/// The differential of `L_{X1} L_{X2} ... h` by the unknown states, in their order, over any plain number: `f32`, `f64`,
/// double-doubles, or intervals, which then enclose it.
///
/// # Errors
/// Where the point is a pole, or may be one.
pub fn differential_by_duals<T: RealNumber + DualNum>(
    system: &System,
    word: &[usize],
    h: NodeId,
    point: &HashMap<Symbol, T>,
) -> Result<Vec<T>, NestedError> {
    let unknowns = system.unknowns();
    let states = DVector::from_iterator(
        unknowns.len(),
        unknowns.iter().map(|symbol| point.get(symbol).copied().unwrap_or_else(T::zero)),
    );
    let function = |x: DVector<DualVec<T, Dyn>>| {
        let mut full: HashMap<Symbol, DualVec<T, Dyn>> =
            point.iter().map(|(symbol, value)| (*symbol, DualVec::from_re(*value))).collect();
        for (symbol, value) in unknowns.iter().zip(x.iter()) {
            full.insert(*symbol, value.clone());
        }
        lie_derivative_by_duals(system, word, h, &full)
    };
    let (_, slope) = gradient(function, &states)?;
    Ok(slope.iter().copied().collect())
}
