//! `palmistry prove`: every claim of some files.

use super::output::{INTERRUPTED, print_json, print_text, progress, proof_files, write_whole};
use super::{Status, Unusable};
use clap::Args;
use palmistry::report::{claim_json, claim_line, junit};
use palmistry::{Outcome, System, decide_all};
use serde_json::json;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

/// Decides every claim of proof files.
///
/// Exit status 0 only when each claim has the verdict that its file expects: 'claim' proved (or what 'expect' says),
/// 'erratum' with the printed form refuted and the corrected one proved. A claim is about all values of its symbols, whatever
/// values the file gives to parameters; where the verdict at these is another one, that is said too.
#[derive(Args)]
pub(crate) struct Prove {
    /// Proof files, or folders in which every .proof file is taken.
    #[arg(required = true, value_name = "FILE-OR-FOLDER")]
    paths: Vec<PathBuf>,
    /// Print one JSON object: 'claims' with id, verdict, expected, ok, engine, and error_bound or witness.
    #[arg(long)]
    pub json: bool,
    /// Write the outcomes as JUnit XML, for a CI system.
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Seed of the random points.
    #[arg(long, default_value_t = 1, value_name = "S")]
    seed: u64,
}

impl Prove {
    pub fn run(self) -> miette::Result<Status> {
        // read everything before deciding anything: a mistake in the last file should not cost the first ones' time
        let systems: Vec<System> = proof_files(&self.paths)?
            .iter()
            .map(|file| System::read(file).map_err(miette::Report::new))
            .collect::<Result<_, _>>()?;
        let claims: usize = systems.iter().map(|system| system.claims.len()).sum();
        if claims == 0 {
            return Err(Unusable::report(
                "these files claim nothing",
                "add a line such as: claim 1: L(f, x) = v",
            ));
        }
        let bar = progress(claims as u64, "deciding claims");
        let outcomes: Vec<Outcome> = systems
            .iter()
            .flat_map(|system| decide_all(system, self.seed, &INTERRUPTED, &|_| bar.inc(1)))
            .collect();
        bar.finish_and_clear();
        let interrupted = INTERRUPTED.load(Ordering::Relaxed);
        let failed = outcomes.iter().filter(|outcome| !outcome.ok).count();
        if let Some(path) = &self.junit {
            write_whole(path, &junit(&outcomes)?)?;
        }
        if self.json {
            print_json(&json!({
                "ok": failed == 0 && !interrupted,
                "interrupted": interrupted,
                "seed": self.seed,
                "claims": outcomes.iter().map(claim_json).collect::<Vec<_>>(),
            }));
        } else {
            let mut file = "";
            for outcome in &outcomes {
                if outcome.file != file {
                    file = &outcome.file;
                    print_text(file);
                }
                print_text(&claim_line(outcome));
            }
            let words = ["proved", "erratum", "scanning fault", "definition", "refuted", "undecided"];
            let counts: Vec<String> = words
                .iter()
                .map(|word| (outcomes.iter().filter(|outcome| outcome.word() == *word).count(), word))
                .filter(|(count, _)| *count > 0)
                .map(|(count, word)| format!("{count} {word}"))
                .collect();
            print_text(&format!(
                "{} claims: {}; {failed} not as expected",
                outcomes.len(),
                counts.join(", ")
            ));
        }
        let all = failed == 0 && outcomes.len() == claims;
        Ok(if all { Status::AsExpected } else { Status::NotAsExpected })
    }
}
