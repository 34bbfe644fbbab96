//! The outline by an observer's estimates, sample by sample: where the contacts are in the frame of the body, and at which normals.
//!
//! This is geometry of two palms about the origin, flat or circular.

use super::super::recovered::{TouchInstant, TouchTrack};
use super::super::run::{Answer, Experiment};
use palmistry_bodies::mechanics::Palm;
use palmistry_bodies::shape::SupportSample;
use palmistry_math::number::rational_to_f64;
use palmistry_observe::{Signals, Update, UpdateEnd, WhenUnobservable};
use std::f64::consts::FRAC_PI_2;

/// The answer whose outline is shown: of the first method by windows that observed anything, else of the first by windows, else of the first.
#[doc(hidden)]
pub fn shown(answers: &[Answer]) -> Option<&Answer> {
    let by_windows = || answers.iter().filter(|answer| !answer.track.updates.is_empty());
    let saw = by_windows().find(|answer| answer.track.updates.iter().any(sees));
    saw.or_else(|| by_windows().next()).or(answers.first())
}

fn sees(update: &Update) -> bool {
    !matches!(update.end, UpdateEnd::Unobservable { .. } | UpdateEnd::Lost(_))
}

/// The time, in s, from which windows give no outline: where a search did not converge, or where a window between observing ones does not observe, and no other one covers
/// it. The orientation of all later ones depends on it. An uninformative window that goes on by its equations does not count.
fn hole(answer: &Answer, when_unobservable: WhenUnobservable) -> Option<f64> {
    let updates = &answer.track.updates;
    let is_answered = |update: &Update| sees(update) && update.end != UpdateEnd::StepsSpent;
    let ends = (updates.iter().position(is_answered), updates.iter().rposition(is_answered));
    let (Some(first), Some(last)) = ends else { return updates.first().map(|update| update.from) };
    let is_hole = |(place, update): &(usize, &Update)| {
        let covers =
            |other: &Update| is_answered(other) && other.from <= update.from && update.to <= other.to;
        let is_unanswered = match update.end {
            UpdateEnd::StepsSpent => true,
            UpdateEnd::Lost(_) => (first..last).contains(place),
            UpdateEnd::Unobservable { .. } => {
                when_unobservable == WhenUnobservable::Hold && (first..last).contains(place)
            }
            _ => false,
        };
        is_unanswered && !updates.iter().any(covers)
    };
    updates.iter().enumerate().find(is_hole).map(|(_, update)| update.from)
}

/// Why windows give no outline, as text; none where they do. Between flat palms all measurements at once are tried first: where that fails, or
/// windows contradict it, these are accepted only if they pass all their tests.
pub(super) fn no_outline(
    answer: &Answer,
    forms: &[Palm<f64>],
    when_unobservable: WhenUnobservable,
) -> Option<String> {
    if let Some(from) = hole(answer, when_unobservable) {
        return Some(format!(
            "no outline is estimated from the windows: from {from:.3} s there is no answer"
        ));
    }
    let is_flat = forms.iter().all(|form| *form == Palm::Flat);
    let are_refuted = !answer.track.updates.is_empty() && !answer.track.is_sound();
    (is_flat && are_refuted).then(|| {
        "no outline is estimated: the batch estimate of all measurements is no answer, and the windows do not pass their tests".to_owned()
    })
}

/// The value of a state or constant at a sample, from the measurements or from the known values.
pub(super) fn measured_or_known(experiment: &Experiment, name: &str, row: usize) -> Option<f64> {
    let signals = &experiment.signals;
    if let Some(place) = signals.find(name) {
        return signals.column(place).get(row).copied();
    }
    experiment.question.known.get(name).copied().or_else(|| {
        let symbol = experiment.system.find_symbol(name)?;
        let info = experiment.system.symbols().find(|(other, _)| *other == symbol)?.1;
        info.default.as_ref().map(rational_to_f64)
    })
}

/// The outline by one answer. None where the model is not one of two palms, or `r1` and `r2` were not estimated.
///
/// The contacts as seen from the centre of mass are `R x_i = -(r_i n_i + d_i t_i)`, with `d_i` by 3.18 and 3.19 from the recovered
/// `r_i` and the measured `s_i`; on curved palms the `r_i` determine the centre of mass, and it the contacts. They are turned back by the
/// orientation, the integral of the recovered `omega0` over the curve that each window draws; it starts at the true one where that is known, and at zero otherwise.
pub(super) fn touch_track(experiment: &Experiment, answer: &Answer) -> Option<TouchTrack> {
    let is_output = |name: &str| experiment.system.outputs.iter().any(|(output, _)| output == name);
    if !(is_output("s1") && is_output("s2")) {
        return None;
    }
    let names = experiment.names();
    let place = |name: &str| names.iter().position(|other| *other == name);
    let (first, second) = (place("r1")?, place("r2")?);
    let times = experiment.signals.times();
    let forms = forms(experiment);
    let orientations = orientations(experiment, answer)?;
    let worth = worth(answer, [first, second]);
    let mut instants = Vec::new();
    for ((moment, orientation), worth) in answer.track.estimates.iter().zip(orientations).zip(worth) {
        let row = times.partition_point(|time| *time < moment.time);
        let of = |name: &str| match place(name) {
            Some(place) => Some(moment.state[place]),
            None => measured_or_known(experiment, name, row),
        };
        let (r, s) = ([moment.state[first], moment.state[second]], [of("s1")?, of("s2")?]);
        let (phi1, phi2) = (of("phi1")?, of("phi2")?);
        let palms = [phi1, phi1 + phi2];
        let Seen { contacts, arms } = match forms {
            [Palm::Flat, Palm::Flat] => between_flat(phi2, palms, r, s),
            _ => between_curved(&forms, palms, r, s),
        };
        let seen = answer.track.updates.is_empty() || !moment.residual.is_empty();
        let sample = |i: usize| {
            let side = if i == 0 { 1.0 } else { -1.0 };
            let tangent = palms[i] + side * forms[i].at(&s[i]).turned;
            let weight = if seen { worth[i] } else { 0.0 };
            SupportSample { angle: tangent - side * FRAC_PI_2 - orientation, radius: r[i], weight }
        };
        instants.push(TouchInstant {
            time: moment.time,
            palms,
            sensed: s,
            contacts,
            centre: [contacts[0][0] - arms[0][0], contacts[0][1] - arms[0][1]],
            orientation,
            points: arms.map(|arm| turned(arm, -orientation)),
            samples: [sample(0), sample(1)],
            is_observed: seen,
        });
    }
    (!instants.is_empty()).then_some(TouchTrack { method: answer.method, forms, instants })
}

/// The weights of the radii at each estimate: the inverse variance at the window's first sample, divided among its samples, whose errors are one. One
/// where there are no windows.
fn worth(answer: &Answer, places: [usize; 2]) -> Vec<[f64; 2]> {
    let updates = &answer.track.updates;
    let estimates = &answer.track.estimates;
    let window = |time: f64| updates.iter().rposition(|update| update.from < time).unwrap_or(0);
    let mut counts = vec![0.0; updates.len()];
    for moment in estimates {
        if let Some(count) = counts.get_mut(window(moment.time)) {
            *count += 1.0;
        }
    }
    let of = |time: f64| {
        let at = window(time);
        match updates.get(at) {
            None => [1.0; 2],
            Some(update) => places.map(|place| match update.deviations.get(place) {
                Some(deviation) if *deviation > 0.0 && deviation.is_finite() && sees(update) => {
                    1.0 / (deviation * deviation * counts[at])
                }
                _ => 0.0,
            }),
        }
    };
    estimates.iter().map(|moment| of(moment.time)).collect()
}

/// The orientation at each estimate. The rate estimated by windows is one smooth curve from the first sample of a window to its last, and jumps
/// where the next one begins: each piece is integrated by itself, by the polynomials through its nearest samples.
fn orientations(experiment: &Experiment, answer: &Answer) -> Option<Vec<f64>> {
    let names = experiment.names();
    let place = names.iter().position(|name| *name == "omega0");
    let times = experiment.signals.times();
    let track = &answer.track;
    let rate = |time: f64, state: &[f64]| match place {
        Some(place) => Some(state[place]),
        None => measured_or_known(experiment, "omega0", times.partition_point(|other| *other < time)),
    };
    let start = experiment.simulation.as_ref().and_then(|s| s.trajectory.moments.first());
    let mut orientation = start.map_or(0.0, |moment| moment.phi0);
    let mut all: Vec<f64> = Vec::with_capacity(track.estimates.len());
    let begins: Vec<&Update> = track.updates.iter().skip(1).collect();
    let mut next = 0;
    while all.len() < track.estimates.len() {
        let done = all.len();
        // the sample that two windows share is the last one of the first
        let end = begins.get(next).map_or(track.estimates.len(), |begin| {
            track.estimates.partition_point(|moment| moment.time <= begin.from).max(done)
        });
        let (mut piece_times, mut rates) = (Vec::new(), Vec::new());
        if let Some(last) = done.checked_sub(1).map(|last| &track.estimates[last]) {
            let state = match next.checked_sub(1).map(|own| begins[own]) {
                Some(update) if update.from == last.time => &update.estimate,
                _ => &last.state,
            };
            piece_times.push(last.time);
            rates.push(rate(last.time, state)?);
        }
        for moment in &track.estimates[done..end] {
            piece_times.push(moment.time);
            rates.push(rate(moment.time, &moment.state)?);
        }
        let skipped = usize::from(done > 0);
        let turned = integral(&piece_times, rates);
        all.extend(turned.iter().skip(skipped).map(|turned| orientation + turned));
        orientation += turned.last().copied().unwrap_or(0.0);
        next += 1;
    }
    Some(all)
}

/// The integral from the first time to each, of the polynomials through the nearest eight values: by Gauss and Legendre's rule with four nodes, which has no error
/// for these.
fn integral(times: &[f64], values: Vec<f64>) -> Vec<f64> {
    /// Abramowitz and Stegun, table 25.4.
    const GAUSS: [(f64, f64); 2] = [
        (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    ];
    let Ok(signals) = Signals::new(times.to_vec(), vec![(String::new(), values)]) else {
        // a track that has run away has no orientation either
        return times.iter().map(|_| f64::NAN).collect();
    };
    let at = |time: f64| {
        let mut value = [0.0];
        signals.at(&[0], time, &mut value);
        value[0]
    };
    let mut sum = 0.0;
    let mut all = vec![0.0];
    for pair in times.windows(2) {
        let (middle, half) = (f64::midpoint(pair[0], pair[1]), (pair[1] - pair[0]) / 2.0);
        let nodes =
            GAUSS.iter().map(|(node, weight)| weight * (at(middle - node * half) + at(middle + node * half)));
        sum += half * nodes.sum::<f64>();
        all.push(sum);
    }
    all
}

/// The contacts, from the joint and from the centre of mass, in the world.
struct Seen {
    contacts: [[f64; 2]; 2],
    arms: [[f64; 2]; 2],
}

/// The forms of the palms: those of the scene; for a recording those of the known constants.
pub(super) fn forms(experiment: &Experiment) -> [Palm<f64>; 2] {
    if experiment.simulation.is_some() {
        return experiment.scene.palm_forms;
    }
    ["b1", "b2"].map(|name| match measured_or_known(experiment, name, 0) {
        Some(radius) if radius.is_finite() && radius != 0.0 => Palm::Circular { radius },
        _ => Palm::Flat,
    })
}
fn between_flat(phi2: f64, palms: [f64; 2], r: [f64; 2], s: [f64; 2]) -> Seen {
    let (sine, cosine) = phi2.sin_cos();
    let d = [(r[0] * cosine + r[1]) / sine - s[0], -(r[1] * cosine + r[0]) / sine + s[1]];
    // t2 points towards the origin, so that n2 points to the body as n1 does
    let along = [unit(palms[0]), unit(palms[1]).map(|x| -x)];
    let arm = |i: usize| -> [f64; 2] {
        let t = along[i];
        let n = [-t[1], t[0]];
        [-(r[i] * n[0] + d[i] * t[0]), -(r[i] * n[1] + d[i] * t[1])]
    };
    let contacts = [unit(palms[0]).map(|x| x * s[0]), unit(palms[1]).map(|x| x * s[1])];
    Seen { contacts, arms: [arm(0), arm(1)] }
}

/// The centre of mass is `r_i` from the tangent at each contact.
fn between_curved(forms: &[Palm<f64>; 2], palms: [f64; 2], r: [f64; 2], s: [f64; 2]) -> Seen {
    let contacts = [0, 1].map(|i: usize| on_palm(&forms[i], i, palms[i], s[i]));
    let normals = [0, 1].map(|i: usize| world(i, palms[i], forms[i].at(&s[i]).normal));
    let heights =
        [0, 1].map(|i: usize| r[i] + normals[i][0] * contacts[i][0] + normals[i][1] * contacts[i][1]);
    let [[a, b], [c, d]] = normals;
    let sine = a * d - b * c;
    let centre = [(heights[0] * d - heights[1] * b) / sine, (a * heights[1] - c * heights[0]) / sine];
    Seen { contacts, arms: contacts.map(|place| [place[0] - centre[0], place[1] - centre[1]]) }
}

/// A vector in the frame of a palm (0 or 1) at an angle, in the world.
fn world(palm: usize, angle: f64, [ahead, across]: [f64; 2]) -> [f64; 2] {
    let [c, s] = unit(angle);
    let across = if palm == 0 { across } else { -across };
    [ahead * c - across * s, ahead * s + across * c]
}

/// The point of a palm (0 or 1) at an angle, so far along it, in the world.
#[doc(hidden)]
pub fn on_palm(form: &Palm<f64>, palm: usize, angle: f64, s: f64) -> [f64; 2] {
    world(palm, angle, form.at(&s).place)
}

fn unit(angle: f64) -> [f64; 2] {
    let (sine, cosine) = angle.sin_cos();
    [cosine, sine]
}

/// A vector, turned counterclockwise by an angle in rad.
#[doc(hidden)]
pub fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let [c, s] = unit(angle);
    [c * x - s * y, s * x + c * y]
}

#[cfg(test)]
mod tests {
    use super::*;
    use palmistry_observe::Lost;

    /// One window after the other is made unobservable: between others this leaves a hole, at an end it does not, and a search without convergence leaves one anywhere.
    #[test]
    fn a_hole_is_what_later_orientations_hang_on() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../proofs/moll2002/scenes/same_rate.toml");
        let text = std::fs::read_to_string(path).unwrap();
        let mut scene = crate::Scene::parse(path, &text).unwrap_or_else(|error| panic!("{error:?}"));
        scene.observer.methods = vec![crate::Method::TrustRegion];
        let experiment = Experiment::new(scene, None).unwrap_or_else(|error| panic!("{error:?}"));
        let answer = experiment.observe().unwrap_or_else(|error| panic!("{error:?}")).remove(0);
        let last = answer.track.updates.len() - 1;
        assert!(last >= 3);
        let hole_with = |place: usize, end: UpdateEnd, when_unobservable| {
            let mut other = answer.clone();
            other.track.updates[place].end = end;
            hole(&other, when_unobservable)
                .map(|from| answer.track.updates.iter().position(|own| own.from == from).unwrap())
        };
        assert_eq!(hole(&answer, WhenUnobservable::Hold), None);
        let lost = || UpdateEnd::Lost(Lost { time: 0.0, why: String::new() });
        let blind = || UpdateEnd::Unobservable { weakest: Vec::new() };
        for place in 0..=last {
            let between = (0 < place && place < last).then_some(place);
            assert_eq!(hole_with(place, UpdateEnd::StepsSpent, WhenUnobservable::Integrate), Some(place));
            assert_eq!(hole_with(place, lost(), WhenUnobservable::Integrate), between);
            assert_eq!(hole_with(place, blind(), WhenUnobservable::Hold), between);
            assert_eq!(hole_with(place, blind(), WhenUnobservable::Integrate), None);
        }
        let mut none = answer.clone();
        none.track.updates.iter_mut().for_each(|own| own.end = blind());
        assert_eq!(hole(&none, WhenUnobservable::Integrate), Some(0.0));
        // a window that has grown over it covers it
        let mut covered = answer.clone();
        covered.track.updates[1].end = blind();
        covered.track.updates[2].from = answer.track.updates[1].from;
        assert_eq!(hole(&covered, WhenUnobservable::Hold), None);
    }

    /// The integral of a cosine is the sine; a polynomial of the seventh degree has no error but rounding's.
    #[test]
    fn smooth_rates_are_integrated_to_rounding() {
        let times: Vec<f64> = (0..80).map(|i| 0.0035 * f64::from(i) + 1e-4 * f64::from(i % 3)).collect();
        let found = integral(&times, times.iter().map(|t| (6.0 * t).cos()).collect());
        for (time, found) in times.iter().zip(found) {
            assert!((found - (6.0 * time).sin() / 6.0).abs() < 1e-14, "{time}: {found}");
        }
        let power = |k: i32| times.iter().map(|t| t.powi(k)).collect::<Vec<f64>>();
        for (found, exact) in integral(&times, power(7)).iter().zip(power(8)) {
            assert!((found - exact / 8.0).abs() < 1e-15);
        }
        assert!(integral(&times, vec![f64::NAN; 80]).iter().all(|turned| turned.is_nan()));
        assert_eq!(integral(&[1.0], vec![3.0]), [0.0]);
    }
}
