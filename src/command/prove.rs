//! `palmistry prove`: every claim of some files.

use super::Status;
use super::claims::{Claims, no_claims};
use super::coq::Theorems;
use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted, watched};
use super::output::{Form, progress};
use super::watch::Watch;
use clap::Args;
use palmistry::claim::decide_all_keeping;
use palmistry::report::ClaimsSummary;
use palmistry::{Outcome, System};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Decides every claim of proof files.
///
/// Exit status 0 only when each claim has the verdict that its file expects: 'claim' proved (or what 'expect' says),
/// 'erratum' with the printed form refuted and the corrected one proved, and likewise 'damaged', 'scan', 'convention' and
/// 'loose'. A claim whose two sides are the same expression 'holds by definition'; it is not called 'proved', and is as expected. A claim
/// is about all values of its symbols, whatever values the file gives to parameters; where the verdict at these values differs,
/// the program says so.
#[derive(Args, Clone)]
#[command(after_help = "Examples:
  palmistry prove mysystem.proof            each claim with its verdict
  palmistry prove proofs/ -q                only what is not as expected: statement, place, both sides at a witness
  palmistry prove mysystem.proof --only 4.48 --only 'reduce.*'
  palmistry prove mysystem.proof --watch    again whenever the file is changed
  palmistry prove mysystem.proof --coq theorems
  palmistry prove proofs/ --junit claims.xml --verdicts claims.json")]
pub(crate) struct Prove {
    #[command(flatten)]
    pub claims: Claims,
    /// Decide again whenever a file is changed, or one that it imports, until it is interrupted. Only files that are changed,
    /// or import what is changed, are decided again. With --json each report is one line.
    #[arg(long, conflicts_with = "coq")]
    pub watch: bool,
    /// Write what is proved as theorems for the proof assistant Coq into this folder: a file for each proof file, with its definitions and
    /// fields, and a library that is proved there. Coq computes all derivatives anew. It writes identities (also under conditions solved
    /// for a variable) and ranks that are reached at a state; what is left out stands at the end of each file.
    #[arg(long, value_name = "DIR")]
    pub coq: Option<PathBuf>,
}

/// What is decided so far.
#[derive(Default)]
struct Decided {
    /// How many claims there are, once all files are read.
    claims: Option<usize>,
    /// The place of each claim, by its file and its name, in the order of the files.
    places: HashMap<(String, String), usize>,
    /// As they were decided.
    outcomes: Vec<Outcome>,
    /// The files, where theorems are to be written.
    systems: Vec<System>,
}

impl Prove {
    pub fn run(self) -> miette::Result<Status> {
        if self.watch {
            // what was told stays told
            return watched(move || Watch::of(self.claims).run(), || Ok(Status::CutOff));
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

    /// Decides all claims.
    fn decide(&self, decided: &Mutex<Decided>) -> miette::Result<()> {
        let systems = self.claims.read()?;
        let names: Vec<(String, String)> = systems
            .iter()
            .flat_map(|system| system.claims.iter().map(|claim| (system.name.clone(), claim.id.clone())))
            .collect();
        let claims = names.len();
        if claims == 0 {
            return Err(no_claims());
        }
        {
            let mut decided = hold(decided);
            decided.claims = Some(claims);
            decided.places = names.into_iter().zip(0..).collect();
            if self.coq.is_some() {
                decided.systems.clone_from(&systems);
            }
        }
        let bar = progress(claims as u64, "deciding claims");
        for system in &systems {
            let done = |outcome: &Outcome| {
                hold(decided).outcomes.push(outcome.clone());
                bar.inc(1);
            };
            decide_all_keeping(self.claims.kept(), system, self.claims.seed, &INTERRUPTED, &done);
        }
        bar.finish_and_clear();
        Ok(())
    }

    /// Prints and writes what is decided, in the order of the files.
    fn tell(&self, decided: &Mutex<Decided>, begin: Instant) -> miette::Result<Status> {
        let Decided { claims, places, mut outcomes, systems } = std::mem::take(&mut *hold(decided));
        outcomes
            .sort_by_cached_key(|outcome| places.get(&(outcome.file.clone(), outcome.id.clone())).copied());
        let whole = claims == Some(outcomes.len());
        let as_expected = outcomes.iter().all(|outcome| outcome.ok) && (whole || interrupted());
        let status = Status::of(as_expected);
        let summary = ClaimsSummary { claims, seconds: begin.elapsed().as_secs_f64() };
        let mut object = self.claims.object(&outcomes, summary.seconds);
        let mut files = self.claims.written(&outcomes);
        let theorems = self.coq.as_ref().map(|folder| Theorems::of(folder, &systems, &outcomes));
        if let Some(theorems) = &theorems {
            theorems.write(&mut files);
            object["theorems"] = theorems.object();
        }
        let in_words = || {
            let mut text = self.claims.in_words(&outcomes, summary);
            if let Some(theorems) = &theorems {
                text.push('\n');
                text.push_str(&theorems.in_words());
            }
            text
        };
        files.print(Form::of(self.claims.json), object, in_words, status)
    }
}

fn hold(decided: &Mutex<Decided>) -> std::sync::MutexGuard<'_, Decided> {
    decided.lock().unwrap_or_else(PoisonError::into_inner)
}
