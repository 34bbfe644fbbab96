//! Whether what is asked about exists at a state: every guard of outputs, fields and rows holds there.

use super::state::State;
use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::expression::{Graph, Guard, Need, NodeId, Program, expand_angles};
use palmistry_math::number::{Arithmetic, Enclosures, Floats, Interval, Rationals};

/// The bits of enclosures, one after the other.
const PRECISE: [usize; 2] = [128, 512];

/// Guards, ready to be looked at state by state.
#[derive(Clone, Debug, Default)]
pub struct Defined {
    needs: Vec<Need>,
    program: Program,
    texts: Vec<String>,
}

/// The operands of guards at a state.
enum Operands<N> {
    Values(Vec<N>),
    /// What is not defined there.
    Undefined(NodeId),
    /// The arithmetic has no values for them.
    NotInThese,
}

/// A guard that is not known to hold.
#[derive(Clone, Copy)]
struct Failing {
    index: usize,
    /// Whether it may hold all the same.
    may_hold: bool,
}

impl Defined {
    /// Those guards that do not hold wherever their operands exist.
    pub fn new(system: &mut System, guards: &[Guard]) -> Defined {
        let guards: Vec<Guard> =
            guards.iter().copied().filter(|guard| guard.is_obvious(&system.graph) != Some(true)).collect();
        let is_angle = &system.angle_test();
        let nodes: Vec<NodeId> = guards.iter().map(|guard| guard.node).collect();
        let nodes = expand_angles(&mut system.graph, &nodes, is_angle);
        Defined {
            needs: guards.iter().map(|guard| guard.need).collect(),
            program: Program::new(&system.graph, &nodes, is_angle),
            texts: guards.iter().map(|guard| guard.text(&system.graph)).collect(),
        }
    }

    /// Whether there is no state at which something may not hold.
    pub fn is_always_met(&self) -> bool {
        self.needs.is_empty()
    }

    /// Whether everything certainly holds at a state.
    pub fn holds(&self, state: &State) -> bool {
        self.first_failure(&|_| String::new(), state).is_none()
    }

    /// What does not hold at a state, or may not, in words; nothing where everything certainly exists.
    pub fn failure(&self, graph: &Graph, state: &State) -> Option<String> {
        self.first_failure(&|node| graph.text(node), state)
    }

    fn first_failure(&self, text: &dyn Fn(NodeId) -> String, state: &State) -> Option<String> {
        if self.needs.is_empty() {
            return None;
        }
        let doubles = self.values(state, Floats::<Interval>::default());
        if let Operands::Values(values) = doubles
            && self.first(&values, |need, value| need.is_met_in(value.low(), value.high())).is_none()
        {
            return None;
        }
        match self.values(state, Rationals::default()) {
            Operands::Values(values) => {
                let failing = self.first(&values, |need, value: &RBig| Some(need.is_met_by(value)));
                return failing.map(|failing| self.not_met(failing.index));
            }
            Operands::Undefined(node) => return Some(format!("{} is not defined", text(node))),
            Operands::NotInThese => {}
        }
        let mut found = None;
        for bits in PRECISE {
            let Operands::Values(values) = self.values(state, Enclosures::new(bits)) else {
                found =
                    Some("what outputs and fields divide by cannot be distinguished from zero".to_owned());
                continue;
            };
            match self.first(&values, |need, value| need.is_met_by_enclosure(value)) {
                None => return None,
                Some(Failing { index, may_hold: false }) => return Some(self.not_met(index)),
                Some(Failing { index, may_hold: true }) => {
                    found =
                        Some(format!("with {bits} bits it cannot be decided whether {}", self.texts[index]));
                }
            }
        }
        found
    }

    fn not_met(&self, index: usize) -> String {
        format!("outside of {}", self.texts[index])
    }

    /// The first guard that is not known to hold.
    fn first<N>(&self, values: &[N], met: impl Fn(Need, &N) -> Option<bool>) -> Option<Failing> {
        let known = |(index, value)| match met(self.needs[index], value) {
            Some(true) => None,
            Some(false) => Some(Failing { index, may_hold: false }),
            None => Some(Failing { index, may_hold: true }),
        };
        // what certainly fails says more than what may
        let found: Vec<Failing> = values.iter().enumerate().filter_map(known).collect();
        found.iter().find(|failing| !failing.may_hold).or(found.first()).copied()
    }

    /// The operands at a state.
    fn values<A: Arithmetic>(&self, state: &State, arithmetic: A) -> Operands<A::Number> {
        let Ok(inputs) = state.inputs(&self.program, &arithmetic) else { return Operands::NotInThese };
        let Ok(loaded) = self.program.load(arithmetic) else { return Operands::NotInThese };
        match loaded.run(&inputs, &mut Vec::new()) {
            Ok(values) => Operands::Values(values),
            Err(failure) => match failure.refusal {
                palmistry_math::number::Refusal::DivisionByZero => {
                    Operands::Undefined(failure.divisor.unwrap_or(failure.node))
                }
                _ => Operands::NotInThese,
            },
        }
    }
}
