//! Whether all windows together are explained, and the innovations of a filter, as text and as JSON.

use super::fit::{finite, p_in_words};
use palmistry_observe::{Innovations, Together, Track, Update};
use serde_json::{Value, json};

/// What is to be said of a track as a whole, a line each: of several windows whether they are explained together and where they meet, of a filter whether its
/// innovations are.
pub(super) fn verdict_lines(track: &Track) -> Vec<String> {
    let together = track.together().map(|all| together_in_words(&all));
    let innovations = track.innovations.map(|own| innovations_in_words(&own));
    together.into_iter().chain(untested_in_words(&track.updates)).chain(innovations).collect()
}

/// How many windows nothing was tested of, where there are several.
fn untested_in_words(updates: &[Update]) -> Option<String> {
    let untested = updates.iter().filter(|update| update.is_untested()).count();
    (untested > 0 && updates.len() > 1).then(|| {
        let windows = updates.len();
        format!("in {untested} of {windows} windows too little was measured to test the residuals")
    })
}

pub(super) fn together_in_words(all: &Together) -> String {
    let does = if all.fits { "pass" } else { "fail" };
    let seam = all.worst_seam.map_or_else(String::new, |(seam, probability)| {
        format!(
            "; where they meet they are apart most at {:.3} s, by chi-square {:.1} of {} ({} of the worst)",
            seam.time,
            seam.chi_square,
            seam.degrees,
            p_in_words(probability)
        )
    });
    let seams = all.seams.filter(|_| !all.fits).map_or_else(String::new, |probability| {
        format!("; all such differences together have {}", p_in_words(probability))
    });
    format!(
        "the {} windows together {does} the chi-square test ({} by Fisher's method){seam}{seams}",
        all.windows,
        p_in_words(all.probability)
    )
}

/// The test of a filter's innovations.
pub(super) fn innovations_in_words(own: &Innovations) -> String {
    let does = if own.fits { "pass" } else { "fail" };
    let white = own.whiteness.map_or_else(String::new, |p| format!("; as white noise {}", p_in_words(p)));
    format!(
        "its innovations {does} the chi-square test: normalised squares of {:.1} for {} measurements with noise of {:.1e} ({}){white}",
        own.chi_square,
        own.degrees,
        own.sigma,
        p_in_words(own.probability)
    )
}

/// The same as an object; null where there is nothing to test.
pub(super) fn together_json(together: Option<Together>) -> Value {
    let Some(all) = together else { return Value::Null };
    let seam = all.worst_seam.map(|(seam, probability)| {
        json!({
            "time": seam.time,
            "chi_square": finite(seam.chi_square),
            "degrees_of_freedom": seam.degrees,
            "probability": probability,
        })
    });
    json!({
        "fits": all.fits,
        "windows": all.windows,
        "probability": all.probability,
        "worst_seam": seam,
        "probability_of_seams": all.seams,
    })
}

/// The test of a filter's innovations as an object; null of other methods.
pub(super) fn innovations_json(innovations: Option<Innovations>) -> Value {
    innovations.map_or(Value::Null, |own| {
        json!({
            "fits": own.fits,
            "chi_square": finite(own.chi_square),
            "degrees_of_freedom": own.degrees,
            "probability": own.probability,
            "noise": own.sigma,
            "whiteness": own.whiteness,
        })
    })
}
