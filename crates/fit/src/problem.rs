//! Experiments, measurements and the parameters that are estimated.

use super::laws::{ErrorLaw, ErrorScale, ParameterScale, Prior};
use palmistry_lang::System;
use palmistry_math::expression::{NodeId, Symbol};

/// A parameter that is estimated.
#[derive(Clone, Debug)]
pub struct EstimatedParameter {
    /// Its name.
    pub name: String,
    /// What stands for it in formulas.
    pub symbol: Symbol,
    /// On which scale it is estimated.
    pub scale: ParameterScale,
    /// The least and the greatest value.
    pub bounds: [f64; 2],
    /// The range of its initial guesses; its bounds unless given.
    pub starts: Option<[f64; 2]>,
    /// A published value, or an initial guess.
    pub nominal: Option<f64>,
    /// Its prior.
    pub prior: Option<Prior>,
}

impl EstimatedParameter {
    /// Its bounds, on its scale.
    pub fn scaled_bounds(&self) -> [f64; 2] {
        self.bounds.map(|bound| self.scale.scaled(bound))
    }
}

/// A time during which one set of rates holds.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Phase {
    /// The rate of each state, by states and estimated parameters.
    pub rates: Vec<NodeId>,
    /// The state at the start, by parameters; an entry that is none keeps the value from the end of the phase
    /// before.
    pub start: Vec<Option<NodeId>>,
}

/// An experiment.
#[derive(Clone, Debug)]
pub struct JointExperiment {
    /// Its name.
    pub name: String,
    /// What happens before the experiment, until the steady state.
    pub before: Option<Phase>,
    /// What happens while it is measured, from time zero.
    pub phase: Phase,
}

/// A measurement.
#[derive(Clone, Debug)]
pub struct JointMeasurement {
    /// The place of its experiment.
    pub experiment: usize,
    /// The name of what is measured.
    pub output: String,
    /// When, in the unit of the rates; infinite for a measurement at steady state.
    pub time: f64,
    /// What was measured.
    pub value: f64,
    /// What is expected of it, by states and parameters.
    pub expected: NodeId,
    /// The size of its errors, by states and parameters.
    pub size: NodeId,
    /// On which scale it is compared.
    pub scale: ErrorScale,
    /// How its errors are distributed.
    pub law: ErrorLaw,
}

/// Several experiments with one set of parameters.
#[derive(Clone, Debug)]
pub struct JointProblem {
    /// The system in whose graph all formulas are.
    pub system: System,
    /// Its states that move.
    pub states: Vec<Symbol>,
    /// The place of the state that is time, where there is one: it never comes to rest.
    pub clock: Option<usize>,
    /// The estimated parameters.
    pub parameters: Vec<EstimatedParameter>,
    /// The experiments.
    pub experiments: Vec<JointExperiment>,
    /// What was measured in them.
    pub measurements: Vec<JointMeasurement>,
}

impl JointProblem {
    /// The nominal values on their scales, where all have one.
    pub fn nominal(&self) -> Option<Vec<f64>> {
        self.parameters.iter().map(|one| one.nominal.map(|value| one.scale.scaled(value))).collect()
    }

    /// Parameters as they are, from their scales.
    pub fn values(&self, scaled: &[f64]) -> Vec<f64> {
        self.parameters.iter().zip(scaled).map(|(one, place)| one.scale.value(*place)).collect()
    }
}
