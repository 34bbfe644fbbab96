//! Which orders of harmonics are tried: raised while G. Schwarz's criterion (BIC) improves.

use super::closure::closed;
use super::found::{EXACT, SlowShape};
use super::measurements::SlowMeasurements;
use super::together::{Point, Together};
use palmistry_bodies::shape::SupportSeries;

/// Orders that are tried, as far as the number of measurements allows.
const ORDERS: [usize; 14] = [3, 5, 8, 12, 16, 24, 32, 48, 64, 80, 100, 130, 160, 200];

/// Under noise above this fraction of the mean contact, orders above this one are not identifiable.
const IS_NOISY: f64 = 1e-5;
const MOST_NOISY: usize = 48;

/// The search ends after this many orders in a row without improvement.
const PATIENCE: usize = 2;

/// From an order on, a residual above this fraction of the mean contact and this many deviations means another motion.
const HOPELESS: [(usize, f64); 3] = [(16, 3e-2), (32, 1e-2), (64, 3e-3)];
const HOPELESS_NOISE: f64 = 5.0;

/// Parts of the measurements that are explained one after the other, and a residual, in deviations, above which the search stops.
const PARTS: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 1.0];
const HOPELESS_PART: f64 = 20.0;

/// The orders from one to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Orders {
    pub least: usize,
    /// The last order, whether it is one of the usual ones or not; none chooses it by the measurements.
    pub most: Option<usize>,
    /// Below a residual of this fraction of the mean radius no higher order is tried, even if it would improve the fit.
    pub enough: f64,
}

impl Orders {
    pub const CHOSEN: Orders = Orders { least: 0, most: None, enough: 0.0 };

    fn all(self) -> Vec<usize> {
        let most = self.most.unwrap_or(usize::MAX);
        let mut all: Vec<usize> =
            ORDERS.into_iter().filter(|order| (self.least..most).contains(order)).collect();
        all.extend(self.most);
        all
    }
}

impl Together<'_> {
    pub fn is_noisy(&self) -> bool {
        self.measurements.sigma > IS_NOISY * self.size
    }

    /// Fits all measurements from a given track, with increasing orders. None where no order has a start there.
    pub fn explain(
        &self,
        start: &SupportSeries,
        near: &[f64],
        orders: Orders,
        interrupt: &dyn Fn() -> bool,
    ) -> Option<SlowShape> {
        let measurements = 2 * near.len();
        let criterion = |at: &Point| at.cost + at.coefficients.len() as f64 * (measurements as f64).ln();
        let padded = |from: &[f64], order: usize| -> Vec<f64> {
            let mut all = from.to_vec();
            all.resize(1 + 2 * order, 0.0);
            all
        };
        let from = start.coefficients();
        let mut best: Option<Point> = None;
        let mut patience = PATIENCE;
        let mut last: Option<Point> = None;
        for order in orders.all() {
            if 2 * (1 + 2 * order) > measurements || (self.is_noisy() && order > MOST_NOISY) || interrupt() {
                break;
            }
            let begin = match &last {
                Some(at) => self.point(padded(&at.coefficients, order), &at.phi0),
                None => self.begin(&padded(&from, order), near),
            };
            let Some(begin) = begin else { continue };
            let end = self.without_lost(self.down(begin, interrupt), interrupt);
            let rms_residual =
                (end.left.rows(0, measurements).norm_squared() / measurements as f64).sqrt() * self.sigma;
            if HOPELESS.iter().any(|(from, part)| {
                order >= *from
                    && rms_residual > (HOPELESS_NOISE * self.measurements.sigma).max(part * self.size)
            }) {
                // another start is needed: more harmonics do not repair a wrong motion
                best = best.or(Some(end));
                break;
            }
            let is_enough = rms_residual <= orders.enough * end.coefficients[0];
            last = Some(end.clone());
            if best.as_ref().is_none_or(|best| criterion(&end) < criterion(best)) {
                best = Some(end);
                patience = PATIENCE;
            } else {
                patience -= 1;
            }
            if patience == 0 || is_enough {
                break;
            }
        }
        best.map(|best| self.shape(&best))
    }

    /// The same shape with fewer harmonics, where Schwarz's criterion (BIC) rejects the others: a search that went up the orders by parts of the measurements keeps the highest one that a
    /// part asked for, and superfluous harmonics cause a long valley in which it stops far from the body.
    pub fn with_fewer_harmonics(&self, found: SlowShape, interrupt: &dyn Fn() -> bool) -> SlowShape {
        let worth = (2.0 * found.track.phi0.len() as f64).ln();
        let criterion = |of: &SlowShape| of.shape.chi_square + (1 + 2 * of.order) as f64 * worth;
        let coefficients = found.shape.support.coefficients();
        if !self.is_noisy() || !found.kinks.is_empty() || !found.explains(EXACT) {
            return found;
        }
        let fewer = ORDERS.into_iter().filter(|order| *order < found.order);
        let mut others = fewer.flat_map(|order| {
            // truncated, and as a closed outline through what was touched
            let cut = coefficients[..1 + 2 * order].to_vec();
            let through =
                closed(self.measurements, &found.track, order).map(|(support, _)| support.coefficients());
            let starts = std::iter::once(cut).chain(through);
            let begun = starts.filter_map(|start| self.begin(&start, &found.track.phi0));
            let ends =
                begun.map(|begin| self.shape(&self.without_lost(self.down(begin, interrupt), interrupt)));
            ends.collect::<Vec<_>>()
        });
        let simpler = others.find(|other| other.explains(EXACT) && criterion(other) < criterion(&found));
        simpler.filter(|_| !interrupt()).unwrap_or(found)
    }

    /// The same, over longer and longer parts of the measurements: the fit to the first ones leads the body through the next ones.
    pub fn explain_by_parts(
        measurements: &SlowMeasurements,
        start: &SupportSeries,
        near: &[f64],
        orders: Orders,
        interrupt: &dyn Fn() -> bool,
    ) -> Option<SlowShape> {
        let (mut support, mut near) = (start.clone(), near.to_vec());
        let mut found = None;
        for part in PARTS {
            let rows = ((measurements.rows() as f64 * part) as usize).min(measurements.rows());
            let first = measurements.part(&(0..rows));
            let explained = Together::of(&first).explain(&support, &near[..rows], orders, interrupt)?;
            let last = rows.checked_sub(1)?;
            let turned = explained.track.phi0[last] - near[last];
            near[..rows].copy_from_slice(&explained.track.phi0);
            near[rows..].iter_mut().for_each(|phi0| *phi0 += turned);
            support = SupportSeries::of_coefficients(&explained.shape.support.coefficients());
            if explained.rms_residual > HOPELESS_PART * explained.sigma.max(1e-3 * measurements.scale()) {
                return Some(explained).filter(|_| rows == measurements.rows());
            }
            found = Some(explained);
        }
        found
    }
}
