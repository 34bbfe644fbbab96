//! The pose of the body at each sample, and its jumps, estimated together.
//!
//! A body lies in a minimum of its potential and is led along by the palms; where the minimum ends it falls, into the one to which descent leads. Measurements with errors are sometimes explained by other
//! poses almost as well: for a body that is nearly its own mirror image, or near a fold; and a track that takes the pose of the least residual at each sample has turns there that
//! no body makes. So the poses of all samples are chosen together. At an estimated shape each stable pose of each sample costs the residual of its contacts, in deviations of the measurements and
//! of the shape; a step from one sample to the next costs nothing where descent leads from the one pose to the other, continuously or by a jump, and the square of five
//! deviations where it does not. The cheapest sequence is found by dynamic programming (R. Bellman 1957; A. Viterbi 1967), and the shape is fitted to it.
//!
//! A body whose pose has just ended at this shape may lie in it for some samples more at another one: such a pose is the flattest place that the contacts agree with, and costs the
//! slope of the potential there, in deviations. The shape is fitted to the other samples then, with a potential that is just no longer steep there, and afterwards to all.
//!
//! A turn to which no descent leads remains only where the measurements pay for it. Another shape that explains them without it is tried as well: a shape that was fitted to wrong poses holds on to
//! them, so that samples about such a turn are left out of a fit, and then tried again.

use super::found::{CERTAIN, EXACT, SlowShape};
use super::measurements::SlowMeasurements;
use super::outline::Outline;
use super::segments::{Between, FoundJump, JUMP, STEPS, found_jumps};
use super::together::{Held, Together};
use palmistry_bodies::mechanics::resting::stable_poses;
use palmistry_bodies::shape::Measured;
use std::f64::consts::{PI, TAU};

/// The cost of a turn to which no descent leads.
const UNLED: f64 = CERTAIN * CERTAIN;

/// A better sequence is looked for this often.
const ROUNDS: usize = 8;

/// The most fits in all: a fit of a long run takes seconds.
const MOST_FITTED: usize = 60;

/// Samples before and after a turn that are left out of a fit.
const ABOUT: [usize; 2] = [2, 6];

/// Two jumps no farther apart than this may be a stretch in a wrong pose.
const STRETCH: usize = 60;

/// A shape is fitted this often without samples whose pose has ended before, until none has.
const ENDED_BEFORE: usize = 4;

/// How far from where a pose ended it is looked for, in rad, and in how many places.
const FARTHEST: f64 = 0.3;
const PLACES: usize = 120;

/// The standard deviation of a prescribed slope, in units of its own.
const HELD: f64 = 0.1;

/// A way that costs more than the cheapest by this is dropped.
const HOPELESS: f64 = 10.0 * UNLED;

/// The fraction of a deviation's square by which the sum has to fall for a sequence to be better.
const BETTER: f64 = 1e-3;

/// A track whose poses and jumps explain the measurements together, with its shape.
pub(super) fn with_poses_and_jumps(
    measurements: &SlowMeasurements,
    mut found: SlowShape,
    interrupt: &dyn Fn() -> bool,
) -> SlowShape {
    if !found.explains(EXACT) {
        // its jumps are not reported
        return found;
    }
    let together = Together::of(measurements);
    // the residual of exact measurements is that of the shape's order
    let sigma = found.sigma.max(found.rms_residual);
    let cost = |of: &SlowShape, jumps: &[FoundJump]| {
        let unled = jumps.iter().filter(|jump| !jump.predicted).count();
        of.shape.chi_square * (of.sigma / sigma).powi(2) + UNLED * unled as f64
    };
    let mut jumps = found_jumps(measurements, &found);
    let mut least = cost(&found, &jumps);
    let mut fitted = 0;
    for _ in 0..ROUNDS {
        let mut better: Option<(f64, SlowShape, Vec<FoundJump>)> = None;
        for way in ways(measurements, &together, &found, &jumps) {
            if interrupt() || fitted == MOST_FITTED {
                break;
            }
            let Some(other) = another(&together, &found, way, sigma, interrupt) else { continue };
            fitted += 1;
            if !other.explains(EXACT) {
                continue;
            }
            let others = found_jumps(measurements, &other);
            let its = cost(&other, &others);
            if its < least - BETTER && better.as_ref().is_none_or(|(cost, ..)| its < *cost) {
                let is_led = others.iter().all(|jump| jump.predicted);
                better = Some((its, other, others));
                if is_led {
                    break;
                }
            }
        }
        let Some(next) = better else { break };
        (least, found, jumps) = next;
    }
    found
}

/// The samples and slopes of a fit that precedes a new sequence.
#[derive(Default)]
struct Way {
    /// Samples that are left out.
    left_out: Vec<usize>,
    /// Prescribed slopes of the potential.
    held: Vec<Held>,
}

/// The ways that are tried: the shape as it is first; then without the samples about each turn to which nothing leads, and those between it and the jumps beside; and
/// where the turn is small, with a potential that does not rise between its poses.
fn ways(
    measurements: &SlowMeasurements,
    together: &Together<'_>,
    found: &SlowShape,
    jumps: &[FoundJump],
) -> Vec<Way> {
    let outline = Outline::of(&found.shape.support.coefficients(), 0);
    let rows = measurements.rows();
    let mut ways = vec![Way::default()];
    if !found.kinks.is_empty() {
        // these are fitted elsewhere
        return ways;
    }
    for (place, jump) in jumps.iter().enumerate().filter(|(_, jump)| !jump.predicted) {
        let within =
            |from: usize, to: usize, about: usize| from.saturating_sub(about)..(to + about).min(rows);
        let mut stretches = ABOUT.map(|about| within(jump.row, jump.row, about)).to_vec();
        let before = place.checked_sub(1).map(|before| jumps[before].row..jump.row);
        let after = jumps.get(place + 1).map(|after| jump.row..after.row);
        for stretch in before.into_iter().chain(after).filter(|stretch| stretch.len() <= STRETCH) {
            stretches.push(within(stretch.start, stretch.end, ABOUT[0]));
        }
        ways.extend(
            stretches.into_iter().map(|stretch| Way { left_out: stretch.collect(), held: Vec::new() }),
        );
        let last = found.track.phi0[jump.row - 1];
        let from = led(&mut Between::before(measurements, jump.row), last, &outline).to.unwrap_or(last);
        let turn = turned(found.track.phi0[jump.row] - from);
        if turn.abs() <= FARTHEST {
            let bent = |part: f64| {
                let phi0 = from + part * turn;
                (phi0, together.bent(jump.row, phi0, &outline, &found.shape.covariance)[0])
            };
            let rise = |part: &f64| bent(*part).1.value * turn.signum();
            let steepest = (1..PLACES).map(|at| at as f64 / PLACES as f64);
            let steepest = steepest.max_by(|a, b| rise(a).total_cmp(&rise(b))).unwrap_or(0.5);
            let (phi0, Measured { deviation, .. }) = bent(steepest);
            let (slope, deviation) = (-turn.signum() * deviation, HELD * deviation);
            let held = vec![Held { row: jump.row, phi0, slope, deviation }];
            ways.push(Way { left_out: vec![jump.row], held });
        }
    }
    ways
}

/// The cheapest sequence at the shape fitted to the samples that are not left out, and the shape along it; none where the sequence is unchanged.
fn another(
    together: &Together<'_>,
    found: &SlowShape,
    way: Way,
    sigma: f64,
    interrupt: &dyn Fn() -> bool,
) -> Option<SlowShape> {
    let mut is_new = !way.left_out.is_empty();
    let mut shape = fitted_without(together, found.clone(), way, interrupt)?;
    for _ in 0..=ENDED_BEFORE {
        let Sequence { phi0, ended } = cheapest(together, &shape, sigma, interrupt)?;
        is_new |= !is_the_same(&phi0, &found.track.phi0);
        if !is_new {
            return None;
        }
        if ended.is_empty() {
            return along(together, &shape, phi0, interrupt);
        }
        if !shape.kinks.is_empty() {
            return None;
        }
        let outline = Outline::of(&shape.shape.support.coefficients(), 0);
        let held = ended.iter().map(|row| {
            let bent = |phi0: f64| together.bent(*row, phi0, &outline, &shape.shape.covariance)[0];
            let flattest = places(phi0[*row])
                .min_by(|a, b| bent(*a).value.abs().total_cmp(&bent(*b).value.abs()))
                .unwrap_or(phi0[*row]);
            let Measured { value, deviation } = bent(flattest);
            // opposite by a deviation: there is a pose beside it then
            Held {
                row: *row,
                phi0: flattest,
                slope: -value.signum() * deviation,
                deviation: HELD * deviation,
            }
        });
        let held = held.collect();
        shape.track.phi0 = phi0;
        shape = fitted_without(together, shape, Way { left_out: ended, held }, interrupt)?;
    }
    None
}

/// Orientations about one.
fn places(phi0: f64) -> impl Iterator<Item = f64> {
    (0..=PLACES).map(move |at| phi0 + FARTHEST * (2.0 * at as f64 / PLACES as f64 - 1.0))
}

/// The shape fitted to the other samples, with prescribed slopes of the potential.
fn fitted_without(
    together: &Together<'_>,
    found: SlowShape,
    way: Way,
    interrupt: &dyn Fn() -> bool,
) -> Option<SlowShape> {
    if way.left_out.is_empty() {
        return Some(found);
    }
    let mut others = together.clone();
    others.held = way.held;
    way.left_out.iter().for_each(|row| others.passed_over[*row] = true);
    let begin = others.point(found.shape.support.coefficients(), &found.track.phi0)?;
    Some(others.shape(&others.down(begin, interrupt)))
}

fn is_the_same(one: &[f64], other: &[f64]) -> bool {
    one.iter().zip(other).all(|(one, other)| turned(one - other).abs() < 1e-9)
}

/// By the shorter way round.
fn turned(turn: f64) -> f64 {
    (turn + PI).rem_euclid(TAU) - PI
}

/// A pose of a sample, and the cheapest way to it.
#[derive(Clone, Copy)]
struct Node {
    pose: f64,
    cost: f64,
    /// The index of the node before among those of its sample, and by how much the body turned from there.
    before: (usize, f64),
    /// Whether the pose has ended at this shape.
    has_ended: bool,
}

/// Where the palms lead a body between two samples.
#[derive(Clone, Copy)]
struct Led {
    to: Option<f64>,
    /// Whether its pose ended on the way.
    falls: bool,
}

/// A sequence of poses.
struct Sequence {
    phi0: Vec<f64>,
    /// The samples whose pose has ended at this shape.
    ended: Vec<usize>,
}

/// The cheapest sequence of poses at a shape; none where a sample has no stable pose, or where it was interrupted.
fn cheapest(
    together: &Together<'_>,
    found: &SlowShape,
    sigma: f64,
    interrupt: &dyn Fn() -> bool,
) -> Option<Sequence> {
    let measurements = together.measurements;
    let outline = Outline::of(&found.shape.support.coefficients(), 0);
    let support = |angle: f64| {
        let [radius, slope, second, _] = outline.support(angle);
        [radius, slope, second]
    };
    let covariance = &found.shape.covariance;
    let mut all: Vec<Vec<Node>> = Vec::with_capacity(measurements.rows());
    for row in 0..measurements.rows() {
        if interrupt() {
            return None;
        }
        let poses = stable_poses(&support, measurements.palms[row]);
        let own = |pose: f64| together.surprise(row, pose, &outline, covariance, sigma);
        let Some(last) = all.last() else {
            let begin = found.track.phi0.first().copied().unwrap_or_default();
            // the frame is that of the track
            let first = |pose: f64| {
                let before = (0, begin + turned(pose - begin));
                Node { pose, cost: own(pose), before, has_ended: false }
            };
            all.push(poses.into_iter().map(first).collect());
            continue;
        };
        let mut between = Between::before(measurements, row);
        let led: Vec<Led> = last.iter().map(|node| led(&mut between, node.pose, &outline)).collect();
        let stable = |pose: f64| -> Option<Node> {
            let from = |(place, (node, led)): (usize, (&Node, &Led))| {
                let off = led.to.map(|led| turned(pose - led));
                let (step, turn) = match (off, led.to) {
                    (Some(off), Some(led)) if off.abs() < JUMP => (0.0, led + off - node.pose),
                    _ => (UNLED, turned(pose - node.pose)),
                };
                (node.cost + step, (place, turn))
            };
            let ways = last.iter().zip(&led).enumerate().map(from);
            let (cost, before) = ways.min_by(|a, b| a.0.total_cmp(&b.0))?;
            Some(Node { pose, cost: cost + own(pose), before, has_ended: false })
        };
        let ended = last.iter().zip(&led).enumerate().filter(|(_, (_, led))| led.falls);
        let ended = ended.filter_map(|(place, (node, _))| {
            let surprise = |pose: f64| together.surprise_if_it_lay(row, pose, &outline, covariance, sigma);
            let flat = places(node.pose).map(|pose| (pose, surprise(pose)));
            let (pose, surprise) = flat.min_by(|a, b| a.1.total_cmp(&b.1))?;
            let before = (place, pose - node.pose);
            Some(Node { pose, cost: node.cost + surprise, before, has_ended: true })
        });
        let mut nodes: Vec<Node> = poses.into_iter().filter_map(stable).chain(ended).collect();
        let least = nodes.iter().map(|node| node.cost).fold(f64::INFINITY, f64::min);
        nodes.retain(|node| node.cost <= least + HOPELESS);
        all.push(nodes);
    }
    let last = all.last()?.iter().enumerate().min_by(|a, b| a.1.cost.total_cmp(&b.1.cost))?;
    let mut place = last.0;
    let (mut turns, mut ended) = (Vec::with_capacity(all.len()), Vec::new());
    for (row, nodes) in all.iter().enumerate().rev() {
        let Node { before: (before, turn), has_ended, .. } = nodes[place];
        turns.push(turn);
        ended.extend(has_ended.then_some(row));
        place = before;
    }
    let mut phi0 = 0.0;
    let sum = |turn: f64| {
        phi0 += turn;
        phi0
    };
    Some(Sequence { phi0: turns.into_iter().rev().map(sum).collect(), ended })
}

/// Where the palms lead the body from a pose at the sample before.
fn led(between: &mut Between, from: f64, outline: &Outline) -> Led {
    let (mut pose, mut falls) = (from, false);
    for step in 1..=STEPS {
        let next = between.at(step as f64 / STEPS as f64).pose(0, pose, outline, PI);
        let Some((next, _)) = next else { return Led { to: None, falls: true } };
        falls |= (next - pose).abs() > JUMP;
        pose = next;
    }
    Led { to: Some(pose), falls }
}

/// The shape along another track: fitted again, or as it was where it has kinks.
fn along(
    together: &Together<'_>,
    found: &SlowShape,
    phi0: Vec<f64>,
    interrupt: &dyn Fn() -> bool,
) -> Option<SlowShape> {
    let coefficients = found.shape.support.coefficients();
    if found.kinks.is_empty() {
        let begin = together.point(coefficients, &phi0)?;
        return Some(together.shape(&together.down(begin, interrupt)));
    }
    let outline = Outline::of(&coefficients, 0);
    let mut other = found.clone();
    let mut square = 0.0;
    for (row, pose) in phi0.into_iter().enumerate() {
        let touched = together.touched(row, pose, &outline);
        let contacts = together.contacts(row, &touched);
        square += (0..2).map(|i| (contacts[i] - together.measurements.contacts[row][i]).powi(2)).sum::<f64>();
        let radii = touched.map(|radius| radius[0]);
        (other.track.phi0[row], other.track.radii[row]) = (pose, radii);
        other.track.height[row] = together.measurements.sampled(row).height(radii);
    }
    other.shape.chi_square = square / other.sigma.powi(2);
    other.rms_residual = (square / other.shape.samples as f64).sqrt();
    Some(other)
}
#[cfg(test)]
mod tests {
    use super::*;
    use crate::slow::{SlowExperiment, SlowScene};
    use palmistry_bodies::mechanics::resting::stable_poses;

    fn experiment(more: &str) -> SlowExperiment {
        let text = format!(
            "title = \"A slow body\"\nmotion = \"quasistatic\"\nduration = 60\nsamples = 80\n[body]\nmass = 1.0\n\
             shape = {{ kind = \"harmonics\", mean = 1.0, harmonics = [[0, 0], [0.06, 0.02], [0.02, -0.01]] }}\n\
             [palms]\nplan = {{ margin = 0.15, rounds = 2 }}\n{more}"
        );
        let scene = SlowScene::parse("scene.toml", &text).unwrap_or_else(|error| panic!("{error:?}"));
        SlowExperiment::new(scene, None).unwrap_or_else(|error| panic!("{error:?}"))
    }

    /// A run without a jump of which some samples are given another stable pose, in the middle and at both ends: the track is as it was, and no jump is reported.
    #[test]
    fn samples_in_another_pose_are_led_on() {
        let experiment = experiment("");
        let measurements = &experiment.measurements;
        let found = experiment.run(&|| false, &|_| ()).together.unwrap();
        assert!(found_jumps(measurements, &found).is_empty());
        let outline = Outline::of(&found.shape.support.coefficients(), 0);
        let support = |angle: f64| {
            let [radius, slope, second, _] = outline.support(angle);
            [radius, slope, second]
        };
        for rows in [40..41, 30..38, 0..5, 70..80] {
            let mut wrong = found.clone();
            let mut given = 0;
            for row in rows.clone() {
                let own = found.track.phi0[row];
                let other = stable_poses(&support, measurements.palms[row])
                    .into_iter()
                    .map(|pose| pose + ((own - pose) / TAU).round() * TAU)
                    .find(|pose| (pose - own).abs() > 0.5);
                if let Some(other) = other {
                    (wrong.track.phi0[row], given) = (other, given + 1);
                }
            }
            assert!(given > 0 && !found_jumps(measurements, &wrong).is_empty(), "{rows:?}");
            let mended = with_poses_and_jumps(measurements, wrong, &|| false);
            assert!(found_jumps(measurements, &mended).is_empty(), "{rows:?}");
            for row in rows {
                assert!((mended.track.phi0[row] - found.track.phi0[row]).abs() < 1e-6, "{row}");
                assert!((mended.track.height[row] - found.track.height[row]).abs() < 1e-6, "{row}");
            }
        }
    }

    /// Where the measurements are those of the other pose a jump stays: here the contacts of a stretch are those of another pose of the same body.
    #[test]
    fn what_the_readings_bear_out_stays() {
        let experiment = experiment("[sensor]\nnoise = 1e-3\n");
        let found = experiment.run(&|| false, &|_| ()).together.unwrap();
        let outline = Outline::of(&found.shape.support.coefficients(), 0);
        let support = |angle: f64| {
            let [radius, slope, second, _] = outline.support(angle);
            [radius, slope, second]
        };
        let mut measurements = experiment.measurements.clone();
        let mut wrong = found.clone();
        for row in 30..38 {
            let own = found.track.phi0[row];
            let poses = stable_poses(&support, measurements.palms[row]);
            let other =
                poses.into_iter().find(|pose| ((pose - own + PI).rem_euclid(TAU) - PI).abs() > 0.5).unwrap();
            let together = Together::of(&experiment.measurements);
            measurements.contacts[row] = together.contacts(row, &together.touched(row, other, &outline));
            wrong.track.phi0[row] = other;
        }
        let told = found_jumps(&measurements, &wrong).len();
        assert!(told >= 2);
        let kept = with_poses_and_jumps(&measurements, wrong, &|| false);
        assert_eq!(found_jumps(&measurements, &kept).len(), told);
    }
}
