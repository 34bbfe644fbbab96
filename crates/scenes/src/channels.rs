//! The sensors of single columns: errors that simulated sensors make, what observers know of them, and the calibrations that they estimate.

use super::scene::{Channel, Scene, SceneError};
use super::simulation::{NOMINAL, TOUCH};
use crate::not_identifiable::not_identifiable;
use palmistry_lang::System;
use palmistry_observe::{
    CalibrationKind, EmptyCells, EstimateQuestion, Interpolation, MeasurementErrors, SignalError, Signals,
    SparseColumn, Task,
};
use std::collections::BTreeMap;

/// What is known of a column's sensor: it measures `gain * x(t - delay) + bias`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Known {
    pub gain: f64,
    pub bias: f64,
    pub delay: f64,
}

impl Default for Known {
    fn default() -> Self {
        Known { gain: 1.0, bias: 0.0, delay: 0.0 }
    }
}

/// Splits the known values into constants of the model and those of sensors, such as `tau1.gain`.
pub(super) fn split(known: &BTreeMap<String, f64>) -> (BTreeMap<String, f64>, BTreeMap<String, Known>) {
    let mut constants = BTreeMap::new();
    let mut sensors: BTreeMap<String, Known> = BTreeMap::new();
    for (name, value) in known {
        match name.split_once('.') {
            Some((column, "gain")) => sensors.entry(column.to_owned()).or_default().gain = *value,
            Some((column, "bias")) => sensors.entry(column.to_owned()).or_default().bias = *value,
            Some((column, "delay")) => sensors.entry(column.to_owned()).or_default().delay = *value,
            _ => {
                constants.insert(name.clone(), *value);
            }
        }
    }
    (constants, sensors)
}

/// What is known of sensors, by column.
pub(super) fn known_sensors(known: &BTreeMap<String, f64>) -> BTreeMap<String, Known> {
    split(known).1
}

/// Checks the columns that the scene's sensor settings and calibrations name.
pub(super) fn are_columns(scene: &Scene, signals: &Signals) -> Result<(), SceneError> {
    let columns = || signals.names().join(", ");
    if let Some(name) = scene.channels.keys().find(|name| signals.find(name).is_none()) {
        let help = format!("the columns are {}", columns());
        return Err(scene.error_at(
            &format!("sensor.{name}"),
            format!("there is no column '{name}'"),
            "this sensor",
            help,
        ));
    }
    for (name, known) in split(&scene.observer.known).1 {
        if signals.find(&name).is_none() {
            let help = format!("the columns are {}", columns());
            return Err(scene.error_at(
                "observer.known",
                format!("there is no column '{name}'"),
                "known here",
                help,
            ));
        }
        let is_sparse = signals.find(&name).is_some_and(|place| !signals.is_whole(place));
        if known.delay > 0.0 && is_sparse {
            let message = format!("'{name}' was not measured in each sample, and its delay cannot be undone");
            let help = format!("estimate '{name}.delay', or leave out the rows where the cell is empty");
            return Err(scene.error_at("observer.known", message, "known here", help));
        }
        if known.gain == 0.0 || known.delay < 0.0 {
            let what = if known.gain == 0.0 { "a gain of zero" } else { "a delay below zero" };
            let help = "a sensor reads gain * x(t - delay) + bias, with a gain that is not zero and a delay that is not negative";
            return Err(scene.error_at(
                "observer.known",
                format!("{what} of '{name}' cannot be undone"),
                "known here",
                help,
            ));
        }
    }
    for (index, name) in scene.observer.estimate.iter().enumerate() {
        // earlier values are integrated backwards, in steps that know no jumps
        let is_delay = CalibrationKind::of(name).is_some_and(|(_, kind)| kind == CalibrationKind::Delay);
        if is_delay && scene.data.interpolation == Interpolation::Hold {
            let message = format!("'{name}' cannot be estimated where columns are held between samples");
            let help = "take interpolation = \"linear\" or \"polynomial\", or leave the delay out";
            return Err(scene.error_at(
                &format!("observer.estimate[{index}]"),
                message,
                "estimated here",
                help,
            ));
        }
        if let Some((column, _)) =
            CalibrationKind::of(name).filter(|(column, _)| signals.find(column).is_none())
        {
            let place = format!("observer.estimate[{index}]");
            let help = format!("the columns are {}", columns());
            return Err(scene.error_at(
                &place,
                format!("there is no column '{column}'"),
                "estimated here",
                help,
            ));
        }
    }
    Ok(())
}

/// The measurements corrected by the known gains, biases and delays of the sensors. They end earlier by the largest delay.
pub(super) fn corrected(signals: Signals, known: &BTreeMap<String, f64>) -> Result<Signals, SignalError> {
    let sensors = split(known).1;
    if sensors.is_empty() {
        return Ok(signals);
    }
    let late = sensors.values().map(|known| known.delay).fold(0.0, f64::max);
    let end = signals.times().last().copied().unwrap_or(0.0) - late;
    let times: Vec<f64> = signals.times().iter().copied().filter(|time| *time <= end).collect();
    let column = |(place, name): (usize, &String)| {
        let Known { gain, bias, delay } = sensors.get(name).copied().unwrap_or_default();
        let read = |(row, time): (usize, &f64)| {
            let mut value = [signals.column(place)[row]];
            if delay > 0.0 {
                signals.at(&[place], time + delay, &mut value);
            }
            (value[0] - bias) / gain
        };
        (name.clone(), times.iter().enumerate().map(read).collect())
    };
    let columns = signals.names().iter().enumerate().map(column).collect();
    Ok(Signals::sparse(times.clone(), columns)?.interpolated(signals.interpolation()))
}

/// The errors of the measurements of a column, as the scene states them; none where it states none for the column itself.
fn stated(scene: &Scene, name: &str) -> Option<MeasurementErrors> {
    let touch = TOUCH.contains(&name).then_some(scene.sensor);
    let channel = scene.channels.get(name).copied();
    let common = touch.as_ref().map_or((0.0, 0.0), |sensor| (sensor.noise, sensor.resolution));
    let Channel { noise, resolution, .. } = channel.unwrap_or_default();
    (channel.is_some() || touch.is_some()).then(|| MeasurementErrors {
        normal: noise.unwrap_or(common.0),
        rounding: resolution.unwrap_or(common.1),
    })
}

/// Gives a task the known errors of single columns, in a scene that states one. Of those that are `sparse` errors are larger, where cells were filled.
///
/// # Errors
/// Where a recording's columns have errors, and none are stated for its outputs.
pub(super) fn tell(
    (scene, sparse): (&Scene, &[SparseColumn]),
    task: &mut Task<'_>,
    has_palms: bool,
    simulated: bool,
) -> Result<(), SceneError> {
    let sought = |name: &String| CalibrationKind::of(name).is_some();
    let is_one_sought = scene.observer.estimate.iter().any(sought);
    let is_nothing_read = (0..task.full.outputs.len()).all(|output| task.full.is_implicit(output));
    if is_nothing_read && !has_palms && (scene.sensor.noise > 0.0 || scene.sensor.resolution > 0.0) {
        let known: Vec<&str> = task.full.read_columns(task.signals);
        let help = format!(
            "[sensor.COLUMN] states those of one column; the outputs here depend on {}",
            known.join(", ")
        );
        let message = "the errors of outputs are stated, and no output is read: all of them are zero";
        return Err(scene.error_at("sensor", message.to_owned(), "stated here", help));
    }
    if is_nothing_read {
        (task.exact, task.sigma, task.noise) = (true, NOMINAL, palmistry_observe::Noise::Unstated);
    }
    if scene.channels.is_empty() && !is_one_sought && !task.full.has_implicit() {
        return Ok(());
    }
    let sensors = split(&scene.observer.known).1;
    let all = task.full.outputs.iter().enumerate();
    let outputs: Vec<String> =
        all.filter(|(place, _)| !task.full.is_implicit(*place)).map(|(_, name)| name.clone()).collect();
    for name in task.signals.names() {
        // an output has the errors of `[sensor]` unless it has its own; for a body between palms these are the errors of the contacts
        let common = MeasurementErrors { normal: scene.sensor.noise, rounding: scene.sensor.resolution };
        let unsaid = if !has_palms && outputs.contains(name) { common } else { MeasurementErrors::default() };
        let gain = sensors.get(name).map_or(1.0, |known| known.gain.abs());
        let MeasurementErrors { normal, rounding } = stated(scene, name).unwrap_or(unsaid);
        // errors of filled cells are correlated: a measured value errs for all rows that it stands for, as so many independent errors of their root's size do
        let filled = sparse.iter().find(|own| own.column == *name && own.empty == EmptyCells::Interpolated);
        let together = filled.map_or(1.0, |own| own.stands_for.sqrt()) / gain;
        let errors = MeasurementErrors { normal: normal * together, rounding: rounding * together };
        if !errors.are_none() {
            task.errors.insert(name.clone(), errors);
        }
    }
    let drives = |name: &String| task.errors.contains_key(name) && !outputs.contains(name);
    let driving = task.signals.names().iter().find(|name| drives(name));
    let silent = outputs.iter().find(|name| !task.errors.contains_key(*name));
    if let (false, Some(driving), Some(silent)) = (simulated, driving, silent) {
        let message =
            format!("the errors of '{driving}' are stated, and those of the output '{silent}' are not");
        let help = format!("add [sensor.{silent}] with its noise: residuals are measured by both");
        return Err(scene.error_at(&format!("sensor.{driving}"), message, "this sensor", help));
    }
    let of_outputs = || outputs.iter().map(|name| task.errors.get(name).copied().unwrap_or_default());
    let mut largest = of_outputs().map(MeasurementErrors::variance).fold(0.0, f64::max).sqrt();
    if is_nothing_read {
        // a unit for what is weighted anyway
        largest = task.errors.values().map(|errors| errors.variance()).fold(0.0, f64::max).sqrt();
    }
    let errs = driving.is_some() || largest > 0.0;
    // the first measurements of an output whose gain or bias is estimated are not its first values
    let is_output =
        |name: &String| CalibrationKind::of(name).is_some_and(|(c, _)| outputs.iter().any(|o| o == c));
    let reads_otherwise = scene.observer.estimate.iter().any(is_output);
    if errs {
        task.exact = false;
        task.sigma = if largest > 0.0 { largest } else { NOMINAL };
        let alike = of_outputs().next().filter(|first| of_outputs().all(|other| other == *first));
        let common = alike.filter(|errors| !errors.are_none());
        let common = common.unwrap_or(MeasurementErrors { normal: task.sigma, rounding: 0.0 });
        task.noise = palmistry_observe::Noise::Stated { normal: common.normal, rounding: common.rounding };
        for name in &outputs {
            // a measurement without stated error is taken to be good to a nanometre, or its like
            task.errors.entry(name.clone()).or_insert(MeasurementErrors { normal: NOMINAL, rounding: 0.0 });
        }
    } else if reads_otherwise {
        task.exact = false;
    }
    Ok(())
}

/// Checks that the measurements can determine the gains, biases and delays that are estimated.
///
/// # Errors
/// Which one is not identifiable, and from which others it cannot be distinguished.
pub(super) fn are_determined(
    scene: &Scene,
    system: &System,
    question: &EstimateQuestion,
    signals: &Signals,
) -> Result<(), SceneError> {
    let unobserved = not_identifiable(system, question, signals);
    let Some(first) = unobserved.iter().find(|name| CalibrationKind::of(name).is_some()) else {
        return Ok(());
    };
    let others: Vec<&str> = unobserved.iter().filter(|name| *name != first).map(String::as_str).collect();
    let message = match others.is_empty() {
        true => format!("no measurements determine '{first}': the rank does not count it"),
        false => format!(
            "no measurements distinguish '{first}' from {}: the rank is short of them",
            others.join(", ")
        ),
    };
    let place = scene.observer.estimate.iter().position(|name| name == first).unwrap_or(0);
    let help = "leave it out of 'estimate', or give one of the others under `known`";
    Err(scene.error_at(&format!("observer.estimate[{place}]"), message, "estimated here", help))
}

/// The true value of an estimated gain, bias or delay of a simulated sensor; none of any other name.
pub(super) fn truth(scene: &Scene, name: &str) -> Option<f64> {
    let (column, kind) = CalibrationKind::of(name)?;
    let channel = scene.channels.get(column).copied().unwrap_or_default();
    Some(match kind {
        CalibrationKind::Gain => channel.gain,
        CalibrationKind::Bias => channel.bias,
        CalibrationKind::Delay => channel.delay,
    })
}

/// Whether a name asks for gain, bias or delay of something that the model knows.
pub(super) fn is_calibration(system: &System, name: &str) -> bool {
    CalibrationKind::of(name).is_some_and(|(column, _)| system.find_symbol(column).is_some())
}
