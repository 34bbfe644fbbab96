//! Names behind `restates` and `follows`: each has to be there, and none may lead back to itself.

use super::codes::Code;
use super::error::{Problem, nearest};
use super::grammar::parse_file;
use super::model::System;
use super::problems::{Cause, Full, Problems};
use super::source_text::{is_a_proof_file, load, no_proof_file, with_plain_line_ends};
use super::standing::{Basis, Reference};
use super::syntax::{ClaimBody, ClaimSyntax, Item};
use palmistry_io::foreign::shown_path;
use std::collections::{BTreeSet, HashMap};
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
        let mut ways = Ways::default();
        let looked_for = |reference: &Reference| reference.file.as_ref().map(|file| folder.join(file));
        for claim in &self.claims {
            for reference in references(claim) {
                files.extend(looked_for(reference));
                if let Err(problem) = self.check_reference(claim, reference, folder, &mut known, &mut ways) {
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
        ways: &mut Ways,
    ) -> Result<(), Problem> {
        let file = look_into(reference, Path::new(""), folder, known)?;
        self.exists(claim, reference, &known[&file])?;
        if ways.lead_back(&claim.id, reference, folder, known) {
            let message = format!("'{}' is said to come from itself", claim.id);
            return Err(Problem::new(Code::Reference, &reference.span, message, "leads back to it"));
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
                return Err(Problem::new(Code::Reference, &reference.span, message, "this entry holds")
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
        let problem = Problem::new(
            Code::Reference,
            &reference.span,
            format!("there is no {what} '{name}'{file}"),
            "not found",
        );
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
    let refuse =
        |message: String| Problem::new(Code::Reference, &reference.span, message, "referred to here");
    if !known.contains_key(&path) {
        let text = load(&path).map_err(refuse)?;
        let items = parse_file(&with_plain_line_ends(&text)).map_err(|error| {
            match is_a_proof_file(&path, &text) {
                true => refuse(format!("{}: {error}", shown_path(&path))),
                false => refuse(no_proof_file(&path)),
            }
        })?;
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

/// What is known of an entry that something refers to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// It is on the way that is being followed.
    Open,
    /// Nothing that it refers to, through whatever others, leads back to where it came from.
    Ends,
    /// Something does.
    Circular,
}

/// An entry: its file and its name.
type Place = (PathBuf, String);

/// An entry on the way, and which of its references comes next.
struct Step {
    place: Place,
    next: std::vec::IntoIter<Reference>,
}

/// Follows references, each once, however many entries lead to it.
#[derive(Default)]
struct Ways(HashMap<Place, Way>);

impl Ways {
    /// Whether a reference of an entry leads, through whatever other entries, to one that was met on the way.
    fn lead_back(&mut self, from: &str, reference: &Reference, folder: &Path, known: &mut Known) -> bool {
        let first = (PathBuf::new(), from.to_owned());
        let before = self.0.insert(first.clone(), Way::Open);
        let mut steps = vec![Step { place: first.clone(), next: vec![reference.clone()].into_iter() }];
        let found = self.follow(&mut steps, folder, known);
        for step in steps {
            self.0.insert(step.place, Way::Circular);
        }
        match before {
            // the other references of this entry are not known by this one
            None if !found => self.0.remove(&first),
            Some(before) if !found => self.0.insert(first, before),
            _ => None,
        };
        found
    }

    fn follow(&mut self, steps: &mut Vec<Step>, folder: &Path, known: &mut Known) -> bool {
        while let Some(step) = steps.last_mut() {
            let Some(reference) = step.next.next() else {
                self.0.insert(step.place.clone(), Way::Ends);
                steps.pop();
                continue;
            };
            // what is wrong in another file is said there
            let Ok(file) = look_into(&reference, &step.place.0, folder, known) else { continue };
            let Some(entry) = known.get(&file).and_then(|entries| entries.get(&reference.name)) else {
                continue;
            };
            let next = entry.refers_to.clone().into_iter();
            let place = (file, reference.name);
            match self.0.get(&place) {
                Some(Way::Open | Way::Circular) => return true,
                Some(Way::Ends) => {}
                None => {
                    self.0.insert(place.clone(), Way::Open);
                    steps.push(Step { place, next });
                }
            }
        }
        false
    }
}
