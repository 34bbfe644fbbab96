//! What a report on slow palms is about.

use palmistry_scenes::slow::{SlowAnswers, SlowExperiment, StudyRow};

/// A scene of slow motion and what came of it.
pub struct SlowObserved<'a> {
    /// The scene with its measurements.
    pub experiment: &'a SlowExperiment,
    /// What was found.
    pub answers: &'a SlowAnswers,
    /// The study; empty where none was run.
    pub study: &'a [StudyRow],
    /// Whether it was interrupted.
    pub interrupted: bool,
}

impl<'a> SlowObserved<'a> {
    /// A whole run without a study.
    pub fn of(experiment: &'a SlowExperiment, answers: &'a SlowAnswers) -> SlowObserved<'a> {
        SlowObserved { experiment, answers, study: &[], interrupted: false }
    }
}
