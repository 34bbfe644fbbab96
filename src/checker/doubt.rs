//! What a check can come to, and why it did not confirm.

use crate::number::Refusal;
use std::sync::atomic::{AtomicU64, Ordering};

/// Why an operation of a listing has no value at a state, as far as the checker can tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Missing {
    /// The operation itself, or what it needs, was refused.
    #[error("operation {place}: {refusal}")]
    Refused { place: usize, refusal: Refusal },
    /// The state says nothing of the symbol.
    #[error("operation {place} names a symbol that the state does not give")]
    Symbol { place: usize },
    /// There is no such operation, or it does not come before what needs it.
    #[error("operation {place} needs what does not come before it, or the list is too long")]
    Place { place: usize },
    /// The work that one file may ask for is used up.
    #[error("the file asks for more work than a check may take")]
    Effort,
}

impl Missing {
    /// Whether it is certain that there is no value.
    pub fn is_certain(self) -> bool {
        matches!(self, Missing::Refused { refusal: Refusal::DivisionByZero, .. })
    }
}

/// The work that is left to a check, in operations on numbers of about a machine word.
#[derive(Debug)]
pub struct Effort(AtomicU64);

impl Default for Effort {
    /// A file of honest size takes a thousandth of this; all of it is some minutes.
    fn default() -> Self {
        Effort(AtomicU64::new(1 << 32))
    }
}

impl Effort {
    /// So much and no more.
    pub fn new(operations: u64) -> Self {
        Effort(AtomicU64::new(operations))
    }

    /// Takes some of it.
    ///
    /// # Errors
    /// Where there is not so much left.
    pub fn spend(&self, operations: u64) -> Result<(), Missing> {
        let take = |left: u64| left.checked_sub(operations);
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take).map_err(|_| Missing::Effort)?;
        Ok(())
    }
}

/// Why a verdict is not confirmed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)] // names and messages say it
pub enum Doubt {
    #[error("the state gives '{0}' by a sine and a cosine whose squares do not add up to one")]
    NotOnTheCircle(String),
    #[error("it refers to an operation that the listing does not have")]
    NoSuchStep,
    #[error("{0}")]
    NoValue(#[from] Missing),
    #[error("condition {0} is not met at the state")]
    ConditionNotMet(usize),
    #[error("condition {0} cannot be shown to hold exactly at the state")]
    ConditionNotShown(usize),
    #[error("requirement {0} is not met at the state: a side does not exist there")]
    RequirementNotMet(usize),
    #[error("requirement {0} cannot be shown to hold at the state")]
    RequirementNotShown(usize),
    #[error("the two sides are equal at the state")]
    Equal,
    #[error("the relation holds at the state")]
    Holds,
    #[error("the two sides differ at a state that meets every condition")]
    Differ,
    #[error("the two sides cannot be told apart at the state")]
    NotToldApart,
    #[error("whether the two sides are within the tolerance cannot be told")]
    ToleranceNotTold,
    #[error("the two sides are printed alike")]
    PrintedAlike,
    #[error("the {0} side is not what is printed")]
    PrintedOtherwise(&'static str),
    #[error("the {0} side cannot be shown to be what is printed")]
    PrintNotShown(&'static str),
    #[error("the rows do not have as many entries as there are columns")]
    Ragged,
    #[error("the minor of state {state} is not one of {rank} different rows and columns")]
    NoMinor { state: usize, rank: usize },
    #[error("the minor of state {0} vanishes")]
    MinorVanishes(usize),
    #[error("the minor of state {0} cannot be told from zero")]
    MinorNotTold(usize),
    #[error(
        "the kernel of state {state} has {found} vectors instead of {wanted}, or not all have an entry a column"
    )]
    KernelSize { state: usize, found: usize, wanted: usize },
    #[error("the kernel of state {0} is not independent")]
    KernelDependent(usize),
    #[error("row {row} does not annihilate vector {vector} of the kernel of state {state}")]
    NotAnnihilated { state: usize, row: usize, vector: usize },
    #[error("row {row} cannot be shown to annihilate vector {vector} of the kernel of state {state}")]
    NotShownAnnihilated { state: usize, row: usize, vector: usize },
    #[error("a rank of {found} does not say this of a claim of {claimed}")]
    OtherRank { found: usize, claimed: usize },
    #[error("the rank is {found} at another state, and not {stated} at almost all")]
    GreaterRank { found: usize, stated: usize },
    #[error("the digest is another: the file was changed")]
    DigestDiffers,
    #[error("a symbol has no range, two ranges, or an empty one")]
    NoRange,
    #[error("box {0} does not lie in the whole box, or has no width")]
    BoxOutside(usize),
    #[error("box {0} does not come with as many different rows as there are columns")]
    BoxWithoutMinor(usize),
    #[error("boxes {first} and {second} overlap")]
    BoxesOverlap { first: usize, second: usize },
    #[error("the boxes do not make the volume that is told")]
    VolumeDiffers,
    #[error(
        "full rank could not be shown on all of box {0} by plain interval arithmetic, which does not refute it"
    )]
    BoxNotShown(usize),
    #[error("requirement {requirement} is not met in box {index}: the rows do not exist there")]
    MissingInBox { index: usize, requirement: usize },
    #[error("at state {state}: {doubt}")]
    AtState { state: usize, doubt: Box<Doubt> },
    #[error("there is nothing in it to be checked")]
    Empty,
    #[error("it was interrupted before this was checked")]
    Interrupted,
}

impl Doubt {
    /// The same with the state to which it belongs, where it does not name one yet.
    pub(super) fn at_state(self, state: usize) -> Doubt {
        match self {
            Doubt::NotOnTheCircle(_)
            | Doubt::NoValue(_)
            | Doubt::ConditionNotMet(_)
            | Doubt::ConditionNotShown(_)
            | Doubt::RequirementNotMet(_)
            | Doubt::RequirementNotShown(_) => Doubt::AtState { state, doubt: Box::new(self) },
            named => named,
        }
    }
}

/// What a check has come to.
#[derive(Clone, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // names and messages say it
pub enum Finding {
    /// The verdict has been found again by evaluation alone. How often something was checked: states, boxes.
    Confirmed { times: usize },
    /// What was evaluated agrees with the verdict and does not prove it: so many states beyond the one in the file.
    Consistent { states: usize },
    /// The verdict comes with nothing that evaluation could check.
    NotChecked,
    /// It has not been found again.
    NotConfirmed(Doubt),
}

impl Finding {
    /// The finding in words, as `recheck` prints them.
    pub fn word(&self) -> &'static str {
        match self {
            Finding::Confirmed { .. } => "confirmed",
            Finding::Consistent { .. } => "consistent",
            // a signal says nothing against a verdict
            Finding::NotChecked | Finding::NotConfirmed(Doubt::Interrupted) => "not checked",
            Finding::NotConfirmed(_) => "NOT CONFIRMED",
        }
    }
}
