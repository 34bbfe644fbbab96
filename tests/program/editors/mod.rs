//! What editors and manual readers get: the language server, the grammar for highlighting, the manual pages.
//!
//! Oracles: `palmistry check` for mistakes; positions counted by hand; the words of the reader itself.

mod damaged;
mod grammar;
mod manual;
#[cfg(unix)]
mod session;
mod textmate;

use std::path::{Path, PathBuf};

/// All proof files that come with the program.
fn shipped() -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            match path.extension().and_then(|extension| extension.to_str()) {
                _ if path.is_dir() => folders.push(path),
                Some("proof") => found.push(path),
                _ => {}
            }
        }
    }
    found.sort();
    assert!(found.len() > 30, "{}", found.len());
    found
}
