//! What observers made of an experiment, as JSON and as text.

use crate::axis::unit_of;
use crate::layout::{counted, in_columns};
use crate::motion::closure::{closure_json, closure_text};
use crate::motion::fit::{finite, fit_in_words, noise_from, suspect_json, suspects_in_words};
use crate::motion::next::next_lines_of_track;
use crate::motion::recognition::{recognition_json, recognition_text};
use crate::motion::reconstruction::{shape_json, shape_text};
use crate::motion::studies::{studies_json, studies_text};
use crate::motion::verdicts::{innovations_json, together_json, verdict_lines};
use palmistry_io::foreign::shown;
use palmistry_observe::{EmptyCells, Fault, Interpolation, SampleEstimate, SparseColumn, Update, UpdateEnd};
use palmistry_scenes::{Answer, Experiment, Guess, Method, Studied, error};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Of an experiment that was not studied.
static NOT_STUDIED: Studied = Studied { noise: Vec::new(), basins: Vec::new(), curvature: None };

/// An experiment with all that was found: what the page and the JSON are made from.
#[derive(Clone, Copy, Debug)]
pub struct Observed<'a> {
    /// The scene with its measurements.
    pub experiment: &'a Experiment,
    /// What the observers made of it.
    pub answers: &'a [Answer],
    /// What its studies came to.
    pub studied: &'a Studied,
    /// Whether it was stopped before the end.
    pub interrupted: bool,
}

impl<'a> Observed<'a> {
    /// An experiment without studies.
    pub fn of(experiment: &'a Experiment, answers: &'a [Answer]) -> Self {
        Observed { experiment, answers, studied: &NOT_STUDIED, interrupted: false }
    }
}

pub(super) fn end_name(end: &UpdateEnd) -> String {
    match end {
        UpdateEnd::Converged => "converged".to_owned(),
        UpdateEnd::DoesNotFit => "converged, but does not fit".to_owned(),
        UpdateEnd::StepsSpent => "all steps spent".to_owned(),
        UpdateEnd::Stuck => "no step lowers the error".to_owned(),
        UpdateEnd::Unobservable { .. } => "not observable".to_owned(),
        UpdateEnd::Lost(lost) => format!("lost: {lost}"),
    }
}

/// The unit of the measurements' errors, with a space before it: metres of contacts, and of other systems that of all outputs where they
/// have one.
pub(super) fn noise_unit(observed: &Observed<'_>) -> String {
    let experiment = observed.experiment;
    if experiment.is_about_palms() {
        return " m".to_owned();
    }
    let mut units = experiment.system.outputs.iter().map(|(name, _)| unit_of(&experiment.system, name));
    let first = units.next().flatten();
    let same = first.filter(|first| units.all(|unit| unit.as_ref() == Some(first)));
    same.map_or_else(String::new, |unit| format!(" {unit}"))
}

/// The faults of a file, as lines.
pub fn fault_lines(faults: &[Fault]) -> Vec<String> {
    faults.iter().map(ToString::to_string).collect()
}

/// From when on times are counted: a date as it was written, or seconds of another age; none where they are taken as they are.
pub(super) fn origin(experiment: &Experiment) -> Option<Value> {
    let dated = experiment.began.as_ref().map(|began| json!(began));
    dated.or_else(|| (experiment.origin != 0.0).then(|| json!(experiment.origin)))
}

/// The same as a line; empty where there is nothing to say.
pub(super) fn origin_in_words(experiment: &Experiment) -> String {
    match (&experiment.began, experiment.origin) {
        (Some(began), _) => format!("times are counted from the first row, {}\n", shown(began)),
        (None, 0.0) => String::new(),
        (None, origin) => format!("times are counted from the first sample, at {origin} s\n"),
    }
}

/// In which columns of a file something was not measured, as lines.
pub(super) fn sparse_lines(experiment: &Experiment) -> Vec<String> {
    // a known delay shortens the signals, and not the record
    let rows = experiment.record.len() + experiment.outside.iter().sum::<usize>();
    let column = |own: &SparseColumn| {
        let what = match own.empty {
            EmptyCells::NotMeasured => "compared there".to_owned(),
            EmptyCells::Interpolated => {
                format!(
                    "interpolated between ({})",
                    interpolation_in_words(experiment.scene.data.interpolation)
                )
            }
        };
        format!("{} is measured in {} of {rows} rows, and {what}", shown(&own.column), own.measured)
    };
    let [first, last] = experiment.outside;
    let outside = (first + last > 0).then(|| {
        format!("the first {first} and the last {last} rows are left out: a column that drives the model is empty there")
    });
    experiment.sparse.iter().map(column).chain(outside).collect()
}

fn interpolation_in_words(interpolation: Interpolation) -> &'static str {
    match interpolation {
        Interpolation::Polynomial => "polynomials",
        Interpolation::Linear => "straight lines",
        Interpolation::Hold => "held values",
    }
}

/// States with what was recovered, what is true, the error and the Cramér-Rao bound, by name.
pub(super) fn states(observed: &Observed<'_>, time: f64, recovered: &[f64], bounds: Option<&[f64]>) -> Value {
    let truth = observed.experiment.truth_at(time);
    let mut states = Map::new();
    for (i, name) in observed.experiment.names().into_iter().enumerate() {
        let mut state = json!({ "recovered": finite(recovered[i]) });
        if let Some(truth) = &truth {
            state["true"] = json!(truth[i]);
            state["error"] = finite((recovered[i] - truth[i]).abs());
            state["relative_error"] = finite(error(recovered[i], truth[i]));
        }
        if let Some(bound) = bounds.and_then(|bounds| bounds.get(i)) {
            state["bound"] = finite(*bound);
        }
        states.insert(name.to_owned(), state);
    }
    Value::Object(states)
}

pub(super) fn update_json(observed: &Observed<'_>, update: &Update) -> Value {
    let mut found = json!({
        "from": update.from,
        "to": update.to,
        "status": end_name(&update.end),
        "iterations": update.steps,
        "troubled": update.troubled,
        "seconds": update.seconds,
        "condition": finite(update.condition),
        "cost": finite(update.cost),
        "residual": finite(update.rms_residual),
        "states": states(observed, update.from, &update.estimate, Some(&update.deviations)),
    });
    if let UpdateEnd::Unobservable { weakest } = &update.end {
        found["unobservable"] = json!(weakest);
        found["held"] = json!(true);
    }
    if let Some(fit) = &update.fit {
        found["fit"] = json!({
            "fits": fit.fits,
            "chi_square": finite(fit.chi_square),
            "degrees_of_freedom": fit.degrees,
            "probability": fit.is_tested().then_some(fit.probability),
            "noise": finite(fit.sigma),
            "noise_from": noise_from(fit.from),
        });
        if !fit.is_tested() {
            found["fit"]["tested"] = json!(false);
        }
        if let (Some(drift), Some(output)) = (fit.drift, &update.drifting) {
            found["fit"]["drift"] = json!({ "output": output, "probability": drift.probability });
        }
    }
    if update.is_heir {
        found["inherits"] = json!(true);
    }
    if update.discounted > 0 {
        found["discounted"] = json!(update.discounted);
        found["outliers"] = json!(update.fit.map_or(0, |fit| fit.outliers));
    }
    let names = observed.experiment.names();
    for (place, bound) in &update.at_bounds {
        found["states"][names[*place]]["at_bound"] = json!(bound);
    }
    if let Some(seam) = &update.seam {
        found["seam"] = json!({
            "chi_square": finite(seam.chi_square),
            "degrees_of_freedom": seam.degrees,
            "probability": seam.probability,
        });
    }
    if !update.suspects.is_empty() {
        found["suspects"] = update
            .suspects
            .iter()
            .map(|suspect| suspect_json(&observed.experiment.names(), suspect))
            .collect();
    }
    found
}

/// What is known of the sensors: the contacts' noise and resolution, and the columns that have their own.
fn sensor_json(experiment: &Experiment) -> Value {
    let sensor = &experiment.scene.sensor;
    let mut found = json!({ "noise": sensor.noise, "resolution": sensor.resolution });
    let columns: Map<String, Value> = experiment
        .scene
        .channels
        .iter()
        .map(|(name, own)| {
            let column = json!({
                "noise": own.noise,
                "resolution": own.resolution,
                "bias": own.bias,
                "gain": own.gain,
                "delay": own.delay,
            });
            (name.clone(), column)
        })
        .collect();
    if !columns.is_empty() {
        found["columns"] = Value::Object(columns);
    }
    found
}

/// An experiment as JSON: true and recovered states, errors, the Cramér-Rao bounds, iterations and time.
///
/// An `error` is `|recovered - true|` in the unit of its state, as a `bound` is, a standard deviation for the measurements' own errors or, where they have
/// none, for errors of 1e-9 (contacts: a nanometre); an unobservable state has none. A `relative_error` is absolute where the truth is less than a millionth.
pub fn observe_json(observed: &Observed<'_>) -> Value {
    let experiment = observed.experiment;
    let times = experiment.signals.times();
    let answers = observed.answers.iter().map(|answer| {
        let updates = answer.track.updates.iter().map(|update| update_json(observed, update));
        let told = |at: &SampleEstimate| {
            let bounds = Some(&at.deviations[..]);
            json!({ "time": at.time, "states": states(observed, at.time, &at.state, bounds) })
        };
        let end = answer.track.last().map(told);
        let mut found = json!({
            "method": answer.method.name(),
            "seconds": answer.seconds,
            "unobserved_samples": answer.track.unobserved,
            "remarks": answer.track.remarks,
            "together": together_json(answer.track.together()),
            "innovations": innovations_json(answer.track.innovations),
            "updates": updates.collect::<Vec<_>>(),
            "fits_as_well": answer.track.others.iter().map(|other| update_json(observed, other)).collect::<Vec<_>>(),
            "end": end,
        });
        if let Some(begin) = smoothed_begin(answer) {
            found["begin"] = told(begin);
        }
        found
    });
    let guess: Map<String, Value> =
        experiment.question.guess.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
    let mut found = json!({
        "scene": experiment.scene.title,
        "model": experiment.system.title,
        "seed": experiment.scene.seed,
        "samples": times.len(),
        "duration": times.last(),
        "sensor": sensor_json(experiment),
        "first_guess": if experiment.scene.observer.guess == Guess::None { Value::Null } else { json!(guess) },
        "initial_guess": guess,
        "clamped": experiment.question.clamped,
        "given": experiment.question.known,
        "faults": fault_lines(&experiment.faults),
        "observers": answers.collect::<Vec<_>>(),
        "interrupted": observed.interrupted,
    });
    let units = experiment.names().into_iter();
    let units: Map<String, Value> =
        units.filter_map(|name| Some((name.to_owned(), json!(state_unit(observed, name)?)))).collect();
    if !units.is_empty() {
        found["units"] = Value::Object(units);
    }
    if let Some(origin) = origin(experiment) {
        found["time_origin"] = origin;
    }
    if !experiment.sparse.is_empty() {
        let column = |own: &SparseColumn| {
            let is_filled = own.empty == EmptyCells::Interpolated;
            json!({ "column": own.column, "measured": own.measured, "interpolated": is_filled })
        };
        found["sparse"] = json!(experiment.sparse.iter().map(column).collect::<Vec<_>>());
        found["rows_left_out"] = json!({ "start": experiment.outside[0], "end": experiment.outside[1] });
    }
    if let Some(simulation) = &experiment.simulation {
        found["simulation"] = json!({
            "ended": simulation.ended().to_string(),
            "energy_drift": simulation.trajectory.energy_drift(),
            "draws": simulation.draws,
        });
    }
    if let Some(motion) = &experiment.motion {
        let ended = motion.ended().map_or_else(|| "completed".to_owned(), |lost| format!("ended {lost}"));
        found["simulation"] = json!({ "ended": ended });
    }
    if let Some(recognition) = &experiment.recognition {
        found["recognition"] = recognition_json(recognition);
    }
    if let Some(closure) = &experiment.closure {
        found["closure"] = closure_json(closure);
    }
    if let Some(shape) = shape_json(experiment, observed.answers) {
        found["shape"] = shape;
    }
    studies_json(observed.studied, &experiment.names(), &mut found);
    found
}

/// Where a smoother begins: with what was measured later.
fn smoothed_begin(answer: &Answer) -> Option<&SampleEstimate> {
    answer.track.estimates.first().filter(|_| answer.method == Method::Smoother)
}

/// An experiment as text.
pub fn observe_text(observed: &Observed<'_>) -> String {
    let experiment = observed.experiment;
    let names = experiment.names();
    let mut text = String::new();
    let samples = experiment.signals.times().len();
    let _ = writeln!(text, "{}", experiment.scene.title);
    if let Some(simulation) = &experiment.simulation {
        let _ = writeln!(
            text,
            "{}; {}; energy kept to {:.1e} J",
            counted(samples, "sample"),
            simulation.ended(),
            simulation.trajectory.energy_drift()
        );
    } else if let Some(motion) = &experiment.motion {
        let ended = motion.ended().map_or_else(|| "completed".to_owned(), |lost| format!("ended {lost}"));
        let _ = writeln!(text, "{}; {ended}", counted(samples, "sample"));
    } else {
        let samples = counted(samples, "sample");
        let _ = writeln!(text, "{samples} from a file; faults: {}", experiment.faults.len());
    }
    text.push_str(&origin_in_words(experiment));
    for line in fault_lines(&experiment.faults).into_iter().chain(sparse_lines(experiment)) {
        let _ = writeln!(text, "  {line}");
    }
    text.push_str(units_in_words(experiment));
    for answer in observed.answers {
        let is_timed = !answer.seconds.is_nan();
        let time = if is_timed { format!(": {:.3} s", answer.seconds) } else { String::new() };
        let _ = writeln!(text, "\n{}{time}", answer.method.name());
        for update in &answer.track.updates {
            let time = if is_timed { format!(", {:.1} ms", 1e3 * update.seconds) } else { String::new() };
            // that it does not fit has a sentence of its own, with the figures
            let standing = match &update.end {
                UpdateEnd::DoesNotFit => end_name(&UpdateEnd::Converged),
                end => end_name(end),
            };
            let (from, steps, fit) = (update.from, counted(update.steps, "step"), fit_in_words(update));
            let _ = writeln!(text, "  from {from:.3} s: {standing} after {steps}{fit}{time}");
            let known = Beside::of(update);
            state_lines(&mut text, observed, &names, update.from, &update.estimate, known);
            for line in suspects_in_words(update) {
                let _ = writeln!(text, "    {line}");
            }
        }
        let ends = [("start", smoothed_begin(answer)), ("end", answer.track.last())];
        for (place, at) in ends.into_iter().filter_map(|(place, at)| Some((place, at?))) {
            let _ = writeln!(text, "  at the {place}, {:.3} s:", at.time);
            let known = Beside { bounds: &at.deviations, at_bounds: &[], worth: "" };
            state_lines(&mut text, observed, &names, at.time, &at.state, known);
        }
        if answer.track.unobserved > 0 {
            let _ = writeln!(
                text,
                "  not observable for {} of {}",
                answer.track.unobserved,
                counted(samples, "sample")
            );
        }
        for other in &answer.track.others {
            let _ = writeln!(
                text,
                "  from {:.3} s another state fits as well{}:",
                other.from,
                fit_in_words(other)
            );
            state_lines(&mut text, observed, &names, other.from, &other.estimate, Beside::of(other));
        }
        for line in verdict_lines(&answer.track) {
            let _ = writeln!(text, "  {line}");
        }
        for remark in &answer.track.remarks {
            let _ = writeln!(text, "  {remark}");
        }
        for line in next_lines_of_track(&answer.track) {
            let _ = writeln!(text, "  {line}");
        }
    }
    if let Some(found) = &experiment.recognition {
        text.push_str(&recognition_text(found));
    }
    if let Some(closure) = &experiment.closure {
        text.push_str(&closure_text(closure));
    }
    studies_text(observed.studied, &names, &noise_unit(observed), &mut text);
    text.push_str(&shape_text(experiment, observed.answers));
    if observed.interrupted {
        text.push_str("\ninterrupted; this is what was done until then\n");
    }
    in_columns(&text)
}

/// The unit that a state's values are in; of palms, where all is in SI units, none is said.
fn state_unit(observed: &Observed<'_>, name: &str) -> Option<String> {
    let experiment = observed.experiment;
    if experiment.is_about_palms() { None } else { unit_of(&experiment.system, name) }
}

/// An estimated state, with its unit.
pub(super) fn state_name(observed: &Observed<'_>, name: &str) -> String {
    state_unit(observed, name).map_or_else(|| name.to_owned(), |unit| format!("{name}, {unit}"))
}

pub(super) fn state_lines(
    text: &mut String,
    observed: &Observed<'_>,
    names: &[&str],
    time: f64,
    recovered: &[f64],
    known: Beside<'_>,
) {
    let truth = observed.experiment.truth_at(time);
    let named: Vec<String> = names.iter().map(|name| state_name(observed, name)).collect();
    let width = named.iter().map(|name| name.chars().count()).fold(8, usize::max);
    for (i, name) in named.iter().enumerate() {
        let _ = write!(text, "    {name:<width$} {:>14.9}", recovered[i]);
        if let Some(bound) = known.bounds.get(i) {
            let _ = write!(text, "{} ± {bound:.1e}", known.worth);
        }
        if let Some(truth) = &truth {
            let _ = write!(text, "  true {:>14.9} error {:.1e}", truth[i], (recovered[i] - truth[i]).abs());
        }
        if let Some((_, bound)) = known.at_bounds.iter().find(|(place, _)| *place == i) {
            let _ = write!(text, "  at its bound {bound}");
        }
        text.push('\n');
    }
}

/// What is known beside recovered states: their standard deviations, which may be none, those that lie at a bound, and what is said before a deviation that is
/// not an estimate's.
#[derive(Clone, Copy)]
pub(super) struct Beside<'a> {
    pub bounds: &'a [f64],
    pub at_bounds: &'a [(usize, f64)],
    pub worth: &'static str,
}

impl<'a> Beside<'a> {
    pub fn of(update: &'a Update) -> Beside<'a> {
        Beside { bounds: &update.deviations, at_bounds: &update.at_bounds, worth: worth_in_words(update) }
    }
}

/// What is said before the deviations where there is no estimate: its error is not what measurements could reach at best.
pub(super) fn worth_in_words(update: &Update) -> &'static str {
    match () {
        () if update.is_held() => "  not estimated, at best",
        () if update.is_unfinished() => "  search not ended, at best",
        () => "",
    }
}

/// In what unit errors and bounds are printed.
fn units_in_words(experiment: &Experiment) -> &'static str {
    match experiment.simulated().is_some() {
        true => {
            "estimate ± one standard deviation (Cramér-Rao bound); error: |estimate - true|; both in the unit of the state\n"
        }
        false => "estimate ± one standard deviation (Cramér-Rao bound), in the unit of the state\n",
    }
}
