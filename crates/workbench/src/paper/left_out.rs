//! What was left out of a paper.

/// Something that could not be done, and why. The rest is done all the same.
#[derive(Clone, Debug)]
pub struct LeftOut {
    pub what: String,
    pub why: String,
}
