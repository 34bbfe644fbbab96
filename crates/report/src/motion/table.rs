//! What each observer found, as tables: at the end, update by update, and what was unobservable.

use crate::motion::answers::{Observed, end_name, state_name, worth_in_words};
use crate::motion::fit::{p_in_words, suspects_in_words, unexplained};
use crate::motion::verdicts::{innovations_in_words, verdict_lines};
use maud::{Markup, html};
use palmistry_observe::{Update, UpdateEnd};
use palmistry_scenes::Answer;

/// More updates than these are in the JSON only.
const MOST_UPDATES: usize = 60;

fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.0} µs", s * 1e6),
        s if s < 1.0 => format!("{:.0} ms", s * 1e3),
        s => format!("{s:.1} s"),
    }
}

/// Whether times are kept.
fn is_timed(observed: &Observed<'_>) -> bool {
    observed.answers.iter().all(|answer| !answer.seconds.is_nan())
}

/// The update in the middle, by time.
fn median(answer: &Answer) -> Option<&Update> {
    let mut updates: Vec<&Update> = answer.track.updates.iter().collect();
    updates.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    updates.get(updates.len() / 2).copied()
}

/// How the time of an update compares with the time that its window covers; nothing where no times are kept.
pub(super) fn pace(observed: &Observed<'_>, answer: &Answer) -> Option<String> {
    if answer.seconds.is_nan() {
        return None;
    }
    let times = observed.experiment.signals.times();
    let covered = times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first);
    Some(match median(answer) {
        Some(update) => {
            let window = update.to - update.from;
            let verdict = if update.seconds < window { "fast enough" } else { "too slow" };
            let steps = times.iter().filter(|time| (update.from..update.to).contains(*time)).count();
            format!(
                "one update of the {steps}-step window takes {}, the window covers {}: {verdict} to keep up",
                duration(update.seconds),
                duration(window)
            )
        }
        None => format!("{} for {} of motion", duration(answer.seconds), duration(covered)),
    })
}

/// Each method at the last sample, and whether it keeps up with the motion.
pub(super) fn ends(observed: &Observed<'_>) -> Markup {
    let names = observed.experiment.names();
    let timed = is_timed(observed);
    let known = observed.experiment.simulated().is_some();
    html! {
        div.scroll { table {
            thead { tr {
                th { "method" } th { "at" }
                @for name in &names { th { (state_name(observed, name)) } @if known { th { "error" } } th { "bound" } }
                th { "updates that converged and fit" } @if timed { th { "time" } }
            } }
            tbody {
                @for answer in observed.answers {
                    @let converged = answer.track.updates.iter().filter(|u| u.end == UpdateEnd::Converged).count();
                    tr {
                        td { b { (answer.method.name()) } }
                        @if let Some(last) = answer.track.last() {
                            @let truth = observed.experiment.truth_at(last.time);
                            td.n { (format!("{:.3} s", last.time)) }
                            @for (place, value) in last.state.iter().enumerate() {
                                td.n { (format!("{value:.6}")) }
                                @if known { td.n {
                                    (truth.as_ref().map_or("-".to_owned(), |truth| format!("{:.1e}", (value - truth[place]).abs())))
                                } }
                                td.n { (last.deviations.get(place).map_or("-".to_owned(), |own| bound_in_words(*own))) }
                            }
                        } @else { td colspan=(1 + names.len() * if known { 3 } else { 2 }) { "no estimate" } }
                        td.n {
                            @if answer.track.updates.is_empty() { (tested(answer)) }
                            @else { (converged) " of " (answer.track.updates.len()) }
                        }
                        @if let Some(pace) = pace(observed, answer) { td.w { (pace) } }
                    }
                }
                @if let (true, Some(truth)) = (known, last_truth(observed)) {
                    tr {
                        td { "true" } td {}
                        @for value in truth { td.n { (format!("{value:.6}")) } td {} td {} }
                        td {} @if timed { td {} }
                    }
                }
            }
        } }
        p.remark {
            @if known { "Errors and bounds are absolute, in the unit of the state; a bound is a standard deviation. " }
            @else { "A bound is a standard deviation, in the unit of the state. " }
            @if timed { "Times are wall times of this run." }
        }
    }
}

/// Whether a method without updates passes a test of its own.
fn tested(answer: &Answer) -> String {
    match answer.track.innovations {
        Some(own) if own.fits => format!("innovations pass ({})", p_in_words(own.probability)),
        Some(own) => format!("innovations fail ({})", p_in_words(own.probability)),
        None => "not tested".to_owned(),
    }
}

fn bound_in_words(value: f64) -> String {
    if value.is_finite() { format!("{value:.1e}") } else { "unobservable".to_owned() }
}

fn last_truth(observed: &Observed<'_>) -> Option<Vec<f64>> {
    observed.experiment.truth_at(*observed.experiment.signals.times().last()?)
}

/// Every update of the methods that work by windows, a row a state.
pub(super) fn updates(observed: &Observed<'_>) -> Markup {
    html! {
        @for answer in observed.answers.iter().filter(|answer| !answer.track.updates.is_empty()) {
            h3 { (answer.method.name()) @if let Some(pace) = pace(observed, answer) { ": " (pace) } }
            (update_table(observed, answer))
            p.remark {
                "The state is that at the window's first sample; the bound is its least standard deviation. Steps that had to be "
                "shortened, refused or replaced are counted as mended."
            }
            @if answer.track.updates.len() > MOST_UPDATES {
                p.remark { "The first " (MOST_UPDATES) " of " (answer.track.updates.len()) " updates; the JSON has them all." }
            }
        }
    }
}

fn update_table(observed: &Observed<'_>, answer: &Answer) -> Markup {
    let names = observed.experiment.names();
    let timed = is_timed(observed);
    let known = observed.experiment.simulated().is_some();
    html! {
        div.scroll { table {
            thead { tr {
                th { "window" } th { "it" } th { "steps" } @if timed { th { "time" } } th { "state" } th { "recovered" }
                @if known { th { "true" } th { "off by" } }
                th { "bound" } @if known { th { "off by, in bounds" } }
            } }
            tbody { @for update in answer.track.updates.iter().take(MOST_UPDATES) {
                @let truth = observed.experiment.truth_at(update.from);
                @for (place, name) in names.iter().enumerate() {
                    @let (value, deviation) = (update.estimate[place], update.deviations[place]);
                    tr {
                        @if place == 0 {
                            td.n rowspan=(names.len()) { (format!("{:.3} to {:.3} s", update.from, update.to)) }
                            td rowspan=(names.len()) { (end_name(&update.end)) }
                            td.n rowspan=(names.len()) {
                                (update.steps) @if update.troubled > 0 { " (" (update.troubled) " mended)" }
                            }
                            @if timed { td.n rowspan=(names.len()) { (duration(update.seconds)) } }
                        }
                        td { (state_name(observed, name)) }
                        td.n { (format!("{value:.9}")) }
                        @if known { @match &truth {
                            Some(truth) => {
                                td.n { (format!("{:.9}", truth[place])) }
                                td.n { (format!("{:.1e}", (value - truth[place]).abs())) }
                            }
                            None => { td { "-" } td { "-" } }
                        } }
                        td.n {
                            (worth_in_words(update).trim_start()) " "
                            (bound_in_words(deviation))
                            @if let Some((_, bound)) = update.at_bounds.iter().find(|own| own.0 == place) { ", held at " (bound) }
                        }
                        @if known { td.n { @match &truth {
                            Some(truth) if deviation.is_finite() && deviation > 0.0 && worth_in_words(update).is_empty() => {
                                (format!("{:.1}", (value - truth[place]).abs() / deviation))
                            }
                            _ => { "-" }
                        } } }
                    }
                }
            } }
        } }
    }
}

/// The samples that were unobservable or could not be followed, and what else the observers report.
pub(super) fn notes(observed: &Observed<'_>) -> Markup {
    let samples = observed.experiment.signals.times().len();
    let mut lines = Vec::new();
    for answer in observed.answers {
        let name = answer.method.name();
        if answer.track.unobserved > 0 {
            lines.push(format!(
                "{name}: the state was not observable at {} of {samples} samples, where the last estimate was held or integrated",
                answer.track.unobserved
            ));
        }
        for update in &answer.track.updates {
            let from = update.from;
            match &update.end {
                UpdateEnd::Unobservable { weakest } => {
                    lines.push(format!("{name} from {from:.3} s: {}", blind(observed, update, weakest)));
                }
                UpdateEnd::Converged => {}
                UpdateEnd::DoesNotFit => {
                    let why = update.fit.map_or_else(String::new, |fit| unexplained(update, &fit));
                    lines.push(format!("{name} from {from:.3} s: {}: {why}", end_name(&update.end)));
                }
                _ => lines.push(format!("{name} from {from:.3} s: {}", end_name(&update.end))),
            }
        }
        lines.extend(
            answer.track.updates.iter().flat_map(suspects_in_words).map(|line| format!("{name}: {line}")),
        );
        for other in &answer.track.others {
            let state = observed.experiment.names().into_iter().zip(&other.estimate);
            let state: Vec<String> = state.map(|(name, value)| format!("{name} = {value:.6}")).collect();
            lines.push(format!(
                "{name} from {:.3} s: another state fits as well: {}",
                other.from,
                state.join(", ")
            ));
        }
        lines.extend(answer.track.remarks.iter().map(|remark| format!("{name}: {remark}")));
        let fails = answer.track.innovations.filter(|own| !own.fits);
        lines.extend(fails.map(|own| format!("{name}: {}", innovations_in_words(&own))));
        if answer.track.updates.is_empty() && answer.track.innovations.is_none() {
            lines.push(format!("{name}: its estimates are not tested against the measurements"));
        }
        if answer.track.together().is_some_and(|all| !all.fits) {
            lines.extend(verdict_lines(&answer.track).into_iter().map(|line| format!("{name}: {line}")));
        }
    }
    html! {
        @if lines.is_empty() {
            p { (all_is_well(observed)) }
        } @else {
            details open[lines.len() <= 12] {
                summary { "where the state was not observable or a method failed, and other remarks: " (lines.len()) }
                ul { @for line in &lines { li { (line) } } }
            }
        }
    }
}

/// What is said where nothing is wrong, of those methods that have it.
fn all_is_well(observed: &Observed<'_>) -> String {
    let answers = || observed.answers.iter();
    let updates = answers().any(|answer| !answer.track.updates.is_empty());
    let filters = answers().any(|answer| answer.track.innovations.is_some());
    let both = [
        updates.then_some("Every update converged and fits"),
        filters.then_some("the innovations of every filter pass the chi-square test"),
    ];
    let said: Vec<&str> = both.into_iter().flatten().collect();
    match said.is_empty() {
        true => "No method was tested.".to_owned(),
        false => {
            let said = said.join(", and ");
            let first = said[..1].to_uppercase();
            format!("{first}{}; at no sample was the state unobservable.", &said[1..])
        }
    }
}

/// The direction that the measurements of a window determine least, by the names of the estimated states.
fn blind(observed: &Observed<'_>, update: &Update, weakest: &[f64]) -> String {
    let experiment = observed.experiment;
    let first = experiment.signals.times().first() == Some(&update.from);
    // what the first window may not change has no part in the direction; measurements that are unknown come last
    let names = experiment.names();
    let clamped = |name: &str| first && experiment.question.clamped.iter().any(|other| other == name);
    let mut parts: Vec<(&str, f64)> =
        names.into_iter().filter(|name| !clamped(name)).zip(weakest.iter().copied()).collect();
    parts.retain(|(_, part)| part.abs() > 0.05);
    parts.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let sign = parts.first().map_or(1.0, |(_, part)| part.signum());
    let parts: Vec<String> = parts.iter().map(|(name, part)| format!("{:+.2} {name}", sign * part)).collect();
    match &parts[..] {
        [] => "what is estimated is not observable from the measurements of this window".to_owned(),
        parts => {
            format!("the measurements of this window determine {} least, each in its size", parts.join(" "))
        }
    }
}
