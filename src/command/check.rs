//! `palmistry check`: are these files proof files? Nothing is decided.

use super::Status;
use super::interrupt::{begin_to_tell, interrupted};
use super::output::{Files, Form, proof_files};
use clap::Args;
use palmistry::System;
use palmistry::report::read_error_json;
use palmistry::system::{Examination, MOST_PROBLEMS};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Reads proof files, and lists every mistake in each: syntax, names, kinds of values, references. Decides nothing.
///
/// What only follows from another mistake is not reported: a name whose definition cannot be read is not also reported as unknown. Exit
/// status 0 when all files can be used, 2 when one cannot, as with 'prove'.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry check mysystem.proof            every mistake, each at its place
  palmistry check proofs/ --json            the same for an editor: file, line, column, code, message, help")]
pub(crate) struct Check {
    /// Proof files, or folders in which every .proof file is taken.
    #[arg(required = true, value_name = "FILE-OR-FOLDER")]
    pub(super) paths: Vec<PathBuf>,
    /// Print one JSON object: 'ok', 'files', and 'errors' with file, line, column, code, message and help.
    #[arg(long)]
    pub json: bool,
}

impl Check {
    pub fn run(self) -> miette::Result<Status> {
        let paths = proof_files(&self.paths)?;
        let mut examined: Vec<Examination> = Vec::new();
        for path in &paths {
            if interrupted() {
                break;
            }
            examined.push(System::examine(path, MOST_PROBLEMS));
        }
        begin_to_tell();
        let errors = examined.iter().map(|file| file.problems.len()).sum::<usize>();
        let object = json!({
            "ok": errors == 0 && !interrupted(),
            "interrupted": interrupted(),
            "files": examined.len(),
            "errors": examined.iter().flat_map(errors_json).collect::<Vec<_>>(),
            "more": examined.iter().any(|file| file.more),
        });
        let status = match (errors, interrupted()) {
            (0, false) => Status::AsExpected,
            (0, true) => Status::CutOff,
            _ => Status::Unusable,
        };
        Files::default().print(Form::of(self.json), object, || in_words(&examined), status)
    }
}

/// The problems of a file, each as an object.
pub(crate) fn errors_json(file: &Examination) -> impl Iterator<Item = Value> + '_ {
    file.problems.iter().map(read_error_json)
}

/// The problems of a file, each with the text around it.
pub(crate) fn problems_text(file: &Examination) -> String {
    let more = file.more.then(|| format!("and more: the first {MOST_PROBLEMS} are listed\n"));
    let each = file.problems.iter().map(|problem| format!("{:?}", miette::Report::new(problem.clone())));
    each.chain(more).collect::<Vec<_>>().join("\n")
}

fn in_words(examined: &[Examination]) -> String {
    let files = examined.len();
    let errors = examined.iter().map(|file| file.problems.len()).sum::<usize>();
    let with_errors = examined.iter().filter(|file| !file.problems.is_empty()).count();
    let number = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    let mut parts: Vec<String> =
        examined.iter().filter(|file| !file.problems.is_empty()).map(problems_text).collect();
    parts.push(match errors {
        0 => format!("{} can be read", number(files, "file")),
        _ => format!("{} in {with_errors} of {}", number(errors, "error"), number(files, "file")),
    });
    if interrupted() {
        parts.push("interrupted: the other files were not read".to_owned());
    }
    parts.join("\n")
}
