//! Files that came with the program: papers, so that an installed program has them wherever it runs. Their paths begin with
//! [`PACKED`], and whoever reads a file by its path reads these too.

use std::io::{Error, ErrorKind, Result};
use std::path::{Component, Path, PathBuf};
use std::sync::OnceLock;

/// A file that came with the program: its path under [`PACKED`], and what stands in it.
pub type PackedFile = (&'static str, &'static [u8]);

/// What the paths of such files begin with, as in `papers:moll2002/general.proof`.
pub const PACKED: &str = "papers:";

static FILES: OnceLock<&'static [PackedFile]> = OnceLock::new();

/// Makes files known that came with the program. Only the first call does anything.
pub fn pack(files: &'static [PackedFile]) {
    let _ = FILES.set(files);
}

/// The path of a packed file within the pack, without `.` and `..`; nothing for a path on the disk.
fn within(path: &Path) -> Option<String> {
    let rest = path.to_str()?.strip_prefix(PACKED)?;
    let mut parts: Vec<&str> = Vec::new();
    for component in Path::new(rest).components() {
        match component {
            Component::Normal(part) => parts.push(part.to_str()?),
            Component::ParentDir => drop(parts.pop()),
            _ => {}
        }
    }
    Some(parts.join("/"))
}

fn files() -> &'static [PackedFile] {
    FILES.get().copied().unwrap_or_default()
}

/// The bytes of a packed file. `None` where the path is one of the disk.
pub(super) fn bytes(path: &Path) -> Option<Result<&'static [u8]>> {
    let name = within(path)?;
    let found = files().iter().find(|(known, _)| *known == name).map(|(_, bytes)| *bytes);
    Some(found.ok_or_else(|| Error::new(ErrorKind::NotFound, "no file of this name came with the program")))
}

/// Whether there is a file under a path.
pub fn is_file(path: &Path) -> bool {
    bytes(path).map_or_else(|| path.is_file(), |found| found.is_ok())
}

/// Whether there is a folder under a path.
pub fn is_folder(path: &Path) -> bool {
    match within(path) {
        None => path.is_dir(),
        Some(folder) => files().iter().any(|(known, _)| known.starts_with(&format!("{folder}/"))),
    }
}

/// One path for one file, however it was reached.
///
/// # Errors
/// There is no such file.
pub fn identity(path: &Path) -> Result<PathBuf> {
    match (bytes(path), within(path)) {
        (Some(found), Some(name)) => found.map(|_| PathBuf::from(format!("{PACKED}{name}"))),
        _ => path.canonicalize(),
    }
}

/// The files in a folder, not those in folders of it, in order of their names.
///
/// # Errors
/// It cannot be read.
pub fn files_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    match within(folder) {
        Some(name) => {
            let inside = files().iter().filter_map(|(known, _)| known.strip_prefix(&format!("{name}/")));
            found.extend(inside.filter(|rest| !rest.contains('/')).map(|rest| folder.join(rest)));
        }
        None => {
            for entry in std::fs::read_dir(folder)? {
                let path = entry?.path();
                if path.is_file() {
                    found.push(path);
                }
            }
        }
    }
    found.sort();
    Ok(found)
}

/// The folders that came with the program, in the order in which they were packed.
pub fn packed_folders() -> Vec<&'static str> {
    let mut found: Vec<&str> =
        files().iter().filter_map(|(known, _)| Some(known.split_once('/')?.0)).collect();
    found.dedup();
    found
}
