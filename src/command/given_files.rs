//! The files of a command line: whether they are there and of the kind that the command takes, and whether what is to be written
//! can have the name that is given. All of it is said before anything is done.

use super::{Unusable, Verb};
use miette::Report;
use palmistry::file::{PACKED, files_in, is_file, is_folder, read_head};
use palmistry::foreign::{shown, shown_path};
use palmistry::system::{Code, nearest_file};
use std::path::Path;

/// What a file is by the end of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Proof,
    Scene,
    Table,
    Json,
    /// A model of another program.
    Model,
}

impl Kind {
    /// None where the name says nothing.
    fn of(path: &Path) -> Option<Kind> {
        let end = path.extension()?.to_str()?.to_ascii_lowercase();
        Some(match end.as_str() {
            "proof" => Kind::Proof,
            "toml" => Kind::Scene,
            "csv" | "parquet" => Kind::Table,
            "json" => Kind::Json,
            _ => return None,
        })
    }

    fn text(self) -> &'static str {
        match self {
            Kind::Proof => "a proof file",
            Kind::Scene => "a scene",
            Kind::Table => "a table of measurements",
            Kind::Json => "a file of verdicts",
            Kind::Model => "a model of another program",
        }
    }
}

/// A file that a command is given.
pub(super) struct Given<'a> {
    pub path: &'a Path,
    /// What it has to be.
    pub wanted: Kind,
    /// Whether a folder of such files is taken as well.
    pub or_folder: bool,
}

impl<'a> Given<'a> {
    pub fn one(path: &'a Path, wanted: Kind) -> Given<'a> {
        Given { path, wanted, or_folder: false }
    }

    pub fn or_folder(path: &'a Path) -> Given<'a> {
        Given { path, wanted: Kind::Proof, or_folder: true }
    }

    /// Why it cannot be used.
    fn refused(&self, verb: &str) -> Option<Report> {
        let shown = shown_path(self.path);
        let name = self.path.to_string_lossy();
        let is_stream = self.path == Path::new("-");
        if is_stream && self.wanted != Kind::Proof || name.starts_with(PACKED) {
            return None;
        }
        if is_folder(self.path) {
            // of scenes and recordings the readers say it
            let help = || format!("name {} in it", self.wanted.text());
            return (!self.or_folder && self.wanted == Kind::Proof).then(|| {
                Unusable::report(Code::File, format!("cannot read {shown}: it is a folder"), help())
            });
        }
        // what is there and cannot be read is said by who reads it
        let is_missing = !is_file(self.path)
            && std::fs::metadata(self.path).is_err_and(|why| why.kind() == std::io::ErrorKind::NotFound);
        if is_missing || is_stream {
            let what = if self.or_folder { "folder or file" } else { "file" };
            return Some(Unusable::report(
                Code::File,
                format!("there is no {what} {shown}"),
                self.meant(verb),
            ));
        }
        if verb == "verify" && self.path.ends_with("paper.toml") {
            return None;
        }
        let found = Kind::of(self.path).filter(|found| *found != self.wanted)?;
        let help = instead(self.path, found, self.wanted, verb)?;
        let message =
            format!("{shown} is {}, and '{verb}' takes {}", what_it_is(self.path, found), self.wanted.text());
        Some(Unusable::report(Code::File, message, help))
    }

    /// What may be meant by a file that is not there.
    fn meant(&self, verb: &str) -> String {
        let name = self.path.to_string_lossy();
        let near = |path: &Path| nearest_file(path).map(|near| format!("perhaps you meant '{near}'"));
        let rules: [(bool, &dyn Fn() -> String); 5] = [
            (name == "-", &|| "a proof file is read from a file, not from standard input".to_owned()),
            (name.starts_with("file://"), &|| {
                format!("name it without file://: {}", &name["file://".len()..])
            }),
            (name.contains("://"), &|| "files are not fetched: save it first".to_owned()),
            (name.contains('*'), &|| format!("a folder takes all files in it, as in 'palmistry {verb} .'")),
            (name.contains(',') && Path::new(name.split(',').next().unwrap_or_default()).exists(), &|| {
                format!("names of files stand with blanks between them, and '{verb}' may take one only")
            }),
        ];
        if let Some((_, help)) = rules.iter().find(|(is_so, _)| *is_so) {
            return help();
        }
        let help = near(self.path).or_else(|| others(self.path));
        help.unwrap_or_else(|| "a file is looked for from the folder in which you are; a name with blanks stands in quotation marks".to_owned())
    }
}

/// So many files of a folder are listed.
const LISTED: usize = 6;

/// The other files of the kind in the folder of one that is not there.
fn others(path: &Path) -> Option<String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let files = files_in(folder).ok()?;
    let mut same =
        files.iter().filter(|file| file.extension().is_some() && file.extension() == path.extension());
    let names: Vec<_> =
        same.by_ref().take(LISTED).filter_map(|file| file.file_name()?.to_str()).map(shown).collect();
    let more = if same.next().is_some() { ", ..." } else { "" };
    (!names.is_empty()).then(|| format!("the folder has {}{more}", names.join(", ")))
}

/// What a file is, a little closer.
fn what_it_is(path: &Path, found: Kind) -> &'static str {
    match found {
        _ if path.ends_with("paper.toml") => "the list of a paper",
        Kind::Json if !is_verdicts(path) => "a JSON file",
        found => found.text(),
    }
}

fn is_verdicts(path: &Path) -> bool {
    read_head(path, 4096).is_ok_and(|head| String::from_utf8_lossy(&head).contains("\"verdicts\""))
}

/// What to do with a file that this command does not take.
fn instead(path: &Path, found: Kind, wanted: Kind, verb: &str) -> Option<String> {
    let shown = shown_path(path);
    if path.ends_with("paper.toml") && wanted == Kind::Proof {
        return Some("name the folder in which it lies: palmistry verify FOLDER".to_owned());
    }
    Some(match (found, wanted) {
        // readers of recordings and of models say what they read
        (_, Kind::Table) | (Kind::Table | Kind::Json, Kind::Model) => return None,
        (Kind::Scene, Kind::Model) => format!("palmistry observe {shown}"),
        (Kind::Proof, Kind::Model) => format!("it is one already: palmistry check {shown}"),
        (_, Kind::Json) => "verdicts are written by 'palmistry prove FILE.proof --verdicts FILE'".to_owned(),
        (Kind::Scene, _) => {
            format!("palmistry observe {shown}; its proof file stands in it, as in model = \"...\"")
        }
        (Kind::Table, _) => format!("palmistry observe SCENE --data {shown}"),
        (Kind::Proof, _) => match verb {
            "advise" => format!("palmistry advise {shown} --identify all"),
            _ => format!("palmistry rank {shown}; or name it in a scene: model = \"{shown}\""),
        },
        (Kind::Json, Kind::Proof) if is_verdicts(path) => format!("palmistry recheck {shown}"),
        (Kind::Json, Kind::Proof) => "a proof file begins with: system \"what it is\"".to_owned(),
        (Kind::Json | Kind::Model, _) => return None,
    })
}

/// What a command is to write.
pub(super) enum Written<'a> {
    /// A table, CSV or Parquet by its extension.
    Table(&'static str, &'a Path),
    /// Files into a folder.
    Folder(&'static str, &'a Path),
}

impl Written<'_> {
    /// Why it cannot be written so.
    fn refused(&self) -> Option<Report> {
        match *self {
            Written::Table(option, path) => {
                let is_known = path == Path::new("-") || Kind::of(path) == Some(Kind::Table);
                let message = || format!("{} is neither a .csv nor a .parquet file", shown_path(path));
                let help = || format!("a table's format is given by its extension, as in {option} run.csv");
                (!is_known).then(|| Unusable::report(Code::Option, message(), help()))
            }
            Written::Folder(option, path) => {
                let message = || format!("{} is a file, and {option} names a folder", shown_path(path));
                let help = "name a folder: it need not be there yet";
                path.is_file().then(|| Unusable::report(Code::Option, message(), help))
            }
        }
    }
}

/// Refuses a command line whose files cannot be used.
///
/// # Errors
/// The first of them.
pub(super) fn refuse(verb: &Verb) -> miette::Result<()> {
    let name = verb.name();
    let refused = verb.given().iter().find_map(|given| given.refused(name));
    match refused.or_else(|| verb.written().iter().find_map(Written::refused)) {
        Some(report) => Err(report),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_another_kind_are_told_apart() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.proof", "a.toml", "a.csv", "a.json", "paper.toml", "note.txt"] {
            std::fs::write(folder.path().join(name), "{}").unwrap();
        }
        for (verb, name, wanted, told) in [
            ("rank", "a.toml", Kind::Proof, Some("is a scene, and 'rank' takes a proof file")),
            ("rank", "a.csv", Kind::Proof, Some("is a table of measurements")),
            ("rank", "a.json", Kind::Proof, Some("is a JSON file")),
            ("prove", "paper.toml", Kind::Proof, Some("is the list of a paper")),
            ("verify", "paper.toml", Kind::Proof, None),
            ("observe", "a.proof", Kind::Scene, Some("is a proof file, and 'observe' takes a scene")),
            ("observe", "a.csv", Kind::Scene, Some("is a table of measurements")),
            ("recheck", "a.proof", Kind::Json, Some("takes a file of verdicts")),
            ("import", "a.proof", Kind::Model, Some("takes a model of another program")),
            ("rank", "b", Kind::Proof, Some("there is no file")),
            ("rank", "a", Kind::Proof, Some("there is no file")),
            ("rank", "a.proof", Kind::Proof, None),
            ("rank", "note.txt", Kind::Proof, None),
            ("import", "a.json", Kind::Model, None),
        ] {
            let path = folder.path().join(name);
            let refused = Given::one(&path, wanted).refused(verb).map(|report| report.to_string());
            assert_eq!(refused.is_some(), told.is_some(), "{verb} {name}: {refused:?}");
            assert!(refused.unwrap_or_default().contains(told.unwrap_or_default()), "{verb} {name}");
        }
        let near = Given::one(&folder.path().join("a"), Kind::Proof).meant("rank");
        assert!(near.starts_with("perhaps you meant '"), "{near}");
    }

    #[test]
    fn what_cannot_be_written_is_told_at_once() {
        assert!(Written::Table("--record", Path::new("a.xlsx")).refused().is_some());
        assert!(Written::Table("--record", Path::new("a.CSV")).refused().is_none());
        assert!(Written::Table("--record", Path::new("-")).refused().is_none());
        let file = tempfile::NamedTempFile::new().unwrap();
        assert!(Written::Folder("--out", file.path()).refused().is_some());
        assert!(Written::Folder("--out", Path::new("not/there")).refused().is_none());
    }
}
