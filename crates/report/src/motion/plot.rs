//! What observers made of an experiment, over time: as figure 4.4, and the errors beside the Cramér-Rao bound.

use crate::axis::{axis, unit_of};
use crate::motion::answers::Observed;
use crate::motion::curves::{Curve, Frame, Shown, draw};
use palmistry_scenes::Answer;
use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

/// Errors below this are drawn there.
const LEAST: f64 = 1e-17;

/// A name with the unit that its model declares for it.
pub(super) fn with_unit(observed: &Observed<'_>, name: &str) -> String {
    axis(name, unit_of(&observed.experiment.system, name).as_deref())
}

fn times(observed: &Observed<'_>) -> (f64, f64) {
    let times = observed.experiment.signals.times();
    let (first, last) = (times.first().copied().unwrap_or(0.0), times.last().copied().unwrap_or(1.0));
    (first, if last > first { last } else { first + 1.0 })
}

/// Where windows end, of all methods that work by windows.
fn limits(observed: &Observed<'_>) -> Vec<f64> {
    let updates = observed.answers.iter().flat_map(|answer| &answer.track.updates);
    let ends: BTreeSet<u64> = updates.map(|update| update.to.to_bits()).collect();
    ends.into_iter().map(f64::from_bits).collect()
}

/// The truth of a state, over time.
fn truth(observed: &Observed<'_>, name: &str) -> Vec<(f64, f64)> {
    let values = observed.experiment.truth(name);
    observed.experiment.signals.times().iter().copied().zip(values.unwrap_or_default()).collect()
}

/// A range that shows the truth and, as far as they come near it, the recovered values; of these most where there is no truth, with their bars unless these are longer than all that
/// there is to show.
fn range(truth: &[(f64, f64)], curves: &[Curve], bars: &[[f64; 2]]) -> (f64, f64) {
    let ends = |values: &[f64]| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        (low, values.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    };
    let recovered = curves.iter().flat_map(|curve| &curve.points).map(|point| point.1);
    let mut recovered: Vec<f64> = recovered.filter(|value| value.is_finite()).collect();
    recovered.sort_by(f64::total_cmp);
    let (low, high) = if truth.is_empty() {
        let rest = recovered.len() / 50;
        ends(&recovered[rest..recovered.len() - rest])
    } else {
        ends(&truth.iter().map(|point| point.1).collect::<Vec<_>>())
    };
    if low > high {
        return (0.0, 1.0);
    }
    let span = (high - low).max(0.2 * low.abs().max(high.abs())).max(1e-12);
    // how far the values in the middle are off: one method that runs away does not flatten the others
    let mut off: Vec<f64> = recovered.iter().map(|value| (low - value).max(value - high).max(0.0)).collect();
    off.sort_by(f64::total_cmp);
    let reach = off.get(off.len() / 2).map_or(0.0, |middle| 3.0 * middle).max(0.6 * span);
    let near = |value: &f64| *value > low - reach && *value < high + reach;
    let is_short = |[low, high]: &&[f64; 2]| truth.is_empty() && (high - low) / 2.0 <= span;
    let bars = bars.iter().filter(is_short).flatten().copied();
    let shown: Vec<f64> = recovered.into_iter().chain(bars).filter(near).chain([low, high]).collect();
    let (low, high) = ends(&shown);
    let room = 0.06 * (high - low).max(span / 2.0);
    (low - room, high + room)
}

/// About so many samples have a bound in a picture, beside those where windows begin.
const BOUNDS: usize = 40;

/// Time, value and standard deviation of a state, where an answer has them: where windows begin, and at samples between.
fn bounds(answer: &Answer, place: usize) -> Vec<(f64, f64, f64)> {
    let (estimates, updates) = (&answer.track.estimates, &answer.track.updates);
    let begins = updates.iter().map(|update| (update.from, update.estimate[place], update.deviations[place]));
    let step = (estimates.len() / BOUNDS).max(1);
    let between = estimates.iter().skip(step / 2).step_by(step);
    let between = between.filter_map(|at| Some((at.time, at.state[place], *at.deviations.get(place)?)));
    begins.chain(between).filter(|(_, _, deviation)| deviation.is_finite()).collect()
}

/// One state over time: true, and as each method recovered it, with two standard deviations of the Cramér-Rao bound.
pub(super) fn state(observed: &Observed<'_>, place: usize) -> String {
    let names = observed.experiment.names();
    let Some(name) = names.get(place) else { return String::new() };
    let truth = truth(observed, name);
    let recovered = |answer: &Answer| {
        let points = answer.track.estimates.iter().map(|moment| (moment.time, moment.state[place]));
        Curve::of_method(answer.method, points.collect())
    };
    let mut curves: Vec<Curve> = observed.answers.iter().map(recovered).collect();
    let mut bars = Vec::new();
    for answer in observed.answers {
        for (time, value, deviation) in bounds(answer, place) {
            let ends = (value - 2.0 * deviation, value + 2.0 * deviation);
            bars.push((Shown::Method(answer.method), time, ends.0, ends.1));
        }
    }
    let ends: Vec<[f64; 2]> = bars.iter().map(|(_, _, low, high)| [*low, *high]).collect();
    let range = range(&truth, &curves, &ends);
    if !truth.is_empty() {
        curves.insert(0, Curve::truth(truth));
    }
    let frame = Frame {
        title: format!("{name} over time"),
        vertical: with_unit(observed, name),
        times: times(observed),
        range,
        limits: &limits(observed),
        bars: &bars,
        ..Frame::default()
    };
    draw(&frame, &curves)
}

/// Decimal logarithms of sizes; what is zero or smaller than can be is drawn at the lower edge.
fn logarithms(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    points.map(|(time, value)| (time, value.abs().max(LEAST).log10())).collect()
}

/// A range of decades that holds most of what is finite, of all up to a thousand, and `also`.
fn decades(curves: &[Curve], also: impl Iterator<Item = f64>) -> (f64, f64) {
    let heights = curves.iter().flat_map(|curve| &curve.points).map(|point| point.1).chain(also);
    let mut heights: Vec<f64> = heights.filter(|height| height.is_finite()).collect();
    heights.sort_by(f64::total_cmp);
    // single crossings of zero would open decades
    let Some(low) = heights.get(heights.len() / 100) else { return (-10.0, 0.0) };
    let high = heights.last().copied().unwrap_or(0.0).min(3.0);
    let (low, high) = (low.floor().min(high - 1.0), high.ceil().max(low + 1.0));
    let room = (4.0 - (high - low)).max(0.0) / 2.0;
    (low - room.floor(), high + room.ceil())
}

/// The distance of each method's values from the truth over time, logarithmic, with the Cramér-Rao bound. None without a truth.
pub(super) fn errors(observed: &Observed<'_>, place: usize) -> Option<String> {
    let names = observed.experiment.names();
    let name = names.get(place)?;
    let truth = truth(observed, name);
    let at = |time: f64| truth.get(truth.partition_point(|point| point.0 < time)).map(|point| point.1);
    let error = |answer: &Answer| {
        let moments = answer.track.estimates.iter();
        let points = moments.filter_map(|moment| Some((moment.time, moment.state[place] - at(moment.time)?)));
        Curve::of_method(answer.method, logarithms(points))
    };
    let curves: Vec<Curve> = observed.answers.iter().map(error).collect();
    let mut dots = Vec::new();
    for answer in observed.answers {
        let seen = bounds(answer, place).into_iter().map(|(time, _, deviation)| (time, deviation));
        let seen = seen.filter(|(_, deviation)| *deviation > 0.0);
        dots.extend(
            logarithms(seen).into_iter().map(|(time, value)| (Shown::Method(answer.method), time, value)),
        );
    }
    let frame = Frame {
        title: format!("{name}: |recovered - true|"),
        vertical: with_unit(observed, name),
        times: times(observed),
        range: decades(&curves, dots.iter().map(|dot| dot.2)),
        logarithmic: true,
        limits: &limits(observed),
        dots: &dots,
        dots_are: "bound",
        ..Frame::default()
    };
    (!truth.is_empty()).then(|| draw(&frame, &curves))
}

/// The names of the outputs that the observers compare with measurements, in the order of their surprises, and the standard deviation
/// of these measurements: none where they have no error.
fn outputs(observed: &Observed<'_>) -> Option<(Vec<String>, Option<f64>)> {
    let never = AtomicBool::new(false);
    let task = observed.experiment.task(&never).ok()?;
    Some((task.full.outputs.clone(), (!task.exact).then_some(task.sigma)))
}

/// The root of the mean square in stretches of time with equally many samples: noise has no line of its own.
fn sizes(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    const STRETCHES: usize = 80;
    let root = |run: &[(f64, f64)]| {
        let count = run.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| run.iter().map(of).sum::<f64>() / count;
        (mean(&|point| point.0), mean(&|point| point.1 * point.1).sqrt())
    };
    points.chunks((points.len() / STRETCHES).max(5)).map(root).collect()
}

/// The sensor error, expected minus measured: of one method as it is, as figure 4.4d, and the size of every method's, an output each.
pub(super) fn sensor_errors(observed: &Observed<'_>) -> Vec<String> {
    let Some((names, sigma)) = outputs(observed) else { return Vec::new() };
    let surprises = |answer: &Answer, output: usize| -> Vec<(f64, f64)> {
        let moments = answer.track.estimates.iter();
        let measured = |value: &&f64| !value.is_nan();
        moments
            .filter_map(|moment| Some((moment.time, *moment.residual.get(output).filter(measured)?)))
            .collect()
    };
    let limits = limits(observed);
    let mut pictures = Vec::new();
    let by_windows = |answer: &&Answer| !answer.track.updates.is_empty();
    if let Some(answer) = observed.answers.iter().find(by_windows) {
        let output = |(place, name): (usize, &String)| Curve {
            shown: Shown::Output(place),
            name: name.clone(),
            points: surprises(answer, place),
        };
        let curves: Vec<Curve> = names.iter().enumerate().map(output).collect();
        let values = curves.iter().flat_map(|curve| &curve.points).map(|point| point.1.abs());
        let size = values.filter(|value| value.is_finite()).fold(0.0f64, f64::max).max(LEAST) * 1.08;
        let frame = Frame {
            title: format!("sensor error of {}: expected minus read", answer.method.name()),
            vertical: names
                .first()
                .and_then(|name| unit_of(&observed.experiment.system, name))
                .unwrap_or_default(),
            times: times(observed),
            range: (-size, size),
            limits: &limits,
            band: sigma
                .map(|sigma| ((-2.0 * sigma, 2.0 * sigma), "two standard deviations of a measurement")),
            ..Frame::default()
        };
        if curves.iter().any(|curve| !curve.points.is_empty()) {
            pictures.push(draw(&frame, &curves));
        }
    }
    for (place, name) in names.iter().enumerate() {
        let all = observed.answers.iter();
        let curve = |answer: &Answer| {
            Curve::of_method(answer.method, logarithms(sizes(&surprises(answer, place)).into_iter()))
        };
        let mut curves: Vec<Curve> = all.map(curve).collect();
        curves.retain(|curve| !curve.points.is_empty());
        if curves.is_empty() {
            continue;
        }
        let range = decades(&curves, sigma.iter().map(|sigma| sigma.log10()));
        let frame = Frame {
            title: format!("sensor error of {name}: rms in short stretches of time"),
            vertical: with_unit(observed, name),
            times: times(observed),
            range,
            logarithmic: true,
            limits: &limits,
            band: sigma
                .map(|sigma| ((range.0, sigma.log10()), "up to one standard deviation of a measurement")),
            ..Frame::default()
        };
        pictures.push(draw(&frame, &curves));
    }
    pictures
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: plus and minus three have the size three, whatever the noise between them.
    #[test]
    fn noise_has_its_size() {
        let points: Vec<(f64, f64)> =
            (0..4000).map(|i| (f64::from(i), if i % 2 == 0 { 3.0 } else { -3.0 })).collect();
        let found = sizes(&points);
        assert_eq!(found.len(), 80);
        assert!(found.iter().all(|(_, size)| *size == 3.0));
        assert_eq!(found[0].0, 24.5);
    }

    /// A curve that runs away does not flatten the others.
    #[test]
    fn a_range_follows_the_truth() {
        let truth = [(0.0, 1.0), (1.0, 2.0)];
        let curves = [Curve::truth(vec![(0.0, 0.9), (0.2, 1.5), (0.5, 1e9), (1.0, f64::NAN)])];
        let (low, high) = range(&truth, &curves, &[[-50.0, 50.0]]);
        assert!(low < 0.9 && low > 0.7 && high > 2.0 && high < 2.2, "{low} {high}");
        // a truth that stands still: what is beside it is shown
        let (low, high) =
            range(&[(0.0, 1.0), (1.0, 1.0)], &[Curve::truth(vec![(0.0, 1.5), (1.0, 1.6)])], &[]);
        assert!(low < 1.0 && high > 1.6, "{low} {high}");
        assert_eq!(range(&[], &[], &[]), (0.0, 1.0));
        // a constant that was estimated: its bars are shown, and one that is longer than all else is not
        let flat = [Curve::truth(vec![(0.0, 1.0), (1.0, 1.0)])];
        let (low, high) = range(&[], &flat, &[[0.97, 1.03], [-9.0, 11.0]]);
        assert!(low < 0.97 && low > 0.8 && high > 1.03 && high < 1.2, "{low} {high}");
    }
}
