//! Fits of several experiments: text, JSON, tables, and a page with what was measured beside what is expected.

mod page;
mod plot;
mod tables;

use crate::layout::{counted_in, in_columns};
pub use page::joint_page;
pub(crate) use page::joint_section;
use palmistry_fit::{
    EstimatedParameter, JointFit, ParameterProfile, ParameterScale, SimulatedExperiments, StartEnd,
};
use palmistry_scenes::joint::{JointAnswer, JointExperiments};
use serde_json::{Value, json};
use std::fmt::Write;
pub use tables::{joint_parameters, joint_simulation};

/// A fit and what it was made from.
#[derive(Clone, Copy)]
pub struct JointObserved<'a> {
    /// The scene with its measurements.
    pub experiments: &'a JointExperiments,
    /// What came of it.
    pub answer: &'a JointAnswer,
    /// Whether it was interrupted.
    pub interrupted: bool,
}

impl<'a> JointObserved<'a> {
    /// Of a fit that came to its end.
    pub fn of(experiments: &'a JointExperiments, answer: &'a JointAnswer) -> JointObserved<'a> {
        JointObserved { experiments, answer, interrupted: false }
    }
}

/// Columns of a line of text.
const WIDTH: usize = 80;

/// Half of an interval of 95 %, in deviations.
const HALF: f64 = 1.959_964;

/// A parameter is poorly determined where half of its interval of 95 % is more than this part of a decade, or of its value on a linear scale.
const POOR: f64 = 0.5;

/// With fewer measurements than this beyond one for each parameter, intervals of 95 % hold the truth noticeably less often.
const FEW: f64 = 10.0;

/// What is known of a parameter, by its profile where that came to its ends, else by the information at the best parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Standing {
    Determined,
    Poorly,
    /// Other values explain the measurements as well, and lie apart.
    Several,
    /// The interval of 95 % goes beyond the bounds, or no measurement determines it.
    Undetermined,
    AtBound,
    /// The search has not converged: there is something better, and the information there has no meaning.
    NotEnded,
}

impl Standing {
    fn word(self) -> &'static str {
        match self {
            Standing::Determined => "determined",
            Standing::Poorly => "poorly determined",
            Standing::Several => "several values",
            Standing::Undetermined => "not determined",
            Standing::AtBound => "at a bound",
            Standing::NotEnded => "search not ended",
        }
    }

    fn of(
        parameter: &EstimatedParameter,
        scaled: f64,
        deviation: Option<f64>,
        interval: Option<[f64; 2]>,
        is_at_bound: bool,
    ) -> Standing {
        let Some(deviation) = deviation.filter(|_| !is_at_bound) else { return Standing::AtBound };
        let [low, high] = parameter.scaled_bounds();
        // the wider of the two is believed
        let by_profile = interval.map_or(0.0, |[from, to]| (scaled - from).max(to - scaled));
        let half = (HALF * deviation).max(by_profile);
        let wide = match parameter.scale {
            ParameterScale::Linear => POOR * scaled.abs(),
            ParameterScale::Log => POOR * std::f64::consts::LN_10,
            ParameterScale::Log10 => POOR,
        };
        match half {
            _ if half <= wide => Standing::Determined,
            _ if interval.is_some() || low <= scaled - half && scaled + half <= high => Standing::Poorly,
            _ => Standing::Undetermined,
        }
    }
}

/// The best value of a parameter.
struct Entry<'a> {
    parameter: &'a EstimatedParameter,
    scaled: f64,
    /// On its scale.
    deviation: Option<f64>,
    standing: Standing,
    profile: Option<&'a ParameterProfile>,
    /// Its values at other ends that explain the measurements as well.
    others: Vec<f64>,
}

impl Entry<'_> {
    fn value(&self) -> f64 {
        self.parameter.scale.value(self.scaled)
    }

    /// The ends of the interval of 95 % by the profile, as values.
    fn interval(&self) -> Option<[Option<f64>; 2]> {
        self.profile.map(|own| own.interval.map(|end| end.map(|end| self.parameter.scale.value(end))))
    }

    /// The same as text: an end that is not met before the bound is open, and of a profile that was cut off it is unknown.
    fn interval_words(&self) -> Option<[String; 2]> {
        let (ends, cut_off) = (self.interval()?, self.profile?.cut_off);
        let word = |side: usize| match ends[side] {
            Some(end) => short(end),
            None if cut_off[side] => "cut off".to_owned(),
            None => "open".to_owned(),
        };
        Some([word(0), word(1)])
    }
}

fn entries<'a>(observed: &JointObserved<'a>) -> Vec<Entry<'a>> {
    let Some(Ok(fit)) = &observed.answer.fit else { return Vec::new() };
    let has_ended = fit.best().end == StartEnd::Converged;
    let entry = |(place, parameter): (usize, &'a EstimatedParameter)| {
        let deviation =
            observed.answer.information.as_ref().and_then(|own| own.deviations.get(place).copied().flatten());
        let is_at_bound = observed.answer.at_bounds.get(place) == Some(&true);
        let scaled = fit.best().found[place];
        let profile = observed.answer.profiles.iter().find(|own| own.parameter == place);
        let is_open =
            profile.is_some_and(|own| (0..2).any(|side| own.interval[side].is_none() && !own.cut_off[side]));
        let interval = profile.and_then(|own| Some([own.interval[0]?, own.interval[1]?]));
        let others = observed.answer.information.as_ref().map_or(Vec::new(), |information| {
            let scaled = fit.other_values(information, &observed.answer.apart, place);
            scaled.into_iter().map(|value| parameter.scale.value(value)).collect()
        });
        let standing = match has_ended {
            false => Standing::NotEnded,
            true if is_open && !is_at_bound => Standing::Undetermined,
            true if !others.is_empty() => Standing::Several,
            true => Standing::of(parameter, scaled, deviation, interval, is_at_bound),
        };
        Entry { parameter, scaled, deviation: deviation.filter(|_| has_ended), standing, profile, others }
    };
    observed.experiments.problem().parameters.iter().enumerate().map(entry).collect()
}

/// A number of four digits.
fn short(value: f64) -> String {
    match value.abs() {
        size if value == 0.0 || (1e-3..1e5).contains(&size) => {
            let decimals = (3.0 - size.max(1e-300).log10().floor()).clamp(0.0, 6.0) as usize;
            format!("{value:.decimals$}")
        }
        _ => format!("{value:.3e}"),
    }
}

/// A value with its deviation: on a logarithmic scale by a factor.
fn with_deviation(entry: &Entry<'_>) -> String {
    let spread = match (entry.deviation, entry.parameter.scale) {
        (None, _) => return String::new(),
        (Some(deviation), _) if !deviation.is_finite() => return "infinite".to_owned(),
        (Some(deviation), ParameterScale::Linear) => return format!("± {}", short(deviation)),
        (Some(deviation), ParameterScale::Log) => deviation,
        (Some(deviation), ParameterScale::Log10) => deviation * std::f64::consts::LN_10,
    };
    match spread {
        small if small < 0.2 => format!("± {:.2} %", 100.0 * small),
        _ if spread < 7.0 => format!("×/÷ {:.2}", spread.exp()),
        _ => format!("×/÷ 1e{:.0}", spread / std::f64::consts::LN_10),
    }
}

/// A direction as text: the parameters that take part, on their scales.
fn direction_words(observed: &JointObserved<'_>, parts: &[(usize, f64)]) -> String {
    let parameters = &observed.experiments.problem().parameters;
    let one = |(place, part): &(usize, f64)| {
        let parameter = &parameters[*place];
        let name = match parameter.scale {
            ParameterScale::Linear => parameter.name.clone(),
            scale => format!("{}({})", scale.word(), parameter.name),
        };
        format!("{part:+.2} {name}")
    };
    let all: Vec<String> = parts.iter().take(6).map(one).collect();
    let rest = if parts.len() > 6 { " ..." } else { "" };
    format!("{}{rest}", all.join(" "))
}

/// Directions known no better than by half of a decade, or a unit of a linear scale, the worst first.
fn weak<'a>(observed: &JointObserved<'a>) -> Vec<&'a palmistry_fit::WeakDirection> {
    let has_ended = matches!(&observed.answer.fit, Some(Ok(fit)) if fit.best().end == StartEnd::Converged);
    let Some(information) = observed.answer.information.as_ref().filter(|_| has_ended) else {
        return Vec::new();
    };
    information.directions.iter().filter(|one| one.deviation > 0.5).take(5).collect()
}

fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

fn end_word(end: &StartEnd) -> &'static str {
    match end {
        StartEnd::Converged => "converged",
        StartEnd::StepsSpent => "steps spent",
        StartEnd::Stuck => "stuck",
        StartEnd::NoStart(_) => "no start",
        StartEnd::Interrupted => "interrupted",
    }
}

/// What was fitted, in a line.
fn heading(observed: &JointObserved<'_>) -> String {
    let problem = observed.experiments.problem();
    let outputs: std::collections::BTreeSet<&str> =
        problem.measurements.iter().map(|one| one.output.as_str()).collect();
    format!(
        "{} of {} in {}; {}",
        count(problem.measurements.len(), "measurement"),
        count(outputs.len(), "output"),
        count(problem.experiments.len(), "experiment"),
        count(problem.parameters.len(), "parameter")
    )
}

/// What the searches came to, in sentences.
fn ending(observed: &JointObserved<'_>) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(nominal) = &observed.answer.nominal {
        lines.push(match &nominal.simulated {
            Ok(found) => format!(
                "at the nominal values: log-likelihood {:.4}, chi-square {}",
                found.log_likelihood,
                short(found.chi_square)
            ),
            Err(why) => format!("at the nominal values nothing can be expected: {why}"),
        });
    }
    match &observed.answer.fit {
        None => {}
        Some(Err(why)) => lines.push(format!("nothing was found: {why}")),
        Some(Ok(fit)) => {
            let [random, near] = fit.arrived(&observed.answer.apart);
            let others = fit.searches.len() - fit.random;
            lines.push(format!(
                "best: log-likelihood {:.4}, chi-square {}",
                fit.simulated.log_likelihood,
                short(fit.simulated.chi_square)
            ));
            let beside = match others {
                0 => String::new(),
                _ => format!(", {near} of {others} from near it"),
            };
            lines.push(format!(
                "{random} of {} searches from random starts come to it (within 0.1){beside}",
                fit.random
            ));
            if !observed.answer.apart.is_empty() {
                lines.push(format!(
                    "searches that ended elsewhere, where the measurements are explained as well: {} (log-likelihood lower by less than 1.92); parameters with several values have those too",
                    observed.answer.apart.len()
                ));
            }
            if fit.best == fit.random && is_from_the_nominal_values(observed, fit) {
                lines.push(
                    "no search from a random start came as far as the one from the nominal values: ask for more starts under [search]"
                        .to_owned(),
                );
            }
            let free =
                observed.experiments.problem().measurements.len() as f64 - fit.best().found.len() as f64;
            if free < FEW {
                lines.push(format!(
                    "{} for {}: standard deviations and intervals are right for many measurements, and too narrow for so few",
                    count(observed.experiments.problem().measurements.len(), "measurement"),
                    count(fit.best().found.len(), "parameter")
                ));
            }
            if fit.best().end != StartEnd::Converged {
                lines.push(format!(
                    "the best search did not converge ({}): ask for more steps under [search]",
                    end_word(&fit.best().end)
                ));
            }
            if random <= 1 && fit.random > 1 && observed.answer.apart.is_empty() && !observed.interrupted {
                lines.push(
                    "few searches came there: ask for more starts under [search] to be sure of it".to_owned(),
                );
            }
            let better = observed.answer.profiles.iter().map(|own| own.better).fold(0.0, f64::max);
            if better > 0.1 {
                lines.push(format!(
                    "a profile met parameters whose log-likelihood is larger by {}: the best is not the best there is; ask for more starts under [search]",
                    short(better)
                ));
            }
            lines.push(match &observed.answer.goodness {
                Some(own) => format!(
                    "{} the chi-square test: {} with {} (p = {:.2e})",
                    if own.fits() { "passes" } else { "fails" },
                    short(own.chi_square),
                    counted_in(own.degrees, "degree of freedom", "degrees of freedom"),
                    own.probability,
                ),
                None if fit.best().end != StartEnd::Converged => "no test of fit: the search came to no end".to_owned(),
                None => "no test of fit: the size of the errors is estimated, or they are not normal, there are priors, or too few measurements".to_owned(),
            });
        }
    }
    lines
}

/// Whether the search that came farthest began at the nominal values.
fn is_from_the_nominal_values(observed: &JointObserved<'_>, fit: &JointFit) -> bool {
    observed.answer.nominal.as_ref().is_some_and(|nominal| nominal.place == fit.best().start)
}

/// The answer as text.
pub fn joint_text(observed: &JointObserved<'_>) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "{}\n{}", observed.experiments.scene.title, heading(observed));
    let options = textwrap::Options::new(WIDTH).subsequent_indent("  ");
    for line in ending(observed) {
        let _ = writeln!(out, "{}", textwrap::fill(&line, &options));
    }
    let all = entries(observed);
    if !all.is_empty() {
        let width = all.iter().map(|entry| entry.parameter.name.chars().count()).max().unwrap_or(0).max(9);
        let _ = writeln!(out, "\n  {:width$}  {:>12}  {:>14}", "parameter", "value", "deviation");
        for entry in &all {
            let _ = write!(
                out,
                "  {:width$}  {:>12}  {:>14}  {}",
                entry.parameter.name,
                short(entry.value()),
                with_deviation(entry),
                entry.standing.word()
            );
            if !entry.others.is_empty() {
                let others: Vec<String> = entry.others.iter().take(4).map(|value| short(*value)).collect();
                let _ = write!(out, "; also {}", others.join(", "));
            }
            if let Some([low, high]) = entry.interval_words() {
                let _ = write!(out, "; 95 %: {low} to {high}");
            }
            out.push('\n');
        }
        let weak = weak(observed);
        if !weak.is_empty() {
            let _ = writeln!(
                out,
                "\ndirections that the measurements hardly determine (unit steps on the scales):"
            );
            for one in weak {
                let deviation =
                    if one.deviation.is_finite() { short(one.deviation) } else { "infinite".to_owned() };
                let _ = writeln!(out, "  deviation {deviation}: {}", direction_words(observed, &one.parts));
            }
        }
    }
    if observed.interrupted {
        let _ = writeln!(out, "\ninterrupted: this is what was found until then");
    }
    if let Some(next) = next_in_words(observed) {
        let _ = writeln!(out, "try next: {next}");
    }
    in_columns(out.trim_end())
}

/// What to try where there is no plain success; of searches that came to no end it is said where they are counted.
fn next_in_words(observed: &JointObserved<'_>) -> Option<&'static str> {
    match (&observed.answer.fit, &observed.answer.goodness) {
        (Some(Err(_)), _) => Some("other bounds of the parameters, or more starts under [search]"),
        (_, Some(own)) if !own.fits() => Some(
            "another model, larger errors of the measurements if they have them, or more starts under [search]",
        ),
        _ => None,
    }
}

/// A number of JSON; none where it is no finite one.
fn finite(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

fn measurements_json(observed: &JointObserved<'_>, simulated: &SimulatedExperiments) -> Value {
    let problem = observed.experiments.problem();
    let rows = problem.measurements.iter().enumerate().map(|(row, one)| {
        json!({
            "experiment": problem.experiments[one.experiment].name,
            "output": one.output,
            "time": finite(one.time),
            "value": one.value,
            "expected": simulated.expected[row],
            "deviation": simulated.sizes[row],
            "residual": simulated.residuals[row],
        })
    });
    Value::Array(rows.collect())
}

fn simulated_json(observed: &JointObserved<'_>, simulated: &SimulatedExperiments) -> Value {
    json!({
        "log_likelihood": simulated.log_likelihood,
        "objective": simulated.objective,
        "chi_square": simulated.chi_square,
        "measurements": measurements_json(observed, simulated),
    })
}

/// The answer as JSON.
pub fn joint_json(observed: &JointObserved<'_>) -> Value {
    let problem = observed.experiments.problem();
    let answer = observed.answer;
    let parameters: Vec<Value> = entries(observed)
        .iter()
        .map(|entry| {
            json!({
                "name": entry.parameter.name,
                "scale": entry.parameter.scale.word(),
                "bounds": entry.parameter.bounds,
                "nominal": entry.parameter.nominal,
                "value": entry.value(),
                "scaled": entry.scaled,
                "deviation": entry.deviation.map(finite),
                "status": entry.standing.word(),
                "other_values": entry.others,
                "interval": entry.interval().map(|ends| ends.map(|end| end.map(finite))),
            })
        })
        .collect();
    let nominal = answer.nominal.as_ref().map(|own| match &own.simulated {
        Ok(found) => simulated_json(observed, found),
        Err(why) => json!({ "why_not": why }),
    });
    let (best, searches, why_not) = match &answer.fit {
        None => (Value::Null, Vec::new(), Value::Null),
        Some(Err(why)) => (Value::Null, Vec::new(), json!(why)),
        Some(Ok(fit)) => {
            let mut best = simulated_json(observed, &fit.simulated);
            let free = answer.at_bounds.iter().filter(|is_at| !**is_at).count();
            let [random, near] = fit.arrived(&answer.apart);
            best["arrived"] = json!({ "from_random_starts": random, "from_near_it": near });
            best["random_starts"] = json!(fit.random);
            best["aic"] = json!(2.0 * problem.parameters.len() as f64 - 2.0 * fit.simulated.log_likelihood);
            best["bic"] = json!(
                (problem.measurements.len() as f64).ln() * problem.parameters.len() as f64
                    - 2.0 * fit.simulated.log_likelihood
            );
            best["parameters_off_bounds"] = json!(free);
            let searches = fit.searches.iter().map(|one| {
                json!({
                    "objective": finite(one.objective),
                    "steps": one.steps,
                    "end": end_word(&one.end),
                    "start": one.start,
                    "found": one.found,
                })
            });
            (best, searches.collect(), Value::Null)
        }
    };
    let directions: Vec<Value> = answer
        .information
        .iter()
        .flat_map(|own| &own.directions)
        .map(|one| {
            let parts: serde_json::Map<String, Value> = one
                .parts
                .iter()
                .map(|(place, part)| (problem.parameters[*place].name.clone(), json!(part)))
                .collect();
            json!({ "deviation": finite(one.deviation), "parts": parts })
        })
        .collect();
    let profiles: Vec<Value> = answer
        .profiles
        .iter()
        .map(|own| {
            json!({
                "parameter": problem.parameters[own.parameter].name,
                "points": own.points,
                "interval": own.interval.map(|end| end.map(finite)),
                "cut_off": own.cut_off,
                "better_by": own.better,
            })
        })
        .collect();
    json!({
        "title": observed.experiments.scene.title,
        "kind": "experiments",
        "seed": observed.experiments.scene.seed,
        "experiments": problem.experiments.iter().map(|one| &one.name).collect::<Vec<_>>(),
        "parameters": parameters,
        "nominal": nominal,
        "best": best,
        "why_not": why_not,
        "searches": searches,
        "goodness_of_fit": answer.goodness.map(|own| json!({
            "chi_square": own.chi_square,
            "degrees": own.degrees,
            "probability": own.probability,
            "fits": own.fits(),
        })),
        "directions": directions,
        "profiles": profiles,
        "interrupted": observed.interrupted,
    })
}
