//! The equations at random points modulo random primes: the span of the outputs' derivatives, as long as it grows.

use super::covectors::{Covector, integers};
use super::echelon::Echelon;
use super::equations::Equations;
use crate::observability::State;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{Input, NodeId};
use palmistry_math::number::{PrimeField, Refusal};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Random points that are poles are drawn again so often.
pub(super) const ATTEMPTS: usize = 40;
/// And those at which a square root does not exist.
const ATTEMPTS_FOR_ROOTS: usize = 4000;
/// The signs of no more square roots than this are all tried.
pub(super) const MOST_ROOTS: usize = 5;

/// In systems of no more coordinates than this further derivatives are cheap.
const SMALL: usize = 24;

/// A point at which the equations were run to the end.
pub(super) struct Evaluated {
    /// Of the unknowns.
    pub echelon: Echelon,
    /// The differentials of the functions that are asked for, by unknowns.
    asked: Vec<Vec<u64>>,
    /// The rank where states with known initial conditions count as unknown.
    pub closed: usize,
    pub order: usize,
}

impl Evaluated {
    /// The span by unknowns and what is asked for, the rank by all that moves, and the order of the last derivative that added to the span.
    pub fn new(echelon: Echelon, asked: Vec<Vec<u64>>, closed: usize, order: usize) -> Evaluated {
        Evaluated { echelon, asked, closed, order }
    }

    /// The rank at this point.
    pub fn rank(&self) -> usize {
        self.echelon.rank()
    }

    /// Whether each unknown, and then each function that is asked for, is observable here.
    pub fn observable(&self) -> Vec<bool> {
        observable_in(&self.echelon, &self.asked)
    }
}

/// Of each unknown whether its unit row lies in the span, then of each of these rows.
pub(super) fn observable_in(echelon: &Echelon, asked: &[Vec<u64>]) -> Vec<bool> {
    let mut seen = echelon.observable();
    seen.extend(asked.iter().map(|row| echelon.contains(row.clone())));
    seen
}

/// The equations of a system, to be evaluated at random points modulo random primes.
pub struct Probe {
    pub(super) equations: Equations,
    /// No derivative of a higher order is one of the system: tied signals have symbols for no more of theirs.
    highest: Option<usize>,
    /// So many coefficients sufficed at the point before. Where they do not there are more: the answer does not depend on them.
    sufficed: AtomicUsize,
}

/// Where a probe was run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Draw {
    pub field: PrimeField,
    pub seed: u64,
    pub signs: Option<u64>,
}

impl Probe {
    /// The system on the set of these conditions, solved for symbols.
    pub fn new(system: &System, conditions: &Assignment) -> Probe {
        Probe::asking(system, conditions, &[])
    }

    /// The same, which also asks whether functions are observable.
    pub(super) fn asking(system: &System, conditions: &Assignment, asked: &[NodeId]) -> Probe {
        Probe {
            equations: Equations::new(system, conditions, asked),
            highest: system.highest_lie_order(),
            sufficed: AtomicUsize::new(0),
        }
    }

    /// The rank by order, at one start: outputs are differentiated while a derivative adds to the span.
    fn evaluate(&self, start: &[u64], draw: Draw, rests: bool) -> Result<Evaluated, Refusal> {
        let equations = &self.equations;
        let full = equations.columns.len();
        let most = match equations.closed.len().max(1) {
            // at a special state the first informative derivative may be of high order
            closed if !rests && closed <= SMALL => 2 * closed + 2,
            closed => closed,
        };
        let most = self.highest.map_or(most, |highest| most.min(highest + 1));
        let outputs = equations.outputs.max(1);
        let mut length = match self.sufficed.load(Ordering::Relaxed) {
            _ if !rests => most,
            0 => (most.div_ceil(outputs) + 2).min(most),
            before => before,
        };
        loop {
            let trajectory = equations.trajectory(draw.field, start, (draw.seed, draw.signs), length)?;
            let integers = integers(&draw.field, length);
            let mut echelon = Echelon::new(draw.field, full);
            // where all that moves is unknown the two are one
            let all = equations.closed.len();
            let mut closed = (all > full).then(|| Echelon::new(draw.field, all));
            let mut open: Vec<Covector> = trajectory.covectors;
            let of_unknowns = |covector: &Covector| -> Vec<u64> {
                let value = covector.value();
                equations.columns.iter().map(|place| value[*place]).collect()
            };
            let asked: Vec<Vec<u64>> = open.split_off(equations.outputs).iter().map(of_unknowns).collect();
            let (mut order, mut spanned, mut taken) = (0, 0, 0);
            for k in 0..length {
                taken = k + 1;
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
                if rests {
                    self.sufficed.fetch_max(taken, Ordering::Relaxed);
                }
                return Ok(Evaluated { echelon, asked, closed: spanned, order });
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
        // at a special state a derivative may add nothing and the next one may
        if quick == most { Some(quick) } else { Some(self.evaluate(&start, draw, false).ok()?.rank()) }
    }

    /// The equations at a random point, for every choice of signs of the roots where there are few.
    pub(super) fn round(&self, rng: &mut ChaCha8Rng, rests: bool) -> Result<Vec<Evaluated>, String> {
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
        Err(format!("{attempts} random points were singularities: {refused}"))
    }

    /// The unobservable directions at one random point, and the point: see [`Directions`].
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
        Err(format!("{ATTEMPTS} random points were singularities: {refused}"))
    }

    /// What the equations are given at a point, in the order of [`Probe::directions_at`].
    pub fn inputs(&self) -> &[Input] {
        self.equations.inputs()
    }

    /// Whether functions other than sines and cosines of angles are met.
    pub fn has_functions(&self) -> bool {
        !self.equations.functions.is_empty()
    }

    /// A basis of the unobservable directions at one point, by unknowns in the order of the file; all else is drawn from the seed.
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

/// The unobservable directions at one random point.
#[derive(Clone, Debug)]
pub struct Directions {
    /// The field of residues.
    pub field: PrimeField,
    /// The point: the symbols that the equations mention, for angles their sines and cosines, with their values. What is not
    /// among them may have any value.
    pub point: Vec<(Input, u64)>,
    /// A basis of the directions, by unknowns in the order of the file.
    pub kernel: Vec<Vec<u64>>,
}
