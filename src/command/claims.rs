//! What `prove` decides and how it tells it, once or again and again.

use super::Unusable;
use super::interrupt::interrupted;
use super::output::{Files, proof_files};
use super::terminal::layout;
use clap::Args;
use palmistry::checker::VerdictFile;
use palmistry::claim::{Kept, Selection, UnmetPattern};
use palmistry::foreign::shown;
use palmistry::report::{
    ClaimsForm, ClaimsSummary, Shown, claim_json, claims_json, claims_text, junit, statement_latex_in,
};
use palmistry::system::Code;
use palmistry::{Outcome, System};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Which claims, and what of them is printed and written.
#[derive(Args, Clone)]
pub(crate) struct Claims {
    /// Proof files, or folders in which every .proof file is taken.
    #[arg(required = true, value_name = "FILE-OR-FOLDER")]
    pub paths: Vec<PathBuf>,
    /// Decide only these claims: by id, by the part of ids before a dot ('4.44' is '4.44.r1' too), or with '*' for any
    /// characters (may be repeated).
    #[arg(long, value_name = "ID")]
    pub only: Vec<String>,
    /// Print only what is not as expected, and the summary.
    #[arg(short, long)]
    pub quiet: bool,
    /// Print one JSON object: 'claims' with id, file, line, column, statement, verdict, expected, ok, engine, and error_bound
    /// or witness.
    #[arg(long)]
    pub json: bool,
    /// Write the outcomes as JUnit XML, for a CI system.
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write what the verdicts rest on to a file for 'palmistry recheck'.
    #[arg(long, value_name = "FILE")]
    pub verdicts: Option<PathBuf>,
    /// Give each statement in LaTeX too: a line of its own, or 'latex' in the JSON.
    #[arg(long)]
    pub latex: bool,
    /// Seed of the random points.
    #[arg(long, default_value_t = 1, value_name = "S")]
    pub seed: u64,
}

impl Claims {
    /// The claims that are asked for.
    pub fn selection(&self) -> Selection {
        Selection::new(&self.only)
    }

    /// Reads all files, and keeps the claims that are asked for.
    pub fn read(&self) -> miette::Result<Vec<System>> {
        // read everything before deciding anything: a mistake in the last file should not cost the first ones' time
        let mut systems: Vec<System> = proof_files(&self.paths)?
            .iter()
            .map(|file| System::read(file).map_err(miette::Report::new))
            .collect::<Result<_, _>>()?;
        let selection = self.selection();
        let ids = systems.iter().flat_map(|system| &system.claims).map(|claim| claim.id.as_str());
        if let Some(unmet) = selection.unmet(ids) {
            let ids = systems.iter().flat_map(|system| &system.claims).map(|claim| claim.id.as_str());
            return Err(no_such_claim(&unmet, ids));
        }
        for system in &mut systems {
            system.claims.retain(|claim| selection.keeps(&claim.id));
        }
        Ok(systems)
    }

    /// An outcome as JSON, with its formulas where they are asked for.
    fn claim(&self, outcome: &Outcome) -> Value {
        let mut object = claim_json(outcome);
        if self.latex {
            object["latex"] = json!(statement_latex_in(&outcome.statement, &outcome.looks));
            if let Some((printed, _)) = &outcome.printed {
                object["printed"]["latex"] = json!(statement_latex_in(printed, &outcome.looks));
            }
        }
        object
    }

    /// Writes the files that are asked for.
    pub fn written(&self, outcomes: &[Outcome]) -> Files {
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
    pub fn object(&self, outcomes: &[Outcome], seconds: f64) -> Value {
        claims_json(outcomes, |outcome| self.claim(outcome), self.seed, seconds, interrupted())
    }

    /// What was found, as text.
    pub fn in_words(&self, outcomes: &[Outcome], summary: ClaimsSummary) -> String {
        let shown = if self.quiet { Shown::Unexpected } else { Shown::All };
        claims_text(outcomes, summary, ClaimsForm { shown, latex: self.latex }, &layout())
    }

    /// What is kept of a verdict.
    pub fn kept(&self) -> Kept {
        if self.verdicts.is_some() { Kept::Evidence } else { Kept::Verdicts }
    }
}

/// That a pattern of `--only` is met by no claim.
pub(crate) fn no_such_claim<'a>(unmet: &UnmetPattern, ids: impl Iterator<Item = &'a str>) -> miette::Report {
    let all: Vec<_> = ids.map(shown).collect();
    let more = if all.len() > MOST_IDS { ", ..." } else { "" };
    let help = match &unmet.nearest {
        Some(near) => format!("perhaps you meant '{near}'"),
        None if all.is_empty() => "there are no claims".to_owned(),
        None => format!("the claims are {}{more}", all[..all.len().min(MOST_IDS)].join(", ")),
    };
    Unusable::report(Code::Question, unmet.to_string(), help)
}

/// So many ids are listed.
const MOST_IDS: usize = 20;

/// That there is nothing to decide.
pub(crate) fn no_claims() -> miette::Report {
    Unusable::report(Code::Question, "these files claim nothing", "add a line such as: claim 1: L(f, x) = v")
}
