//! An experiment as a part of a page: pictures first, then what each observer found, in tables and as text.

use crate::motion::answers::{Observed, fault_lines, noise_unit, sparse_lines};
use crate::motion::frames::{frames, recovered_outline};
use crate::motion::outline_section::shape_section;
use crate::motion::plot::{errors, sensor_errors, state};
use crate::motion::reconstruction::length;
use crate::motion::shape::{departure, outline};
use crate::motion::studies_section::studies;
use crate::motion::table::{ends, notes, pace, updates};
use maud::{Markup, PreEscaped, html};
use palmistry_bodies::mechanics::Palm;
use palmistry_scenes::{Channel, Guess, NOMINAL, SceneOutline, error, shown};
use std::collections::BTreeMap;

/// At most so many samples are drawn.
pub(super) const FRAMES: usize = 12;

/// Experiments, as a section of the page of the thesis.
pub(crate) fn observed_section(experiments: &[Observed<'_>]) -> Markup {
    html! {
        section #observers {
            h2 { "Bodies in motion" }
            p {
                "A body moves between two palms by Newton's laws and contact geometry; observers get only what touch sensors and "
                "motors measure, and recover shape and motion with the equations of the proof file. "
                code { "palmistry observe" } " writes such a page for any scene, with twice the samples and the errors of the sensors."
            }
            @for observed in experiments {
                h3 { (observed.experiment.scene.title) }
                (summary(observed))
                (faults(observed))
                @if observed.experiment.is_about_palms() { (body_pictures(observed, FRAMES / 2)) }
                (shape_section(observed))
                (ends(observed))
                (notes(observed))
                details { summary { "states over time, and their errors" } (state_pictures(observed)) }
                details { summary { "all updates" } (updates(observed)) }
                (studies(observed))
            }
        }
    }
}

fn palms_in_words(forms: &[Palm<f64>; 2]) -> String {
    let one = |form: &Palm<f64>| match form {
        Palm::Flat => "flat".to_owned(),
        Palm::Circular { radius } if *radius > 0.0 => {
            format!("hollow, an arc of radius {} m", shortest(*radius))
        }
        Palm::Circular { radius } => format!("bulging, an arc of radius {} m", shortest(-radius)),
    };
    match forms {
        [Palm::Flat, Palm::Flat] => "two palms".to_owned(),
        [first, second] => format!("two palms (the first is {}, the second {})", one(first), one(second)),
    }
}

fn shape_in_words(shape: &SceneOutline) -> String {
    match shape {
        SceneOutline::Harmonics { harmonics, .. } => {
            format!("a body whose support function has {} harmonics", harmonics.len())
        }
        SceneOutline::Ellipse { .. } => "an ellipse".to_owned(),
        SceneOutline::Superellipse { .. } => "a superellipse".to_owned(),
        SceneOutline::Arcs { corners, .. } => format!("a body with {} corners", corners.len()),
        SceneOutline::Spline { .. } => "a closed spline".to_owned(),
        SceneOutline::RandomSpline { seed, .. } => format!("a random closed spline (seed {seed})"),
    }
}

/// What was simulated or loaded, and what was asked for.
pub(super) fn summary(observed: &Observed<'_>) -> Markup {
    let experiment = observed.experiment;
    let (scene, times) = (&experiment.scene, experiment.signals.times());
    let (first, last) = (times.first().copied().unwrap_or(0.0), times.last().copied().unwrap_or(0.0));
    let sensor = &scene.sensor;
    let guesses =
        experiment.question.guess.iter().map(|(name, value)| format!("{name} = {}", shortest(*value)));
    html! {
        (headline(observed))
        p {
            @if let (Some(simulation), Some(simulated)) = (&experiment.simulation, &scene.simulated) {
                "Simulated: " (shape_in_words(&simulated.body.shape)) ", " (simulated.body.mass) " kg, between " (palms_in_words(&scene.palm_forms)) "; "
                b { (times.len()) " samples over " (shortest(last - first)) " s" } ". The motion "
                @match simulation.ended() {
                    palmistry_bodies::mechanics::moving::Ended::Completed => { "went to its end" }
                    early => { b { "ended early: " (early) } }
                }
                ", and energy was kept to " (format!("{:.0e} J", simulation.trajectory.energy_drift())) ". "
                @if sensor.noise == 0.0 && sensor.resolution == 0.0 {
                    "The contacts were measured without error; bounds are for measurements good to " (format!("{NOMINAL:.0e} m")) ", and the residuals of "
                    "an error comes from the curves between the samples. "
                } @else {
                    "The contacts were read with errors of " (format!("{:.1e} m", sensor.noise)) " (standard deviation, seed "
                    (scene.seed) ")"
                    @if sensor.resolution > 0.0 { ", rounded to multiples of " (format!("{:.1e} m", sensor.resolution)) }
                    ". "
                }
                @for (name, own) in &scene.channels { (channel_in_words(name, own)) " " }
                @if sensor.jitter > 0.0 { "Steps in time vary by " (format!("{:.1e} s", sensor.jitter)) ". " }
            } @else if let (Some(motion), Some(simulated)) = (&experiment.motion, &scene.system) {
                "Simulated by its own equations, from " code { (values(&simulated.start)) }
                @if !simulated.inputs.is_empty() { ", driven by " code { (functions(&simulated.inputs)) } }
                "; " b { (times.len()) " samples over " (shortest(last - first)) " s" } ". "
                @if let Some(lost) = motion.ended() { "The motion " b { "ended early: " (lost.to_string()) } ". " }
                @if sensor.noise == 0.0 && sensor.resolution == 0.0 {
                    "The outputs were measured without error; bounds are for measurements good to " (format!("{NOMINAL:.0e}")) ". "
                } @else {
                    "The outputs were read with errors of " (format!("{:.1e}{}", sensor.noise, noise_unit(observed)))
                    " (standard deviation, seed " (scene.seed) ")"
                    @if sensor.resolution > 0.0 { ", rounded to multiples of " (format!("{:.1e}{}", sensor.resolution, noise_unit(observed))) }
                    ". "
                }
                @if sensor.jitter > 0.0 { "Steps in time vary by " (format!("{:.1e} s", sensor.jitter)) ". " }
            } @else if let (Some(motion), Some(simulated)) = (&experiment.motion, &scene.robot) {
                "Simulated: a robot of " (simulated.robot.mass) " kg on two wheels over uneven ground, wheel 1 at " (simulated.robot.speed) " m/s; "
                b { (times.len()) " samples over " (shortest(last - first)) " s" } ". "
                @if let Some(lost) = motion.ended() { "The motion " b { "ended early: " (lost.to_string()) } ". " }
                @for (name, own) in &scene.channels { (channel_in_words(name, own)) " " }
                @if sensor.jitter > 0.0 { "Steps in time vary by " (format!("{:.1e} s", sensor.jitter)) ". " }
            } @else {
                "Recorded: " b { (times.len()) " samples from " (shortest(first)) " s to " (shortest(last)) " s" }
                @if let Some(file) = scene.data.record.as_ref().and_then(|path| path.file_name()) {
                    " (the scene names " code { (file.to_string_lossy()) } ")"
                }
                ". What is true is not known, so that there are no errors here, only bounds. "
            }
            "Model: " (experiment.system.title) "."
        }
        p {
            @if scene.observer.guess == Guess::None { "Estimated without a first guess, from what the measurements themselves determine at first: " }
            @else { "Estimated, with the initial guesses: " }
            code { (guesses.collect::<Vec<_>>().join(", ")) }
            @if !experiment.question.clamped.is_empty() {
                "; fixed at its guess in the first window: " code { (experiment.question.clamped.join(", ")) }
            }
            ". A window has " (scene.observer.window) " steps of time."
        }
        @if observed.interrupted { p.bad { "This run was interrupted; it shows what was done until then." } }
    }
}

/// The sensor of a column that has its own.
fn channel_in_words(name: &str, own: &Channel) -> String {
    let mut parts = Vec::new();
    if let Some(noise) = own.noise.filter(|noise| *noise > 0.0) {
        parts.push(format!("errors of {noise:.1e}"));
    }
    if let Some(resolution) = own.resolution.filter(|resolution| *resolution > 0.0) {
        parts.push(format!("rounding to multiples of {resolution:.1e}"));
    }
    if own.gain != 1.0 {
        parts.push(format!("a gain of {}", own.gain));
    }
    if own.bias != 0.0 {
        parts.push(format!("a bias of {}", own.bias));
    }
    if own.delay > 0.0 {
        parts.push(format!("a delay of {:.1e} s", own.delay));
    }
    if parts.is_empty() {
        format!("{name} was read without error.")
    } else {
        format!("{name} was read with {}.", parts.join(", "))
    }
}

fn values(values: &BTreeMap<String, f64>) -> String {
    values.iter().map(|(name, value)| format!("{name} = {}", shortest(*value))).collect::<Vec<_>>().join(", ")
}

fn functions(functions: &BTreeMap<String, String>) -> String {
    functions.iter().map(|(name, text)| format!("{name}(t) = {text}")).collect::<Vec<_>>().join(", ")
}

/// In a sentence what the method whose outline is shown came to.
fn headline(observed: &Observed<'_>) -> Markup {
    let Some(answer) = shown(observed.answers) else { return html! {} };
    let names = observed.experiment.names();
    let end = answer.track.last().and_then(|last| Some((last, observed.experiment.truth_at(last.time)?)));
    let largest = end.map(|(last, truth)| {
        last.state.iter().zip(&truth).map(|(value, truth)| error(*value, *truth)).fold(0.0, f64::max)
    });
    html! {
        p.lead {
            b { (answer.method.name()) }
            @match largest {
                Some(largest) if largest.is_finite() => {
                    " ends with " (names.join(", ")) " off by at most " b { (format!("{largest:.1e}")) } " of their size"
                }
                Some(_) => { " does not end with a number for each of " (names.join(", ")) }
                None => { " looked for " (names.join(", ")) }
            }
            @if answer.track.unobserved > 0 {
                "; " b { "the state was not observable at " (answer.track.unobserved) " of " (observed.experiment.signals.times().len()) " samples" }
            }
            @if let Some(pace) = pace(observed, answer) { "; " (pace) }
            "."
        }
    }
}

/// A number with no more digits than it needs, five at most.
fn shortest(value: f64) -> String {
    let text = format!("{value:.5}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// The faults of a file, by row.
pub(super) fn faults(observed: &Observed<'_>) -> Markup {
    let lines = fault_lines(&observed.experiment.faults);
    html! {
        @if !lines.is_empty() {
            details open[lines.len() <= 12] {
                summary { (lines.len()) " faults in the file; their rows were left out, unless the fault is a gap" }
                ul.faults { @for line in &lines { li { code { (line) } } } }
            }
        } @else if observed.experiment.simulated().is_none() {
            p { "No row of the file is faulty." }
        }
        @let sparse = sparse_lines(observed.experiment);
        @if !sparse.is_empty() {
            p { "Not each row measures all:" }
            ul { @for line in &sparse { li { (line) } } }
        }
    }
}

/// As figure 4.3 and 4.4a.
pub(super) fn body_pictures(observed: &Observed<'_>, most: usize) -> Markup {
    let Some(outline) = outline(observed.experiment, observed.answers) else {
        return html! {
            p.remark {
                "There is no picture of the body: that takes two palms with the outputs s1 and s2, estimates of r1 and r2, and "
                "omega0, phi1 and phi2 estimated, measured or given."
            }
        };
    };
    let shape = observed.experiment.simulation.as_ref().map(|simulation| &simulation.shape);
    html! {
        figure {
            div.frames { @for picture in frames(observed, &outline, most) { (PreEscaped(picture)) } }
            figcaption {
                "The palms about their joint at " (outline.instants.len().min(most)) " samples. Large dots are the "
                "centre of mass and the two contacts. Small dots are the part of the outline that " b { (outline.method.name()) }
                " has recovered by then, blue where palm 1 touched it and orange where palm 2 did"
                @if !outline.instants.iter().all(|instant| instant.is_observed) { ", pale where the state was not observable" }
                ". "
                @if shape.is_some() {
                    "The thin line is the true outline; dots beside it are errors of the observer, or of the orientation, which is the "
                    "integral of its rate."
                } @else { "The body's place is the recovered one: the true outline is not known." }
            }
        }
        figure.narrow {
            (PreEscaped(recovered_outline(shape, &outline)))
            figcaption {
                "Every recovered contact, turned back by the recovered orientation. "
                @if let Some(shape) = shape {
                    @match departure(&outline, shape) {
                        Some((largest, mean)) => {
                            @let size = (shape.area() / std::f64::consts::PI).sqrt();
                            "Where it could see, the points lie within " b { (length(largest)) } " of the true outline (root of the "
                            "mean square " (length(mean)) "), " (format!("{:.1e}", largest / size)) " of the radius of a disc with "
                            "the body's area."
                        }
                        None => { b { "There was no sample at which it could see:" } " no point counts as recovered." }
                    }
                } @else { "The frame is that of the body at the first sample." }
            }
        }
    }
}

/// As figure 4.4b and c: each state over time, and its errors beside the Cramér-Rao bound.
pub(super) fn state_pictures(observed: &Observed<'_>) -> Markup {
    let places = 0..observed.experiment.names().len();
    let known = observed.experiment.simulated().is_some();
    html! {
        figure {
            div.two {
                @for place in places {
                    (PreEscaped(state(observed, place)))
                    @if let Some(picture) = errors(observed, place) { (PreEscaped(picture)) }
                }
            }
            figcaption {
                @if known {
                    "Each state, true (broad grey line) and recovered; a good observer hides in the grey. "
                    "Beside it the error, in decades: " b { "circles are the bound of Cramér and Rao" } ", carried along the flow from the "
                    "first sample of each window, below which no unbiased estimate can stay on average, and of filters their own "
                    "standard deviation. "
                } @else { "Each state as each method recovered it. " }
                "Faint vertical lines are where windows meet; bars, where they are long enough to be seen, are two standard deviations "
                "of the bound to either side. Values far outside are cut off. A window's estimate holds for its first sample; from "
                "there the equations carry it on, and its bound with it."
            }
        }
    }
}

/// As figure 4.4d.
pub(super) fn sensor_pictures(observed: &Observed<'_>) -> Markup {
    let pictures = sensor_errors(observed);
    html! {
        @if pictures.is_empty() {
            p.remark { "No method compared what it expected with what was read." }
        } @else {
            figure {
                div.two { @for picture in &pictures { (PreEscaped(picture)) } }
                figcaption {
                    (if observed.experiment.is_about_palms() { "The contact" } else { "The output" }) " that the model expects minus the one that was read. What an observer that is right has "
                    "left is the error of the sensor, without a trend; a curve that bends within a window shows a wrong state or "
                    "model. A method that compares nothing has no curve."
                }
            }
        }
    }
}
