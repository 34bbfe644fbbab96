//! Finds again the poses that a search loses at folds.
//!
//! A body that is led past a fold has two poses near it, and while the shape is still off, the one in which it lay may be no minimum at all: then the sample's pose slides into another one, the residual of its contacts
//! is as large as the body, and no step of the search leads back. Where few samples are off by more than chance the others are fitted without them, and the lost ones are tried again: at the poses
//! next to those of the samples beside, and all others.

use super::together::{Point, Together};
use palmistry_bodies::mechanics::resting::stable_poses;
use std::f64::consts::{PI, TAU};

/// A sample is lost where a contact is off by this many deviations, by this many times the median residual, and by this fraction of the mean contact.
const LOST: f64 = 6.0;
const BEYOND_MOST: f64 = 5.0;
const BEYOND_SIZE: f64 = 2e-3;

/// If more than this fraction of all samples is off it is another motion, not lost poses.
const FEW: f64 = 0.1;

/// The number of attempts.
const TRIED: usize = 4;

impl Together<'_> {
    /// The same point, or a better one with the poses of samples that were lost.
    pub fn without_lost(&self, mut at: Point, interrupt: &dyn Fn() -> bool) -> Point {
        for _ in 0..TRIED {
            let lost = self.lost(&at);
            if lost.is_empty() || interrupt() {
                break;
            }
            let mut others = self.clone();
            lost.iter().for_each(|row| others.passed_over[*row] = true);
            let Some(begin) = others.point(at.coefficients.clone(), &at.phi0) else { break };
            let found = others.down(begin, interrupt);
            let Some(again) = self.with_poses(&found, &lost) else { break };
            if again.cost >= at.cost {
                break;
            }
            at = self.down(again, interrupt);
        }
        at
    }

    /// Samples that are off while most are not.
    fn lost(&self, at: &Point) -> Vec<usize> {
        let rows = at.phi0.len();
        let off: Vec<f64> =
            (0..rows).map(|row| at.left[2 * row].abs().max(at.left[2 * row + 1].abs())).collect();
        let mut sorted = off.clone();
        sorted.sort_by(f64::total_cmp);
        let middle = sorted.get(rows / 2).copied().unwrap_or(0.0);
        let most = LOST.max(BEYOND_MOST * middle).max(BEYOND_SIZE * self.size / self.sigma);
        let lost: Vec<usize> = (0..rows).filter(|row| off[*row] > most).collect();
        if lost.len() as f64 > FEW * rows as f64 { Vec::new() } else { lost }
    }

    /// All samples at a shape, the lost ones in the stable poses with the least residual.
    fn with_poses(&self, at: &Point, lost: &[usize]) -> Option<Point> {
        let outline = self.outline(&at.coefficients);
        let support = |angle: f64| {
            let [r, slope, second, _] = outline.support(angle);
            [r, slope, second]
        };
        let mut near = at.phi0.clone();
        for &row in lost {
            let off = |phi0: f64| -> f64 {
                let s = self.contacts(row, &self.touched(row, phi0, &outline));
                (0..2).map(|i| (self.measurements.contacts[row][i] - s[i]).powi(2)).sum()
            };
            let beside = near[row.max(1) - 1];
            // by the shorter way round
            let turned = |pose: f64| pose + ((beside - pose) / TAU).round() * TAU;
            let all = stable_poses(&support, self.measurements.palms[row]).into_iter().map(turned);
            let led = [Some(beside), near.get(row + 1).copied()]
                .into_iter()
                .flatten()
                .filter_map(|start| Some(self.pose(row, start, &outline, PI)?.0));
            near[row] = all.chain(led).min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(near[row]);
        }
        self.point(at.coefficients.clone(), &near)
    }
}
