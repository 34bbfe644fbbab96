//! `palmistry recheck`: verdicts of a file, evaluated again by the checker alone.

use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted};
use super::output::{Files, Form, progress};
use super::{Status, Unusable};
use clap::Args;
use palmistry::checker::{Checking, Effort, Finding, LARGEST_FILE, ProofSources, Unchecked, VerdictFile};
use palmistry::file::read_text;
use palmistry::foreign::{shown, shown_path};
use palmistry::report::{has_failed, recheck_json, recheck_text};
use palmistry::system::Code;
use std::path::PathBuf;

/// Checks a file of verdicts that 'prove', 'rank' or 'certify' wrote with '--verdicts', against the proof files that it names.
///
/// Each claim is read from its proof file. A refutation is evaluated again at its witness, a certified rank by its minor and its
/// kernel, a certificate box by box: these are confirmed or not. An equation is confirmed where both sides become the same expression when
/// multiplied out, a generic rank and what is observable by elimination among the expressions themselves. What takes too much
/// work for that is shown at random points modulo primes, where degrees are bounded, or is tested at further states, and is half confirmed or
/// consistent. Exit status 0 only when nothing failed.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry prove mysystem.proof --verdicts claims.json && palmistry recheck claims.json
  palmistry recheck claims.json --seed 2                   proofs are tested at other states")]
pub(crate) struct Recheck {
    /// The verdict file.
    pub(super) file: PathBuf,
    /// The folder from which the names of proof files are read.
    #[arg(long, default_value = ".", value_name = "FOLDER")]
    proofs: PathBuf,
    /// Seed of the states at which proofs are tested.
    #[arg(long, default_value_t = 1, value_name = "S")]
    seed: u64,
    /// Print one JSON object: 'verdicts' with file, id, kind, finding and reason, and the counts.
    #[arg(long)]
    pub json: bool,
}

impl Recheck {
    pub fn run(self) -> miette::Result<Status> {
        let unusable =
            |why: String| Unusable::report(Code::Saved, format!("{}: {why}", shown_path(&self.file)), "");
        let text = read_text(&self.file, LARGEST_FILE).map_err(|why| unusable(why.to_string()))?;
        let file = VerdictFile::read(&text).map_err(|why| unusable(why.to_string()))?;
        drop(text);
        let bar = progress(file.verdicts.len() as u64, "checking verdicts");
        let sources = ProofSources::below(self.proofs.clone());
        let effort = Effort::default();
        let with = Checking { sources: &sources, seed: self.seed, effort: &effort, interrupt: &INTERRUPTED };
        let checked = file.check(with, &|| bar.inc(1));
        bar.finish_and_clear();
        begin_to_tell();
        // a folder that is not theirs would leave every verdict unchecked, and none in doubt
        let missing: Option<Vec<&String>> = checked
            .iter()
            .map(|verdict| match &verdict.finding {
                Finding::NotChecked(Unchecked::NoProofFile(why)) => Some(why),
                _ => None,
            })
            .collect();
        if let Some(why) = missing.as_deref().and_then(<[_]>::first) {
            return Err(Unusable::report(
                Code::Saved,
                format!(
                    "{}: no proof file that it names can be read: {}",
                    shown_path(&self.file),
                    shown(why)
                ),
                "--proofs names the folder from which the names of proof files are read",
            ));
        }
        let failed = has_failed(&checked);
        let object = recheck_json(&file, &checked, interrupted());
        let in_words = || recheck_text(&checked);
        let status = Status::of(!failed);
        Files::default().print(Form::of(self.json), object, in_words, status)
    }
}
