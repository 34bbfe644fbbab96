//! `palmistry stress`: the extremes.

use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted, nothing_found, watched};
use super::output::{Files, Form, progress};
use super::verify::packed_paper;
use super::{Status, Unusable};
use clap::{Args, ValueEnum};
use palmistry::System;
use palmistry::paper::Paper;
use palmistry::report::{stress_json, stress_pictures, stress_text};
use palmistry::system::Code;
use palmistry::tradeoff::LandscapeRows;
use palmistry::tradeoff::stress::{Stress as Prepared, StressOptions, StressStudy};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Tests number types at extreme states: how near to a singular set, and at which scales, a rank is first reported wrongly.
///
/// Lines approach every singular set down to a distance of 1e-15. At each point, an exact rational state, the rank is decided in single
/// precision, in doubles by numpy's rule, in doubles after equilibration, with error bounds from
/// intervals, by intervals alone, in double-doubles, and by the number types that 'palmistry rank' takes in turn; beside them stands the
/// certified rank of the rows: the file's own, or the Lie derivatives that suffice at generic states. For each the table has the
/// distance at which it first reports another rank, and at which an entry first loses more than half of its digits, each as
/// a range over the states; and at how many states on the set itself it has the exact rank of the rows, since a method that always answers
/// "full" (a column of its own) is right everywhere off the set.
///
/// Then every quantity is scaled from 1e-150 to 1e150, and ranks are decided again in other units, which should change
/// no verdict: units of the dimensions that the file declares, or each state in a smaller unit where it declares none. Where numbers overflow or are divided by zero, the operation is named.
///
/// The sets are those that a file names ('set', 'singularity', and lines to infinity); where it names none, what it says to avoid,
/// the divisors of its rows, and each quantity of its sample at zero. Without FILE, the systems with named sets of a
/// paper that came with the program are taken.
#[derive(Args, Clone)]
#[command(after_help = "Examples:
  palmistry stress --out stress")]
pub(crate) struct Stress {
    /// A proof file; without one, a paper that came with the program.
    pub(super) file: Option<PathBuf>,
    /// Which rows: the file's own matrix 'rows' where it defines one, or the full codistribution.
    #[arg(long, value_enum, default_value_t = Which::Own, value_name = "WHICH")]
    rows: Which,
    /// States on each set from which lines go; the range over them is reported.
    #[arg(long, default_value_t = 10, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1000))]
    states: u64,
    /// States of the sample box at which ranks are decided again in other units.
    #[arg(long, default_value_t = 200, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    samples: u64,
    /// Seed of the states.
    #[arg(long, default_value_t = 1, value_name = "S")]
    seed: u64,
    /// Write the pictures (SVG) and stress.json into this folder.
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// A paper that came with the program, by the name of its folder.
    #[arg(long, value_name = "NAME", conflicts_with = "file")]
    paper: Option<String>,
    /// Print one JSON object with 'studies': for each its 'lines', 'scalings', 'units' and 'conditioning'.
    #[arg(long)]
    pub json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Which {
    Own,
    Full,
}

/// States on each set that are looked at in other units.
const SAMPLES_ON_SETS: u64 = 6;

impl Stress {
    pub fn run(self) -> miette::Result<Status> {
        let done: Arc<Mutex<Vec<StressStudy>>> = Arc::default();
        let (worker, filled) = (self.clone(), done.clone());
        let work = move || {
            worker.work(&filled)?;
            begin_to_tell();
            worker.tell(&filled)
        };
        watched(work, || self.tell(&done))
    }

    /// Runs the studies, one after the other.
    fn work(&self, studies: &Mutex<Vec<StressStudy>>) -> miette::Result<()> {
        let bar = progress(1, "extreme states");
        let done = AtomicU64::new(0);
        let step = || bar.set_position(done.fetch_add(1, Ordering::Relaxed) + 1);
        let options = StressOptions {
            seed: self.seed,
            states: self.states,
            step: 1,
            samples: self.samples,
            samples_on_sets: SAMPLES_ON_SETS,
            interrupt: &INTERRUPTED,
            progress: &step,
        };
        let rows = match self.rows {
            Which::Own => LandscapeRows::Own,
            Which::Full => LandscapeRows::Full,
        };
        let mut systems = match &self.file {
            Some(file) => vec![System::read(file)?],
            None => Paper::read(&packed_paper(self.paper.as_deref())?)?.systems()?,
        };
        if self.file.is_none() {
            systems.retain(|system| !system.sets.is_empty());
        }
        let mut prepared = Vec::new();
        for system in &mut systems {
            let one = Prepared::of_file(system, rows, &options);
            let named = |why: String| Unusable::report(Code::Question, format!("{}: {why}", system.name), "");
            prepared.push(one.map_err(named)?);
        }
        bar.set_length(prepared.iter().map(|one| one.steps(&options)).sum());
        for one in &prepared {
            let study = one.run(&options);
            studies.lock().unwrap_or_else(PoisonError::into_inner).push(study);
        }
        bar.finish_and_clear();
        Ok(())
    }

    /// Prints and writes the studies that were done.
    fn tell(&self, studies: &Mutex<Vec<StressStudy>>) -> miette::Result<Status> {
        let studies = std::mem::take(&mut *studies.lock().unwrap_or_else(PoisonError::into_inner));
        if studies.is_empty() && interrupted() {
            return nothing_found(Form::of(self.json));
        }
        let mut object = stress_json(&studies, self.seed);
        let whole = !interrupted() && studies.iter().all(|study| !study.interrupted);
        object["interrupted"] = json!(!whole);
        let mut files = Files::default();
        if let Some(folder) = &self.out {
            write_files(folder, &studies, &object, &mut files);
        }
        let status = if whole { Status::AsExpected } else { Status::CutOff };
        files.print(Form::of(self.json), object, || stress_text(&studies), status)
    }
}

fn write_files(folder: &Path, studies: &[StressStudy], object: &serde_json::Value, files: &mut Files) {
    for study in studies {
        for (name, svg) in stress_pictures(study) {
            let path = folder.join(format!("{name}.svg"));
            files.text(&path, &svg);
            files.announce(&path);
        }
    }
    files.text(
        &folder.join("stress.json"),
        &format!("{}\n", serde_json::to_string(object).unwrap_or_default()),
    );
}
