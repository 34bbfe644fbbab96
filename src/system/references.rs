//! Names behind `restates` and `follows`: each has to be there, and none may lead back to itself.

use super::error::{Problem, nearest};
use super::grammar::parse_file;
use super::model::System;
use super::problems::{Cause, Full, Problems};
use super::source_text::{load, with_plain_line_ends};
use super::standing::{Basis, Reference};
use super::syntax::{ClaimBody, ClaimSyntax, Item};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};

/// An entry, as far as references go.
struct Entry {
    is_fault: bool,
    refers_to: Vec<Reference>,
}

/// The entries of the files that were looked into, by the file's path; this file's is empty.
type Known = HashMap<PathBuf, HashMap<String, Entry>>;

fn entries<'c>(claims: impl IntoIterator<Item = &'c ClaimSyntax>) -> HashMap<String, Entry> {
    let entry = |claim: &ClaimSyntax| {
        let is_fault = matches!(claim.body, ClaimBody::Erratum { .. } | ClaimBody::Scan { .. });
        let refers_to = references(claim).cloned().collect();
        (claim.id.clone(), Entry { is_fault, refers_to })
    };
    claims.into_iter().map(entry).collect()
}

fn references(claim: &ClaimSyntax) -> impl Iterator<Item = &Reference> {
    let restated = match &claim.basis {
        Basis::Restates(list) => list.as_slice(),
        _ => &[],
    };
    restated.iter().chain(&claim.follows)
}

impl System {
    /// Whether everything that the entries refer to is there; `folder` is the file's.
    pub(super) fn check_references(
        &self,
        folder: &Path,
        problems: &mut Problems,
        files: &mut BTreeSet<PathBuf>,
    ) -> Result<(), Full> {
        let mut known = Known::from([(PathBuf::new(), entries(&self.claims))]);
        let looked_for = |reference: &Reference| reference.file.as_ref().map(|file| folder.join(file));
        for claim in &self.claims {
            for reference in references(claim) {
                files.extend(looked_for(reference));
                if let Err(problem) = self.check_reference(claim, reference, folder, &mut known) {
                    problems.add(problem)?;
                }
            }
        }
        files.extend(known.into_keys().filter(|file| !file.as_os_str().is_empty()));
        Ok(())
    }

    fn check_reference(
        &self,
        claim: &ClaimSyntax,
        reference: &Reference,
        folder: &Path,
        known: &mut Known,
    ) -> Result<(), Problem> {
        let file = look_into(reference, Path::new(""), folder, known)?;
        self.exists(claim, reference, &known[&file])?;
        let mut met = HashSet::from([(PathBuf::new(), claim.id.clone())]);
        if leads_back(reference, Path::new(""), folder, known, &mut met)? {
            let message = format!("'{}' is said to come from itself", claim.id);
            return Err(Problem::new(&reference.span, message, "leads back to it"));
        }
        Ok(())
    }

    /// Whether a file has what is referred to.
    fn exists(
        &self,
        claim: &ClaimSyntax,
        reference: &Reference,
        entries: &HashMap<String, Entry>,
    ) -> Result<(), Problem> {
        let name = reference.name.as_str();
        let follows = claim.follows.as_ref() == Some(reference);
        match entries.get(name) {
            Some(entry) if !follows || entry.is_fault => return Ok(()),
            Some(_) => {
                let message = format!("'{name}' is no error from which another one could follow");
                return Err(Problem::new(&reference.span, message, "this entry holds")
                    .help("name an erratum, or another entry with a form that does not hold"));
            }
            None => {}
        }
        let here = reference.file.is_none();
        let is_named = |name: &str| {
            self.definition(name).is_some() || self.field(name).is_some() || self.find_symbol(name).is_some()
        };
        if here && !follows && is_named(name) {
            return Ok(());
        }
        let what = if follows { "entry" } else { "entry, definition, field or state" };
        let file = reference.file.as_ref().map(|file| format!(" in {file}")).unwrap_or_default();
        let problem =
            Problem::new(&reference.span, format!("there is no {what} '{name}'{file}"), "not found");
        // what another file lacks is not this one's doing
        let problem = if here { problem.because(Cause::Unknown(name.to_owned())) } else { problem };
        Err(match nearest(name, entries.keys().map(String::as_str)) {
            Some(near) => problem.help(format!("perhaps you meant '{near}'")),
            None => problem,
        })
    }
}

/// Makes the entries of the file known that a reference in a file is to, and names that file.
fn look_into(
    reference: &Reference,
    within: &Path,
    folder: &Path,
    known: &mut Known,
) -> Result<PathBuf, Problem> {
    let Some(file) = &reference.file else { return Ok(within.to_owned()) };
    let path = within.parent().map_or(folder.join(file), |parent| match within.as_os_str().is_empty() {
        true => folder.join(file),
        false => parent.join(file),
    });
    let refuse = |message: String| Problem::new(&reference.span, message, "referred to here");
    if !known.contains_key(&path) {
        let text = load(&path).map_err(refuse)?;
        let items = parse_file(&with_plain_line_ends(&text))
            .map_err(|error| refuse(format!("{}: {error}", path.display())))?;
        let claims: Vec<ClaimSyntax> = items
            .into_iter()
            .filter_map(|item| match item {
                Item::Claim(claim) => Some(*claim),
                _ => None,
            })
            .collect();
        known.insert(path.clone(), entries(&claims));
    }
    Ok(path)
}

/// Whether what a reference names refers, through whatever other entries, to one that was met on the way to it.
fn leads_back(
    reference: &Reference,
    within: &Path,
    folder: &Path,
    known: &mut Known,
    met: &mut HashSet<(PathBuf, String)>,
) -> Result<bool, Problem> {
    let file = look_into(reference, within, folder, known)?;
    let Some(entry) = known.get(&file).and_then(|entries| entries.get(&reference.name)) else {
        return Ok(false);
    };
    let next = entry.refers_to.clone();
    let place = (file.clone(), reference.name.clone());
    if !met.insert(place.clone()) {
        return Ok(true);
    }
    for reference in &next {
        // what is wrong in another file is said there
        let back = leads_back(reference, &file, folder, known, met);
        if back.unwrap_or(false) {
            return Ok(true);
        }
    }
    met.remove(&place);
    Ok(false)
}
