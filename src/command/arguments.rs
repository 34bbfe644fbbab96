//! What is chosen from a list of words on the command line.

use clap::ValueEnum;
use palmistry::design::AdditionKind;
use palmistry::sweep::Certainty;

/// What a verdict has to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Wanted {
    Certified,
    Computed,
}

impl From<Wanted> for Certainty {
    fn from(wanted: Wanted) -> Self {
        match wanted {
            Wanted::Certified => Certainty::Certified,
            Wanted::Computed => Certainty::Computed,
        }
    }
}

/// Kinds of additions, as they are named on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum By {
    /// Further outputs: the states, or what --measure names.
    Outputs,
    /// Parameters that are known.
    Known,
    /// States whose initial conditions are known.
    Initial,
    /// Known inputs that are added to the rates of states.
    Inputs,
    /// Further experiments from other initial conditions.
    Experiments,
}

impl From<By> for AdditionKind {
    fn from(by: By) -> AdditionKind {
        match by {
            By::Outputs => AdditionKind::Outputs,
            By::Known => AdditionKind::Known,
            By::Initial => AdditionKind::Initial,
            By::Inputs => AdditionKind::Inputs,
            By::Experiments => AdditionKind::Experiments,
        }
    }
}
