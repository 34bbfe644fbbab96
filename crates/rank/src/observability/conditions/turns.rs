//! Whole turns: `sin(phi) = 0` fixes an angle up to multiples of two pi, and what distinguishes these cannot be decided at one
//! of them.

use super::{Branch, all_vanish};
use palmistry_lang::{Assignment, System, Time};
use palmistry_math::expression::{Input, NodeId, Program, Symbol, expand_angles};
use palmistry_math::number::Function;

impl Branch {
    /// Refuses a codistribution that distinguishes what the conditions leave open; see [`Branch::put_in`].
    ///
    /// # Errors
    /// In words: which angle is known up to whole turns only.
    pub fn check_codistribution(&self, system: &mut System) -> Result<(), String> {
        if self.up_to_turns.is_empty() {
            return Ok(());
        }
        let ingredients = ingredients(system);
        self.put_in(system, &ingredients).map(|_| ())
    }

    /// The expressions on the branch: its values put in.
    ///
    /// # Errors
    /// Where an expression distinguishes values, apart by whole turns, that the conditions leave open; in words:
    /// which angle is known up to whole turns only.
    pub fn put_in(&self, system: &mut System, expressions: &[NodeId]) -> Result<Vec<NodeId>, String> {
        let before = system.graph.substitute(expressions, &self.before_turns);
        for angle in &self.up_to_turns {
            if !turns_do_not_matter(system, &before, *angle) {
                let name = system.symbol_name(*angle);
                return Err(format!(
                    "the condition fixes '{name}' up to whole turns, and the statement distinguishes them"
                ));
            }
        }
        Ok(system.graph.substitute(&before, &self.values))
    }
}

/// What every Lie derivative's differential is made of: the outputs' differentials and the fields' components.
fn ingredients(system: &mut System) -> Vec<NodeId> {
    let mut found: Vec<NodeId> = Vec::new();
    for (_, output) in system.outputs.clone() {
        found.extend(system.differential(output));
    }
    for field in system.moving_fields() {
        for (moved, component) in system.fields[field].components.clone() {
            // after a step an angle is met in its sine and cosine again; a rate stands for itself
            match system.time == Time::Discrete && system.is_angle(moved) {
                true => {
                    found.extend([Function::Sin, Function::Cos].map(|of| system.graph.apply(of, component)))
                }
                false => found.push(component),
            }
        }
    }
    found
}

/// Whether expressions mention an angle only through sines and cosines of integer combinations, so that whole turns of
/// it do not matter.
pub(super) fn turns_do_not_matter(system: &mut System, expressions: &[NodeId], angle: Symbol) -> bool {
    let is_angle = &system.angle_test();
    let expanded = expand_angles(&mut system.graph, expressions, is_angle);
    let program = Program::with_unknown_functions(&system.graph, &expanded, is_angle);
    let bare = program.inputs().contains(&Input::Plain(angle));
    let within = |input: &Input| match input {
        Input::Opaque(node) => system.graph.symbols_of([*node]).contains(&angle),
        _ => false,
    };
    if bare || !program.inputs().iter().any(within) {
        return !bare;
    }
    // inside of functions: a turn further all is as it was
    let (pi, two) = (system.graph.pi(), system.graph.integer(2));
    let turn = system.graph.mul(two, pi);
    let here = system.graph.symbol(angle);
    let further = system.graph.add(here, turn);
    let turned = system.graph.substitute(expressions, &Assignment::from([(angle, further)]));
    let differences: Vec<NodeId> =
        turned.iter().zip(expressions).map(|(there, here)| system.graph.sub(*there, *here)).collect();
    all_vanish(system, &differences)
}
