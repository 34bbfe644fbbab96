//! Poses that a body has for a moment and leaves again for where it was: no jumps, but readings that explain two poses almost alike.
//!
//! A body that falls into another stable pose stays there, since the palms have to go back a long way before it falls back. A sample or a few whose pose is another, between
//! neighbours that go on as if nothing had been, have been given that pose by the rounding of their readings. They are led on from the sample before.

use super::found::SlowShape;
use super::outline::Outline;
use super::readings::SlowReadings;
use super::together::Together;
use std::f64::consts::PI;
use std::ops::Range;

/// A pose that is left again after so many samples or fewer is none.
const MOST: usize = 3;

/// A turn by more than this, in radians, between two samples may be into another pose; and one that returns ends within this part of it.
const TURN: f64 = 0.04;
const BACK: f64 = 0.25;

/// The samples of which the poses are others for a moment.
pub(super) fn returns(phi0: &[f64]) -> Vec<Range<usize>> {
    let turn = |row: usize| phi0[row] - phi0[row - 1];
    let mut all: Vec<Range<usize>> = Vec::new();
    let mut row = 1;
    while row < phi0.len() {
        let ends = (row + 1..=row + MOST).filter(|end| *end < phi0.len());
        // what the track does around it is what it does in between
        let usual = |end: usize| {
            let beside =
                [row.checked_sub(1).filter(|row| *row > 0), (end + 1 < phi0.len()).then_some(end + 1)];
            beside.into_iter().flatten().map(|row| turn(row).abs()).fold(0.0, f64::max)
        };
        let is_back = |end: &usize| {
            let (away, net) = (turn(row).abs(), (phi0[*end] - phi0[row - 1]).abs());
            let most = usual(*end) * (1 + end - row) as f64;
            away > TURN && turn(*end).abs() > TURN && net < BACK * away && away > 2.0 * most
        };
        match ends.clone().find(is_back) {
            Some(end) => {
                all.push(row..end);
                row = end + 1;
            }
            None => row += 1,
        }
    }
    all
}

/// A shape whose track is led on from sample to sample where its poses are others for a moment.
pub(super) fn led_on(readings: &SlowReadings, mut found: SlowShape) -> SlowShape {
    let returns = returns(&found.track.phi0);
    if returns.is_empty() {
        return found;
    }
    let together = Together::of(readings);
    let outline = Outline::of(&found.shape.support.coefficients(), 0);
    for row in returns.into_iter().flatten() {
        let Some((pose, _)) = together.pose(row, found.track.phi0[row - 1], &outline, PI) else { continue };
        let radii = together.touched(row, pose, &outline).map(|radius| radius[0]);
        let track = &mut found.track;
        (track.phi0[row], track.radii[row]) = (pose, radii);
        track.height[row] = readings.sampled(row).height(radii);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slow::{SlowExperiment, SlowScene, found_jumps};
    use palmistry_bodies::mechanics::resting::stable_poses;

    /// What stays is a jump, however near to another, and what is left again for where it was is none.
    #[test]
    fn what_returns_is_no_jump() {
        let smooth = |row: usize| 0.3 * (0.1 * row as f64).sin();
        let track =
            |added: &dyn Fn(usize) -> f64| (0..60).map(|row| smooth(row) + added(row)).collect::<Vec<_>>();
        let (one, two) = (30..31, 30..32);
        assert_eq!(returns(&track(&|_| 0.0)), []);
        assert_eq!(returns(&track(&|row| if row < 30 { 0.0 } else { 1.9 })), []);
        assert_eq!(returns(&track(&|row| if row == 30 { 1.92 } else { 0.0 })), [one]);
        let found = returns(&track(&|row| if two.contains(&row) { -1.2 } else { 0.0 }));
        assert_eq!(found, [two]);
        // it falls on, and it falls back much later
        assert_eq!(
            returns(&track(&|row| 1.5 * (f64::from(u8::from(row > 20)) + f64::from(u8::from(row > 22))))),
            []
        );
        assert_eq!(returns(&track(&|row| if (20..40).contains(&row) { 1.9 } else { 0.0 })), []);
    }

    /// A run without a jump of which one sample is given another stable pose: its track is led on as it was, and no jump is told.
    #[test]
    fn a_sample_in_another_pose_is_led_on() {
        let text = "title = \"A slow body\"\nmotion = \"quasistatic\"\nduration = 60\nsamples = 80\n[body]\nmass = 1.0\n\
                    shape = { kind = \"harmonics\", mean = 1.0, harmonics = [[0, 0], [0.06, 0.02], [0.02, -0.01]] }\n\
                    [palms]\nplan = { margin = 0.15, rounds = 2 }\n";
        let scene = SlowScene::parse("scene.toml", text).unwrap_or_else(|error| panic!("{error:?}"));
        let experiment = SlowExperiment::new(scene, None).unwrap_or_else(|error| panic!("{error:?}"));
        let readings = &experiment.readings;
        let found = experiment.run(&|| false, &|_| ()).together.unwrap();
        assert!(found_jumps(readings, &found).is_empty());
        let row = 40;
        let outline = Outline::of(&found.shape.support.coefficients(), 0);
        let support = |angle: f64| {
            let [radius, slope, second, _] = outline.support(angle);
            [radius, slope, second]
        };
        let own = found.track.phi0[row];
        let other = stable_poses(&support, readings.palms[row])
            .into_iter()
            .map(|pose| pose + ((own - pose) / std::f64::consts::TAU).round() * std::f64::consts::TAU)
            .find(|pose| (pose - own).abs() > 0.5)
            .unwrap();
        let mut wrong = found.clone();
        wrong.track.phi0[row] = other;
        assert_eq!(found_jumps(readings, &wrong).len(), 2);
        let mended = led_on(readings, wrong);
        assert!(found_jumps(readings, &mended).is_empty());
        assert!((mended.track.phi0[row] - own).abs() < 1e-9);
        assert!((mended.track.height[row] - found.track.height[row]).abs() < 1e-9);
    }
}
