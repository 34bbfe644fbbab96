//! Scenes, papers and formulas: what is asked without a system.

use crate::answers::printed;
use crate::errors::{unreadable, unusable};
use crate::observed::{ObservationFound, Seen};
use crate::system::System;
use crate::work::{Cut, interruptible, keeping};
use numpy::PyReadonlyArray1;
use palmistry::experiment::joint::{JointExperiments, JointScene};
use palmistry::experiment::slow::{SlowExperiment, SlowScene, StudyRow, slow_study};
use palmistry::experiment::space::{SpaceExperiment, SpaceScene};
use palmistry::experiment::{
    Answer, Experiment, Measurements, Scene, Studied, basins, curvature_map, noise_study,
};
use palmistry::paper::{Paper, VerifyOptions, verify as verify_paper};
use palmistry::report::{
    expression_latex, findings_json, forget_seconds, forget_times, page, statement_latex,
};
use palmistry::{ReadError, System as Read};
use pyo3::prelude::*;
use std::cell::RefCell;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

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

/// Runs the observers of a scene, of any kind.
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
        let data = data.as_deref();
        if let Some(space) = SpaceScene::read(&scene) {
            let mut scene = space?;
            scene.seed = seed.unwrap_or(scene.seed);
            return in_space(SpaceExperiment::new(scene, data)?, studies, times, interrupt);
        }
        if let Some(slow) = SlowScene::read(&scene) {
            let mut scene = slow?;
            scene.seed = seed.unwrap_or(scene.seed);
            return slowly(SlowExperiment::new(scene, data)?, studies, times, interrupt);
        }
        if let Some(joint) = JointScene::read(&scene) {
            let mut scene = joint?;
            scene.seed = seed.unwrap_or(scene.seed);
            return jointly(JointExperiments::new(scene, data)?, studies, times, interrupt);
        }
        let mut scene = Scene::read(&scene)?;
        scene.seed = seed.unwrap_or(scene.seed);
        moving(Experiment::new(scene, data)?, studies, times, interrupt)
    });
    told(py, found)
}

/// Runs observers on measurements of a system that is at hand: a scene's text without a model that is looked for, and a file or columns under their names.
#[pyfunction]
pub fn observe_measured<'py>(
    py: Python<'py>,
    system: &System,
    scene: String,
    file: Option<PathBuf>,
    columns: Vec<(String, PyReadonlyArray1<'py, f64>)>,
    times: bool,
) -> PyResult<ObservationFound> {
    let copy = |(name, values): (String, PyReadonlyArray1<'py, f64>)| {
        PyResult::Ok((name, values.as_slice().map(<[f64]>::to_vec)?))
    };
    let columns = columns.into_iter().map(copy).collect::<PyResult<Vec<_>>>()?;
    let system = Read::clone(system.read_system());
    let found = keeping(py, move |interrupt| {
        let scene = Scene::parse("what was asked of observe", &scene)?;
        let measurements = match &file {
            Some(file) => Measurements::File(file),
            None => Measurements::Columns(columns),
        };
        moving(Experiment::measured(scene, system, measurements)?, false, times, interrupt)
    });
    told(py, found)
}

type Found = Result<ObservationFound, Trouble>;

fn told(py: Python<'_>, found: Result<Found, Cut<Found>>) -> PyResult<ObservationFound> {
    let found = found.map_err(|cut| cut.map(Result::ok).with_found(py))?;
    found.map_err(|trouble| match trouble {
        Trouble::Read(error) => unreadable(py, &error),
        Trouble::NoStudies => {
            let message =
                "the scene has no studies, or its measurements come from a file, which knows no truth";
            let help = "leave out studies=True, or add [study.noise], [study.basin] or [study.curvature]";
            unusable(py, message, Some(help))
        }
        Trouble::NoStudiesInSpace => {
            unusable(py, "no study of bodies in space is run by a scene", Some("leave out studies=True"))
        }
    })
}

fn moving(mut experiment: Experiment, studies: bool, times: bool, interrupt: &AtomicBool) -> Found {
    if studies && (experiment.simulated().is_none() || experiment.scene.study.is_empty()) {
        return Err(Trouble::NoStudies);
    }
    if !experiment.scene.observer.modes.is_empty() {
        let windows = match experiment.scene.observer.switch {
            Some(_) => experiment.run_switched(interrupt, &|| ())?,
            None => experiment.run_modes(interrupt, &|| ())?,
        };
        let seen = Seen::Modes { experiment: Box::new(experiment), windows };
        return Ok(ObservationFound { seen, times, interrupted: interrupt.load(Ordering::Relaxed) });
    }
    let mut answers = experiment.run_with_shape(interrupt, &|_| ())?;
    experiment.recognition = experiment.recognise(interrupt)?;
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
    let seen = Seen::Moving { experiment: Box::new(experiment), answers, studied: Box::new(studied) };
    Ok(ObservationFound { seen, times, interrupted })
}

fn slowly(experiment: SlowExperiment, studies: bool, times: bool, interrupt: &AtomicBool) -> Found {
    let cut = || interrupt.load(Ordering::Relaxed);
    let settings = experiment.scene.study.clone().filter(|_| studies);
    if studies && settings.is_none() {
        return Err(Trouble::NoStudies);
    }
    let mut answers = experiment.run(&cut, &|_| ());
    let study = RefCell::new(Vec::new());
    if settings.is_some() {
        let keep = |rows: &[StudyRow]| *study.borrow_mut() = rows.to_vec();
        let scene = &experiment.scene;
        slow_study(scene, &cut, &keep)
            .map_err(|error| scene.error_at("study", error.to_string(), "other families may do"))?;
    }
    let mut study = study.into_inner();
    if !times {
        answers.seconds = [f64::NAN; 3];
        study.iter_mut().for_each(StudyRow::forget_times);
    }
    let seen = Seen::Slow { experiment: Box::new(experiment), answers: Box::new(answers), study };
    Ok(ObservationFound { seen, times, interrupted: cut() })
}

fn in_space(experiment: SpaceExperiment, studies: bool, times: bool, interrupt: &AtomicBool) -> Found {
    if studies {
        return Err(Trouble::NoStudiesInSpace);
    }
    let cut = || interrupt.load(Ordering::Relaxed);
    let mut answers = experiment.run(&cut, &|| ());
    if !times {
        answers.forget_times();
    }
    let seen = Seen::Space { experiment: Box::new(experiment), answers: Box::new(answers) };
    Ok(ObservationFound { seen, times, interrupted: cut() })
}

fn jointly(experiments: JointExperiments, studies: bool, times: bool, interrupt: &AtomicBool) -> Found {
    if studies {
        return Err(Trouble::NoStudies);
    }
    let cut = || interrupt.load(Ordering::Relaxed);
    let answer = experiments.run(None, &cut, &|| ());
    let seen = Seen::Joint { experiments: Box::new(experiments), answer: Box::new(answer) };
    Ok(ObservationFound { seen, times, interrupted: cut() })
}

/// Why a scene is not run.
enum Trouble {
    Read(Box<ReadError>),
    NoStudies,
    NoStudiesInSpace,
}

impl From<ReadError> for Trouble {
    fn from(error: ReadError) -> Trouble {
        Trouble::Read(Box::new(error))
    }
}

/// Checks a whole paper: the JSON of what was found, and the page.
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
