//! The motion of a body of known shape between two flat palms: its angle and its rate at the first sample that fit the measurements best.
//!
//! The shape gives both contacts from one angle, so that a single sample admits a few angles, and two samples a few rates. From those that explain the first rows best, Levenberg and Marquardt's method goes
//! on to more and more of the record, by the law of motion that the reconstruction of unknown bodies has.

use super::super::law::{Pose, pose};
use super::super::record::WholeRecord;
use nalgebra::{DVector, Matrix2, Vector2};
use palmistry_bodies::mechanics::moving::Shape;
use palmistry_observe::advance;
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering};

/// Angles that are tried at a sample.
const ANGLES: usize = 720;

/// This many of the angles that explain a sample best go on.
const KEPT_ANGLES: usize = 6;

/// Rates on the grid, and the fastest of them in units of `sqrt(g/R)`.
const RATES: usize = 11;
const FASTEST: f64 = 2.0;

/// The first rows, by which initial values are sorted: this fraction of the record, and no fewer.
const FIRST: f64 = 0.06;
const FEWEST: usize = 8;

/// This many initial values are optimised, and this many of them on the whole record.
const BEGUN: usize = 10;
const KEPT: usize = 3;

/// Parts of the record that are explained one after the other.
const PARTS: [f64; 4] = [0.15, 0.3, 0.6, 1.0];

/// Steps for one part at most; the last lowers the sum of the squares by less than this fraction of it.
const STEPS: usize = 30;
const SETTLED: f64 = 1e-9;

/// Steps of the differences by which motions are differentiated, in rad and rad/s.
const DIFFERENCE: f64 = 1e-6;

/// The tolerance of the integration.
const TOLERANCE: f64 = 1e-11;

/// A body that may have been measured.
pub(super) struct Candidate<'a> {
    pub record: &'a WholeRecord,
    pub shape: &'a Shape,
    /// In m.
    pub gyration: f64,
}

/// Where a search ended.
#[derive(Clone, Debug)]
pub(super) struct End {
    /// The angle in rad and the rate in rad/s, at the first sample.
    pub first: Vector2<f64>,
    /// The sum of the squares of expected minus measured, in units of the stated deviation.
    pub cost: f64,
    /// The normal equations' matrix there.
    pub matrix: Matrix2<f64>,
}

impl Candidate<'_> {
    fn pose(&self, time: f64, angle: f64, rate: f64) -> Pose<f64> {
        let palms = self.record.palms_at(time);
        let support = palms.normals(angle).map(|normal| self.shape.support(normal));
        pose(&palms, &support, rate, self.gyration, self.record.gravity)
    }

    /// Expected minus measured of both contacts over so many rows, in m; none where the motion cannot be followed.
    pub fn differences(&self, first: &Vector2<f64>, rows: usize) -> Option<DVector<f64>> {
        let record = self.record;
        let law = |time: f64, y: &[f64], dy: &mut [f64]| {
            (dy[0], dy[1]) = (y[1], self.pose(time, y[0], y[1]).acceleration);
        };
        let mut y = vec![first[0], first[1]];
        let mut differences = Vec::with_capacity(2 * rows);
        for i in 0..rows {
            if i > 0 {
                y = advance(&law, record.times[i - 1], record.times[i], &y, TOLERANCE).ok()?;
            }
            let contacts = self.pose(record.times[i], y[0], y[1]).contacts;
            differences.extend([0, 1].map(|palm| contacts[palm] - record.contacts[palm][i]));
        }
        let all = DVector::from_vec(differences);
        all.iter().all(|value| value.is_finite()).then_some(all)
    }

    fn cost(&self, first: &Vector2<f64>, rows: usize) -> Option<f64> {
        Some(self.differences(first, rows)?.norm_squared() / self.record.sigma.powi(2))
    }

    /// The angles that explain a row best, each a local minimum.
    fn angles(&self, row: usize) -> Vec<f64> {
        let time = self.record.times[row];
        let off = |angle: f64| -> f64 {
            let contacts = self.pose(time, angle, 0.0).contacts;
            [0, 1].map(|palm| (contacts[palm] - self.record.contacts[palm][row]).powi(2)).iter().sum()
        };
        let all: Vec<f64> = (0..ANGLES).map(|i| off(TAU * i as f64 / ANGLES as f64)).collect();
        let is_least =
            |i: &usize| all[*i] <= all[(i + 1) % ANGLES] && all[*i] < all[(i + ANGLES - 1) % ANGLES];
        let mut least: Vec<usize> = (0..ANGLES).filter(is_least).collect();
        least.sort_by(|a, b| all[*a].total_cmp(&all[*b]));
        least.truncate(KEPT_ANGLES);
        least.into_iter().map(|i| TAU * i as f64 / ANGLES as f64).collect()
    }

    /// Angles of the first sample with rates: from those of a later one, and on a grid.
    fn starts(&self, rows: usize) -> Vec<Vector2<f64>> {
        let times = &self.record.times;
        let (begun, later) = (self.angles(0), self.angles(rows - 1));
        let elapsed = times[rows - 1] - times[0];
        let mean = self.shape.perimeter() / TAU;
        let palms = self
            .record
            .palms_at(times[0])
            .rates
            .into_iter()
            .fold(0.0, |most: f64, rate| most.max(rate.abs()));
        let most = FASTEST * (self.record.gravity.abs() / mean).sqrt() + palms;
        let mut starts = Vec::new();
        for angle in begun {
            for end in &later {
                let turned = end - angle - TAU * ((end - angle) / TAU).round();
                starts.push(Vector2::new(angle, turned / elapsed));
            }
            let rates = (0..RATES).map(|i| most * (2.0 * i as f64 / (RATES - 1) as f64 - 1.0));
            starts.extend(rates.map(|rate| Vector2::new(angle, rate)));
        }
        starts
    }

    fn is_explained(&self, cost: f64, rows: usize) -> bool {
        let n = 2.0 * rows as f64;
        cost <= n + 5.0 * (2.0 * n).sqrt()
    }

    /// The best angle and rate that are found; none where no motion can be followed, or it was interrupted.
    pub fn best(&self, interrupt: &AtomicBool) -> Option<End> {
        let all = self.record.times.len();
        let part = |part: f64| ((part * all as f64).ceil() as usize).clamp(FEWEST.min(all), all);
        let rows = part(FIRST);
        let starts = self.starts(rows).into_iter();
        let mut starts: Vec<(f64, Vector2<f64>)> =
            starts.filter_map(|start| Some((self.cost(&start, rows)?, start))).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        starts.truncate(BEGUN);
        let begun = starts.into_iter();
        let mut begun: Vec<End> =
            begun.filter_map(|(_, start)| self.descend(start, part(PARTS[0]), interrupt)).collect();
        begun.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        // several came to one place
        begun.dedup_by(|a, b| (a.first - b.first).amax() < 1e-3 * (1.0 + b.first.amax()));
        let mut best: Option<End> = None;
        for begin in begun.into_iter().take(KEPT) {
            let mut end = Some(begin);
            for more in &PARTS[1..] {
                end = end.and_then(|end| self.descend(end.first, part(*more), interrupt));
            }
            best = best.into_iter().chain(end).min_by(|a, b| a.cost.total_cmp(&b.cost));
            if best.as_ref().is_some_and(|best| self.is_explained(best.cost, all)) {
                break;
            }
        }
        best.filter(|_| !interrupt.load(Ordering::Relaxed))
    }

    /// Levenberg and Marquardt's method on the first rows.
    fn descend(&self, start: Vector2<f64>, rows: usize, interrupt: &AtomicBool) -> Option<End> {
        let sigma = self.record.sigma;
        let mut first = start;
        let mut left = self.differences(&first, rows)? / sigma;
        let mut damping = 1e-3;
        let mut matrix = Matrix2::zeros();
        for _ in 0..STEPS {
            if interrupt.load(Ordering::Relaxed) {
                return None;
            }
            let slope = |axis: usize| {
                let mut aside = first;
                aside[axis] += DIFFERENCE;
                Some((self.differences(&aside, rows)? / sigma - &left) / DIFFERENCE)
            };
            let slopes = [slope(0)?, slope(1)?];
            matrix = Matrix2::from_fn(|i, j| slopes[i].dot(&slopes[j]));
            let gradient = Vector2::from_fn(|i, _| slopes[i].dot(&left));
            let cost = left.norm_squared();
            let mut better = None;
            for _ in 0..8 {
                let damped = matrix + Matrix2::from_diagonal(&matrix.diagonal()) * damping;
                if let Some(step) = damped.try_inverse().map(|inverse| inverse * gradient) {
                    let there = first - step;
                    let next = self.differences(&there, rows).map(|next| next / sigma);
                    if let Some(next) = next.filter(|next| next.norm_squared() < cost) {
                        better = Some((there, next));
                        break;
                    }
                }
                damping = (damping * 10.0).max(1e-9);
            }
            let Some((there, next)) = better else { break };
            let settled = cost - next.norm_squared() <= SETTLED * cost;
            (first, left) = (there, next);
            damping *= 0.02;
            if settled {
                break;
            }
        }
        let cost = left.norm_squared();
        cost.is_finite().then_some(End { first, cost, matrix })
    }
}
