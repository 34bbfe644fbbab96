//! Observers with the estimates of earlier windows, window after window.

use super::arriving::{Arriving, Buffer, INTERRUPTED, MARGIN};
use super::events::{StreamAnswer, StreamTally, WindowReport};
use crate::channels::known_sensors;
use crate::run::Experiment;
use crate::scene::{Method, SceneError};
use palmistry_observe::{FALSE_ALARMS, Learned, Signals, Task, Tested, Update, UpdateEnd};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// The state that is kept from window to window.
pub struct SoFar {
    pub windows: u64,
    pub learned: Vec<Option<Arc<Learned>>>,
    pub tallies: Vec<StreamTally>,
    /// The origin from which times are counted.
    pub origin: f64,
    /// A remark for the report on the next window.
    remark: Option<String>,
}

impl SoFar {
    pub fn of(experiment: &Experiment) -> SoFar {
        let methods = &experiment.scene.observer.methods;
        let tally = |method: &Method| StreamTally {
            method: *method,
            updates: 0,
            fit: 0,
            untested: 0,
            contradicted: 0,
            spent: 0,
            tested: Tested::default(),
            innovations: None,
            believed: [0; 2],
        };
        SoFar {
            windows: 0,
            learned: vec![None; methods.len()],
            tallies: methods.iter().map(tally).collect(),
            origin: experiment.origin,
            remark: None,
        }
    }

    /// The model changes from here on.
    pub fn forget_all_but_belief(&mut self, column: &str) {
        for learned in self.learned.iter_mut().flatten() {
            *learned = Arc::new(Learned::belief_alone(learned.belief.clone()));
        }
        self.remark = Some(format!(
            "'{column}' changes, and was taken for a constant: what was learned with it is forgotten but for the state"
        ));
    }
}

/// Observers with the estimates of earlier windows.
pub struct Observing<'a> {
    experiment: &'a Experiment,
    task: &'a Task<'a>,
    names: Vec<String>,
    /// The bias and the gain by which each column is corrected, where they are known of its sensor.
    sensors: Vec<(f64, f64)>,
    /// Columns that are taken for constants.
    steady: Vec<(usize, f64)>,
    so_far: SoFar,
    /// Whether the rows beside a window contribute to its curves.
    has_margins: bool,
}

impl<'a> Observing<'a> {
    pub fn of(
        experiment: &'a Experiment,
        task: &'a Task<'a>,
        told: &BTreeMap<String, f64>,
        names: Vec<String>,
        so_far: SoFar,
    ) -> Observing<'a> {
        let known = known_sensors(&experiment.scene.observer.known);
        let sensor = |name: &String| known.get(name).map_or((0.0, 1.0), |known| (known.bias, known.gain));
        let steady = |(place, name): (usize, &String)| {
            let value = experiment.question.known.get(name).filter(|_| !told.contains_key(name))?;
            Some((place, *value))
        };
        Observing {
            experiment,
            task,
            sensors: names.iter().map(sensor).collect(),
            steady: names.iter().enumerate().filter_map(steady).collect(),
            names,
            so_far,
            // errors of columns are weighted for all of their samples: those beside a window do not belong to it
            has_margins: task.errors.is_empty(),
        }
    }

    /// Window after window, to the end or to one in which a column changes that was taken for a constant.
    pub fn run(
        mut self,
        arriving: &mut Arriving<'_>,
        window: usize,
        tell: &mut dyn FnMut(&WindowReport<'_>) -> bool,
    ) -> Result<(SoFar, Option<String>), SceneError> {
        loop {
            let count = window.min(arriving.buffer.waiting());
            if count < 2 {
                return Ok((self.so_far, None));
            }
            if let Some(changed) = self.changed(&arriving.buffer, count) {
                return Ok((self.so_far, Some(changed)));
            }
            let answers = self.answer(&arriving.buffer, count)?;
            let report = WindowReport {
                experiment: self.experiment,
                window: self.so_far.windows,
                samples: count,
                rows: arriving.rows.arrived(),
                faults: std::mem::take(&mut arriving.faults),
                answers,
            };
            let is_heard = tell(&report);
            arriving.buffer.first += count - 1;
            let unobserved = self.so_far.learned.iter().flatten().map(|learned| learned.rows_unobserved());
            arriving.buffer.again = unobserved.max().unwrap_or(0);
            arriving.buffer.drop_before();
            if !is_heard {
                arriving.end.cut_off = Some("nobody reads the answers any more".to_owned());
                return Ok((self.so_far, None));
            }
            if arriving.interrupt.load(Ordering::Relaxed) {
                arriving.end.cut_off.get_or_insert_with(|| INTERRUPTED.to_owned());
                return Ok((self.so_far, None));
            }
            arriving.fill(&self.experiment.scene, window)?;
        }
    }

    /// A column that was taken for a constant and changes in the next rows.
    fn changed(&self, buffer: &Buffer, count: usize) -> Option<String> {
        let rows = buffer.first..buffer.first + count;
        let changes = |(place, value): &&(usize, f64)| {
            let (bias, gain) = self.sensors[*place];
            buffer.columns[*place][rows.clone()].iter().any(|read| (read - bias) / gain != *value)
        };
        let (place, _) = self.steady.iter().find(changes)?;
        Some(self.names[*place].clone())
    }

    /// The signals of the next rows, and of so many before them.
    fn signals(&self, buffer: &Buffer, again: usize, count: usize) -> Result<Signals, SceneError> {
        let margin = if self.has_margins { MARGIN } else { 0 };
        let shown = buffer.first - again;
        let from = shown.saturating_sub(margin);
        let to = (buffer.first + count + margin).min(buffer.times.len());
        let times = buffer.times[from..to].iter().map(|time| time - self.so_far.origin).collect();
        let column = |(place, name): (usize, &String)| {
            let (bias, gain) = self.sensors[place];
            let values = buffer.columns[place][from..to].iter().map(|value| (value - bias) / gain).collect();
            (name.clone(), values)
        };
        let columns = self.names.iter().enumerate().map(column).collect();
        let signals = Signals::sparse(times, columns).map_err(|error| {
            self.experiment.scene.error_at("data", error.to_string(), "these measurements", "")
        })?;
        let first = shown - from;
        let interpolation = self.experiment.scene.data.interpolation;
        Ok(signals.interpolated(interpolation).showing(first..first + again + count))
    }

    fn answer(&mut self, buffer: &Buffer, count: usize) -> Result<Vec<StreamAnswer>, SceneError> {
        let rows_unobserved =
            |learned: &Option<Arc<Learned>>| learned.as_ref().map_or(0, |learned| learned.rows_unobserved());
        let again: Vec<usize> = self.so_far.learned.iter().map(rows_unobserved).collect();
        let mut signals: BTreeMap<usize, Signals> = BTreeMap::new();
        for again in &again {
            if !signals.contains_key(again) {
                signals.insert(*again, self.signals(buffer, *again, count)?);
            }
        }
        let so_far = &mut self.so_far;
        so_far.windows += 1;
        let alarm = FALSE_ALARMS * 6.0 / (PI * so_far.windows as f64).powi(2);
        let remark = so_far.remark.take();
        let mut answers = Vec::new();
        for ((learned, tally), again) in so_far.learned.iter_mut().zip(&mut so_far.tallies).zip(&again) {
            let mut task = self.task.with_signals(&signals[again]);
            task.alarm = Some(alarm);
            task.learned = learned.take();
            let track = self.experiment.observer(tally.method).observe(&task);
            tally.updates += track.updates.len();
            let count = |of: fn(&Update) -> bool| track.updates.iter().filter(|update| of(update)).count();
            tally.fit += count(|update| update.is_borne_out() && !update.is_untested());
            tally.untested += count(Update::is_untested);
            track.updates.iter().for_each(|update| update.count_in(&mut tally.tested));
            tally.contradicted += count(Update::is_contradicted);
            tally.spent += count(|update| update.end == UpdateEnd::StepsSpent);
            if let Some(own) = track.innovations {
                tally.innovations = Some(tally.innovations.map_or(own, |before| before.with(own)));
            }
            tally.believed[0] += track.estimates.len();
            tally.believed[1] += track.unobserved;
            answers.push(StreamAnswer {
                method: tally.method,
                deviations: track.learned.as_ref().and_then(|learned| learned.deviations.clone()),
                end: track.estimates.last().cloned(),
                updates: track.updates,
                others: track.others,
                remarks: remark.iter().cloned().chain(track.remarks).collect(),
                unobserved: track.unobserved,
            });
            *learned = track.learned.or(task.learned);
        }
        Ok(answers)
    }
}
