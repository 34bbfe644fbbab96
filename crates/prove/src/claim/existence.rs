//! Does a statement speak of anything? Its sides have to exist at some state that meets its conditions.

use super::terms::OnBranch;
use palmistry_inequality::hold_somewhere;
use palmistry_lang::System;
use palmistry_math::expression::{
    Guard, Need, NodeId, Program, ZeroTest, draw_residues, expand_angles, identically_zero,
};
use palmistry_math::number::PrimeField;
use rand::Rng;

/// Whether there is a state on a branch at which terms exist.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Existence {
    /// There is one.
    Shown,
    /// There is none: this is needed, and holds nowhere.
    Nowhere(String),
    /// None was found; this is needed.
    NotShown(String),
}

/// How many random points, and states, are tried.
const ATTEMPTS: usize = 40;
const STATES: usize = 240;

/// Whether the sides exist somewhere on the branch.
pub(crate) fn existence(system: &mut System, on: &OnBranch, rng: &mut impl Rng) -> Existence {
    let guards: Vec<Guard> = on.terms.guards.clone();
    for guard in &guards {
        if guard.is_obvious(&system.graph) == Some(false) {
            return Existence::Nowhere(guard.text(&system.graph));
        }
    }
    let is_angle = &system.angle_test();
    let nodes: Vec<NodeId> = guards.iter().map(|guard| guard.node).collect();
    let expanded = expand_angles(&mut system.graph, &nodes, is_angle);
    let open: Vec<(Guard, NodeId)> = guards
        .iter()
        .zip(&expanded)
        .filter(|(guard, node)| {
            Guard { node: **node, need: guard.need }.is_obvious(&system.graph) != Some(true)
        })
        .map(|(guard, node)| (*guard, *node))
        .collect();
    let nodes: Vec<NodeId> = open.iter().map(|(_, node)| *node).collect();
    let sides = expand_angles(&mut system.graph, &on.terms.sides, is_angle);
    let program = Program::with_unknown_functions(&system.graph, &nodes, is_angle);
    let algebraic = open.iter().all(|(guard, _)| guard.need == Need::NotZero)
        && program.unknown_function(&system.graph).is_none()
        && program.bare_angle().is_none();
    if algebraic {
        // what is not zero modulo a prime is not zero, and a rational expression that is not zero is so at almost all states
        let all: Vec<NodeId> = nodes.iter().chain(&sides).copied().collect();
        let all = Program::with_unknown_functions(&system.graph, &all, is_angle);
        let mut registers = Vec::new();
        for _ in 0..ATTEMPTS {
            let field = PrimeField::random(rng);
            let Ok(loaded) = all.load(field) else { continue };
            let inputs = draw_residues(&all, &field, rng);
            if let Ok(values) = loaded.run(&inputs, &mut registers)
                && values[..nodes.len()].iter().all(|value| *value != 0)
            {
                return Existence::Shown;
            }
        }
    }
    for (guard, node) in &open {
        if guard.need == Need::NotZero
            && matches!(identically_zero(&system.graph, &[*node], is_angle, rng), ZeroTest::Zero { .. })
        {
            return Existence::Nowhere(guard.text(&system.graph));
        }
    }
    for attempt in 0..STATES {
        let point = on.draw(system, attempt, rng);
        if on.sides(&point).is_some() {
            return Existence::Shown;
        }
    }
    let found = hold_somewhere(&mut system.graph, &guards, is_angle);
    let texts: Vec<String> = open.iter().map(|(guard, _)| guard.text(&system.graph)).collect();
    match found {
        Some(true) => Existence::Shown,
        Some(false) => Existence::Nowhere(texts.join(", ")),
        None => Existence::NotShown(texts.join(", ")),
    }
}
