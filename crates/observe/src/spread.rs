//! The covariance of a state that follows curves through measurements: for an observer that interpolates between samples.

use nalgebra::{DMatrix, DVector};
use std::collections::VecDeque;

/// How uncertain the state is: what measurements did that no longer carry the curves, and how far each of those moves the state that still do.
pub(super) struct Spread {
    settled: DMatrix<f64>,
    /// The first measurement that carries the curves.
    first: usize,
    /// The derivatives of the state by this measurement and those after it.
    by_measurement: VecDeque<DMatrix<f64>>,
    /// The variances of the measurements.
    noise: DMatrix<f64>,
}

impl Spread {
    /// Of a guess with a covariance; measurements have variances, and so many carry the curves at a time.
    pub fn of_a_guess(covariance: DMatrix<f64>, noise: DVector<f64>, carriers: usize) -> Self {
        let none = DMatrix::zeros(covariance.nrows(), noise.len());
        let by_measurement = vec![none; carriers].into();
        Self { settled: covariance, first: 0, by_measurement, noise: DMatrix::from_diagonal(&noise) }
    }

    /// One step: the measurements from `first` on carry the curves, and each moves the state.
    pub fn step(&mut self, by_state: &DMatrix<f64>, first: usize, moved: Vec<DMatrix<f64>>) {
        for _ in self.first..first {
            if let Some(oldest) = self.by_measurement.pop_front() {
                self.settled += &oldest * &self.noise * oldest.transpose();
                self.by_measurement.push_back(oldest * 0.0);
            }
        }
        self.first = first;
        if self.settled.iter().all(|value| value.is_finite()) {
            self.settled = by_state * &self.settled * by_state.transpose();
        }
        for (by_measurement, moved) in self.by_measurement.iter_mut().zip(moved) {
            *by_measurement = by_state * &*by_measurement + moved;
        }
    }

    /// Makes every state unknown.
    pub fn forget(&mut self) {
        self.settled.fill(0.0);
        self.settled.fill_diagonal(f64::INFINITY);
    }

    /// Of the whole state.
    pub fn covariance(&self) -> DMatrix<f64> {
        self.by_measurement
            .iter()
            .fold(self.settled.clone(), |sum, by| sum + by * &self.noise * by.transpose())
    }

    /// The covariance of some states less a measurement of them, which may have moved them.
    pub fn of_residual(&self, places: &[usize], reading: usize) -> DMatrix<f64> {
        let own = self.covariance().select_rows(places).select_columns(places) + &self.noise;
        let by = reading.checked_sub(self.first).and_then(|place| self.by_measurement.get(place));
        match by {
            Some(by) => {
                let shared = by.select_rows(places) * &self.noise;
                own - &shared - shared.transpose()
            }
            None => own,
        }
    }
}
