//! Estimated kinks of the curvature, for bodies whose harmonics fall slowly: closed splines have one where two of their pieces meet.
//!
//! Harmonics up to some hundred locate them roughly: jumps of the third derivative are the peaks of the fourth, summed with a window. One kink after the other is taken from the highest peak of the residual of
//! the ones before, and all of them are fitted at once. The free parameters are then a few harmonics, and three jumps and an angle a kink, instead of hundreds of harmonics. It is a model like any
//! other: a kink in the fit does not prove that the body has one there.

use super::found::{EXACT, SlowShape};
use super::measurements::SlowMeasurements;
use super::outline::{Kink, OF_KINK, Outline};
use super::together::{Point, Together};
use palmistry_bodies::shape::SupportSeries;
use std::f64::consts::{PI, TAU};

/// Kinks are sought only beside harmonics of at least this order; a body that needs fewer has no need of kinks.
const SLOWLY: usize = 48;

/// A residual below this many deviations needs no kinks.
const NOTHING_LEFT: f64 = 100.0;

/// Kinks at most, and how many in a row may bring no improvement.
const MOST: usize = 6;
const PATIENCE: usize = 2;

/// Another kink, or more harmonics, have to lower the residual to this fraction of it.
const LOWER: f64 = 0.5;

/// The harmonics that are free while kinks are looked for, and afterwards.
const FIRST_ORDER: usize = 32;
const ORDERS: [usize; 3] = [48, 64, 96];

/// Lower orders at which peaks are also looked for; and the residual, relative to that of harmonics, below which the search ends.
const SPECTRA: [usize; 2] = [96, 64];
const FOUND: f64 = 1e-2;

/// Steps for each of these.
const STEPS: usize = 12;

/// The root mean square residual of a contact, in deviations.
fn left(at: &Point, rows: usize) -> f64 {
    (at.left.rows(0, 2 * rows).norm_squared() / (2 * rows) as f64).sqrt()
}

/// The highest peak of the fourth derivative of a series without the kinks that are known, as a kink.
fn highest(series: &SupportSeries, known: &[Kink]) -> Kink {
    let order = series.order();
    let mut tail = vec![0.0; 1 + 2 * order];
    if !known.is_empty() {
        let coefficients =
            known.iter().flat_map(|kink| kink.jumps.into_iter().chain([kink.angle])).collect::<Vec<f64>>();
        tail = Outline::of(&[vec![0.0], coefficients].concat(), known.len()).expanded(order).coefficients();
    }
    let window = |k: usize| (PI * k as f64 / order as f64).sin().powi(2);
    let sharpened: Vec<[f64; 2]> = (1..=order)
        .map(|k| {
            let [a, b] = series.harmonics[k - 1];
            let factor = window(k) * (k as f64).powi(4);
            [factor * (a - tail[2 * k - 1]), factor * (b - tail[2 * k])]
        })
        .collect();
    let sharp = SupportSeries { mean: 0.0, harmonics: sharpened };
    let angles = (0..8 * order).map(|i| TAU * i as f64 / (8 * order) as f64);
    let (angle, height) = angles
        .map(|angle| (angle, sharp.support(angle)[0]))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        .unwrap_or_default();
    let area: f64 = (1..=order).map(window).sum();
    Kink { jumps: [PI * height / area, 0.0, 0.0], angle }
}

/// The shape with kinks of its curvature, where harmonics alone leave a residual of exact measurements; else unchanged.
pub(super) fn with_kinks(
    measurements: &SlowMeasurements,
    found: SlowShape,
    interrupt: &dyn Fn() -> bool,
) -> SlowShape {
    let together = Together::of(measurements);
    let is_asked = !together.is_noisy()
        && found.kinks.is_empty()
        && found.order >= SLOWLY
        && found.rms_residual > NOTHING_LEFT * together.sigma
        && found.explains(EXACT);
    if !is_asked {
        return found;
    }
    let better = search(&together, &found, interrupt)
        .filter(|better| better.rms_residual < LOWER * found.rms_residual);
    better.unwrap_or(found)
}

/// The best shape with kinks, over series of several orders that locate them: the highest orders follow few measurements more than the body.
fn search(together: &Together<'_>, found: &SlowShape, interrupt: &dyn Fn() -> bool) -> Option<SlowShape> {
    let mut best: Option<SlowShape> = None;
    let lower = SPECTRA.into_iter().filter(|order| *order < found.order);
    for order in std::iter::once(found.order).chain(lower) {
        let series = if order == found.order {
            SupportSeries::of_coefficients(&found.shape.support.coefficients())
        } else {
            let mut first = found.shape.support.coefficients();
            first.truncate(1 + 2 * order);
            let Some(begin) = together.point(first, &found.track.phi0) else { continue };
            SupportSeries::of_coefficients(&together.down_by(STEPS, begin, interrupt).coefficients)
        };
        let with = from_peaks(together, &series, &found.track.phi0, interrupt);
        if let Some(with) = with
            && best.as_ref().is_none_or(|best| with.rms_residual < best.rms_residual)
        {
            best = Some(with);
        }
        if best.as_ref().is_some_and(|best| best.rms_residual < FOUND * found.rms_residual) || interrupt() {
            break;
        }
    }
    best
}

/// Kinks from the peaks of a series, one after the other, and then as many harmonics as lower the residual.
fn from_peaks(
    together: &Together<'_>,
    series: &SupportSeries,
    near: &[f64],
    interrupt: &dyn Fn() -> bool,
) -> Option<SlowShape> {
    let rows = near.len();
    let mut together = together.clone();
    let mut first = series.coefficients();
    first.truncate(1 + 2 * FIRST_ORDER);
    let mut now = together.down_by(STEPS, together.point(first, near)?, interrupt);
    let mut best = (now.clone(), 0);
    let mut patience = PATIENCE;
    while together.kinks < MOST && patience > 0 && !interrupt() {
        let kink = highest(series, &together.outline(&now.coefficients).kinks);
        together.kinks += 1;
        let coefficients = [&now.coefficients[..], &kink.jumps, &[kink.angle]].concat();
        let Some(begin) = together.point(coefficients, &now.phi0) else { break };
        now = together.down_by(STEPS, begin, interrupt);
        if left(&now, rows) < LOWER * left(&best.0, rows) {
            best = (now.clone(), together.kinks);
            patience = PATIENCE;
        } else {
            patience -= 1;
        }
    }
    let (mut best, kinks) = best;
    together.kinks = kinks;
    if kinks == 0 {
        return None;
    }
    for order in ORDERS.into_iter().filter(|order| 2 * (1 + 2 * order + OF_KINK * kinks) <= 2 * rows) {
        let mut coefficients = together.outline(&best.coefficients).expanded(order).coefficients();
        coefficients.extend(&best.coefficients[best.coefficients.len() - OF_KINK * kinks..]);
        let Some(begin) = together.point(coefficients, &best.phi0) else { break };
        let end = together.down_by(STEPS, begin, interrupt);
        if left(&end, rows) >= LOWER * left(&best, rows) || interrupt() {
            break;
        }
        best = end;
    }
    Some(together.shape(&best))
}
