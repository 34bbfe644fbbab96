//! How the expression graph of a repeated Lie derivative grows with its order.

use palmistry_lang::System;
use palmistry_math::expression::Program;
use std::time::Instant;

/// The cost of one order.
#[derive(Clone, Copy, Debug)]
pub struct Growth {
    pub order: usize,
    /// Operations of the straight-line program for the derivative alone.
    pub operations: usize,
    /// Seconds to build this order from the one before.
    pub seconds: f64,
}

/// Takes the Lie derivative of an output along one field again and again, and counts: up to an order, or until there are more
/// than a hundred thousand operations. `field` and `output` are places in the system.
pub fn growth_of_lie_derivatives(system: &System, field: usize, output: usize, orders: usize) -> Vec<Growth> {
    let mut system = system.clone();
    let mut value = system.outputs[output].1;
    let mut found = Vec::new();
    for order in 1..=orders {
        let begin = Instant::now();
        value = system.lie_derivative(field, value);
        let seconds = begin.elapsed().as_secs_f64();
        let operations = Program::plain(&system.graph, &[value]).len();
        found.push(Growth { order, operations, seconds });
        if operations > MOST_OPERATIONS {
            break;
        }
    }
    found
}

/// Beyond so many operations the next order is not taken.
pub(super) const MOST_OPERATIONS: usize = 100_000;
