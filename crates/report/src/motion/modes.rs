//! Systems side by side, window by window, as JSON and as text.

use super::answers::end_name;
use super::fit::finite;
use crate::layout::{counted, in_columns};
use palmistry_observe::{MotionRankFound, Objection, Update};
use palmistry_scenes::{Experiment, ModeEstimate, ModeWindow};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// The rank of an observer's system in a window.
fn rank_json(rank: &MotionRankFound, objection: Option<&Objection>) -> Value {
    json!({
        "samples": rank.asked,
        "rank": rank.rank,
        "of": rank.of,
        "derivatives": rank.order,
        "certified": rank.certified,
        "smallest_singular_value": finite(rank.smallest),
        "condition": finite(rank.condition),
        "at": rank.at,
        "singularity": rank.pole.as_ref().map(|pole| json!({ "divisor": pole.divisor, "at": pole.time })),
        "objection": objection.map(Objection::word),
        "why": objection.map(ToString::to_string),
    })
}

fn estimate_json(estimate: &ModeEstimate) -> Value {
    let mut value = update_json(estimate);
    if let Some(rank) = &estimate.rank {
        value["rank"] = rank_json(rank, estimate.objection.as_ref());
    }
    value
}

fn update_json(estimate: &ModeEstimate) -> Value {
    let Some(update) = &estimate.update else { return json!({ "name": estimate.name, "fits": false }) };
    let states: Map<String, Value> = (0..estimate.estimated.len())
        .map(|i| {
            let state =
                json!({ "recovered": finite(update.estimate[i]), "bound": finite(update.deviations[i]) });
            (estimate.estimated[i].clone(), state)
        })
        .collect();
    json!({
        "name": estimate.name,
        "fits": estimate.fits(),
        "status": end_name(&update.end),
        "residual": finite(update.rms_residual),
        "chi_square": update.fit.map(|fit| finite(fit.chi_square)),
        "degrees_of_freedom": update.fit.map(|fit| fit.degrees),
        "states": states,
    })
}

/// Modes as JSON: for each window what each made of it, and which was taken.
pub fn modes_json(experiment: &Experiment, windows: &[ModeWindow]) -> Value {
    let window = |window: &ModeWindow| {
        json!({
            "from": window.from,
            "to": window.to,
            "mode": window.chosen.map(|place| window.estimates[place].name.clone()),
            "true_modes": window.true_modes,
            "modes": window.estimates.iter().map(estimate_json).collect::<Vec<_>>(),
        })
    };
    json!({
        "scene": experiment.scene.title,
        "seed": experiment.scene.seed,
        "samples": experiment.signals.times().len(),
        "samples_after_windows": experiment.samples_after_windows(),
        "windows": windows.iter().map(window).collect::<Vec<_>>(),
    })
}

/// Modes as text.
pub fn modes_text(experiment: &Experiment, windows: &[ModeWindow]) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "{}", experiment.scene.title);
    let samples = counted(experiment.signals.times().len(), "sample");
    let _ = writeln!(text, "{samples}, {}", counted(windows.len(), "window"));
    for window in windows {
        let _ = write!(text, "  {:.3} s to {:.3} s: ", window.from, window.to);
        let Some(estimate) = window.chosen.map(|place| &window.estimates[place]) else {
            let least = window.estimates.iter().filter_map(|estimate| estimate.update.as_ref());
            let least = least.map(|update| update.rms_residual).fold(f64::INFINITY, f64::min);
            if window.estimates.iter().any(|estimate| estimate.rank.is_some()) {
                let _ = writeln!(text, "no observer answers");
                window.estimates.iter().for_each(|estimate| rank_line(&mut text, estimate));
                continue;
            }
            let _ = writeln!(
                text,
                "every mode fails its test, the least residual is {least:.1e}{}",
                truth(window)
            );
            continue;
        };
        let others = window.estimates.iter().filter(|other| other.fits() && other.name != estimate.name);
        let others: Vec<&str> = others.map(|other| other.name.as_str()).collect();
        let also = if others.is_empty() {
            String::new()
        } else {
            format!(" ({} pass with larger residuals)", others.join(", "))
        };
        let rms_residual = estimate.update.as_ref().map_or(f64::NAN, |update| update.rms_residual);
        let _ = writeln!(text, "{}{also}, residual {rms_residual:.1e}{}", estimate.name, truth(window));
        window.estimates.iter().for_each(|estimate| rank_line(&mut text, estimate));
        if let Some(update) = &estimate.update {
            state_lines(&mut text, experiment, &estimate.estimated, update);
        }
    }
    match experiment.samples_after_windows() {
        0 => {}
        left => {
            let (samples, are) = (counted(left, "sample"), if left == 1 { "is" } else { "are" });
            let _ = writeln!(text, "  the last {samples} {are} in no window, and nothing is said of them");
        }
    }
    if windows.iter().any(|window| window.chosen.is_none()) {
        text.push_str(
            "  try next (no mode passes): a mode for what happens there, more 'noise' of the sensors if they have it, or a shorter 'window' where modes change inside of one\n",
        );
    }
    in_columns(&text)
}

/// The rank of an observer's system, and what came of it.
fn rank_line(text: &mut String, estimate: &ModeEstimate) {
    let Some(rank) = &estimate.rank else { return };
    let is_certain = if rank.certified { ", certified" } else { "" };
    let word = format!(
        "rank {} of {} at {}{is_certain}, condition at most {:.1e}",
        rank.rank,
        rank.of,
        counted(rank.asked, "sample"),
        rank.condition
    );
    let came = match (&estimate.objection, &estimate.update) {
        (Some(why), None) => format!("not asked: {why}"),
        (Some(why), Some(_)) => format!("does not answer: what it found has {why}"),
        (None, Some(_)) if estimate.fits() => format!("answers: {word}"),
        (None, Some(update)) => format!("asked, and {}: {word}", end_name(&update.end)),
        (None, None) => word,
    };
    let _ = writeln!(text, "    {}: {came}", estimate.name);
}

fn truth(window: &ModeWindow) -> String {
    match window.true_modes.is_empty() {
        true => String::new(),
        false => format!("; true: {}", window.true_modes.join(", then ")),
    }
}

fn state_lines(text: &mut String, experiment: &Experiment, sought: &[String], update: &Update) {
    let row = experiment.signals.times().iter().position(|time| *time == update.from).unwrap_or(0);
    for ((name, value), bound) in sought.iter().zip(&update.estimate).zip(&update.deviations) {
        let truth = experiment.truth(name).and_then(|all| all.get(row).copied());
        let truth = truth.map_or_else(String::new, |truth| format!("  true {truth:>15.9}"));
        let _ = writeln!(text, "    {name:<10} {value:>15.9} ± {bound:.1e}{truth}");
    }
}
