//! What is asked of a reduction, and why there is none.

use dashu::rational::RBig;
use palmistry_lang::Range;

/// Which conditions hold, and what is known.
#[derive(Clone, Debug, Default)]
pub struct ReduceQuestion {
    /// Conditions in the language of proof files: `omega1 = 0`, `omega2 = omega1`. Each has to be solved for a state, a parameter or a signal in one way, and
    /// has to stay met along every field that is kept.
    pub conditions: Vec<String>,
    /// States and unknown constants that are known, with their values where these are numbers. A constant becomes a parameter of that value; a state that moves
    /// becomes an output; a parameter gets the value.
    pub known: Vec<(String, Option<RBig>)>,
    /// Input fields that nothing drives.
    pub undriven: Vec<String>,
    /// Input fields with the known signal or parameter that drives each: `f + u g` is the drift of the smaller system, and no input is left.
    pub driven: Vec<(String, String)>,
    /// Parameters that are known signals.
    pub signals: Vec<String>,
    /// Terms of a rate that together are at most this part of the median of the rate's absolute values over the ranges are left out, as far as that is
    /// shown.
    pub tolerance: Option<f64>,
    /// Ranges in the place of those that the file gives.
    pub ranges: Vec<(String, Range)>,
}

/// Why a system is not written smaller.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)] // names and messages say it
pub enum NotReduced {
    /// Steps, several experiments, or no field.
    #[error("{why}")]
    Kind { why: String },
    /// A condition cannot be read or solved.
    #[error("the condition '{condition}': {why}")]
    Condition { condition: String, why: String },
    /// Conditions that can be met in several ways.
    #[error("the conditions can be met in {ways} ways: {list}; write the one that is meant")]
    SeveralWays { ways: usize, list: String },
    /// A condition that does not stay met along a field, or is not shown to.
    #[error(
        "'{condition}' is not shown to stay met: along {field} the rate of one side less the other is {rate}"
    )]
    NotKept { condition: String, field: String, rate: String },
    /// A rate or an output that divides by zero where the conditions hold.
    #[error("where the conditions hold, {what} divides by zero")]
    Pole { what: String },
    /// A name that is no unknown.
    #[error("'{name}' is no state and no unknown constant of the system; these are {unknowns}")]
    NoUnknown { name: String, unknowns: String },
    /// A name that is no input.
    #[error("'{name}' is no input of the system; its inputs are {inputs}")]
    NoInput { name: String, inputs: String },
    /// A name that is no parameter and no known signal.
    #[error("'{name}' is no parameter and no known signal of the system")]
    NoSignal { name: String },
    /// A formula that is too long to read.
    #[error("the rate of '{name}' is too long to be written")]
    TooLong { name: String },
    /// Nothing is left.
    #[error("nothing is left: the outputs depend on no unknown under these conditions")]
    Nothing,
}
