//! Puts the papers under `proofs/` into the program, so that an installed one has them: writes a list of their files, of which
//! the compiler reads each. Only the program depends on them and not the library, so that an edit of a proof compiles little.

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
    list.push_str("]\n");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets it")).join("papers.rs");
    std::fs::write(out, list).expect("the list of papers can be written");
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
