//! `palmistry fmt`: proof files in their normal form.

use super::interrupt::{interrupted, nothing_found};
use super::output::{Files, Form, proof_files};
use super::{Status, Unusable};
use clap::Args;
use palmistry::file;
use palmistry::foreign::{name_of, shown_path};
use palmistry::system::{Code, format_text};
use serde_json::json;
use std::path::PathBuf;

/// Files longer than this are refused, as by every command that reads them.
const LONGEST_FILE: u64 = 16 << 20;

/// Brings proof files into their normal form: entries at the left edge and what belongs to them further in, columns of '=' in
/// fields and of 'in' in samples, no blanks at the ends of lines, at most one empty line.
///
/// Nothing else is touched: no sign, no comment, no text in quotation marks. A file that cannot be read is left as it is.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry fmt mysystem.proof
  palmistry fmt proofs/ --check             exit status 1 where something would change; nothing is written")]
pub(crate) struct Fmt {
    /// Proof files, or folders in which every .proof file is taken.
    #[arg(required = true, value_name = "FILE-OR-FOLDER")]
    pub(super) paths: Vec<PathBuf>,
    /// Write nothing; say which files are not in normal form.
    #[arg(long)]
    check: bool,
    /// Print one JSON object: 'ok' and 'changed', the files that were or would be changed.
    #[arg(long)]
    pub json: bool,
}

impl Fmt {
    pub fn run(self) -> miette::Result<Status> {
        // all are read before any is written: a mistake in one leaves all as they are
        let mut changed: Vec<(PathBuf, String)> = Vec::new();
        for path in proof_files(&self.paths)? {
            let shown = name_of(&path);
            let text = file::read_text(&path, LONGEST_FILE)
                .map_err(|why| Unusable::report(Code::File, format!("cannot read {shown}: {why}"), ""))?;
            let formatted = format_text(&shown, &text)?;
            if formatted != text {
                changed.push((path, formatted));
            }
        }
        let form = Form::of(self.json);
        let mut files = Files::default();
        if !self.check {
            if interrupted() {
                return nothing_found(form);
            }
            for (path, text) in &changed {
                files.text(path, text);
            }
        }
        let ok = !self.check || changed.is_empty();
        let status = Status::of(ok);
        let words = || {
            let line = |(path, _): &(PathBuf, String)| {
                let what = match self.check {
                    true => "not in normal form",
                    false if files.has_written(path) => "changed",
                    false => "left as it is",
                };
                format!("{what}: {}", shown_path(path))
            };
            match changed.is_empty() {
                true => "all files are in normal form".to_owned(),
                false => changed.iter().map(line).collect::<Vec<_>>().join("\n"),
            }
        };
        let paths: Vec<String> = changed
            .iter()
            .map(|(path, _)| path)
            .filter(|path| files.has_written(path))
            .map(|path| name_of(path))
            .collect();
        let (object, words) = (json!({ "ok": ok, "changed": paths }), words());
        files.print(form, object, || words, status)
    }
}
