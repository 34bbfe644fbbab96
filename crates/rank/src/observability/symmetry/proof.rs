//! Proofs: that fields lie in the kernel of the codistribution for good, and that functions have their differentials in it.
//!
//! Let independent fields `v_1 ... v_s` span a distribution. If it annihilates the outputs, and the brackets of its fields with the
//! drift and the inputs lie in it again, then it annihilates all Lie derivatives of the outputs, of any length: `L_v L_f a =
//! L_f L_v a - L_[f,v] a`, by induction (Isidori, Nonlinear Control Systems, 3rd edition, 1995, section 1.9). No Lie derivative of
//! the codistribution is needed for that, and the rank is at most the dimension less `s`.

use super::modular::Residues;
use palmistry_lang::System;
use palmistry_math::expression::{
    Derivation, Guard, NodeId, Related, Symbol, ZeroTest, expand_angles, identically_zero, zero_by_relations,
};
use rand_chacha::ChaCha8Rng;
use std::collections::HashMap;

/// The motion and the outputs of a system, with some parameters fixed at values.
pub(super) struct Motion {
    /// Every state, known ones included.
    pub states: Vec<Symbol>,
    /// For each field that moves the states its components, in the order of the states.
    pub fields: Vec<Vec<NodeId>>,
    pub outputs: Vec<NodeId>,
    /// What has to hold for all of it to be smooth.
    pub guards: Vec<Guard>,
}

/// Whether all of some expressions are identically zero, and the probability of an error as a power of two.
pub(super) fn vanish(
    system: &mut System,
    expressions: &[NodeId],
    guards: &[Guard],
    rng: &mut ChaCha8Rng,
) -> Option<f64> {
    let is_angle = &system.angle_test();
    let expanded = expand_angles(&mut system.graph, expressions, is_angle);
    match identically_zero(&system.graph, &expanded, is_angle, rng) {
        ZeroTest::Zero { log2_error, .. } => Some(log2_error),
        ZeroTest::Pole(_) => None,
        ZeroTest::Nonzero(_) | ZeroTest::Unknown(_) => {
            match zero_by_relations(&mut system.graph, &expanded, guards, is_angle, rng) {
                Related::Zero { log2_error, .. } => Some(log2_error),
                Related::NotShown(_) | Related::NoFunctions => None,
            }
        }
    }
}

/// The derivative along a vector, by states.
fn along(states: &[Symbol], vector: &[NodeId]) -> Derivation {
    Derivation::new(states.iter().copied().zip(vector.iter().copied()).collect::<HashMap<_, _>>())
}

/// A matrix of expressions beside its value at a point modulo a prime.
pub(super) struct Vectors {
    pub entries: Vec<Vec<NodeId>>,
    pub values: Vec<Vec<u64>>,
}

impl Vectors {
    /// Brings the rows to echelon form, each with a one at a pivot of its own and zeros at those of the others. None where they
    /// are dependent.
    fn reduce(&mut self, system: &mut System, residues: Residues) -> Option<Vec<usize>> {
        let mut pivots = Vec::new();
        for row in 0..self.entries.len() {
            // a constant divides without a remainder
            let constant = |column: &usize| system.graph.constant_value(self.entries[row][*column]).is_some();
            let filled: Vec<usize> =
                (0..self.values[row].len()).filter(|column| self.values[row][*column] != 0).collect();
            let pivot = filled.iter().copied().find(constant).or(filled.first().copied())?;
            let (by, inverse) = (self.entries[row][pivot], residues.0.inverse(self.values[row][pivot])?);
            for column in filled {
                self.entries[row][column] = system.graph.div(self.entries[row][column], by);
                self.values[row][column] = residues.mul(self.values[row][column], inverse);
            }
            for other in (0..self.entries.len()).filter(|other| *other != row) {
                let (factor, amount) = (self.entries[other][pivot], self.values[other][pivot]);
                if amount == 0 {
                    continue;
                }
                for column in 0..self.values[row].len() {
                    if self.values[row][column] != 0 {
                        let product = system.graph.mul(factor, self.entries[row][column]);
                        self.entries[other][column] = system.graph.sub(self.entries[other][column], product);
                        let product = residues.mul(amount, self.values[row][column]);
                        self.values[other][column] = residues.sub(self.values[other][column], product);
                    }
                }
                self.entries[other][pivot] = system.graph.integer(0);
            }
            pivots.push(pivot);
        }
        Some(pivots)
    }
}

/// Whether vectors span a distribution that annihilates the outputs and that the motion maps into itself; the probability of an
/// error as a power of two. A row is a vector, with a component for each state.
pub(super) fn is_unseen_for_good(
    system: &mut System,
    motion: &Motion,
    vectors: &[Vec<NodeId>],
    values: Vec<Vec<u64>>,
    residues: Residues,
    rng: &mut ChaCha8Rng,
) -> Option<f64> {
    let mut wanted = Vec::new();
    for vector in vectors {
        let mut derivation = along(&motion.states, vector);
        for output in &motion.outputs {
            wanted.push(derivation.apply(&mut system.graph, *output));
        }
    }
    let mut span = Vectors { entries: vectors.to_vec(), values };
    let pivots = span.reduce(system, residues)?;
    for field in &motion.fields {
        let mut along_field = along(&motion.states, field);
        for vector in vectors {
            let mut along_vector = along(&motion.states, vector);
            let bracket: Vec<NodeId> = field
                .iter()
                .zip(vector)
                .map(|(rate, component)| {
                    let forth = along_field.apply(&mut system.graph, *component);
                    let back = along_vector.apply(&mut system.graph, *rate);
                    system.graph.sub(forth, back)
                })
                .collect();
            for (column, entry) in bracket.iter().enumerate() {
                let mut rest = *entry;
                for (row, pivot) in span.entries.iter().zip(&pivots) {
                    let part = system.graph.mul(bracket[*pivot], row[column]);
                    rest = system.graph.sub(rest, part);
                }
                wanted.push(rest);
            }
        }
    }
    vanish(system, &wanted, &motion.guards, rng)
}

/// Whether rows of differentials annihilate a vector; both have a column for each of the same coordinates.
pub(super) fn annihilate(
    system: &mut System,
    rows: &[NodeId],
    vector: &[NodeId],
    guards: &[Guard],
    rng: &mut ChaCha8Rng,
) -> Option<f64> {
    let mut products = Vec::new();
    for row in rows.chunks(vector.len().max(1)) {
        let terms: Vec<NodeId> = row.iter().zip(vector).map(|(a, b)| system.graph.mul(*a, *b)).collect();
        products.push(system.graph.sum(terms));
    }
    vanish(system, &products, guards, rng)
}

/// Whether no vector changes a function.
pub(super) fn is_unchanged(
    system: &mut System,
    motion: &Motion,
    vectors: &[Vec<NodeId>],
    function: NodeId,
    rng: &mut ChaCha8Rng,
) -> Option<f64> {
    let changes: Vec<NodeId> = vectors
        .iter()
        .map(|vector| along(&motion.states, vector).apply(&mut system.graph, function))
        .collect();
    vanish(system, &changes, &motion.guards, rng)
}

/// The probability that any of several arguments errs, as a power of two, from those of each.
pub(super) fn together(errors: impl IntoIterator<Item = f64>) -> f64 {
    let errors: Vec<f64> = errors.into_iter().filter(|error| *error > f64::NEG_INFINITY).collect();
    let largest = errors.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
    if errors.is_empty() { largest } else { largest + (errors.len() as f64).log2() }
}
