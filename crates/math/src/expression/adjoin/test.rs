//! The zero test over generators: random points, above which the algebraic ones are adjoined to a random prime field.
//!
//! Let `A` be `Z[g][y]/(m(y))[t_1]/(t_1^2 - a_1 b_1)...`, with free generators `g`, twice the cosine `y` of a part of the turn
//! and roots `t_i/b_i` of `a_i/b_i`, where `a_i` and `b_i` mention what was adjoined before. What is tested is `n/d` with `n` and
//! `d` in `A`. If `n` is zero in `A`, then `n/d` is zero at every state, whatever else may relate the generators: the true
//! values satisfy all equations that define `A`. So it is `n` that has to be shown zero, and as an element of a free module: all
//! its coefficients, polynomials in `g`.
//!
//! *Their size.* Give `t_i` half of the degree of `a_i b_i`, and in the sum of the magnitudes of coefficients the weight whose
//! square is the sum of `a_i b_i`. To replace `t_i^2` by `a_i b_i` then raises neither the degree nor the weighted sum. For `y`
//! stands `z + 1/z`, of sum two, in `Z[z]/(z^N - 1)`, where products do not raise the sum either; only at the end it is
//! reduced modulo the cyclotomic polynomial, which multiplies by at most the largest sum of a power of `z`. So degree and
//! sum of every coefficient are bounded by those of `n` written down without any relation, and one point misses a
//! coefficient that is not zero as it misses any polynomial ([`identically_zero`](crate::expression::identically_zero)).
//!
//! *At a point* the same ring is calculated in modulo the prime, with all its coefficients, so that neither squares nor
//! primitive roots are needed there, and no sign of a root is chosen. It may have divisors of zero; a point at which one of
//! them is divided by is drawn anew, at most [`ATTEMPTS`] times, and the bound is multiplied by that.

use super::Adjunction;
use super::generators::Key;
use crate::expression::zero_test::{failure_bound, unit_residue};
use crate::expression::{Input, NodeId, Program, Symbol};
use crate::number::polynomial::Size;
use crate::number::{Extension, Fraction, Fractions, PrimeField, Refusal};
use std::collections::{HashMap, HashSet};

/// How often a point is drawn for one round.
const ATTEMPTS: usize = 16;
/// Elements have no more coefficients.
const LONGEST: usize = 256;

/// What a test has found.
pub(super) enum Tested {
    /// Zero, but for an error of a probability of this logarithm; the number of points, the degree.
    Zero(f64, usize, f64),
    NotShown(String),
}

/// An adjoined root: its symbol, and what it is a root of.
pub(super) struct Root {
    symbol: Symbol,
    program: Program,
}

impl Adjunction<'_> {
    /// Whether all expressions over generators are zero; the probability of an error is added to those before.
    pub(super) fn is_zero(&mut self, nodes: &[NodeId]) -> bool {
        match self.tested(nodes) {
            Tested::Zero(log2_error, points, degree) => {
                self.error += log2_error.exp2();
                self.points += points;
                self.degree = self.degree.max(degree);
                true
            }
            Tested::NotShown(_) => false,
        }
    }

    /// Tests whether all expressions over generators are zero.
    pub(super) fn tested(&mut self, nodes: &[NodeId]) -> Tested {
        if nodes.iter().all(|node| self.graph.constant_value(*node).is_some_and(|value| value.is_zero())) {
            return Tested::Zero(f64::NEG_INFINITY, 0, 0.0);
        }
        let roots = self.roots_below(nodes);
        if let Err(why) = self.is_short(&roots) {
            return Tested::NotShown(why);
        }
        let program = self.program(nodes);
        let (rounds, log2_error, degree) = match self.size(&program, &roots) {
            Ok(size) => match failure_bound(size) {
                Some((rounds, log2_error)) => {
                    // each round draws several points, any of which may mislead
                    let each = log2_error / rounds as f64 + (ATTEMPTS as f64).log2();
                    let rounds = (-100.0 / each).ceil();
                    (rounds as usize, rounds * each, size.degree)
                }
                None => return Tested::NotShown(format!("the degree may be {:.1e}", size.degree)),
            },
            Err(refusal) => return Tested::NotShown(refusal.to_string()),
        };
        for _ in 0..rounds {
            match self.round(&program, &roots) {
                Some(true) => {}
                Some(false) => {
                    return Tested::NotShown("the sides differ as expressions in their functions".into());
                }
                None => return Tested::NotShown("a divisor is zero for some signs of its roots".into()),
            }
        }
        Tested::Zero(log2_error, rounds, degree)
    }

    /// Whether elements of the ring with these roots have few enough coefficients.
    pub(super) fn is_short(&self, roots: &[Root]) -> Result<(), String> {
        let length = (self.generators.turn.minimal.len() as u64).checked_shl(roots.len() as u32);
        match length.is_some_and(|length| length <= LONGEST as u64) {
            true => Ok(()),
            false => Err(format!("{} roots are met that do not come of one another", roots.len())),
        }
    }

    pub(super) fn program(&self, nodes: &[NodeId]) -> Program {
        let circles = &self.generators.circles;
        Program::with_unknown_functions(self.graph, nodes, |symbol| circles.contains_key(&symbol))
    }

    /// The roots that expressions need, each after those that it is made of.
    pub(super) fn roots_below(&mut self, nodes: &[NodeId]) -> Vec<Root> {
        let (mut open, mut seen) = (nodes.to_vec(), HashSet::new());
        let mut found = std::collections::BTreeMap::new();
        while let Some(node) = open.pop() {
            for symbol in self.graph.symbols_of([node]) {
                let Some(variable) = self.generators.of_symbol(symbol) else { continue };
                if !seen.insert(variable) {
                    continue;
                }
                let radicand = match self.generators.key(variable).clone() {
                    Key::Root(form) => self.node_of_form(&form),
                    Key::Abs(form) => {
                        let node = self.node_of_form(&form);
                        self.graph.power(node, 2)
                    }
                    _ => continue,
                };
                open.push(radicand);
                // a generator comes after all that its form mentions
                found.insert(variable, Root { symbol, program: self.program(&[radicand]) });
            }
        }
        found.into_values().collect()
    }

    fn turn_symbol(&mut self) -> Option<Symbol> {
        let node = self.node_of_key(Key::Turn);
        self.graph.as_symbol(node)
    }

    /// A bound on the numerators, by the argument above.
    fn size(&mut self, program: &Program, roots: &[Root]) -> Result<Size, Refusal> {
        let mut size = Size::default();
        for (top, _) in self.sizes(program, roots)? {
            size = Size { degree: size.degree.max(top.degree), bits: size.bits.max(top.bits) };
        }
        size.bits += self.weight_of_turn();
        Ok(size)
    }

    /// What is added to the bits of a numerator when it is reduced in the end.
    pub(super) fn weight_of_turn(&self) -> f64 {
        (self.generators.turn.largest_sum as f64).log2()
    }

    /// Bounds on all numerators and denominators.
    pub fn sizes(&mut self, program: &Program, roots: &[Root]) -> Result<Vec<(Size, Size)>, Refusal> {
        let fractions = Fractions::<Size>::default();
        let turn = self.turn_symbol();
        let mut known: HashMap<Symbol, Fraction> = HashMap::new();
        let mut circles: HashMap<Symbol, Fraction> = HashMap::new();
        let mut run = |program: &Program, known: &HashMap<Symbol, Fraction>| {
            let mut inputs = Vec::new();
            for input in program.inputs() {
                let mut circle = |symbol: Symbol, degree| {
                    let bottom = circles
                        .entry(symbol)
                        .or_insert_with(|| fractions.element(Size { degree: 2.0, bits: 1.0 }))
                        .clone();
                    Ok(Fraction {
                        top: fractions.element(Size { degree, bits: 1.0 }).top,
                        bottom: bottom.top,
                    })
                };
                inputs.push(match input {
                    Input::Plain(symbol) => match known.get(symbol) {
                        Some(size) => size.clone(),
                        None if Some(*symbol) == turn => fractions.element(Size { degree: 0.0, bits: 1.0 }),
                        None => fractions.element(Size { degree: 1.0, bits: 0.0 }),
                    },
                    Input::Sine(symbol) => circle(*symbol, 1.0)?,
                    Input::Cosine(symbol) => circle(*symbol, 2.0)?,
                    Input::Opaque(_) => return Err(Refusal::TooLarge),
                });
            }
            let loaded = program.load(&fractions)?;
            loaded.run(&inputs, &mut Vec::new()).map_err(|failure| failure.refusal)
        };
        for root in roots {
            let Some(radicand) = run(&root.program, &known)?.pop() else { return Err(Refusal::TooLarge) };
            let (top, bottom) = (fractions.expand(&radicand.top)?, fractions.expand(&radicand.bottom)?);
            let size =
                Size { degree: (top.degree + bottom.degree) / 2.0, bits: (top.bits + bottom.bits) / 2.0 };
            let root_of_product = fractions.element(size);
            known.insert(root.symbol, Fraction { top: root_of_product.top, bottom: radicand.bottom });
        }
        let values = run(program, &known)?;
        values
            .iter()
            .map(|value| Ok((fractions.expand(&value.top)?, fractions.expand(&value.bottom)?)))
            .collect()
    }

    /// Whether all are zero at one point; nothing where no point was found at which they exist.
    fn round(&mut self, program: &Program, roots: &[Root]) -> Option<bool> {
        (0..ATTEMPTS).find_map(|_| {
            let field = PrimeField::random(&mut self.rng);
            let (_, values) = self.point(program, roots, field)?;
            Some(values.iter().flatten().all(|value| *value == 0))
        })
    }

    /// The values at a random point, and the ring in which they lie; nothing where they do not exist there.
    pub(super) fn point(
        &mut self,
        program: &Program,
        roots: &[Root],
        field: PrimeField,
    ) -> Option<(Extension, Vec<Vec<u64>>)> {
        let turn = self.turn_symbol();
        let mut all = Extension::new(field, &self.generators.turn.minimal);
        let (mut numbers, mut circles) = (HashMap::new(), HashMap::new());
        let rng = &mut self.rng;
        let mut run = |all: &Extension, numbers: &mut HashMap<Symbol, Vec<u64>>, program: &Program| {
            let mut inputs = Vec::new();
            for input in program.inputs() {
                let mut circle = |symbol| *circles.entry(symbol).or_insert_with(|| unit_residue(&field, rng));
                inputs.push(match input {
                    Input::Sine(symbol) => vec![circle(*symbol).0],
                    Input::Cosine(symbol) => vec![circle(*symbol).1],
                    Input::Plain(symbol) if Some(*symbol) == turn => all.generator(),
                    Input::Plain(symbol) => {
                        numbers.entry(*symbol).or_insert_with(|| vec![field.draw(rng)]).clone()
                    }
                    Input::Opaque(_) => return None,
                });
            }
            program.load(all).ok()?.run(&inputs, &mut Vec::new()).ok()
        };
        for root in roots {
            let radicand = run(&all, &mut numbers, &root.program)?.pop()?;
            numbers.insert(root.symbol, all.adjoin_root(radicand));
        }
        let values = run(&all, &mut numbers, program)?;
        Some((all, values))
    }
}
