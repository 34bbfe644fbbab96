//! What courses of the palms are advised, as text with a block to paste into a scene, and as JSON.

use crate::layout::counted;
use palmistry_bodies::mechanics::moving::Course;
use palmistry_scenes::{Advice, ExpectedBounds, Scene, TriedMotion};
use serde_json::{Value, json};

/// The lines of `[palms]` that say how they move; what else is under `[palms]` stays.
fn prescribed(courses: &[Course; 2]) -> String {
    let number = |value: f64| {
        let text = format!("{value:.3}");
        let text = text.trim_end_matches('0');
        if text.ends_with('.') { format!("{text}0") } else { text.to_owned() }
    };
    let course = |course: &Course| {
        let swings: Vec<String> = course
            .swings
            .iter()
            .map(|swing| {
                let [a, f, p] = [swing.amplitude, swing.frequency, swing.phase].map(number);
                format!("{{ amplitude = {a}, frequency = {f}, phase = {p} }}")
            })
            .collect();
        let (start, rate) = (number(course.start), number(course.rate));
        format!("    {{ start = {start}, rate = {rate}, swings = [{}] }},\n", swings.join(", "))
    };
    format!("prescribed = [\n{}{}]", course(&courses[0]), course(&courses[1]))
}

/// What is advised, as text.
pub fn advice_text(scene: &Scene, advice: &Advice) -> String {
    let mut lines = vec![scene.title.clone()];
    lines.push(format!(
        "{} of the palms tried; the body is held to the end in {}",
        counted(advice.tried, "motion"),
        advice.held
    ));
    let touched = |motion: &TriedMotion| {
        let part = format!("{:.1} % of all normals touched", 100.0 * motion.coverage.fraction());
        match motion.is_held() {
            true => part,
            false if motion.lasted > 0.0 => {
                format!("{part}, and the body is let go after {:.0} % of the time", 100.0 * motion.lasted)
            }
            false => "the body is not held at the start".to_owned(),
        }
    };
    if let Some(own) = &advice.own {
        lines.push(format!("as the scene has it: {}", touched(own)));
    }
    let Some(best) = &advice.best else {
        lines.push("no motion was found that holds the body at all".to_owned());
        return lines.join("\n");
    };
    lines.push(format!("best: {}", touched(best)));
    match &advice.expected {
        Some(expected) => lines.extend(expected_lines(scene, expected)),
        None => lines.push(
            "what its measurements determine is not known: the scene's model does not fit this motion"
                .to_owned(),
        ),
    }
    lines.push(String::new());
    lines.push("[palms]  # these lines in the place of what moves them".to_owned());
    lines.push(prescribed(&best.courses));
    lines.join("\n")
}

fn expected_lines(scene: &Scene, expected: &ExpectedBounds) -> Vec<String> {
    let bounds: Vec<String> =
        expected.bounds.iter().map(|(name, bound)| format!("{name} {bound:.1e}")).collect();
    let noise = match scene.sensor.noise.hypot(scene.sensor.resolution) > 0.0 {
        true => "with the scene's sensors",
        false => "for each nanometre of noise, as the scene states none",
    };
    vec![
        format!(
            "in {} of {} all that is estimated is observable",
            expected.observable_windows,
            counted(expected.windows, "window")
        ),
        format!("expected errors in the median window, {noise}: {}", bounds.join(", ")),
        format!("condition of the median window: {:.1e}", expected.condition),
    ]
}

/// What is advised, as JSON.
pub fn advice_json(scene: &Scene, advice: &Advice, interrupted: bool) -> Value {
    let number = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
    let motion = |motion: &TriedMotion| {
        let palms: Vec<Value> = motion
            .courses
            .iter()
            .map(|course| {
                let swings: Vec<Value> = course
                    .swings
                    .iter()
                    .map(|s| json!({ "amplitude": s.amplitude, "frequency": s.frequency, "phase": s.phase }))
                    .collect();
                json!({ "start": course.start, "rate": course.rate, "swings": swings })
            })
            .collect();
        json!({
            "palms": palms,
            "held": motion.is_held(),
            "lasted": motion.lasted,
            "coverage": motion.coverage.fraction(),
            "gaps": motion.coverage.gaps(),
        })
    };
    let expected = advice.expected.as_ref().map(|expected| {
        let bounds: serde_json::Map<String, Value> =
            expected.bounds.iter().map(|(name, bound)| (name.clone(), number(*bound))).collect();
        json!({
            "windows": expected.windows,
            "observable": expected.observable_windows,
            "bounds": bounds,
            "condition": number(expected.condition),
        })
    });
    json!({
        "scene": scene.title,
        "tried": advice.tried,
        "held": advice.held,
        "own": advice.own.as_ref().map(motion),
        "best": advice.best.as_ref().map(motion),
        "expected": expected,
        "interrupted": interrupted,
    })
}
