//! What the manifests of the crates cannot say, and what they have to say. Within a crate a module imports only from those above it in its `lib.rs`, and
//! no file needs one beside it that needs it in turn; the names of public types are unique in all crates. Read from the imports themselves; tests
//! may look at everything.

mod features;
mod manifests;
mod source;
mod words;

use source::{Crate, ModulePath};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Folders with files that need each other, and why.
const CIRCLES: [(&str, &str, &str); 1] =
    [("lang", "", "what a file says and what a system is refer to each other, and are read in one pass")];

/// The crates of more than one module, whose modules stand in the order in which they may import from each other.
const IN_ORDER: [&str; 6] = ["io", "math", "rank", "prove", "bodies", "workbench"];

/// The root package and the crates that it consists of, by the names of their folders. None where they are no part of what is tested: a
/// package that is published has the root alone.
fn ours() -> Vec<(String, Crate)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = vec![("palmistry".to_owned(), Crate::read(&root.join("src")))];
    for name in manifests::crates() {
        found.push((name.clone(), Crate::read(&root.join("crates").join(&name).join("src"))));
    }
    found
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
fn a_module_imports_from_those_above_it_only() {
    for (name, modules) in ours() {
        if IN_ORDER.contains(&name.as_str()) {
            assert!(modules.floors().len() > 1, "{name}: {:?}", modules.floors());
            let found = upward(&modules);
            assert!(found.is_empty(), "{name}: {}", found.join("\n"));
        }
    }
}

#[test]
fn no_file_needs_one_beside_it_that_needs_it() {
    let mut lines = Vec::new();
    for (name, modules) in ours() {
        let mut found = circles(&modules);
        for (_, folder, why) in CIRCLES.iter().filter(|(own, _, _)| *own == name) {
            let path: ModulePath =
                folder.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect();
            assert!(
                found.remove(&path).is_some(),
                "no circle in {name} {folder} any more, and its exception stays: {why}"
            );
        }
        lines.extend(found.iter().map(|(folder, tied)| {
            let tied = tied.iter().map(|path| text(path)).collect::<Vec<_>>().join(", ");
            format!("{name}, {}: {tied}", text(folder))
        }));
    }
    assert!(lines.is_empty(), "files that need each other:\n{}", lines.join("\n"));
}

/// The page for contributors names every crate, and no file that is not there.
#[test]
fn the_house_in_one_page_is_this_house() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let crates = manifests::crates();
    for name in ["CONTRIBUTING.md", "ARCHITECTURE.md"] {
        let page = std::fs::read_to_string(root.join(name)).expect("the page");
        let words: Vec<&str> = page.split('`').skip(1).step_by(2).collect();
        for one in crates.iter().map(String::as_str).filter(|_| name == "ARCHITECTURE.md") {
            assert!(words.contains(&format!("crates/{one}").as_str()), "'{one}' is not named in {name}");
        }
        let is_path = |word: &&&str| {
            word.contains('/')
                && !word.contains([' ', '='])
                && !word.contains(|c: char| c.is_ascii_uppercase())
                && !word.contains("//")
        };
        let paths: Vec<&&str> = words.iter().filter(is_path).collect();
        assert!(paths.len() > 13, "{paths:?}");
        for path in paths {
            let is_there = ["", "crates", "src", "tests/claims"]
                .iter()
                .any(|folder| root.join(folder).join(path).exists());
            // folders that are left out of the package
            assert!(
                is_there || path.starts_with(".ci/") || crates.is_empty(),
                "{name}: '{path}' is not there"
            );
        }
    }
}

/// What is public is unique in all crates: a second thing of a name carries its noun.
#[test]
fn a_public_type_has_a_name_of_its_own() {
    let all = ours();
    let mut places: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (own, modules) in &all {
        for (path, name) in modules.public_types() {
            places.entry(name).or_default().push(format!("{own}::{}", text(path)));
        }
    }
    assert!(
        all.len() == 1 || places.len() > 250 && places["System"] == ["lang::model"],
        "{} types",
        places.len()
    );
    places.retain(|_, places| places.len() > 1);
    assert!(places.is_empty(), "{places:#?}");
}

/// What the other tests rest on: nothing is found only where nothing is.
#[test]
fn imports_are_seen_in_every_form() {
    let all = ours();
    let known = |own: &str, from: &[&str], to: &[&str]| {
        let path = |parts: &[&str]| parts.iter().map(|part| (*part).to_owned()).collect::<ModulePath>();
        let found = all.iter().find(|(name, _)| name == own).map(|(_, modules)| modules.needed(&path(from)));
        found.is_some_and(|found| found.contains(&path(to)))
    };
    if all.len() > 1 {
        // by a name that `observability/mod.rs` passes on, by one that `certificate/mod.rs` does, by one that begins with a module
        assert!(known("rank", &["sweep", "deviation"], &["observability", "state"]));
        assert!(known("prove", &["drops", "on_box"], &["certificate", "region"]));
        assert!(known("math", &["number", "instructions", "portable"], &["number", "sine"]));
    }

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
