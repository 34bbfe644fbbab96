//! `palmistry verify`: all of a paper checked.

use super::coq::Theorems;
use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted, watched};
use super::output::{Files, Form, progress};
use super::stage::Stage;
use super::{Status, Unusable};
use clap::Args;
use palmistry::System;
use palmistry::file;
use palmistry::foreign::shown;
use palmistry::paper::{Findings, MANIFEST, Paper, VerifyOptions, verify_into};
use palmistry::report::{
    errata_markdown, findings_json, findings_text, forget_seconds, forget_times, page_with, versioned,
};
use palmistry::system::Code;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Checks a whole paper: claims, ranks on named sets, maps, lines, numbers in print, reductions, speed against
/// accuracy, extreme states, certificates, scenes; and writes a page with pictures.
///
/// A paper is a folder of proof files, with a paper.toml that gives its title, its numbered equations and the scenes to run; or
/// one proof file. Without a path, a paper that came with the program is taken.
///
/// Exit status 0 only when every claim has the verdict that its file expects, every named set has a rank, every named
/// singularity has none, and every reduction is proved.
#[derive(Args, Clone)]
#[command(after_help = "Examples:
  palmistry verify mypaper --out report")]
pub(crate) struct Verify {
    /// A folder of proof files, or one proof file.
    #[arg(value_name = "FOLDER-OR-FILE", conflicts_with = "paper")]
    pub(super) path: Option<PathBuf>,
    /// A paper that came with the program, by the name of its folder.
    #[arg(long, value_name = "NAME")]
    paper: Option<String>,
    /// Where to write index.html, verify.json and errata.md.
    #[arg(long, value_name = "DIR", default_value = "verify")]
    pub(super) out: PathBuf,
    /// Seed of the random points and the sampled states.
    #[arg(long, default_value_t = 1, value_name = "S")]
    seed: u64,
    /// Measure no times: two runs with one seed on one machine then write the same to the last byte. Speed against accuracy is left out.
    #[arg(long)]
    no_times: bool,
    /// Write what is proved as theorems for the proof assistant Coq beside the page, into the folder coq; claims on the page lead to them.
    #[arg(long)]
    coq: bool,
    /// Print everything that was found as one JSON object.
    #[arg(long)]
    pub json: bool,
}

/// So long after a line of progress comes the next, where no bar shows it.
const TELL_EVERY: Duration = Duration::from_secs(15);

/// The folder of theorems, beside the page.
const THEOREMS: &str = "coq";

impl Verify {
    pub fn run(self) -> miette::Result<Status> {
        let found = Arc::new(Mutex::new(Findings::begun(self.seed)));
        let (worker, filled) = (self.clone(), found.clone());
        let work = move || {
            worker.work(&filled)?;
            let theorems = worker.coq.then(|| worker.theorems(&filled));
            begin_to_tell();
            worker.tell(&filled, theorems.as_ref())
        };
        watched(work, || self.tell(&found, None))
    }

    /// What is proved, as theorems.
    fn theorems(&self, found: &Mutex<Findings>) -> Theorems {
        let (systems, outcomes) = {
            let found = found.lock().unwrap_or_else(PoisonError::into_inner);
            let systems: Vec<System> = found.files.iter().map(|file| file.system.clone()).collect();
            (systems, found.outcomes().cloned().collect::<Vec<_>>())
        };
        Theorems::of(&self.out.join(THEOREMS), &systems, &outcomes)
    }

    /// Finds out everything.
    fn work(&self, found: &Mutex<Findings>) -> miette::Result<()> {
        let path = match &self.path {
            Some(path) => path.clone(),
            None => packed_paper(self.paper.as_deref())?,
        };
        let paper = Paper::read(&path)?;
        let bar = progress(1, "verifying");
        let stage = Stage::default();
        let _lines = stage.lines_every(TELL_EVERY);
        let options = VerifyOptions {
            seed: self.seed,
            interrupt: &INTERRUPTED,
            timed: !self.no_times,
            progress: &|what, done, all| {
                bar.set_length(all);
                bar.set_position(done);
                let what = shown(what);
                bar.set_message(what.chars().take(28).collect::<String>());
                stage.is(&what, done, all);
            },
        };
        let result = verify_into(&paper, &options, found);
        bar.finish_and_clear();
        Ok(result?)
    }

    /// Prints and writes what was found.
    fn tell(&self, found: &Mutex<Findings>, theorems: Option<&Theorems>) -> miette::Result<Status> {
        let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
        found.interrupted |= interrupted();
        let mut json = versioned(findings_json(&found));
        if self.no_times {
            forget_times(&mut found);
            forget_seconds(&mut json);
        }
        let (html_file, json_file) = (self.out.join("index.html"), self.out.join("verify.json"));
        let mut files = Files::default();
        let addresses = theorems.map(|theorems| theorems.addresses(THEOREMS)).unwrap_or_default();
        if let Some(theorems) = theorems {
            theorems.write(&mut files);
            json["theorems"] = theorems.object();
        }
        files.text(&html_file, &page_with(&found, &addresses));
        files.text(&json_file, &format!("{}\n", serde_json::to_string(&json).unwrap_or_default()));
        files.text(&self.out.join("errata.md"), &errata_markdown(&found.paper, found.outcomes()));
        files.announce(&html_file);
        files.announce(&json_file);
        // a run that is cut off leaves out ranks and more, which is no fault of theirs
        let claims_hold = || found.outcomes().all(|outcome| outcome.ok);
        let status = match found.interrupted {
            true if claims_hold() => Status::CutOff,
            _ if found.ok() => Status::AsExpected,
            _ => Status::NotAsExpected,
        };
        let in_words = || {
            let theorems = theorems.map(|theorems| format!("\n{}", theorems.in_words()));
            findings_text(&found) + &theorems.unwrap_or_default()
        };
        files.print(Form::of(self.json), json, in_words, status)
    }
}

/// The folder of a paper that came with the program; the first one where none is named.
pub(crate) fn packed_paper(name: Option<&str>) -> miette::Result<PathBuf> {
    let is_paper = |name: &&str| file::is_file(Path::new(&format!("{}{name}/{MANIFEST}", file::PACKED)));
    let all: Vec<&str> = file::packed_folders().into_iter().filter(is_paper).collect();
    let found = match name {
        None => all.first(),
        Some(name) => all.iter().find(|known| **known == name),
    };
    match found {
        Some(found) => Ok(Path::new(&format!("{}{found}", file::PACKED)).to_owned()),
        None => {
            let message = format!("no paper '{}' came with this program", name.unwrap_or_default());
            Err(Unusable::report(Code::Option, message, format!("there are: {}", all.join(", "))))
        }
    }
}
