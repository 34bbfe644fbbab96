//! `palmistry prove --watch`: files are decided again when they are changed.
//!
//! A change is seen by looking at the times and lengths of files, three times a second, and not by asking the system to tell:
//! such messages are lost where an editor puts a new file in the place of the old one, and do not come at all from folders
//! that are mounted over a network or into a container. Looking at a few hundred files costs less than a millisecond.

use super::Status;
use super::check::{errors_json, problems_text};
use super::claims::{Claims, no_claims, no_such_claim};
use super::interrupt::{INTERRUPTED, interrupted};
use super::output::{Form, print_text, progress, proof_files};
use super::terminal::is_terminal;
use palmistry::claim::decide_all_keeping;
use palmistry::foreign::{json_text, name_of, shown_path};
use palmistry::report::{ClaimsSummary, versioned};
use palmistry::system::{Examination, MOST_PROBLEMS};
use palmistry::{Outcome, System, file};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// How often files are looked at.
const PAUSE: Duration = Duration::from_millis(300);
/// How often an interrupt is looked for meanwhile.
const GLANCE: Duration = Duration::from_millis(20);

/// What tells a file from what it was: when it was written, and its length; nothing where there is none.
type Stamp = Option<(SystemTime, u64)>;

fn stamp(path: &Path) -> Stamp {
    let known = std::fs::metadata(path).ok()?;
    Some((known.modified().ok()?, known.len()))
}

/// What is known of one proof file.
struct Decided {
    /// The files on which it rests, itself among them, as they were before they were read.
    rests_on: Vec<(PathBuf, Stamp)>,
    claims: usize,
    /// All its ids, whether they are asked for or not.
    ids: Vec<String>,
    outcomes: Vec<Outcome>,
    /// What is wrong with it; then nothing of it is decided.
    wrong: Option<Examination>,
}

impl Decided {
    fn is_stale(&self) -> bool {
        self.rests_on.iter().any(|(path, before)| stamp(path) != *before)
    }
}

/// The files that are watched.
pub(super) struct Watch {
    asked: Claims,
    files: BTreeMap<PathBuf, Decided>,
}

impl Watch {
    pub fn of(asked: Claims) -> Watch {
        Watch { asked, files: BTreeMap::new() }
    }

    /// Decides and tells, again and again, until it is interrupted. The status is that of the last report.
    pub fn run(mut self) -> miette::Result<Status> {
        let mut status = None;
        loop {
            let begin = Instant::now();
            // what is not there when it begins is a mistake, and what goes away later may come back
            let paths = match (proof_files(&self.asked.paths), status) {
                (Ok(paths), _) => paths,
                (Err(error), None) => return Err(error),
                (Err(_), Some(_)) => {
                    let there = |path| proof_files(std::slice::from_ref(path)).unwrap_or_default();
                    self.asked.paths.iter().flat_map(there).collect()
                }
            };
            let before = self.files.len();
            self.files.retain(|path, _| paths.contains(path));
            let gone = before != self.files.len();
            let is_stale = |path: &&PathBuf| self.files.get(*path).is_none_or(Decided::is_stale);
            let stale: Vec<PathBuf> = paths.iter().filter(is_stale).cloned().collect();
            if gone || !stale.is_empty() || status.is_none() {
                for path in &stale {
                    let decided = self.decide(path);
                    self.files.insert(path.clone(), decided);
                    if interrupted() {
                        return Ok(Status::CutOff);
                    }
                }
                status = Some(self.tell(&paths, &stale, begin)?);
            }
            let wait = Instant::now();
            while wait.elapsed() < PAUSE {
                if interrupted() {
                    return Ok(status.unwrap_or(Status::CutOff));
                }
                std::thread::sleep(GLANCE);
            }
        }
    }

    /// Reads and decides one file.
    fn decide(&self, path: &Path) -> Decided {
        // stamped before it is read: what is written meanwhile is seen the next time
        let known = self.files.get(path).into_iter().flat_map(|known| &known.rests_on).map(|(file, _)| file);
        let before: BTreeMap<PathBuf, Stamp> =
            known.cloned().chain([path.to_owned()]).map(|file| (file.clone(), stamp(&file))).collect();
        let mut examined = System::examine(path, MOST_PROBLEMS);
        let rests_on = std::mem::take(&mut examined.files).into_iter().map(|file| {
            let found = before.get(&file).copied().unwrap_or_else(|| stamp(&file));
            (file, found)
        });
        let rests_on = rests_on.collect();
        let Some(mut system) = examined.system.take() else {
            let (claims, ids, outcomes) = Default::default();
            return Decided { rests_on, claims, ids, outcomes, wrong: Some(examined) };
        };
        let ids = system.claims.iter().map(|claim| claim.id.clone()).collect();
        let selection = self.asked.selection();
        system.claims.retain(|claim| selection.keeps(&claim.id));
        let bar = progress(system.claims.len() as u64, "deciding claims");
        let done = |_: &Outcome| bar.inc(1);
        let outcomes = decide_all_keeping(self.asked.kept(), &system, self.asked.seed, &INTERRUPTED, &done);
        bar.finish_and_clear();
        Decided { rests_on, claims: system.claims.len(), ids, outcomes, wrong: None }
    }

    /// Prints and writes what is known of all files; `again` are those that were decided just now.
    fn tell(&self, paths: &[PathBuf], again: &[PathBuf], begin: Instant) -> miette::Result<Status> {
        let known: Vec<&Decided> = paths.iter().filter_map(|path| self.files.get(path)).collect();
        let outcomes: Vec<Outcome> = known.iter().flat_map(|file| file.outcomes.iter().cloned()).collect();
        let wrong: Vec<&Examination> = known.iter().filter_map(|file| file.wrong.as_ref()).collect();
        let ids = || known.iter().flat_map(|file| &file.ids).map(String::as_str);
        let unmet = self.asked.selection().unmet(ids()).filter(|_| wrong.is_empty());
        let claims: usize = known.iter().map(|file| file.claims).sum();
        let summary = ClaimsSummary { claims: Some(claims), seconds: begin.elapsed().as_secs_f64() };
        let written = self.asked.written(&outcomes);
        let ok =
            wrong.is_empty() && unmet.is_none() && outcomes.iter().all(|outcome| outcome.ok) && claims > 0;
        match Form::of(self.asked.json) {
            Form::Json => {
                let mut object = self.asked.object(&outcomes, summary.seconds);
                object["ok"] = json!(ok);
                object["decided_again"] = again.iter().map(|path| json!(name_of(path))).collect();
                object["errors"] =
                    wrong.iter().flat_map(|file| errors_json(file)).collect::<Vec<Value>>().into();
                written.note_in(&mut object);
                print_text(&json_text(&versioned(object), false))?;
            }
            Form::Text => {
                let names: Vec<String> = again.iter().map(|path| shown_path(path)).collect();
                if is_terminal() {
                    file::clear_terminal();
                }
                let mut text = match names.is_empty() {
                    true => "a file is gone\n".to_owned(),
                    false => format!("decided: {}\n", names.join(", ")),
                };
                wrong.iter().for_each(|file| text.push_str(&problems_text(file)));
                text.push_str(&self.asked.in_words(&outcomes, summary));
                print_text(&text)?;
            }
        }
        if let Some(unmet) = unmet {
            file::note(&format!("{:?}", no_such_claim(&unmet, ids())));
        } else if claims == 0 && wrong.is_empty() {
            file::note(&format!("{:?}", no_claims()));
        }
        written.note_failures();
        if !self.asked.json {
            file::note("waiting for changes (interrupt to end)");
        }
        Ok(match ok {
            _ if !wrong.is_empty() => Status::Unusable,
            _ if !written.whole() => Status::Unwritten,
            true => Status::AsExpected,
            false => Status::NotAsExpected,
        })
    }
}
