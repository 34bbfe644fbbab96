//! `palmistry prove --coq DIR`: claims as theorems that Coq checks alone.

use super::output::Files;
use palmistry::coq::{Exported, exported};
use palmistry::foreign::shown_path;
use palmistry::report::TheoremAddresses;
use palmistry::{Outcome, System, Verdict};
use serde_json::{Value, json};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// The library on which the theorems rest, as it stands in `proofs/coq`.
const LIBRARY: [(&str, &str); 4] = [
    ("Lie.v", include_str!("../../proofs/coq/Lie.v")),
    ("Check.v", include_str!("../../proofs/coq/Check.v")),
    ("Point.v", include_str!("../../proofs/coq/Point.v")),
    ("Rank.v", include_str!("../../proofs/coq/Rank.v")),
];

/// What stands in a folder of theorems.
pub(crate) struct Theorems {
    folder: PathBuf,
    /// How many claims there are.
    claims: usize,
    files: Vec<(String, String, Exported)>,
}

impl Theorems {
    /// The theorems of some files: of the claims that are proved here.
    pub fn of(folder: &Path, systems: &[System], outcomes: &[Outcome]) -> Theorems {
        let decided: HashMap<(&str, &str), &Outcome> =
            outcomes.iter().map(|outcome| ((outcome.file.as_str(), outcome.id.as_str()), outcome)).collect();
        let mut modules: HashSet<String> = LIBRARY.iter().map(|(name, _)| name.to_lowercase()).collect();
        let file = |system: &System| {
            let wanted = |id: &str| match decided.get(&(system.name.as_str(), id)) {
                None => Err("it was not decided".to_owned()),
                Some(outcome) => match &outcome.verdict {
                    Verdict::Proved { .. } => Ok(()),
                    other => Err(format!("palmistry's verdict is '{}'", other.word())),
                },
            };
            let mut name = module(&system.name);
            while !modules.insert(format!("{name}.v").to_lowercase()) {
                name.push('_');
            }
            (system.name.clone(), format!("{name}.v"), exported(system, &wanted))
        };
        let claims = systems.iter().map(|system| system.claims.len()).sum();
        Theorems { folder: folder.to_owned(), claims, files: systems.iter().map(file).collect() }
    }

    /// Writes them, the library, and what the tools of Coq need to know.
    pub fn write(&self, files: &mut Files) {
        let mut project = "-Q . Palmistry\n".to_owned();
        for (name, text) in LIBRARY {
            files.text(&self.folder.join(name), text);
            project.push_str(&format!("{name}\n"));
        }
        for (_, name, found) in &self.files {
            files.text(&self.folder.join(name), &found.text);
            project.push_str(&format!("{name}\n"));
        }
        files.text(&self.folder.join("_CoqProject"), &project);
    }

    /// Where each is written, by the file and the id of its claim: in this folder as a page names it.
    pub fn addresses(&self, folder: &str) -> TheoremAddresses {
        let of = |(file, name, found): &(String, String, Exported)| {
            let ids = found.claims.iter().chain(&found.reached).chain(&found.refuted);
            ids.map(|id| ((file.clone(), id.clone()), format!("{folder}/{name}"))).collect::<Vec<_>>()
        };
        self.files.iter().flat_map(of).collect()
    }

    /// As JSON: for each file how many claims are theorems, and which are none, with the reason.
    pub fn object(&self) -> Value {
        let file = |(file, name, found): &(String, String, Exported)| {
            let left_out: Vec<Value> =
                found.left_out.iter().map(|one| json!({ "id": one.id, "reason": one.reason })).collect();
            json!({ "file": file, "coq": name, "theorems": found.claims, "reached": found.reached, "refuted": found.refuted, "left_out": left_out })
        };
        json!({ "folder": shown_path(&self.folder), "files": self.files.iter().map(file).collect::<Vec<_>>() })
    }

    /// In words, with what to do next.
    pub fn in_words(&self) -> String {
        let count =
            |of: fn(&Exported) -> usize| self.files.iter().map(|(_, _, found)| of(found)).sum::<usize>();
        let (theorems, refuted) = (count(|found| found.claims.len()), count(|found| found.refuted.len()));
        let reached = count(|found| found.reached.len());
        let folder = shown_path(&self.folder);
        format!(
            "{folder}: {theorems} of {} claims as theorems; of {reached} more on ranks, that these are reached; {refuted} wrong forms refuted at a state; others are at the end of each file, with reasons\n\
             check them there: coq_makefile -f _CoqProject -o Makefile && make",
            self.claims
        )
    }
}

/// The name of a module of Coq for a proof file: that of the file without its folders.
fn module(file: &str) -> String {
    let name =
        Path::new(file).file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let plain: String =
        name.chars().map(|sign| if sign.is_ascii_alphanumeric() { sign } else { '_' }).collect();
    match plain.chars().next() {
        Some(first) if first.is_ascii_alphabetic() => plain,
        _ => format!("file_{plain}"),
    }
}
