//! What the filters have in common: what they believe sample by sample with its bars, their innovations, and the bounds that they keep.

use super::Learned;
use super::task::Task;
use super::together::Innovations;
use super::track::{SampleEstimate, Track};
use nalgebra::{Cholesky, DMatrix, DVector};
use std::collections::BTreeMap;

/// What a filter has come to so far.
pub(super) struct Filtered<'t, 'a> {
    task: &'t Task<'a>,
    pub track: Track,
    /// The least standard deviation of a measurement that is believed.
    least: f64,
    chi_square: f64,
    degrees: usize,
    /// The innovation before, in deviations of its own; none where the filter's need not be white.
    before: Option<DVector<f64>>,
    /// The sum of the products of neighbours, and how many there are.
    products: f64,
    counted: usize,
    /// The states that were moved to a bound: when first, and at how many samples.
    held: BTreeMap<(usize, bool), (f64, usize)>,
}

/// An innovation: expected minus measured, and its covariance.
pub(super) struct Innovation {
    pub residual: DVector<f64>,
    pub covariance: DMatrix<f64>,
    /// The outputs that were measured, of which these are.
    pub measured: Vec<usize>,
}

impl Innovation {
    /// Expected minus measured of all outputs; NaN of those that were not measured.
    pub fn of_all(&self, outputs: usize) -> Vec<f64> {
        let mut all = vec![f64::NAN; outputs];
        self.measured.iter().zip(self.residual.iter()).for_each(|(place, own)| all[*place] = *own);
        all
    }
}

/// The places of what was measured among the measurements of a sample.
pub(super) fn measured(read: &[f64]) -> Vec<usize> {
    (0..read.len()).filter(|place| !read[*place].is_nan()).collect()
}

impl<'t, 'a> Filtered<'t, 'a> {
    /// Before any measurement.
    pub fn begin(task: &'t Task<'a>, least: f64) -> Self {
        let (track, held) = (Track::default(), BTreeMap::new());
        let (chi_square, products) = (0.0, 0.0);
        Filtered { task, track, least, chi_square, degrees: 0, before: None, products, counted: 0, held }
    }

    /// The variance of each output's measurement, as the filter believes it.
    pub fn measurement_variances(&self) -> DVector<f64> {
        let own = |output: usize| self.task.output_errors(output).variance().max(self.least * self.least);
        DVector::from_fn(self.task.full.outputs.len(), |output, _| own(output))
    }

    /// Counts the innovation of a sample, and gives it in deviations of its own; none where its covariance is not known.
    pub fn compare(&mut self, innovation: &Innovation) -> Option<DVector<f64>> {
        if innovation.covariance.iter().any(|value| !value.is_finite()) {
            return None;
        }
        let root = Cholesky::new(innovation.covariance.clone())?;
        let own = root.l().solve_lower_triangular(&innovation.residual)?;
        self.chi_square += own.norm_squared();
        self.degrees += own.len();
        Some(own)
    }

    /// Counts the innovation of a sample, of a filter whose innovations are white where all is right.
    pub fn compare_white(&mut self, innovation: &Innovation) {
        let own = self.compare(innovation);
        if let (Some(own), Some(before)) = (&own, &self.before)
            && own.len() == before.len()
        {
            self.products += own.dot(before);
            self.counted += own.len();
        }
        self.before = own;
    }

    /// What is believed at a sample, with the variances of the state, and the innovation there, which is empty where none was compared.
    pub fn believe(&mut self, time: f64, state: &[f64], variances: &DVector<f64>, residual: Vec<f64>) {
        let sought = self.task.estimated();
        let deviations = variances.iter().take(sought).map(|own| own.max(0.0).sqrt()).collect();
        let state = state[..sought].to_vec();
        self.track.estimates.push(SampleEstimate { time, state, deviations, residual });
    }

    /// Moves a state to within the bounds that were stated: what is beyond one is put there, and all else goes with it as the covariance has it (D. Simon,
    /// Kalman filtering with state constraints, 2010, section 3.3).
    pub fn hold(&mut self, time: f64, state: &mut DVector<f64>, covariance: &DMatrix<f64>) {
        for _ in 0..self.task.estimated() {
            let beyond = |place: &usize| {
                let [low, high] = self.task.bounds[*place];
                state[*place] < low || state[*place] > high
            };
            let Some(place) = (0..self.task.estimated()).find(beyond) else { break };
            let [low, high] = self.task.bounds[place];
            let is_low = state[place] < low;
            let by = if is_low { low } else { high } - state[place];
            let variance = covariance[(place, place)];
            if variance > 0.0 && variance.is_finite() {
                *state += covariance.column(place) * (by / variance);
            }
            state[place] = if is_low { low } else { high };
            self.held.entry((place, is_low)).or_insert((time, 0)).1 += 1;
        }
        let within = self.task.within_bounds(state.as_slice().to_vec());
        state.copy_from_slice(&within);
    }

    /// The track, with the test of the innovations.
    pub fn end(mut self) -> Track {
        for ((place, is_low), (time, samples)) in &self.held {
            let name = &self.task.full.states[*place];
            let bound = self.task.bounds[*place][usize::from(!is_low)];
            self.track
                .remarks
                .push(format!("from {time:.3} s '{name}' is at its bound {bound}, at {samples} samples"));
        }
        let outputs = 0..self.task.full.outputs.len();
        let rounding = outputs.map(|output| self.task.output_errors(output).rounding).fold(0.0, f64::max);
        let sigma = self.measurement_variances().min().sqrt();
        let coherent = (rounding / 2.0 + self.task.timing) / sigma;
        self.track.innovations =
            Innovations::of([self.chi_square, self.products], [self.degrees, self.counted], sigma, coherent);
        self.track
    }
}

impl Learned {
    /// Of a filter, with the covariance of its state.
    pub(super) fn of_filter(
        task: &Task<'_>,
        state: &DVector<f64>,
        spread: &DMatrix<f64>,
        variances: &DVector<f64>,
    ) -> Learned {
        let n = task.estimated();
        Learned {
            belief: state.as_slice()[..n].to_vec(),
            deviations: Some(variances.iter().take(n).map(|variance| variance.max(0.0).sqrt()).collect()),
            filter: Some((state.clone(), spread.clone())),
            ..Learned::nothing(task)
        }
    }
}
