//! What each crate may know of the others: its manifest says it, and this says what no manifest may come to say.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The folders under `crates/`; none in a package, which has the root alone.
pub fn crates() -> Vec<String> {
    let Ok(folder) = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("crates")) else {
        return Vec::new();
    };
    let mut names: Vec<String> = folder
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.join("Cargo.toml").is_file())
        .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned())
        .collect();
    names.sort();
    names
}

/// A manifest and its `[dependencies]`, those of tests left out: our crates by their folders, others by their names.
fn dependencies(name: &str) -> (BTreeSet<String>, BTreeSet<String>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates").join(name).join("Cargo.toml");
    let manifest: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    let all = manifest["dependencies"].as_table().unwrap().keys();
    let (ours, others): (Vec<&String>, Vec<&String>) = all.partition(|key| key.starts_with("palmistry-"));
    let ours = ours.into_iter().map(|key| key["palmistry-".len()..].to_owned());
    (ours.collect(), others.into_iter().cloned().collect())
}

/// All crates that a crate is built on.
fn under(name: &str, known: &BTreeMap<String, BTreeSet<String>>) -> BTreeSet<String> {
    let (mut found, mut open) = (BTreeSet::new(), vec![name.to_owned()]);
    while let Some(at) = open.pop() {
        open.extend(known[&at].iter().filter(|next| found.insert((*next).clone())).cloned());
    }
    found
}

/// The invariants of ARCHITECTURE.md: of each crate, what it must not be built on, however far below.
const APART: [(&str, &[&str]); 9] = [
    // what checks a verdict shares nothing with what found it
    ("checker", &["inequality", "rank", "prove", "observe", "scenes"]),
    // theorems for Coq are written from what was read, and from nothing that was found
    ("coq", &["inequality", "rank", "prove", "checker", "observe", "scenes"]),
    // real bodies are a second witness for the physics: they read no proof file
    ("bodies", &["lang", "rank", "prove", "observe"]),
    // numbers and expressions know no file and no system
    ("math", &["io", "lang"]),
    // what is counted knows nothing of what it counts
    ("budget", &["io", "math"]),
    // observers know systems and signals, and neither ranks nor palms
    ("observe", &["rank", "prove", "bodies"]),
    // theorems take nothing from touch
    ("prove", &["bodies", "observe", "scenes"]),
    ("rank", &["bodies", "observe", "scenes", "prove", "checker"]),
    ("lsp", &["rank", "prove", "observe"]),
];

#[test]
fn what_a_crate_must_not_know_it_does_not() {
    let names = crates();
    if names.is_empty() {
        return; // a package has the root alone
    }
    let known: BTreeMap<String, BTreeSet<String>> =
        names.iter().map(|name| (name.clone(), dependencies(name).0)).collect();
    assert!(under("report", &known).len() > 8 && under("scenes", &known).contains("bodies"), "{known:?}");
    for (name, forbidden) in APART {
        let found = under(name, &known);
        let wrong: Vec<&&str> = forbidden.iter().filter(|one| found.contains(**one)).collect();
        assert!(wrong.is_empty(), "{name} is built on {wrong:?}");
    }
}

/// A crate whose examples are not run has none: what is shown as code and is no text would be believed.
#[test]
fn examples_in_documentation_are_run() {
    for name in crates() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates").join(&name);
        let manifest: toml::Table =
            std::fs::read_to_string(folder.join("Cargo.toml")).unwrap().parse().unwrap();
        let is_run = manifest.get("lib").and_then(|lib| lib.get("doctest")).and_then(toml::Value::as_bool);
        if is_run != Some(false) {
            continue;
        }
        for (path, text) in super::source::files(&folder.join("src")) {
            let fences = text.lines().map(str::trim_start).filter_map(|line| {
                line.strip_prefix("///").or_else(|| line.strip_prefix("//!"))?.trim().strip_prefix("```")
            });
            let wrong = fences.step_by(2).find(|language| *language != "text");
            assert_eq!(wrong, None, "{}: an example that is not run", path.display());
        }
    }
}

/// Nothing under `report` writes JSON but what speaks to editors and to the lab's page, sealed parts and the verdict files that the checker reads.
#[test]
fn only_reports_know_json() {
    let knowing: Vec<String> =
        crates().into_iter().filter(|name| dependencies(name).1.contains("serde_json")).collect();
    assert!(knowing.is_empty() || knowing == ["checker", "io", "lab", "lsp", "report"], "{knowing:?}");
}
