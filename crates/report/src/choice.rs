//! Which observer suffices, as text and as JSON.

use crate::layout::{item, prose};
use palmistry_scenes::{ObserverChoice, Sufficient, TriedObserver};
use serde_json::{Value, json};

/// What was tried and what is chosen, with times unless they are left out.
pub fn choice_text(choice: &ObserverChoice, times: bool) -> String {
    let mut out = String::new();
    let asked = match choice.asked {
        Sufficient::Accuracy(accuracy) => {
            format!(
                "a standard deviation of at most {accuracy:.1e} of the size of each estimated state, at the end"
            )
        }
        Sufficient::Within(seconds) => format!("the most accurate estimate within {}", duration(seconds)),
    };
    prose(&format!("asked for: {asked}"), &mut out);
    let how = match choice.asked {
        Sufficient::Accuracy(_) => "until one suffices, and one more",
        Sufficient::Within(_) => "until two take too long",
    };
    prose(&format!("tried in the order of what they cost as a rule, {how}:"), &mut out);
    for own in &choice.tried {
        item(&tried_in_words(own, times), &mut out);
    }
    match choice.chosen.map(|place| &choice.tried[place]) {
        Some(own) if choice.suffices => prose(&format!("chosen: {}", name(own)), &mut out),
        Some(own) => prose(
            &format!("none of them suffices; nearest to it: {}{}", name(own), lacking(choice, own)),
            &mut out,
        ),
        None => prose(
            "no answer passes its test of fit with a standard deviation for each estimated state",
            &mut out,
        ),
    }
    if let Some(better) = choice.better.filter(|_| choice.suffices) {
        prose(
            &format!("the next more accurate one: {}", tried_in_words(&choice.tried[better], times)),
            &mut out,
        );
    }
    out
}

/// The same as JSON.
pub fn choice_json(choice: &ObserverChoice, times: bool) -> Value {
    let asked = match choice.asked {
        Sufficient::Accuracy(accuracy) => json!({ "accuracy": accuracy }),
        Sufficient::Within(seconds) => json!({ "seconds": seconds }),
    };
    let tried = choice.tried.iter().map(|own| {
        json!({
            "method": own.method.name(),
            "window": own.window,
            "seconds": times.then_some(own.seconds),
            "passes": own.passes,
            "accuracy": own.accuracy.is_finite().then_some(own.accuracy),
        })
    });
    json!({
        "asked": asked,
        "tried": tried.collect::<Vec<_>>(),
        "suffices": choice.suffices,
        "chosen": choice.chosen,
        "better": choice.better,
    })
}

fn name(own: &TriedObserver) -> String {
    match own.window {
        Some(window) => format!("{}, windows of {window} samples", own.method.name()),
        None => format!("{}, all samples at once", own.method.name()),
    }
}

fn tried_in_words(own: &TriedObserver, times: bool) -> String {
    let time = if times { format!(", {}", duration(own.seconds)) } else { String::new() };
    let found = match (own.passes, own.accuracy.is_finite()) {
        (false, _) => "does not pass".to_owned(),
        (true, false) => "does not determine a state".to_owned(),
        (true, true) => format!("accuracy {:.1e}", own.accuracy),
    };
    format!("{}: {found}{time}", name(own))
}

/// What would have to change: deviations fall with the root of the number of measurements.
fn lacking(choice: &ObserverChoice, own: &TriedObserver) -> String {
    match choice.asked {
        Sufficient::Accuracy(accuracy) => {
            let times = own.accuracy / accuracy;
            format!(
                "; it would take errors of the measurements {times:.1} times smaller, or some {:.0} times as many measurements",
                times * times
            )
        }
        Sufficient::Within(_) => String::new(),
    }
}

fn duration(seconds: f64) -> String {
    match seconds {
        long if long >= 1.0 => format!("{long:.2} s"),
        short => format!("{:.2} ms", short * 1e3),
    }
}
