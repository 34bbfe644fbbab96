//! Outputs that are zero, `0 = y(x, u)`: they tie known signals to states. What is seen of a state is then what the rows of `y`,
//! `y'`, ... say at points where all of these vanish.
//!
//! Each `y^(j) = 0` is solved for a coordinate in which it is linear. For `j > 0` it is so in the highest derivative of a
//! signal, with the slope that `y` itself has; where that slope does not vanish (at almost all points of a set that has one part)
//! the derivatives of the signal are given by the rest, one after the other. No branch is followed on which it does vanish: a rank is
//! that at almost all points.

use super::single::{also_met_otherwise, linear_solution};
use super::{Branch, Unsolved, is_a_constant_but_zero, quote, vanishes};
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{Guard, Need, NodeId, Symbol, add_guard};

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
        let mut solved: Vec<Option<Symbol>> = vec![None; outputs.len()];
        let mut current = outputs;
        for order in 0..=system.longest_word().unwrap_or(0) + 1 {
            for (node, solved) in current.iter().zip(&mut solved) {
                *solved = self.meet(system, *node, order, *solved)?;
            }
            let Some(drift) = drift else { break };
            current = current.iter().map(|node| system.lie_derivative(drift, *node)).collect();
        }
        Ok(self)
    }

    /// Meets one more equation, a derivative of an output, and tells what it was solved for. `before` is what the derivative before
    /// it was.
    fn meet(
        &mut self,
        system: &mut System,
        output: NodeId,
        order: usize,
        before: Option<Symbol>,
    ) -> Result<Option<Symbol>, Unsolved> {
        let here = system.graph.substitute(&[output], &self.values)[0];
        if let Some((symbol, slope)) = before.and_then(|before| next_in_line(system, here, before)) {
            let zero = system.graph.integer(0);
            let rest = system.graph.substitute(&[here], &Assignment::from([(symbol, zero)]))[0];
            let quotient = system.graph.div(rest, slope);
            let value = system.graph.neg(quotient);
            self.put(system, symbol, value, slope);
            return Ok(Some(symbol));
        }
        if vanishes(system, here) {
            return Ok(None);
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
            self.put(system, symbol, value, slope);
            return Ok(Some(symbol));
        }
        Err(Unsolved::NotLinear(text))
    }

    /// Puts the value of a symbol into all that is known, where the slope that it was divided by does not vanish.
    fn put(&mut self, system: &mut System, symbol: Symbol, value: NodeId, slope: NodeId) {
        add_guard(&system.graph, &mut self.guards, Guard { node: slope, need: Need::NotZero });
        let single = Assignment::from([(symbol, value)]);
        for values in [&mut self.values, &mut self.before_turns] {
            let (symbols, nodes): (Vec<Symbol>, Vec<NodeId>) =
                values.iter().map(|(symbol, node)| (*symbol, *node)).unzip();
            let images = system.graph.substitute(&nodes, &single);
            values.extend(symbols.into_iter().zip(images));
            values.insert(symbol, value);
        }
    }
}

/// The next derivative of a signal that the derivative before was solved for, and its slope, where an equation is visibly linear
/// in it: the slope does not mention it. The slope is that of the derivative before (Faa di Bruno), which was tested for zero, so that
/// none of the tests is made again on expressions that grow with each order.
fn next_in_line(system: &mut System, equation: NodeId, before: Symbol) -> Option<(Symbol, NodeId)> {
    if !system.known.contains(&before) {
        return None;
    }
    let next = system.next_derivative_of_signal(before)?;
    if !system.graph.symbols_of([equation]).contains(&next) {
        return None;
    }
    let slope = system.partial(equation, next);
    (!system.graph.symbols_of([slope]).contains(&next)).then_some((next, slope))
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
