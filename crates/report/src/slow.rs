//! What slow palms determine of a body: text, JSON, and a page with the pictures of figures 3.6, 3.7 and 3.8 and the body in motion.

use crate::document::document;
use crate::layout::{counted, counted_in, in_columns};
use crate::slow_observed::SlowObserved;
use crate::slow_plot::{animation, curves, frames};
use crate::slow_study::{number, study_json, study_section, study_text};
use maud::{Markup, PreEscaped, html};
use palmistry_scenes::slow::{Arrangement, FoundJump, SlowAnswers, SlowTrack, ThesisMethod, TrackError};
use serde_json::{Value, json};
use std::fmt::Write;

/// Samples at which it is shown what was touched.
const FRAMES: usize = 27;

fn method_name(method: ThesisMethod) -> &'static str {
    match method {
        ThesisMethod::PredictorCorrector => "3.35 to 3.37 by predictor and corrector",
        ThesisMethod::Dopri5 => "3.35 to 3.37 by dopri5",
        ThesisMethod::Dop853 => "3.35 to 3.37 by dop853",
    }
}

/// A way, its track, its seconds, and what is to be said of it.
struct Way<'a> {
    name: &'static str,
    track: &'a SlowTrack,
    seconds: Option<f64>,
    remark: String,
}

fn greatest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

fn ways<'a>(observed: &SlowObserved<'a>) -> Vec<Way<'a>> {
    let answers = observed.answers;
    let mut all = Vec::new();
    if let Some(found) = &answers.together {
        let kinks = match found.kinks.len() {
            0 => String::new(),
            count => format!(" and {} of the curvature", counted(count, "kink")),
        };
        let remark = format!(
            "order {}{kinks}, {:.2e} m residual of a contact; the measurements {} explained",
            found.order,
            found.rms_residual,
            if answers.explained { "are" } else { "are NOT" }
        );
        all.push(Way {
            name: "batch least squares",
            track: &found.track,
            seconds: Some(answers.seconds[0]),
            remark,
        });
    }
    let from = if observed.experiment.truth.is_some() {
        "from the true height"
    } else {
        "from the height that was found"
    };
    if let Some(track) = &answers.quadrature {
        all.push(Way {
            name: "quadrature",
            track,
            seconds: Some(answers.seconds[1]),
            remark: from.to_owned(),
        });
    }
    for (method, found) in &answers.thesis {
        let remark = match &found.stopped {
            Some(why) => format!(
                "stopped at sample {} of {}: {why}",
                found.track.radii.len(),
                observed.experiment.measurements.rows()
            ),
            None => format!(
                "the denominator of 3.37 changes its sign {}; e_f up to {:.1e} m, e_c up to {:.1e} m",
                counted(found.vanishing.len(), "time"),
                greatest(&found.force_error),
                greatest(&found.contact_error)
            ),
        };
        let seconds = (*method == ThesisMethod::PredictorCorrector).then_some(answers.seconds[2]);
        all.push(Way { name: method_name(*method), track: &found.track, seconds, remark });
    }
    if let Some(found) = &answers.misled {
        let remark = format!(
            "the height at the first sample 1 % off: e_f up to {:.1e} m, e_c up to {:.1e} m",
            greatest(&found.force_error),
            greatest(&found.contact_error)
        );
        all.push(Way { name: "the same, misled", track: &found.track, seconds: None, remark });
    }
    all
}

fn error_in_words(error: Option<TrackError>, mean: f64) -> String {
    match error {
        Some(error) => format!("{:.1e} of the mean radius, {:.1e} rad", error.radius / mean, error.phi0),
        None => "-".to_owned(),
    }
}

fn mean_radius(observed: &SlowObserved<'_>) -> f64 {
    let truth =
        observed.experiment.truth.as_ref().map(|truth| truth.shape.perimeter() / std::f64::consts::TAU);
    let found = observed.answers.together.as_ref().map(|found| found.shape.support.mean());
    truth.or(found).unwrap_or(1.0)
}

/// What was found, as text.
pub fn slow_text(observed: &SlowObserved<'_>) -> String {
    let (experiment, answers) = (observed.experiment, observed.answers);
    let mut out = format!("{}\n", experiment.scene.title);
    let _ = writeln!(out, "{}", counted(experiment.measurements.rows(), "sample"));
    if let Some(truth) = &experiment.truth {
        let _ =
            writeln!(out, "the motion: {}; jumps: {}", truth.trajectory.ended, truth.trajectory.jumps.len());
        for jump in &truth.trajectory.jumps {
            let _ = writeln!(
                out,
                "  at {:.4} s, palms {:.4} and {:.4} rad: from {:.4} to {:.4} rad, {:.3e} m down",
                jump.time, jump.palms[0], jump.palms[1], jump.from, jump.to, jump.drop
            );
        }
    }
    let mean = mean_radius(observed);
    for way in ways(observed) {
        let _ = writeln!(
            out,
            "{}: {}; {}",
            way.name,
            error_in_words(experiment.error(way.track), mean),
            way.remark
        );
    }
    if answers.together.is_none() {
        out.push_str(
            "batch estimate of all measurements: no start could be followed; nothing is recovered\ntry next: \
             slower palms or more samples, so that less happens between two of them, or a smooth convex body\n",
        );
    } else if !answers.explained {
        out.push_str(
            "try next (residuals not explained): more 'noise' or 'resolution' of the sensors if they have it, or a smooth convex \
             body, as the model takes it to be\n",
        );
    }
    if !answers.jumps.is_empty() {
        let _ = writeln!(
            out,
            "jumps found in the measurements, and where descent leads: {}",
            jumps_in_words(answers)
        );
    }
    if let Some(both) = &answers.arrangements {
        let _ = writeln!(out, "3.48 and 3.49: {}", arrangements_in_words(both));
    }
    let votes: Vec<String> =
        answers.votes.iter().take(4).map(|vote| format!("{:.6} m ({})", vote.height, vote.votes)).collect();
    let _ = writeln!(out, "heights determined by zeros of 3.37's numerator: {}", votes.join(", "));
    out.push_str(&study_text(observed.study));
    if observed.interrupted {
        out.push_str("interrupted: this is what was done until then\n");
    }
    in_columns(&out)
}

/// Jumps in one line.
pub(super) fn jumps_in_words(answers: &SlowAnswers) -> String {
    let one = |jump: &FoundJump| {
        let word = match (jump.certain, jump.predicted) {
            (false, _) => "possibly: a quick turn without a jump explains the measurements as well",
            (true, true) => "as descent says",
            (true, false) => "another pose than descent says",
        };
        let before = match jump.within.map(|row| row + 1) {
            [first, last] if first < last => format!("before one of the samples {first} to {last}"),
            [only, _] => format!("before sample {only}"),
        };
        format!("{before} by {:.4} rad, {word}", jump.turn)
    };
    answers.jumps.iter().map(one).collect::<Vec<_>>().join("; ")
}

/// What 3.48 and 3.49 say of both arrangements.
fn arrangements_in_words(both: &[Arrangement; 2]) -> String {
    let one = |name: &str, at: &Arrangement| {
        format!(
            "{name} {:.2e} m^2 over {}, E {:.2e}",
            at.area,
            counted_in(at.patches, "patch", "patches"),
            at.error()
        )
    };
    format!("{}; {}", one("as found", &both[0]), one("the thesis's way, restarted at the jumps,", &both[1]))
}

/// What was found, as JSON.
pub fn slow_json(observed: &SlowObserved<'_>) -> Value {
    let (experiment, answers) = (observed.experiment, observed.answers);
    let ways = ways(observed).into_iter().map(|way| {
        let error = experiment.error(way.track);
        json!({
            "name": way.name,
            "samples": way.track.radii.len(),
            "radius_error": error.map(|error| error.radius),
            "phi0_error": error.map(|error| error.phi0),
            "remark": way.remark,
            "seconds": way.seconds,
        })
    });
    let together = answers.together.as_ref().map(|found| {
        let support = &found.shape.support;
        let deviations: Vec<Value> =
            found.shape.covariance.diagonal().iter().map(|variance| number(variance.sqrt())).collect();
        json!({
            "mean": support.mean(),
            "harmonics": support.harmonics(),
            "deviations": deviations,
            "order": found.order,
            "kinks": found.kinks.iter().map(|kink| json!({ "angle": kink.angle, "jumps": kink.jumps })).collect::<Vec<_>>(),
            "residual": found.rms_residual,
            "sigma": found.sigma,
            "explained": answers.explained,
        })
    });
    let simulation = experiment.truth.as_ref().map(|truth| {
        let jumps = truth.trajectory.jumps.iter().map(|jump| {
            json!({ "time": jump.time, "palms": jump.palms, "from": jump.from, "to": jump.to, "drop": jump.drop })
        });
        json!({ "ended": truth.trajectory.ended.to_string(), "jumps": jumps.collect::<Vec<_>>() })
    });
    let votes = answers.votes.iter().map(|vote| json!({ "height": vote.height, "votes": vote.votes }));
    json!({
        "scene": experiment.scene.title,
        "motion": "quasistatic",
        "seed": experiment.scene.seed,
        "samples": experiment.measurements.rows(),
        "simulation": simulation,
        "shape": together,
        "ways": ways.collect::<Vec<_>>(),
        "jumps": answers.jumps.iter().map(|jump| json!({ "row": jump.row, "within": jump.within, "turn": jump.turn, "predicted": jump.predicted, "certain": jump.certain })).collect::<Vec<_>>(),
        "arrangements": answers.arrangements.map(|both| both.map(|at| json!({ "patches": at.patches, "area": at.area, "force": at.force, "contact": at.contact, "error": at.error() }))),
        "heights": votes.collect::<Vec<_>>(),
        "study": study_json(observed.study),
        "interrupted": observed.interrupted,
    })
}

/// How far each way is off, and what is to be said of it.
pub(super) fn ways_table(observed: &SlowObserved<'_>) -> Markup {
    let mean = mean_radius(observed);
    html! {
        table {
            thead { tr { th { "way" } th { "greatest error" } th { "remark" } } }
            tbody {
                @for way in ways(observed) {
                    tr { td { (way.name) } td { (error_in_words(observed.experiment.error(way.track), mean)) } td { (way.remark) } }
                }
            }
        }
    }
}

/// The page as HTML.
pub fn slow_page(observed: &SlowObserved<'_>) -> String {
    let (experiment, answers) = (observed.experiment, observed.answers);
    let content = html! {
        header {
            h1 { (experiment.scene.title) }
            p {
                "A smooth convex body at rest between two slow palms (chapter 3); " b { (experiment.measurements.rows()) " samples" } ". "
                @if let Some(truth) = &experiment.truth {
                    "Simulated: the motion " (truth.trajectory.ended) ", with " (truth.trajectory.jumps.len()) " jumps. "
                } @else { "Recorded: what is true is not known. " }
            }
            @if observed.interrupted { p.bad { "This run was interrupted; it shows what was done until then." } }
        }
        main {
            section #body { h2 { "The body between its palms" } figure.narrow { (PreEscaped(animation(observed))) } }
            @if let Some(truth) = &experiment.truth {
                @if !truth.trajectory.jumps.is_empty() {
                    section #jumps {
                        h2 { "Jumps" }
                        table {
                            thead { tr { th { "s" } th { "palms, rad" } th { "from, rad" } th { "to, rad" } th { "down, m" } } }
                            tbody { @for jump in &truth.trajectory.jumps {
                                tr {
                                    td { (format!("{:.4}", jump.time)) } td { (format!("{:.4}, {:.4}", jump.palms[0], jump.palms[1])) }
                                    td { (format!("{:.4}", jump.from)) } td { (format!("{:.4}", jump.to)) } td { (format!("{:.2e}", jump.drop)) }
                                }
                            } }
                        }
                    }
                }
            }
            section #found {
                h2 { "What each way found" }
                (ways_table(observed))
                @if answers.together.is_none() { p.bad { "Batch estimate of all measurements: no start could be followed; nothing is recovered." } }
                @if !answers.jumps.is_empty() { p { "Jumps found in the measurements, and where descent in the recovered potential leads: " (jumps_in_words(answers)) "." } }
                @if let Some(both) = &answers.arrangements { p { "The errors 3.48 and 3.49 of segments, for comparison: " (arrangements_in_words(both)) "." } }
                p {
                    "Heights of the centre of mass at the first sample determined by zeros of 3.37's numerator, with their number: "
                    @for vote in answers.votes.iter().take(6) { (format!("{:.5} m ({}) ", vote.height, vote.votes)) }
                }
            }
            section #frames { h2 { "As figure 3.6: what was touched so far" } div.frames { (PreEscaped(frames(observed, FRAMES, 200))) } }
            section #errors { h2 { "As figures 3.7 and 3.8: errors over the samples" } div.two { (PreEscaped(curves(observed))) } }
            @if !observed.study.is_empty() { section #study { h2 { "Many bodies" } (study_section(observed.study)) } }
        }
    };
    document(&experiment.scene.title, &content, false)
}
