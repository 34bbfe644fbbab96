//! Shape and motion of a body from all measurements of a record at once, by least squares.
//!
//! The body slides between two flat palms by its one law of motion (`law`), so that all contacts follow from its rate at the first sample and its
//! support function: a handful of unknowns for hundreds of measurements. No torque and no mass is in it, no derivative of a measurement, and no window: what
//! a method by windows forgets from one to the next is kept here. The search begins at the shape and rate of another estimate, on the first part of the record, and goes
//! on to all of it. Then candidates are compared, Fourier polynomials of all orders (`series`) and closed splines through a few points (`knots`), each weighted by its
//! evidence. Their differences are in the band.

use super::candidate::{Best, Found};
use super::record::{Unknowns, WholeRecord};
use super::series::{convex_weights, expanded};
use crate::simulation::NOMINAL;
use palmistry_bodies::shape::deviation_of;
use std::sync::atomic::{AtomicBool, Ordering};

/// The estimate from a whole record: the likeliest candidate, and the others with their probabilities.
pub(super) struct WholeEstimate {
    pub best: Found,
    pub others: Vec<(f64, Found)>,
}

/// Parts of the record that are explained one after the other.
const PARTS: [f64; 4] = [0.15, 0.3, 0.6, 1.0];

/// The fewest rows of a part.
const FEWEST: usize = 24;

/// A residual below this fraction of the mean radius is an error of the shape; a larger one means another motion.
const FOUND: f64 = 1e-2;

/// This many ends of searches with few harmonics go on to all orders.
const KEPT: usize = 6;

/// This many of those that do not explain the measurements go on with more harmonics, and as splines.
const UNEXPLAINED: usize = 2;

/// A deviation of a support radius beyond this fraction of the mean radius is not small: errors may not be linear there, and another motion may explain the measurements as well.
const WIDE: f64 = 2e-3;

/// The initial standard deviation of the contacts where none is stated, relative to their mean.
const UNSTATED: f64 = 1e-4;

/// A candidate whose residual is below this fraction of another one's is the only one.
const SMALLER: f64 = 0.5;

/// For noise the correlation length of the residuals is below this many neighbours.
const ALIKE: f64 = 1.5;

/// A residual below this fraction of the size of the body is due to the integration alone, for measurements without noise.
const EXACT: f64 = 1e-10;

/// Candidates of a lower probability are left out.
const UNLIKELY: f64 = 1e-4;

impl WholeRecord {
    /// Shape and motion, from given initial values; none where nothing can be followed, or it was interrupted. Where no deviation of a contact is stated it is taken from the residual of the best candidate.
    pub fn estimate(
        &mut self,
        starts: &[Unknowns],
        stated: f64,
        interrupt: &AtomicBool,
    ) -> Option<WholeEstimate> {
        let is_stated = stated > 0.0;
        self.sigma = if is_stated { stated } else { UNSTATED * self.size() };
        let begin = self.begin(starts, interrupt)?;
        let series = self.series(&begin.x, interrupt)?;
        let mut candidates = match is_stated {
            true => {
                let mut all = self.elsewhere(starts, &series, interrupt);
                all.push(series);
                let splines = likeliest(&all).map(|best| self.splines(best, is_stated, interrupt));
                all.extend(splines.into_iter().flatten());
                all
            }
            false => {
                let mut all = self.by_what_is_left(series, interrupt)?;
                let least = all.iter().min_by(|a, b| a.rms_residual.total_cmp(&b.rms_residual)).cloned();
                let others =
                    least.map(|least| (least.rms_residual, self.elsewhere(starts, &least, interrupt)));
                let (least, others) = others.unwrap_or_default();
                let is_less = |other: &Found| !other.is_spline() && other.rms_residual < SMALLER * least;
                if let Some(better) = others.iter().find(|other| is_less(other)) {
                    // the residual of the first one was not noise
                    self.sigma = UNSTATED * self.size();
                    all = self.by_what_is_left(better.clone(), interrupt)?;
                } else {
                    all.extend(others);
                }
                all
            }
        };
        // where none of them is a body there is no sure answer, whatever else explains the measurements
        if candidates.iter().any(Found::is_body) {
            candidates.retain(Found::is_body);
        } else {
            candidates.iter_mut().for_each(|found| found.is_sure = false);
        }
        // where a search has converged and its errors are linear, other candidates are dropped
        if candidates.iter().any(|found| found.is_sure) {
            candidates.retain(|found| found.is_sure);
        }
        let mut told = weighed(candidates).map(|told| self.widened(told, is_stated))?;
        told.best.is_sure &= self.is_determined(&told.best);
        (is_stated || self.is_exact(&told.best) || self.is_spread(&told.best)).then_some(told)
    }

    /// The candidates for measurements without a stated deviation, which is taken from the residual of the best of them. No other body is tried where the series leaves no residual, or noise below what is accepted for any measurement.
    fn by_what_is_left(&mut self, first: Found, interrupt: &AtomicBool) -> Option<Vec<Found>> {
        let unstated = self.sigma;
        let mut series = first.clone();
        while self.sigma > NOMINAL && self.left(&series) < SMALLER * self.sigma {
            self.sigma = self.left(&series);
            series = self.series(&series.unknowns, interrupt)?;
        }
        let left = self.left(&series);
        // a small residual that is still a curve may vanish with a spline
        if left <= NOMINAL && (self.is_exact(&series) || self.alike(&series) < ALIKE) {
            self.sigma = left;
            let mut all = vec![series];
            // a series of very high order may be that of a kink
            if all[0].shape.support.order() > Self::ORDER_OF_SMOOTH {
                let splines = self.splines(&all[0], false, interrupt);
                all.extend(splines.into_iter().filter(|spline| spline.rms_residual <= NOMINAL));
            }
            return Some(all);
        }
        self.sigma = unstated;
        let mut splines = self.splines(&first, false, interrupt);
        let least =
            |splines: &[Found]| splines.iter().map(|at| at.rms_residual).fold(f64::INFINITY, f64::min);
        if least(&splines) > NOMINAL {
            self.sigma = left;
            let is_noise = self.alike(&series) < ALIKE;
            splines.extend(self.splines(&series, is_noise, interrupt));
        } else {
            series = first;
        }
        let least = least(&splines);
        if least > SMALLER * series.rms_residual {
            let again = splines.iter().filter_map(|spline| self.spline_again(spline, interrupt));
            let again: Vec<Found> = again.collect();
            return Some([vec![series], again].concat());
        }
        // the series leaves a residual that the measurements do not have
        let sigma = std::mem::replace(&mut self.sigma, least.max(NOMINAL));
        let again = splines.iter().filter(|spline| spline.rms_residual <= 2.0 * self.sigma);
        let again: Vec<Found> = again.filter_map(|spline| self.spline_again(spline, interrupt)).collect();
        if again.is_empty() {
            self.sigma = sigma;
            return Some(vec![series]);
        }
        Some(again)
    }

    /// The deviation of a contact estimated from a candidate's residual, in m.
    fn left(&self, found: &Found) -> f64 {
        let n = found.shape.samples as f64;
        (found.rms_residual * (n / found.shape.degrees as f64).sqrt()).max(NOMINAL)
    }

    fn spline_again(&self, spline: &Found, interrupt: &AtomicBool) -> Option<Found> {
        let prior = self.spline_prior(&spline.shape.support);
        let best = self.descend(spline.unknowns.clone(), &prior, self.times.len(), interrupt)?;
        self.at_minimum(&best, &prior).filter(|_| best.is_settled)
    }

    /// A series that explains most, from given initial values; where these explain nothing, from motions on a grid.
    fn begin(&self, starts: &[Unknowns], interrupt: &AtomicBool) -> Option<Best> {
        let rows = self.times.len();
        let stop = || interrupt.load(Ordering::Relaxed);
        let mut best: Option<Best> = None;
        for start in starts {
            let straight = self.low(start.clone(), rows, interrupt);
            let mut ends = vec![straight];
            if !ends[0].as_ref().is_some_and(|end| self.is_explained(end.cost, rows)) {
                ends.push(self.by_parts(start.clone(), interrupt));
            }
            best =
                best.into_iter().chain(ends.into_iter().flatten()).min_by(|a, b| a.cost.total_cmp(&b.cost));
            if stop() || best.as_ref().is_some_and(|best| self.is_explained(best.cost, rows)) {
                break;
            }
        }
        let is_found = |best: &Best| self.rms_residual(best.cost, rows) < FOUND * best.x.support.mean();
        if !best.as_ref().is_some_and(is_found) && !stop() {
            best = best
                .into_iter()
                .chain(self.begun_by_turning(interrupt))
                .min_by(|a, b| a.cost.total_cmp(&b.cost));
        }
        best.filter(|_| !stop())
    }

    /// Whether the residual passes the chi-square test, where a deviation is stated. The covariance about a motion that fails it is that of another one.
    fn is_determined(&self, found: &Found) -> bool {
        !self.stated || self.is_explained(found.shape.chi_square, self.times.len())
    }

    /// Whether the residual is zero, or noise.
    fn is_noise(&self, found: &Found) -> bool {
        if self.stated {
            self.is_determined(found)
        } else {
            self.is_exact(found) || self.alike(found) < ALIKE
        }
    }

    /// Other series, and splines, that explain measurements with noise as large as these: where this one fails, or its band is wide, the motion that was found first need not be the likeliest, nor the only one. A search
    /// with a weak prior of the harmonics runs far along poorly determined directions; so each begins with few harmonics and a strong prior, and the likeliest go on. Where few harmonics explain nothing there may be
    /// kinks: the best of such ends go on with more harmonics and as splines.
    fn elsewhere(&self, starts: &[Unknowns], found: &Found, interrupt: &AtomicBool) -> Vec<Found> {
        if !self.is_wide(found) && self.is_noise(found) {
            return Vec::new();
        }
        let rows = self.times.len();
        let mut splines: Vec<Found> = Vec::new();
        let ends = self.begun_by_turning(interrupt);
        let own = Some(&found.unknowns).filter(|_| !found.is_spline());
        let begins = own.into_iter().chain(starts).chain(ends.iter().map(|end| &end.x));
        let mut all: Vec<Found> = begins.flat_map(|begin| self.believed(begin, interrupt)).collect();
        for end in ends.iter().filter(|end| !self.is_explained(end.cost, rows)).take(UNEXPLAINED) {
            all.extend(self.series(&end.x, interrupt));
            let few = self.at_minimum(end, &convex_weights(self.size(), end.x.support.order()));
            splines.extend(few.into_iter().flat_map(|few| self.splines(&few, false, interrupt)));
        }
        let is_explained = |end: &Found| self.is_explained(end.shape.chi_square, rows);
        all.retain(is_explained);
        splines.retain(is_explained);
        all.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        let ends = different(all).into_iter().take(KEPT);
        let series: Vec<Found> = ends.filter_map(|end| self.series_about(&end.unknowns, interrupt)).collect();
        [different(series), splines].concat()
    }

    /// Whether a shape is so uncertain somewhere where it was touched that its errors are not small.
    fn is_wide(&self, found: &Found) -> bool {
        let mean = found.shape.support.mean();
        found.motion.iter().any(|at| {
            let deviations = at.radius_rows.each_ref().map(|row| deviation_of(&found.covariance, row));
            deviations.into_iter().any(|deviation| deviation > WIDE * mean)
        })
    }

    /// A series of the order that it has, with the prior of convexity alone.
    pub(super) fn low(&self, start: Unknowns, rows: usize, interrupt: &AtomicBool) -> Option<Best> {
        let order = start.support.order();
        self.descend(expanded(&start, order), &convex_weights(self.size(), order), rows, interrupt)
    }

    /// The parts of the record one after the other.
    fn by_parts(&self, start: Unknowns, interrupt: &AtomicBool) -> Option<Best> {
        let mut end = None;
        let mut x = start;
        for part in self.parts() {
            let best = self.low(x, part, interrupt)?;
            x = best.x.clone();
            end = Some(best);
        }
        end
    }

    /// The numbers of samples of the parts that are explained one after the other.
    pub(super) fn parts(&self) -> [usize; 4] {
        PARTS.map(|part| self.part(part))
    }

    fn part(&self, part: f64) -> usize {
        let rows = self.times.len();
        ((part * rows as f64) as usize).clamp(rows.min(FEWEST), rows)
    }

    /// A residual larger than noise increases all deviations; and where the residuals of neighbours are correlated, no sample counts as an independent one.
    fn widened(&self, mut told: WholeEstimate, is_stated: bool) -> WholeEstimate {
        let best = &told.best;
        let spread = (best.shape.chi_square / best.shape.degrees as f64).max(1.0);
        let is_noise = is_stated && self.is_explained(best.shape.chi_square, self.times.len());
        let is_exact = !is_stated && self.is_exact(best);
        let alike = if is_noise || is_exact { 1.0 } else { self.alike(best) };
        let factor = spread * alike;
        for found in std::iter::once(&mut told.best).chain(told.others.iter_mut().map(|(_, found)| found)) {
            found.covariance *= factor;
            found.shape.covariance *= factor;
            found.shape.widened = factor.sqrt();
        }
        told.best.shape.others =
            told.others.iter().map(|(probability, found)| (*probability, found.shape.clone())).collect();
        told
    }

    fn is_exact(&self, found: &Found) -> bool {
        found.rms_residual <= EXACT * self.size()
    }

    /// Whether the residual counts as more independent numbers than there are unknowns. Where it does not it is a curve: the size of the errors is unknown, and the
    /// shape is wrong.
    fn is_spread(&self, found: &Found) -> bool {
        let (samples, degrees) = (found.shape.samples as f64, found.shape.degrees as f64);
        samples / self.alike(found) > samples - degrees
    }

    /// The correlation length of the residuals, in samples: the sum of their autocorrelations, up to the first that is not positive.
    fn alike(&self, found: &Found) -> f64 {
        let mut most: f64 = 1.0;
        for palm in 0..2 {
            let left: Vec<f64> = found
                .motion
                .iter()
                .zip(&self.contacts[palm])
                .map(|(at, read)| at.contacts[palm] - read)
                .collect();
            let square: f64 = left.iter().map(|x| x * x).sum();
            let with = |lag: usize| left.iter().zip(&left[lag..]).map(|(a, b)| a * b).sum::<f64>() / square;
            let sum: f64 = (1..left.len() / 4).map(with).take_while(|part| *part > 0.0).sum();
            most = most.max(1.0 + 2.0 * sum);
        }
        most
    }
}

/// Candidates without those that agree with an earlier one.
fn different(candidates: Vec<Found>) -> Vec<Found> {
    let mut kept: Vec<Found> = Vec::new();
    for found in candidates {
        if !kept.iter().any(|known| known.is_also(&found) && found.is_also(known)) {
            kept.push(found);
        }
    }
    kept
}

/// Which candidates the measurements refute beside another one: these are dropped, however few unknowns they have; they have not converged, or are not the body.
fn refuted(candidates: &[Found]) -> Vec<bool> {
    candidates.iter().map(|found| candidates.iter().any(|other| found.is_refuted_by(other))).collect()
}

/// The likeliest that the measurements do not refute, a body if there is one.
fn likeliest(candidates: &[Found]) -> Option<&Found> {
    let any = candidates.iter().any(Found::is_body);
    let left = candidates.iter().zip(refuted(candidates));
    let left = left.filter(|(found, refuted)| !refuted && (!any || found.is_body()));
    left.map(|(found, _)| found).max_by(|a, b| a.evidence.total_cmp(&b.evidence))
}

/// The candidates that the measurements do not refute, with their probabilities, the likeliest first.
fn weighed(mut candidates: Vec<Found>) -> Option<WholeEstimate> {
    let mut refuted = refuted(&candidates).into_iter();
    candidates.retain(|_| refuted.next() == Some(false));
    candidates.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    // the same minimum, met twice, is no likelier than met once
    let mut candidates = different(candidates).into_iter();
    let best = candidates.next()?;
    let weights: Vec<(f64, Found)> =
        candidates.map(|other| ((other.evidence - best.evidence).exp(), other)).collect();
    let total = 1.0 + weights.iter().map(|(weight, _)| weight).sum::<f64>();
    let others = weights.into_iter().map(|(weight, other)| (weight / total, other));
    Some(WholeEstimate { best, others: others.filter(|(probability, _)| *probability > UNLIKELY).collect() })
}
