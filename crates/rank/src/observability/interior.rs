//! What inequalities and domains leave of a branch: an open part of it, an edge of fewer dimensions, or nothing.
//!
//! A rank at almost all states of a branch says something of the states at which inequalities hold only if these make up an open part of the
//! branch: `x >= 0, x <= 0` leaves one point of a line, at which the rank may be another one. An open part is shown by a state at which
//! all of them hold strictly. Closed inequalities may leave thin parts besides, as `x^2*(x - 1) >= 0` leaves `x = 0` beside `x >= 1`. Such a part
//! lies where some of them hold with equality and where no direction leads into all of them at once (the qualification of constraints of
//! O. L. Mangasarian and S. Fromovitz, 1967). Where all inequalities that hold with equality together are concave there is such a direction,
//! towards the state at which they hold strictly; of a single one there is one unless it has its greatest value there.

use super::conditions::{Branch, vanishes};
use dashu::rational::RBig;
use palmistry_inequality::{Given, InequalityAnswer, Proposed, bounds, decide, holds_by_signs};
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{Graph, Guard, Need, Node, NodeId, Program, Sign, Symbol, sign};
use palmistry_math::number::{Enclosures, Function, rational_from_f64};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// States that are drawn to find one at which everything holds strictly.
const STATES: usize = 240;
/// The bits with which that is decided.
const BITS: usize = 256;
/// No more inequalities are asked whether they can only hold with equality.
const MOST_ASKED: usize = 8;
/// And fewer by boxes, which are slow, where no more symbols are met.
const MOST_BY_BOXES: usize = 3;
const MOST_SYMBOLS: usize = 2;
/// No more sets on which inequalities hold with equality are looked at.
const MOST_EDGES: usize = 12;

/// What guards leave of a branch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Interior {
    /// Nothing: this holds nowhere.
    Empty(String),
    /// These expressions vanish wherever all guards hold.
    Flat(Vec<NodeId>),
    /// There are states at which all hold strictly, arbitrarily near all others, except perhaps near those at which all expressions of one of
    /// these lists vanish.
    Open(Vec<Vec<NodeId>>),
    /// It is not known; these are the guards.
    NotKnown(String),
}

/// What guards leave of a branch; a branch without inequalities is left whole.
///
/// # Errors
/// In words, where a guard distinguishes what the conditions leave open.
pub fn interior(system: &mut System, branch: &Branch, guards: &[Guard]) -> Result<Interior, String> {
    if guards.iter().all(|guard| guard.need == Need::NotZero) {
        return Ok(Interior::Open(Vec::new()));
    }
    let operands: Vec<NodeId> = guards.iter().map(|guard| guard.node).collect();
    let there = branch.put_in(system, &operands)?;
    let mut all = Vec::new();
    for (guard, node) in guards.iter().zip(there) {
        plain_inequalities(system, Guard { node, need: guard.need }, &mut all);
    }
    // what vanishes on the branch need not look like zero: cos(pi/2)
    let zero = system.graph.integer(0);
    for guard in all.iter_mut().filter(|guard| guard.need != Need::NotZero) {
        if vanishes(system, guard.node) {
            guard.node = zero;
        }
    }
    if let Some(guard) = all.iter().find(|guard| guard.is_obvious(&system.graph) == Some(false)) {
        return Ok(Interior::Empty(guard.text(&system.graph)));
    }
    all.retain(|guard| guard.is_obvious(&system.graph) != Some(true));
    let mut closed: Vec<NodeId> = Vec::new();
    for guard in all.iter().filter(|guard| guard.need == Need::NotNegative) {
        if !closed.contains(&guard.node) {
            closed.push(guard.node);
        }
    }
    if all.iter().all(|guard| guard.need == Need::NotZero) {
        return Ok(Interior::Open(Vec::new()));
    }
    let mut open = Vec::new();
    for group in groups(system, &all) {
        if group.iter().all(|guard| guard.need == Need::NotZero) {
            continue;
        }
        let strictly = Strictly::new(system, &group);
        if !strictly.is_somewhere(system, &group) {
            open.push((group, strictly));
        }
    }
    let mut unknown = None;
    for (group, strictly) in open {
        match without_a_state(system, &group, &strictly) {
            Some(Interior::NotKnown(words)) => unknown = Some(words),
            Some(found) => return Ok(found),
            None => {}
        }
    }
    Ok(match (unknown, edges(system, &closed, &all)) {
        (None, Some(edges)) => Interior::Open(edges),
        (Some(words), _) => Interior::NotKnown(words),
        (None, None) => Interior::NotKnown(in_words(system, &all)),
    })
}

/// Where the outputs and rates of a system, and what else is asked about, have derivatives of all orders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SmoothPart {
    /// On an open part of the branch: what holds at almost all of its states speaks of some.
    Open,
    /// Nowhere, or on a set of fewer dimensions: what holds at almost all states of the branch says nothing of it. Why, in words.
    Thin(String),
    /// It is not known; this is needed.
    NotShown(String),
}

/// Where the outputs and the rates of all fields that move have derivatives of all orders on a branch, with values that are held, and where further guards hold.
///
/// # Errors
/// In words, where a guard distinguishes what the conditions leave open.
pub fn smooth_part(
    system: &mut System,
    branch: &Branch,
    held: &Assignment,
    further: &[Guard],
) -> Result<SmoothPart, String> {
    let mut guards = system.smooth_guards(&system.moving_fields());
    guards.extend(branch.guards.iter().chain(further));
    let guards = system.substitute_guards(&guards, held);
    // a divisor may vanish on all of the branch
    let divisors: Vec<NodeId> =
        guards.iter().filter(|guard| guard.need == Need::NotZero).map(|guard| guard.node).collect();
    for (divisor, there) in divisors.iter().zip(branch.put_in(system, &divisors)?) {
        if !branch.values.is_empty() && vanishes(system, there) {
            let text = system.graph.text(*divisor);
            return Ok(SmoothPart::Thin(format!(
                "outputs and rates are divided by {text}, which is zero here"
            )));
        }
    }
    Ok(match interior(system, branch, &guards)? {
        Interior::Open(_) => SmoothPart::Open,
        Interior::Empty(guard) => SmoothPart::Thin(format!(
            "there is no state at which outputs and rates have all derivatives and what is assumed is met: that needs {guard}"
        )),
        Interior::Flat(vanishing) => {
            let equations: Vec<String> =
                vanishing.iter().map(|node| format!("{} = 0", system.graph.text(*node))).collect();
            SmoothPart::Thin(format!(
                "outputs and rates have all derivatives, and what is assumed is met, on no open set of states, but only where {}",
                equations.join(", ")
            ))
        }
        Interior::NotKnown(words) => SmoothPart::NotShown(format!(
            "no state was found at which outputs and rates have all derivatives and what is assumed is met: that needs {words}"
        )),
    })
}

/// Guards in groups that have no symbol in common: all hold strictly somewhere where those of each group do.
fn groups(system: &System, guards: &[Guard]) -> Vec<Vec<Guard>> {
    let mut found: Vec<(Vec<Symbol>, Vec<Guard>)> = Vec::new();
    for guard in guards {
        let (mut symbols, mut group) = (system.graph.symbols_of([guard.node]), vec![*guard]);
        let (tied, apart): (Vec<_>, Vec<_>) = std::mem::take(&mut found)
            .into_iter()
            .partition(|(others, _)| others.iter().any(|symbol| symbols.contains(symbol)));
        found = apart;
        for (others, guards) in tied {
            symbols.extend(others);
            group.extend(guards);
        }
        found.push((symbols, group));
    }
    found.into_iter().map(|(_, group)| group).collect()
}

/// What is known where no state was drawn at which all guards of a group hold strictly; nothing where one is proposed after all.
fn without_a_state(system: &mut System, group: &[Guard], strictly: &Strictly) -> Option<Interior> {
    let is_angle = system.angle_test();
    let asked: Vec<Guard> =
        group.iter().copied().filter(|guard| guard.need != Need::NotZero).take(MOST_ASKED).collect();
    let given = Given { assumed: group, equations: &[], exists: &[] };
    let mut flat = Vec::new();
    for guard in &asked {
        let back = system.graph.neg(guard.node);
        let goal = Guard { node: back, need: Need::NotNegative };
        if holds_by_signs(&mut system.graph, goal, given, &is_angle) {
            if guard.need == Need::Positive {
                return Some(Interior::Empty(guard.text(&system.graph)));
            }
            flat.push(guard.node);
        }
    }
    // boxes are slow, and what is flat may decide the rest
    let few_symbols = system.graph.symbols_of(group.iter().map(|guard| guard.node)).len() <= MOST_SYMBOLS;
    for guard in asked.iter().take(MOST_BY_BOXES).filter(|_| flat.is_empty() && few_symbols) {
        let back = system.graph.neg(guard.node);
        let goal = Guard { node: back, need: Need::NotNegative };
        let mut holds_strictly = |_: &mut Graph, proposed: &Proposed| strictly.holds_in(proposed);
        match decide(&mut system.graph, goal, given, &is_angle, &mut holds_strictly) {
            InequalityAnswer::Holds(_) if guard.need == Need::Positive => {
                return Some(Interior::Empty(guard.text(&system.graph)));
            }
            InequalityAnswer::Holds(_) => return Some(Interior::Flat(vec![guard.node])),
            InequalityAnswer::Fails => return None,
            InequalityAnswer::FailsAt(_) | InequalityAnswer::Open(_) => {}
        }
    }
    Some(match flat.is_empty() {
        true => Interior::NotKnown(in_words(system, group)),
        false => Interior::Flat(flat),
    })
}

fn in_words(system: &System, guards: &[Guard]) -> String {
    guards.iter().map(|guard| guard.text(&system.graph)).collect::<Vec<_>>().join(", ")
}

/// A guard as inequalities with zero; `|u| <= c` as two, of which none has a corner.
fn plain_inequalities(system: &mut System, guard: Guard, found: &mut Vec<Guard>) {
    let need = match guard.need {
        Need::WithinOne => Need::NotNegative,
        Need::InsideOne => Need::Positive,
        need @ (Need::NotNegative | Need::Positive) => {
            if let Node::Sub(bound, root) = system.graph.node(guard.node)
                && let Node::Apply(Function::Sqrt, square) = system.graph.node(root)
                && let Node::Power(inner, 2) = system.graph.node(square)
            {
                let parts = [system.graph.sub(bound, inner), system.graph.add(bound, inner)];
                found.extend(parts.map(|node| Guard { node, need }));
                return;
            }
            found.push(guard);
            return;
        }
        Need::NotZero => {
            found.push(guard);
            return;
        }
    };
    let one = system.graph.integer(1);
    let parts = [system.graph.sub(one, guard.node), system.graph.add(one, guard.node)];
    found.extend(parts.map(|node| Guard { node, need }));
}

/// Guards as a program, to be looked at strictly.
struct Strictly {
    program: Program,
    needs: Vec<Need>,
    symbols: Vec<Symbol>,
}

impl Strictly {
    fn new(system: &System, guards: &[Guard]) -> Strictly {
        let nodes: Vec<NodeId> = guards.iter().map(|guard| guard.node).collect();
        Strictly {
            program: Program::plain(&system.graph, &nodes),
            needs: guards.iter().map(|guard| guard.need.smooth()).collect(),
            symbols: system.graph.symbols_of(nodes),
        }
    }

    /// Whether all guards certainly hold strictly at a state.
    fn hold_at(&self, state: &BTreeMap<Symbol, RBig>) -> bool {
        let numbers = Enclosures::new(BITS);
        let value = |symbol: Symbol| {
            use palmistry_math::number::Arithmetic;
            numbers.rational(state.get(&symbol)?).ok()
        };
        let inputs: Option<Vec<_>> =
            self.program.inputs().iter().map(|input| value(input.symbol()?)).collect();
        let Some(inputs) = inputs else { return false };
        let Ok(loaded) = self.program.load(numbers) else { return false };
        let Ok(found) = loaded.run(&inputs, &mut Vec::new()) else { return false };
        found.iter().zip(&self.needs).all(|(value, need)| need.is_met_by_enclosure(value) == Some(true))
    }

    /// Whether a proposed state is one at which they do.
    fn holds_in(&self, proposed: &Proposed) -> bool {
        let middle = |(symbol, low, high): &(Symbol, RBig, RBig)| (*symbol, (low + high) / RBig::from(2));
        let state: BTreeMap<Symbol, RBig> = proposed.iter().map(middle).collect();
        self.hold_at(&state)
    }

    /// Whether a state is drawn at which they do.
    fn is_somewhere(&self, system: &mut System, guards: &[Guard]) -> bool {
        let ranges = bounds(&mut system.graph, guards);
        // any fixed seed: the same file gives the same answer
        let mut rng = ChaCha8Rng::seed_from_u64(0x696e_7369);
        (0..STATES).any(|attempt| {
            let mut state = BTreeMap::new();
            for symbol in &self.symbols {
                let file = system.symbol_info(*symbol).and_then(|info| info.range.as_ref());
                let reach = [3.0, 1.0, 10.0, 0.25, 100.0][attempt % 5];
                let (mut low, mut high) = match file {
                    Some(range) if attempt % 3 == 0 => (range.low.clone(), range.high.clone()),
                    _ => (rational(-reach), rational(reach)),
                };
                if let Some(range) = ranges.get(symbol) {
                    let enclosed = range.interval();
                    let (least, most) = (enclosed.low(), enclosed.high());
                    match (least.is_finite(), most.is_finite()) {
                        (true, true) => (low, high) = (rational(least), rational(most)),
                        (true, false) => (low, high) = (rational(least), rational(least + reach)),
                        (false, true) => (low, high) = (rational(most - reach), rational(most)),
                        (false, false) => {}
                    }
                }
                let part = RBig::from(rng.random_range(1..=63)) / RBig::from(64);
                state.insert(*symbol, &low + (&high - &low) * part);
            }
            self.hold_at(&state)
        })
    }
}

fn rational(value: f64) -> RBig {
    rational_from_f64(value).unwrap_or(RBig::ZERO)
}

/// The sets on which thin parts may lie: where some expressions that are not to be negative vanish together. Nothing where there are too
/// many.
fn edges(system: &mut System, closed: &[NodeId], all: &[Guard]) -> Option<Vec<Vec<NodeId>>> {
    let mut found: Vec<Vec<NodeId>> = Vec::new();
    for (place, node) in closed.iter().enumerate() {
        if is_concave(system, *node) {
            continue;
        }
        if !has_no_greatest_value(system, *node, all) {
            found.push(vec![*node]);
            continue;
        }
        let symbols = system.graph.symbols_of([*node]);
        for (other_place, other) in closed.iter().enumerate().filter(|(_, other)| *other != node) {
            let shared = system.graph.symbols_of([*other]).iter().any(|symbol| symbols.contains(symbol));
            let pair = vec![closed[place.min(other_place)], closed[place.max(other_place)]];
            if shared && !found.contains(&pair) {
                found.push(pair);
            }
        }
    }
    (found.len() <= MOST_EDGES).then_some(found)
}

/// Whether an expression has nowhere a greatest value, as far as guards hold: a derivative that is not zero, or a second one in some
/// direction that is positive.
fn has_no_greatest_value(system: &mut System, node: NodeId, guards: &[Guard]) -> bool {
    let symbols = system.graph.symbols_of([node]);
    let is_smooth = !system.graph.reachable([node]).iter().any(|id| {
        matches!(system.graph.node(*id), Node::Apply(Function::Sqrt | Function::Asin | Function::Acos, _))
    });
    if !is_smooth {
        return false;
    }
    let not_zero: Vec<NodeId> = guards
        .iter()
        .filter(|guard| matches!(guard.need, Need::NotZero | Need::Positive))
        .map(|guard| guard.node)
        .collect();
    let slopes: Vec<NodeId> = symbols.iter().map(|symbol| system.partial(node, *symbol)).collect();
    let differs = |system: &System, slope: &NodeId| {
        sign(&system.graph, *slope).is_some_and(Sign::is_strict) || not_zero.contains(slope)
    };
    if slopes.iter().any(|slope| differs(system, slope)) {
        return true;
    }
    for (first, slope) in slopes.iter().enumerate() {
        let own = system.partial(*slope, symbols[first]);
        if sign(&system.graph, own) == Some(Sign::Positive) {
            return true;
        }
        for second in 0..first {
            let mixed = system.partial(*slope, symbols[second]);
            let other = system.partial(slopes[second], symbols[second]);
            let two = system.graph.integer(2);
            let twice = system.graph.mul(two, mixed);
            let both = system.graph.add(own, other);
            let along = [system.graph.add(both, twice), system.graph.sub(both, twice)];
            if along.iter().any(|bend| sign(&system.graph, *bend) == Some(Sign::Positive)) {
                return true;
            }
        }
    }
    false
}

/// Whether an expression is concave: a sum of terms of the first and second degree with constant second derivatives, the negative of which are
/// positive semidefinite.
fn is_concave(system: &mut System, node: NodeId) -> bool {
    let symbols = system.graph.symbols_of([node]);
    let mut negative: Vec<Vec<RBig>> = Vec::new();
    for first in &symbols {
        let slope = system.partial(node, *first);
        let mut row = Vec::new();
        for second in &symbols {
            let bend = system.partial(slope, *second);
            let constant = system.graph.constant_value(bend).cloned();
            row.push(match constant {
                Some(value) => -value,
                None if vanishes(system, bend) => RBig::ZERO,
                None => return false,
            });
        }
        negative.push(row);
    }
    // a derivative of a function with corners says nothing of the corners
    let has_functions = system.graph.reachable([node]).iter().any(
        |id| matches!(system.graph.node(*id), Node::Apply(_, a) if !system.graph.symbols_of([a]).is_empty()),
    );
    !has_functions && is_semidefinite(negative)
}

/// Whether a symmetric matrix is positive semidefinite, by elimination.
fn is_semidefinite(mut matrix: Vec<Vec<RBig>>) -> bool {
    let size = matrix.len();
    for step in 0..size {
        let pivot = matrix[step][step].clone();
        if pivot < RBig::ZERO {
            return false;
        }
        if pivot.is_zero() {
            // a row of a semidefinite matrix with a zero on the diagonal is zero
            if matrix[step][step..].iter().any(|value| !value.is_zero()) {
                return false;
            }
            continue;
        }
        let top = matrix[step].clone();
        for row in matrix.iter_mut().skip(step + 1) {
            let factor = &row[step] / &pivot;
            for (value, above) in row.iter_mut().zip(&top).skip(step) {
                *value -= &factor * above;
            }
        }
    }
    true
}
