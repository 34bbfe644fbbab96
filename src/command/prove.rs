//! `palmistry prove`: every claim of some files.

use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted, watched};
use super::output::{Files, Form, progress, proof_files};
use super::terminal::layout;
use super::watch::Watch;
use super::{Status, Unusable};
use clap::Args;
use palmistry::checker::VerdictFile;
use palmistry::claim::{Kept, Selection, UnmetPattern, decide_all_keeping};
use palmistry::report::{ClaimsForm, ClaimsSummary, Shown, claim_json, claims_text, junit, statement_latex};
use palmistry::{Outcome, System};
use serde_json::json;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Decides every claim of proof files.
///
/// Exit status 0 only when each claim has the verdict that its file expects: 'claim' proved (or what 'expect' says),
/// 'erratum' with the printed form refuted and the corrected one proved, and likewise 'damaged', 'scan', 'convention' and
/// 'loose'. A claim whose sides are one expression is 'restated' and not 'proved', which is as expected. A claim is about all values of its symbols, whatever
/// values the file gives to parameters; where the verdict at these is another one, that is said too.
#[derive(Args, Clone)]
#[command(after_help = "Examples:
  palmistry prove mysystem.proof            each claim with its verdict
  palmistry prove proofs/ -q                only what is not as expected: statement, place, both sides at a witness
  palmistry prove mysystem.proof --only 4.48 --only 'reduce.*'
  palmistry prove mysystem.proof --watch    again whenever the file is changed
  palmistry prove proofs/ --junit claims.xml --verdicts claims.json")]
pub(crate) struct Prove {
    /// Proof files, or folders in which every .proof file is taken.
    #[arg(required = true, value_name = "FILE-OR-FOLDER")]
    pub(super) paths: Vec<PathBuf>,
    /// Decide only these claims: by id, by the part of ids before a dot ('4.44' is '4.44.r1' too), or with '*' for any
    /// characters (may be repeated).
    #[arg(long, value_name = "ID")]
    only: Vec<String>,
    /// Print only what is not as expected, and the summary.
    #[arg(short, long)]
    quiet: bool,
    /// Decide again whenever a file is changed, or one that it imports, until it is interrupted. Only files that are changed,
    /// or import what is changed, are decided again. With --json each report is one line.
    #[arg(long)]
    watch: bool,
    /// Print one JSON object: 'claims' with id, file, line, column, statement, verdict, expected, ok, engine, and error_bound
    /// or witness.
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
    pub(super) seed: u64,
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
        if self.watch {
            // what was told stays told
            return watched(move || Watch::of(self).run(), || Ok(Status::NotAsExpected));
        }
        let decided = Arc::new(Mutex::new(Decided::default()));
        let (worker, filled) = (self.clone(), decided.clone());
        let begin = Instant::now();
        let work = move || {
            worker.decide(&filled)?;
            begin_to_tell();
            worker.tell(&filled, begin)
        };
        watched(work, || self.tell(&decided, begin))
    }

    /// The claims that are asked for.
    pub(super) fn selection(&self) -> Selection {
        Selection::new(&self.only)
    }

    /// Reads all files, and keeps the claims that are asked for.
    fn read(&self) -> miette::Result<Vec<System>> {
        // read everything before deciding anything: a mistake in the last file should not cost the first ones' time
        let mut systems: Vec<System> = proof_files(&self.paths)?
            .iter()
            .map(|file| System::read(file).map_err(miette::Report::new))
            .collect::<Result<_, _>>()?;
        let selection = self.selection();
        let ids = systems.iter().flat_map(|system| &system.claims).map(|claim| claim.id.as_str());
        if let Some(unmet) = selection.unmet(ids) {
            return Err(no_such_claim(&unmet));
        }
        for system in &mut systems {
            system.claims.retain(|claim| selection.keeps(&claim.id));
        }
        Ok(systems)
    }

    /// Decides all claims.
    fn decide(&self, decided: &Mutex<Decided>) -> miette::Result<()> {
        let systems = self.read()?;
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
        let bar = progress(claims as u64, "deciding claims");
        for system in &systems {
            let done = |outcome: &Outcome| {
                hold(decided).outcomes.push(outcome.clone());
                bar.inc(1);
            };
            decide_all_keeping(self.kept(), system, self.seed, &INTERRUPTED, &done);
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

    /// Writes the files that are asked for.
    pub(super) fn written(&self, outcomes: &[Outcome]) -> Files {
        let mut files = Files::default();
        if let Some(path) = &self.junit {
            files.text_or(path, junit(outcomes));
        }
        if let Some(path) = &self.verdicts {
            let records = outcomes.iter().flat_map(|outcome| outcome.evidence.iter().cloned()).collect();
            let text = VerdictFile::new(self.seed, records).text();
            files.text_or(path, text);
        }
        files
    }

    /// What was found, as JSON.
    pub(super) fn object(&self, outcomes: &[Outcome], seconds: f64) -> serde_json::Value {
        json!({
            "ok": outcomes.iter().all(|outcome| outcome.ok) && !interrupted(),
            "interrupted": interrupted(),
            "seed": self.seed,
            "seconds": seconds,
            "claims": outcomes.iter().map(|outcome| self.claim(outcome)).collect::<Vec<_>>(),
        })
    }

    /// What was found, as text.
    pub(super) fn in_words(&self, outcomes: &[Outcome], summary: ClaimsSummary) -> String {
        let shown = if self.quiet { Shown::Unexpected } else { Shown::All };
        claims_text(outcomes, summary, ClaimsForm { shown, latex: self.latex }, &layout())
    }

    /// What is kept of a verdict.
    pub(super) fn kept(&self) -> Kept {
        if self.verdicts.is_some() { Kept::Evidence } else { Kept::Verdicts }
    }

    /// Prints and writes what is decided, in the order of the files.
    fn tell(&self, decided: &Mutex<Decided>, begin: Instant) -> miette::Result<Status> {
        let Decided { claims, places, mut outcomes } = std::mem::take(&mut *hold(decided));
        outcomes
            .sort_by_cached_key(|outcome| places.get(&(outcome.file.clone(), outcome.id.clone())).copied());
        let all = outcomes.iter().all(|outcome| outcome.ok) && claims > 0 && outcomes.len() == claims;
        let status = if all { Status::AsExpected } else { Status::NotAsExpected };
        let summary = ClaimsSummary { claims, seconds: begin.elapsed().as_secs_f64() };
        let object = self.object(&outcomes, summary.seconds);
        let in_words = || self.in_words(&outcomes, summary);
        self.written(&outcomes).print(Form::of(self.json), object, in_words, status)
    }
}

/// That a pattern of `--only` is met by no claim.
pub(super) fn no_such_claim(unmet: &UnmetPattern) -> miette::Report {
    let help = unmet.nearest.as_ref().map(|near| format!("perhaps you meant '{near}'"));
    Unusable::report(unmet.to_string(), help.unwrap_or_default())
}

fn hold(decided: &Mutex<Decided>) -> std::sync::MutexGuard<'_, Decided> {
    decided.lock().unwrap_or_else(PoisonError::into_inner)
}
