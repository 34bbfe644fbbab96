//! `palmistry verify`: the main job.

use super::output::{INTERRUPTED, print_json, print_text, progress, write_whole};
use super::{Status, Unusable};
use clap::Args;
use palmistry::report::{errata_markdown, page, verification_json, verification_text};
use palmistry::verification::{Options, VerifyError, verify};
use std::path::{Path, PathBuf};

/// Checks chapter 4 and appendix A.2 of the thesis: claims, ranks, determinants; writes a page with pictures.
///
/// Exit status 0 only when every claim has the verdict that its file expects and every rank is certified.
#[derive(Args)]
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
        let folder = folder_of(&self.proofs)?;
        let scenes = folder_of(&self.scenes)?;
        let bar = progress(1, "verifying");
        let found = verify(&Options {
            folder: &folder,
            scenes: &scenes,
            seed: self.seed,
            interrupt: &INTERRUPTED,
            progress: &|what, done, all| {
                bar.set_length(all);
                bar.set_position(done);
                bar.set_message(what.chars().take(28).collect::<String>());
            },
        });
        bar.finish_and_clear();
        let found = found.map_err(|error| match error {
            VerifyError::Read(error) => miette::Report::new(*error),
            other => Unusable::report(other.to_string(), ""),
        })?;
        let json = verification_json(&found);
        let (html_file, json_file) = (self.out.join("index.html"), self.out.join("verify.json"));
        write_whole(&html_file, &page(&found))?;
        write_whole(&json_file, &format!("{}\n", serde_json::to_string(&json).unwrap_or_default()))?;
        write_whole(&self.out.join("errata.md"), &errata_markdown(&found.outcomes))?;
        if self.json {
            print_json(&json);
        } else {
            print_text(&verification_text(&found));
        }
        eprintln!("written: {} and {}", html_file.display(), json_file.display());
        Ok(if found.ok() { Status::AsExpected } else { Status::NotAsExpected })
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
