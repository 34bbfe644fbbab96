//! That there are states at which an expression vanishes: between two at which it has different signs, where it is
//! continuous.

use super::domain_intervals::WhereDefined;
use dashu::rational::RBig;
use palmistry_math::expression::{Graph, Guard, NodeId, Program, Symbol};
use palmistry_math::number::Interval;
use std::collections::HashMap;

/// A way between two states is looked at in so many pieces.
const PIECES: u32 = 64;
/// So many pairs of states are tried.
const PAIRS: usize = 150;

/// Whether an expression certainly vanishes at a state at which all guards hold, on a straight way between two of the
/// given states.
pub fn vanishes_somewhere(
    graph: &mut Graph,
    expression: NodeId,
    guards: &[Guard],
    states: &[HashMap<Symbol, RBig>],
) -> bool {
    let mut nodes = vec![expression];
    nodes.extend(guards.iter().map(|guard| guard.node));
    let way = graph.intern("the way from one state to another");
    let t = graph.symbol(way);
    let symbols = graph.symbols_of(nodes.iter().copied());
    let pairs = (0..states.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    for (i, j) in pairs.take(PAIRS) {
        let mut values = HashMap::new();
        for symbol in &symbols {
            let (Some(a), Some(b)) = (states[i].get(symbol), states[j].get(symbol)) else { continue };
            let (from, step) = (graph.rational(a.clone()), graph.rational(b - a));
            let step = graph.mul(step, t);
            values.insert(*symbol, graph.add(from, step));
        }
        let there = graph.substitute(&nodes, &values);
        let program = Program::plain(graph, &there);
        let Ok(loaded) = program.load(WhereDefined) else { continue };
        let mut registers = Vec::new();
        let mut at = |low: f64, high: f64| {
            let inputs = vec![Interval::new(low, high); program.inputs().len()];
            loaded.run(&inputs, &mut registers).ok()
        };
        let end = |k: u32| f64::from(k) / f64::from(PIECES);
        for k in 0..PIECES {
            let (low, high) = (end(k), end(k + 1));
            let (Some(first), Some(last), Some(between)) = (at(low, low), at(high, high), at(low, high))
            else {
                continue;
            };
            let apart =
                first[0].high() < 0.0 && last[0].low() > 0.0 || first[0].low() > 0.0 && last[0].high() < 0.0;
            let exists =
                guards.iter().zip(&between[1..]).all(|(g, v)| g.need.is_met_by_interval(*v) == Some(true));
            if apart && exists {
                return true;
            }
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use palmistry_math::expression::Need;

    #[test]
    fn a_sign_that_changes_shows_a_zero_but_not_across_a_pole() {
        let mut graph = Graph::default();
        let symbol = graph.intern("x");
        let x = graph.symbol(symbol);
        let at = |value: i64| HashMap::from([(symbol, RBig::from(value))]);
        let states = [at(-1), at(2)];
        let square = graph.power(x, 2);
        let two = graph.integer(2);
        let root = graph.sub(square, two);
        assert!(vanishes_somewhere(&mut graph, root, &[], &states));
        let sum = graph.add(square, two);
        assert!(!vanishes_somewhere(&mut graph, sum, &[], &states));
        let one = graph.integer(1);
        let pole = graph.div(one, x);
        let guard = Guard { node: x, need: Need::NotZero };
        assert!(!vanishes_somewhere(&mut graph, pole, &[guard], &states));
    }
}
