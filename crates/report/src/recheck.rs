//! What a checker has found of the verdicts of a file.

use crate::layout::counted;
use palmistry_checker::{CheckedVerdict, Evidence, Finding, VerdictFile};
use palmistry_io::foreign::shown;
use serde_json::{Value, json};

/// The names of findings, from the best to the worst.
const WORDS: [&str; 5] = ["confirmed", "half confirmed", "consistent", "not checked", FAILED];

/// The name of what the checker contradicts.
const FAILED: &str = "NOT CONFIRMED";

fn count(checked: &[CheckedVerdict<'_>], word: &str) -> usize {
    checked.iter().filter(|verdict| verdict.finding.word() == word).count()
}

/// Whether the checker contradicts any of these verdicts.
pub fn has_failed(checked: &[CheckedVerdict<'_>]) -> bool {
    count(checked, FAILED) > 0
}

/// The findings as an object: `verdicts` with file, id, kind, finding and reason, and the counts.
pub fn recheck_json(file: &VerdictFile, checked: &[CheckedVerdict<'_>], interrupted: bool) -> Value {
    let [confirmed, half_confirmed, consistent, not_checked, not_confirmed] =
        WORDS.map(|word| count(checked, word));
    json!({
        "ok": not_confirmed == 0 && !interrupted,
        "interrupted": interrupted,
        "tool": file.tool,
        "confirmed": confirmed,
        "half_confirmed": half_confirmed,
        "consistent": consistent,
        "not_checked": not_checked,
        "not_confirmed": not_confirmed,
        "verdicts": checked.iter().map(verdict_json).collect::<Vec<_>>(),
    })
}

/// A line a verdict, and the counts.
pub fn recheck_text(checked: &[CheckedVerdict<'_>]) -> String {
    let counts: Vec<String> = WORDS
        .iter()
        .map(|word| (count(checked, word), word))
        .filter(|(count, _)| *count > 0)
        .map(|(count, word)| format!("{count} {word}"))
        .collect();
    let lines: Vec<String> = checked.iter().map(verdict_line).collect();
    format!("{}\n{}: {}", lines.join("\n"), counted(checked.len(), "verdict"), counts.join(", "))
}

fn finding_text(finding: &Finding) -> String {
    match finding {
        Finding::Confirmed { times: 1 } => "evaluated again".to_owned(),
        Finding::Shown(ground) => ground.to_string(),
        Finding::Confirmed { times } => format!("evaluated again at {}", counted(*times, "state")),
        Finding::Consistent { states: 0 } => {
            "it agrees with its own state, and no other was found".to_owned()
        }
        Finding::Consistent { states } => {
            format!("it agrees with its own state and with {}", counted(*states, "other"))
        }
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
        Evidence::Unchecked(why) if !matches!(verdict.finding, Finding::Shown(_)) => why.clone(),
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
