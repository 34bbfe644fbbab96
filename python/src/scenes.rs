//! Scenes, papers and formulas: what is asked without a system.

use crate::answers::{ObservationFound, printed};
use crate::errors::{unreadable, unusable};
use crate::work::{interruptible, keeping};
use palmistry::ReadError;
use palmistry::experiment::{Answer, Experiment, Scene, Studied, basins, curvature_map, noise_study};
use palmistry::paper::{Paper, VerifyOptions, verify as verify_paper};
use palmistry::report::{
    expression_latex, findings_json, forget_seconds, forget_times, page, statement_latex,
};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

/// An expression or a statement of the language in LaTeX; none where the text is neither.
#[pyfunction]
pub fn latex(text: &str) -> Option<String> {
    expression_latex(text).or_else(|| statement_latex(text))
}

/// Names of another program as names of the language, no two of them one.
#[pyfunction]
pub fn our_names(foreign: Vec<String>) -> Vec<String> {
    palmistry::import::our_names(&foreign)
}

/// Runs the observers of a scene.
#[pyfunction]
pub fn observe(
    py: Python<'_>,
    scene: PathBuf,
    data: Option<PathBuf>,
    seed: Option<u64>,
    studies: bool,
    times: bool,
) -> PyResult<ObservationFound> {
    let found = keeping(py, move |interrupt| {
        let mut scene = Scene::read(&scene)?;
        scene.seed = seed.unwrap_or(scene.seed);
        let experiment = Experiment::new(scene, data.as_deref())?;
        if studies && (experiment.simulated().is_none() || experiment.scene.study.is_empty()) {
            return Err(Trouble::NoStudies);
        }
        let mut answers = experiment.run_with_shape(interrupt, &|_| ())?;
        if !times {
            answers.iter_mut().for_each(Answer::forget_times);
        }
        let (mut studied, study) = (Studied::default(), &experiment.scene.study);
        if let (true, Some(motion)) = (studies, experiment.simulated()) {
            if let Some(settings) = &study.noise {
                studied.noise = noise_study(&experiment, motion, settings, interrupt, &|| ())?;
            }
            if let Some(settings) = &study.basin {
                studied.basins = basins(&experiment, settings, interrupt, &|| ())?;
            }
            if let Some(settings) = &study.curvature {
                studied.curvature = Some(curvature_map(&experiment, settings, interrupt, &|| ())?);
            }
        }
        let interrupted = interrupt.load(Ordering::Relaxed);
        Ok(ObservationFound { experiment, answers, studied, times, interrupted })
    });
    let found = found.map_err(|cut| cut.map(Result::ok).with_found(py))?;
    found.map_err(|trouble| match trouble {
        Trouble::Read(error) => unreadable(py, &error),
        Trouble::NoStudies => {
            let message = "the scene has no studies, or its readings come from a file, which knows no truth";
            let help = "leave out studies=True, or add [study.noise], [study.basin] or [study.curvature]";
            unusable(py, message, Some(help))
        }
    })
}

/// Why a scene is not run.
enum Trouble {
    Read(Box<ReadError>),
    NoStudies,
}

impl From<ReadError> for Trouble {
    fn from(error: ReadError) -> Trouble {
        Trouble::Read(Box::new(error))
    }
}

/// Takes a paper through everything: the JSON of what was found, and the page.
#[pyfunction]
pub fn verify(py: Python<'_>, folder: PathBuf, seed: u64, times: bool) -> PyResult<(String, String)> {
    let found = interruptible(py, move |interrupt| {
        let paper = Paper::read(&folder)?;
        let options = VerifyOptions { seed, interrupt, timed: times, progress: &|_, _, _| () };
        let mut found = verify_paper(&paper, &options)?;
        let mut object = findings_json(&found);
        if !times {
            forget_times(&mut found);
            forget_seconds(&mut object);
        }
        Ok::<_, ReadError>((printed(object), page(&found)))
    })?;
    found.map_err(|error| unreadable(py, &error))
}
