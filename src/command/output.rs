//! What all commands print alike: JSON, progress, errors, and files that are whole or not there.

use super::{Status, Unusable};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use miette::Report;
use palmistry::experiment::Scene;
use palmistry::foreign::{json_text, name_of, shown_path};
use palmistry::observer::Record;
use palmistry::report::{read_error_json, versioned};
use palmistry::system::Code;
use palmistry::{ReadError, file};
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether what is printed is a stream of objects, of which each has a line.
static IN_LINES: AtomicBool = AtomicBool::new(false);

/// From now on every object that is printed is one line: results, errors, and what an interrupt leaves.
pub(crate) fn print_in_lines() {
    IN_LINES.store(true, Ordering::Relaxed);
}

/// Prints an object to standard output with its version, indented, or as one line of a stream.
pub(crate) fn print_json(object: &Value) -> miette::Result<()> {
    let in_lines = IN_LINES.load(Ordering::Relaxed);
    print_text(&json_text(&versioned(object.clone()), !in_lines))
}

/// Prints a text and the end of its line to standard output. A reader that has gone away is no error of ours.
pub(crate) fn print_text(text: &str) -> miette::Result<()> {
    file::print(&format!("{text}\n")).map_err(|error| {
        let help = "nothing of what was found is kept: free some space, or send it elsewhere";
        Unusable::report(Code::Place, format!("cannot write to standard output: {error}"), help)
    })
}

/// The files that a command writes beside what it prints. What cannot be written is noted and costs no result: it is
/// still printed, and the exit status is 2.
#[derive(Default)]
pub(crate) struct Files {
    failures: Vec<Failure>,
}

struct Failure {
    file: PathBuf,
    why: String,
    /// What can be done about it.
    help: &'static str,
}

/// Where the file is at fault.
const ANOTHER_PLACE: &str = "the results are printed; name a place that can be written, or free some space";

impl Files {
    /// Writes a text.
    pub fn text(&mut self, path: &Path, text: &str) {
        let written = file::write_whole(path, |file| file.write_all(text.as_bytes()));
        self.note(path, written.map_err(|error| format!("cannot write {}: {error}", shown_path(path))));
    }

    /// Writes a text that may have failed to come about: then there is nothing to write, and that is noted.
    pub fn text_or(&mut self, path: &Path, text: Result<String, impl std::fmt::Display>) {
        match text {
            Ok(text) => self.text(path, &text),
            Err(why) => {
                let why = format!("{} is not written: {why}", shown_path(path));
                self.failures.push(Failure { file: path.to_owned(), why, help: "the results are printed" });
            }
        }
    }

    /// Writes an object as JSON, indented, with its version.
    pub fn json(&mut self, path: &Path, object: &Value) {
        let object = versioned(object.clone());
        self.text(path, &format!("{}\n", json_text(&object, true)));
    }

    /// Writes a record, CSV or Parquet by the extension.
    pub fn table(&mut self, path: &Path, table: &Record) {
        self.note(path, table.write(path).map_err(|error| error.to_string()));
    }

    /// Writes a file as it is found.
    pub fn table_of(
        &mut self,
        path: &Path,
        fill: impl FnOnce(&mut (dyn Write + Send)) -> std::io::Result<()>,
    ) {
        let written = file::write_whole(path, fill);
        self.note(path, written.map_err(|error| format!("cannot write {}: {error}", shown_path(path))));
    }

    fn note(&mut self, path: &Path, written: Result<(), String>) {
        if let Err(why) = written {
            self.failures.push(Failure { file: path.to_owned(), why, help: ANOTHER_PLACE });
        }
    }

    /// Whether nothing went wrong with a file.
    pub fn has_written(&self, path: &Path) -> bool {
        self.failures.iter().all(|failure| failure.file != path)
    }

    /// Says on standard error that a file was written, if it was.
    pub fn announce(&self, path: &Path) {
        if path != Path::new("-") && self.has_written(path) {
            file::note(&format!("written: {}", shown_path(path)));
        }
    }

    /// What a run has come to that prints nothing else: whether all was written.
    pub fn status(self, status: Status) -> Status {
        self.note_failures();
        if self.whole() { status } else { Status::Unwritten }
    }

    /// Whether all was written so far.
    pub fn whole(&self) -> bool {
        self.failures.is_empty()
    }

    /// Prints what was found, in the form that is asked for, and after it what could not be written.
    pub fn print(
        self,
        form: Form,
        mut object: Value,
        text: impl FnOnce() -> String,
        status: Status,
    ) -> miette::Result<Status> {
        self.note_in(&mut object);
        match form {
            Form::Json => print_json(&object)?,
            Form::Text => print_text(&text())?,
        }
        self.note_failures();
        Ok(if self.whole() { status } else { Status::Unwritten })
    }

    /// Names in an object what could not be written, if there is anything.
    pub fn note_in(&self, object: &mut Value) {
        if !self.whole() {
            object["unwritten"] = self
                .failures
                .iter()
                .map(|failure| json!({ "file": name_of(&failure.file), "why": failure.why }))
                .collect();
        }
    }

    /// Says on standard error what could not be written.
    pub fn note_failures(&self) {
        for failure in &self.failures {
            file::note(&format!("{:?}", Unusable::report(Code::Place, failure.why.clone(), failure.help)));
        }
    }
}

/// How results are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    Json,
    Text,
}

impl Form {
    /// What `--json` asks for.
    pub fn of(json: bool) -> Form {
        if json { Form::Json } else { Form::Text }
    }
}

/// An error as JSON, with the place where it points into a file.
pub(crate) fn error_json(report: &Report) -> Value {
    let mut error = json!({ "message": report.to_string() });
    if let Some(unusable) = report.downcast_ref::<Unusable>() {
        error["code"] = json!(unusable.code.id());
        if !unusable.help.is_empty() {
            error["help"] = json!(unusable.help);
        }
    } else if let Some(help) = report.help() {
        error["help"] = json!(help.to_string());
    }
    if let Some(read) = report.downcast_ref::<ReadError>() {
        error = read_error_json(read);
    }
    json!({ "error": error })
}

/// What is wrong with the command line, as JSON: the first line is the message, the rest says what to do.
pub(crate) fn usage_json(text: &str) -> Value {
    let (message, rest) = text.split_once('\n').unwrap_or((text, ""));
    let message = message.strip_prefix("error: ").unwrap_or(message);
    let help = rest.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n");
    json!({ "error": { "message": message, "code": Code::Option.id(), "help": help } })
}

/// A progress bar on standard error, shown only where that is a terminal.
pub(crate) fn progress(length: u64, what: &'static str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr());
    let template = "{msg:>28} [{bar:40}] {pos}/{len} {elapsed}";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_message(what);
    bar
}

/// A count of what was done where nobody knows how much there is.
pub(crate) fn counter(what: &'static str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{msg:>28} {pos} {elapsed}") {
        bar.set_style(style);
    }
    bar.set_message(what);
    bar
}

/// A progress bar for a fraction between zero and one, in parts of ten thousand; its message says the rest.
pub(crate) fn fraction_bar(what: &'static str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(10_000), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{prefix:>12} [{bar:40}] {msg} {elapsed}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_prefix(what);
    bar
}

/// Reads a scene of planar motion. Keys under a name that they had before are read as well, with a note; and those that change nothing, since no
/// method of the scene heeds them, are named.
pub(crate) fn read_scene(path: &Path) -> miette::Result<Scene> {
    let scene = Scene::read(path)?;
    for (old, new) in scene.old_keys() {
        file::note(&format!("note: {}: the key '{old}' is called '{new}' now", shown_path(path)));
    }
    for (key, methods) in scene.unheeded_keys() {
        let path = shown_path(path);
        file::note(&format!(
            "note: {path}: '{key}' changes nothing: it is for {methods}, and 'methods' has none"
        ));
    }
    Ok(scene)
}

/// All proof files that the paths name: files as they are, folders with everything below them, in order of name.
pub(crate) fn proof_files(paths: &[PathBuf]) -> miette::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() {
            let before = files.len();
            collect(path, &mut files).map_err(|e| {
                Unusable::report(Code::File, format!("cannot read {}: {e}", shown_path(path)), "")
            })?;
            if files.len() == before {
                let message = format!("there is no .proof file below {}", shown_path(path));
                return Err(Unusable::report(Code::File, message, "name a file, or a folder that has some"));
            }
        } else {
            files.push(path.clone());
        }
    }
    Ok(files)
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder)?.map(|entry| entry.map(|e| e.path())).collect::<Result<_, _>>()?;
    entries.sort();
    for entry in entries {
        if entry.is_dir() && !entry.is_symlink() {
            collect(&entry, files)?;
        } else if entry.extension().is_some_and(|e| e == "proof") {
            files.push(entry);
        }
    }
    Ok(())
}
