//! What is asked of a system beside claims, ranks and boxes; and verdict files held to their proof files.

use crate::errors::{given, unreadable, unusable};
use crate::system::System;
use crate::told::Told;
use crate::work::{interruptible, keeping};
use palmistry::checker::{Checking, Effort, LARGEST_FILE, ProofSources, VerdictFile};
use palmistry::design::{AdditionKind, DesignQuestion, design as ask_design};
use palmistry::drops::where_it_drops;
use palmistry::file::{read_old_text, read_text};
use palmistry::foreign::name_of;
use palmistry::import::{ForeignFormat, ForeignUnknowns, ImportQuestion, import, import_petab, petab_beside};
use palmistry::reduction::{ReduceQuestion, reduce};
use palmistry::report::{
    accessibility_json, accessibility_text, design_json, design_text, drops_json, drops_page, drops_text,
    global_json, global_text, recheck_json, recheck_text,
};
use palmistry::sweep::{RankError, SolutionsWanted, answer_accessibility, answer_solutions};
use palmistry::system::given_number;
use palmistry::{RankQuestion, System as Read};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

/// Models of other programs that are longer than this are refused, as by the program.
const LONGEST_MODEL: u64 = 16 << 20;

/// How many values of each unknown give the same outputs.
#[pyfunction]
pub fn solutions(py: Python<'_>, system: &System, functions: bool, work: Option<u64>) -> PyResult<Told> {
    let mut system = Read::clone(system.read_system());
    let work = work.unwrap_or(palmistry::observability::SOLUTIONS_WORK);
    let wanted = if functions { SolutionsWanted::Functions } else { SolutionsWanted::Values };
    let found = keeping(py, move |interrupt| answer_solutions(&mut system, wanted, work, interrupt));
    let made = |answer| Told::new(global_json(&answer), global_text(&answer));
    let found = found.map_err(|cut| cut.map(|found| found.ok().map(made)).with_found(py))?;
    found.map(made).map_err(|why| unusable(py, &why.to_string(), None))
}

/// What to measure or to know besides.
#[pyfunction]
pub fn design(
    py: Python<'_>,
    system: &System,
    identify: Vec<String>,
    globally: bool,
    by: Option<Vec<String>>,
    measure: Option<Vec<String>>,
    at_most: usize,
) -> PyResult<Told> {
    let kind = |word: &String| match word.as_str() {
        "outputs" => Ok(AdditionKind::Outputs),
        "known" => Ok(AdditionKind::Known),
        "initial" => Ok(AdditionKind::Initial),
        "inputs" => Ok(AdditionKind::Inputs),
        "experiments" => Ok(AdditionKind::Experiments),
        _ => {
            let help = "one of 'outputs', 'known', 'initial', 'inputs', 'experiments'";
            Err(unusable(py, &format!("'{word}' is nothing that can be added"), Some(help)))
        }
    };
    let kinds = by.map(|by| by.iter().map(kind).collect::<PyResult<Vec<_>>>()).transpose()?;
    let system = Read::clone(system.read_system());
    let found = keeping(py, move |interrupt| {
        let folder = PathBuf::from(&system.name);
        let of_a_file = DesignQuestion::of(folder.parent().unwrap_or(Path::new("")), interrupt);
        let question = DesignQuestion {
            targets: identify,
            kinds: kinds.unwrap_or_else(|| of_a_file.kinds.clone()),
            measurable: measure,
            at_most,
            globally,
            ..of_a_file
        };
        ask_design(&system, &question)
    });
    let made = |answer| Told::new(design_json(&answer), design_text(&answer));
    let found = found.map_err(|cut| cut.map(|found| found.ok().map(made)).with_found(py))?;
    found.map(made).map_err(|why| unusable(py, &why.to_string(), None))
}

/// The singular set.
#[pyfunction]
pub fn drops(py: Python<'_>, system: &System, seed: u64) -> PyResult<Told> {
    let mut system = Read::clone(system.read_system());
    let found = keeping(py, move |interrupt| where_it_drops(&mut system, seed, interrupt));
    let made = |answer| Told::new(drops_json(&answer), drops_text(&answer)).with_page(drops_page(&answer));
    let found = found.map_err(|cut| cut.map(|found| found.ok().map(made)).with_found(py))?;
    found.map(made).map_err(|why| unusable(py, &why, None))
}

/// What the inputs can move.
#[pyfunction]
pub fn accessible(
    py: Python<'_>,
    system: &System,
    samples: Option<u64>,
    seed: u64,
    at: Vec<String>,
    conditions: Vec<String>,
    order: Option<usize>,
) -> PyResult<Told> {
    let fixed = system.read_system().given_values(&at).map_err(|error| given(py, &error))?;
    let fixed: BTreeMap<_, _> = fixed.into_iter().collect();
    let mut system = Read::clone(system.read_system());
    let found = keeping(py, move |interrupt| {
        let samples = samples.unwrap_or(RankQuestion::default().samples);
        let question =
            RankQuestion { samples, seed, order, fixed, conditions, interrupt, ..RankQuestion::default() };
        answer_accessibility(&mut system, &question)
    });
    let made = |answer| Told::new(accessibility_json(&answer), accessibility_text(&answer));
    let found = found.map_err(|cut| cut.map(|found| found.ok().map(made)).with_found(py))?;
    found.map(made).map_err(|why| unusable(py, &why.to_string(), None))
}

/// The text of a system without what is not observable, as a proof file.
#[pyfunction]
pub fn reparametrised(py: Python<'_>, system: &System) -> PyResult<String> {
    let mut system = Read::clone(system.read_system());
    let found = interruptible(py, move |interrupt| {
        let question = RankQuestion { samples: 0, interrupt, ..RankQuestion::default() };
        let answer =
            palmistry::answer_rank(&mut system, &question).map_err(|why: RankError| why.to_string())?;
        let [branch] = answer.branches.as_slice() else {
            return Err("the conditions have several branches".to_owned());
        };
        let Some(found) = &branch.motions else {
            return Err("all unknowns are locally observable already".to_owned());
        };
        let name = system.name.clone();
        palmistry::observability::reparametrise(&system, found, &name).map_err(|why| why.to_string())
    })?;
    found.map_err(|why| unusable(py, &why, None))
}

/// The text of the least model of a system under conditions, as a proof file. What is known may have a value, in the language of proof files.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // those of the Python function
pub fn least_model(
    py: Python<'_>,
    system: &System,
    conditions: Vec<String>,
    known: Vec<(String, Option<String>)>,
    undriven: Vec<String>,
    driven: Vec<(String, String)>,
    signals: Vec<String>,
    tolerance: Option<f64>,
) -> PyResult<String> {
    let system = Read::clone(system.read_system());
    let found = interruptible(py, move |_| {
        let value = |(name, value): (String, Option<String>)| match value {
            None => Ok((name, None)),
            Some(text) => match given_number(&text) {
                Ok(value) => Ok((name, Some(value))),
                Err(why) => Err(format!("{name}: {why}")),
            },
        };
        let known = known.into_iter().map(value).collect::<Result<_, String>>()?;
        let question =
            ReduceQuestion { conditions, known, undriven, driven, signals, tolerance, ranges: Vec::new() };
        reduce(&system, &question, &system.name).map(|found| found.text).map_err(|why| why.to_string())
    })?;
    found.map_err(|why| unusable(py, &why, None))
}

/// A problem of parameter estimation as a proof file, a scene and measurements: their texts, what was renamed, and what is worth knowing.
#[pyfunction]
#[allow(clippy::type_complexity)] // taken apart at once in Python
pub fn imported_problem(
    py: Python<'_>,
    path: PathBuf,
    stem: String,
) -> PyResult<(String, String, String, Vec<(String, String)>, Vec<String>)> {
    let name = name_of(&path);
    let read = path.clone();
    let text = interruptible(py, move |_| read_text(&read, LONGEST_MODEL))?;
    let text = text.map_err(|why| unusable(py, &format!("cannot read {name}: {why}"), None))?;
    let load = petab_beside(&path);
    let found = interruptible(py, move |_| import_petab(&name, &text, &stem, &load))?;
    let found = found.map_err(|error| unreadable(py, &error))?;
    Ok((found.proof, found.scene, found.measurements, found.renamed, found.remarks))
}

/// A model of another program as a proof file: its text, its format, what was renamed, and remarks.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
#[allow(clippy::type_complexity)]
pub fn imported(
    py: Python<'_>,
    path: PathBuf,
    format: Option<String>,
    model: Option<String>,
    outputs: Vec<String>,
    unknown: Option<Vec<String>>,
    known_inputs: Vec<String>,
    unknown_inputs: Vec<String>,
    states: Vec<String>,
) -> PyResult<(String, &'static str, Vec<(String, String)>, Vec<String>)> {
    let format = match &format {
        Some(word) => {
            Some(ForeignFormat::ALL.into_iter().find(|one| one.name() == word).ok_or_else(|| {
                let all = ForeignFormat::ALL.map(ForeignFormat::name).join(", ");
                unusable(py, &format!("'{word}' is no format"), Some(&format!("these are {all}")))
            })?)
        }
        None => None,
    };
    let unknowns = match unknown {
        None => ForeignUnknowns::AsTheFileSays,
        Some(names) => match names.as_slice() {
            [all] if all == "all" => ForeignUnknowns::All,
            [] => ForeignUnknowns::None,
            _ => ForeignUnknowns::These(names),
        },
    };
    let question = ImportQuestion { format, model, outputs, unknowns, known_inputs, unknown_inputs, states };
    let name = name_of(&path);
    let text = interruptible(py, move |_| read_old_text(&path, LONGEST_MODEL))?;
    let text = text.map_err(|why| unusable(py, &format!("cannot read {name}: {why}"), None))?;
    let found = interruptible(py, move |_| import(&name, &text, &question))?;
    let found = found.map_err(|error| unreadable(py, &error))?;
    Ok((found.text, found.format.name(), found.renamed, found.model.remarks))
}

/// The same as [`recheck`] of a file of verdicts.
#[pyfunction]
pub fn recheck_file(py: Python<'_>, path: PathBuf, folder: PathBuf, seed: u64) -> PyResult<Told> {
    let name = name_of(&path);
    let text = interruptible(py, move |_| read_text(&path, LARGEST_FILE))?;
    let text = text.map_err(|why| unusable(py, &format!("cannot read {name}: {why}"), None))?;
    recheck(py, text, folder, seed)
}

/// Verdicts, evaluated again by the checker alone, against the proof files in a folder.
#[pyfunction]
pub fn recheck(py: Python<'_>, verdicts: String, folder: PathBuf, seed: u64) -> PyResult<Told> {
    let found = keeping(py, move |interrupt| {
        let file = VerdictFile::read(&verdicts).map_err(|why| why.to_string())?;
        let (sources, effort) = (ProofSources::below(folder), Effort::default());
        let with = Checking { sources: &sources, seed, effort: &effort, interrupt };
        let checked = file.check(with, &|| ());
        let object = recheck_json(&file, &checked, interrupt.load(Ordering::Relaxed));
        Ok::<_, String>(Told::new(object, recheck_text(&checked)))
    });
    let found = found.map_err(|cut| cut.map(Result::ok).with_found(py))?;
    found.map_err(|why| {
        unusable(py, &why, Some("write it by prove(), rank() or certify() with their method verdicts()"))
    })
}
