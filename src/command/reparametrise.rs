//! `palmistry rank --reparametrise`: a system without what is not seen, as a proof file, and whether its claims are proved.

use super::derived::{decided, import_path};
use palmistry::observability::reparametrise;
use palmistry::{RankAnswer, System};
use std::path::Path;

/// A proof file of the system without what is not seen.
pub(crate) struct Reparametrisation {
    pub text: String,
    /// How many claims it has, and how many of them are proved.
    pub claims: usize,
    pub proved: usize,
}

impl Reparametrisation {
    pub fn in_words(&self) -> String {
        format!(
            "reparametrised by observable functions: {} of {} claims of the new file are proved",
            self.proved, self.claims
        )
    }
}

/// The file, for the answer to a question without conditions on states.
///
/// # Errors
/// In words: what is missing.
pub(crate) fn reparametrisation(
    system: &System,
    answer: &RankAnswer,
    file: &Path,
    out: &Path,
) -> Result<Reparametrisation, String> {
    let [branch] = answer.branches.as_slice() else {
        return Err("the conditions have several branches".to_owned());
    };
    let Some(found) = &branch.motions else {
        return Err(match branch.generic_rank == answer.dimension {
            true => "all unknowns are locally observable already".to_owned(),
            false => "the question has conditions on states".to_owned(),
        });
    };
    let import = import_path(file, Some(out));
    let text = reparametrise(system, found, &import).map_err(|why| why.to_string())?;
    let (_, outcomes) = decided(&text, &import, file, out)?;
    let proved = outcomes.iter().filter(|outcome| outcome.ok).count();
    Ok(Reparametrisation { text, claims: outcomes.len(), proved })
}
