//! `palmistry verify`: the main job.

use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted, watched};
use super::output::{Files, Form, progress};
use super::{Status, Unusable};
use clap::Args;
use palmistry::report::{errata_markdown, page, verification_json, verification_text};
use palmistry::verification::{Options, Verification, VerifyError, verify_into};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Checks chapter 4 and appendix A.2 of the thesis: claims, ranks, determinants; writes a page with pictures.
///
/// Exit status 0 only when every claim has the verdict that its file expects and every rank is certified.
#[derive(Args, Clone)]
pub(crate) struct Verify {
    /// Where to write index.html, verify.json and errata.md.
    #[arg(long, value_name = "DIR", default_value = "verify")]
    out: PathBuf,
    /// The folder that holds the thesis's proof files.
    #[arg(long, value_name = "DIR", default_value = "proofs/moll2002")]
    proofs: PathBuf,
    /// The folder that holds the scenes.
    #[arg(long, value_name = "DIR", default_value = "scenes")]
    scenes: PathBuf,
    /// Seed of the random points and the sampled states.
    #[arg(long, default_value_t = 1, value_name = "S")]
    seed: u64,
    /// Print everything that was found as one JSON object.
    #[arg(long)]
    pub json: bool,
}

impl Default for Verify {
    fn default() -> Self {
        Verify {
            out: "verify".into(),
            proofs: "proofs/moll2002".into(),
            scenes: "scenes".into(),
            seed: 1,
            json: false,
        }
    }
}

impl Verify {
    pub fn run(self) -> miette::Result<Status> {
        let found = Arc::new(Mutex::new(Verification::begun(self.seed)));
        let (worker, filled) = (self.clone(), found.clone());
        let work = move || {
            worker.work(&filled)?;
            begin_to_tell();
            worker.tell(&filled)
        };
        watched(work, || self.tell(&found))
    }

    /// Finds out everything.
    fn work(&self, found: &Mutex<Verification>) -> miette::Result<()> {
        let folder = folder_of(&self.proofs)?;
        let scenes = folder_of(&self.scenes)?;
        let bar = progress(1, "verifying");
        let options = Options {
            folder: &folder,
            scenes: &scenes,
            seed: self.seed,
            interrupt: &INTERRUPTED,
            progress: &|what, done, all| {
                bar.set_length(all);
                bar.set_position(done);
                bar.set_message(what.chars().take(28).collect::<String>());
            },
        };
        let result = verify_into(&options, found);
        bar.finish_and_clear();
        result.map_err(|error| match error {
            VerifyError::Read(error) => miette::Report::new(*error),
            other => Unusable::report(other.to_string(), ""),
        })
    }

    /// Prints and writes what was found.
    fn tell(&self, found: &Mutex<Verification>) -> miette::Result<Status> {
        let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
        found.interrupted |= interrupted();
        let json = verification_json(&found);
        let (html_file, json_file) = (self.out.join("index.html"), self.out.join("verify.json"));
        let mut files = Files::default();
        files.text(&html_file, &page(&found));
        files.text(&json_file, &format!("{}\n", serde_json::to_string(&json).unwrap_or_default()));
        files.text(&self.out.join("errata.md"), &errata_markdown(&found.outcomes));
        files.announce(&html_file);
        files.announce(&json_file);
        let status = if found.ok() { Status::AsExpected } else { Status::NotAsExpected };
        files.print(Form::of(self.json), json, || verification_text(&found), status)
    }
}

/// The files are beside the place where the program is run, or beside its source.
pub(crate) fn folder_of(proofs: &Path) -> miette::Result<PathBuf> {
    let beside_source = Path::new(env!("CARGO_MANIFEST_DIR")).join(proofs);
    for folder in [proofs.to_path_buf(), beside_source] {
        if folder.is_dir() {
            return Ok(folder);
        }
    }
    let message = format!("there is no folder {}", proofs.display());
    Err(Unusable::report(message, "run it where the folder is, or name it with --proofs or --scenes"))
}
