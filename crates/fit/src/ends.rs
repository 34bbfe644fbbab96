//! Where a search ended, and how.

/// How a search ended.
#[derive(Clone, Debug, PartialEq)]
pub enum StartEnd {
    /// No step raises the likelihood by anything that counts.
    Converged,
    /// Its steps are spent: the likelihood still grows.
    StepsSpent,
    /// No step raises the likelihood, although its slope says so.
    Stuck,
    /// No start could be simulated; why the last could not.
    NoStart(String),
    /// It was interrupted.
    Interrupted,
}

/// A search from one start.
#[derive(Clone, Debug)]
pub struct SearchEnd {
    /// Where it began, on the scales of the parameters.
    pub start: Vec<f64>,
    /// Where it ended.
    pub found: Vec<f64>,
    /// Minus the logarithm of the likelihood there, priors included.
    pub objective: f64,
    /// How many steps were made.
    pub steps: u64,
    /// How it ended.
    pub end: StartEnd,
}
