//! Runs in which the body jumps (section 3.7): one shape for all segments, with no prior knowledge.
//!
//! The thesis restarts where the rate of the body is large, and then estimates two unknowns a segment. Here a stretch without a jump determines a shape; it grows on both sides as long as
//! the residuals are those of the measurements' errors. Where they are larger, the body lies in another stable pose of the estimated shape: first the one to which it falls
//! in the recovered potential, then each other, from each sample on. There is then no unknown a segment, but a choice among few poses, and all measurements are fitted at once.

use super::found::{CERTAIN, EXACT, SlowShape};
use super::measurements::SlowMeasurements;
use super::orders::Orders;
use super::outline::Outline;
use super::start::from_nothing_briefly;
use super::together::Together;
use palmistry_bodies::mechanics::resting::stable_poses;
use palmistry_bodies::shape::SupportSeries;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Fractions of all samples among which a window without a jump is looked for, and the step of a window as a fraction of its length.
const WINDOWS: [f64; 2] = [0.5, 0.3];
const WINDOW_STEP: f64 = 0.34;

/// The fewest samples of a window.
const FEWEST: usize = 40;

/// A stretch is explained well enough to grow below this residual relative to the mean radius. For bodies whose harmonics fall slowly each order lowers the residual, and all of
/// them at every step would take most of the time; they are tried at the end, for all measurements.
const ENOUGH: f64 = 0.1 * EXACT;

/// Samples by which a stretch grows at once.
const BLOCK: usize = 10;

/// This many places of a jump go on from their initial residual to a search.
const TRIED: usize = 5;

/// This many samples before the end of a stretch are tried, too, where it does not grow: a small jump does not show at once.
const BACK: usize = 8;

/// Between two samples the palms move in this many steps; a larger turn in one of them may be a jump.
pub(super) const STEPS: usize = 24;
pub(super) const JUMP: f64 = 0.04;

/// Such a step is halved this often: a turn that remains is a jump.
const HALVINGS: usize = 20;

/// A jump that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundJump {
    /// The first sample after it.
    pub row: usize,
    /// The first and the last sample that may be the first one after it, within five deviations of the measurements.
    pub within: [usize; 2],
    /// By how much the body turned, in radians: as it descends where that is predicted, else by the shorter way round.
    pub turn: f64,
    /// Whether descent in the recovered potential leads there from the pose before.
    pub predicted: bool,
    /// Whether the measurements need it: no shape within five deviations of the estimate turns as far without a jump. Else a quick turn explains them as well.
    pub certain: bool,
}

/// A stretch of samples that one shape explains, on its way to all.
struct Growth<'a> {
    measurements: &'a SlowMeasurements,
    rows: Range<usize>,
    support: SupportSeries,
    /// Of all samples; those outside of the stretch are unused.
    phi0: Vec<f64>,
    interrupt: &'a dyn Fn() -> bool,
}

impl Growth<'_> {
    /// Grows until all is explained, or no further growth is possible.
    fn grow(&mut self) {
        let last = self.measurements.rows();
        while !(self.interrupt)() {
            let ahead = self.rows.end < last && self.extend(true);
            let behind = self.rows.start > 0 && self.extend(false);
            if !ahead && !behind {
                break;
            }
        }
    }

    /// The samples by which it would grow, in the order in which they are reached.
    fn block(&self, forwards: bool) -> Vec<usize> {
        if forwards {
            (self.rows.end..(self.rows.end + BLOCK).min(self.measurements.rows())).collect()
        } else {
            (self.rows.start.saturating_sub(BLOCK)..self.rows.start).rev().collect()
        }
    }

    fn extend(&mut self, forwards: bool) -> bool {
        let block = self.block(forwards);
        let (Some(first), Some(end)) = (block.first(), block.last()) else { return false };
        let whole = (*first).min(*end).min(self.rows.start)..(*first).max(*end).max(self.rows.end - 1) + 1;
        let measurements = self.measurements.part(&whole);
        let together = Together::of(&measurements);
        let before = if forwards { self.rows.end - 1 } else { self.rows.start };
        let local = |row: usize| row - whole.start;
        let outline = Outline::of(&self.support.coefficients(), 0);
        // the poses to which the palms lead it, from a sample and its pose on
        let led = |mut near: Vec<f64>, from: usize, pose: f64| -> Option<Vec<f64>> {
            near[local(from)] = pose;
            let mut last = pose;
            let rows: Vec<usize> =
                if forwards { (from + 1..whole.end).collect() } else { (whole.start..from).rev().collect() };
            for row in rows {
                last = together.pose(local(row), last, &outline, PI)?.0;
                near[local(row)] = last;
            }
            Some(near)
        };
        let known: Vec<f64> = self.phi0[whole.clone()].to_vec();
        let mut tried: Vec<Vec<f64>> = Vec::new();
        if let Some(near) = led(known.clone(), before, self.phi0[before]) {
            if let Some(found) = self.explained(&together, &near, true) {
                return self.take(whole, &found);
            }
            tried.push(near);
        }
        // another pose from some sample on, the most likely ones by their residual before any search
        let mut others: Vec<(f64, Vec<f64>)> = Vec::new();
        let asked: Vec<usize> = if forwards {
            (before.saturating_sub(BACK).max(self.rows.start + 1)..whole.end).collect()
        } else {
            (whole.start..(before + BACK).min(self.rows.end - 1)).rev().collect()
        };
        for row in asked {
            if (self.interrupt)() {
                return false;
            }
            let support = |angle: f64| {
                let [r, slope, second, _] = self.support.support(angle);
                [r, slope, second]
            };
            let beside = if forwards { row - 1 } else { row + 1 };
            let Some(continued) = tried.first().map(|near| near[local(beside)]) else { return false };
            for pose in stable_poses(&support, self.measurements.palms[row]) {
                // by the shorter way round
                let pose = pose + ((continued - pose) / TAU).round() * TAU;
                let near = tried.first().cloned().unwrap_or_else(|| known.clone());
                let Some(near) = led(near, row, pose) else { continue };
                if tried.iter().any(|other| (other[local(row)] - pose).abs() < JUMP) {
                    continue;
                }
                if let Some(left) = together.left_at(&self.support, &near) {
                    others.push((left, near));
                }
            }
        }
        others.sort_by(|a, b| a.0.total_cmp(&b.0));
        others.truncate(TRIED);
        for (_, near) in &others {
            if let Some(found) = self.explained(&together, near, true) {
                return self.take(whole, &found);
            }
        }
        // more harmonics, where the present ones do not suffice
        tried.extend(others.into_iter().take(2).map(|(_, near)| near));
        for near in &tried {
            if let Some(found) = self.explained(&together, near, false) {
                return self.take(whole, &found);
            }
        }
        false
    }

    /// A shape that explains the samples from poses near these, by the present order alone or by all from it on.
    fn explained(&self, together: &Together<'_>, near: &[f64], is_quick: bool) -> Option<SlowShape> {
        let least = self.support.order();
        let orders = Orders {
            least: if is_quick { least } else { least + 1 },
            most: is_quick.then_some(least),
            enough: ENOUGH,
        };
        let found = together.explain(&self.support, near, orders, self.interrupt)?;
        found.explains(EXACT).then_some(found)
    }

    fn take(&mut self, rows: Range<usize>, found: &SlowShape) -> bool {
        self.phi0[rows.clone()].copy_from_slice(&found.track.phi0);
        self.support = SupportSeries::of_coefficients(&found.shape.support.coefficients());
        self.rows = rows;
        true
    }
}

/// Shape and motion of a run with jumps, with no prior knowledge: from windows without one. None where no window determines a shape; whether all measurements are explained says
/// [`SlowShape::explains`], and a run that is explained only in part is not.
pub fn from_segments(measurements: &SlowMeasurements, interrupt: &dyn Fn() -> bool) -> Option<SlowShape> {
    let rows = measurements.rows();
    let together = Together::of(measurements);
    let mut best: Option<SlowShape> = None;
    let in_window = Orders { enough: ENOUGH, ..Orders::CHOSEN };
    for window in WINDOWS {
        let width = ((rows as f64 * window) as usize).max(FEWEST).min(rows);
        let step = ((width as f64 * WINDOW_STEP) as usize).max(1);
        for start in (0..=rows - width).step_by(step) {
            if interrupt() {
                return best;
            }
            let stretch = start..start + width;
            let Some(found) = from_nothing_briefly(&measurements.part(&stretch), in_window, interrupt) else {
                continue;
            };
            if !found.explains(EXACT) {
                continue;
            }
            let support = SupportSeries::of_coefficients(&found.shape.support.coefficients());
            let mut growth = Growth { measurements, rows: 0..0, support, phi0: vec![0.0; rows], interrupt };
            growth.take(stretch, &found);
            growth.grow();
            if growth.rows.len() < rows {
                continue;
            }
            let orders = Orders { least: growth.support.order(), ..Orders::CHOSEN };
            let whole = together.explain(&growth.support, &growth.phi0, orders, interrupt);
            if let Some(whole) = whole
                && best.as_ref().is_none_or(|best| whole.rms_residual < best.rms_residual)
            {
                best = Some(whole);
            }
            if best.as_ref().is_some_and(|best| best.explains(EXACT)) {
                return best;
            }
        }
    }
    best
}

/// A turn that remains however small the palms' step is made.
#[derive(Clone, Copy, Debug)]
struct Fall {
    /// Where the palms are when it begins, as a fraction of their way between two samples.
    at: f64,
    /// The orientations before and after.
    turn: [f64; 2],
}

/// The part of a turn between two positions of the palms that happens at once, if most of it does: a quick motion near a fold does not.
fn fall(
    [mut low, mut high]: [f64; 2],
    [mut from, mut to]: [f64; 2],
    led: &mut dyn FnMut(f64, f64) -> Option<f64>,
) -> Option<Fall> {
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        let Some(there) = led(middle, from) else { break };
        if (there - from).abs() > (to - there).abs() {
            (high, to) = (middle, there);
        } else {
            (low, from) = (middle, there);
        }
    }
    ((to - from).abs() > JUMP / 2.0).then_some(Fall { at: high, turn: [from, to] })
}

/// Places between two poses at which the potential's curvature is tested for being negative.
const BETWEEN: usize = 64;

/// Whether the measurements show that a body falls between two poses. It does where the potential's curvature is negative somewhere between them: its largest distance from zero in its own
/// deviations is the least distance, in deviations, of a shape that turns steadily.
fn is_borne_out(together: &Together<'_>, found: &SlowShape, outline: &Outline, [from, to]: [f64; 2]) -> bool {
    (1..BETWEEN).any(|place| {
        let orientation = from + (to - from) * place as f64 / BETWEEN as f64;
        let [_, stiffness] = together.bent(0, orientation, outline, &found.shape.covariance);
        -stiffness.value > CERTAIN * found.caution() * stiffness.deviation
    })
}

/// The palms' way between two samples, as a sample of its own.
pub(super) struct Between {
    ends: [[f64; 2]; 2],
    at: SlowMeasurements,
}

impl Between {
    /// Between a sample and the one before.
    pub fn before(measurements: &SlowMeasurements, row: usize) -> Between {
        Between {
            ends: [measurements.palms[row - 1], measurements.palms[row]],
            at: measurements.part(&(row - 1..row)),
        }
    }

    /// The palms at a fraction of the way.
    pub fn at(&mut self, part: f64) -> Together<'_> {
        let [from, to] = self.ends;
        self.at.palms = vec![[0, 1].map(|palm: usize| from[palm] + part * (to[palm] - from[palm]))];
        Together::of(&self.at)
    }

    /// The uncertainty, in samples, of where a body falls: five deviations of the slope of the potential where the pose ends, divided by its change over the palms' way; infinite where the shape has no covariance.
    fn spread(&mut self, fall: &Fall, found: &SlowShape, outline: &Outline) -> f64 {
        let pose = fall.turn[0];
        let mut slope = |part: f64| self.at(part).bent(0, pose, outline, &found.shape.covariance)[0];
        let (here, change) = (slope(fall.at), slope(1.0).value - slope(0.0).value);
        let spread = CERTAIN * found.caution() * here.deviation / change.abs();
        if spread.is_nan() { f64::INFINITY } else { spread }
    }
}

/// The jumps of the body in a track: between two samples the palms are moved on in small steps, and the recovered shape follows.
pub fn found_jumps(measurements: &SlowMeasurements, found: &SlowShape) -> Vec<FoundJump> {
    let outline = Outline::of(&found.shape.support.coefficients(), 0);
    let phi0 = &found.track.phi0;
    let mut all = Vec::new();
    for row in 1..phi0.len() {
        let mut between = Between::before(measurements, row);
        let mut led = |at: f64, from: f64| between.at(at).pose(0, from, &outline, PI).map(|found| found.0);
        let (mut pose, mut falls, mut followed) = (phi0[row - 1], Vec::new(), true);
        for step in 1..=STEPS {
            let [before, at] = [step - 1, step].map(|step| step as f64 / STEPS as f64);
            match led(at, pose) {
                Some(next) => {
                    if (next - pose).abs() > JUMP {
                        falls.extend(fall([before, at], [pose, next], &mut led));
                    }
                    pose = next;
                }
                None => followed = false,
            }
        }
        let shorter = |turn: f64| (turn + PI).rem_euclid(TAU) - PI;
        let predicted = followed && shorter(pose - phi0[row]).abs() < JUMP;
        if falls.is_empty() && predicted {
            continue;
        }
        let before = phi0[row - 1];
        let turn = if predicted { pose - before } else { shorter(phi0[row] - before) };
        let (mut within, mut certain) = ([row; 2], false);
        for fall in falls.iter().filter(|_| predicted) {
            certain |= is_borne_out(&between.at(fall.at), found, &outline, fall.turn);
            let (place, spread) = ((row - 1) as f64 + fall.at, between.spread(fall, found, &outline));
            let [first, last] = [place - spread, place + spread].map(|place| place.ceil().max(1.0) as usize);
            within = [within[0].min(first), within[1].max(last.min(phi0.len() - 1))];
        }
        if !predicted {
            // the turn is already in the fit, and counts as a jump only where the measurements need it; two poses so near each other that nothing is sure to lie between are one
            let mut lies_between = |from: f64| {
                is_borne_out(&between.at(1.0), found, &outline, [from, from + shorter(phi0[row] - from)])
            };
            let from_before = lies_between(before);
            if !falls.is_empty() && !from_before {
                // this shape's pose has just ended, and the body is in it still
                continue;
            }
            certain = from_before && (!followed || lies_between(pose));
        }
        all.push(FoundJump { row, within, turn, predicted, certain });
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slow::{SlowExperiment, SlowScene};

    /// A jump that the measurements need is certain, and lies between its own two samples; with a thousandth of a radius of uncertainty it is somewhere about them; where the shape is
    /// unknown the body may as well have turned steadily.
    #[test]
    fn how_sure_a_jump_is_hangs_on_how_sure_the_shape_is() {
        let text = include_str!("../../../../proofs/moll2002/scenes/slow_jump.toml");
        let scene = SlowScene::parse("slow_jump.toml", text).unwrap();
        let experiment = SlowExperiment::new(scene, None).unwrap();
        let found = experiment.run(&|| false, &|_| ()).together.unwrap();
        let jumps = |deviation: f64| {
            let mut found = found.clone();
            let n = found.shape.covariance.nrows();
            found.shape.covariance = nalgebra::DMatrix::identity(n, n) * deviation.powi(2);
            found_jumps(&experiment.measurements, &found)
        };
        let sure = found_jumps(&experiment.measurements, &found);
        assert_eq!(sure.len(), 1);
        assert!(sure[0].certain && sure[0].predicted && sure[0].within == [sure[0].row; 2], "{sure:?}");
        let less = jumps(1e-3);
        assert!(less[0].certain && less[0].row == sure[0].row, "{less:?}");
        assert!(less[0].within[0] < less[0].row || less[0].within[1] > less[0].row, "{less:?}");
        let unsure = jumps(1.0);
        assert!(!unsure[0].certain && unsure[0].row == sure[0].row, "{unsure:?}");
        let [first, last] = unsure[0].within;
        assert!(first <= less[0].within[0] && last >= less[0].within[1], "{unsure:?}");
        // a triangle that has no inverse leaves no covariance
        let unknown = jumps(f64::INFINITY);
        assert!(
            !unknown[0].certain && unknown[0].within == [1, experiment.measurements.rows() - 1],
            "{unknown:?}"
        );
    }
}
