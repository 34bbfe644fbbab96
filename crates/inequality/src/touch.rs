//! Where an inequality holds with equality: bounds never show it there, but derivatives do.
//!
//! At a state where the goal and its gradient vanish exactly the goal is not negative around, as far as its Hessian is
//! positive definite. And of a goal in one coordinate whose first derivatives vanish exactly at `a`, the next one of
//! order `n` being positive on a whole interval, `h(x) = h^(n)(xi) (x - a)^n / n!` has the sign of `(x - a)^n`.

use super::domain_intervals::WhereDefined;
use dashu::base::BitTest;
use dashu::rational::RBig;
use palmistry_math::expression::{
    Graph, Input, Need, NodeId, Program, Symbol, ZeroTest, gradient, identically_zero,
};
use palmistry_math::number::{Interval, rational_from_f64};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::HashMap;

/// Derivatives of a goal in one coordinate are taken up to this order.
const DEEPEST: usize = 6;
/// Boxes are looked at whose sides are narrower than this, for their size.
const NARROW: f64 = 0.05;
/// States with longer numbers are not tried.
const LONGEST: usize = 24;
/// So many states are tried at most.
const MOST_STATES: usize = 200;

/// Derivatives of a goal, and states at which they have been looked at.
pub struct Touch {
    goal: NodeId,
    symbols: Vec<Symbol>,
    slopes: Vec<NodeId>,
    /// The Hessian by rows; of one coordinate, the derivatives from the second on.
    further: Option<(Vec<NodeId>, Program)>,
    /// At a state: whether goal and gradient vanish; of one coordinate, how many derivatives do, the goal included.
    known: HashMap<Vec<RBig>, usize>,
}

impl Touch {
    pub fn new(goal: NodeId, symbols: &[Symbol], slopes: &[NodeId]) -> Touch {
        Touch {
            goal,
            symbols: symbols.to_vec(),
            slopes: slopes.to_vec(),
            further: None,
            known: HashMap::new(),
        }
    }

    /// Whether the goal holds on a box on which it is defined everywhere. `is_left_out` says whether the box does not
    /// contain a number at which a coordinate ends.
    pub fn holds(
        &mut self,
        graph: &mut Graph,
        need: Need,
        sides: &[Interval],
        is_left_out: &dyn Fn(usize, &RBig) -> bool,
    ) -> bool {
        let one = self.symbols.len() == 1;
        let narrow = |side: &Interval| side.width() <= NARROW * side.magnitude().max(1.0);
        if need == Need::NotZero || need == Need::Positive && !one || !sides.iter().all(narrow) {
            return false;
        }
        let Some(state) = sides.iter().map(|side| simplest(*side)).collect::<Option<Vec<RBig>>>() else {
            return false;
        };
        let vanishing = match self.known.get(&state) {
            Some(vanishing) => *vanishing,
            None if self.known.len() >= MOST_STATES => return false,
            None => {
                let vanishing = self.vanishing(graph, &state);
                self.known.insert(state.clone(), vanishing);
                vanishing
            }
        };
        if one {
            return vanishing > 0 && self.on_a_line(graph, need, sides[0], &state[0], vanishing, is_left_out);
        }
        vanishing == 2 && self.is_convex(graph, sides)
    }

    /// How many of goal, first and further derivatives vanish exactly.
    fn vanishing(&mut self, graph: &mut Graph, state: &[RBig]) -> usize {
        let values: HashMap<Symbol, NodeId> = self
            .symbols
            .iter()
            .zip(state)
            .map(|(symbol, value)| (*symbol, graph.rational(value.clone())))
            .collect();
        let vanishes = |graph: &mut Graph, nodes: &[NodeId]| {
            let there = graph.substitute(nodes, &values);
            // what stands for itself, as log(2), may cancel
            let mut rng = ChaCha8Rng::seed_from_u64(0x746f_7563);
            matches!(identically_zero(graph, &there, |_| false, &mut rng), ZeroTest::Zero { .. })
        };
        if !vanishes(graph, &[self.goal]) {
            return 0;
        }
        let slopes = self.slopes.clone();
        if !vanishes(graph, &slopes) {
            return 1;
        }
        if self.symbols.len() > 1 {
            return 2;
        }
        let further = self.further(graph).to_vec();
        2 + further.iter().take_while(|node| vanishes(graph, &[**node])).count()
    }

    fn further(&mut self, graph: &mut Graph) -> &[NodeId] {
        if self.further.is_none() {
            let mut nodes = Vec::new();
            if self.symbols.len() == 1 {
                let mut last = self.slopes[0];
                for _ in 2..=DEEPEST {
                    last = gradient(graph, last, &self.symbols)[0];
                    nodes.push(last);
                }
            } else {
                for slope in &self.slopes {
                    nodes.extend(gradient(graph, *slope, &self.symbols));
                }
            }
            let program = Program::plain(graph, &nodes);
            self.further = Some((nodes, program));
        }
        self.further.as_ref().map_or(&[], |(nodes, _)| nodes)
    }

    fn values(&self, sides: &[Interval]) -> Option<Vec<Interval>> {
        let (_, program) = self.further.as_ref()?;
        let at = |input: &Input| match input {
            Input::Plain(symbol) => {
                self.symbols.binary_search(symbol).map_or(Interval::WHOLE, |place| sides[place])
            }
            _ => Interval::WHOLE,
        };
        let inputs: Vec<Interval> = program.inputs().iter().map(at).collect();
        program.load(WhereDefined).ok()?.run(&inputs, &mut Vec::new()).ok()
    }

    fn on_a_line(
        &mut self,
        graph: &mut Graph,
        need: Need,
        side: Interval,
        state: &RBig,
        order: usize,
        is_left_out: &dyn Fn(usize, &RBig) -> bool,
    ) -> bool {
        self.further(graph);
        let next = match order {
            0 => return false,
            1 => {
                let program = Program::plain(graph, &self.slopes);
                let Ok(loaded) = program.load(WhereDefined) else { return false };
                let inputs = vec![side; program.inputs().len()];
                loaded.run(&inputs, &mut Vec::new()).ok().map(|values| values[0])
            }
            order => self.values(&[side]).and_then(|values| values.get(order - 2).copied()),
        };
        let Some(next) = next else { return false };
        let at = |end: f64| rational_from_f64(end).is_some_and(|end| end == *state);
        let (from_below, from_above) = (at(side.low()), at(side.high()));
        let even = order.is_multiple_of(2);
        let holds = if even {
            next.low() > 0.0
        } else {
            from_below && next.low() > 0.0 || from_above && next.high() < 0.0
        };
        // at the state itself the goal is zero
        holds && (need == Need::NotNegative || is_left_out(0, state))
    }

    /// Whether the Hessian is positive definite on a box: elimination in intervals, which holds for every matrix in them.
    fn is_convex(&mut self, graph: &mut Graph, sides: &[Interval]) -> bool {
        self.further(graph);
        let Some(mut matrix) = self.values(sides) else { return false };
        let n = sides.len();
        for k in 0..n {
            let pivot = matrix[k * n + k];
            if pivot.low() <= 0.0 {
                return false;
            }
            for i in k + 1..n {
                let factor = matrix[i * n + k] / pivot;
                for j in k + 1..n {
                    matrix[i * n + j] = matrix[i * n + j] - factor * matrix[k * n + j];
                }
            }
        }
        true
    }
}

/// The simplest number of an interval, where it is short.
fn simplest(side: Interval) -> Option<RBig> {
    let (low, high) = (rational_from_f64(side.low())?, rational_from_f64(side.high())?);
    let mut candidates = vec![low.clone(), high.clone()];
    if low <= RBig::ZERO && high >= RBig::ZERO {
        candidates.push(RBig::ZERO);
    } else if low < high {
        candidates.push(RBig::simplest_in(low, high));
    }
    let length = |value: &RBig| value.numerator().bit_len() + value.denominator().bit_len();
    candidates.into_iter().min_by_key(length).filter(|value| length(value) <= LONGEST)
}
