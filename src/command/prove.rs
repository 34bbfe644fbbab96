//! `palmistry prove`: every claim of some files.

use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted, watched};
use super::output::{Files, Form, progress, proof_files};
use super::{Status, Unusable};
use clap::Args;
use palmistry::checker::VerdictFile;
use palmistry::claim::{Kept, decide_all_keeping};
use palmistry::report::{claim_json, claim_line, counts_text, junit, statement_latex};
use palmistry::{Outcome, System};
use serde_json::json;
use std::collections::HashMap;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// Decides every claim of proof files.
///
/// Exit status 0 only when each claim has the verdict that its file expects: 'claim' proved (or what 'expect' says),
/// 'erratum' with the printed form refuted and the corrected one proved, and likewise 'damaged', 'scan', 'convention' and
/// 'loose'. A claim whose sides are one expression is 'restated' and not 'proved', which is as expected. A claim is about all values of its symbols, whatever
/// values the file gives to parameters; where the verdict at these is another one, that is said too.
#[derive(Args, Clone)]
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
    /// Write what the verdicts rest on to a file that 'palmistry recheck' checks alone.
    #[arg(long, value_name = "FILE")]
    verdicts: Option<PathBuf>,
    /// Give each statement in LaTeX too: a line of its own, or 'latex' in the JSON.
    #[arg(long)]
    latex: bool,
    /// Seed of the random points.
    #[arg(long, default_value_t = 1, value_name = "S")]
    seed: u64,
}

/// What is decided so far.
#[derive(Default)]
struct Decided {
    /// How many claims there are.
    claims: usize,
    /// The place of each claim, by its file and its name, in the order of the files.
    places: HashMap<(String, String), usize>,
    /// As they were decided.
    outcomes: Vec<Outcome>,
}

impl Prove {
    pub fn run(self) -> miette::Result<Status> {
        let decided = Arc::new(Mutex::new(Decided::default()));
        let (worker, filled) = (self.clone(), decided.clone());
        let work = move || {
            worker.decide(&filled)?;
            begin_to_tell();
            worker.tell(&filled)
        };
        watched(work, || self.tell(&decided))
    }

    /// Decides all claims.
    fn decide(&self, decided: &Mutex<Decided>) -> miette::Result<()> {
        // read everything before deciding anything: a mistake in the last file should not cost the first ones' time
        let systems: Vec<System> = proof_files(&self.paths)?
            .iter()
            .map(|file| System::read(file).map_err(miette::Report::new))
            .collect::<Result<_, _>>()?;
        let names: Vec<(String, String)> = systems
            .iter()
            .flat_map(|system| system.claims.iter().map(|claim| (system.name.clone(), claim.id.clone())))
            .collect();
        let claims = names.len();
        if claims == 0 {
            return Err(Unusable::report(
                "these files claim nothing",
                "add a line such as: claim 1: L(f, x) = v",
            ));
        }
        {
            let mut decided = hold(decided);
            decided.claims = claims;
            decided.places = names.into_iter().zip(0..).collect();
        }
        let kept = if self.verdicts.is_some() { Kept::Evidence } else { Kept::Verdicts };
        let bar = progress(claims as u64, "deciding claims");
        for system in &systems {
            let done = |outcome: &Outcome| {
                hold(decided).outcomes.push(outcome.clone());
                bar.inc(1);
            };
            decide_all_keeping(kept, system, self.seed, &INTERRUPTED, &done);
        }
        bar.finish_and_clear();
        Ok(())
    }

    /// An outcome as JSON, with its formulas where they are asked for.
    fn claim(&self, outcome: &Outcome) -> serde_json::Value {
        let mut object = claim_json(outcome);
        if self.latex {
            object["latex"] = json!(statement_latex(&outcome.statement));
            if let Some((printed, _)) = &outcome.printed {
                object["printed"]["latex"] = json!(statement_latex(printed));
            }
        }
        object
    }

    /// Prints and writes what is decided, in the order of the files.
    fn tell(&self, decided: &Mutex<Decided>) -> miette::Result<Status> {
        let Decided { claims, places, mut outcomes } = std::mem::take(&mut *hold(decided));
        outcomes
            .sort_by_cached_key(|outcome| places.get(&(outcome.file.clone(), outcome.id.clone())).copied());
        let failed = outcomes.iter().filter(|outcome| !outcome.ok).count();
        let mut files = Files::default();
        if let Some(path) = &self.junit {
            files.text_or(path, junit(&outcomes));
        }
        if let Some(path) = &self.verdicts {
            let records = outcomes.iter().flat_map(|outcome| outcome.evidence.iter().cloned()).collect();
            let text = VerdictFile::new(self.seed, records).text();
            files.text_or(path, text);
        }
        let object = json!({
            "ok": failed == 0 && !interrupted(),
            "interrupted": interrupted(),
            "seed": self.seed,
            "claims": outcomes.iter().map(|outcome| self.claim(outcome)).collect::<Vec<_>>(),
        });
        let all = failed == 0 && claims > 0 && outcomes.len() == claims;
        let status = if all { Status::AsExpected } else { Status::NotAsExpected };
        files.print(Form::of(self.json), object, || in_words(&outcomes, claims, self.latex), status)
    }
}

fn hold(decided: &Mutex<Decided>) -> std::sync::MutexGuard<'_, Decided> {
    decided.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The outcomes, a line each, and their number.
fn in_words(outcomes: &[Outcome], claims: usize, latex: bool) -> String {
    let mut text = String::new();
    let mut file = "";
    for outcome in outcomes {
        if outcome.file != file {
            file = &outcome.file;
            let _ = writeln!(text, "{file}");
        }
        let _ = writeln!(text, "{}", claim_line(outcome));
        if let Some(formula) = latex.then(|| statement_latex(&outcome.statement)).flatten() {
            let _ = writeln!(text, "         {:<10} {formula}", "latex");
        }
    }
    let failed = outcomes.iter().filter(|outcome| !outcome.ok).count();
    let _ = write!(text, "{} claims: {}; {failed} not as expected", outcomes.len(), counts_text(outcomes));
    if outcomes.len() < claims {
        let _ = write!(text, "\ninterrupted: {} claims are not decided", claims - outcomes.len());
    } else if claims == 0 {
        let _ = write!(text, "\ninterrupted while the files were read");
    }
    text
}
