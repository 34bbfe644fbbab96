//! Poses that a body has for a while and leaves again for where it was: no jumps, but measurements that explain two poses almost alike.
//!
//! A body falls where the pose in which it lay ends, into the one to which descent leads, and stays there, since the palms have to go back a long way before it falls back. What a track
//! has instead, a turn that no descent explains, may be a stretch of samples that were given another pose by the errors of their readings. So the body is led on from the
//! sample before such a turn, or back from the one after it, until the track is met again or the readings speak against it: where this explains the readings of the stretch, or a shape
//! that is fitted to it explains all of them within five deviations as well, and the body jumps less often then, it is the track. What it does not explain stays a jump that descent did
//! not foretell.

use super::found::{CERTAIN, EXACT, SlowShape};
use super::outline::Outline;
use super::readings::SlowMeasurements;
use super::segments::{JUMP, found_jumps};
use super::together::Together;
use std::f64::consts::{PI, TAU};

/// So many stretches are led on at most, one after the other.
const MOST: usize = 20;

/// So many ways are fitted in all: a fit of a long run takes seconds.
const MOST_FITTED: usize = 60;

/// A track without detours, and a shape that was fitted to it.
pub(super) fn without_detours(
    readings: &SlowMeasurements,
    mut found: SlowShape,
    interrupt: &dyn Fn() -> bool,
) -> SlowShape {
    if !found.explains(EXACT) {
        // nobody is told of its jumps
        return found;
    }
    let together = Together::of(readings);
    let mut jumps = found_jumps(readings, &found);
    let mut fitted = 0;
    // of two tracks that the measurements do not tell apart the one that a body can have
    let most = found.shape.chi_square + (CERTAIN * found.shape.widened).powi(2);
    for _ in 0..MOST {
        let mut as_well = None;
        let better = jumps.iter().filter(|jump| !jump.predicted).find_map(|jump| {
            let ways =
                [true, false].into_iter().flat_map(|forwards| led(&together, &found, jump.row, forwards));
            ways.filter(|_| !interrupt()).find_map(|way| {
                fitted += 1;
                if fitted > MOST_FITTED {
                    return None;
                }
                let other = along(&together, &found, way.phi0, interrupt);
                let left = found_jumps(readings, &other);
                let chi_square = other.shape.chi_square;
                let explains = other.explains(EXACT) && chi_square <= most;
                if left.len() >= jumps.len() || !(way.explains || explains) {
                    return None;
                }
                let other = Some((other, left));
                if way.explains || chi_square <= found.shape.chi_square {
                    return other;
                }
                as_well = as_well.take().or(other);
                None
            })
        });
        let better = better.or(as_well);
        let Some(better) = better else { break };
        (found, jumps) = better;
    }
    found
}

/// A stretch led on.
struct Led {
    phi0: Vec<f64>,
    /// Whether the shape as it is explains its readings.
    explains: bool,
}

/// The orientations with a stretch that begins at a turn led on from the sample before it, or back from the first one after it: to where the track is met again, or to the end, and as
/// far as the readings bear it out where that is not all of it. Where the body has no such pose any more, the latter alone.
fn led(together: &Together<'_>, found: &SlowShape, turn: usize, forwards: bool) -> Vec<Led> {
    let outline = Outline::of(&found.shape.support.coefficients(), 0);
    let mut phi0 = found.track.phi0.clone();
    let mut last = phi0[if forwards { turn - 1 } else { turn }];
    let rows: Vec<usize> = if forwards { (turn..phi0.len()).collect() } else { (0..turn).rev().collect() };
    // as the whole is held against its readings
    let sigma = found.sigma.max(found.rms_residual);
    let (mut square, mut borne_out, mut turns, mut count) = (0.0, 0, 0.0, 0);
    let mut is_lost = false;
    for row in rows {
        let Some((pose, _)) = together.pose(row, last, &outline, PI) else {
            is_lost = true;
            break;
        };
        last = pose;
        let apart = last - phi0[row];
        let whole = (apart / TAU).round() * TAU;
        if (apart - whole).abs() < JUMP {
            turns = whole;
            break;
        }
        let contacts = together.contacts(row, &together.touched(row, last, &outline));
        square += (0..2).map(|i| (contacts[i] - together.readings.contacts[row][i]).powi(2)).sum::<f64>();
        count += 1;
        phi0[row] = last;
        let readings = 2.0 * count as f64;
        if (square / readings).sqrt() <= (1.0 + CERTAIN / (2.0 * readings).sqrt()) * sigma {
            borne_out = count;
        }
    }
    let until = |count: usize| if forwards { turn..turn + count } else { turn - count..turn };
    let part = (0 < borne_out && borne_out < count).then(|| {
        let mut own = found.track.phi0.clone();
        own[until(borne_out)].copy_from_slice(&phi0[until(borne_out)]);
        Led { phi0: own, explains: true }
    });
    // whole turns between what was led and what it met are no jumps
    let rest = if forwards { turn + count..phi0.len() } else { 0..turn - count };
    phi0[rest].iter_mut().for_each(|own| *own += turns);
    let is_part = is_lost && borne_out < count;
    let whole = (count > 0 && !is_part).then_some(Led { phi0, explains: borne_out == count });
    whole.into_iter().chain(part).collect()
}

/// The shape along another track: fitted anew, or as it was where it has kinks.
fn along(
    together: &Together<'_>,
    found: &SlowShape,
    phi0: Vec<f64>,
    interrupt: &dyn Fn() -> bool,
) -> SlowShape {
    let coefficients = found.shape.support.coefficients();
    if found.kinks.is_empty()
        && let Some(begin) = together.point(coefficients.clone(), &phi0)
    {
        return together.shape(&together.down(begin, interrupt));
    }
    let outline = Outline::of(&coefficients, 0);
    let mut other = found.clone();
    for (row, pose) in phi0.into_iter().enumerate().filter(|(row, pose)| *pose != found.track.phi0[*row]) {
        let radii = together.touched(row, pose, &outline).map(|radius| radius[0]);
        (other.track.phi0[row], other.track.radii[row]) = (pose, radii);
        other.track.height[row] = together.readings.sampled(row).height(radii);
    }
    other
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

    /// A run without a jump of which some samples are given another stable pose, in the middle and at both ends: the track is as it was, and no jump is told.
    #[test]
    fn samples_in_another_pose_are_led_on() {
        let experiment = experiment("");
        let readings = &experiment.readings;
        let found = experiment.run(&|| false, &|_| ()).together.unwrap();
        assert!(found_jumps(readings, &found).is_empty());
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
                let other = stable_poses(&support, readings.palms[row])
                    .into_iter()
                    .map(|pose| pose + ((own - pose) / TAU).round() * TAU)
                    .find(|pose| (pose - own).abs() > 0.5);
                if let Some(other) = other {
                    (wrong.track.phi0[row], given) = (other, given + 1);
                }
            }
            assert!(given > 0 && !found_jumps(readings, &wrong).is_empty(), "{rows:?}");
            let mended = without_detours(readings, wrong, &|| false);
            assert!(found_jumps(readings, &mended).is_empty(), "{rows:?}");
            for row in rows {
                assert!((mended.track.phi0[row] - found.track.phi0[row]).abs() < 1e-6, "{row}");
                assert!((mended.track.height[row] - found.track.height[row]).abs() < 1e-6, "{row}");
            }
        }
    }

    /// Where the readings are those of the other pose a jump stays: here the contacts of a stretch are those of another pose of the same body.
    #[test]
    fn what_the_readings_bear_out_stays() {
        let experiment = experiment("[sensor]\nnoise = 1e-3\n");
        let found = experiment.run(&|| false, &|_| ()).together.unwrap();
        let outline = Outline::of(&found.shape.support.coefficients(), 0);
        let support = |angle: f64| {
            let [radius, slope, second, _] = outline.support(angle);
            [radius, slope, second]
        };
        let mut readings = experiment.readings.clone();
        let mut wrong = found.clone();
        for row in 30..38 {
            let own = found.track.phi0[row];
            let poses = stable_poses(&support, readings.palms[row]);
            let other =
                poses.into_iter().find(|pose| ((pose - own + PI).rem_euclid(TAU) - PI).abs() > 0.5).unwrap();
            let together = Together::of(&experiment.readings);
            readings.contacts[row] = together.contacts(row, &together.touched(row, other, &outline));
            wrong.track.phi0[row] = other;
        }
        let told = found_jumps(&readings, &wrong).len();
        assert!(told >= 2);
        let kept = without_detours(&readings, wrong, &|| false);
        assert_eq!(found_jumps(&readings, &kept).len(), told);
    }
}
