//! The folder that is served: its proof files are listed and read, and written where the page saves one.

use super::work::error;
use palmistry_io::file::write_whole;
use serde_json::{Value, json};
use std::path::{Component, Path, PathBuf};

/// More files are not listed, nor more entries of folders looked at.
const MOST_FILES: usize = 2000;
const MOST_ENTRIES: usize = 50_000;
/// Folders in folders beyond this are not looked into.
const DEEPEST: usize = 8;
/// Longer files are not read.
const LONGEST: u64 = 16 << 20;

/// What is asked of the folder.
pub(super) fn respond(folder: &Path, path: &str, asked: &Value) -> Value {
    match path {
        "/api/files" => json!({ "kind": "done", "files": list(folder) }),
        "/api/read" => match read(folder, text(asked, "file")) {
            Ok(text) => json!({ "kind": "done", "text": text }),
            Err(why) => error(&why, ""),
        },
        _ => match save(folder, text(asked, "file"), text(asked, "text"), asked["was"].as_str()) {
            Ok(()) => json!({ "kind": "done" }),
            Err(why) => error(&why, "download it instead, or choose another name"),
        },
    }
}

fn text<'v>(asked: &'v Value, key: &str) -> &'v str {
    asked[key].as_str().unwrap_or_default()
}

/// The proof files, by their paths within the folder.
fn list(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    look(folder, Path::new(""), DEEPEST, (&mut found, &mut 0));
    found.sort();
    found
}

fn look(folder: &Path, within: &Path, deep: usize, (found, looked): (&mut Vec<String>, &mut usize)) {
    let Ok(entries) = std::fs::read_dir(folder.join(within)) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        // links are not followed, and what is hidden stays so
        let (Ok(kind), false) = (entry.file_type(), name.to_string_lossy().starts_with('.')) else {
            continue;
        };
        let path = within.join(&name);
        *looked += 1;
        if found.len() >= MOST_FILES || *looked > MOST_ENTRIES {
            return;
        }
        if kind.is_dir() && deep > 0 {
            look(folder, &path, deep - 1, (found, looked));
        } else if kind.is_file()
            && is_proof(&path)
            && let Some(path) = path.to_str()
        {
            found.push(path.replace(std::path::MAIN_SEPARATOR, "/"));
        }
    }
}

fn is_proof(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == "proof")
}

/// The path of a proof file in the folder.
fn inside(folder: &Path, name: &str) -> Result<PathBuf, String> {
    let path = Path::new(name);
    let is_plain = path.components().all(|part| matches!(part, Component::Normal(_)));
    let has_odd_letters = name.chars().any(|c| c.is_control() || c == '\\');
    if !is_plain || !is_proof(path) || has_odd_letters {
        return Err("a file is named by a path within the folder that ends with .proof".to_owned());
    }
    let path = folder.join(path);
    let parent = path.parent().unwrap_or(folder).canonicalize();
    let parent = parent.map_err(|why| format!("{name} cannot be used: {why}"))?;
    // a link, of the file or of a folder before it, leads elsewhere
    let is_link = path.symlink_metadata().is_ok_and(|found| !found.is_file());
    if !parent.starts_with(folder) || is_link {
        return Err(format!("{name} lies outside of the folder that is served"));
    }
    Ok(path)
}

fn read(folder: &Path, name: &str) -> Result<String, String> {
    let path = inside(folder, name)?;
    palmistry_io::file::read_text(&path, LONGEST).map_err(|why| format!("{name} cannot be read: {why}"))
}

/// Writes a file whole, or keeps the old one. The file has to be as the page last read it, or absent where the page knows of none:
/// somebody else may have written it.
fn save(folder: &Path, name: &str, text: &str, was: Option<&str>) -> Result<(), String> {
    let path = inside(folder, name)?;
    let is = if path.exists() { Some(read(folder, name)?) } else { None };
    match (was, is) {
        (None, Some(_)) => {
            return Err(format!("{name} is there already, and this text was not opened from it"));
        }
        (Some(was), Some(is)) if was != is => return Err(format!("{name} was changed since it was opened")),
        _ => {}
    }
    let written = write_whole(&path, |file| file.write_all(text.as_bytes()));
    written.map_err(|why| format!("{name} cannot be written: {why}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_proof_files_of_the_folder_are_read_and_written() {
        let outer = tempfile::tempdir().expect("a folder");
        let folder = outer.path().canonicalize().expect("it is there").join("served");
        std::fs::create_dir_all(folder.join("sub")).expect("folders");
        std::fs::write(outer.path().join("secret.proof"), "secret").expect("written");
        std::fs::write(folder.join("notes.txt"), "notes").expect("written");
        std::fs::write(folder.join(".hidden.proof"), "hidden").expect("written");
        for name in ["a.proof", "sub/b.proof"] {
            save(&folder, name, "text", None).expect("it lies within");
            assert_eq!(read(&folder, name).as_deref(), Ok("text"));
        }
        assert_eq!(list(&folder), ["a.proof", "sub/b.proof"]);
        #[cfg(unix)]
        {
            let link =
                |to: &Path, name: &str| std::os::unix::fs::symlink(to, folder.join(name)).expect("a link");
            link(&outer.path().join("secret.proof"), "link.proof");
            link(outer.path(), "out");
            assert_eq!(list(&folder), ["a.proof", "sub/b.proof"]);
        }
        let absolute = outer.path().join("secret.proof").display().to_string();
        for name in [
            "../secret.proof",
            "notes.txt",
            "sub/../../secret.proof",
            &absolute,
            "link.proof",
            "out/secret.proof",
            "",
            ".",
            "nowhere/a.proof",
            "a.proof\n",
            "..\\secret.proof",
            "sub",
        ] {
            assert!(read(&folder, name).is_err(), "{name}");
            assert!(save(&folder, name, "x", None).is_err(), "{name}");
            assert!(save(&folder, name, "x", Some("secret")).is_err(), "{name}");
        }
        assert_eq!(
            std::fs::read_to_string(outer.path().join("secret.proof")).expect("it is there"),
            "secret"
        );
    }
}
