//! Which of several known bodies was measured, as text, JSON and for the page.

use super::fit::{finite, p_in_words};
use maud::{Markup, html};
use palmistry_bodies::shape::Measured;
use palmistry_scenes::{LibraryAnswer, Recognition, RecognitionVerdict};
use serde_json::{Value, json};
use std::fmt::Write;

/// The verdict in a word or two, for programs.
fn word(verdict: &RecognitionVerdict) -> &'static str {
    match verdict {
        RecognitionVerdict::Recognised(_) => "recognised",
        RecognitionVerdict::Alike(_) => "cannot be distinguished",
        RecognitionVerdict::NoneOfThem => "none of them",
    }
}

/// The verdict with names.
fn in_words(found: &Recognition) -> String {
    match &found.verdict {
        RecognitionVerdict::Recognised(_) => format!("it is {}", found.names().join(", ")),
        RecognitionVerdict::Alike(_) => format!("cannot be distinguished: {}", found.names().join(", ")),
        RecognitionVerdict::NoneOfThem => "it is none of them".to_owned(),
    }
}

/// What is said of one body.
fn standing(body: &LibraryAnswer) -> String {
    let Some(fit) = body.fit else { return "no motion of it could be followed".to_owned() };
    let does = if fit.fits { "passes" } else { "fails" };
    let (square, degrees) = (fit.chi_square, fit.degrees);
    format!("{does} the chi-square test ({}): {square:.1} of {degrees}", p_in_words(fit.probability))
}

fn measured(number: Measured) -> String {
    format!("{:.6} ± {:.1e}", number.value, number.deviation)
}

/// As text.
pub(super) fn recognition_text(found: &Recognition) -> String {
    let count = found.bodies.len();
    let mut text =
        format!("\nrecognition among {count} known bodies, from all measurements: {}\n", in_words(found));
    for body in &found.bodies {
        let _ = write!(text, "  {}: {}", body.name, standing(body));
        match body.fits() {
            true => {
                let (angle, rate) = (measured(body.orientation), measured(body.rate));
                let _ = writeln!(text, "; at the first sample {angle} rad, {rate} rad/s");
            }
            false if body.fit.is_some() => {
                let _ = writeln!(text, "; the residual is {:.1e} m (rms)", body.rms_residual);
            }
            false => text.push('\n'),
        }
    }
    match &found.verdict {
        RecognitionVerdict::Recognised(_) => {}
        RecognitionVerdict::Alike(_) => text.push_str(
            "  try next (cannot be distinguished): a motion that touches more of the outline, or sensors with less noise\n",
        ),
        RecognitionVerdict::NoneOfThem => text.push_str(
            "  try next (none of them): add the body to [[observer.library]], or recover its outline without one\n",
        ),
    }
    text
}

fn measured_json(number: Measured) -> Value {
    json!({ "value": finite(number.value), "deviation": finite(number.deviation) })
}

/// As JSON.
pub(super) fn recognition_json(found: &Recognition) -> Value {
    let bodies = found.bodies.iter().map(|body| {
        json!({
            "name": body.name,
            "fits": body.fits(),
            "chi_square": body.fit.map(|fit| finite(fit.chi_square)),
            "degrees_of_freedom": body.fit.map(|fit| fit.degrees),
            "probability": body.fit.map(|fit| finite(fit.probability)),
            "residual": finite(body.rms_residual),
            "orientation": measured_json(body.orientation),
            "rate": measured_json(body.rate),
        })
    });
    json!({ "verdict": word(&found.verdict), "names": found.names(), "bodies": bodies.collect::<Vec<_>>() })
}

/// For the page.
pub(super) fn recognition_section(found: &Recognition) -> Markup {
    html! {
        p { "Among " (found.bodies.len()) " known bodies, by all measurements: " b { (in_words(found)) } "." }
        div.scroll {
            table {
                thead { tr { th { "body" } th { "" } th { "left of a contact, m (rms)" } th { "angle at the first sample, rad" } th { "rate, rad/s" } } }
                tbody {
                    @for body in &found.bodies {
                        tr {
                            td { b { (body.name) } }
                            td { (standing(body)) }
                            @if body.fit.is_some() {
                                td.n { (format!("{:.1e}", body.rms_residual)) }
                                td.n { (measured(body.orientation)) }
                                td.n { (measured(body.rate)) }
                            } @else {
                                td {} td {} td {}
                            }
                        }
                    }
                }
            }
        }
    }
}
