//! At which order Lie derivatives stop. It is said here and nowhere else: for the rank at almost all states, under conditions and on
//! the sets of an exact answer, by expressions, by series and in discrete time.
//!
//! **What rests.** Let `E_k` be the span of the differentials `dL_w h` of all Lie derivatives of up to `k` fields, with functions of the state as
//! coefficients. From `dL_X h = L_X dh` and `L_X(a w) = (L_X a) w + a L_X w` follows `E_(k+1) = E_k + sum_X L_X E_k`: where
//! `E_(k+1) = E_k`, no later one is larger. Three things have to hold for that.
//!
//! 1. *The differentials are taken by all coordinates that move and are not measured all the time*: by the unknown ones **and** by
//!    those of which the initial condition alone is known ([`System::closed_coordinates`]). Let `z1' = z2, z2' = x, x' = 0` with output `z1`, both `z` known
//!    initially: by `x` alone the span has the dimensions 0, 0, 1. Once the span by all of them rests, the part by the unknown
//!    ones does, whichever columns are left out. Known signals need no column: their derivatives are known too, `L_X du` is a
//!    differential of such.
//! 2. *The states are those of an invariant set*, or almost all states of an irreducible one: along such a set `L_X a` needs the
//!    values of `a` on it and no others. The columns stay those of all coordinates.
//! 3. *The coefficients have values*: where a minor of `E_k` that has its rank does not vanish, or at almost all states.
//!
//! **Where the set is not invariant** a rank may rest and grow again. There the rank at almost all states *around* the set, again by all
//! coordinates that move, is a ceiling: rows that have it at a state of the set span the differentials of all Lie derivatives around it, with
//! coefficients that are analytic there, so that no longer one adds anything ([`Ceiling::Around`]). Below it `generic/orbit.rs` says up to which order
//! something can be added, where it can.
//!
//! **Each output by itself.** Along one trajectory the first derivative of an output that adds nothing to what was taken before is
//! the last of it that can, for the same reason: the equation is differentiated.
//!
//! **In discrete time** the rows are `dh, d(h o F), d(h o F o F), ...`, and `E_(k+1)` is spanned by `dh` and `F* E_k`. A span that has
//! rested once rests for good, provided that the coefficients have values after a step: that is so where `F` is *dominant*, its
//! images no thin set. A minor of its Jacobian by states and known signals that does not vanish modulo a
//! prime shows that. Of `x+ = 0, y+ = 1, z+ = x, w+ = z/y` with outputs `x y`, `x z` and `w` the span rests after one step, for `z/y` is
//! `x z/(x y)`, and grows at the next, which shows `x`: the image has `x = 0`, where that quotient has no value.
//!
//! Whatever `F` is, the closures of its images shrink at most so often as they lose dimensions, and on the last of them it is
//! dominant. Images of all states lose one dimension at each of `m` steps, so that `n - m` remain: with `n` steps taken, the
//! span rests. A set that is mapped into itself shrinks no more than `n` times either; its rows have `n` columns: `2 n` steps.
//!
//! References: A. Isidori, *Nonlinear Control Systems*, 3rd edition (1995), sections 1.7 to 1.9, for the smallest codistribution that fields keep
//! invariant and for regular points; H. Nijmeijer, *Observability of autonomous discrete time non-linear systems*, Int. J. Control 36 (1982), for
//! the spans in discrete time; the argument on images is that of dimensions of irreducible sets.

use super::conditions::vanishes;
use super::needed::{CodistributionError, needed};
use palmistry_lang::{Assignment, System, Time};
use palmistry_math::expression::{NodeId, gradient};

/// Why no longer Lie derivatives were taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The rank has reached the dimension of the state space.
    Full,
    /// The rank has reached that at almost all states around, which no state of the locus can exceed. Where values are
    /// their known initial conditions: that of the differentials by these too.
    Ceiling,
    /// One further order did not raise the rank.
    NoGrowth,
    /// The longest Lie derivative that was allowed.
    Order,
    /// There are more Lie derivatives of the next order than are worth taking.
    TooMany,
    /// No Lie derivatives were asked for.
    NotTaken,
    /// The user did not wait for longer ones.
    Interrupted,
}

/// What bounds a rank from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ceiling {
    /// The set is invariant: what has stopped growing has stopped for good.
    Rests,
    /// It need not be, and these are the ranks at almost all states around, with known initial conditions as unknown, and of the
    /// unknowns; a rank falls on a special set, and never rises.
    Around {
        /// That of all that moves.
        closed: usize,
        /// That of the unknowns.
        unknown: usize,
    },
}

/// Ranks of the differentials by *all coordinates that move*, of the Lie derivatives below an order and of those up to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RankGrowth {
    /// The order that was reached.
    pub order: usize,
    /// The rank with one order less.
    pub below: usize,
    /// The rank with this order.
    pub up_to: usize,
}

impl RankGrowth {
    /// Whether the last order has added nothing. On an invariant set no further one does, in continuous time.
    pub fn has_ended(self) -> bool {
        self.order > 0 && self.below == self.up_to
    }
}

/// After how many steps a rank that rests has stopped for good.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Steps {
    /// Not before so many were taken; none, where one rest suffices.
    at_least: usize,
    /// The rank rests after so many at the latest.
    most: usize,
}

/// When the Lie derivatives of a system are long enough, on the set that some conditions describe.
#[derive(Clone, Debug)]
pub(super) struct Saturation {
    /// How many coordinates the span is taken by, and how many of them are unknown.
    moving: usize,
    unknown: usize,
    ceiling: Ceiling,
    /// In discrete time.
    steps: Option<Steps>,
}

impl Saturation {
    /// Of a set with this ceiling.
    ///
    /// # Errors
    /// Where every state of it is a pole.
    pub fn new(
        system: &mut System,
        conditions: &Assignment,
        ceiling: Ceiling,
    ) -> Result<Saturation, CodistributionError> {
        Ok(Saturation {
            moving: system.closed_coordinates().len(),
            unknown: system.unknown_count(),
            ceiling,
            steps: steps(system, conditions)?,
        })
    }

    /// Whether the set is invariant.
    pub fn is_on_an_invariant_set(&self) -> bool {
        self.ceiling == Ceiling::Rests
    }

    /// How many orders are worth looking at, where `usual` are taken otherwise.
    pub fn longest(&self, usual: usize) -> usize {
        match self.steps {
            _ if !self.is_on_an_invariant_set() => self.moving,
            Some(steps) => steps.most.max(usual),
            None => usual,
        }
    }

    /// Why longer Lie derivatives than those up to an order are not needed, if they are not: `unknown` is the rank of the unknowns' columns.
    pub fn stop(&self, growth: RankGrowth, unknown: usize) -> Option<Stop> {
        let ceiling = match self.ceiling {
            Ceiling::Rests => self.moving,
            Ceiling::Around { closed, .. } => closed,
        };
        let at_least = self.steps.map_or(0, |steps| steps.at_least);
        if unknown == self.unknown {
            Some(Stop::Full)
        } else if growth.up_to == ceiling {
            Some(Stop::Ceiling)
        } else if self.is_on_an_invariant_set() && growth.order > at_least && growth.has_ended() {
            Some(Stop::NoGrowth)
        } else {
            None
        }
    }
}

/// After how many steps a span by so many coordinates rests in discrete time, whatever the map is: from almost all states, or from those
/// of a set.
pub(super) fn most_steps(coordinates: usize, on_a_set: bool) -> usize {
    if on_a_set { 2 * coordinates } else { coordinates }
}

/// The steps that a system in discrete time needs where the conditions are met; nothing in continuous time.
fn steps(system: &mut System, conditions: &Assignment) -> Result<Option<Steps>, CodistributionError> {
    if system.time == Time::Continuous {
        return Ok(None);
    }
    let dimension = system.closed_coordinates().len();
    let states = system.states.clone();
    let on_a_set = conditions.iter().any(|(symbol, value)| {
        let mentioned = system.graph.symbols_of([*value]);
        states.contains(symbol) || states.iter().any(|state| mentioned.contains(state))
    });
    let at_least = match on_a_set {
        false if is_dominant(system, conditions)? => 0,
        _ => most_steps(dimension, on_a_set),
    };
    Ok(Some(Steps { at_least, most: most_steps(dimension, on_a_set) + 1 }))
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

/// Whether the drift and every input are tangent to the set that the conditions describe: `L_X (x - value) = 0` on it.
pub(super) fn is_invariant(system: &mut System, conditions: &Assignment) -> bool {
    // of the last derivative of a signal that outputs tie, the rate is not that of the field
    let counts = |(symbol, _): &(&palmistry_math::expression::Symbol, &NodeId)| !system.is_cut_off(**symbol);
    let mut solved: Vec<_> =
        conditions.iter().filter(counts).map(|(symbol, value)| (*symbol, *value)).collect();
    solved.sort_unstable();
    solved.into_iter().all(|(symbol, value)| {
        let left = system.graph.symbol(symbol);
        let difference = system.graph.sub(left, value);
        system.moving_fields().into_iter().all(|field| {
            let rate = system.lie_derivative(field, difference);
            let on_the_set = system.graph.substitute(&[rate], conditions)[0];
            vanishes(system, on_the_set)
        })
    })
}
