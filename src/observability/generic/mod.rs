//! What is seen at almost all states: the rank of the observability codistribution, and of each unknown whether it is seen,
//! by power series modulo a prime. No words of Lie derivatives are formed, and nothing is written out: the cost grows with a
//! power of the number of unknowns.
//!
//! From a random state, with random series for the inputs, the outputs' derivatives and their differentials are computed in residues
//! ([`equations`], [`covectors`]). Their span is that of all words: words are the coefficients of the inputs' derivatives
//! in it. Once a derivative of an output adds nothing, no further one of it does. A nonzero minor modulo one prime is a nonzero
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
mod matrix;
mod orders;
mod steps;
#[cfg(test)]
mod tests;

pub(super) use matrix::formal_rank;
pub use matrix::{GenericRank, generic_rank};
pub(crate) use orders::Orders;

use crate::expression::Symbol;
use crate::number::{PrimeField, Refusal};
use crate::observability::State;
use crate::system::{Assignment, System, Time};
use bound::Rounds;
use covectors::Covector;
use echelon::Echelon;
use equations::Equations;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// What is known of one unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seen {
    /// It is a function of what is measured, near almost every state.
    Yes,
    /// It can change and nothing that is measured does.
    No,
    /// Neither is shown.
    Undecided,
}

/// What is seen at almost all states, or on almost all of a set.
#[derive(Clone, Debug, PartialEq)]
pub struct GenericAnswer {
    /// How many unknowns there are.
    pub dimension: usize,
    /// The rank is no less: a minor was found that does not vanish.
    pub at_least: usize,
    /// Nor more, but for an error of probability below `2^log2_error`.
    pub at_most: usize,
    /// The same bound where what is known at the beginning counts as unknown.
    pub(crate) closed_at_most: usize,
    /// Minus infinity where the rank is full and there is nothing to err about.
    pub log2_error: f64,
    /// At how many random points, each modulo a random prime.
    pub rounds: usize,
    /// How many derivatives of the outputs were needed.
    pub order: usize,
    /// The unknowns in the order of the file, and whether each is seen.
    pub unknowns: Vec<(Symbol, Seen)>,
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

/// Random points that are poles are drawn again so often.
const ATTEMPTS: usize = 40;
/// And those at which a square root does not exist.
const ATTEMPTS_FOR_ROOTS: usize = 4000;
/// The signs of no more square roots than this are all tried.
const MOST_ROOTS: usize = 5;

/// A point at which the equations were run to the end.
struct Evaluated {
    /// Of the unknowns.
    echelon: Echelon,
    /// The rank where what is known at the beginning counts as unknown.
    closed: usize,
    order: usize,
}

impl Evaluated {
    /// The rank at this point.
    fn rank(&self) -> usize {
        self.echelon.rank()
    }
}

/// The equations of a system, to be evaluated at random points modulo random primes.
pub struct Probe {
    equations: Equations,
}

/// Where a probe was run.
#[derive(Clone, Copy, Debug)]
struct Draw {
    field: PrimeField,
    seed: u64,
    signs: Option<u64>,
}

impl Probe {
    /// The system on the set of these conditions, solved for symbols.
    pub fn new(system: &System, conditions: &Assignment) -> Probe {
        Probe { equations: Equations::new(system, conditions) }
    }

    /// The rank by order, at one start: outputs are differentiated while a derivative adds to the span.
    fn evaluate(&self, start: &[u64], draw: Draw, rests: bool) -> Result<Evaluated, Refusal> {
        let equations = &self.equations;
        let full = equations.columns.len();
        let most = equations.closed.len().max(1);
        let outputs = equations.outputs.max(1);
        let mut length = if rests { (most.div_ceil(outputs) + 2).min(most) } else { most };
        loop {
            let trajectory = equations.trajectory(draw.field, start, (draw.seed, draw.signs), length)?;
            let one = draw.field.one();
            let integers: Vec<u64> =
                std::iter::successors(Some(0), |k| Some(draw.field.sum(*k, one))).take(length + 1).collect();
            let mut echelon = Echelon::new(draw.field, full);
            // where all that moves is unknown the two are one
            let all = equations.closed.len();
            let mut closed = (all > full).then(|| Echelon::new(draw.field, all));
            let mut open: Vec<Covector> = trajectory.covectors;
            let (mut order, mut spanned) = (0, 0);
            for k in 0..length {
                let mut further = Vec::new();
                for covector in open {
                    let value = covector.value();
                    let part = |places: &[usize]| places.iter().map(|place| value[*place]).collect();
                    let raised = echelon.insert(part(&equations.columns));
                    if raised {
                        order = k;
                    }
                    let goes_on = match &mut closed {
                        Some(closed) => closed.insert(part(&equations.closed)),
                        None => raised,
                    };
                    if goes_on || !rests {
                        further.push(covector);
                    }
                }
                open = further;
                spanned = closed.as_ref().unwrap_or(&echelon).rank();
                if spanned == all || open.is_empty() {
                    break;
                }
                if k + 1 < length {
                    let next =
                        |covector: &Covector| covector.next(&draw.field, &trajectory.entries, &integers);
                    open = open.iter().map(next).collect();
                }
            }
            if open.is_empty() || spanned == all || length >= most {
                return Ok(Evaluated { echelon, closed: spanned, order });
            }
            length = (2 * length).min(most);
        }
    }

    /// The rank at a state modulo a prime: no more than it is there. `most` is what it cannot exceed: where it is that, it
    /// is so for certain. Nothing where the state or a function has no residue.
    pub fn rank_at(&self, state: &State, field: PrimeField, seed: u64, most: usize) -> Option<usize> {
        if !self.equations.functions.is_empty() {
            return None;
        }
        let inputs = state.inputs(&self.equations.starts, &field).ok()?;
        let start = self.equations.start(field, &inputs, seed).ok()?;
        let draw = Draw { field, seed, signs: None };
        let quick = self.evaluate(&start, draw, true).ok()?.rank();
        // at a state of its own a derivative may add nothing and the next one may
        if quick == most { Some(quick) } else { Some(self.evaluate(&start, draw, false).ok()?.rank()) }
    }

    /// The equations at a random point, for every choice of signs of the roots where there are few.
    fn round(&self, rng: &mut ChaCha8Rng, rests: bool) -> Result<Vec<Evaluated>, String> {
        let roots = self.equations.roots;
        let all_signs = roots > 0 && roots <= MOST_ROOTS;
        let attempts = if all_signs { ATTEMPTS_FOR_ROOTS } else { ATTEMPTS };
        let mut refused = String::new();
        for _ in 0..attempts {
            let field = PrimeField::random(rng);
            let begin = self.equations.draw(field, rng);
            let seed: u64 = rng.random();
            let found = begin.and_then(|start| {
                let signs = if all_signs { 1u64 << roots } else { 1 };
                (0..signs)
                    .map(|signs| {
                        let signs = all_signs.then_some(signs);
                        self.evaluate(&start, Draw { field, seed, signs }, rests)
                    })
                    .collect::<Result<Vec<_>, Refusal>>()
            });
            match found {
                Ok(found) => return Ok(found),
                Err(refusal) => refused = refusal.to_string(),
            }
        }
        Err(format!("{attempts} random points were poles: {refused}"))
    }

    /// The vectors that nothing sees at one random point, and the point: see [`Directions`].
    ///
    /// # Errors
    /// In words, where the points were poles.
    pub fn directions(&self, rng: &mut ChaCha8Rng) -> Result<Directions, String> {
        let mut refused = String::new();
        for _ in 0..ATTEMPTS {
            let field = PrimeField::random(rng);
            match self.directions_in(field, rng) {
                Ok(found) => return Ok(found),
                Err(refusal) => refused = refusal.to_string(),
            }
        }
        Err(format!("{ATTEMPTS} random points were poles: {refused}"))
    }

    /// What the equations are given at a point, in the order of [`Probe::directions_at`].
    pub fn inputs(&self) -> &[crate::expression::Input] {
        self.equations.inputs()
    }

    /// Whether functions other than sines and cosines of angles are met.
    pub fn has_functions(&self) -> bool {
        !self.equations.functions.is_empty()
    }

    /// A basis of the vectors that nothing sees at one point, by unknowns in the order of the file; all else is drawn from the seed.
    ///
    /// # Errors
    /// Where the point is a pole.
    pub fn directions_at(
        &self,
        field: PrimeField,
        point: &[u64],
        seed: u64,
    ) -> Result<Vec<Vec<u64>>, Refusal> {
        let evaluated = self.evaluate(point, Draw { field, seed, signs: None }, true)?;
        Ok(evaluated.echelon.kernel())
    }

    /// The same modulo a prime of one's own choice.
    ///
    /// # Errors
    /// Where the random point is a pole.
    pub fn directions_in(&self, field: PrimeField, rng: &mut ChaCha8Rng) -> Result<Directions, Refusal> {
        let start = self.equations.draw(field, rng)?;
        let draw = Draw { field, seed: rng.random(), signs: None };
        let evaluated = self.evaluate(&start, draw, true)?;
        let inputs = self.equations.inputs();
        let point = inputs.iter().copied().zip(start).collect();
        Ok(Directions { field, point, kernel: evaluated.echelon.kernel() })
    }
}

/// What is not seen at one random point.
#[derive(Clone, Debug)]
pub struct Directions {
    /// The field of residues.
    pub field: PrimeField,
    /// The point: the symbols that the equations mention, for angles their sines and cosines, with their values. What is not
    /// among them may have any value.
    pub point: Vec<(crate::expression::Input, u64)>,
    /// A basis of the directions, by unknowns in the order of the file.
    pub kernel: Vec<Vec<u64>>,
}

/// What bounds a rank from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ceiling {
    /// The fields leave no state of the set: what has stopped growing has stopped for good.
    Rests,
    /// They may, and these are the ranks at almost all states around, with what is known at the beginning as unknown, and of the
    /// unknowns; a rank falls on a special set, and never rises.
    Around {
        /// That of all that moves.
        closed: usize,
        /// That of the unknowns.
        unknown: usize,
    },
}

/// What is seen at almost all states that satisfy the conditions.
pub fn generic_answer(system: &System, conditions: &Assignment, ceiling: Ceiling) -> GenericAnswer {
    if system.time == Time::Discrete {
        return answer_in_steps(system, conditions, ceiling);
    }
    let rests = ceiling == Ceiling::Rests;
    let probe = Probe::new(system, conditions);
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
        unknowns: columns.iter().map(|column| (system.states[*column], Seen::Undecided)).collect(),
        open: None,
    };
    // any fixed seed: what is true almost everywhere does not depend on the user's
    let mut rng = ChaCha8Rng::seed_from_u64(0x7365_7269_6573);
    let bounds = bound::rounds(&probe.equations, probe.equations.closed.len());
    let rounds = bounds.as_ref().map_or(1, |bounds| bounds.rounds);
    // of each choice of signs the ranks of all columns, and of all but one
    let mut best: Vec<(usize, Vec<bool>)> = Vec::new();
    let (mut closed, all) = (0, probe.equations.closed.len());
    let known_functions = functions_are_known(&probe.equations);
    for _ in 0..rounds {
        let found = match probe.round(&mut rng, rests) {
            Ok(found) => found,
            Err(why) => {
                answer.open = Some(why);
                return answer;
            }
        };
        answer.rounds += 1;
        best.resize(found.len(), (0, vec![false; dimension]));
        answer.order = found.iter().map(|here| here.order).fold(answer.order, usize::max);
        closed = found.iter().map(|here| here.closed).fold(closed, usize::max);
        // which choice of signs is which is another matter at every point
        let mut found: Vec<_> = found.iter().map(|here| (here.rank(), here.echelon.seen())).collect();
        found.sort_unstable();
        for (best, here) in best.iter_mut().zip(found) {
            if here.0 > best.0 {
                *best = here;
            } else if here.0 == best.0 {
                // seen is what the others do without at no point
                best.1.iter_mut().zip(here.1).for_each(|(best, here)| *best &= here);
            }
        }
        if best.iter().all(|(rank, _)| *rank == dimension) {
            break;
        }
    }
    answer.closed_at_most = if bounds.is_ok() { closed } else { all };
    conclude(&mut answer, &best, &bounds, known_functions, ceiling);
    answer
}

/// The same in discrete time.
fn answer_in_steps(system: &System, conditions: &Assignment, ceiling: Ceiling) -> GenericAnswer {
    let mut answer = nothing_known(system, String::new());
    let steps = match steps::Steps::new(system, conditions, ceiling == Ceiling::Rests) {
        Ok(steps) => steps,
        Err(why) => return nothing_known(system, why),
    };
    // any fixed seed: what is true almost everywhere does not depend on the user's
    let mut rng = ChaCha8Rng::seed_from_u64(0x0073_7465_7073);
    let bounds = steps.rounds();
    let mut best: Option<(usize, Vec<bool>)> = None;
    let mut refused = String::new();
    for _ in 0..bounds.as_ref().map_or(1, |bounds| bounds.rounds) + ATTEMPTS {
        let field = PrimeField::random(&mut rng);
        let (echelon, order) = match steps.follow(field, &mut rng) {
            Ok(found) => found,
            Err(refusal) => {
                refused = refusal.to_string();
                continue;
            }
        };
        answer.rounds += 1;
        answer.order = answer.order.max(order);
        let (rank, seen) = (echelon.rank(), echelon.seen());
        best = Some(match best.take() {
            Some(known) if known.0 > rank => known,
            // seen is what the others do without at no point
            Some(known) if known.0 == rank => {
                (rank, known.1.iter().zip(&seen).map(|(known, here)| *known && *here).collect())
            }
            _ => (rank, seen),
        });
        let is_full = rank == answer.dimension;
        if is_full || answer.rounds == bounds.as_ref().map_or(1, |bounds| bounds.rounds) {
            break;
        }
    }
    let Some(best) = best else {
        return nothing_known(system, format!("{ATTEMPTS} random sequences met poles: {refused}"));
    };
    if bounds.as_ref().is_ok_and(|bounds| answer.rounds < bounds.rounds) && best.0 < answer.dimension {
        return nothing_known(system, format!("too many of the random sequences met poles: {refused}"));
    }
    answer.open = None;
    let closed = system.closed_coordinates();
    if bounds.is_ok() {
        answer.closed_at_most = best.0;
        if closed.len() > answer.dimension {
            // what is known at the beginning counts as unknown
            let mut all = system.clone();
            all.known.retain(|symbol| !closed.contains(symbol));
            answer.closed_at_most = match answer_in_steps(&all, conditions, ceiling) {
                found if found.open.is_none() || ceiling != Ceiling::Rests => found.at_least,
                _ => closed.len(),
            };
        }
    }
    conclude(&mut answer, &[best], &bounds, true, ceiling);
    answer
}

/// An answer that says why it says nothing.
fn nothing_known(system: &System, why: String) -> GenericAnswer {
    let unknowns: Vec<_> = system.unknowns().into_iter().map(|symbol| (symbol, Seen::Undecided)).collect();
    GenericAnswer {
        dimension: unknowns.len(),
        at_least: 0,
        at_most: unknowns.len(),
        closed_at_most: system.closed_coordinates().len(),
        log2_error: f64::NEG_INFINITY,
        rounds: 0,
        order: 0,
        unknowns,
        open: Some(why),
    }
}

/// Whether values of functions are known by their relations, so that a random one shows what the true one does.
fn functions_are_known(equations: &Equations) -> bool {
    equations.related && (equations.roots == 0 || equations.roots <= MOST_ROOTS)
}

/// What follows from the ranks of each choice of signs.
fn conclude(
    answer: &mut GenericAnswer,
    best: &[(usize, Vec<bool>)],
    bounds: &Result<Rounds, String>,
    known_functions: bool,
    ceiling: Ceiling,
) {
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
    let known = answer.is_final();
    for (place, (_, seen)) in answer.unknowns.iter_mut().enumerate() {
        let by = || best.iter().map(|(_, seen)| seen[place]);
        *seen = match known {
            _ if answer.at_least == answer.dimension => Seen::Yes,
            true if by().all(|seen| seen) => Seen::Yes,
            true if !by().any(|seen| seen) => Seen::No,
            _ => Seen::Undecided,
        };
    }
}
