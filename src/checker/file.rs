//! The verdict file: what was found, and what it rests on, in one JSON object that is checked without any other file.

use super::boxes::CertifiedBoxes;
use super::claimed_rank::{ClaimedRank, ClaimedWord};
use super::doubt::{Doubt, Effort, Finding};
use super::identity::StatedIdentity;
use super::minor::CertifiedRank;
use super::witness::Refutation;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, Ordering};

/// The name of the schema, and the version that is written. Version 1, which knows equations only, is read as well.
const SCHEMA: &str = "palmistry-verdicts";
const VERSION: u32 = 2;
/// No verdict file is longer, in bytes.
pub const LARGEST_FILE: u64 = 1 << 28;

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
    /// Nothing that evaluation could check; in words, why.
    Unchecked(String),
}

/// One verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VerdictRecord {
    /// The proof file.
    pub file: String,
    /// The claim's number or name, or what was asked.
    pub id: String,
    /// The statement as it stands in the file.
    pub statement: String,
    /// What the verdict rests on.
    pub evidence: Evidence,
}

/// Verdicts, and what they rest on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VerdictFile {
    schema: String,
    version: u32,
    /// The tool that found them, with its version.
    pub tool: String,
    /// The seed with which they were found.
    pub seed: u64,
    /// The verdicts, in the order in which they were found.
    pub verdicts: Vec<VerdictRecord>,
}

/// What is read first, so that a file of another version is told from a damaged one.
#[derive(Deserialize)]
struct Header {
    schema: String,
    version: u32,
}

/// Why a text is no verdict file.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // names and messages say it
pub enum Unreadable {
    #[error("it is longer than {LARGEST_FILE} bytes")]
    TooLong,
    #[error("it is no verdict file: {0}")]
    Damaged(#[from] serde_json::Error),
    #[error("it is no verdict file: its schema is '{0}' and not '{SCHEMA}'")]
    OtherSchema(String),
    #[error("its version is {0}, and this program reads versions up to {VERSION}")]
    OtherVersion(u32),
}

/// A verdict, and what its check has come to.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedVerdict<'f> {
    /// The verdict of the file.
    pub record: &'f VerdictRecord,
    /// What came of it.
    pub finding: Finding,
}

impl VerdictFile {
    /// A file of verdicts that were found with a seed.
    pub fn new(seed: u64, verdicts: Vec<VerdictRecord>) -> Self {
        let tool = format!("palmistry {}", env!("CARGO_PKG_VERSION"));
        VerdictFile { schema: SCHEMA.to_owned(), version: VERSION, tool, seed, verdicts }
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// Where it is too long, damaged, or something else.
    pub fn read(text: &str) -> Result<VerdictFile, Unreadable> {
        if text.len() as u64 > LARGEST_FILE {
            return Err(Unreadable::TooLong);
        }
        let header: Header = serde_json::from_str(text)?;
        if header.schema != SCHEMA {
            return Err(Unreadable::OtherSchema(header.schema));
        }
        if !(1..=VERSION).contains(&header.version) {
            return Err(Unreadable::OtherVersion(header.version));
        }
        Ok(serde_json::from_str(text)?)
    }

    /// The text of the file.
    ///
    /// # Errors
    /// Where a number has no JSON: an infinite bound.
    pub fn text(&self) -> Result<String, Unreadable> {
        Ok(serde_json::to_string(self)?)
    }

    /// Checks every verdict. `seed` is that of the states which the checker chooses.
    pub fn check<'f>(
        &'f self,
        seed: u64,
        effort: &Effort,
        interrupt: &AtomicBool,
        done: &(dyn Fn() + Sync),
    ) -> Vec<CheckedVerdict<'f>> {
        let check = |(index, record): (usize, &'f VerdictRecord)| {
            let seed = seed.wrapping_add(index as u64);
            let finding = match &record.evidence {
                _ if interrupt.load(Ordering::Relaxed) => Finding::NotConfirmed(Doubt::Interrupted),
                Evidence::Refuted(refutation) => refutation.check(effort),
                Evidence::Proved(identity) => identity.check(seed, effort),
                Evidence::Rank(rank) => rank.check(effort, interrupt),
                Evidence::ClaimedRank(rank) => rank.check(seed, effort),
                Evidence::Boxes(boxes) => boxes.check(effort, interrupt),
                Evidence::Unchecked(_) => Finding::NotChecked,
            };
            done();
            CheckedVerdict { record, finding }
        };
        self.verdicts.par_iter().enumerate().map(check).collect()
    }
}

impl Evidence {
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
