//! Absolute values and other roots whose value depends on a sign: the states are divided by the signs of the arguments.
//!
//! `sqrt(u^2)` is `u` where `u` is positive and `-u` where it is negative. Of functions that are analytic on each part a rank is one
//! number on each, and may be another one on the next: `x + sqrt(x^2)` has rank 1 where `x > 0` and rank 0 where `x < 0`.

use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::expression::{
    Guard, Input, Need, Node, NodeId, add_guard, expand, expand_angles, normal_form, without_signs,
};
use palmistry_math::number::Function;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// The signs that some expressions have.
#[derive(Clone, Debug, Default)]
pub struct SignCell {
    /// What is positive, or not negative.
    pub guards: Vec<Guard>,
    /// The same in words.
    pub words: Vec<String>,
    /// All that is assumed there, where roots are met whose values depend on it.
    assumed: Vec<Guard>,
}

/// Whether the states at which an expression vanishes are left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edges {
    /// They are: a statement about almost all states does without them.
    LeftOut,
    /// They belong to both sides.
    Counted,
}

/// No more parts are distinguished.
const MOST_CELLS: usize = 64;
/// Systems of inequalities with more of them are not looked at.
const MOST_INEQUALITIES: usize = 400;

/// The parts, by signs, of the states at which the guards hold, as far as the values of expressions depend on them: one without signs
/// where they do not. Parts that are empty since linear inequalities exclude each other are left out.
///
/// # Errors
/// In words, where there are too many.
pub fn sign_cells(
    system: &mut System,
    nodes: &[NodeId],
    guards: &[Guard],
    edges: Edges,
) -> Result<Vec<SignCell>, String> {
    let is_root = |id: &NodeId| matches!(system.graph.node(*id), Node::Apply(Function::Sqrt, _));
    if !system.graph.reachable(nodes.iter().copied()).iter().any(is_root) {
        return Ok(vec![SignCell::default()]);
    }
    let is_angle = &system.angle_test();
    let expanded = expand_angles(&mut system.graph, nodes, is_angle);
    // any fixed seed: the parts do not depend on the user's
    let mut rng = ChaCha8Rng::seed_from_u64(0x0073_6967_6e73);
    let need = match edges {
        Edges::LeftOut => Need::Positive,
        Edges::Counted => Need::NotNegative,
    };
    let (mut open, mut done) = (vec![SignCell::default()], Vec::new());
    while let Some(cell) = open.pop() {
        let assumed: Vec<Guard> = guards.iter().chain(&cell.guards).copied().collect();
        if !is_feasible(system, &assumed) {
            continue;
        }
        let cell = SignCell { assumed: assumed.clone(), ..cell };
        let found = normal_form(&mut system.graph, &expanded, &assumed, &mut rng);
        let sign = found.ok().and_then(|found| found.open_signs.first().copied());
        let Some(sign) = sign.filter(|sign| !cell.guards.iter().any(|guard| guard.node == *sign)) else {
            done.push(cell);
            if done.len() > MOST_CELLS {
                return Err(format!("there are more than {MOST_CELLS} parts by signs"));
            }
            continue;
        };
        let text = system.graph.text(sign);
        let back = system.graph.neg(sign);
        let words = match edges {
            Edges::LeftOut => [format!("{text} < 0"), format!("{text} > 0")],
            Edges::Counted => [format!("{text} <= 0"), format!("{text} >= 0")],
        };
        for (node, words) in [back, sign].into_iter().zip(words) {
            let mut next = cell.clone();
            next.guards.push(Guard { node, need });
            next.words.push(words);
            open.push(next);
        }
        if open.len() + done.len() > 2 * MOST_CELLS {
            return Err(format!("there are more than {MOST_CELLS} parts by signs"));
        }
    }
    Ok(done)
}

/// Runs `work` on a system whose outputs and fields are rewritten for these signs. Afterwards the system is what it was, its graph
/// larger.
pub fn in_sign_cell<T>(system: &mut System, cell: &SignCell, work: impl FnOnce(&mut System) -> T) -> T {
    if cell.assumed.is_empty() {
        return work(system);
    }
    let (outputs, fields) = (system.outputs.clone(), system.fields.clone());
    let output_guards = system.output_guards.clone();
    let mut assumed = system.smooth_guards(&system.moving_fields());
    cell.assumed.iter().for_each(|guard| add_guard(&system.graph, &mut assumed, *guard));
    let mut nodes: Vec<NodeId> = outputs.iter().map(|(_, node)| *node).collect();
    nodes.extend(fields.iter().flat_map(|field| field.components.iter().map(|(_, node)| *node)));
    let mut rng = ChaCha8Rng::seed_from_u64(0x6365_6c6c);
    let mut found = without_signs(&mut system.graph, &nodes, &assumed, &mut rng).into_iter();
    for output in &mut system.outputs {
        output.1 = found.next().unwrap_or(output.1);
    }
    for field in &mut system.fields {
        for component in &mut field.components {
            component.1 = found.next().unwrap_or(component.1);
        }
        field.derive_anew(&system.graph);
    }
    if let Some(guards) = system.output_guards.first_mut() {
        cell.assumed.iter().for_each(|guard| add_guard(&system.graph, guards, *guard));
    }
    let result = work(system);
    (system.outputs, system.fields, system.output_guards) = (outputs, fields, output_guards);
    result
}

/// A monomial, by the places of the variables in it and their powers.
type Monomial = Vec<(usize, u8)>;
/// `sum > 0` (`true`) or `sum >= 0`, a sum of multiples of monomials.
type Inequality = (BTreeMap<Monomial, RBig>, bool);

/// Whether inequalities do not exclude each other as linear ones in their monomials (Fourier and Motzkin). What is not a polynomial
/// excludes nothing.
fn is_feasible(system: &mut System, guards: &[Guard]) -> bool {
    let is_angle = &system.angle_test();
    let mut open: Vec<Inequality> = Vec::new();
    let mut variables: Vec<Input> = Vec::new();
    for guard in guards {
        let strict = match guard.need {
            Need::Positive => true,
            Need::NotNegative => false,
            _ => continue,
        };
        let Ok(expansion) = expand(&mut system.graph, guard.node, is_angle) else { continue };
        if !expansion.denominator.is_empty() {
            continue;
        }
        let mut sum = BTreeMap::new();
        for (exponents, factor) in expansion.numerator.terms() {
            let mut monomial = Monomial::new();
            for (input, power) in expansion.variables.iter().zip(exponents).filter(|(_, power)| **power > 0) {
                let known = variables.iter().position(|known| known == input);
                let place = known.unwrap_or_else(|| {
                    variables.push(*input);
                    variables.len() - 1
                });
                monomial.push((place, *power));
            }
            monomial.sort_unstable();
            sum.insert(monomial, RBig::from(factor.clone()) * &expansion.front);
        }
        open.push((sum, strict));
    }
    loop {
        let unit = Monomial::new();
        let constant = |(sum, _): &Inequality| sum.keys().all(|monomial| *monomial == unit);
        let excluded = |(sum, strict): &Inequality| {
            let value = sum.get(&unit).cloned().unwrap_or(RBig::ZERO);
            value < RBig::ZERO || *strict && value.is_zero()
        };
        if open.iter().any(|inequality| constant(inequality) && excluded(inequality)) {
            return false;
        }
        open.retain(|inequality| !constant(inequality));
        let Some(pivot) = open.iter().flat_map(|(sum, _)| sum.keys()).find(|m| **m != unit).cloned() else {
            return true;
        };
        let (with, mut rest): (Vec<_>, Vec<_>) =
            open.into_iter().partition(|(sum, _)| sum.contains_key(&pivot));
        let (above, below): (Vec<_>, Vec<_>) =
            with.into_iter().partition(|(sum, _)| sum[&pivot] > RBig::ZERO);
        for (up, up_strict) in &above {
            for (down, down_strict) in &below {
                let (p, q) = (up[&pivot].clone(), -down[&pivot].clone());
                let mut sum: BTreeMap<Monomial, RBig> = BTreeMap::new();
                for (part, scale) in [(up, &q), (down, &p)] {
                    for (monomial, factor) in part {
                        *sum.entry(monomial.clone()).or_insert(RBig::ZERO) += factor * scale;
                    }
                }
                sum.retain(|_, factor| !factor.is_zero());
                rest.push((sum, *up_strict || *down_strict));
            }
        }
        if rest.len() > MOST_INEQUALITIES {
            return true;
        }
        open = rest;
    }
}
