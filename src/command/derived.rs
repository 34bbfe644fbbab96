//! Proof files that a command writes about another one, which they import: read back, and their claims decided.

use palmistry::foreign::name_of;
use palmistry::{Outcome, System, prove};
use std::path::{Component, Path, PathBuf};

/// A file as it is named from the folder of another one, or from here where that is printed.
pub(crate) fn import_path(file: &Path, out: Option<&Path>) -> String {
    from(out.and_then(Path::parent).unwrap_or(Path::new("")), file)
}

/// A text that imports a file by this path, read as if it were in its folder, and its claims with their verdicts.
///
/// # Errors
/// In words: it cannot be read.
pub(crate) fn decided(
    text: &str,
    import: &str,
    file: &Path,
    out: &Path,
) -> Result<(System, Vec<Outcome>), String> {
    // the folder that the import is named from may not be there yet
    let whole = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    let there = text.replacen(&format!("\"{import}\""), &format!("\"{}\"", name_of(&whole)), 1);
    let read = System::parse(&name_of(out), &there, Path::new(""));
    let system = read.map_err(|error| format!("it cannot be read back: {error}"))?;
    let outcomes = prove(&system);
    Ok((system, outcomes))
}

/// A file as it is named from a folder.
fn from(folder: &Path, file: &Path) -> String {
    let whole = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (folder, file) = (whole(folder_or_here(folder)), whole(file));
    let parts = |path: &Path| -> Vec<String> {
        let plain = path.components().filter(|part| !matches!(part, Component::CurDir));
        plain.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect()
    };
    let (to, at) = (parts(&file), parts(&folder));
    let common = to.iter().zip(&at).take_while(|(one, other)| one == other).count();
    let up = std::iter::repeat_n("..".to_owned(), at.len() - common);
    let path: PathBuf = up.chain(to[common..].iter().cloned()).collect();
    path.to_string_lossy().into_owned()
}

fn folder_or_here(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}
