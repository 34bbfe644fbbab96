//! A system as Python sees it. Questions are asked without the lock of the interpreter, of a copy of their own.

use crate::answers::{CertificateFound, ClaimsFound, RankFound, printed};
use crate::errors::{given, no_value, unreadable, unusable};
use crate::states::StatesDecider;
use crate::work::{Cut, interruptible, interruptible_here, keeping};
use numpy::{PyArray1, PyReadonlyArray1};
use palmistry::certificate::{Limits, Region, RegionRows};
use palmistry::claim::{Kept, Selection, decide_all_keeping, evaluate};
use palmistry::report::{ValueAsked, unit_of, value_json};
use palmistry::sweep::{Certainty, RankError, RankPreparation, StateRow, StateTable};
use palmistry::system::Role;
use palmistry::tradeoff::standard_deviations_at;
use palmistry::{Outcome, RankAnswer, RankQuestion, System as Read};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// A system that was read from a proof file.
#[pyclass(frozen, module = "palmistry._native")]
pub struct System {
    system: Arc<Read>,
}

/// What a rank is asked with.
struct Asked {
    samples: u64,
    seed: u64,
    wanted: Certainty,
    digits: Option<usize>,
    order: Option<usize>,
    conditions: Vec<String>,
}

#[pymethods]
impl System {
    /// Reads a proof file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<System> {
        System::of(py, interruptible(py, move |_| Read::read(&path))?)
    }

    /// Reads a system from a text.
    #[staticmethod]
    fn parse(py: Python<'_>, text: String, name: String, folder: PathBuf) -> PyResult<System> {
        System::of(py, interruptible(py, move |_| Read::parse(&name, &text, Path::new(&folder)))?)
    }

    #[getter]
    fn title(&self) -> &str {
        &self.system.title
    }

    #[getter]
    fn name(&self) -> &str {
        &self.system.name
    }

    #[getter]
    fn source(&self) -> &str {
        &self.system.source
    }

    /// The states, in the order of the file.
    #[getter]
    fn states(&self) -> Vec<String> {
        self.system.states.iter().map(|state| self.system.symbol_name(*state).to_owned()).collect()
    }

    /// Symbols that are no states of this file, in the order in which it names them.
    #[getter]
    fn parameters(&self) -> Vec<String> {
        let others = self.system.symbols().filter(|(symbol, _)| !self.system.states.contains(symbol));
        others.map(|(symbol, _)| self.system.symbol_name(symbol).to_owned()).collect()
    }

    /// The fields with their roles, `drift`, `input` or `field`.
    #[getter]
    fn fields(&self) -> Vec<(String, &'static str)> {
        let role = |role: Role| role.name();
        self.system.fields.iter().map(|field| (field.name.clone(), role(field.role))).collect()
    }

    /// The outputs as they are written.
    #[getter]
    fn outputs(&self) -> Vec<String> {
        self.system.outputs.iter().map(|(text, _)| text.clone()).collect()
    }

    /// The names of the unknowns: states and unknown parameters.
    #[getter]
    fn unknowns(&self) -> Vec<String> {
        self.system.unknowns().into_iter().map(|symbol| self.system.symbol_name(symbol).to_owned()).collect()
    }

    /// The ends of the ranges from which symbols are drawn, by name: of the file's sample box, or the default of what has none.
    fn sample_box(&self) -> BTreeMap<String, (f64, f64)> {
        let range = |(symbol, info): (_, &palmistry::system::SymbolInfo)| {
            let range = info.range.clone().or_else(|| self.system.default_range(symbol))?;
            let [low, high] = [&range.low, &range.high].map(palmistry::number::rational_to_f64);
            Some((self.system.symbol_name(symbol).to_owned(), (low, high)))
        };
        self.system.symbols().filter_map(range).collect()
    }

    /// The names of the claims.
    #[getter]
    fn claims(&self) -> Vec<String> {
        self.system.claims.iter().map(|claim| claim.id.clone()).collect()
    }

    /// The unit of a symbol; none where the file says nothing of it.
    fn unit(&self, name: &str) -> Option<String> {
        unit_of(&self.system, name)
    }

    /// Decides the claims that meet any of the patterns; all where there are none. What the verdicts rest on is kept if it is to be.
    fn prove(&self, py: Python<'_>, only: Vec<String>, seed: u64, evidence: bool) -> PyResult<ClaimsFound> {
        let mut system = Read::clone(&self.system);
        let selection = Selection::new(&only);
        if let Some(unmet) = selection.unmet(system.claims.iter().map(|claim| claim.id.as_str())) {
            let help = unmet.nearest.as_ref().map(|near| format!("perhaps you meant '{near}'"));
            return Err(unusable(py, &unmet.to_string(), help.as_deref()));
        }
        system.claims.retain(|claim| selection.keeps(&claim.id));
        let asked = system.claims.len();
        let order: Vec<String> = system.claims.iter().map(|claim| claim.id.clone()).collect();
        // a claim that was begun is not cut short: those that were decided before are kept beside it
        let (begin, decided) = (Instant::now(), Arc::new(Mutex::new(Vec::new())));
        let keep = decided.clone();
        let found = keeping(py, move |interrupt| {
            let done =
                |outcome: &Outcome| keep.lock().unwrap_or_else(PoisonError::into_inner).push(outcome.clone());
            let kept = if evidence { Kept::Evidence } else { Kept::Verdicts };
            decide_all_keeping(kept, &system, seed, interrupt, &done)
        });
        let seconds = move || begin.elapsed().as_secs_f64();
        let made =
            |outcomes| ClaimsFound { outcomes, asked, seed, seconds: seconds(), has_evidence: evidence };
        found.map(made).map_err(|cut| {
            let before = || {
                let mut decided = decided.lock().unwrap_or_else(PoisonError::into_inner).clone();
                decided.sort_by_key(|outcome| order.iter().position(|id| *id == outcome.id));
                decided
            };
            let found = cut.found.unwrap_or_else(before);
            Cut { raised: cut.raised, found: Some(made(found)) }.with_found(py)
        })
    }

    /// The rank of the observability codistribution at sampled states.
    #[allow(clippy::too_many_arguments)]
    fn rank(
        &self,
        py: Python<'_>,
        samples: Option<u64>,
        seed: u64,
        at: Vec<String>,
        conditions: Vec<String>,
        order: Option<usize>,
        certified: bool,
        digits: Option<usize>,
        times: bool,
        table: bool,
        coordinates: bool,
    ) -> PyResult<RankFound> {
        let fixed = self.system.given_values(&at).map_err(|error| given(py, &error))?;
        let fixed: BTreeMap<_, _> = fixed.into_iter().collect();
        let mut system = Read::clone(&self.system);
        // where nothing is asked for, states are looked at where that takes no time, as by the program
        let nothing_asked = samples.is_none() && order.is_none();
        let samples = samples.unwrap_or(RankQuestion::default().samples);
        let asked = Asked { samples, seed, wanted: wanted(certified), digits, order, conditions };
        let found = keeping(py, move |interrupt| {
            let question = RankQuestion {
                samples: asked.samples,
                seed: asked.seed,
                wanted: asked.wanted,
                digits: asked.digits,
                order: asked.order,
                fixed,
                conditions: asked.conditions,
                recorded: 0,
                interrupt,
                progress: &|_| (),
            };
            let prepared = match nothing_asked {
                true => RankPreparation::at_once(&mut system, &question)?,
                false => RankPreparation::new(&mut system, &question)?,
            };
            let mut rows: Vec<(usize, StateRow)> = Vec::new();
            let symbols = if coordinates { prepared.coordinates() } else { Vec::new() };
            let names = symbols.iter().map(|symbol| system.symbol_name(*symbol).to_owned()).collect();
            let mut take = |branch: usize, found: &[StateRow]| {
                rows.extend(found.iter().map(|row| (branch, row.clone())));
            };
            let mut sink = StateTable { coordinates: symbols, take: &mut take };
            let part = prepared.sweep_with(&system, 0..question.samples, table.then_some(&mut sink))?;
            let answer = prepared.answer(&mut system, [(String::new(), part)])?;
            Ok::<_, RankError>((answer, rows, names))
        });
        let made = |(mut answer, rows, coordinates): (RankAnswer, Vec<_>, Vec<String>)| {
            if !times {
                answer.forget_times();
            }
            RankFound { answer, rows: table.then_some(rows), coordinates }
        };
        let found = found.map_err(|cut| cut.map(|found| found.ok().map(made)).with_found(py))?;
        found.map(made).map_err(|why| unusable(py, &why.to_string(), None))
    }

    /// The value of an expression at a point, as the program prints it.
    fn eval(
        &self,
        py: Python<'_>,
        expression: String,
        at: Vec<String>,
        digits: usize,
        certified: bool,
    ) -> PyResult<String> {
        let values = self.system.given_values(&at).map_err(|error| given(py, &error))?;
        let mut system = Read::clone(&self.system);
        let (found, system, expression, values) = interruptible(py, move |_| {
            let found = evaluate(&mut system, &expression, &values, digits, wanted(certified));
            (found, system, expression, values)
        })?;
        let value = found.map_err(|error| no_value(py, &error))?;
        let mut at: Vec<_> = values
            .into_iter()
            .map(|(symbol, value)| (system.symbol_name(symbol).to_owned(), value))
            .collect();
        at.sort();
        Ok(printed(value_json(&ValueAsked { expression: &expression, digits, at: &at }, &value)))
    }

    /// What decides states that are handed over.
    fn decider(
        &self,
        py: Python<'_>,
        at: Vec<String>,
        order: Option<usize>,
        certified: bool,
    ) -> PyResult<StatesDecider> {
        let fixed = self.system.given_values(&at).map_err(|error| given(py, &error))?;
        let fixed: BTreeMap<_, _> = fixed.into_iter().collect();
        let mut system = Read::clone(&self.system);
        let found = interruptible(py, move |interrupt| {
            let question = RankQuestion {
                fixed,
                order,
                wanted: wanted(certified),
                interrupt,
                ..RankQuestion::default()
            };
            let prepared = RankPreparation::new(&mut system, &question)?;
            let states = prepared.at_given_states(&mut system)?;
            Ok::<_, RankError>(StatesDecider::new(&system, states))
        })?;
        found.map_err(|why| unusable(py, &why.to_string(), None))
    }

    /// The standard deviation of each unknown over its prior one at states that are handed over, an array a coordinate: infinite where it is
    /// not observable, not a number at a singularity.
    fn standard_deviations<'py>(
        &self,
        py: Python<'py>,
        at: Vec<String>,
        order: Option<usize>,
        names: Vec<String>,
        states: Vec<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let fixed = self.system.given_values(&at).map_err(|error| given(py, &error))?;
        let fixed: Vec<_> = fixed
            .into_iter()
            .map(|(symbol, value)| (self.system.symbol_name(symbol).to_owned(), value))
            .collect();
        let slices: Vec<&[f64]> = states.iter().map(|array| array.as_slice()).collect::<Result<_, _>>()?;
        let count = slices.iter().map(|column| column.len()).min().unwrap_or(0);
        let rows: Vec<Vec<f64>> =
            (0..count).map(|row| slices.iter().map(|column| column[row]).collect()).collect();
        let found = interruptible_here(py, |_| {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
            standard_deviations_at(&self.system, order, &fixed, &names, &rows)
        })?;
        let (unknowns, found) = found.map_err(|why| unusable(py, &why, None))?;
        let columns = PyDict::new(py);
        for (place, name) in unknowns.iter().enumerate() {
            let column = found.iter().map(|point| point.as_ref().map_or(f64::NAN, |all| all[place]));
            columns.set_item(name, PyArray1::from_vec(py, column.collect()))?;
        }
        Ok(columns)
    }

    /// On which part of the sample box the rank is full, proved.
    #[allow(clippy::too_many_arguments)]
    fn certify(
        &self,
        py: Python<'_>,
        ranges: Vec<String>,
        boxes: Option<u64>,
        budget: f64,
        own_rows: bool,
        order: Option<usize>,
        map: Option<(String, String)>,
    ) -> PyResult<CertificateFound> {
        let mut system = Read::clone(&self.system);
        let ranges = system.given_ranges(&ranges).map_err(|error| given(py, &error))?;
        let rows = if own_rows { RegionRows::Own } else { RegionRows::Codistribution(order) };
        let symbol = |name: &str| self.system.own_symbol(name).map_err(|error| given(py, &error));
        let map = map.map(|(x, y)| PyResult::Ok((symbol(&x)?, symbol(&y)?))).transpose()?;
        let unit = |symbol| unit_of(&self.system, self.system.symbol_name(symbol));
        let units = map.map_or([None, None], |(x, y)| [unit(x), unit(y)]);
        let limits = match boxes {
            Some(boxes) => Limits { seconds: None, boxes: Some(boxes) },
            None => Limits { seconds: Some(budget), boxes: None },
        };
        let found = keeping(py, move |interrupt| {
            let mut region = Region::new(&mut system, rows, &ranges, map)?;
            region.run(limits, interrupt, &|_| ());
            Ok::<_, String>(region.answer_until(interrupt))
        });
        let made = |answer, interrupted| CertificateFound { answer, units: units.clone(), interrupted };
        let kept = |found: Result<_, String>| found.ok().map(|answer| made(answer, true));
        let found = found.map_err(|cut| cut.map(kept).with_found(py))?;
        found.map(|answer| made(answer, false)).map_err(|why| unusable(py, &why, None))
    }
}

fn wanted(certified: bool) -> Certainty {
    if certified { Certainty::Certified } else { Certainty::Computed }
}

impl System {
    /// What was read.
    pub fn read_system(&self) -> &Read {
        &self.system
    }

    fn of(py: Python<'_>, found: Result<Read, palmistry::ReadError>) -> PyResult<System> {
        match found {
            Ok(system) => Ok(System { system: Arc::new(system) }),
            Err(error) => Err(unreadable(py, &error)),
        }
    }
}
