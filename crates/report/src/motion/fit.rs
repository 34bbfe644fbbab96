//! Whether what an observer found explains the measurements, as text and as JSON; and what would not be noticed.

use crate::layout::counted;
use palmistry_observe::{Fit, NoiseFrom, Suspect, Update, UpdateEnd};
use serde_json::{Map, Value, json};

/// An infinite bound has no number in JSON.
pub(super) fn finite(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

/// Where the size of the noise comes from, in a word.
pub(super) fn noise_from(from: NoiseFrom) -> &'static str {
    match from {
        NoiseFrom::Stated => "stated",
        NoiseFrom::Residual | NoiseFrom::Untested => "residual",
        NoiseFrom::Computation => "computation",
    }
}

/// A probability with its digits, however small.
pub(super) fn p_in_words(probability: f64) -> String {
    match probability {
        p if p <= 0.0 => "p below 1e-300".to_owned(),
        p if p < 1e-3 => format!("p = {p:.1e}"),
        p if p < 0.1 => format!("p = {p:.4}"),
        p => format!("p = {p:.2}"),
    }
}

/// How an update fits, to be put behind how it ended; empty where that was not found out.
pub(super) fn fit_in_words(update: &Update) -> String {
    let Some(fit) = &update.fit else { return String::new() };
    match update.end {
        // a search that has not ended has no test, but its residual against a known noise is of use
        UpdateEnd::StepsSpent if !fit.fits && fit.degrees > 0 && fit.from == NoiseFrom::Stated => {
            format!(", fails the chi-square test where it stands: {}", unexplained(update, fit))
        }
        UpdateEnd::Unobservable { .. } | UpdateEnd::Lost(_) | UpdateEnd::StepsSpent => String::new(),
        _ if fit.fits => format!(", {}", explained(fit)),
        _ => format!(", fails the {}: {}", test_name(fit), unexplained(update, fit)),
    }
}

/// What is tested: against a stated noise the size of the residuals, else whether they are white.
fn test_name(fit: &Fit) -> &'static str {
    match fit.from {
        NoiseFrom::Stated => "chi-square test",
        _ => "whiteness test",
    }
}

fn explained(fit: &Fit) -> String {
    match fit.from {
        NoiseFrom::Stated => format!("passes the chi-square test ({})", p_in_words(fit.probability)),
        NoiseFrom::Residual => format!("passes the whiteness test (residuals of {:.1e})", fit.sigma),
        NoiseFrom::Untested => {
            format!("too few measurements to test the residuals; their size is {:.1e}", fit.sigma)
        }
        NoiseFrom::Computation => "residuals are rounding errors".to_owned(),
    }
}

/// Why a residual is not explained.
pub(super) fn unexplained(update: &Update, fit: &Fit) -> String {
    let (rms_residual, probability) = (update.rms_residual, fit.probability);
    match fit.from {
        _ if fit.degrees == 0 => "there are no more measurements than unknowns".to_owned(),
        NoiseFrom::Stated if fit.has_outliers() => {
            format!("more than a tenth are outliers, {}", counted(fit.outliers, "measurement"))
        }
        NoiseFrom::Stated if fit.by_drift().is_some() => format!(
            "residuals of {rms_residual:.1e} for a noise of {:.1e}, and they drift, those of {} most: {}",
            fit.sigma,
            update.drifting.as_deref().unwrap_or("an output"),
            p_in_words(probability)
        ),
        NoiseFrom::Stated if fit.is_by_neighbours() => format!(
            "residuals of {rms_residual:.1e} for a noise of {:.1e}, correlated with their neighbours: {}",
            fit.sigma,
            p_in_words(probability)
        ),
        NoiseFrom::Stated => {
            format!(
                "residuals of {rms_residual:.1e} for a noise of {:.1e}: {}",
                fit.sigma,
                p_in_words(probability)
            )
        }
        _ => format!(
            "the residuals, {rms_residual:.1e}, are no white noise (neighbours so alike have the probability {probability:.1e})"
        ),
    }
}

/// Whether the least error that is noticed is small enough to be reported: below 100 %, or 1 s.
fn is_told(suspect: &Suspect) -> bool {
    suspect.noticed.is_some_and(|noticed| noticed < 1.0)
}

/// What the measurements of an update say of all that is taken for known.
pub(super) fn suspects_in_words(update: &Update) -> Vec<String> {
    let mut lines = Vec::new();
    let (told, hidden): (Vec<&Suspect>, Vec<&Suspect>) =
        update.suspects.iter().partition(|suspect| is_told(suspect));
    if !told.is_empty() {
        let words = |suspect: &&Suspect| {
            format!("{suspect} {}", suspect.in_words(suspect.noticed.unwrap_or(f64::INFINITY)))
        };
        let words: Vec<String> = told.iter().map(words).collect();
        lines.push(format!("errors that are noticed (99 of 100) begin at: {}", words.join(", ")));
    }
    let (large, never): (Vec<&Suspect>, Vec<&Suspect>) =
        hidden.into_iter().partition(|suspect| suspect.noticed.is_some());
    for (suspects, words) in [
        (large, "errors that are noticed from 100 % (1 s) on only"),
        (never, "errors that cannot be distinguished from what is estimated"),
    ] {
        let names: Vec<String> = suspects.iter().map(ToString::to_string).collect();
        if !names.is_empty() {
            lines.push(format!("{words}: {}", names.join(", ")));
        }
    }
    let mut named: Vec<&str> = Vec::new();
    for suspect in &told {
        let name = suspect.to_string();
        if !suspect.same_as.is_empty() && !named.contains(&name.as_str()) {
            lines.push(format!("{name} cannot be distinguished from {}", suspect.same_as.join(", ")));
            named.extend(suspect.same_as.iter().map(String::as_str));
        }
    }
    if update.end == UpdateEnd::DoesNotFit
        && let Some(fit) = &update.fit
    {
        let best = told.iter().max_by(|a, b| a.explains.1.total_cmp(&b.explains.1));
        if let Some(best) = best {
            let (error, part) = (best.in_words(best.explains.0), 100.0 * best.explains.1 / fit.chi_square);
            lines.push(format!(
                "of these {best} explains most, off by about {error}: to first order {part:.0} % of the squared residuals"
            ));
        }
    }
    lines
}

/// A suspect as JSON.
pub(super) fn suspect_json(names: &[&str], suspect: &Suspect) -> Value {
    let shifts: Map<String, Value> =
        names.iter().zip(&suspect.shifts).map(|(name, shift)| ((*name).to_owned(), finite(*shift))).collect();
    json!({
        "what": suspect.to_string(),
        "noticed_from": suspect.noticed.map_or(Value::Null, finite),
        "same_as": suspect.same_as,
        "shifts": shifts,
        "would_explain": { "error": finite(suspect.explains.0), "chi_square": finite(suspect.explains.1) },
    })
}

#[cfg(test)]
mod tests {
    use super::{explained, p_in_words};
    use palmistry_observe::{Fit, NoiseFrom};

    #[test]
    fn a_probability_has_its_digits() {
        let words = [0.43, 0.0021, 2.1e-7, 0.0].map(p_in_words);
        assert_eq!(words, ["p = 0.43", "p = 0.0021", "p = 2.1e-7", "p below 1e-300"]);
    }

    /// What was not tested is not called noise.
    #[test]
    fn residuals_that_were_not_tested_are_called_so() {
        let fit = Fit {
            chi_square: 5.0,
            degrees: 5,
            probability: 1.0,
            outliers: 0,
            measurements: 7,
            squares: None,
            neighbours: None,
            drift: None,
            sigma: 0.5,
            from: NoiseFrom::Untested,
            fits: true,
        };
        assert_eq!(explained(&fit), "too few measurements to test the residuals; their size is 5.0e-1");
        let noise = Fit { from: NoiseFrom::Residual, ..fit };
        assert_eq!(explained(&noise), "passes the whiteness test (residuals of 5.0e-1)");
    }
}
