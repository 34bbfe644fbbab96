//! Names of places on the page: unique, and such that they can stand in an address.

use palmistry_prove::claim::Outcome;
use palmistry_workbench::paper::FileFindings;
use std::collections::{BTreeMap, BTreeSet};

/// Where each claim, file and line of a file is found on the page.
pub(super) struct Anchors {
    /// By the place of a file.
    files: Vec<String>,
    /// By the place of a file and the id of a claim.
    claims: BTreeMap<(usize, String), String>,
    /// The line of a claim in its file, counted from one.
    lines: BTreeMap<(usize, String), usize>,
    /// Where the theorem of a claim is written.
    theorems: BTreeMap<(usize, String), String>,
}

/// The addresses of theorems, by the file and the id of the claim, relative to the page.
pub type TheoremAddresses = BTreeMap<(String, String), String>;

/// A text without what has a meaning in addresses.
fn plain(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '_' }).collect()
}

/// The name of a file without its folders and its ending.
pub(super) fn stem(name: &str) -> &str {
    let name = name.rsplit(['/', '\\']).next().unwrap_or(name);
    name.strip_suffix(".proof").unwrap_or(name)
}

/// The wish, or the wish with a number behind it where it is taken.
fn unique(wish: String, taken: &mut BTreeSet<String>) -> String {
    let mut found = wish.clone();
    let mut count = 1;
    while !taken.insert(found.clone()) {
        count += 1;
        found = format!("{wish}-{count}");
    }
    found
}

impl Anchors {
    /// The names of everything in some files. `reserved` are names that the page has given already.
    pub fn new(files: &[FileFindings], reserved: &[&str], theorems: &TheoremAddresses) -> Anchors {
        let mut taken: BTreeSet<String> = reserved.iter().map(|name| (*name).to_owned()).collect();
        let mut anchors = Anchors {
            files: Vec::new(),
            claims: BTreeMap::new(),
            lines: BTreeMap::new(),
            theorems: BTreeMap::new(),
        };
        for file in files {
            anchors.files.push(unique(plain(stem(&file.system.name)), &mut taken));
        }
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for claim in files.iter().flat_map(|file| &file.system.claims) {
            *counts.entry(&claim.id).or_default() += 1;
        }
        for (place, file) in files.iter().enumerate() {
            for claim in &file.system.claims {
                // short addresses: the file only where two have a claim of the same name
                let wish = match counts.get(claim.id.as_str()) {
                    Some(1) => plain(&claim.id),
                    _ => format!("{}-{}", anchors.files[place], plain(&claim.id)),
                };
                anchors.claims.insert((place, claim.id.clone()), unique(wish, &mut taken));
                let before = file.system.source.get(..claim.span.start).unwrap_or_default();
                let line = 1 + before.bytes().filter(|byte| *byte == b'\n').count();
                anchors.lines.insert((place, claim.id.clone()), line);
                if let Some(address) = theorems.get(&(file.system.name.clone(), claim.id.clone())) {
                    anchors.theorems.insert((place, claim.id.clone()), address.clone());
                }
            }
        }
        anchors
    }

    /// The name of a file's text.
    pub fn file(&self, file: usize) -> &str {
        self.files.get(file).map_or("", String::as_str)
    }

    /// The name of a claim's entry.
    pub fn claim(&self, file: usize, id: &str) -> &str {
        self.claims.get(&(file, id.to_owned())).map_or("", String::as_str)
    }

    /// The line on which a claim begins.
    pub fn line(&self, file: usize, id: &str) -> Option<usize> {
        self.lines.get(&(file, id.to_owned())).copied()
    }

    /// Where the theorem of a claim is written, if there is one.
    pub fn theorem(&self, file: usize, id: &str) -> Option<&str> {
        self.theorems.get(&(file, id.to_owned())).map(String::as_str)
    }

    /// The name of a line: in a name of the others there is no colon.
    pub fn line_name(file: usize, line: usize) -> String {
        format!("{file}:{line}")
    }

    /// The lines of a file that something points to.
    pub fn lines_of(&self, file: usize) -> BTreeSet<usize> {
        self.lines.iter().filter(|((place, _), _)| *place == file).map(|(_, line)| *line).collect()
    }
}

/// A claim with the file that it stands in.
#[derive(Clone, Copy)]
pub(super) struct Placed<'a> {
    pub file: usize,
    pub outcome: &'a Outcome,
}

/// All claims, in the order of the files.
pub(super) fn placed(files: &[FileFindings]) -> Vec<Placed<'_>> {
    let of = |(file, found): (usize, &'_ FileFindings)| -> Vec<(usize, usize)> {
        (0..found.outcomes.len()).map(|place| (file, place)).collect()
    };
    let places: Vec<(usize, usize)> = files.iter().enumerate().flat_map(of).collect();
    places.into_iter().map(|(file, place)| Placed { file, outcome: &files[file].outcomes[place] }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_can_stand_in_an_address_and_are_unique() {
        assert_eq!(plain("4.31.s2 ä/#\""), "4.31.s2_____");
        assert_eq!(stem("a/b/general.proof"), "general");
        let mut taken = BTreeSet::from(["claims".to_owned()]);
        assert_eq!(unique("claims".into(), &mut taken), "claims-2");
        assert_eq!(unique("claims".into(), &mut taken), "claims-3");
        assert_eq!(unique("x".into(), &mut taken), "x");
    }
}
