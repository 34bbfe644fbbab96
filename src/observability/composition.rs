//! How many steps of a system in discrete time show all that is ever seen: its rows are `dh, d(h o F), d(h o F o F), ...`.
//!
//! Let `E_k` be the span of the first `k` of them, with functions as coefficients. The next one is that of `dh` and of `F* E_k`,
//! so that a span that has rested once rests for good, provided that the coefficients have values after a step: that is so where
//! `F` is *dominant*, its images no thin set. A minor of its Jacobian by states and known signals that does not vanish modulo a
//! prime shows that. Of `x+ = 0, y+ = 1, z+ = x, w+ = z/y` with outputs `x y`, `x z` and `w` the span rests after one step, for `z/y` is
//! `x z/(x y)`, and grows at the next, which shows `x`: the image has `x = 0`, where that quotient has no value.
//!
//! Whatever `F` is, the closures of its images shrink at most so often as they lose dimensions, and on the last of them it is
//! dominant. Images of all states lose one dimension at each of `m` steps, and what is left has `n - m`: with `n` steps taken, the
//! span rests. A set that is mapped into itself shrinks no more than `n` times either; its rows have `n` columns: `2 n` steps.
//!
//! Reference: J. Nijmeijer, *Observability of autonomous discrete time non-linear systems*, Int. J. Control 36 (1982), for the
//! spans; the argument on images is that of dimensions of irreducible sets.

use super::needed::{CodistributionError, needed};
use crate::expression::{NodeId, gradient};
use crate::system::{Assignment, System, Time};

/// After how many steps a rank that rests has stopped for good.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Steps {
    /// Not before so many were taken; none, where one rest suffices.
    pub at_least: usize,
    /// The rank rests after so many at the latest.
    pub most: usize,
}

/// The steps that a system in discrete time needs where the conditions are met; nothing in continuous time.
pub(super) fn steps(
    system: &mut System,
    conditions: &Assignment,
) -> Result<Option<Steps>, CodistributionError> {
    if system.time == Time::Continuous {
        return Ok(None);
    }
    let dimension = system.closed_coordinates().len();
    let states = system.states.clone();
    let on_a_set = conditions.iter().any(|(symbol, value)| {
        let mentioned = system.graph.symbols_of([*value]);
        states.contains(symbol) || states.iter().any(|state| mentioned.contains(state))
    });
    Ok(Some(match on_a_set {
        true => Steps { at_least: 2 * dimension, most: 2 * dimension + 1 },
        false if is_dominant(system, conditions)? => Steps { at_least: 0, most: dimension + 1 },
        false => Steps { at_least: dimension, most: dimension + 1 },
    }))
}

/// Whether the images of the drift are certainly no thin set: its Jacobian by the states and the known signals has full rank.
fn is_dominant(system: &mut System, conditions: &Assignment) -> Result<bool, CodistributionError> {
    let moved = system.closed_coordinates();
    let Some(drift) = system.drift() else { return Ok(true) };
    let successors: Vec<NodeId> = moved
        .iter()
        .map(|state| {
            let now = system.graph.symbol(*state);
            system.lie_derivative(drift, now)
        })
        .collect();
    let mut by = moved.clone();
    by.extend(system.known_signals());
    let rows: Vec<Vec<NodeId>> =
        successors.into_iter().map(|value| gradient(&mut system.graph, value, &by)).collect();
    if rows.is_empty() {
        return Ok(true);
    }
    let (kept, guessed) = needed(system, &rows, conditions)?;
    Ok(!guessed && kept.len() == moved.len())
}
