//! Conditions on one sine or cosine, `a sin(u)^2 + b sin(u) + c = 0` with constants `a`, `b` and `c`, solved for an angle.

use super::turns::turns_do_not_matter;
use super::vanishing::{
    all_vanish, enclosed_constant, inside_no_function, is_a_constant_but_zero, vanishes, vanishes_as_numbers,
};
use super::way::Way;
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{Node, NodeId, Symbol};
use palmistry_math::number::{Arithmetic, Enclosures, Function};
use std::collections::HashMap;

/// An angle is solved for from sines of multiples up to this.
const LARGEST_MULTIPLE: i64 = 12;
/// Angles are written as multiples of pi over numbers up to this, where they are such.
const MOST_PARTS: u32 = 120;
/// And only where they have no more operations.
const LONGEST_ANGLE: usize = 100;

/// A sine or cosine and the constants, one of which it has to be; solved for an angle. All angles with such a sine differ from
/// the values by whole turns.
pub(super) fn circular(system: &mut System, difference: NodeId) -> Option<Way> {
    let (function, argument, values) = sine_or_cosine(system, difference)?;
    let zero = system.graph.integer(0);
    for symbol in system.graph.symbols_of([argument]) {
        if !system.is_angle(symbol) {
            continue;
        }
        let slope = system.partial(argument, symbol);
        let Some(slope) = system.graph.constant_value(slope).filter(|slope| !slope.is_zero()).cloned() else {
            continue;
        };
        let top = i64::try_from(IBig::clone(slope.numerator())).ok()?.abs();
        let rest = system.graph.substitute(&[argument], &Assignment::from([(symbol, zero)]))[0];
        let factor = system.graph.rational(slope.clone());
        let line = system.graph.symbol(symbol);
        let line = system.graph.mul(factor, line);
        let whole = system.graph.add(line, rest);
        let rest_of_it = system.graph.sub(argument, whole);
        if top > LARGEST_MULTIPLE
            || !inside_no_function(system, argument, symbol)
            || !vanishes_as_numbers(system, rest_of_it)
            || !whole_turns_of_others_are_none(system, argument, rest, &slope)
        {
            continue;
        }
        let mut found = Vec::new();
        for root in roots(system, function, &values)? {
            // slope symbol + rest = root + 2 pi k
            for turn in 0..top {
                let two_pi = system.graph.pi();
                let turn = system.graph.integer(2 * turn);
                let turns = system.graph.mul(two_pi, turn);
                let turned = system.graph.add(root, turns);
                let moved = system.graph.sub(turned, rest);
                let value = if slope.is_one() {
                    moved
                } else if slope == RBig::from(-1) {
                    system.graph.neg(moved)
                } else {
                    system.graph.div(moved, factor)
                };
                let value = in_parts_of_pi(system, value);
                if !found.contains(&value) {
                    found.push(value);
                }
            }
        }
        return Some(match found.is_empty() {
            true => Way::Factors(found),
            false => Way::Turns(symbol, found),
        });
    }
    None
}

/// Whether each other angle has whole turns that make whole turns of the argument: else an angle that is solved for later, up
/// to whole turns, would leave out some values of this one.
fn whole_turns_of_others_are_none(system: &mut System, argument: NodeId, rest: NodeId, slope: &RBig) -> bool {
    let mut others: Vec<Symbol> = system.graph.symbols_of([rest]);
    others.retain(|symbol| system.is_angle(*symbol));
    if others.is_empty() {
        return true;
    }
    let wave = system.graph.apply(Function::Cos, argument);
    slope.denominator().is_one()
        && others.into_iter().all(|angle| turns_do_not_matter(system, &[wave], angle))
}

/// The angles between minus a whole turn and a whole one with one of these sines or cosines, each up to whole turns; nothing
/// where that is not known.
fn roots(system: &mut System, function: Function, values: &[NodeId]) -> Option<Vec<NodeId>> {
    let mut found = Vec::new();
    for value in values {
        let one = system.graph.integer(1);
        let (below, above) = (system.graph.sub(one, *value), system.graph.add(one, *value));
        let enclosed = enclosed_constant(system, *value)?;
        if enclosed.low() > RBig::ONE || enclosed.high() < RBig::from(-1) {
            continue;
        }
        let edge = [(below, 1), (above, -1)].into_iter().find(|(gap, _)| vanishes(system, *gap));
        let principal = match edge {
            Some((_, sign)) => {
                let sign = system.graph.integer(sign);
                quarter(system, function, sign)?
            }
            None if enclosed.low() > RBig::from(-1) && enclosed.high() < RBig::ONE => {
                quarter(system, function, *value)?
            }
            None => return None,
        };
        let pi = system.graph.pi();
        let other = match function {
            Function::Sin => system.graph.sub(pi, principal),
            _ => system.graph.neg(principal),
        };
        for root in [principal, other] {
            let root = in_parts_of_pi(system, root);
            if !found.contains(&root) && (edge.is_none() || root == in_parts_of_pi(system, principal)) {
                found.push(root);
            }
        }
    }
    Some(found)
}

/// The inverse sine or cosine of a constant: a multiple of pi where it is one.
fn quarter(system: &mut System, function: Function, value: NodeId) -> Option<NodeId> {
    let undoes = if function == Function::Sin { Function::Asin } else { Function::Acos };
    let inverse = system.graph.apply(undoes, value);
    let numbers = Enclosures::new(256);
    let ratio = enclosed_constant(system, value)
        .and_then(|value| numbers.apply(undoes, &value).ok())
        .and_then(|angle| numbers.div(&angle, &numbers.pi().ok()?).ok());
    let guess = match ratio {
        Some(ratio) if ratio.low() == ratio.high() => ratio.low(),
        Some(ratio) => RBig::simplest_in(ratio.low(), ratio.high()),
        None => return Some(inverse),
    };
    if u32::try_from(guess.denominator().clone()).is_ok_and(|parts| parts <= MOST_PARTS) {
        let pi = system.graph.pi();
        let guess = system.graph.rational(guess);
        let angle = system.graph.mul(guess, pi);
        let difference = system.graph.sub(inverse, angle);
        if all_vanish(system, &[difference]) {
            return Some(in_parts_of_pi(system, angle));
        }
    }
    Some(inverse)
}

/// A rational multiple of pi in one way: what it is called does not depend on how it was found.
fn in_parts_of_pi(system: &mut System, angle: NodeId) -> NodeId {
    // what was made here of a few numbers
    if !system.graph.symbols_of([angle]).is_empty() || system.graph.reachable([angle]).len() > LONGEST_ANGLE {
        return angle;
    }
    let Some(factor) = factor_of_pi(system, angle) else { return angle };
    let two = RBig::from(2);
    // between minus pi and pi
    let turns = (&factor / &two + RBig::from_parts(1.into(), 2u8.into())).ceil() - IBig::ONE;
    let factor = factor - RBig::from(turns) * two;
    let pi = system.graph.pi();
    let top = system.graph.rational(RBig::from(factor.numerator().clone()));
    let top = system.graph.mul(top, pi);
    let bottom = system.graph.rational(RBig::from(IBig::from(factor.denominator().clone())));
    system.graph.div(top, bottom)
}

/// How many times pi a sum of rational multiples of pi is. Each node once: an angle may hold one node many times.
fn factor_of_pi(system: &System, angle: NodeId) -> Option<RBig> {
    let graph = &system.graph;
    let mut factors: HashMap<NodeId, RBig> = HashMap::new();
    for id in graph.reachable([angle]) {
        let of = |node| factors.get(&node).cloned();
        let number = |node| graph.constant_value(node).cloned();
        let factor = match graph.node(id) {
            Node::Pi => Some(RBig::ONE),
            Node::Constant(_) => number(id).filter(RBig::is_zero),
            Node::Neg(a) => of(a).map(|a| -a),
            Node::Add(a, b) => of(a).zip(of(b)).map(|(a, b)| a + b),
            Node::Sub(a, b) => of(a).zip(of(b)).map(|(a, b)| a - b),
            Node::Mul(a, b) => match number(a) {
                Some(factor) => of(b).map(|b| factor * b),
                None => of(a).zip(number(b)).map(|(a, b)| a * b),
            },
            Node::Div(a, b) => of(a).zip(number(b).filter(|b| !b.is_zero())).map(|(a, b)| a / b),
            _ => None,
        };
        if let Some(factor) = factor {
            factors.insert(id, factor);
        }
    }
    factors.remove(&angle)
}

/// The sine or cosine whose values alone decide whether an expression vanishes, and those at which it does.
fn sine_or_cosine(system: &mut System, difference: NodeId) -> Option<(Function, NodeId, Vec<NodeId>)> {
    let all = system.graph.reachable([difference]);
    let mut waves = all.iter().filter_map(|id| match system.graph.node(*id) {
        Node::Apply(function @ (Function::Sin | Function::Cos), argument)
            if !system.graph.symbols_of([argument]).is_empty() =>
        {
            Some((*id, function, argument))
        }
        _ => None,
    });
    let (wave, function, argument) = waves.next().filter(|_| waves.next().is_none())?;
    // no name of a file begins like this
    let unknown = system.graph.intern("#wave");
    let place = system.graph.symbol(unknown);
    let mut image = HashMap::from([(wave, place)]);
    for id in all {
        if !image.contains_key(&id) {
            let node = system.graph.node(id);
            let new = system.graph.rebuild(node, |operand| image[&operand]);
            image.insert(id, new);
        }
    }
    let polynomial = image[&difference];
    if system.graph.symbols_of([polynomial]) != [unknown] || !inside_no_function(system, polynomial, unknown)
    {
        return None;
    }
    let slope = system.partial(polynomial, unknown);
    let bend = system.partial(slope, unknown);
    let third = system.partial(bend, unknown);
    if !vanishes(system, third) {
        return None;
    }
    let zero = system.graph.integer(0);
    let at_zero = Assignment::from([(unknown, zero)]);
    let mut coefficients = system.graph.substitute(&[polynomial, slope, bend], &at_zero);
    let (bend, slope, value) = (coefficients.pop()?, coefficients.pop()?, coefficients.pop()?);
    Some((function, argument, vanishing_at(system, bend, slope, value)?))
}

/// Where `bend s^2/2 + slope s + value` vanishes, for constants.
fn vanishing_at(system: &mut System, bend: NodeId, slope: NodeId, value: NodeId) -> Option<Vec<NodeId>> {
    if vanishes(system, bend) {
        if !is_a_constant_but_zero(system, slope) {
            return None;
        }
        let quotient = system.graph.div(value, slope);
        return Some(vec![system.graph.neg(quotient)]);
    }
    if !is_a_constant_but_zero(system, bend) {
        return None;
    }
    // s = (-slope +- sqrt(slope^2 - 2 bend value))/bend
    let two = system.graph.integer(2);
    let square = system.graph.power(slope, 2);
    let product = system.graph.mul(bend, value);
    let product = system.graph.mul(two, product);
    let discriminant = system.graph.sub(square, product);
    let back = system.graph.neg(slope);
    if vanishes(system, discriminant) {
        return Some(vec![system.graph.div(back, bend)]);
    }
    let enclosed = enclosed_constant(system, discriminant)?;
    if enclosed.high() < RBig::ZERO {
        return Some(Vec::new());
    }
    if enclosed.low() <= RBig::ZERO {
        return None;
    }
    let root = system.graph.apply(Function::Sqrt, discriminant);
    let (first, second) = (system.graph.add(back, root), system.graph.sub(back, root));
    Some(vec![system.graph.div(first, bend), system.graph.div(second, bend)])
}
