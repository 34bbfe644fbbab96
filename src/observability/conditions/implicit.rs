//! Outputs that are zero, `0 = y(x, u)`: they tie known signals to states. What is seen of a state is then what the rows of `y`,
//! `y'`, ... say at points where all of these vanish.
//!
//! Each `y^(j) = 0` is solved for a coordinate in which it is linear. For `j > 0` it is so in the highest derivative of a
//! signal, with the slope that `y` itself has; where that slope does not vanish (at almost all points of a set that has one part)
//! the derivatives of the signal are given by the rest, one after the other. No branch is followed on which it does vanish: a rank is
//! that at almost all points.

use super::single::{also_met_otherwise, linear_solution};
use super::{Branch, Unsolved, is_a_constant_but_zero, quote, vanishes};
use crate::expression::{Guard, Need, NodeId, Symbol, add_guard};
use crate::system::{Assignment, System};

impl Branch {
    /// The part of the branch on which the outputs that are zero vanish, with one derivative more than words are long: so many
    /// derivatives of known signals there are, and all but the last move along the set.
    ///
    /// # Errors
    /// Where one of them vanishes nowhere, is linear in no coordinate, or vanishes in more than one way.
    pub fn tied_by_outputs(mut self, system: &mut System) -> Result<Branch, Unsolved> {
        let outputs = system.zero_outputs();
        if outputs.is_empty() {
            return Ok(self);
        }
        for node in &outputs {
            let zero = system.graph.integer(0);
            self.steps.push(quote(system, zero, *node));
        }
        let drift = system.drift();
        let mut current = outputs;
        for order in 0..=system.longest_word().unwrap_or(0) + 1 {
            for node in &current {
                self.meet(system, *node, order)?;
            }
            let Some(drift) = drift else { break };
            current = current.iter().map(|node| system.lie_derivative(drift, *node)).collect();
        }
        Ok(self)
    }

    /// Meets one more equation, a derivative of an output.
    fn meet(&mut self, system: &mut System, output: NodeId, order: usize) -> Result<(), Unsolved> {
        let here = system.graph.substitute(&[output], &self.values)[0];
        if vanishes(system, here) {
            return Ok(());
        }
        let zero = system.graph.integer(0);
        let text = quote(system, zero, here);
        if is_a_constant_but_zero(system, here) {
            return Err(Unsolved::Never(text));
        }
        for symbol in candidates(system, here) {
            let Some(value) = linear_solution(system, here, symbol) else { continue };
            // derivatives of a signal follow from what was found to be one part
            let follows = order > 0 && system.known.contains(&symbol);
            if !follows && also_met_otherwise(system, here, symbol) {
                return Err(Unsolved::Several(text));
            }
            let slope = system.partial(here, symbol);
            add_guard(&system.graph, &mut self.guards, Guard { node: slope, need: Need::NotZero });
            let single = Assignment::from([(symbol, value)]);
            for values in [&mut self.values, &mut self.before_turns] {
                for known in values.values_mut() {
                    *known = system.graph.substitute(&[*known], &single)[0];
                }
                values.insert(symbol, value);
            }
            return Ok(());
        }
        Err(Unsolved::NotLinear(text))
    }
}

/// The coordinates that an equation may be solved for: known signals, their highest derivatives first, then all others.
fn candidates(system: &System, equation: NodeId) -> Vec<Symbol> {
    let mentioned = system.graph.symbols_of([equation]);
    let may_be = |symbol: &Symbol| mentioned.contains(symbol) && !system.is_angle(*symbol);
    let mut found: Vec<Symbol> = system.states.iter().copied().filter(may_be).collect();
    found.sort_by_key(|symbol| match system.known.contains(symbol) {
        true => (0, std::cmp::Reverse(system.derivative_of_signal(*symbol).unwrap_or(0))),
        false => (1, std::cmp::Reverse(0)),
    });
    found
}
