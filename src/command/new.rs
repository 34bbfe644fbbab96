//! `palmistry new`: a folder to begin with.

use super::output::{Files, Form};
use super::{Status, Unusable};
use clap::Args;
use palmistry::foreign::{name_of, shown_path};
use palmistry::paper::MANIFEST;
use palmistry::system::Code;
use serde_json::json;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The files of a folder: names and texts.
pub(super) type Folder<'a> = &'a [(&'a str, &'a str)];

/// The files of a new paper.
const TEMPLATE: Folder<'_> = &[
    (MANIFEST, include_str!("template/paper.toml")),
    ("pendulum.proof", include_str!("template/pendulum.proof")),
];

/// Makes a folder with a small paper whose claims are all proved, for you to change: a system, claims, sets and pictures, with a comment on
/// each line.
///
/// The folder must not be there yet, or be empty.
#[derive(Args)]
#[command(after_help = "Example:
  palmistry new mypaper && palmistry verify mypaper")]
pub(crate) struct New {
    /// The folder to make.
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// Print one JSON object: 'folder' and 'files'.
    #[arg(long)]
    pub json: bool,
}

impl New {
    pub fn run(self) -> miette::Result<Status> {
        let folder = &self.folder;
        refuse_taken(folder)?;
        fill(folder, TEMPLATE).map_err(|error| {
            Unusable::report(
                Code::Place,
                format!("cannot make {}: {error}", shown_path(folder)),
                "choose another place",
            )
        })?;
        let paths: Vec<PathBuf> = TEMPLATE.iter().map(|(name, _)| folder.join(name)).collect();
        let shown = shown_path(folder);
        let words =
            || format!("{shown} is a paper whose claims are all proved; next: palmistry verify {shown}");
        let object = json!({ "folder": name_of(folder), "files": paths.iter().map(|path| name_of(path)).collect::<Vec<_>>() });
        Files::default().print(Form::of(self.json), object, words, Status::AsExpected)
    }
}

/// Fills a folder beside the one that is wanted, and moves it there: it is whole or not there.
pub(super) fn fill(folder: &Path, files: Folder<'_>) -> std::io::Result<()> {
    let parent = match folder.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(parent)?;
    let aside = tempfile::Builder::new().prefix(".new-paper-").tempdir_in(parent)?;
    for (name, text) in files {
        std::fs::write(aside.path().join(name), text)?;
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // a folder for passing things is closed to others, and this one is not
        std::fs::set_permissions(aside.path(), std::fs::Permissions::from_mode(0o755))?;
    }
    // an empty folder gives way
    match std::fs::remove_dir(folder) {
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    std::fs::rename(aside.path(), folder)?;
    // it has gone to its place: there is nothing left to remove
    let _ = aside.keep();
    Ok(())
}

/// Refuses a place at which something is.
pub(super) fn refuse_taken(folder: &Path) -> miette::Result<()> {
    let taken = |what: &str| {
        let message = format!("{} {what}", shown_path(folder));
        Err(Unusable::report(
            Code::Place,
            message,
            "name a folder that is not there yet; nothing was written",
        ))
    };
    match std::fs::read_dir(folder) {
        Ok(mut entries) => match entries.next() {
            Some(_) => taken("is not empty"),
            None => Ok(()),
        },
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Err(error) if error.kind() == ErrorKind::NotADirectory => taken("is no folder"),
        Err(error) => taken(&format!("cannot be looked at: {error}")),
    }
}
