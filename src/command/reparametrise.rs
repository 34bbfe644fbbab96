//! `palmistry rank --reparametrise`: a system without what is not seen, as a proof file, and whether its claims are proved.

use palmistry::foreign::name_of;
use palmistry::observability::reparametrise;
use palmistry::{RankAnswer, System, prove};
use std::path::{Component, Path, PathBuf};

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
    let folder = out.parent().unwrap_or(Path::new(""));
    let import = from(folder, file);
    let text = reparametrise(system, found, &import).map_err(|why| why.to_string())?;
    // the folder that the import is named from may not be there yet
    let whole = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    let there = text.replacen(&format!("\"{import}\""), &format!("\"{}\"", name_of(&whole)), 1);
    let read = System::parse(&name_of(out), &there, Path::new(""));
    let reduced = read.map_err(|error| format!("it cannot be read back: {error}"))?;
    let outcomes = prove(&reduced);
    let proved = outcomes.iter().filter(|outcome| outcome.ok).count();
    Ok(Reparametrisation { text, claims: outcomes.len(), proved })
}

/// A file as it is named from a folder.
fn from(folder: &Path, file: &Path) -> String {
    let whole = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (folder, file) = (whole(folder_or_here(folder)), whole(file));
    let parts = |path: &Path| -> Vec<String> {
        let plain = path.components().filter(|part| !matches!(part, Component::CurDir));
        plain.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect()
    };
    let (to, at) = (parts(&file), parts(&folder));
    let common = to.iter().zip(&at).take_while(|(one, other)| one == other).count();
    let up = std::iter::repeat_n("..".to_owned(), at.len() - common);
    let path: PathBuf = up.chain(to[common..].iter().cloned()).collect();
    path.to_string_lossy().into_owned()
}

fn folder_or_here(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}
