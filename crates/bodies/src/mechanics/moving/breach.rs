//! What ends a contact.

/// What ends a contact. That a contact reaches the joint is not among it: it lies on the body's side of the other palm,
/// so that `s sin(phi2)` is positive as long as the body is between the palms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Breach {
    #[error("the palms are parallel, or the body is not between them")]
    Parallel,
    #[error("the contact with palm {palm} is beyond the palm's end")]
    Beyond { palm: usize },
    #[error("the contact force of palm {palm} is not positive")]
    Contact { palm: usize },
}
