//! Values that are far from what their neighbours foretell.
//!
//! The rule. A value is foretold in three ways, each time by the parabola of least squares through measurements that do
//! not include it: the five before it, the five after it, and the three on either side. Its departure from each is
//! divided by what that way does to unit white noise, which makes them alike, and the least of the three counts: a
//! corner, a step or the neighbour of a spike is foretold well from one side, a spike from none. The usual departure
//! is the upper quartile of these, divided by that of unit white noise, so that it is the noise's standard deviation
//! where there is nothing but white noise. In data without noise it would be next to nothing; so it is never taken
//! below a tenth of the usual change from measurement to measurement nearby, three tenths of the sensor's resolution, and
//! 1e-9 of the largest value. A value that departs by more than the threshold times this is a spike, the worst among
//! its neighbours first; it is taken out and the rest is judged anew, until no more are found.
//!
//! A fault returns to where it was, and a jump stays: what a body does that falls from one stable pose into another is none. So a value that lies between its neighbours is no
//! spike, nor one at a jump between two smooth stretches that belongs to either ([`stays`]).
//!
//! The first and the last value have neighbours on one side only. They are spikes where what is left without them is smooth there, and no change elsewhere in the
//! column is as large ([`is_alone`]): else they belong to a fast motion, or are another step of a command. For the same reason more than [`MOST_TOGETHER`] close
//! together are none where the measurements between them change as much as they are off: a motion that is faster than the samples ([`without_motion`]). A held command's first step may be its last value: there only what has neighbours on both
//! sides is judged.
//!
//! What follows: a spike has to be larger among the five measurements at either end, which are foretold less well; with
//! fewer than [`FEWEST`] measurements there is no judgement; where a quarter of the measurements or more are spikes, they are
//! what is usual; a measurement between two spikes can be taken for one too; several wrong measurements in a row that agree are
//! a step and no spikes.

use std::collections::BTreeSet;

/// Fewer measurements than this are not judged: the upper quartile of so few says little.
pub(super) const FEWEST: usize = 16;

/// The upper quartile of the least departure in evenly sampled white noise of unit standard deviation (from a
/// simulation; a test draws it anew).
const QUARTILE_OF_NOISE: f64 = 0.535;

/// The neighbours by which a value is foretold, as offsets among the measurements that are left.
const WAYS: [&[isize]; 3] = [&[-5, -4, -3, -2, -1], &[1, 2, 3, 4, 5], &[-3, -2, -1, 1, 2, 3]];

/// What is added where there are no five measurements before, or none after (with the signs changed): one wrong measurement
/// near the end cannot spoil all of these for its neighbours.
const AT_AN_END: [[isize; 5]; 2] = [[2, 3, 4, 5, 6], [3, 4, 5, 6, 7]];

/// How far away those neighbours are at most.
const REACH: usize = 5;

/// More spikes than these that are this close together may be a motion that is faster than the samples.
const MOST_TOGETHER: usize = 3;
const CLOSE: usize = 4;

/// A change from one measurement to the next is as large as another where it is more than this part of it.
const AS_LARGE: f64 = 0.5;

/// How far away the neighbours are at the ends: what is farther from a measurement has no say in its departure.
const FARTHEST: usize = 7;

/// The spikes among pairs of time and value, times increasing and all finite: index, and how many usual departures it
/// is off. They come in the order of their indices. The first and the last value of a column that `is_held` from sample to sample are not judged.
pub(super) fn spikes(
    series: &[(f64, f64)],
    threshold: f64,
    resolution: f64,
    is_held: bool,
) -> Vec<(usize, f64)> {
    let size = series.iter().fold(0.0, |size: f64, (_, value)| size.max(value.abs()));
    let floor = (0.3 * resolution).max(1e-9 * size).max(f64::MIN_POSITIVE);
    let mut found = Vec::new();
    // the measurements that are left, by their indices, and their departures where they are known
    let mut left: Vec<(usize, Option<f64>)> = (0..series.len()).map(|index| (index, None)).collect();
    while left.len() >= FEWEST {
        let points: Vec<(f64, f64)> = left.iter().map(|(index, _)| series[*index]).collect();
        let departures: Vec<f64> = left
            .iter()
            .enumerate()
            .map(|(at, (_, known))| known.unwrap_or_else(|| departure(&points, at)))
            .collect();
        let usual = usual_departure(&departures).max(floor);
        let by_itself =
            |points: &[(f64, f64)], at: usize, own: f64| own / usual.max(change_nearby(points, at) / 10.0);
        let is_fast = |rest: &[(f64, f64)], at: usize| {
            !stays(rest, at) && by_itself(rest, at, departure(rest, at)) > threshold
        };
        let score = |at: usize| match by_itself(&points, at, departures[at]) {
            own if own <= threshold => own,
            _ if stays(&points, at) => 0.0,
            _ if is_end(&points, at) && (is_held || !is_alone(&points, at, is_fast)) => 0.0,
            own => own,
        };
        let scores: Vec<f64> = (0..points.len()).map(score).collect();
        // the worst first: a measurement with spikes on either side of it has yet to be foretold without them
        let nearby = |at: usize, reach: usize| at.saturating_sub(reach)..(at + reach + 1).min(scores.len());
        let worst = |at: usize| scores[nearby(at, REACH)].iter().all(|other| *other <= scores[at]);
        let spikes: BTreeSet<usize> =
            (0..points.len()).filter(|at| scores[*at] > threshold && worst(*at)).collect();
        if spikes.is_empty() {
            break;
        }
        found.extend(spikes.iter().map(|at| Spike {
            index: left[*at].0,
            score: scores[*at],
            off: departures[*at],
        }));
        let kept = (0..left.len()).filter(|at| !spikes.contains(at));
        left = kept
            .map(|at| {
                let changes = spikes.range(nearby(at, FARTHEST)).next().is_some();
                (left[at].0, (!changes).then_some(departures[at]))
            })
            .collect();
    }
    let left: Vec<usize> = left.into_iter().map(|(index, _)| index).collect();
    without_motion(series, &left, found)
}

/// A value that is far from what its neighbours foretell: its place, how many usual departures it is off, and its departure.
struct Spike {
    index: usize,
    score: f64,
    off: f64,
}

/// Whether a value has neighbours on one side only.
fn is_end(points: &[(f64, f64)], at: usize) -> bool {
    at == 0 || at + 1 == points.len()
}

/// Whether a first or last value is the only one that is off: the value that is then first or last is not `is_fast`, and no change elsewhere is as large as the one
/// to its neighbour.
fn is_alone(points: &[(f64, f64)], at: usize, is_fast: impl Fn(&[(f64, f64)], usize) -> bool) -> bool {
    let (rest, next) = match at {
        0 => (&points[1..], 0),
        _ => (&points[..at], at - 1),
    };
    let own = (points[at].1 - rest[next].1).abs();
    let largest = rest.windows(2).map(|pair| (pair[1].1 - pair[0].1).abs()).fold(0.0, f64::max);
    largest < AS_LARGE * own && !is_fast(rest, next)
}

/// Spikes without those that are a motion faster than the samples, in the order of their indices: more than [`MOST_TOGETHER`] close together, among measurements that
/// change from one to the next by as much as they are off.
fn without_motion(series: &[(f64, f64)], left: &[usize], mut found: Vec<Spike>) -> Vec<(usize, f64)> {
    found.sort_by_key(|spike| spike.index);
    let together = found.chunk_by(|before, after| after.index - before.index <= CLOSE);
    let kept = together.filter(|run| run.len() <= MOST_TOGETHER || !is_motion(series, left, run));
    kept.flatten().map(|spike| (spike.index, spike.score)).collect()
}

/// Whether what is left about some spikes usually changes by as much as these are usually off.
fn is_motion(series: &[(f64, f64)], left: &[usize], run: &[Spike]) -> bool {
    let place = |index: usize| left.partition_point(|other| *other < index);
    let from = place(run[0].index).saturating_sub(SIDE);
    let to = (place(run[run.len() - 1].index) + SIDE).min(left.len());
    let changes = left[from..to].windows(2).map(|pair| (series[pair[1]].1 - series[pair[0]].1).abs());
    median(changes) > AS_LARGE * median(run.iter().map(|spike| spike.off))
}

/// The value in the middle, the lower one of two; zero of none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
}

/// Whether a value goes where the values after it are, as a body does that falls into another stable pose: it lies between its neighbours, or it is at a jump from one
/// smooth stretch to another and belongs to one of them. A fault returns.
fn stays(points: &[(f64, f64)], at: usize) -> bool {
    let (Some(before), Some(after)) = (at.checked_sub(1), points.get(at + 1)) else { return false };
    let (value, before, after) = (points[at].1, points[before].1, after.1);
    if (value - before) * (after - value) > 0.0 {
        return true;
    }
    let gap = (after - before).abs();
    let largest = |side: &[(f64, f64)]| {
        side.windows(2)
            .map(|pair| (pair[1].1 - pair[0].1).abs())
            .fold(None, |most: Option<f64>, change| Some(most.map_or(change, |most| most.max(change))))
    };
    let sides = [&points[at.saturating_sub(SIDE)..at], &points[at + 1..(at + 1 + SIDE).min(points.len())]];
    let are_smooth = sides.iter().all(|side| largest(side).is_some_and(|change| SMOOTH * change <= gap));
    are_smooth && (value - before).abs().min((value - after).abs()) <= gap / 2.0
}

/// The upper quartile of the departures, in terms of the standard deviation of white noise.
fn usual_departure(departures: &[f64]) -> f64 {
    let mut sorted = departures.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(3 * sorted.len() / 4).map_or(0.0, |quartile| quartile / QUARTILE_OF_NOISE)
}

/// The least departure of a value from what is foretold of it, in terms of what unit white noise would make of it.
fn departure(points: &[(f64, f64)], at: usize) -> f64 {
    let by = |way: &[isize]| -> Option<f64> {
        let neighbours: Vec<(f64, f64)> =
            way.iter().map(|by| points.get(at.checked_add_signed(*by)?).copied()).collect::<Option<_>>()?;
        let (foretold, gain) = foretell(&neighbours, points[at].0);
        let departure = (points[at].1 - foretold).abs() / gain;
        departure.is_finite().then_some(departure)
    };
    let mut least = WAYS.iter().filter_map(|way| by(way)).fold(f64::INFINITY, f64::min);
    if at < REACH || at + REACH >= points.len() {
        let sign = if at < REACH { 1 } else { -1 };
        least = AT_AN_END.iter().filter_map(|way| by(&way.map(|o| sign * o))).fold(least, f64::min);
    }
    if least.is_finite() { least } else { 0.0 }
}

/// What the parabola of least squares through some points says at a time, and the standard deviation of a value's
/// departure from it when all values have the standard deviation one.
///
/// By polynomials that are orthonormal on the points' times (Forsythe 1957).
fn foretell(points: &[(f64, f64)], time: f64) -> (f64, f64) {
    let size = points.iter().fold(0.0, |size: f64, (t, _)| size.max((t - time).abs()));
    let times: Vec<f64> = points.iter().map(|(t, _)| (t - time) / size).collect();
    let mut basis: Vec<(Vec<f64>, f64)> = Vec::new();
    for degree in 0..3 {
        // the polynomial's values at the points, and at the time, which is zero
        let mut values: Vec<f64> = times.iter().map(|t| t.powi(degree)).collect();
        let mut here = if degree == 0 { 1.0 } else { 0.0 };
        for (other, other_here) in &basis {
            let share: f64 = values.iter().zip(other).map(|(v, o)| v * o).sum();
            values.iter_mut().zip(other).for_each(|(v, o)| *v -= share * o);
            here -= share * other_here;
        }
        let norm = values.iter().map(|v| v * v).sum::<f64>().sqrt();
        values.iter_mut().for_each(|v| *v /= norm);
        basis.push((values, here / norm));
    }
    let (mut foretold, mut variance) = (0.0, 1.0);
    for (index, (_, value)) in points.iter().enumerate() {
        let weight: f64 = basis.iter().map(|(values, here)| values[index] * here).sum();
        foretold += weight * value;
        variance += weight * weight;
    }
    (foretold, f64::sqrt(variance))
}

/// Measurements of a stretch on either side of a jump, and by how much the jump exceeds the changes among them.
const SIDE: usize = 3;
const SMOOTH: f64 = 4.0;

/// The usual change from one measurement to the next among the three on either side, without the measurement itself.
fn change_nearby(points: &[(f64, f64)], at: usize) -> f64 {
    let side = |range: std::ops::Range<usize>| {
        let points = points.get(range.start..range.end.min(points.len())).unwrap_or_default();
        points.windows(2).map(|w| (w[1].1 - w[0].1).abs()).collect::<Vec<f64>>()
    };
    let mut changes = side(at.saturating_sub(3)..at);
    changes.extend(side(at + 1..at + 4));
    median(changes.into_iter())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// White noise of unit standard deviation, by the transform of Box and Muller.
    fn noise(seed: u64, count: usize) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut draw = || {
            let (radius, angle): (f64, f64) = (1.0 - random.random::<f64>(), random.random());
            (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
        };
        (0..count).map(|_| draw()).collect()
    }

    fn sampled(count: usize, value: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        let time = |i: usize| 1.4 * i as f64 / (count - 1) as f64;
        (0..count).map(|i| (time(i), value(time(i)))).collect()
    }

    fn indices(series: &[(f64, f64)]) -> Vec<usize> {
        spikes(series, 8.0, 0.0, false).into_iter().map(|(at, _)| at).collect()
    }

    #[test]
    fn the_usual_departure_of_white_noise_is_its_standard_deviation() {
        let series: Vec<(f64, f64)> =
            noise(2, 200_000).into_iter().enumerate().map(|(i, v)| (i as f64, v)).collect();
        let departures: Vec<f64> = (0..series.len()).map(|at| departure(&series, at)).collect();
        let usual = usual_departure(&departures);
        // the quartile of 200 000 draws is known to about one part in 300
        assert!((usual - 1.0).abs() < 0.01, "{usual}");
    }

    /// The parabola that passes through points of a parabola is that one: 2 - 3 t + 5 t^2 at t = 0.5 is 1.75.
    #[test]
    fn a_parabola_foretells_itself() {
        let parabola = |t: f64| (t, 2.0 - 3.0 * t + 5.0 * t * t);
        let (foretold, gain) = foretell(&[0.1, 0.3, 0.7, 1.2].map(parabola), 0.5);
        assert!((foretold - 1.75).abs() < 1e-13);
        assert!(gain > 1.0);
    }

    /// From five even measurements the next is foretold with the weights 9/5, 0, -4/5, -3/5, 3/5 (normal equations by
    /// hand), whose squares with the measurement's own sum to 28/5.
    #[test]
    fn the_gain_of_five_readings_before() {
        let (_, gain) = foretell(&[-5.0, -4.0, -3.0, -2.0, -1.0].map(|t| (t, 0.0)), 0.0);
        assert!((gain * gain - 28.0 / 5.0).abs() < 1e-12, "{}", gain * gain);
    }

    /// Twelve radians in 400 measurements, exactly: the departures are the error of the parabola.
    #[test]
    fn smooth_data_has_no_spikes() {
        assert_eq!(indices(&sampled(400, |t| (9.0 * t).sin() + 0.2 * (23.0 * t).cos())), [0usize; 0]);
        assert_eq!(indices(&sampled(400, |t| 1.0 / (1.0 + 100.0 * (t - 0.7).powi(2)))), [0usize; 0]);
        assert_eq!(indices(&sampled(400, |_| 2.0)), [0usize; 0]);
        assert_eq!(indices(&sampled(400, |t| 0.1 + 0.5 * t)), [0usize; 0]);
    }

    #[test]
    fn corners_steps_and_wrapped_angles_are_no_spikes() {
        assert_eq!(indices(&sampled(200, |t| (t - 0.7).abs())), [0usize; 0]);
        assert_eq!(indices(&sampled(200, |t| if t < 0.7 { 0.2 } else { 0.9 })), [0usize; 0]);
        assert_eq!(indices(&sampled(200, |t| (7.0 * t) % 3.0)), [0usize; 0]);
    }

    /// A body that comes to a fold goes as the root of the time that is left, and then falls: nothing of that is a spike, whether it is exact, rounded or noisy, and a
    /// fault right beside it is one.
    #[test]
    fn a_jump_behind_a_fold_is_no_spike_and_hides_none() {
        let falls = |fold: f64, after: f64| {
            sampled(160, move |t| match fold - t {
                left if left > 0.0 => 0.05 + 0.03 * left.sqrt() + 0.01 * t,
                _ => after + 0.02 * (3.0 * t).sin(),
            })
        };
        for (fold, after) in [(0.7, 0.2), (0.711, -0.1), (0.7001, 0.03), (0.7065, 1.5)] {
            let exact = falls(fold, after);
            assert_eq!(indices(&exact), [0usize; 0], "{fold} {after}");
            let grid = 1e-4;
            let rounded: Vec<_> = exact.iter().map(|(t, v)| (*t, (v / grid).round() * grid)).collect();
            assert_eq!(spikes(&rounded, 8.0, grid, false), [], "{fold} {after}");
            let at = exact.iter().position(|(t, _)| *t >= fold).unwrap();
            for wrong in [at - 2, at - 1, at, at + 1] {
                let mut series = exact.clone();
                series[wrong].1 += 5.0;
                assert_eq!(indices(&series), [wrong], "{fold} {after}");
            }
        }
    }

    /// Decays from the first sample, and growths to the last, that fall by some factor from sample to sample; with noise, and rounded to six digits behind the point. A
    /// fault where they are slow again is told.
    #[test]
    fn fast_motions_at_an_end_are_no_spikes() {
        for (rate, seed) in
            [0.3, 1.0, 2.0, 3.0, 5.0].into_iter().flat_map(|rate| (0..20).map(move |s| (rate, s)))
        {
            let errors = noise(seed, 41);
            let value = |i: usize| 2.0 * (-rate * i as f64).exp() + 1e-4 * errors[i];
            let falls: Vec<_> = (0..41).map(|i| (i as f64, (value(i) * 1e6).round() / 1e6)).collect();
            let grows: Vec<_> = (0..41).map(|i| (i as f64, falls[40 - i].1)).collect();
            assert_eq!(indices(&falls), [0usize; 0], "{rate} {seed}");
            assert_eq!(indices(&grows), [0usize; 0], "{rate} {seed}");
            let mut faulty = falls.clone();
            faulty[30].1 += 0.5;
            assert_eq!(indices(&faulty), [30], "{rate} {seed}");
        }
    }

    /// A motion that rings and has died away by the first tenth of the samples: its values are far off what their neighbours foretell.
    #[test]
    fn a_motion_faster_than_its_samples_is_no_spike() {
        for (phase, seed) in
            [0.0, 0.4, 0.9, 1.5].into_iter().flat_map(|phase| (0..10).map(move |s| (phase, s)))
        {
            let errors = noise(seed, 200);
            let ringing = |i: usize| (-0.3 * i as f64).exp() * (2.5 * i as f64 + phase).cos();
            let mut series: Vec<_> = (0..200).map(|i| (i as f64, ringing(i) + 1e-3 * errors[i])).collect();
            assert_eq!(indices(&series), [0usize; 0], "{phase} {seed}");
            series[150].1 += 0.5;
            assert_eq!(indices(&series), [150], "{phase} {seed}");
        }
    }

    /// Faults close together are told where the motion is slow.
    #[test]
    fn many_faults_in_a_slow_motion_are_told() {
        let wrong = [100, 104, 108, 112, 116, 120, 200, 203, 206, 209];
        let mut series = sampled(400, |t| (5.0 * t).sin());
        wrong.iter().enumerate().for_each(|(i, at)| series[*at].1 += if i % 2 == 0 { 0.5 } else { -0.7 });
        assert_eq!(indices(&series), wrong);
    }

    /// A command that changes its sign every ten samples, last in the last one; and one that is stepped once.
    #[test]
    fn the_last_step_of_a_command_is_no_spike() {
        let mut square: Vec<_> =
            (0..41).map(|i| (i as f64, if i / 10 % 2 == 0 { 1.0 } else { -1.0 })).collect();
        assert_eq!(indices(&square), [0usize; 0]);
        let back: Vec<_> = (0..41).map(|i| (i as f64, square[40 - i].1)).collect();
        assert_eq!(indices(&back), [0usize; 0]);
        square[25].1 = 40.0;
        assert_eq!(indices(&square), [25]);
        // of a single step nobody can tell but who knows that the column is held
        let once: Vec<_> = (0..41).map(|i| (i as f64, if i < 40 { 1.0 } else { -1.0 })).collect();
        assert_eq!(indices(&once), [40]);
        assert_eq!(spikes(&once, 8.0, 0.0, true), []);
    }

    #[test]
    fn noise_has_no_spikes_and_hides_none_that_stands_out() {
        for seed in 0..20 {
            let mut series = sampled(400, |t| (5.0 * t).sin());
            series.iter_mut().zip(noise(seed, 400)).for_each(|(point, n)| point.1 += 1e-3 * n);
            assert_eq!(indices(&series), [0usize; 0], "seed {seed}");
            // thirty standard deviations: 8 usual departures from five measurements on one side are 8 * 2.37
            series[123].1 += 0.03;
            assert_eq!(indices(&series), [123], "seed {seed}");
        }
    }

    #[test]
    fn single_and_neighbouring_spikes_are_found_and_no_others() {
        let found = |wrong: &[usize], size: f64| {
            let mut series = sampled(400, |t| (5.0 * t).sin());
            wrong.iter().for_each(|at| series[*at].1 += size);
            indices(&series)
        };
        let all: [&[usize]; 8] = [&[0], &[1], &[4], &[397], &[399], &[57], &[57, 58], &[57, 60, 63, 200]];
        for (wrong, size) in all.iter().flat_map(|wrong| [(wrong, 0.5), (wrong, -40.0)]) {
            assert_eq!(found(wrong, size), *wrong, "{size}");
        }
        // alike on either side of a good measurement: the neighbours do not determine which of the three are wrong
        assert_eq!(found(&[57, 59], 0.5), [57, 58, 59]);
    }

    #[test]
    fn measurements_on_a_grid_have_no_spikes() {
        let grid = 1e-4;
        let mut series = sampled(400, |t| grid * (0.02 * (1.0 - (4.0 * (t - 0.9)).tanh()) / grid).round());
        let found = |series: &[(f64, f64)]| spikes(series, 8.0, grid, false).len();
        assert_eq!(found(&series), 0);
        series[100].1 += 2e-3;
        assert_eq!(found(&series), 1);
    }
}
