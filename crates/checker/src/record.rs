//! One verdict: of which claim, and what it rests on.

use super::binding::{ClaimParts, RecordedWord};
use super::boxes::CertifiedBoxes;
use super::claimed_rank::{ClaimedRank, ClaimedWord};
use super::doubt::{Effort, Finding, Unchecked};
use super::identity::StatedIdentity;
use super::minor::CertifiedRank;
use super::witness::Refutation;
use serde::{Deserialize, Serialize};
use std::sync::atomic::AtomicBool;

/// What a verdict rests on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    /// A witness.
    Refuted(Refutation),
    /// An exact argument, which evaluation can try and not repeat.
    Proved(StatedIdentity),
    /// Minors and kernels at states.
    Rank(CertifiedRank),
    /// A minor, of a claim about almost all states.
    ClaimedRank(ClaimedRank),
    /// Boxes, each with its minor.
    Boxes(CertifiedBoxes),
    /// Nothing that evaluation could check; the reason, as text.
    Unchecked(String),
}

/// One verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VerdictRecord {
    /// The proof file.
    pub file: String,
    /// The digest of its text: [`super::source_digest`].
    pub digest: String,
    /// The claim's number or name, or what was asked.
    pub id: String,
    /// The statement as it stands in the file.
    pub statement: String,
    /// What it asks: the number, the sense, the conditions.
    pub asked: ClaimParts,
    /// What was found of it.
    pub verdict: RecordedWord,
    /// What the verdict rests on.
    pub evidence: Evidence,
}

impl Evidence {
    /// Checks the evidence by itself, whatever claim it is filed under: whether its listing is that of the claim is not checked.
    pub fn check_alone(&self, seed: u64, effort: &Effort, interrupt: &AtomicBool) -> Finding {
        match self {
            Evidence::Refuted(refutation) => refutation.check(effort),
            Evidence::Proved(identity) => identity.check(seed, effort),
            Evidence::Rank(rank) => rank.check(effort, interrupt),
            Evidence::ClaimedRank(rank) => rank.check(seed, effort),
            Evidence::Boxes(boxes) => boxes.check(effort, interrupt),
            Evidence::Unchecked(_) => Finding::NotChecked(Unchecked::Nothing),
        }
    }

    /// The verdict in a word.
    pub fn word(&self) -> &'static str {
        match self {
            Evidence::Refuted(_) => "refuted",
            Evidence::Proved(_) => "proved",
            Evidence::Rank(_) => "rank",
            Evidence::ClaimedRank(rank) if rank.word == ClaimedWord::Proved => "proved",
            Evidence::ClaimedRank(_) => "refuted",
            Evidence::Boxes(_) => "boxes",
            Evidence::Unchecked(_) => "unchecked",
        }
    }
}
