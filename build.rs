//! Puts the papers under `proofs/` and the systems under `examples/` into the program, so that an installed one has them: writes a list of their files, of which
//! the compiler reads each. Only the program depends on them and not the library, so that an edit of a proof compiles little.
//!
//! And what `palmistry --version --verbose` says of this build. The commit is the one that a release names (`PALMISTRY_COMMIT`), or that a
//! packed crate carries with it: a tree that is being worked on has none, and is not built again for each new one.

use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The paper that is taken where none is named.
const FIRST: &str = "moll2002";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let root = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("proofs");
    let mut papers: Vec<PathBuf> =
        entries(&root).into_iter().filter(|path| path.join("paper.toml").is_file()).collect();
    papers.sort_by_key(|path| (path.file_name() != Some(FIRST.as_ref()), path.clone()));
    let mut list = String::from("&[\n");
    for paper in papers {
        // which files there are: a paper that gets a new one says so in its paper.toml
        println!("cargo::rerun-if-changed={}", paper.join("paper.toml").display());
        let mut files = Vec::new();
        collect(&paper, &mut files);
        for file in files {
            let name =
                file.strip_prefix(&root).expect("it was found there").to_str().expect("names are UTF-8");
            let name = name.replace(std::path::MAIN_SEPARATOR, "/");
            let _ = writeln!(list, "    ({name:?}, include_bytes!({:?})),", file.display().to_string());
        }
    }
    // the systems that the book and the lab show
    let examples = root.with_file_name("examples").join("systems");
    println!("cargo::rerun-if-changed={}", examples.display());
    for file in entries(&examples).into_iter().filter(|path| path.is_file()) {
        let name = file.file_name().expect("it is a file").to_str().expect("names are UTF-8");
        let _ =
            writeln!(list, "    (\"examples/{name}\", include_bytes!({:?})),", file.display().to_string());
    }
    list.push_str("]\n");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets it")).join("papers.rs");
    std::fs::write(out, list).expect("the list of papers can be written");
    say_what_is_built(&root);
}

fn say_what_is_built(papers: &Path) {
    let variable = |name: &str| std::env::var(name).ok();
    println!("cargo::rerun-if-env-changed=PALMISTRY_COMMIT");
    let packed = papers.with_file_name(".cargo_vcs_info.json");
    let of_package = || {
        let text = std::fs::read_to_string(&packed).ok()?;
        let (_, rest) = text.split_once("\"sha1\": \"")?;
        Some(rest.split_once('"')?.0.to_owned())
    };
    let commit = variable("PALMISTRY_COMMIT").or_else(of_package);
    let compiler = variable("RUSTC").and_then(|rustc| {
        let output = std::process::Command::new(rustc).arg("--version").output().ok()?;
        String::from_utf8(output.stdout).ok()
    });
    let unknown = || "not known".to_owned();
    let commit = commit.unwrap_or_else(|| "not recorded: built from a working tree".to_owned());
    println!("cargo::rustc-env=PALMISTRY_COMMIT={}", commit.trim());
    println!("cargo::rustc-env=PALMISTRY_COMPILER={}", compiler.unwrap_or_else(unknown).trim());
    println!("cargo::rustc-env=PALMISTRY_TARGET={}", variable("TARGET").unwrap_or_else(unknown));
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    let read = std::fs::read_dir(folder).unwrap_or_else(|why| panic!("{}: {why}", folder.display()));
    let mut found: Vec<PathBuf> = read.map(|entry| entry.expect("an entry can be read").path()).collect();
    found.sort();
    found
}

/// All files of a folder and of its folders, but hidden ones.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for path in entries(folder) {
        let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if path.is_dir() && !hidden {
            collect(&path, files);
        } else if !hidden {
            files.push(path);
        }
    }
}
