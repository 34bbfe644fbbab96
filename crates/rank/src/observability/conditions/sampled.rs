//! What a few states say against a sign. It only saves work: a proof that is bound to fail is not looked for, and where rounding
//! deceives, one that would have been found is not found.

use palmistry_lang::System;
use palmistry_math::expression::{Guard, Need, NodeId, Program, Symbol};
use palmistry_math::number::Floats;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// States that are drawn.
const STATES: usize = 48;
/// Between two of them so many are looked at.
const BETWEEN: usize = 16;

/// An expression and guards, to be evaluated at states in doubles.
struct Sampled {
    program: Program,
    needs: Vec<Need>,
    symbols: Vec<Symbol>,
}

/// Whether an expression is positive at some states and negative at others.
pub(super) fn has_both_signs(system: &System, expression: NodeId) -> bool {
    let sampled = Sampled::new(system, expression, &[]);
    let found = sampled.drawn();
    found.iter().any(|(_, values)| values[0] > 0.0) && found.iter().any(|(_, values)| values[0] < 0.0)
}

/// Whether an expression changes its sign between two states, with guards that hold all the way: it vanishes in between.
pub(super) fn changes_its_sign(system: &System, expression: NodeId, guards: &[Guard]) -> bool {
    let sampled = Sampled::new(system, expression, guards);
    let found = sampled.drawn();
    let of_sign = |upward: bool| {
        found.iter().filter(move |(_, values)| values[0] != 0.0 && (values[0] > 0.0) == upward).take(4)
    };
    of_sign(true).any(|from| of_sign(false).any(|to| sampled.is_whole_between(from, to)))
}

impl Sampled {
    fn new(system: &System, expression: NodeId, guards: &[Guard]) -> Sampled {
        let nodes: Vec<NodeId> =
            [expression].into_iter().chain(guards.iter().map(|guard| guard.node)).collect();
        Sampled {
            program: Program::plain(&system.graph, &nodes),
            needs: guards.iter().map(|guard| guard.need).collect(),
            symbols: system.graph.symbols_of(nodes),
        }
    }

    /// The values of the expression and of the guards at a state at which all hold.
    fn values(&self, state: &[f64]) -> Option<Vec<f64>> {
        let at: BTreeMap<Symbol, f64> = self.symbols.iter().copied().zip(state.iter().copied()).collect();
        let inputs: Option<Vec<f64>> =
            self.program.inputs().iter().map(|input| at.get(&input.symbol()?).copied()).collect();
        let values = self.program.load(Floats).ok()?.run(&inputs?, &mut Vec::new()).ok()?;
        let holds = self.needs.iter().zip(&values[1..]).all(|(need, value)| match need {
            Need::NotZero => *value != 0.0,
            Need::Positive => *value > 0.0,
            Need::NotNegative => *value >= 0.0,
            Need::WithinOne => value.abs() <= 1.0,
            Need::InsideOne => value.abs() < 1.0,
        });
        (holds && values.iter().all(|value| value.is_finite())).then_some(values)
    }

    fn drawn(&self) -> Vec<(Vec<f64>, Vec<f64>)> {
        let mut rng = ChaCha8Rng::seed_from_u64(0x7369_676e); // any fixed seed: the same file gives the same answer
        let mut found = Vec::new();
        for attempt in 0..STATES {
            let reach = [3.0, 1.0, 10.0][attempt % 3];
            let state: Vec<f64> = self.symbols.iter().map(|_| rng.random_range(-reach..reach)).collect();
            found.extend(self.values(&state).map(|values| (state, values)));
        }
        found
    }

    /// Whether all guards hold on the way from one state to another, none of them with another sign.
    fn is_whole_between(
        &self,
        (from, first): &(Vec<f64>, Vec<f64>),
        (to, last): &(Vec<f64>, Vec<f64>),
    ) -> bool {
        let same = |a: &[f64], b: &[f64]| a[1..].iter().zip(&b[1..]).all(|(a, b)| (*a > 0.0) == (*b > 0.0));
        same(first, last)
            && (1..BETWEEN).all(|step| {
                let part = step as f64 / BETWEEN as f64;
                let state: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + part * (b - a)).collect();
                self.values(&state).is_some_and(|values| same(first, &values))
            })
    }
}
