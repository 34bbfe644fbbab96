//! What is observable at almost all states: the rank of the observability codistribution, and whether each unknown is observable, by power series
//! modulo a prime. No Lie derivatives are formed, and nothing is written out: the cost grows with a power of the number of unknowns.
//!
//! From a random state, with random series for the inputs, the outputs' derivatives and their differentials are computed in residues
//! ([`equations`], [`covectors`]). Their span is that of all Lie derivatives: these are the coefficients of the inputs' derivatives
//! in it. Once a derivative of an output adds nothing, no further one of it does ([`super::saturation`]). A nonzero minor modulo one prime is a nonzero
//! minor, so what is found is certainly there; that nothing was missed is as certain as [`bound`] says.
//!
//! References: A. Sedoglavic, *A probabilistic algorithm to test local algebraic observability in polynomial time*, J. Symbolic
//! Computation 33 (2002); Y. Wang and E. D. Sontag, *Orders of input/output differential equations and state-space dimensions*,
//! SIAM J. Control Optim. 33 (1995), for the span over generic inputs.

mod adjoined;
mod bound;
mod covectors;
mod echelon;
mod equations;
mod in_steps;
mod laurent;
mod matrix;
mod orbit;
mod orders;
mod probe;
mod rows;
mod steps;
#[cfg(test)]
mod tests;

pub(crate) use bound::sum_of_errors;
pub(super) use matrix::formal_rank;
pub use matrix::{GenericRank, generic_rank};
pub(crate) use orders::Orders;
pub use probe::{Directions, Probe};
pub(crate) use rows::{OutputRows, Rows};

use super::saturation::Ceiling;
use bound::Rounds;
use equations::Equations;
use in_steps::answer_in_steps;
use palmistry_lang::{Assignment, System, Time};
use palmistry_math::expression::{NodeId, Symbol};
use probe::MOST_ROOTS;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// What is known of one unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observability {
    /// It is a function of what is measured, near almost every state.
    Yes,
    /// It can change while no output changes.
    No,
    /// Neither is shown.
    Undecided,
}

/// What is observable at almost all states, or on almost all of a set.
#[derive(Clone, Debug, PartialEq)]
pub struct GenericAnswer {
    /// How many unknowns there are.
    pub dimension: usize,
    /// The rank is no less: a minor was found that does not vanish.
    pub at_least: usize,
    /// And no greater, with an error probability below `2^log2_error`.
    pub at_most: usize,
    /// The same bound where states with known initial conditions count as unknown.
    pub(crate) closed_at_most: usize,
    /// Minus infinity where the rank is full and therefore certain.
    pub log2_error: f64,
    /// At how many random points, each modulo a random prime.
    pub rounds: usize,
    /// How many derivatives of the outputs were needed.
    pub order: usize,
    /// The unknowns in the order of the file, and whether each is observable.
    pub unknowns: Vec<(Symbol, Observability)>,
    /// Whether each of them is observable wherever the rank is `at_most`, with the same error.
    pub(crate) seen_at_most: Vec<bool>,
    /// Why the two bounds differ, or nothing more is known.
    pub open: Option<String>,
}

impl GenericAnswer {
    /// The rank, where it is known.
    pub fn rank(&self) -> Option<usize> {
        (self.at_least == self.at_most).then_some(self.at_least)
    }

    /// Whether the rank is known.
    pub fn is_final(&self) -> bool {
        self.rank().is_some()
    }
}

/// What is observable at almost all states that satisfy the conditions.
pub fn generic_answer(system: &System, conditions: &Assignment, ceiling: Ceiling) -> GenericAnswer {
    generic_answer_of(system, conditions, ceiling, &[]).0
}

/// The same, and whether each of some functions is observable: whether its differential lies in the span of those of what is measured. A negative
/// answer is as certain as the rank; a positive one is as certain as for an unknown.
pub fn generic_answer_of(
    system: &System,
    conditions: &Assignment,
    ceiling: Ceiling,
    asked: &[NodeId],
) -> (GenericAnswer, Vec<Observability>) {
    if system.time == Time::Discrete {
        return answer_in_steps(system, conditions, ceiling, asked);
    }
    let unknown = || vec![Observability::Undecided; asked.len()];
    let rests = ceiling == Ceiling::Rests;
    let probe = Probe::asking(system, conditions, asked);
    let columns = probe.equations.columns.clone();
    let dimension = columns.len();
    let mut answer = GenericAnswer {
        dimension,
        at_least: 0,
        at_most: dimension,
        closed_at_most: probe.equations.closed.len(),
        log2_error: f64::NEG_INFINITY,
        rounds: 0,
        order: 0,
        unknowns: columns.iter().map(|column| (system.states[*column], Observability::Undecided)).collect(),
        seen_at_most: vec![false; dimension],
        open: None,
    };
    // any fixed seed: what is true almost everywhere does not depend on the user's
    let mut rng = ChaCha8Rng::seed_from_u64(0x7365_7269_6573);
    let bounds = bound::rounds(&probe.equations, probe.equations.closed.len());
    let rounds = bounds.as_ref().map_or(1, |bounds| bounds.rounds);
    // of each choice of signs the ranks of all columns, and of all but one; at a rank of zero what is constant is still observable
    let mut best: Vec<(usize, Vec<bool>)> = Vec::new();
    let (mut closed, all) = (0, probe.equations.closed.len());
    let known_functions = functions_are_known(&probe.equations);
    for _ in 0..rounds {
        let found = match probe.round(&mut rng, rests) {
            Ok(found) => found,
            Err(why) => {
                answer.open = Some(why);
                return (answer, unknown());
            }
        };
        answer.rounds += 1;
        best.resize(found.len(), (0, vec![true; dimension + asked.len()]));
        answer.order = found.iter().map(|here| here.order).fold(answer.order, usize::max);
        closed = found.iter().map(|here| here.closed).fold(closed, usize::max);
        // which choice of signs is which is another matter at every point
        let mut found: Vec<_> = found.iter().map(|here| (here.rank(), here.observable())).collect();
        found.sort_unstable();
        for (best, here) in best.iter_mut().zip(found) {
            if here.0 > best.0 {
                *best = here;
            } else if here.0 == best.0 {
                // observable is what is so at all points of this rank
                best.1.iter_mut().zip(here.1).for_each(|(best, here)| *best &= here);
            }
        }
        if best.iter().all(|(rank, _)| *rank == dimension) {
            break;
        }
    }
    answer.closed_at_most = if bounds.is_ok() { closed } else { all };
    let seen = conclude(&mut answer, &best, &bounds, known_functions, ceiling);
    if !rests && !answer.is_final() && known_functions && is_of_free_signals(system) {
        return on_orbits(system, conditions, asked, &answer, &mut rng).unwrap_or((answer, seen));
    }
    (answer, seen)
}

/// The order up to which the derivatives of each output determine all that any derivatives do, at almost all states that satisfy the conditions,
/// which are no invariant set; nothing where that cannot be said.
pub(crate) fn orders_on_orbits(
    system: &System,
    conditions: &Assignment,
    rng: &mut ChaCha8Rng,
) -> Option<Vec<usize>> {
    let (probe, around) = orbit::probes(system, conditions, &[]);
    let found = is_of_free_signals(system).then(|| probe.orbit(&around, rng).ok())??;
    // one further derivative of each: bases end at lower degrees
    Some(found.last.into_iter().map(|last| last + 1).collect())
}

/// Whether no output ties a known signal to states: signals are anything then.
fn is_of_free_signals(system: &System) -> bool {
    system.zero_outputs().is_empty() && system.highest_lie_order().is_none()
}

/// The same on a set that is not invariant, by as many derivatives as determine all there; nothing where that cannot be said.
fn on_orbits(
    system: &System,
    conditions: &Assignment,
    asked: &[NodeId],
    answer: &GenericAnswer,
    rng: &mut ChaCha8Rng,
) -> Option<(GenericAnswer, Vec<Observability>)> {
    let (probe, around) = orbit::probes(system, conditions, asked);
    if !functions_are_known(&probe.equations) || !functions_are_known(&around.equations) {
        return None;
    }
    let orbit = probe.orbit(&around, rng).ok()?;
    let bounds = bound::rounds(&probe.equations, orbit.last.iter().max().map_or(1, |most| most + 1));
    let mut best = (0, vec![true; answer.dimension + asked.len()]);
    let mut answer = GenericAnswer { rounds: 0, order: 0, open: None, ..answer.clone() };
    for _ in 0..bounds.as_ref().map_or(1, |bounds| bounds.rounds) {
        let found = probe.round_up_to(&orbit.last, rng).ok()?;
        answer.rounds += 1;
        answer.order = answer.order.max(found.order);
        let (rank, seen) = (found.rank(), found.observable());
        if rank > best.0 {
            best = (rank, seen);
        } else if rank == best.0 {
            best.1.iter_mut().zip(seen).for_each(|(best, here)| *best &= here);
        }
    }
    let seen = conclude(&mut answer, &[best], &bounds, true, Ceiling::Rests);
    if answer.at_most < answer.dimension {
        answer.log2_error = sum_of_errors(answer.log2_error, orbit.log2_error);
    }
    Some((answer, seen))
}

/// An answer that says why it says nothing.
fn nothing_known(system: &System, why: String) -> GenericAnswer {
    let unknowns: Vec<_> =
        system.unknowns().into_iter().map(|symbol| (symbol, Observability::Undecided)).collect();
    GenericAnswer {
        dimension: unknowns.len(),
        at_least: 0,
        at_most: unknowns.len(),
        closed_at_most: system.closed_coordinates().len(),
        log2_error: f64::NEG_INFINITY,
        rounds: 0,
        order: 0,
        seen_at_most: vec![false; unknowns.len()],
        unknowns,
        open: Some(why),
    }
}

/// Whether values of functions are known by their relations, so that a random one shows what the true one does.
fn functions_are_known(equations: &Equations) -> bool {
    equations.related && (equations.roots == 0 || equations.roots <= MOST_ROOTS)
}

/// What follows from the ranks of each choice of signs; whether each function that is asked for is observable.
fn conclude(
    answer: &mut GenericAnswer,
    best: &[(usize, Vec<bool>)],
    bounds: &Result<Rounds, String>,
    known_functions: bool,
    ceiling: Ceiling,
) -> Vec<Observability> {
    let ranks = || best.iter().map(|(rank, _)| *rank);
    let (least, most) = (ranks().min().unwrap_or(0), ranks().max().unwrap_or(0));
    if known_functions {
        answer.at_least = least;
    } else {
        answer.open = Some(
            "functions are met that may satisfy relations; a rank at a true state is a lower bound"
                .to_owned(),
        );
    }
    match (bounds, ceiling) {
        (Ok(bounds), Ceiling::Rests) => {
            answer.at_most = most;
            if most < answer.dimension {
                answer.log2_error = bounds.log2_error;
            }
        }
        (Ok(bounds), Ceiling::Around { closed, unknown }) => {
            // where all that moves is spanned as around, longer derivatives lie in the span
            let spanned = answer.closed_at_most == closed;
            answer.at_most = if spanned { most.min(unknown) } else { unknown };
            if answer.at_most < answer.dimension {
                answer.log2_error = bounds.log2_error;
            }
            if answer.at_least < answer.at_most && answer.open.is_none() {
                answer.open =
                    Some("the fields leave the set: derivatives of higher orders may see more".to_owned());
            }
        }
        (Err(why), _) if least < answer.dimension => answer.open = Some(why.clone()),
        _ => {}
    }
    if least < most && answer.open.is_none() {
        answer.open =
            Some(format!("the rank is {least} with some signs of the square roots and {most} with others"));
    }
    // without its column the rank is less at all random points, and so at every state; the signs that have the highest rank count
    if bounds.is_ok() && answer.at_most == most {
        let highest = || best.iter().filter(|(rank, _)| *rank == most);
        answer.seen_at_most =
            (0..answer.dimension).map(|place| highest().all(|(_, seen)| seen[place])).collect();
    }
    let known = answer.is_final();
    let told = |place: usize| {
        let by = || best.iter().map(|(_, seen)| seen[place]);
        match known {
            _ if answer.at_least == answer.dimension => Observability::Yes,
            true if by().all(|seen| seen) => Observability::Yes,
            true if !by().any(|seen| seen) => Observability::No,
            _ => Observability::Undecided,
        }
    };
    let all = best.first().map_or(0, |(_, seen)| seen.len());
    let mut found: Vec<Observability> = (0..all).map(told).collect();
    let asked = found.split_off(answer.dimension.min(all));
    answer.unknowns.iter_mut().zip(found).for_each(|((_, seen), found)| *seen = found);
    asked
}
