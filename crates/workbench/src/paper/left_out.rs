//! What was left out of a paper.

/// Something that could not be done, and why. The rest is done all the same.
#[derive(Clone, Debug)]
pub struct LeftOut {
    /// What it is.
    pub what: String,
    /// Why.
    pub why: String,
}
