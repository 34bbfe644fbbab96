//! One condition, solved: for a name, for a symbol in which it is linear, for an angle whose sine or cosine is known, or
//! split into its factors.

use super::circular::circular;
use super::sampled::{changes_its_sign, has_both_signs};
use super::vanishing::{
    all_vanish, enclosed_constant, inside_no_function, is_a_constant_but_zero, test, vanishes,
};
use super::way::{Apart, Way};
use dashu::rational::RBig;
use palmistry_inequality::{Given, holds_by_signs};
use palmistry_lang::{Assignment, Kind, System};
use palmistry_math::expression::{
    Guard, Need, Node, NodeId, Program, Sign, Symbol, ZeroTest, expand_angles, share_a_factor, sign,
    sign_given,
};
use palmistry_math::number::Function;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::HashMap;

/// Longer expressions are not asked whether they are nowhere negative.
const LONGEST_TOUCHING: usize = 60;

/// The way to meet `left = right`.
pub(super) fn way(system: &mut System, left: NodeId, right: NodeId, guards: &[Guard]) -> Way {
    let difference = system.graph.sub(left, right);
    match circular(system, difference) {
        Some(way) if system.graph.as_symbol(left).or(system.graph.as_symbol(right)).is_none() => way,
        _ => way_apart_from_turns(system, left, right, guards),
    }
}

/// The way to meet `left = right` for what is no angle, where guards hold.
pub(super) fn way_apart_from_turns(
    system: &mut System,
    left: NodeId,
    right: NodeId,
    guards: &[Guard],
) -> Way {
    // a name on one side, not met on the other
    for (name, value) in [(left, right), (right, left)] {
        if let Some(symbol) = system.graph.as_symbol(name)
            && !system.graph.symbols_of([value]).contains(&symbol)
        {
            return Way::Value(symbol, value);
        }
    }
    let mut pairs = vec![(left, right), (right, left)];
    if let (Node::Sub(a, b), true) =
        (system.graph.node(left), system.graph.constant_value(right).is_some_and(|value| value.is_zero()))
    {
        pairs.extend([(a, b), (b, a)]);
    }
    if let Some(inner) = pairs.into_iter().find_map(|(one, other)| undone(system, one, other)) {
        return Way::Factors(vec![inner]);
    }
    let difference = system.graph.sub(left, right);
    if let Some(terms) = terms_of_one_sign(system, difference, guards) {
        return Way::All(terms);
    }
    // states before parameters, in the order of the file, so that the answer does not depend on anything else
    let mut candidates = system.states.clone();
    candidates
        .extend(system.symbols().filter(|(_, info)| info.kind != Kind::State).map(|(symbol, _)| symbol));
    let mentioned = system.graph.symbols_of([difference]);
    candidates.retain(|symbol| !system.is_angle(*symbol) && mentioned.contains(symbol));
    let mut best = factors(system, difference).map_or(Way::Unknown, Way::Factors);
    for symbol in candidates {
        let Some(line) = Line::of(system, difference, symbol) else { continue };
        let slope_sign = sign(&system.graph, line.slope);
        let found = if slope_sign.is_some_and(|sign| sign.is_strict())
            || is_a_constant_but_zero(system, line.slope)
            || never_vanishes(system, line.slope, guards)
        {
            Way::Value(symbol, line.root)
        } else {
            let apart = if has_unknown_function(system, &[line.slope, line.rest]) {
                Apart::NotKnown
            } else if also_met_otherwise(system, difference, symbol) {
                Apart::Shared
            } else {
                Apart::Coprime
            };
            Way::Linear { symbol, value: line.root, slope: line.slope, rest: line.rest, apart }
        };
        if found.rank() < best.rank() {
            best = found;
        }
        if best.rank() == 0 {
            break;
        }
    }
    best
}

/// The terms of a sum of at least two, none of which is negative where guards hold, or none positive: each of them vanishes where the sum
/// does.
fn terms_of_one_sign(system: &mut System, sum: NodeId, guards: &[Guard]) -> Option<Vec<NodeId>> {
    let mut known = HashMap::new();
    for guard in guards {
        let sign = match guard.need {
            Need::Positive => Sign::Positive,
            Need::NotNegative => Sign::NotNegative,
            Need::NotZero | Need::WithinOne | Need::InsideOne => continue,
        };
        known.insert(guard.node, sign);
        known.insert(system.graph.neg(guard.node), sign.negated());
    }
    let (mut open, mut found, mut upward) = (vec![(sum, true)], Vec::new(), None);
    while let Some((node, as_it_is)) = open.pop() {
        match system.graph.node(node) {
            Node::Add(a, b) => open.extend([(b, as_it_is), (a, as_it_is)]),
            Node::Sub(a, b) => open.extend([(b, !as_it_is), (a, as_it_is)]),
            Node::Neg(a) => open.push((a, !as_it_is)),
            _ => {
                let is_upward = sign_given(&system.graph, node, &known)?.is_upward() == as_it_is;
                if *upward.get_or_insert(is_upward) != is_upward {
                    return None;
                }
                found.push(node);
            }
        }
    }
    (found.len() > 1).then_some(found)
}

/// Whether an expression is a product of factors each of which is among those of what guards keep from zero.
fn never_vanishes(system: &System, expression: NodeId, guards: &[Guard]) -> bool {
    let kept = guards.iter().filter(|guard| matches!(guard.need, Need::NotZero | Need::Positive));
    let kept: Vec<NodeId> = kept.flat_map(|guard| whole_factors(system, guard.node)).collect();
    whole_factors(system, expression).into_iter().all(|factor| {
        sign(&system.graph, factor).is_some_and(|sign| sign.is_strict())
            || is_a_constant_but_zero(system, factor)
            || kept.contains(&factor)
    })
}

/// The factors of a product, of quotients those above; where an expression vanishes one of these does.
fn whole_factors(system: &System, expression: NodeId) -> Vec<NodeId> {
    let (mut open, mut found) = (vec![expression], Vec::new());
    while let Some(node) = open.pop() {
        match system.graph.node(node) {
            Node::Mul(a, b) => open.extend([b, a]),
            Node::Neg(a) | Node::Div(a, _) => open.push(a),
            Node::Power(a, n) if n > 0 => open.push(a),
            Node::Power(_, n) if n < 0 => {}
            _ => found.push(node),
        }
    }
    found
}

/// Whether signs show that `left = right` is met nowhere.
pub(super) fn is_nowhere_zero(system: &mut System, left: NodeId, right: NodeId, guards: &[Guard]) -> bool {
    let difference = system.graph.sub(left, right);
    let is_angle = system.angle_test();
    system.graph.reachable([difference]).len() <= LONGEST_TOUCHING
        && !changes_its_sign(system, difference, guards)
        && holds_by_signs(
            &mut system.graph,
            Guard { node: difference, need: Need::NotZero },
            Given { assumed: guards, ..Given::default() },
            &is_angle,
        )
}

/// The factors of `left - right` where it is written as a product.
pub(super) fn factors_of(system: &mut System, left: NodeId, right: NodeId) -> Option<Vec<NodeId>> {
    let difference = system.graph.sub(left, right);
    factors(system, difference)
}

/// The way to meet `left = right` where one side is nowhere greater than the other: there the derivatives of the difference vanish too.
pub(super) fn touching(system: &mut System, left: NodeId, right: NodeId) -> Way {
    let difference = system.graph.sub(left, right);
    let symbols = system.graph.symbols_of([difference]);
    let has_corners = system.graph.reachable([difference]).iter().any(|id| {
        matches!(system.graph.node(*id), Node::Apply(Function::Sqrt | Function::Asin | Function::Acos, _))
    });
    let is_too_long = system.graph.reachable([difference]).len() > LONGEST_TOUCHING;
    if has_corners || is_too_long || has_both_signs(system, difference) {
        return Way::Unknown;
    }
    let is_angle = system.angle_test();
    let back = system.graph.neg(difference);
    let touches = [difference, back].into_iter().any(|node| {
        let goal = Guard { node, need: Need::NotNegative };
        holds_by_signs(&mut system.graph, goal, Given::default(), &is_angle)
    });
    if !touches {
        return Way::Unknown;
    }
    Way::Touching(symbols.into_iter().map(|symbol| system.partial(difference, symbol)).collect())
}

/// What vanishes where a function that takes no value twice has this value: `u - v` for `exp(u) = exp(v)`, `u - log(c)` for
/// `exp(u) = c` where `c` is positive, `u - exp(v)` for `log(u) = v`.
fn undone(system: &mut System, left: NodeId, right: NodeId) -> Option<NodeId> {
    let Node::Apply(function, argument) = system.graph.node(left) else { return None };
    // of a constant there is nothing to undo: it would come back as what it was, without end
    if system.graph.symbols_of([argument]).is_empty() {
        return None;
    }
    let value = match (function, system.graph.node(right)) {
        (Function::Sin | Function::Cos, _) => return None,
        (_, Node::Apply(other, inner)) if function == other => inner,
        (Function::Exp, _) if is_positive(system, right) => system.graph.apply(Function::Log, right),
        (Function::Log, _) => system.graph.apply(Function::Exp, right),
        _ => return None,
    };
    Some(system.graph.sub(argument, value))
}

fn is_positive(system: &System, expression: NodeId) -> bool {
    let constant = enclosed_constant(system, expression);
    sign(&system.graph, expression) == Some(Sign::Positive)
        || constant.is_some_and(|value| value.low() > RBig::ZERO)
}

/// Whether a function other than the sine or cosine of an angle is met.
fn has_unknown_function(system: &mut System, expressions: &[NodeId]) -> bool {
    let is_angle = &system.angle_test();
    let expanded = expand_angles(&mut system.graph, expressions, is_angle);
    Program::with_unknown_functions(&system.graph, &expanded, is_angle)
        .unknown_function(&system.graph)
        .is_some()
}

/// The factors of an expression that is written as a product; its own powers and roots vanish where their bases do.
fn factors(system: &System, expression: NodeId) -> Option<Vec<NodeId>> {
    let (mut open, mut found, mut apart) = (vec![expression], Vec::new(), false);
    while let Some(node) = open.pop() {
        match system.graph.node(node) {
            Node::Mul(a, b) => open.extend([b, a]),
            // what is divided by is a guard of the condition
            Node::Neg(a) | Node::Div(a, _) => open.push(a),
            Node::Power(a, n) if n > 0 => open.push(a),
            Node::Apply(Function::Sqrt | Function::Atan | Function::Asin, a) => open.push(a),
            _ => {
                let never = sign(&system.graph, node).is_some_and(|sign| sign.is_strict());
                if !never && !found.contains(&node) {
                    found.push(node);
                }
                continue;
            }
        }
        apart = true;
    }
    apart.then_some(found)
}

/// Whether an expression `a x + b` has a factor that does not depend on `x`: then it vanishes with that factor too, and
/// `x = -b/a` is not all.
pub fn also_met_otherwise(system: &mut System, expression: NodeId, symbol: Symbol) -> bool {
    let slope = system.partial(expression, symbol);
    let zero = system.graph.integer(0);
    let both = system.graph.substitute(&[slope, expression], &Assignment::from([(symbol, zero)]));
    let is_angle = &system.angle_test();
    let both = expand_angles(&mut system.graph, &both, is_angle);
    let mut rng = ChaCha8Rng::seed_from_u64(0x6c69_6e65);
    share_a_factor(&system.graph, both[0], both[1], is_angle, &mut rng) != Some(false)
}

/// An expression that is `slope symbol + rest`, the slope not zero identically.
struct Line {
    slope: NodeId,
    rest: NodeId,
    /// `-rest/slope`
    root: NodeId,
}

impl Line {
    fn of(system: &mut System, expression: NodeId, symbol: Symbol) -> Option<Line> {
        // `atan(tan(y))` has the derivative one, and is not y
        if !inside_no_function(system, expression, symbol) {
            return None;
        }
        let slope = system.partial(expression, symbol);
        let bend = system.partial(slope, symbol);
        if vanishes(system, slope) || !vanishes(system, bend) {
            return None;
        }
        let zero = system.graph.integer(0);
        let at_zero = Assignment::from([(symbol, zero)]);
        // both at symbol = 0: a linear expression is its value there plus its slope there times the symbol
        let both = system.graph.substitute(&[expression, slope], &at_zero);
        let value_is_finite =
            matches!(test(system, &both[..1]), ZeroTest::Zero { .. } | ZeroTest::Nonzero(_));
        if !value_is_finite || !matches!(test(system, &both[1..]), ZeroTest::Nonzero(_)) {
            return None;
        }
        let quotient = system.graph.div(both[0], both[1]);
        let root = system.graph.neg(quotient);
        let value = system.graph.substitute(&[expression], &Assignment::from([(symbol, root)]))[0];
        all_vanish(system, &[value]).then_some(Line { slope: both[1], rest: both[0], root })
    }
}

/// The root of an expression that is linear in a symbol, confirmed by putting it in.
pub fn linear_solution(system: &mut System, expression: NodeId, symbol: Symbol) -> Option<NodeId> {
    Line::of(system, expression, symbol).map(|line| line.root)
}
