//! Each module is a floor and imports only from those above it in `src/lib.rs`; within a folder no file needs another one
//! that needs it in turn. Read from the imports themselves; tests may look at everything.

mod features;
mod source;

use source::{Crate, ModulePath};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Folders with files that need each other, and why.
const CIRCLES: [(&str, &str); 1] =
    [("system", "what a file says and what a system is refer to each other, and are read in one pass")];

fn ours() -> Crate {
    Crate::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"))
}

fn text(path: &[String]) -> String {
    if path.is_empty() { "the crate".to_owned() } else { path.join("::") }
}

/// What is imported from a later floor than one's own. What `main.rs` declares is above all floors.
fn upward(modules: &Crate) -> Vec<String> {
    let floors = modules.floors();
    let floor = |path: &ModulePath| match path.first() {
        Some(first) => floors.iter().position(|floor| floor == first).unwrap_or(floors.len()),
        // the root passes on names of all floors, and is imported from by none
        None => floors.len() + 1,
    };
    let mut found = Vec::new();
    for from in modules.modules().filter(|path| !path.is_empty()) {
        let above = |to: &ModulePath| floor(to) > floor(from);
        found.extend(
            modules
                .needed(from)
                .iter()
                .filter(|to| above(to))
                .map(|to| format!("{} needs {}", text(from), text(to))),
        );
    }
    found
}

/// The sets of modules side by side that need each other, by their folder.
fn circles(modules: &Crate) -> BTreeMap<ModulePath, BTreeSet<ModulePath>> {
    let folders: BTreeSet<&[String]> =
        modules.modules().filter_map(|path| path.split_last()).map(|(_, folder)| folder).collect();
    let mut found = BTreeMap::new();
    for folder in folders {
        // what lies below a module counts for it
        let member = |path: &ModulePath| {
            let inside = path.len() > folder.len() && path.starts_with(folder);
            inside.then(|| path[..=folder.len()].to_vec())
        };
        let mut needs: BTreeMap<ModulePath, BTreeSet<ModulePath>> = BTreeMap::new();
        for from in modules.modules() {
            let Some(own) = member(from) else { continue };
            let others =
                modules.needed(from).iter().filter_map(member).filter(|to| *to != own).collect::<Vec<_>>();
            needs.entry(own).or_default().extend(others);
        }
        let reached = |from: &ModulePath| {
            let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
            while let Some(at) = open.pop() {
                open.extend(needs[at].iter().filter(|next| seen.insert((*next).clone())));
            }
            seen
        };
        let tied: BTreeSet<ModulePath> =
            needs.keys().filter(|path| reached(path).contains(*path)).cloned().collect();
        if !tied.is_empty() {
            found.insert(folder.to_vec(), tied);
        }
    }
    found
}

#[test]
fn a_floor_imports_from_lower_floors_only() {
    let modules = ours();
    assert!(modules.floors().len() > 15, "{:?}", modules.floors());
    let found = upward(&modules);
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn no_file_needs_one_beside_it_that_needs_it() {
    let mut found = circles(&ours());
    for (folder, why) in CIRCLES {
        let path: ModulePath = folder.split("::").map(str::to_owned).collect();
        assert!(
            found.remove(&path).is_some(),
            "no circle in {folder} any more, and its exception stays: {why}"
        );
    }
    let lines: Vec<String> = found
        .iter()
        .map(|(folder, tied)| {
            format!("{}: {}", text(folder), tied.iter().map(|path| text(path)).collect::<Vec<_>>().join(", "))
        })
        .collect();
    assert!(lines.is_empty(), "files that need each other:\n{}", lines.join("\n"));
}

/// The page for contributors names every floor, and no file that is not there.
#[test]
fn the_house_in_one_page_is_this_house() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(root.join("CONTRIBUTING.md")).expect("the page");
    let words: Vec<&str> = page.split('`').skip(1).step_by(2).collect();
    for floor in ours().floors().iter().map(String::as_str).chain(["command"]) {
        assert!(words.contains(&floor), "'{floor}' is not named");
    }
    let is_path = |word: &&&str| {
        word.contains('/') && !word.contains([' ', '=']) && !word.contains(|c: char| c.is_ascii_uppercase())
    };
    let paths: Vec<&&str> = words.iter().filter(is_path).collect();
    assert!(paths.len() > 25, "{paths:?}");
    for path in paths {
        let places = ["", "src", "src/system", "src/number", "src/observability", "tests/claims"];
        let is_there = places.iter().any(|folder| root.join(folder).join(path).exists());
        // a folder that is left out of the package
        assert!(is_there || path.starts_with(".ci/"), "'{path}' is not there");
    }
}

/// What is public is unique in the crate: a second thing of a name carries its noun.
#[test]
fn a_public_type_has_a_name_of_its_own() {
    let modules = ours();
    let mut places: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (path, name) in modules.public_types() {
        places.entry(name).or_default().push(text(path));
    }
    assert!(places.len() > 250 && places["System"] == ["system::model"], "{} types", places.len());
    places.retain(|_, places| places.len() > 1);
    assert!(places.is_empty(), "{places:#?}");
}

/// What the other tests rest on: nothing is found only where nothing is.
#[test]
fn imports_are_seen_in_every_form() {
    let known = |from: &[&str], to: &[&str]| {
        let path = |parts: &[&str]| parts.iter().map(|part| (*part).to_owned()).collect::<ModulePath>();
        ours().needed(&path(from)).contains(&path(to))
    };
    // by a name that `expression/mod.rs` passes on, by one that `claim/mod.rs` does, by one that begins with a module
    assert!(known(&["observability", "conditions", "single"], &["expression", "sign"]));
    assert!(known(&["report", "claims", "outcomes"], &["claim", "verdict"]));
    assert!(known(&["number", "instructions", "portable"], &["number", "sine"]));

    let made = |files: &[(&str, &str)]| {
        let mut modules = Crate::default();
        modules.add(ModulePath::new(), "pub mod low; pub mod high; pub use high::Top;");
        for (path, text) in files {
            modules.add(path.split("::").map(str::to_owned).collect(), text);
        }
        modules
    };
    let forms = [
        "use crate::high::Top;",
        "use crate::{high::{self, Top}};",
        "use crate::high; fn f() -> high::Top { todo!() }",
        "fn f(_: &crate::high::Top) {}",
        "fn f() { let _ = super::high::Top::new(); }",
        "use super::high::Top as Other;",
        "use crate::Top;",
    ];
    for form in forms {
        let modules = made(&[("low", form), ("high", "pub struct Top;")]);
        assert_eq!(upward(&modules).len(), 1, "{form}");
    }
    let blind = [
        "// use crate::high::Top;",
        "fn f() -> &'static str { \"crate::high::Top\" }",
        "#[cfg(test)]\nmod tests { use crate::high::Top; }",
        "fn f() -> char { '\"' } /* crate::high::Top */",
        "use std::high::Top;",
    ];
    for form in blind {
        let modules = made(&[("low", form), ("high", "use crate::low::Low;")]);
        assert_eq!(upward(&modules), Vec::<String>::new(), "{form}");
        assert_eq!(modules.needed(&vec!["high".to_owned()]).len(), 1);
    }
    let tied = made(&[
        ("low", "mod a; mod b; mod c; pub use c::C;"),
        ("low::a", "use super::b::inner::B;"),
        ("low::b", "mod inner;"),
        ("low::b::inner", "use super::super::C;"),
        ("low::c", "pub struct C(crate::low::a::A);"),
        ("high", ""),
    ]);
    let found = circles(&tied);
    assert_eq!(found.keys().collect::<Vec<_>>(), [&vec!["low".to_owned()]]);
    assert_eq!(found[&vec!["low".to_owned()]].len(), 3);
}
