//! The verdict file: what was found, of which claim, and what it rests on, in one JSON object.

use super::bound;
use super::checking::Checking;
use super::doubt::{Doubt, Finding};
use super::record::VerdictRecord;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::atomic::Ordering;

/// The name of the schema, and its version. Verdicts of versions 1 and 2 are bound to no claim, and in version 3 the names of rows stand under
/// another key, so that digests differ: these are not read.
const SCHEMA: &str = "palmistry-verdicts";
const VERSION: u32 = 4;
/// No verdict file is longer, in bytes.
pub const LARGEST_FILE: u64 = 1 << 28;

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

/// What is read first, so that a file of another version can be distinguished from a damaged one.
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
    #[error("its version is {0}, and this program reads version {VERSION}: write it anew with this program")]
    OlderVersion(u32),
    #[error("its version is {0}, and this program reads version {VERSION}")]
    OtherVersion(u32),
}

/// A verdict, and what its check has come to.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedVerdict<'f> {
    /// The verdict of the file.
    pub record: &'f VerdictRecord,
    /// The result of the check.
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
        if (1..VERSION).contains(&header.version) {
            return Err(Unreadable::OlderVersion(header.version));
        }
        if header.version != VERSION {
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

    /// Checks every verdict against its proof file.
    pub fn check<'f>(&'f self, with: Checking<'_>, done: &(dyn Fn() + Sync)) -> Vec<CheckedVerdict<'f>> {
        let count = self.verdicts.len();
        let check = |(index, record): (usize, &'f VerdictRecord)| {
            let effort = with.effort.part(count);
            let seed = with.seed.wrapping_add(index as u64);
            let finding = match with.interrupt.load(Ordering::Relaxed) {
                true => Finding::NotConfirmed(Doubt::Interrupted),
                false => bound::check(record, Checking { seed, effort: &effort, ..with }),
            };
            done();
            CheckedVerdict { record, finding }
        };
        self.verdicts.par_iter().enumerate().map(check).collect()
    }
}
