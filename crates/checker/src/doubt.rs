//! The possible results of a check, and why it did not confirm.

use palmistry_math::number::Refusal;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Why an operation of a listing has no value at a state, as far as the checker knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Missing {
    /// The operation itself, or what it needs, was refused.
    #[error("operation {place}: {refusal}")]
    Refused {
        /// The place of the step in the listing.
        place: usize,
        /// Why it has no value.
        refusal: Refusal,
    },
    /// The state says nothing of the symbol.
    #[error("operation {place} names a symbol that the state does not give")]
    Symbol {
        /// The place of the step in the listing.
        place: usize,
    },
    /// There is no such operation, or it does not come before what needs it.
    #[error("operation {place} needs what does not come before it, or the list is too long")]
    Place {
        /// The place that is meant.
        place: usize,
    },
    /// The work that one file may ask for is used up.
    #[error("too much work: it takes more than a check may")]
    Effort,
}

impl Missing {
    /// Whether it is certain that there is no value.
    pub fn is_certain(self) -> bool {
        matches!(self, Missing::Refused { refusal: Refusal::DivisionByZero, .. })
    }
}

/// The remaining work of a check, in operations on numbers of about a machine word.
#[derive(Debug)]
pub struct Effort {
    left: Arc<AtomicU64>,
    /// The larger budgets that it is a part of; as much is taken from each of them.
    wholes: Vec<Arc<AtomicU64>>,
}

impl Default for Effort {
    /// A file of honest size takes a thousandth of this; all of it is some minutes.
    fn default() -> Self {
        Effort::new(1 << 35)
    }
}

/// No part of the work on a file is less.
const LEAST_PART: u64 = 1 << 30;

impl Effort {
    /// This much work and no more.
    pub fn new(operations: u64) -> Self {
        Effort { left: Arc::new(AtomicU64::new(operations)), wholes: Vec::new() }
    }

    /// The part of each of so many verdicts: one that asks for too much does not use up that of the others.
    pub fn part(&self, verdicts: usize) -> Effort {
        let each = self.left.load(Ordering::Relaxed) / (verdicts.max(1) as u64);
        self.limited(each.max(LEAST_PART))
    }

    /// At most so much of it.
    pub fn limited(&self, operations: u64) -> Effort {
        let wholes = std::iter::once(&self.left).chain(&self.wholes).cloned().collect();
        Effort { left: Arc::new(AtomicU64::new(operations)), wholes }
    }

    /// Spends some of it.
    ///
    /// # Errors
    /// Where there is not so much left.
    pub fn spend(&self, operations: u64) -> Result<(), Missing> {
        let take = |left: u64| left.checked_sub(operations);
        for budget in std::iter::once(&self.left).chain(&self.wholes) {
            budget.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take).map_err(|_| Missing::Effort)?;
        }
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
    #[error("the two sides cannot be distinguished at the state")]
    NotToldApart,
    #[error("whether the two sides are within the tolerance cannot be decided")]
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
    #[error("the minor of state {0} cannot be distinguished from zero")]
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
    #[error("the rank is {found} at another state, and not generically {stated}")]
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
    #[error("the boxes do not make up the volume that is stated")]
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
    #[error("there are no rows in it whose rank could be checked")]
    NoRows,
    #[error("it is bound to another claim: {0}")]
    OtherClaim(&'static str),
    #[error("the proof file has no row '{}'", .0.escape_debug())]
    NoSuchRow(String),
    #[error("the columns are others than those of the proof file")]
    OtherColumns,
    #[error("state {0} cannot be shown to lie outside of the sets that the claim leaves out")]
    LeftOut(usize),
    #[error("the rank is full, so that every function is observable")]
    FullRank,
    #[error("it was interrupted before this was checked")]
    Interrupted,
}

impl Doubt {
    /// Whether it says nothing against a verdict: a signal, too much work, a rank of no rows.
    pub fn is_no_fault(&self) -> bool {
        match self {
            Doubt::Interrupted | Doubt::NoRows | Doubt::NoValue(Missing::Effort) => true,
            Doubt::AtState { doubt, .. } => doubt.is_no_fault(),
            _ => false,
        }
    }

    /// Whether it is the same whichever entry of two matrices is compared.
    pub(super) fn is_of_no_entry(&self) -> bool {
        matches!(
            self,
            Doubt::ConditionNotMet(_)
                | Doubt::ConditionNotShown(_)
                | Doubt::RequirementNotMet(_)
                | Doubt::RequirementNotShown(_)
                | Doubt::NotOnTheCircle(_)
                | Doubt::NoValue(Missing::Effort)
        )
    }

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

/// How a verdict was shown without states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)] // messages say it
pub enum ShownBy {
    #[error("it follows from the expressions themselves, multiplied out")]
    MultipliedOut,
    #[error("the rank follows by elimination among the expressions themselves")]
    Eliminated,
    #[error("the rank is full at a state of each part of the set on which the conditions hold")]
    EachPart,
    #[error("both sides agree at random points modulo random primes, error probability below 2^-100")]
    AgreesAtPoints,
    #[error(
        "the rank is no less near a state, and no greater at random points modulo random primes, error probability below 2^-100"
    )]
    RankAtPoints,
}

/// Which half of a verdict was confirmed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)] // messages say it
pub enum Half {
    #[error("the rank is generically no less; that it is no greater was tried at {states} other states")]
    GenericallyNoLess { states: usize },
    #[error(
        "the rank is no less near one state; that it is no less elsewhere is not shown, that it is no greater was tried at {states} others"
    )]
    PartNoLess { states: usize },
    #[error("the rank is full near one state; that it is full on all parts of the set is not shown")]
    PartOfTheSet,
    #[error(
        "the rank is no less at {times} states; that no other Lie derivative makes it greater is not shown"
    )]
    NoLessAtStates { times: usize },
}

/// Why a verdict was not examined.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)] // messages say it
pub enum Unchecked {
    #[error("evaluation says nothing of it")]
    Nothing,
    #[error("its proof file cannot be read: {0}")]
    NoProofFile(String),
    #[error("its proof file is another one than when the verdict was found")]
    OtherProofFile,
    #[error("it is a step of a proof, which the claim does not name")]
    StepOfAProof,
    #[error("outputs that are zero tie the states")]
    TiedOutputs,
}

/// The result of a check.
#[derive(Clone, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // names and messages say it
pub enum Finding {
    /// The evidence implies the verdict, and has been confirmed by evaluation alone. How often something was checked: states,
    /// boxes.
    Confirmed { times: usize },
    /// The same by exact arithmetic with expressions instead of states.
    Shown(ShownBy),
    /// One half of the verdict was confirmed.
    HalfConfirmed(Half),
    /// What was evaluated agrees with the verdict but does not prove it; the number of states beyond the one in the file.
    Consistent { states: usize },
    /// The verdict has no evidence that evaluation could check, or its subject is not available.
    NotChecked(Unchecked),
    /// The verdict is not confirmed.
    NotConfirmed(Doubt),
}

impl Finding {
    /// The finding as text, as `recheck` prints it.
    pub fn word(&self) -> &'static str {
        match self {
            Finding::Confirmed { .. } | Finding::Shown(_) => "confirmed",
            Finding::HalfConfirmed(_) => "half confirmed",
            Finding::Consistent { .. } => "consistent",
            Finding::NotChecked(_) => "not checked",
            // a signal says nothing against a verdict, nor does too much work
            Finding::NotConfirmed(doubt) if doubt.is_no_fault() => "not checked",
            Finding::NotConfirmed(_) => "NOT CONFIRMED",
        }
    }
}
