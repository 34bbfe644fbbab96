//! Where two windows meet: the difference of their estimates, in units of its covariance.
//!
//! Two windows that know nothing of each other share one sample, and so its measurements' errors: with `A` and `B` the covariances of the two errors with those of the
//! measurements, and `R` the measurements' own, the difference has the covariance `P + Q - A R^-1 B^T - B R^-1 A^T`. A window that has inherited what the one before it learned
//! differs from that by what its own measurements add, and the difference has the covariance `P - Q` (as that of an innovation).

use super::chi_square::exceeded;
use super::learned::Spread;
use super::starts::is_angle;
use super::task::Task;
use super::together::Seam;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use std::f64::consts::{PI, TAU};

/// A state that is known no better than this part of its size is too far from where the linear theory holds.
const KNOWN: f64 = 0.1;

/// A direction with a smaller part of its variance is one in which nothing is added, or rounding.
const LEAST: f64 = 1e-6;

/// The seam of two windows at a time; none where one of them is not tested, or no direction is determined by both.
pub(super) fn between(
    task: &Task<'_>,
    time: f64,
    before: &Spread,
    after: &Spread,
    is_heir: bool,
) -> Option<Seam> {
    let is_known = |place: &usize| {
        let size = task.sizes.get(*place).copied().unwrap_or_else(|| before.state[*place].abs().max(1e-3));
        let most = KNOWN * KNOWN * size * size;
        [before, after].iter().all(|own| own.covariance[(*place, *place)] <= most)
    };
    let places: Vec<usize> = (0..before.state.len()).filter(is_known).collect();
    if !(before.is_tested && after.is_tested) || places.is_empty() {
        return None;
    }
    let apart = DVector::from_fn(places.len(), |i, _| {
        let apart = after.state[places[i]] - before.state[places[i]];
        if is_angle(task, places[i]) { (apart + PI).rem_euclid(TAU) - PI } else { apart }
    });
    let covariance =
        match is_heir {
            true => &before.covariance - &after.covariance,
            false => {
                let own = |output: usize| task.output_errors(output).variance();
                let outputs = before.by_measurement.ncols();
                let back = DMatrix::from_fn(outputs, outputs, |i, j| {
                    if i == j && own(i) > 0.0 { 1.0 / own(i) } else { 0.0 }
                });
                let shared = &before.by_measurement * back * after.by_measurement.transpose();
                &before.covariance + &after.covariance - &shared - shared.transpose()
            }
        };
    let covariance = covariance.select_rows(&places).select_columns(&places);
    let larger =
        |place: usize| before.covariance[(place, place)].max(after.covariance[(place, place)]).sqrt();
    let scales: Vec<f64> = places.iter().map(|place| larger(*place)).collect();
    let (square, degrees) = length(&apart, &covariance, &scales)?;
    let rest = (square.sqrt() - before.coherent - after.coherent).max(0.0);
    let (chi_square, probability) = (rest * rest, exceeded(rest * rest, degrees as f64));
    Some(Seam { time, chi_square, degrees, probability, is_increment: is_heir })
}

/// The square of a difference in units of its covariance, and in how many directions it has any; `scales` are the states' deviations.
fn length(apart: &DVector<f64>, covariance: &DMatrix<f64>, scales: &[f64]) -> Option<(f64, usize)> {
    let moving: Vec<usize> = (0..scales.len()).filter(|i| scales[*i] > 0.0).collect();
    let n = moving.len();
    let scaled = DMatrix::from_fn(n, n, |i, j| {
        let (i, j) = (moving[i], moving[j]);
        covariance[(i, j)] / (scales[i] * scales[j])
    });
    if n == 0 || scaled.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let own = SymmetricEigen::try_new(scaled, f64::EPSILON, 10_000)?;
    let apart = DVector::from_fn(n, |i, _| apart[moving[i]] / scales[moving[i]]);
    let told = (0..n).filter(|k| own.eigenvalues[*k] > LEAST);
    let squares: Vec<f64> =
        told.map(|k| own.eigenvectors.column(k).dot(&apart).powi(2) / own.eigenvalues[k]).collect();
    (!squares.is_empty()).then(|| (squares.iter().sum(), squares.len()))
}
