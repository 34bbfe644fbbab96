//! `palmistry recheck`: verdicts of a file, evaluated again by the checker alone.

use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted};
use super::output::{Files, Form, progress};
use super::{Status, Unusable};
use clap::Args;
use palmistry::checker::{
    CheckedVerdict, Checking, Effort, Evidence, Finding, LARGEST_FILE, ProofSources, VerdictFile,
};
use palmistry::file::read_text;
use palmistry::foreign::{shown, shown_path};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Checks a file of verdicts that 'prove', 'rank' or 'certify' wrote with '--verdicts', against the proof files that it names.
///
/// Each claim is read from its proof file. A refutation is evaluated again at its witness, a certified rank by its minor and its
/// kernel, a certificate box by box: these are confirmed or not. Of a rank that is not full, one half: that it is no less.
/// A proof cannot be repeated by evaluation: it is consistent where both sides agree at further states. Exit status 0 only
/// when nothing failed.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry prove mysystem.proof --verdicts claims.json && palmistry recheck claims.json
  palmistry recheck claims.json --seed 2                   proofs are tried at other states")]
pub(crate) struct Recheck {
    /// The verdict file.
    file: PathBuf,
    /// The folder from which the names of proof files are read.
    #[arg(long, default_value = ".", value_name = "FOLDER")]
    proofs: PathBuf,
    /// Seed of the states at which proofs are tried.
    #[arg(long, default_value_t = 1, value_name = "S")]
    seed: u64,
    /// Print one JSON object: 'verdicts' with file, id, kind, finding and reason, and the counts.
    #[arg(long)]
    pub json: bool,
}

impl Recheck {
    pub fn run(self) -> miette::Result<Status> {
        let unusable = |why: String| Unusable::report(format!("{}: {why}", shown_path(&self.file)), "");
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
        let words = ["confirmed", "half confirmed", "consistent", "not checked", "NOT CONFIRMED"];
        let count = |word: &str| checked.iter().filter(|verdict| verdict.finding.word() == word).count();
        let failed = count("NOT CONFIRMED");
        let object = json!({
            "ok": failed == 0 && !interrupted(),
            "interrupted": interrupted(),
            "tool": file.tool,
            "confirmed": count("confirmed"),
            "half_confirmed": count("half confirmed"),
            "consistent": count("consistent"),
            "not_checked": count("not checked"),
            "not_confirmed": failed,
            "verdicts": checked.iter().map(verdict_json).collect::<Vec<_>>(),
        });
        let in_words = || {
            let counts: Vec<String> = words
                .iter()
                .map(|word| (count(word), word))
                .filter(|(count, _)| *count > 0)
                .map(|(count, word)| format!("{count} {word}"))
                .collect();
            let lines: Vec<String> = checked.iter().map(verdict_line).collect();
            format!("{}\n{} verdicts: {}", lines.join("\n"), checked.len(), counts.join(", "))
        };
        let status = Status::of(failed == 0);
        Files::default().print(Form::of(self.json), object, in_words, status)
    }
}

fn finding_text(finding: &Finding) -> String {
    match finding {
        Finding::Confirmed { times: 1 } => "evaluated again".to_owned(),
        Finding::Confirmed { times } => format!("evaluated again at {times} states"),
        Finding::Consistent { states: 0 } => {
            "it agrees with its own state, and no other was found".to_owned()
        }
        Finding::Consistent { states } => format!("it agrees with its own state and with {states} others"),
        Finding::HalfConfirmed(half) => half.to_string(),
        Finding::NotChecked(why) => why.to_string(),
        Finding::NotConfirmed(doubt) => doubt.to_string(),
    }
}

fn verdict_json(verdict: &CheckedVerdict<'_>) -> Value {
    json!({
        "file": verdict.record.file,
        "id": verdict.record.id,
        "statement": verdict.record.statement,
        "kind": verdict.record.evidence.word(),
        "finding": verdict.finding.word().to_lowercase(),
        "reason": reason(verdict),
    })
}

fn reason(verdict: &CheckedVerdict<'_>) -> String {
    match &verdict.record.evidence {
        Evidence::Unchecked(why) => why.clone(),
        Evidence::Boxes(boxes) if matches!(verdict.finding, Finding::Confirmed { .. }) => boxes.in_words(),
        _ => finding_text(&verdict.finding),
    }
}

fn verdict_line(verdict: &CheckedVerdict<'_>) -> String {
    let record = verdict.record;
    format!(
        "  {:<14} {:<9} {} {}: {}",
        verdict.finding.word(),
        record.evidence.word(),
        shown(&record.file),
        shown(&record.id),
        shown(&reason(verdict))
    )
}
