//! What three palms determine of a body in space: text and JSON.

use crate::layout::{counted, in_columns};
use palmistry_bodies::mechanics::spatial::SpatialEnded;
use palmistry_bodies::shape::sphere::{BoundedRegion, OuterBound, TouchError};
use palmistry_scenes::solid::SolidState;
use palmistry_scenes::space::{SpaceAnswers, SpaceExperiment, SpaceShape, SpaceUpdate, SpaceVerdict};
use serde_json::{Value, json};
use std::fmt::Write;

/// A scene in space and what came of it.
pub struct SpaceObserved<'a> {
    /// The scene with its measurements.
    pub experiment: &'a SpaceExperiment,
    /// What was found.
    pub answers: &'a SpaceAnswers,
    /// Whether it was interrupted.
    pub interrupted: bool,
}

impl<'a> SpaceObserved<'a> {
    /// A run that was not interrupted.
    pub fn of(experiment: &'a SpaceExperiment, answers: &'a SpaceAnswers) -> SpaceObserved<'a> {
        SpaceObserved { experiment, answers, interrupted: false }
    }
}

/// The unknowns, with their units.
const NAMES: [(&str, &str); 16] = [
    ("c_x", "m"),
    ("c_y", "m"),
    ("c_z", "m"),
    ("c'_x", "m/s"),
    ("c'_y", "m/s"),
    ("c'_z", "m/s"),
    ("omega_x", "rad/s"),
    ("omega_y", "rad/s"),
    ("omega_z", "rad/s"),
    ("J_xx/m", "m^2"),
    ("J_yy/m", "m^2"),
    ("J_zz/m", "m^2"),
    ("J_xy/m", "m^2"),
    ("J_xz/m", "m^2"),
    ("J_yz/m", "m^2"),
    ("m", "kg"),
];

/// One unknown.
pub(super) struct Entry {
    pub name: &'static str,
    pub unit: &'static str,
    pub recovered: f64,
    pub truth: Option<f64>,
    pub bound: f64,
}

/// All of a window; nothing where nothing was found.
pub(super) fn entries(observed: &SpaceObserved<'_>, update: &SpaceUpdate) -> Vec<Entry> {
    let Some(state) = &update.state else { return Vec::new() };
    let (found, deviations) = (state.entries(), state.deviations());
    let truth = observed.experiment.true_entries(update);
    let one = |(i, (name, unit)): (usize, &(&'static str, &'static str))| {
        // the mass, and not its inverse
        let is_mass = i + 1 == NAMES.len();
        let told = |value: f64| if is_mass { 1.0 / value } else { value };
        let recovered = told(found[i]);
        let bound = if is_mass { recovered * recovered * deviations[i] } else { deviations[i] };
        Entry { name, unit, recovered, truth: truth.map(|truth| told(truth[i])), bound }
    };
    NAMES.iter().enumerate().map(one).collect()
}

/// The bounds of the shape that there are: what each is, its volume or why there is none.
pub(super) fn bounds(shape: &SpaceShape) -> Vec<(String, Result<f64, String>)> {
    let region = |region: &Result<BoundedRegion, TouchError>, volume: fn(&BoundedRegion) -> f64| match region
    {
        Ok(region) => Ok(volume(region)),
        Err(error) => Err(error.to_string()),
    };
    let [low, high]: [fn(&BoundedRegion) -> f64; 2] = [|at| at.volume.low(), |at| at.volume.high()];
    let mut all = vec![("hull of the contacts, from inside".to_owned(), region(&shape.hull, low))];
    if let Some(rounded) = &shape.rounded {
        all.push(("the same with the least radius of curvature".to_owned(), region(rounded, low)));
    }
    let outer = match &shape.outer {
        Ok(OuterBound::Bounded(region)) => Ok(high(region)),
        Ok(OuterBound::Unbounded { direction: d }) => {
            Err(format!("unbounded along ({:.4}, {:.4}, {:.4})", d.x, d.y, d.z))
        }
        Err(error) => Err(error.to_string()),
    };
    all.push(("half-spaces, from outside".to_owned(), outer));
    if let Some(balls) = &shape.balls {
        all.push(("balls of the greatest radius of curvature".to_owned(), region(balls, high)));
    }
    if let Some(hollow) = &shape.hollow {
        all.push(("balls of the hollow palms, from outside".to_owned(), region(hollow, high)));
    }
    all
}

/// What the shape is, in rows of two.
pub(super) fn shape_rows(observed: &SpaceObserved<'_>) -> Vec<(String, String)> {
    let Some(shape) = &observed.answers.shape else { return Vec::new() };
    let mut rows = vec![("contacts in one frame".to_owned(), shape.touches.len().to_string())];
    if let Some(found) = &shape.estimate {
        let (support, chi, degrees) = (&found.support, found.chi_square, found.degrees);
        let told = format!(
            "harmonics up to degree {}, mean radius {:.6} m, chi-square {chi:.1} of {degrees}",
            support.degree, support.coefficients[0]
        );
        rows.push(("support function".to_owned(), told));
    }
    if let Some([touched, everywhere]) = shape_errors(observed) {
        rows.push(("its greatest error where touched".to_owned(), format!("{touched:.1e} m")));
        rows.push(("over all normals".to_owned(), format!("{everywhere:.1e} m")));
    }
    for (what, volume) in bounds(shape) {
        rows.push((what, volume.map_or_else(|why| why, |volume| format!("{volume:.4} m^3"))));
    }
    if let Some(truth) = &observed.experiment.truth {
        rows.push(("volume of the body".to_owned(), format!("{:.4} m^3", truth.scene.solid.volume())));
    }
    rows
}

fn shape_errors(observed: &SpaceObserved<'_>) -> Option<[f64; 2]> {
    let experiment = observed.experiment;
    experiment.truth.as_ref()?;
    let truth = |normal: &_| experiment.true_support(normal).map_or(f64::NAN, |(extent, _)| extent);
    observed.answers.shape.as_ref()?.errors(&truth)
}

/// The greatest errors of a window's poses: of the centre in m, of the turn in rad, of a support radius in m.
pub(super) fn greatest(observed: &SpaceObserved<'_>, update: &SpaceUpdate) -> Option<[f64; 3]> {
    let errors = observed.experiment.errors(update);
    let most = |of: fn(&palmistry_scenes::space::PoseError) -> f64| errors.iter().map(of).fold(0.0, f64::max);
    (!errors.is_empty()).then(|| [most(|e| e.centre), most(|e| e.turn), most(|e| e.radius)])
}

/// How the motion ended, where it did before its last sample.
pub fn space_ended(observed: &SpaceObserved<'_>) -> Option<String> {
    let told = match &observed.experiment.truth.as_ref()?.trajectory.ended {
        SpatialEnded::Completed => return None,
        SpatialEnded::ContactLost { palm, time } => format!("palm {palm} would have to pull at {time:.4} s"),
        SpatialEnded::Flat { time } => format!("the palms' normals lie in one plane at {time:.4} s"),
        SpatialEnded::NoContact { time } => {
            format!("the body leaves the halves of the palms' spheres that face it at {time:.4} s")
        }
        SpatialEnded::Failed { time, why } => format!("the integrator gave up at {time:.4} s: {why}"),
    };
    Some(format!("the motion ended early: {told}"))
}

/// Why a state that explains the measurements is not determined by them.
fn doubt(update: &SpaceUpdate) -> Option<String> {
    let state = update.state.as_ref()?;
    match (update.verdict, state.rival) {
        (SpaceVerdict::Unobservable, _) if !state.is_minimum => {
            Some("no least chi-square, other states explain the measurements better and better".to_owned())
        }
        (SpaceVerdict::Unobservable, _) if state.is_noise() => {
            Some(format!("{:.2} of what they seem to determine is left without their noise", state.curved))
        }
        (SpaceVerdict::Unobservable, _) if state.is_bent() => {
            Some("chi-square is no parabola as far as the bounds reach, these say nothing".to_owned())
        }
        (SpaceVerdict::Unobservable, _) => Some("a bound is as large as what is estimated".to_owned()),
        (SpaceVerdict::Ambiguous, Some(rival)) => Some(format!(
            "another state {:.0} deviations away leaves chi-square {:.1}",
            rival.apart, rival.chi_square
        )),
        _ => None,
    }
}

/// The verdict on a window.
fn verdict_in_words(update: &SpaceUpdate) -> &'static str {
    let is_stated = update.state.as_ref().is_some_and(|state| state.is_stated);
    match (update.verdict, is_stated) {
        (SpaceVerdict::Fits, true) => "converged, passes the chi-square test",
        (SpaceVerdict::Fits, false) => "converged, passes the whiteness test",
        (SpaceVerdict::DoesNotFit, true) => "converged, fails the chi-square test",
        (SpaceVerdict::DoesNotFit, false) => "converged, fails the whiteness test",
        (verdict, _) => verdict.name(),
    }
}

/// What to try after a window without a plain success.
fn next_in_words(verdict: SpaceVerdict) -> Option<&'static str> {
    match verdict {
        SpaceVerdict::Fits => None,
        SpaceVerdict::DoesNotFit => Some(
            "more 'noise' of the sensors if they have it, a shorter 'window', or palms that are described as they are",
        ),
        SpaceVerdict::Unobservable => {
            Some("a longer 'window', a motion that turns the body more, or contacts with less noise")
        }
        SpaceVerdict::Ambiguous => {
            Some("a longer 'window' or contacts with less noise, so that one of the states is excluded")
        }
        SpaceVerdict::Lost => Some("a shorter 'window', or contacts with less noise"),
    }
}

/// From when to when a window goes, and what is to be said of it.
pub(super) fn headline(observed: &SpaceObserved<'_>, update: &SpaceUpdate) -> String {
    let times = &observed.experiment.measurements.times;
    let mut out = format!(
        "{:.4} to {:.4} s, {}: {}",
        times[update.rows.start],
        times[update.rows.end - 1],
        counted(update.rows.len(), "sample"),
        verdict_in_words(update)
    );
    if let Some(SolidState { chi_square, degrees, rms_residual, is_stated, .. }) = &update.state {
        let left = match is_stated {
            true => format!("; chi-square {chi_square:.1} of {degrees}"),
            false => format!("; {rms_residual:.1e} m residual of a contact, no noise is stated"),
        };
        out += &left;
    }
    if let Some(why) = doubt(update) {
        let _ = write!(out, "; {why}");
    }
    if update.seconds.is_finite() {
        let _ = write!(out, "; {:.1} s", update.seconds);
    }
    out
}

/// What was found, as text.
pub fn space_text(observed: &SpaceObserved<'_>) -> String {
    let (experiment, answers) = (observed.experiment, observed.answers);
    let times = &experiment.measurements.times;
    let covered = times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first);
    let mut out = format!(
        "{}\n{} over {covered:.4} s, nothing known\n",
        experiment.scene.title,
        counted(times.len(), "sample")
    );
    for update in &answers.updates {
        let _ = writeln!(out, "\n{}", headline(observed, update));
        for (place, entry) in entries(observed, update).iter().enumerate() {
            if place == 0 {
                let _ = writeln!(
                    out,
                    "  {:16}{:>14}{:>14}{:>10}{:>10}",
                    "", "recovered", "true", "error", "bound"
                );
            }
            let name = format!("{}, {}", entry.name, entry.unit);
            let _ = write!(out, "  {name:16}{:>14.8}", entry.recovered);
            let _ = match entry.truth {
                Some(truth) => write!(out, "{truth:>14.8}{:>10.1e}", (entry.recovered - truth).abs()),
                None => write!(out, "{:>14}{:>10}", "-", "-"),
            };
            let _ = writeln!(out, "{:>10.1e}", entry.bound);
        }
        if let Some([centre, turn, radius]) = greatest(observed, update) {
            let _ = writeln!(
                out,
                "  over the window, greatest errors: centre {centre:.1e} m, turn {turn:.1e} rad, a support radius at a contact {radius:.1e} m"
            );
        }
    }
    let mut told: Vec<&str> = Vec::new();
    for next in answers.updates.iter().filter_map(|update| next_in_words(update.verdict)) {
        if !told.contains(&next) {
            told.push(next);
            let _ = writeln!(out, "try next: {next}");
        }
    }
    out.push('\n');
    for (what, value) in shape_rows(observed) {
        let _ = writeln!(out, "{what}: {value}");
    }
    if answers.shape.is_none() {
        out.push_str("no shape: the first window fails its test\n");
    }
    if observed.interrupted {
        out.push_str("interrupted: this is what was done until then\n");
    }
    in_columns(&out)
}

fn number(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

fn update_json(observed: &SpaceObserved<'_>, update: &SpaceUpdate) -> Value {
    let times = &observed.experiment.measurements.times;
    let states: serde_json::Map<String, Value> = entries(observed, update)
        .into_iter()
        .map(|entry| {
            let error = entry.truth.map(|truth| (entry.recovered - truth).abs());
            let told = json!({
                "unit": entry.unit, "recovered": entry.recovered, "true": entry.truth, "error": error,
                "bound": number(entry.bound),
            });
            (entry.name.to_owned(), told)
        })
        .collect();
    let poses = update.poses.iter().map(|pose| {
        let turn: Vec<Vec<f64>> = (0..3).map(|i| (0..3).map(|j| pose.turn[(i, j)]).collect()).collect();
        json!({ "time": pose.time, "centre": [pose.centre.x, pose.centre.y, pose.centre.z], "turn": turn })
    });
    let fit = update.state.as_ref().map(|state| {
        json!({
            "fits": state.fits(), "chi_square": state.chi_square, "degrees_of_freedom": state.degrees,
            "residual": state.rms_residual, "neumann": number(state.ratio), "noise_from": if state.is_stated { "stated" } else { "residual" },
            "minimum": state.is_minimum, "left_without_noise": number(state.curved), "bent": number(state.bent),
            "rival": state.rival.map(|rival| json!({ "apart": number(rival.apart), "chi_square": rival.chi_square })),
        })
    });
    json!({
        "from": times[update.rows.start],
        "to": times[update.rows.end - 1],
        "samples": update.rows.len(),
        "verdict": update.verdict.name(),
        "why": doubt(update),
        "states": states,
        "fit": fit,
        "poses": poses.collect::<Vec<_>>(),
        "error": greatest(observed, update).map(|[centre, turn, radius]| json!({ "centre": centre, "turn": turn, "radius": radius })),
        "seconds": number(update.seconds),
    })
}

/// What was found, as JSON.
pub fn space_json(observed: &SpaceObserved<'_>) -> Value {
    let (experiment, answers) = (observed.experiment, observed.answers);
    let shape = answers.shape.as_ref().map(|shape| {
        let bounds = bounds(shape).into_iter().map(|(what, volume)| match volume {
            Ok(volume) => json!({ "what": what, "volume": number(volume), "why": null }),
            Err(why) => json!({ "what": what, "volume": null, "why": why }),
        });
        let estimate = shape.estimate.as_ref().map(|found| {
            json!({
                "degree": found.support.degree, "coefficients": found.support.coefficients,
                "chi_square": found.chi_square, "degrees_of_freedom": found.degrees,
            })
        });
        json!({
            "contacts": shape.touches.len(),
            "deviation": shape.deviation,
            "support": estimate,
            "error": shape_errors(observed).map(|[touched, everywhere]| json!({ "where_touched": touched, "largest": everywhere })),
            "bounds": bounds.collect::<Vec<_>>(),
        })
    });
    let simulation = experiment.truth.as_ref().map(|truth| {
        json!({
            "ended": space_ended(observed).unwrap_or_else(|| "completed".to_owned()),
            "volume": truth.scene.solid.volume(),
            "energy_drift": truth.trajectory.energy_drift(),
        })
    });
    json!({
        "scene": experiment.scene.title,
        "motion": "spatial",
        "seed": experiment.scene.seed,
        "samples": experiment.measurements.times.len(),
        "simulation": simulation,
        "updates": answers.updates.iter().map(|update| update_json(observed, update)).collect::<Vec<_>>(),
        "shape": shape,
        "interrupted": observed.interrupted,
    })
}
