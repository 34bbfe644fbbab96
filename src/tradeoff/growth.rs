//! How the expression graph of a repeated Lie derivative grows with its order.

use crate::expression::Program;
use crate::system::System;
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

/// Takes the Lie derivative of an output along one field again and again, and counts.
pub fn growth_of_lie_derivatives(system: &System, field: usize, output: usize, orders: usize) -> Vec<Growth> {
    let mut system = system.clone();
    let mut value = system.outputs[output].1;
    (1..=orders)
        .map(|order| {
            let begin = Instant::now();
            value = system.lie_derivative(field, value);
            let seconds = begin.elapsed().as_secs_f64();
            Growth {
                order,
                operations: Program::new(&system.graph, &[value], |_| false, false).len(),
                seconds,
            }
        })
        .collect()
}
