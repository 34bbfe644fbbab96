//! What a scene requires of its model, before anything is estimated: constants, the least model with its proof file, its cost, and what is observable from the measurements.

use super::least::{self, ConstantColumns};
use super::motion_rank::MotionRank;
use super::run::Experiment;
use super::scene::SceneError;
use palmistry_io::UNINTERRUPTED;
use palmistry_lang::{Assignment, Kind, Range, Role, System, given_number};
use palmistry_math::expression::{Input, Program};
use palmistry_math::number::Floats;
use palmistry_observe::{CalibrationKind, EstimateQuestion, Model, MotionRankFound, Task};
use palmistry_rank::observability::{Ceiling, GenericAnswer, Observability, generic_answer};
use palmistry_reduce::{LeastModel, ReduceQuestion, WhyLeftOut, reduce};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// What a scene requires.
#[derive(Clone, Debug)]
pub struct ScenePlan {
    /// The states of the model's file.
    pub states: Vec<String>,
    /// The estimated states.
    pub estimated: Vec<String>,
    /// Outputs that are followed beside the estimated states, since their rates depend on them.
    pub followed: Vec<String>,
    /// The outputs with which an estimate is compared.
    pub compared: Vec<String>,
    /// The quantities with one value all along, in the order of their names.
    pub constants: Vec<PlanConstant>,
    /// Columns of the measurements that drive the model.
    pub driving: Vec<String>,
    /// Columns that are constant for a part of the recording, with the first and last time in s.
    pub steady_for_a_while: Vec<SteadyStretch>,
    /// Operations of the right-hand side with every column as a signal, and with constants put in.
    pub operations: [usize; 2],
    /// Their times, in ns; NaN where no times are measured.
    pub nanoseconds: [f64; 2],
    /// The proof file of the least model, or why there is none.
    pub least: Result<LeastModel, String>,
    /// The generic observability of the least model.
    pub generic: Option<PlanRank>,
    /// The rank along the motion, from the true values where they are known, else from the first guess.
    pub along: MotionRankFound,
    /// Whether it is from the true values.
    pub along_truth: bool,
}

/// A constant of a scene's model.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanConstant {
    /// Its name.
    pub name: String,
    /// Its value, in the file's unit.
    pub value: f64,
    /// Whether a column of the measurements has this value in every sample, up to rounding; else the scene states it.
    pub is_measured: bool,
}

/// A column that has one value at the start or at the end of a recording, and not all along.
#[derive(Clone, Debug, PartialEq)]
pub struct SteadyStretch {
    /// The column.
    pub name: String,
    /// The first time at which it has this value, in s.
    pub from: f64,
    /// The last time at which it has this value, in s.
    pub to: f64,
    /// Its value.
    pub value: f64,
}

/// The generic rank of the least model, and the unobservable unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanRank {
    /// A lower bound of the rank.
    pub at_least: usize,
    /// An upper bound of the rank.
    pub at_most: usize,
    /// The number of unknowns.
    pub of: usize,
    /// Those that are estimated and unobservable.
    pub unobservable: Vec<String>,
    /// Estimated unknowns of which each, were it measured too, would make all others observable.
    pub cures: Vec<String>,
}

/// A stretch of one value is reported from this fraction of all samples on.
const WORTH_TELLING: f64 = 0.2;

/// The right-hand side is evaluated this often for its time, three times over.
const EVALUATIONS: usize = 2000;

impl Experiment {
    /// What the scene requires; `import` is the path of the model's file as the least model's file names it, from the working folder. Times are measured where they are
    /// asked for. Where a tolerance is given, terms of a rate that together are at most this part of the median of its absolute values go as well, over the ranges of the measurements, the bounds of what is
    /// estimated, and else those of the model's file.
    ///
    /// # Errors
    /// As [`Experiment::task`].
    pub fn plan(
        &self,
        import: &str,
        times: bool,
        tolerance: Option<f64>,
        interrupt: &AtomicBool,
    ) -> Result<ScenePlan, SceneError> {
        let task = self.task(interrupt)?;
        let known = self.known_to_the_least_model();
        let smallest = self.model_with(known.clone());
        let smallest = smallest.as_ref().unwrap_or(&task.full);
        let least = self.least_model(smallest, &known, import, tolerance);
        let generic = least.as_ref().ok().and_then(|least| self.generic(least));
        let truth = self.signals.times().first().and_then(|time| self.truth_at(*time));
        let along_truth = truth.is_some();
        let start = truth.unwrap_or_else(|| task.guess.clone());
        let along = MotionRank::thorough(&task, &start).along(&task, &start);
        let whole = self.with_all_columns();
        let operations = [whole.as_ref().map_or(0, |model| model.operations()), smallest.operations()];
        let nanoseconds = match times {
            true => [whole.as_ref(), Some(smallest)]
                .map(|model| model.map_or(f64::NAN, |model| self.time_of(model, &start))),
            false => [f64::NAN; 2],
        };
        let names = self.names();
        let is_sought = |name: &String| names.contains(&name.as_str());
        let is_compared = |name: &String| task.full.outputs.contains(name);
        let columns: Vec<String> =
            smallest.columns.iter().map(|column| self.signals.names()[*column].clone()).collect();
        Ok(ScenePlan {
            states: self.system.state_names(),
            estimated: names.iter().map(|name| (*name).to_owned()).collect(),
            followed: smallest.states.iter().filter(|name| !is_sought(name)).cloned().collect(),
            compared: task.full.outputs.clone(),
            constants: self.constants(&known),
            driving: columns.into_iter().filter(|name| !is_compared(name)).collect(),
            steady_for_a_while: self.steady_for_a_while(&known),
            operations,
            nanoseconds,
            least,
            generic,
            along,
            along_truth,
        })
    }

    /// What observers know, and the measured states that never change.
    fn known_to_the_least_model(&self) -> BTreeMap<String, f64> {
        let mut known = self.question.known.clone();
        let which = ConstantColumns::MeasuredToo;
        known.extend(least::constants(&self.scene, &self.system, &known, &self.signals, which));
        known
    }

    fn constants(&self, known: &BTreeMap<String, f64>) -> Vec<PlanConstant> {
        let measured = |name: &String, value: f64| {
            let column = self.signals.find(name).map(|place| self.signals.column(place));
            column.is_some_and(|column| column.first() == Some(&value))
        };
        let constant = |(name, value): (&String, &f64)| PlanConstant {
            name: name.clone(),
            value: *value,
            is_measured: measured(name, *value),
        };
        known.iter().map(constant).collect()
    }

    /// The model with known values put in.
    fn model_with(&self, known: BTreeMap<String, f64>) -> Option<Arc<Model>> {
        let question = EstimateQuestion { known, ..self.question.clone() };
        let task = Task::new(&self.system, &question, &self.signals, &UNINTERRUPTED).ok()?;
        Some(task.full)
    }

    /// The model that takes every column as a signal, with the constants that the scene gives.
    fn with_all_columns(&self) -> Option<Arc<Model>> {
        let known = self.constants(&self.question.known).into_iter().filter(|own| !own.is_measured);
        self.model_with(known.map(|own| (own.name, own.value)).collect())
    }

    /// The time of a right-hand side at the first sample, in ns: the least of three series.
    fn time_of(&self, model: &Model, sought: &[f64]) -> f64 {
        let symbol_values: BTreeMap<&str, f64> =
            self.names().into_iter().zip(sought.iter().copied()).collect();
        let program = Program::plain(&model.system.graph, &model.rate_nodes);
        let value = |input: &Input| -> Option<f64> {
            let name = model.system.symbol_name(input.symbol()?);
            let column = || self.signals.find(name).map(|place| self.signals.column(place)[0]);
            symbol_values.get(name).copied().or_else(column)
        };
        let Some(inputs) = program.inputs().iter().map(value).collect::<Option<Vec<f64>>>() else {
            return f64::NAN;
        };
        let Ok(loaded) = program.load(Floats) else { return f64::NAN };
        let mut registers = Vec::new();
        let mut least = f64::INFINITY;
        for _ in 0..3 {
            let begin = Instant::now();
            for _ in 0..EVALUATIONS {
                if std::hint::black_box(loaded.run_in(std::hint::black_box(&inputs), &mut registers)).is_err()
                {
                    return f64::NAN;
                }
            }
            least = least.min(begin.elapsed().as_secs_f64() * 1e9 / EVALUATIONS as f64);
        }
        least
    }

    /// Columns that are constants of the model at the start or the end, for a good part of the samples and not for all: by the same rule as for all of them.
    fn steady_for_a_while(&self, known: &BTreeMap<String, f64>) -> Vec<SteadyStretch> {
        let times = self.signals.times();
        let mut found = Vec::new();
        for (place, name) in self.signals.names().iter().enumerate() {
            if self.system.find_symbol(name).is_none() || known.contains_key(name) {
                continue;
            }
            let column = self.signals.column(place);
            let (Some(first), Some(last)) = (column.first(), column.last()) else { continue };
            let ahead = column.iter().take_while(|value| *value == first).count();
            let behind = column.iter().rev().take_while(|value| *value == last).count();
            for rows in [0..ahead, column.len() - behind..column.len()] {
                let is_a_part = !rows.is_empty() && rows.len() < column.len();
                if !is_a_part || (rows.len() as f64) < WORTH_TELLING * column.len() as f64 {
                    continue;
                }
                let part = self.signals.clone().showing(rows.clone());
                let which = ConstantColumns::MeasuredToo;
                let constant = least::constants(&self.scene, &self.system, known, &part, which);
                if let Some(value) = constant.get(name) {
                    let (from, to) = (times[rows.start], times[rows.end - 1]);
                    found.push(SteadyStretch { name: name.clone(), from, to, value: *value });
                }
            }
        }
        found
    }

    /// The proof file of the observers' model, with constants put in and inputs in the drift.
    fn least_model(
        &self,
        model: &Model,
        known_values: &BTreeMap<String, f64>,
        import: &str,
        tolerance: Option<f64>,
    ) -> Result<LeastModel, String> {
        let question = &self.question;
        if let Some((name, _)) = question.guess.iter().find(|(name, _)| CalibrationKind::of(name).is_some()) {
            return Err(format!("'{name}' is of a sensor, and a proof file has no sensors"));
        }
        let system = &self.system;
        let driven: Vec<(String, String)> = question.inputs.clone();
        let undriven: Vec<String> = system
            .fields
            .iter()
            .filter(|field| field.role == Role::Input && !field.name.contains('\''))
            .map(|field| field.name.clone())
            .filter(|name| !driven.iter().any(|(field, _)| field == name))
            .collect();
        let (mut conditions, mut known, mut signals) = (Vec::new(), Vec::new(), Vec::new());
        for (name, value) in known_values {
            match *value == 0.0 {
                true => conditions.push(format!("{name} = 0")),
                // the shortest decimal of a number is what somebody wrote
                false => known.push((name.clone(), given_number(&format!("{value}")).ok())),
            }
        }
        for column in &model.columns {
            let name = &self.signals.names()[*column];
            let Some(symbol) = system.find_symbol(name) else { continue };
            let is_parameter = system.symbol_info(symbol).is_some_and(|info| info.kind == Kind::Parameter);
            if is_parameter && system.unknown_kind(symbol).is_none() {
                signals.push(name.clone());
            } else if system.states.contains(&symbol) && !system.known.contains(&symbol) {
                // a state that is given and moves
                known.push((name.clone(), None));
            }
        }
        known.retain(|(name, _)| !self.names().contains(&name.as_str()));
        let ranges = if tolerance.is_some() { self.ranges() } else { Vec::new() };
        let question = ReduceQuestion { conditions, known, undriven, driven, signals, tolerance, ranges };
        reduce(system, &question, import).map_err(|why| why.to_string())
    }

    /// Where the columns of the measurements and what is estimated within bounds lie.
    fn ranges(&self) -> Vec<(String, Range)> {
        let measured = self.signals.names().iter().enumerate().map(|(place, name)| {
            let values = self.signals.column(place).iter().copied().filter(|value| !value.is_nan());
            let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                [low.min(value), high.max(value)]
            });
            (name, [low, high])
        });
        let bounded = self.scene.observer.bounds.iter().map(|(name, range)| (name, *range));
        // the shortest decimal of a number is what somebody wrote
        let exact = |value: f64| given_number(&format!("{value}")).ok();
        let ranges = measured.chain(bounded).filter(|(_, [low, high])| low.is_finite() && high.is_finite());
        let range = |[low, high]: [f64; 2]| Some(Range { low: exact(low)?, high: exact(high)? });
        ranges.filter_map(|(name, ends)| Some((name.clone(), range(ends)?))).collect()
    }

    /// The generic rank of the least model, and which of the estimated states are unobservable.
    fn generic(&self, least: &LeastModel) -> Option<PlanRank> {
        let system = System::parse("the least model", &least.text, Path::new("")).ok()?;
        if !system.zero_outputs().is_empty() {
            // signals tied by outputs are not driven at will: the rank is that of a branch
            return None;
        }
        let answer = generic_answer(&system, &Assignment::new(), Ceiling::Rests);
        let names = self.names();
        let unobserved = |answer: &GenericAnswer, system: &System| -> Vec<String> {
            let all = answer.unknowns.iter().filter(|(_, seen)| *seen == Observability::No);
            all.map(|(symbol, _)| system.symbol_name(*symbol).to_owned()).collect()
        };
        let mut unobservable = unobserved(&answer, &system);
        // what no output depends on is not in the file
        let gone = least.left_out.iter().filter(|one| matches!(one.why, WhyLeftOut::NoOutputDependsOnIt));
        unobservable.extend(gone.map(|one| one.name.clone()));
        unobservable.retain(|name| names.contains(&name.as_str()));
        let mut cures = Vec::new();
        for name in &unobservable {
            let mut other = system.clone();
            let Some(symbol) = other.find_symbol(name).filter(|symbol| other.states.contains(symbol)) else {
                continue;
            };
            let node = other.graph.symbol(symbol);
            other.outputs.push((name.clone(), node));
            other.output_guards.push(Vec::new());
            let with = generic_answer(&other, &Assignment::new(), Ceiling::Rests);
            // each of them has to be shown to be observable: an undecided unknown makes it no cure
            let is_observable = |sought: &&str| {
                let mut all = with.unknowns.iter();
                sought == name
                    || all.any(|(symbol, seen)| {
                        other.symbol_name(*symbol) == *sought && *seen == Observability::Yes
                    })
            };
            if names.iter().all(is_observable) {
                cures.push(name.clone());
            }
        }
        Some(PlanRank {
            at_least: answer.at_least,
            at_most: answer.at_most,
            of: answer.dimension,
            unobservable,
            cures,
        })
    }
}
