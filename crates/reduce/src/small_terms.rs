//! Terms that are small over the ranges, left out of rates with a bound that holds.
//!
//! Every summand of a rate, at any depth, is a candidate: `g*cos(phi1)` in `(omega0^2*r1 + g*cos(phi1))/(omega1 - omega0)` as well as a summand of the rate itself.
//! What is left out of the rate altogether is written operation by operation, as `a b - a' b' = (a - a') b + a' (b - b')` for a product, so that nothing in it cancels.
//! Candidates are chosen by their sizes at drawn states, which prove nothing; the bound is then shown by interval arithmetic over the ranges
//! ([`palmistry_inequality::decide`]), or the terms stay.

use super::differences::difference;
use super::remaining::{LeftOutOfRate, Remaining, WhyLeftOut};
use dashu::rational::RBig;
use palmistry_inequality::{Given, InequalityAnswer, decide};
use palmistry_math::expression::{
    Graph, Guard, Input, Need, Node, NodeId, Program, Symbol, add_guard, gradient,
};
use palmistry_math::number::{Floats, parse_decimal, rational_to_f64};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Terms that were left out of a rate because they are small over the ranges.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallTerms {
    /// The state whose rate it is.
    pub state: String,
    /// The field.
    pub field: String,
    /// The terms, as they stood in the rate.
    pub terms: Vec<String>,
    /// What is left out has at most this absolute value over the ranges, in the unit of the rate: a decimal.
    pub bound: String,
    /// The median of the rate's absolute values at states drawn from the ranges: the largest one may lie beside a pole.
    pub median: f64,
}

/// So many states are drawn.
const DRAWN: usize = 256;

/// One coordinate of three is drawn at an end of its range, where most terms are largest.
const AT_AN_END: f64 = 1.0 / 3.0;

/// What is shown first is this many times the largest value that was drawn, and so on, as far as the tolerance allows: enclosures are wider than what they enclose.
const FACTORS: [f64; 5] = [1.001, 1.1, 1.5, 3.0, 10.0];

/// After so many summands that could not be bounded with the others no further one is tried.
const MOST_FAILED: usize = 4;

/// A rate with more summands is left as it is.
const MOST_SUMMANDS: usize = 400;

/// Leaves out of every rate the summands that together are at most `tolerance` times the median of its absolute values at drawn states, and then what outputs
/// depend on by them alone.
pub(crate) fn leave_out_small_terms(remaining: &mut Remaining, tolerance: f64) -> Vec<SmallTerms> {
    let ranges = known_ranges(remaining);
    let mut told = Vec::new();
    for flow in 0..remaining.flows.len() {
        for place in 0..remaining.states.len() {
            let rate = remaining.rates[flow][place];
            let Some(found) =
                Rate::new(remaining, rate, &ranges).and_then(|own| own.left_out(remaining, tolerance))
            else {
                continue;
            };
            remaining.rates[flow][place] = found.rate;
            let state = remaining.states[place];
            told.push(SmallTerms {
                state: remaining.system.symbol_name(state).to_owned(),
                field: remaining.flows[flow].name.clone(),
                terms: found.terms,
                bound: found.bound.clone(),
                median: found.median,
            });
            let ranges = found.ranges;
            remaining.approximated.push(LeftOutOfRate {
                flow,
                state,
                bound: found.bound,
                difference: found.difference,
                ranges,
            });
        }
    }
    if !told.is_empty() {
        remaining.remarks.push("the rank is of this model: small terms may make more observable".to_owned());
    }
    for place in remaining.not_needed() {
        remaining.leave_out(place, WhyLeftOut::InSmallTermsAlone);
    }
    told
}

/// The ranges that the file, the conservation laws and known values give.
fn known_ranges(remaining: &Remaining) -> HashMap<Symbol, (RBig, RBig)> {
    let mut found = HashMap::new();
    for (symbol, info) in remaining.system.symbols() {
        let known = remaining.constants.iter().find(|(constant, _)| *constant == symbol);
        let known = known.and_then(|(_, value)| value.clone());
        // a parameter with a range may have any value in it
        let ends = match (&known, &info.range, &info.default) {
            (Some(value), ..) | (None, None, Some(value)) => Some((value.clone(), value.clone())),
            (None, Some(range), _) => Some((range.low.clone(), range.high.clone())),
            (None, None, None) => None,
        };
        if let Some(ends) = ends {
            found.insert(symbol, ends);
        }
    }
    for law in &remaining.laws {
        if let Some([low, high]) = law.range_of_the_total(&remaining.system) {
            found.insert(law.total, (low, high));
        }
    }
    found
}

/// A rate whose summands have factors of their own.
struct Rate {
    /// With a factor in front of each summand.
    instrumented: NodeId,
    /// The factor of each summand, and the summand.
    summands: Vec<(Symbol, NodeId)>,
    /// The symbols of the rate, with their ranges.
    ranges: BTreeMap<Symbol, (RBig, RBig)>,
}

/// A rate without its small terms.
struct Found {
    rate: NodeId,
    terms: Vec<String>,
    bound: String,
    median: f64,
    difference: NodeId,
    ranges: Vec<(Symbol, RBig, RBig)>,
}

impl Rate {
    /// None where nothing is added in it, or one of its symbols has neither a range nor a value.
    fn new(remaining: &mut Remaining, rate: NodeId, known: &HashMap<Symbol, (RBig, RBig)>) -> Option<Rate> {
        let graph = &mut remaining.system.graph;
        let mut ranges = BTreeMap::new();
        for symbol in graph.symbols_of([rate]) {
            ranges.insert(symbol, known.get(&symbol)?.clone());
        }
        let is_sum = |graph: &Graph, id: NodeId| matches!(graph.node(id), Node::Add(..) | Node::Sub(..));
        let nodes = graph.reachable([rate]);
        if nodes.iter().filter(|id| is_sum(graph, **id)).count() > MOST_SUMMANDS {
            return None;
        }
        let mut image: HashMap<NodeId, NodeId> = HashMap::new();
        let mut summands = Vec::new();
        for id in nodes {
            let node = graph.node(id);
            let new = match node {
                Node::Add(a, b) | Node::Sub(a, b) => {
                    let [left, right] = [a, b].map(|operand| match is_sum(graph, operand) {
                        true => image[&operand],
                        false => {
                            let factor = graph.intern(&format!("summand {}", summands.len()));
                            summands.push((factor, operand));
                            let factor = graph.symbol(factor);
                            graph.mul(factor, image[&operand])
                        }
                    });
                    if matches!(node, Node::Add(..)) {
                        graph.add(left, right)
                    } else {
                        graph.sub(left, right)
                    }
                }
                _ => graph.rebuild(node, |operand| image[&operand]),
            };
            image.insert(id, new);
        }
        (!summands.is_empty()).then(|| Rate { instrumented: image[&rate], summands, ranges })
    }

    /// The rate without the summands that are small, as far as a bound of what they are together is shown.
    fn left_out(&self, remaining: &mut Remaining, tolerance: f64) -> Option<Found> {
        let factors: Vec<Symbol> = self.summands.iter().map(|(factor, _)| *factor).collect();
        let mut nodes = vec![self.instrumented];
        nodes.extend(gradient(&mut remaining.system.graph, self.instrumented, &factors));
        let (drawn, median) = self.drawn(&remaining.system.graph, &nodes)?;
        let allowed = tolerance * median;
        let mut order: Vec<usize> = (0..factors.len()).filter(|place| drawn[place + 1] <= allowed).collect();
        order.sort_by(|a, b| drawn[a + 1].total_cmp(&drawn[b + 1]));
        let mut sum = 0.0;
        order.retain(|place| {
            sum += drawn[place + 1];
            sum <= allowed
        });
        if order.is_empty() {
            return None;
        }
        let all = self.without(remaining, &order, median, allowed);
        if all.is_some() {
            return all;
        }
        // those that can be bounded together, the smallest first
        let (mut taken, mut best, mut failed) = (Vec::new(), None, 0);
        for place in order {
            taken.push(place);
            match self.without(remaining, &taken, median, allowed) {
                Some(found) => best = Some(found),
                None => {
                    taken.pop();
                    failed += 1;
                }
            }
            if failed == MOST_FAILED {
                break;
            }
        }
        best
    }

    /// The rate without some of its summands, where a bound within what is allowed is shown.
    fn without(
        &self,
        remaining: &mut Remaining,
        places: &[usize],
        median: f64,
        allowed: f64,
    ) -> Option<Found> {
        let is_angle = remaining.system.angle_test();
        let graph = &mut remaining.system.graph;
        let [_, smaller, difference] = self.compared(graph, places);
        // what has one value is that value
        let values: HashMap<Symbol, NodeId> = self
            .ranges
            .iter()
            .filter(|(_, (low, high))| low == high)
            .map(|(symbol, (low, _))| (*symbol, graph.rational(low.clone())))
            .collect();
        if graph.vanishing_divisor(&[difference], &values).is_some() {
            return None;
        }
        let there = graph.substitute(&[difference], &values)[0];
        // without a summand a divisor may be zero: then nothing has a value
        let largest = self.drawn(graph, &[there, smaller])?.0[0];
        let bound = FACTORS.iter().map(|factor| rounded_up(factor * largest)).find(|bound| {
            let exact = parse_decimal(bound).filter(|exact| rational_to_f64(exact) <= allowed);
            exact.is_some_and(|exact| self.is_bounded(graph, there, exact, &is_angle))
        })?;
        let mut terms = Vec::new();
        for place in places {
            let text = graph.text(self.summands[*place].1);
            if !terms.contains(&text) {
                terms.push(text);
            }
        }
        let symbols = graph.symbols_of([difference]);
        let ranges = symbols.into_iter().filter_map(|symbol| {
            let (low, high) = self.ranges.get(&symbol)?;
            Some((symbol, low.clone(), high.clone()))
        });
        let ranges = ranges.collect();
        Some(Found { rate: smaller, terms, bound, median, difference, ranges })
    }

    /// The whole rate, the rate without some summands, and their difference.
    fn compared(&self, graph: &mut Graph, places: &[usize]) -> [NodeId; 3] {
        let [zero, one] = [0, 1].map(|value| graph.integer(value));
        let gone: HashSet<Symbol> = places.iter().map(|place| self.summands[*place].0).collect();
        let factors: HashSet<Symbol> = self.summands.iter().map(|(factor, _)| *factor).collect();
        let mut image: HashMap<NodeId, [NodeId; 3]> = HashMap::new();
        for id in graph.reachable([self.instrumented]) {
            let node = graph.node(id);
            let new = match node {
                Node::Symbol(symbol) if gone.contains(&symbol) => [one, zero, one],
                Node::Symbol(symbol) if factors.contains(&symbol) => [one, one, zero],
                _ => {
                    let [whole, smaller] =
                        [0, 1].map(|which| graph.rebuild(node, |operand| image[&operand][which]));
                    let changes = node.operands().any(|operand| image[&operand][2] != zero);
                    let difference = match changes {
                        true => difference(graph, node, &image, [whole, smaller]),
                        false => zero,
                    };
                    [whole, smaller, difference]
                }
            };
            image.insert(id, new);
        }
        image[&self.instrumented]
    }

    /// Whether it is shown that an expression has at most this absolute value over the ranges.
    fn is_bounded(
        &self,
        graph: &mut Graph,
        node: NodeId,
        bound: RBig,
        is_angle: &dyn Fn(Symbol) -> bool,
    ) -> bool {
        let bound = graph.rational(bound);
        let goals = [graph.sub(bound, node), graph.add(bound, node)];
        let mut assumed = Vec::new();
        for symbol in graph.symbols_of([node]) {
            let Some((low, high)) = self.ranges.get(&symbol) else { return false };
            let [low, high] = [low, high].map(|end| graph.rational(end.clone()));
            let own = graph.symbol(symbol);
            for inside in [graph.sub(own, low), graph.sub(high, own)] {
                assumed.push(Guard { node: inside, need: Need::NotNegative });
            }
        }
        let exists = guards_of(graph, node);
        goals.into_iter().all(|goal| {
            let given = Given { assumed: &assumed, equations: &[], exists: &exists };
            let goal = Guard { node: goal, need: Need::NotNegative };
            matches!(decide(graph, goal, given, is_angle, &mut |_, _| true), InequalityAnswer::Holds(_))
        })
    }

    /// The largest absolute values of some expressions, with all factors one, at states drawn from the ranges, and the median of those of the first; none where
    /// they have no value at any of them.
    fn drawn(&self, graph: &Graph, nodes: &[NodeId]) -> Option<(Vec<f64>, f64)> {
        let program = Program::plain(graph, nodes);
        let loaded = program.load(Floats).ok()?;
        let mut rng = ChaCha8Rng::seed_from_u64(0x736d_616c_6c00); // any fixed seed: what is drawn proves nothing
        let ranges: BTreeMap<Symbol, [f64; 2]> = self
            .ranges
            .iter()
            .map(|(symbol, (low, high))| (*symbol, [rational_to_f64(low), rational_to_f64(high)]))
            .collect();
        let (mut largest, mut of_first) = (vec![0.0f64; nodes.len()], Vec::new());
        for _ in 0..DRAWN {
            let state: BTreeMap<Symbol, f64> =
                ranges.iter().map(|(symbol, range)| (*symbol, drawn(*range, &mut rng))).collect();
            // what is no symbol of the rate is a factor
            let value =
                |input: &Input| input.symbol().map(|symbol| state.get(&symbol).copied().unwrap_or(1.0));
            let inputs: Option<Vec<f64>> = program.inputs().iter().map(value).collect();
            let Ok(values) = loaded.run(&inputs?, &mut Vec::new()) else { continue };
            if values.iter().any(|value| !value.is_finite()) {
                continue;
            }
            of_first.push(values[0].abs());
            largest.iter_mut().zip(values).for_each(|(most, value)| *most = most.max(value.abs()));
        }
        of_first.sort_by(f64::total_cmp);
        let median = *of_first.get(of_first.len() / 2)?;
        Some((largest, median))
    }
}

fn drawn([low, high]: [f64; 2], rng: &mut impl Rng) -> f64 {
    match rng.random::<f64>() {
        part if part < AT_AN_END / 2.0 => low,
        part if part < AT_AN_END => high,
        _ => low + rng.random::<f64>() * (high - low),
    }
}

/// Where an expression exists.
fn guards_of(graph: &Graph, node: NodeId) -> Vec<Guard> {
    let mut found = Vec::new();
    for id in graph.reachable([node]) {
        let (node, need) = match graph.node(id) {
            Node::Div(_, b) => (b, Some(Need::NotZero)),
            Node::Power(a, power) if power < 0 => (a, Some(Need::NotZero)),
            Node::Apply(function, a) => (a, Need::of(function)),
            _ => continue,
        };
        if let Some(need) = need {
            add_guard(graph, &mut found, Guard { node, need });
        }
    }
    found
}

/// A positive number as a decimal of three digits that is no smaller.
fn rounded_up(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.log10().floor() as i32;
    let digits = (value / 10f64.powi(exponent - 2)).ceil() as u64;
    format!("{}.{:02}e{exponent}", digits / 100, digits % 100)
}
