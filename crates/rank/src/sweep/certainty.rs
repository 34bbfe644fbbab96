//! How certain a rank is.

/// How a rank is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Certainty {
    /// Proved for the very state.
    Certified,
    /// By numbers that round, or that cannot distinguish zero from very small.
    Computed,
}
