//! How a scene of slow motion is told, whole or cut off.

use super::Status;
use super::interrupt::interrupted;
use super::output::{Files, Form};
use palmistry::experiment::slow::{SlowAnswers, SlowExperiment, StudyRow};
use palmistry::report::{SlowObserved, slow_json, slow_page, slow_text};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// A scene that was observed, and how that is to be told.
pub(super) struct SlowFound {
    pub experiment: SlowExperiment,
    pub answers: SlowAnswers,
    pub study: Vec<StudyRow>,
    pub out: Option<PathBuf>,
    pub form: Form,
    pub no_times: bool,
}

impl SlowFound {
    pub fn tell(mut self, mut files: Files) -> miette::Result<Status> {
        if self.no_times {
            self.answers.seconds = [f64::NAN; 3];
            self.study.iter_mut().for_each(StudyRow::forget_times);
        }
        let observed = SlowObserved {
            experiment: &self.experiment,
            answers: &self.answers,
            study: &self.study,
            interrupted: interrupted(),
        };
        let json = slow_json(&observed);
        if let Some(folder) = &self.out {
            files.text(&folder.join("index.html"), &slow_page(&observed));
            files.json(&folder.join("observe.json"), &json);
            files.announce(&folder.join("index.html"));
        }
        // measurements that no body explains are not a shape
        let status = Status::of(self.answers.explained && self.study.iter().all(|row| row.silent == 0));
        files.print(self.form, json, || slow_text(&observed), status)
    }
}

/// What a study has come to: a body of many samples takes longer than an interrupt leaves.
#[derive(Clone, Default)]
pub(super) struct KeptSlow(Arc<Mutex<Option<SlowFound>>>);

impl KeptSlow {
    pub fn with<T>(&self, act: impl FnOnce(&mut Option<SlowFound>) -> T) -> T {
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Tells it; nothing where there is nothing.
    pub fn tell(&self) -> Option<miette::Result<Status>> {
        self.with(Option::take).map(|told| told.tell(Files::default()))
    }
}
