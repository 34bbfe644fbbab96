//! Studies: of number types on a system, of motions of palms, of where a body lies between them.

use crate::errors::{unreadable, unusable};
use crate::system::System;
use crate::told::Told;
use crate::work::{Cut, interruptible, keeping};
use palmistry::experiment::space::{RunsQuestion, SpaceScene, advise_runs};
use palmistry::experiment::{AdviceLimits, AdviceQuestion, Scene, advise as advise_motions};
use palmistry::pose_surface::{PalmPair, PoseBody, PoseLimits, PoseQuestion, survey_poses};
use palmistry::report::{
    advice_json, advice_text, poses_json, poses_page, poses_text, read_error_json, runs_advice_json,
    runs_advice_text, stress_json, stress_pictures, stress_text, trade_json, trade_plot, trade_text,
};
use palmistry::system::{MOST_PROBLEMS, format_text};
use palmistry::tradeoff::stress::{Stress, StressOptions};
use palmistry::tradeoff::{LandscapeRows, TradeQuestion, trade as measured_trade};
use palmistry::{ReadError, System as Read};
use pyo3::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

/// What the program takes where nothing is said: rounds of timing, and states on each set that are looked at in other units.
const ROUNDS: usize = 15;
const SAMPLES_ON_SETS: u64 = 6;

/// Why there is no answer.
enum Why {
    Read(Box<ReadError>),
    Said(String),
}

impl From<ReadError> for Why {
    fn from(error: ReadError) -> Why {
        Why::Read(Box::new(error))
    }
}

fn answered(py: Python<'_>, found: Result<Result<Told, Why>, Cut<Result<Told, Why>>>) -> PyResult<Told> {
    let found = found.map_err(|cut| cut.map(Result::ok).with_found(py))?;
    found.map_err(|why| match why {
        Why::Read(error) => unreadable(py, &error),
        Why::Said(why) => unusable(py, &why, None),
    })
}

fn with_end(mut object: Value, interrupted: bool) -> Value {
    object["interrupted"] = json!(interrupted);
    object
}

/// What accuracy costs: number types, ways to a derivative and ways to a rank on the same states. The picture is the page.
#[pyfunction]
pub fn trade(py: Python<'_>, system: &System, samples: u64, seed: u64) -> PyResult<Told> {
    let system = Read::clone(system.read_system());
    let found = keeping(py, move |interrupt| {
        let question = TradeQuestion { samples, seed, rounds: ROUNDS, interrupt, progress: &|_, _| () };
        let found = measured_trade(&system, &question).map_err(Why::Said)?;
        Ok(Told::new(trade_json(&found), trade_text(&found)).with_page(trade_plot(&found)))
    });
    answered(py, found)
}

/// Number types at the extremes: the answer, and its pictures by name.
#[pyfunction]
pub fn stress(
    py: Python<'_>,
    system: &System,
    own_rows: bool,
    states: u64,
    samples: u64,
    seed: u64,
) -> PyResult<(Told, Vec<(String, String)>)> {
    let mut system = Read::clone(system.read_system());
    let found = interruptible(py, move |interrupt| {
        let samples_on_sets = SAMPLES_ON_SETS;
        let options =
            StressOptions { seed, states, step: 1, samples, samples_on_sets, interrupt, progress: &|| () };
        let rows = if own_rows { LandscapeRows::Own } else { LandscapeRows::Full };
        let study = Stress::of_file(&mut system, rows, &options)?.run(&options);
        let pictures = stress_pictures(&study).into_iter();
        // names of files begin with that of the system, and end with what is drawn
        let named =
            |(name, svg): (String, String)| (name.rsplit('-').next().unwrap_or_default().to_owned(), svg);
        let pictures = pictures.map(named).collect();
        let interrupted = study.interrupted;
        let studies = [study];
        let told = Told::new(with_end(stress_json(&studies, seed), interrupted), stress_text(&studies));
        Ok::<_, String>((told, pictures))
    })?;
    found.map_err(|why| unusable(py, &why, None))
}

/// Motions of palms that touch all of a scene's body, or runs of a body in space. What is not given is what the program takes.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn advise(
    py: Python<'_>,
    scene: PathBuf,
    trials: Option<usize>,
    angles: [[f64; 2]; 2],
    rate: Option<f64>,
    runs: Option<usize>,
    seed: Option<u64>,
) -> PyResult<Told> {
    let found = keeping(py, move |interrupt| {
        let ended = || interrupt.load(Ordering::Relaxed);
        if let Some(space) = SpaceScene::read(&scene) {
            let scene = space?;
            let question = RunsQuestion {
                runs: runs.unwrap_or(4),
                trials: trials.unwrap_or(32),
                rate: rate.unwrap_or(0.5),
                seed: seed.unwrap_or(scene.seed),
            };
            let advice = advise_runs(&scene, &question, interrupt, &|| ())?;
            return Ok(Told::new(
                runs_advice_json(&scene, &advice, ended()),
                runs_advice_text(&scene, &advice),
            ));
        }
        if runs.is_some() {
            return Err(Why::Said(
                "runs are of bodies in space, and this scene has two palms in a plane".to_owned(),
            ));
        }
        let scene = Scene::read(&scene)?;
        let question = AdviceQuestion {
            limits: AdviceLimits { angles, rate: rate.unwrap_or(3.0) },
            trials: trials.unwrap_or(400),
            seed: seed.unwrap_or(scene.seed),
        };
        let advice = advise_motions(&scene, &question, interrupt, &|| ())?;
        Ok(Told::new(advice_json(&scene, &advice, ended()), advice_text(&scene, &advice)))
    });
    answered(py, found)
}

/// Where a body lies between two slow palms: that of a scene, or one that a text tells, with its centre of mass.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn poses(
    py: Python<'_>,
    scene: Option<PathBuf>,
    shape: Option<String>,
    centre: Option<[f64; 2]>,
    palms: [f64; 2],
    margin: f64,
    margins: Vec<f64>,
    turn: Option<[f64; 2]>,
    pad: Option<[f64; 2]>,
    tolerance: f64,
    side: usize,
    levels: u32,
) -> PyResult<Told> {
    let found = keeping(py, move |interrupt| {
        let body = match (&scene, &shape) {
            (Some(scene), None) => Scene::read(scene)?.pose_body()?,
            (None, Some(shape)) => {
                PoseBody::parse(shape, centre).map_err(|why| Why::Said(format!("{shape}: {why}")))?
            }
            _ => {
                let why = "give a scene, or a shape as in shape=\"spline:1.2,1.7,1.3\", and not both";
                return Err(Why::Said(why.to_owned()));
            }
        };
        let wrong = margins.iter().chain([&margin]).find(|one| !(**one > 0.0 && **one < PI / 3.0 - 0.01));
        if let Some(wrong) = wrong {
            let why =
                format!("at a margin of {wrong} rad there are no palm angles: take one between 0.001 and 1");
            return Err(Why::Said(why));
        }
        let palms = PalmPair::new(palms[0], palms[1]);
        if palms.margin() <= 0.0 || palms.margin().is_nan() {
            let why = "not both palms push there: both do where phi1 > 0, phi2 > 0 and phi1 + phi2 < pi";
            return Err(Why::Said(why.to_owned()));
        }
        let limits = PoseLimits { margin, pad, tolerance };
        let question = PoseQuestion { palms, limits, margins: &margins, turn, levels, side, interrupt };
        let survey = survey_poses(body, &question);
        let object = with_end(poses_json(&survey), interrupt.load(Ordering::Relaxed));
        Ok(Told::new(object, poses_text(&survey)).with_page(poses_page(&survey)))
    });
    answered(py, found)
}

/// All that is wrong with a proof file, as the program prints it with `--json`, each an object, and whether there is more.
#[pyfunction]
pub fn examined(py: Python<'_>, path: PathBuf) -> PyResult<(String, bool)> {
    interruptible(py, move |_| {
        let found = Read::examine(&path, MOST_PROBLEMS);
        let problems: Vec<Value> = found.problems.iter().map(read_error_json).collect();
        (Value::Array(problems).to_string(), found.more)
    })
}

/// The text of a proof file in its normal form.
#[pyfunction]
pub fn formatted(py: Python<'_>, name: &str, text: &str) -> PyResult<String> {
    format_text(name, text).map_err(|error| unreadable(py, &error))
}
