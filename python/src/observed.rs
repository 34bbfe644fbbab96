//! Scenes of every kind, observed, kept until somebody asks for them as JSON, as text, as a page or as columns.

use crate::answers::{columns, printed};
use crate::errors::unusable;
use numpy::{PyArray1, PyArray2};
use palmistry::experiment::joint::{JointAnswer, JointExperiments};
use palmistry::experiment::slow::{SlowAnswers, SlowExperiment, StudyRow};
use palmistry::experiment::space::{SpaceAnswers, SpaceExperiment};
use palmistry::experiment::{Answer, Experiment, ModeWindow, Studied, shown};
use palmistry::observer::Track;
use palmistry::report::{
    JointObserved, Observed, SlowObserved, SpaceObserved, forget_seconds, joint_json, joint_page, joint_text,
    modes_json, modes_text, observe_json, observe_page, observe_text, slow_json, slow_page, slow_text,
    space_json, space_page, space_text,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;

/// What was observed.
pub enum Seen {
    /// A system or a body in motion.
    Moving { experiment: Box<Experiment>, answers: Vec<Answer>, studied: Box<Studied> },
    /// A system for each mode.
    Modes { experiment: Box<Experiment>, windows: Vec<ModeWindow> },
    /// A body that is moved slowly.
    Slow { experiment: Box<SlowExperiment>, answers: Box<SlowAnswers>, study: Vec<StudyRow> },
    /// A body in space.
    Space { experiment: Box<SpaceExperiment>, answers: Box<SpaceAnswers> },
    /// Several experiments with one set of parameters.
    Joint { experiments: Box<JointExperiments>, answer: Box<JointAnswer> },
}

/// An experiment, and what its observers made of it.
#[pyclass(frozen, module = "palmistry._native")]
pub struct ObservationFound {
    pub seen: Seen,
    pub times: bool,
    pub interrupted: bool,
}

impl ObservationFound {
    /// The track of the answer that is shown.
    fn track(&self) -> Option<&Track> {
        match &self.seen {
            Seen::Moving { answers, .. } => shown(answers).map(|answer| &answer.track),
            _ => None,
        }
    }
}

#[pymethods]
impl ObservationFound {
    fn json(&self) -> String {
        let interrupted = self.interrupted;
        let mut object = match &self.seen {
            Seen::Moving { experiment, answers, studied } => {
                observe_json(&Observed { experiment, answers, studied, interrupted })
            }
            Seen::Modes { experiment, windows } => {
                let mut object = modes_json(experiment, windows);
                object["interrupted"] = json!(interrupted);
                object
            }
            Seen::Slow { experiment, answers, study } => {
                slow_json(&SlowObserved { experiment, answers, study, interrupted })
            }
            Seen::Space { experiment, answers } => {
                space_json(&SpaceObserved { experiment, answers, interrupted })
            }
            Seen::Joint { experiments, answer } => {
                joint_json(&JointObserved { experiments, answer, interrupted })
            }
        };
        if !self.times {
            forget_seconds(&mut object);
        }
        printed(object)
    }

    fn text(&self) -> String {
        let interrupted = self.interrupted;
        match &self.seen {
            Seen::Moving { experiment, answers, studied } => {
                observe_text(&Observed { experiment, answers, studied, interrupted })
            }
            Seen::Modes { experiment, windows } => modes_text(experiment, windows),
            Seen::Slow { experiment, answers, study } => {
                slow_text(&SlowObserved { experiment, answers, study, interrupted })
            }
            Seen::Space { experiment, answers } => {
                space_text(&SpaceObserved { experiment, answers, interrupted })
            }
            Seen::Joint { experiments, answer } => {
                joint_text(&JointObserved { experiments, answer, interrupted })
            }
        }
    }

    /// The whole page; none of a system for each mode.
    fn page(&self) -> Option<String> {
        let interrupted = self.interrupted;
        match &self.seen {
            Seen::Moving { experiment, answers, studied } => {
                Some(observe_page(&Observed { experiment, answers, studied, interrupted }))
            }
            Seen::Modes { .. } => None,
            Seen::Slow { experiment, answers, study } => {
                Some(slow_page(&SlowObserved { experiment, answers, study, interrupted }))
            }
            Seen::Space { experiment, answers } => {
                Some(space_page(&SpaceObserved { experiment, answers, interrupted }))
            }
            Seen::Joint { experiments, answer } => {
                Some(joint_page(&JointObserved { experiments, answer, interrupted }))
            }
        }
    }

    /// A table by its name: `measurements`, `motion`, `track` or `outline`; none where there is no such thing.
    fn table<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyDict>>> {
        let found = match (&self.seen, name) {
            (Seen::Moving { experiment, .. } | Seen::Modes { experiment, .. }, "measurements") => {
                Some(Ok(experiment.record.clone()))
            }
            (Seen::Slow { experiment, .. }, "measurements") => Some(experiment.record()),
            (Seen::Space { experiment, .. }, "measurements") => Some(experiment.measurements.record()),
            (Seen::Moving { experiment, .. } | Seen::Modes { experiment, .. }, "motion") => {
                match (&experiment.simulation, &experiment.motion) {
                    (Some(simulation), _) => Some(simulation.table()),
                    (None, motion) => motion.as_ref().map(|motion| motion.table()),
                }
            }
            (Seen::Moving { experiment, answers, .. }, _) => {
                let answer = shown(answers);
                let reconstruction = answer.and_then(|answer| answer.reconstruction.as_deref());
                match name {
                    "track" => answer.map(|answer| experiment.track_table(answer, reconstruction)),
                    _ => reconstruction.and_then(|found| found.outline_table()),
                }
            }
            _ => None,
        };
        let Some(found) = found else { return Ok(None) };
        let record = found.map_err(|why| unusable(py, &why.to_string(), None))?;
        columns(py, &record).map(Some)
    }

    /// The method whose answer is shown; none where there is no such thing.
    fn shown(&self) -> Option<&'static str> {
        match &self.seen {
            Seen::Moving { answers, .. } => shown(answers).map(|answer| answer.method.name()),
            _ => None,
        }
    }

    /// The names of what is estimated.
    fn sought(&self) -> Vec<String> {
        match &self.seen {
            Seen::Moving { experiment, .. } => experiment.names().into_iter().map(str::to_owned).collect(),
            _ => Vec::new(),
        }
    }

    /// What the model expected minus what was read, by output, with the times; none where nothing was compared.
    fn residuals<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let (Seen::Moving { experiment, .. }, Some(track)) = (&self.seen, self.track()) else {
            return Ok(None);
        };
        let task = experiment.task(&NEVER).map_err(|error| crate::errors::unreadable(py, &error))?;
        let compared: Vec<_> = track
            .estimates
            .iter()
            .filter(|sample| sample.residual.len() == task.full.outputs.len())
            .collect();
        if compared.is_empty() {
            return Ok(None);
        }
        let found = PyDict::new(py);
        found.set_item("time", PyArray1::from_iter(py, compared.iter().map(|sample| sample.time)))?;
        for (place, name) in task.full.outputs.iter().enumerate() {
            let values = compared.iter().map(|sample| sample.residual[place]);
            found.set_item(name, PyArray1::from_iter(py, values))?;
        }
        Ok(Some(found))
    }

    /// The covariance of what is estimated at the first sample of a window, of shape (estimates, estimates); none where there is no such window, or something
    /// is not observable in it.
    fn covariance<'py>(&self, py: Python<'py>, window: usize) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let update = self.track().and_then(|track| track.updates.get(window));
        let Some(whole) = update.and_then(|update| update.covariance.as_ref()) else { return Ok(None) };
        let sought = self.sought().len().min(whole.nrows());
        let rows: Vec<Vec<f64>> = (0..sought).map(|i| (0..sought).map(|j| whole[(i, j)]).collect()).collect();
        Ok(Some(PyArray2::from_vec2(py, &rows)?))
    }
}

/// Nobody ends what takes no time.
static NEVER: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);
