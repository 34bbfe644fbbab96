//! Closed splines through a few points as candidates: bodies whose curvature has kinks, such as those of the thesis.
//!
//! A series needs many harmonics for each kink; a spline has one at each of its points and needs nothing else. The points are first fitted to the series, by its radii at the normals that were touched; then
//! points and steps are fitted to the measurements themselves. An additional point starts in the middle of a piece, where it changes nothing.

use super::candidate::{Best, Found};
use super::descent::{Least, Squares, descend, joined, triangle_of};
use super::record::{Unknowns, WholeRecord};
use nalgebra::{DMatrix, DVector};
use palmistry_bodies::shape::{SupportFunction, SupportSpline};
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering};

/// The fewest points, and the most that are tried.
const FEWEST: usize = 3;
const MOST: usize = 6;

/// Directions of the first point, in fractions of the angle between two.
const TURNS: usize = 8;

/// This many radii of a series are enough for initial values; and their standard deviation relative to the size of the body.
const RADII: usize = 200;
const WORTH: f64 = 1e-4;

/// This many initial values go on to the measurements; all of them while none converges to a fit that the series does not refute.
const KEPT: usize = 2;

/// After this many additional points that lowered the evidence no further one is tried.
const PATIENCE: usize = 1;

/// The squared residuals of a spline's radii.
struct Radii<'a> {
    radii: &'a [[f64; 2]],
    worth: f64,
    prior: Vec<f64>,
}

impl Squares for Radii<'_> {
    type Point = SupportFunction;

    fn sum(&self, at: &SupportFunction) -> Option<f64> {
        let off = self.radii.iter().map(|[angle, radius]| (at.support(*angle)[0] - radius) / self.worth);
        let coefficients = at.coefficients();
        let drawn = coefficients.iter().zip(&self.prior).map(|(value, weight)| value * weight);
        let sum: f64 = off.chain(drawn).map(|x| x * x).sum();
        sum.is_finite().then_some(sum)
    }

    fn triangle(&self, at: &SupportFunction) -> Option<DMatrix<f64>> {
        let coefficients = at.coefficients();
        let p = coefficients.len();
        let mut rows = DMatrix::zeros(self.radii.len(), p + 1);
        for (i, [angle, radius]) in self.radii.iter().enumerate() {
            for (j, basis) in at.basis(*angle).iter().enumerate() {
                rows[(i, j)] = basis[0] / self.worth;
            }
            rows[(i, p)] = (radius - at.support(*angle)[0]) / self.worth;
        }
        let lacks: Vec<f64> =
            coefficients.iter().zip(&self.prior).map(|(value, weight)| -value * weight).collect();
        Some(joined(&triangle_of(rows), &self.prior, &lacks))
    }

    fn moved(&self, at: &SupportFunction, step: &DVector<f64>) -> Option<SupportFunction> {
        let coefficients: Vec<f64> =
            at.coefficients().iter().zip(step.iter()).map(|(value, step)| value + step).collect();
        at.with(&coefficients)
    }
}

impl WholeRecord {
    /// The splines that explain the measurements, one for each number of points that was tried. `series` is the estimate by a series: if `is_enough` and it explains the measurements, no more points are tried.
    pub fn splines(&self, series: &Found, is_enough: bool, interrupt: &AtomicBool) -> Vec<Found> {
        let radii = self.radii(series);
        let mut found: Vec<Found> = Vec::new();
        let (mut begins, mut idle) = (self.triangles(series, &radii), 0);
        for points in FEWEST..=MOST {
            let nearest = self.nearest(&radii, begins, interrupt);
            let Some((end, best)) = self.by_measurements(series, nearest, interrupt) else { break };
            let (end, best) = match best.is_settled {
                true => (Some(end), best),
                false => self.gone_on(best, interrupt),
            };
            begins = with_a_point_more(&best.x.support, points);
            // a search that has not converged has no band: it is no candidate, and only gives initial values
            let Some(end) = end else { continue };
            let before = found.iter().map(|found| found.evidence).fold(f64::NEG_INFINITY, f64::max);
            idle = if end.evidence > before { 0 } else { idle + 1 };
            let explains = |cost: f64| self.is_explained(cost, self.times.len());
            let is_borne_out = explains(best.cost) && !end.is_refuted_by(series);
            let is_explained = is_borne_out || (is_enough && explains(series.shape.chi_square));
            found.push(end);
            if is_explained || idle >= PATIENCE || interrupt.load(Ordering::Relaxed) {
                break;
            }
        }
        found
    }

    /// Continues a search that had not converged; the candidate there if it has converged then.
    fn gone_on(&self, best: Best, interrupt: &AtomicBool) -> (Option<Found>, Best) {
        let prior = self.spline_prior(&best.x.support);
        let best = self.descend_to_end(best.x.clone(), &prior, interrupt).unwrap_or(best);
        let end = best.is_settled.then(|| self.at_minimum(&best, &prior)).flatten();
        (end, best)
    }

    /// Normals that were touched, and the radii there by a series.
    fn radii(&self, series: &Found) -> Vec<[f64; 2]> {
        let all = self.times.iter().zip(&series.motion).flat_map(|(time, at)| {
            let normals = self.palms_at(*time).normals(at.phi);
            [0, 1].map(|palm: usize| [normals[palm], at.radii[palm]])
        });
        let all: Vec<[f64; 2]> = all.collect();
        let stride = all.len().div_ceil(RADII).max(1);
        all.into_iter().step_by(stride).collect()
    }

    /// Splines through three points that are as far from each other as can be; where a series has run away in a gap they have its mean radius.
    fn triangles(&self, series: &Found, radii: &[[f64; 2]]) -> Vec<SupportFunction> {
        let mean = radii.iter().map(|[_, radius]| radius).sum::<f64>() / radii.len().max(1) as f64;
        let point = |angle: f64| {
            let [x, y] = series.shape.support.point(angle);
            if (0.5 * mean..2.0 * mean).contains(&x.hypot(y)) {
                [x, y]
            } else {
                [mean * angle.cos(), mean * angle.sin()]
            }
        };
        let turned = |turn: usize| {
            let first = TAU * turn as f64 / (TURNS * FEWEST) as f64;
            let points = (0..FEWEST).flat_map(|i| point(first + TAU * i as f64 / FEWEST as f64));
            let coefficients: Vec<f64> = points.chain([0.0; FEWEST - 1]).collect();
            SupportSpline::of_coefficients(&coefficients).map(SupportFunction::Spline)
        };
        (0..TURNS).filter_map(turned).collect()
    }

    /// The splines nearest to radii, from each initial value: those that are not the same, the best first.
    fn nearest(
        &self,
        radii: &[[f64; 2]],
        begins: Vec<SupportFunction>,
        interrupt: &AtomicBool,
    ) -> Vec<SupportFunction> {
        let Some(first) = begins.first() else { return Vec::new() };
        let squares = Radii { radii, worth: WORTH * self.size(), prior: self.spline_prior(first) };
        let ends = begins.into_iter().filter_map(|begin| descend(&squares, begin, interrupt));
        let mut ends: Vec<Least<SupportFunction>> = ends.collect();
        ends.sort_by(|a, b| a.sum.total_cmp(&b.sum));
        ends.dedup_by(|a, b| (a.sum - b.sum).abs() <= 1e-3 * b.sum);
        ends.into_iter().map(|end| end.at).collect()
    }

    /// The best spline by the measurements themselves, from several initial values.
    fn by_measurements(
        &self,
        series: &Found,
        begins: Vec<SupportFunction>,
        interrupt: &AtomicBool,
    ) -> Option<(Found, Best)> {
        let mut best: Option<(Found, Best)> = None;
        for (i, begin) in begins.into_iter().enumerate() {
            let is_borne_out =
                |(found, best): &(Found, Best)| best.is_settled && !found.is_refuted_by(series);
            if i >= KEPT && best.as_ref().is_some_and(is_borne_out) {
                break;
            }
            let end = self.spline(series, begin, interrupt);
            best = best.into_iter().chain(end).min_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
        }
        best
    }

    /// A spline by the measurements themselves.
    fn spline(
        &self,
        series: &Found,
        support: SupportFunction,
        interrupt: &AtomicBool,
    ) -> Option<(Found, Best)> {
        let prior = self.spline_prior(&support);
        let start = Unknowns { support, ..series.unknowns.clone() };
        let best = self.descend(start, &prior, self.times.len(), interrupt)?;
        Some((self.at_minimum(&best, &prior)?, best))
    }
}

/// The same spline with one more point, on each of its pieces.
fn with_a_point_more(support: &SupportFunction, pieces: usize) -> Vec<SupportFunction> {
    let SupportFunction::Spline(spline) = support else { return Vec::new() };
    (0..pieces).filter_map(|piece| spline.with_point_on(piece).map(SupportFunction::Spline)).collect()
}
