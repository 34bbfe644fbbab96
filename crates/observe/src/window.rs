//! The error of the output over a window of samples (4.77), as a function of the unknown parts of the first state.

use super::flow::MOST_BENT;
use super::learned::Arrival;
use super::loss::Loss;
use super::weights::Weights;
use super::{Lost, ModelFlow, Order, Sample};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Some samples, and the state at the first of them, of which a part is unknown.
///
/// The error is `k = dt/2 sum |h(q(t_i)) - y_i|^2`, the rectangle rule for the integral of 4.77: every sample counts alike,
/// so that for independent errors of one size the smallest `k` is the most likely state.
#[derive(Clone, Debug)]
pub struct Window<'a> {
    pub flow: ModelFlow<'a>,
    /// In s; the first is the time of the state.
    pub times: &'a [f64],
    /// What was measured: the values of the model's outputs, a row a sample; NaN where an output was not measured.
    pub measured: Vec<Vec<f64>>,
    /// The state at the first time; its known part stays.
    pub start: Vec<f64>,
    /// The places of the unknowns.
    pub free: Vec<usize>,
    /// What is known of the state before the measurements, which is then in the place of the first of them.
    pub(super) arrival: Option<Arc<Arrival>>,
    /// How residuals are weighed, and the standard deviation of a measurement for it.
    pub(super) loss: (Loss, f64),
    /// The bounds of the unknowns.
    pub(super) bounds: Vec<[f64; 2]>,
    /// The weights of the differences, where their errors are not independent and alike.
    pub(super) weights: Option<Arc<Weights>>,
}

/// The error and its derivatives at one guess, `p` unknowns and `n` differences.
#[derive(Clone, Debug)]
pub struct WindowExpansion {
    /// `k` of 4.77.
    pub cost: f64,
    /// The differences `h - y`, sample by sample, as they are; zero where an output was not measured, and so are their derivatives.
    pub left: DVector<f64>,
    /// How many of them there are where an output was measured.
    pub compared: usize,
    /// The same, weighted where they have weights: what the error is made of.
    pub differences: DVector<f64>,
    /// The same as they are where the loss is no square, by which the test of fit judges.
    pub counted: DVector<f64>,
    /// Their derivatives, n by p, weighted as they are, and by the loss where it is no square.
    pub slopes: DMatrix<f64>,
    /// The derivatives of what is `counted`, where the loss is no square: without its weights.
    unscaled: Option<DMatrix<f64>>,
    /// The derivative of `k`.
    pub gradient: DVector<f64>,
    /// The second derivative of `k`: exact at order two, without the second derivatives of the output at order one.
    pub hessian: DMatrix<f64>,
    /// The state at the last time.
    pub end: Vec<f64>,
    /// The derivatives of the state at the last time.
    pub end_slopes: DMatrix<f64>,
}

impl WindowExpansion {
    /// The root of the mean square of the differences as they are.
    pub fn rms_residual(&self) -> f64 {
        self.left.norm() / (self.compared.max(1) as f64).sqrt()
    }

    /// The derivatives of what is `counted`.
    ///
    /// An estimate that is off by `d` moves the residuals by `J d`, whatever the loss that it is the best of: what is orthogonal to `J` is of the errors alone. The
    /// derivatives of the loss do not span that, since they are small where a residual is large.
    pub fn counted_slopes(&self) -> &DMatrix<f64> {
        self.unscaled.as_ref().unwrap_or(&self.slopes)
    }
}

impl Window<'_> {
    /// The unknowns of a state.
    pub fn unknowns(&self, state: &[f64]) -> DVector<f64> {
        DVector::from_iterator(self.free.len(), self.free.iter().map(|place| state[*place]))
    }

    /// Unknowns within their bounds: what is at one is so to the last digit.
    pub(super) fn held(&self, mut unknowns: DVector<f64>) -> DVector<f64> {
        for (value, [low, high]) in unknowns.iter_mut().zip(&self.bounds) {
            *value = value.max(*low).min(*high);
        }
        unknowns
    }

    /// The first state with these unknowns.
    pub fn state(&self, unknowns: &DVector<f64>) -> Vec<f64> {
        let mut state = self.start.clone();
        for (place, value) in self.free.iter().zip(unknowns.iter()) {
            state[*place] = *value;
        }
        state
    }

    /// The mean time between two samples, in s.
    fn step(&self) -> f64 {
        let steps = self.times.len().saturating_sub(1).max(1);
        (self.times[self.times.len() - 1] - self.times[0]) / steps as f64
    }

    /// `k` alone.
    ///
    /// # Errors
    /// Where the model cannot be followed to the end of the window.
    pub fn cost(&self, unknowns: &DVector<f64>) -> Result<f64, Lost> {
        let samples = self.flow.follow(&self.state(unknowns), &self.free, self.times, Order::Value)?;
        let differences = self.weighted(self.differences(&samples));
        let differences = self.after_arrival(unknowns, differences);
        Ok(0.5 * self.step() * differences.norm_squared())
    }

    /// So many of the differences are of the first sample.
    fn of_first(&self) -> usize {
        self.measured.first().map_or(0, Vec::len)
    }

    /// How many differences stand before those of measurements.
    pub(super) fn relations(&self) -> usize {
        self.arrival.as_ref().map_or(0, |arrival| arrival.factor.nrows())
    }

    /// Differences by the loss, with what is known before them in the place of the first sample.
    fn after_arrival(&self, unknowns: &DVector<f64>, mut differences: DVector<f64>) -> DVector<f64> {
        let (loss, sigma) = self.loss;
        if loss != Loss::Squares {
            differences.apply(|value| *value = loss.residual(*value, sigma).0);
        }
        let Some(arrival) = &self.arrival else { return differences };
        let (off, _) = arrival.off(&self.free, unknowns);
        let own = self.of_first();
        DVector::from_iterator(
            off.len() + differences.len() - own,
            off.iter().copied().chain(differences.iter().skip(own).copied()),
        )
    }

    /// The derivatives of differences, with those of what is known before them in the place of the first sample.
    fn slopes_after_arrival(&self, unknowns: &DVector<f64>, slopes: DMatrix<f64>) -> DMatrix<f64> {
        let Some(arrival) = &self.arrival else { return slopes };
        let (_, own) = arrival.off(&self.free, unknowns);
        let rest = slopes.nrows() - self.of_first();
        let mut all = DMatrix::zeros(own.nrows() + rest, slopes.ncols());
        all.rows_mut(0, own.nrows()).copy_from(&own);
        all.rows_mut(own.nrows(), rest).copy_from(&slopes.rows(self.of_first(), rest));
        all
    }

    fn differences(&self, samples: &[Sample]) -> DVector<f64> {
        let rows = samples.iter().zip(&self.measured);
        let all =
            rows.flat_map(|(sample, row)| sample.outputs.iter().zip(row).map(|(seen, read)| seen - read));
        let mut differences = DVector::from_vec(all.collect());
        if let Some(weights) = &self.weights {
            differences += &weights.offset;
        }
        self.unmeasured().for_each(|place| differences[place] = 0.0);
        differences
    }

    /// The places of differences that were not measured.
    pub(super) fn unmeasured(&self) -> impl Iterator<Item = usize> + '_ {
        let read = self.measured.iter().flatten().enumerate();
        read.filter(|(_, value)| value.is_nan()).map(|(place, _)| place)
    }

    /// The same by their places among what counts: behind what is known before, which stands for the first sample.
    pub(super) fn not_counted(&self) -> Vec<usize> {
        let (relations, skipped) = match self.arrival {
            Some(_) => (self.relations(), self.of_first()),
            None => (0, 0),
        };
        let counted = self.unmeasured().filter(|place| *place >= skipped);
        counted.map(|place| place - skipped + relations).collect()
    }

    /// Differences in units in which their errors are independent and alike.
    pub(super) fn weighted(&self, differences: DVector<f64>) -> DVector<f64> {
        match &self.weights {
            Some(weights) => weights.weighted(&differences),
            None => differences,
        }
    }

    /// `k` with its derivatives; of more than [`MOST_BENT`] unknowns without the second ones of the output, whatever the order.
    ///
    /// # Errors
    /// Where the model cannot be followed to the end of the window.
    pub fn expand(&self, unknowns: &DVector<f64>, order: Order) -> Result<WindowExpansion, Lost> {
        let order = if self.free.len() > MOST_BENT { order.min(Order::First) } else { order };
        let samples = self.flow.follow(&self.state(unknowns), &self.free, self.times, order)?;
        let p = self.free.len();
        let left = self.differences(&samples);
        let differences = self.weighted(left.clone());
        let mut slopes = DMatrix::zeros(differences.len(), p);
        let rows = samples.iter().flat_map(|sample| sample.output_slopes.row_iter());
        for (i, row) in rows.enumerate() {
            slopes.set_row(i, &row);
        }
        self.unmeasured().for_each(|place| slopes.row_mut(place).fill(0.0));
        let compared = left.len() - self.unmeasured().count();
        if let Some(weights) = &self.weights {
            slopes = weights.weighted_slopes(&slopes);
        }
        let mut pull = differences.clone();
        let (loss, sigma) = self.loss;
        let unscaled = (loss != Loss::Squares).then(|| self.slopes_after_arrival(unknowns, slopes.clone()));
        if loss != Loss::Squares {
            for (i, value) in pull.iter_mut().enumerate() {
                let (residual, slope) = loss.residual(*value, sigma);
                slopes.row_mut(i).scale_mut(slope);
                *value = residual * slope;
            }
        }
        if let Some(weights) = &self.weights {
            pull = weights.back(&pull);
        }
        self.unmeasured().for_each(|place| pull[place] = 0.0);
        let skipped = self.arrival.as_ref().map_or(0, |_| self.of_first());
        let slopes = self.slopes_after_arrival(unknowns, slopes);
        let counted = differences.clone();
        let differences = self.after_arrival(unknowns, differences);
        let mut hessian = slopes.tr_mul(&slopes);
        let bends = samples.iter().flat_map(|sample| &sample.output_bends);
        for (pull, bend) in pull.iter().zip(bends).skip(skipped) {
            hessian += bend * *pull;
        }
        let relations = self.relations();
        let counted = DVector::from_iterator(
            relations + counted.len() - skipped,
            differences.iter().take(relations).copied().chain(counted.iter().skip(skipped).copied()),
        );
        let step = self.step();
        let end = samples.last();
        Ok(WindowExpansion {
            cost: 0.5 * step * differences.norm_squared(),
            gradient: slopes.tr_mul(&differences) * step,
            hessian: hessian * step,
            end: end.map(|sample| sample.state.clone()).unwrap_or_default(),
            end_slopes: end.map(|sample| sample.slopes.clone()).unwrap_or_default(),
            left,
            compared,
            counted,
            differences,
            slopes,
            unscaled,
        })
    }
}
