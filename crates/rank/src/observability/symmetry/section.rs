//! Coordinates as expressions in the observable functions, on a section: some coordinates, as many as there are unobservable
//! directions, are given constant values, as one counts in units in which `K = 1`.
//!
//! Where unobservable motions take a state to the section, no observable function changes on the way; so what the functions say
//! there of rates and outputs they say everywhere. Whether it is so is proved of the result.

use super::answer::{ObservableFunction, UnseenBlock};
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{NodeId, Symbol};

/// No more choices of constant coordinates are tried than this.
const MOST_CHOICES: usize = 3000;

/// The values of a block's states on sections, in terms of names for its functions, the shortest first. `names` are the new
/// symbols of the functions.
pub(super) fn sections(
    system: &mut System,
    block: &UnseenBlock,
    functions: &[ObservableFunction],
    names: &[Symbol],
    most: usize,
) -> Vec<Assignment> {
    let mut found: Vec<(usize, Assignment)> = Vec::new();
    let mut tried = 0;
    // how many of the fixed coordinates are nought, and which: scalings want a one, translations a nought, angles always that
    for fixed in subsets(block.states.len(), block.unobservable) {
        let free: Vec<usize> =
            fixed.iter().copied().filter(|at| !system.is_angle(block.states[*at])).collect();
        for zeros in 0..1usize << free.len().min(6) {
            tried += 1;
            if tried > MOST_CHOICES {
                break;
            }
            let mut values = Assignment::new();
            for at in &fixed {
                let symbol = block.states[*at];
                let is_zero = match free.iter().position(|other| other == at) {
                    None => true,
                    Some(place) => zeros >> place.min(5) & 1 == 1,
                };
                values.insert(symbol, system.graph.integer(if is_zero { 0 } else { 1 }));
            }
            if let Some(solved) = solve(system, block, functions, names, values) {
                let values: Vec<NodeId> = block.states.iter().map(|state| solved[state]).collect();
                found.push((system.graph.reachable(values).len(), solved));
            }
        }
    }
    found.sort_by_key(|(size, _)| *size);
    found.into_iter().map(|(_, solved)| solved).take(most).collect()
}

/// All sets of so many of the first places, each in order.
fn subsets(places: usize, size: usize) -> Vec<Vec<usize>> {
    let mut found: Vec<Vec<usize>> = vec![Vec::new()];
    for _ in 0..size {
        let longer = |set: &Vec<usize>| {
            let begin = set.last().map_or(0, |last| last + 1);
            (begin..places).map(|place| [set.as_slice(), &[place]].concat()).collect::<Vec<_>>()
        };
        found = found.iter().flat_map(longer).take(MOST_CHOICES).collect();
    }
    found
}

/// Solves function after function, each for the one state that is left in it.
fn solve(
    system: &mut System,
    block: &UnseenBlock,
    functions: &[ObservableFunction],
    names: &[Symbol],
    mut values: Assignment,
) -> Option<Assignment> {
    let mut open: Vec<(&ObservableFunction, Symbol)> = functions.iter().zip(names.iter().copied()).collect();
    while !open.is_empty() {
        let mut solved = None;
        for (place, (function, name)) in open.iter().enumerate() {
            let factors: Vec<NodeId> = function.factors.iter().map(|(factor, _)| *factor).collect();
            let factors = system.graph.substitute(&factors, &values);
            let left: Vec<Symbol> = system
                .graph
                .symbols_of(factors.iter().copied())
                .into_iter()
                .filter(|symbol| block.states.contains(symbol) && !values.contains_key(symbol))
                .collect();
            if let [state] = left[..] {
                let powers: Vec<i32> = function.factors.iter().map(|(_, power)| *power).collect();
                if let Some(value) = solve_for(system, &factors, &powers, state, *name) {
                    solved = Some((place, state, value));
                    break;
                }
            }
        }
        let (place, state, value) = solved?;
        open.remove(place);
        values.insert(state, value);
    }
    (values.len() == block.states.len()).then_some(values)
}

/// The state that makes a product of powers equal to a symbol, where it stands linearly in one factor of power one.
fn solve_for(
    system: &mut System,
    factors: &[NodeId],
    powers: &[i32],
    state: Symbol,
    name: Symbol,
) -> Option<NodeId> {
    let mentions = |system: &System, node: NodeId| system.graph.symbols_of([node]).contains(&state);
    let with: Vec<usize> = (0..factors.len()).filter(|at| mentions(system, factors[*at])).collect();
    let [at] = with[..] else { return None };
    let slope = system.partial(factors[at], state);
    if powers[at].abs() != 1 || mentions(system, slope) {
        return None;
    }
    let zero = system.graph.integer(0);
    let rest = system.graph.substitute(&[factors[at]], &Assignment::from([(state, zero)]))[0];
    let mut value = system.graph.symbol(name);
    for (other, (factor, power)) in factors.iter().zip(powers).enumerate() {
        if other != at {
            let factor = system.graph.power(*factor, *power);
            value = system.graph.div(value, factor);
        }
    }
    let value = system.graph.power(value, powers[at]);
    let top = system.graph.sub(value, rest);
    let is_zero = system.graph.constant_value(slope).is_some_and(|value| value.is_zero());
    (!is_zero).then(|| system.graph.div(top, slope))
}
