//! What the filters have in common: what they believe sample by sample with its bars, their innovations, and the bounds that they keep.

use super::task::Task;
use super::together::Innovations;
use super::track::{SampleEstimate, Track};
use super::{Learned, Lost};
use nalgebra::{DMatrix, DVector};
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

/// The state and the factor of its covariance after a measurement, and the innovation.
pub(super) type Corrected = (DVector<f64>, DMatrix<f64>, Innovation);

/// An innovation: expected minus measured, and the lower triangular factor of its covariance.
pub(super) struct Innovation {
    pub residual: DVector<f64>,
    pub root: DMatrix<f64>,
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

/// The places of what a filter corrects its state by at a sample: all that was measured then. At the first sample an output that is a state is not among it, since that
/// state was taken from this measurement: it would count twice.
pub(super) fn compared(task: &Task<'_>, row: usize) -> Vec<usize> {
    let taken = &task.full.states[task.estimated()..];
    let is_taken = |output: usize| row == 0 && taken.contains(&task.full.outputs[output]);
    let read = task.measurements(row);
    (0..read.len()).filter(|output| !read[*output].is_nan() && !is_taken(*output)).collect()
}

/// A lower triangular `S` with `S S^T = sum C C^T` over some blocks, with no negative number on its diagonal; none where a number is not finite.
///
/// Nothing is subtracted, so that no rounding makes a variance negative, and the numbers are deviations, whose range is twice that of variances.
pub(super) fn factor(blocks: &[DMatrix<f64>]) -> Option<DMatrix<f64>> {
    let n = blocks.first()?.nrows();
    let width = blocks.iter().map(DMatrix::ncols).sum();
    let mut all = DMatrix::zeros(n, width);
    let mut at = 0;
    for block in blocks {
        all.columns_mut(at, block.ncols()).copy_from(block);
        at += block.ncols();
    }
    let triangle = all.transpose().qr().unpack_r();
    let mut factor = triangle.rows(0, n.min(triangle.nrows())).transpose();
    for (place, mut column) in factor.column_iter_mut().enumerate() {
        if column[place] < 0.0 {
            column.neg_mut();
        }
    }
    (factor.ncols() == n && factor.iter().all(|value| value.is_finite())).then_some(factor)
}

/// The standard deviations of a state whose covariance has this factor.
pub(super) fn deviations(root: &DMatrix<f64>) -> DVector<f64> {
    // no square is too large or too small for a double
    DVector::from_fn(root.nrows(), |i, _| root.row(i).iter().copied().fold(0.0, f64::hypot))
}

/// The standard deviations of a state whose variances are these; of a variance that rounding has made negative, or no number, nothing is known.
pub(super) fn of_variances(variances: &DVector<f64>) -> DVector<f64> {
    variances.map(|own| if own >= 0.0 { own.sqrt() } else { f64::INFINITY })
}

/// Where a filter's numbers have left the doubles.
pub(super) fn not_finite(task: &Task<'_>, row: usize) -> Lost {
    let why =
        "the filter's covariance is too large for numbers in doubles: give a smaller 'prior'".to_owned();
    Lost { time: task.signals.times()[row], why }
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

    /// Counts the innovation of a sample, and gives it in deviations of its own.
    pub fn compare(&mut self, innovation: &Innovation) -> Option<DVector<f64>> {
        let own = innovation.root.solve_lower_triangular(&innovation.residual)?;
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

    /// What is believed at a sample, with the deviations of the state, and the innovation there, which is empty where none was compared.
    pub fn believe(&mut self, time: f64, state: &[f64], deviations: &DVector<f64>, residual: Vec<f64>) {
        let sought = self.task.estimated();
        let deviations = deviations.iter().take(sought).copied().collect();
        let state = state[..sought].to_vec();
        self.track.estimates.push(SampleEstimate { time, state, deviations, residual });
    }

    /// A sample to which the model or the filter's covariance could not be followed: what was believed is held, with the outputs as they are read, and is no longer
    /// known.
    pub fn lose(&mut self, row: usize, state: &mut DVector<f64>, lost: &Lost) {
        self.track.hold(lost);
        let belief = state.as_slice()[..self.task.estimated()].to_vec();
        *state = DVector::from_vec(self.task.full_state(&belief, row));
        let unknown = DVector::from_element(state.len(), f64::INFINITY);
        self.before = None;
        self.believe(self.task.signals.times()[row], state.as_slice(), &unknown, Vec::new());
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
    /// Of a filter, with its state's covariance or a factor of it, and the deviations.
    pub(super) fn of_filter(
        task: &Task<'_>,
        state: &DVector<f64>,
        spread: &DMatrix<f64>,
        deviations: &DVector<f64>,
    ) -> Learned {
        let n = task.estimated();
        Learned {
            belief: state.as_slice()[..n].to_vec(),
            deviations: Some(deviations.iter().take(n).copied().collect()),
            filter: Some((state.clone(), spread.clone())),
            ..Learned::nothing(task)
        }
    }
}
