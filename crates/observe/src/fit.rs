//! Whether a residual is what the errors of the measurements explain.

use super::chi_square::exceeded;
use super::correlation::Neighbours;
use super::drift::{Drift, Trend, slow_curves};
use super::loss::Loss;
use nalgebra::{DMatrix, DVector};

/// A run says of a model that is right that it does not fit no more often than this.
pub const FALSE_ALARMS: f64 = 1e-3;

/// A residual below this part of the measurements may come from interpolation between samples: it says nothing of the model.
pub(super) const COMPUTED: f64 = 1e-7;

/// Where more than this part of the measurements are outliers, they are none: the model is wrong.
const MOST_OUTLIERS: f64 = 0.1;

/// Of fewer measurements of an output it is not told whether their residuals are independent.
const FEWEST: usize = 8;

/// What is known of the errors of the measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Noise {
    /// Nothing: their size is estimated from the residual of the best state.
    Unstated,
    /// Normal errors of this standard deviation, and rounding to multiples of a resolution; both in the outputs' unit.
    Stated {
        /// The standard deviation.
        normal: f64,
        /// The resolution; zero for none.
        rounding: f64,
    },
}

/// What is known of the errors of the measurements of a column: independent normal ones, and rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeasurementErrors {
    /// The standard deviation, in the column's unit.
    pub normal: f64,
    /// Measurements are multiples of this; zero for none.
    pub rounding: f64,
}

impl MeasurementErrors {
    /// The variance of a measurement.
    pub fn variance(self) -> f64 {
        self.normal * self.normal + self.rounding * self.rounding / 12.0
    }

    /// Whether there is none.
    pub fn are_none(self) -> bool {
        self.variance() == 0.0
    }
}

/// Where the standard deviation comes from by which a residual is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseFrom {
    /// It was stated.
    Stated,
    /// It is the residual's own: no noise was stated.
    Residual,
    /// It is the residual's own, and there are too few measurements to test whether that is noise: nothing bears the model out or contradicts it.
    Untested,
    /// The residual is no larger than rounding and interpolation make it, and no noise was stated.
    Computation,
}

/// How well the best state explains a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The sum of the squares of expected minus measured, in units of `sigma`.
    pub chi_square: f64,
    /// Measurements less unknowns.
    pub degrees: usize,
    /// How likely a residual is that is no better, were the model right: of one so large (chi-square), whose neighbours agree so much, or that drifts so far, where the
    /// noise was stated; of one whose neighbours are so alike (von Neumann's ratio) where it was not. One where that was not tested.
    pub probability: f64,
    /// Measurements that no normal error explains, and that a robust loss leaves out of the test.
    pub outliers: usize,
    /// Measurements, outliers among them.
    pub measurements: usize,
    /// The probability of so large a sum of squares (chi-square); none where the noise was not stated.
    pub squares: Option<f64>,
    /// The probability of neighbours that agree so much; none where they were not tested by themselves.
    pub neighbours: Option<f64>,
    /// The test for slow curves; none where the noise was not stated, or samples are few.
    pub drift: Option<Drift>,
    /// The standard deviation of a measurement, in its unit.
    pub sigma: f64,
    /// Where it comes from.
    pub from: NoiseFrom,
    /// Whether the residual is explained.
    pub fits: bool,
}

impl Fit {
    /// Whether the residuals were tested at all.
    pub fn is_tested(&self) -> bool {
        self.from != NoiseFrom::Untested
    }

    /// Whether so many measurements are beyond what normal errors reach that they are no outliers.
    pub fn has_outliers(&self) -> bool {
        self.outliers as f64 > MOST_OUTLIERS * self.measurements as f64
    }

    /// Whether it is the neighbours that agree too much, more than that the residuals are large or drift.
    pub fn is_by_neighbours(&self) -> bool {
        let drift = self.drift.map(|own| own.probability);
        self.neighbours.is_some_and(|own| is_least(own, self.squares) && is_least(own, drift))
    }

    /// The drift of the residuals, where that is less likely than their size and their neighbours.
    pub fn by_drift(&self) -> Option<Drift> {
        self.drift.filter(|own| {
            is_least(own.probability, self.squares) && is_least(own.probability, self.neighbours)
        })
    }
}

/// Whether a probability is less than another, if there is one.
fn is_least(own: f64, other: Option<f64>) -> bool {
    other.is_none_or(|other| own < other)
}

/// What is compared: differences sample by sample, `outputs` of them each, after `unknowns` were fitted.
pub(super) struct Residuals<'a> {
    pub differences: &'a DVector<f64>,
    /// The places of those of which nothing was measured: they are zero, and count nowhere.
    pub unmeasured: &'a [usize],
    /// Their derivatives by what was fitted, where they are known.
    pub slopes: Option<&'a DMatrix<f64>>,
    /// How they were weighed.
    pub loss: Loss,
    pub outputs: usize,
    /// So many of the first are no differences of measurements: they are what was known before, in the same unit.
    pub relations: usize,
    /// What was fitted, measurements that were taken as they are included.
    pub unknowns: usize,
    /// The root mean square of the measurements.
    pub size: f64,
    /// The probability of a false alarm that this window may have.
    pub alarm: f64,
    /// The least standard deviation that is believed where none is stated.
    pub least: f64,
    /// What the rounding of the times may add to a measurement.
    pub timing: f64,
}

impl Residuals<'_> {
    pub fn degrees(&self) -> usize {
        (self.differences.len() - self.unmeasured.len()).saturating_sub(self.unknowns)
    }

    /// The residual of a measurement that is right: by interpolation, and by the rounding of its time.
    pub fn computed(&self) -> f64 {
        COMPUTED * self.size + self.timing
    }

    /// Whether something was measured of a difference; their places increase.
    fn is_measured(&self, place: usize) -> bool {
        self.unmeasured.binary_search(&place).is_err()
    }

    fn rms(&self) -> f64 {
        (self.differences.norm_squared() / self.degrees().max(1) as f64).sqrt()
    }

    /// The verdict.
    pub fn fit(&self, noise: Noise) -> Fit {
        match noise {
            Noise::Stated { normal, rounding } => self.against(normal, rounding),
            Noise::Unstated => self.by_itself(),
        }
    }

    /// Against stated errors: by the sum of the squares, and by how much neighbours agree.
    ///
    /// The best state is no farther from the measurements than the true one is, and rounding adds at most half a resolution to each, however these
    /// roundings hang together: that much is taken off before normal errors have to explain the rest.
    ///
    /// A robust loss leaves outliers out, which no normal error reaches, and takes a little less of the errors than least squares do
    /// (`Loss::taken`); more outliers than [`MOST_OUTLIERS`] are no outliers.
    fn against(&self, normal: f64, rounding: f64) -> Fit {
        let sigma = (normal * normal + rounding * rounding / 12.0).sqrt();
        let coherent = rounding / 2.0 + self.computed();
        let is_reading = |i: usize| i >= self.relations;
        let is_out = |i: usize, value: f64| is_reading(i) && self.loss.is_outlier(value, sigma, coherent);
        let kept: Vec<Option<f64>> = self
            .differences
            .iter()
            .enumerate()
            .map(|(i, value)| (!is_out(i, *value) && self.is_measured(i)).then_some(*value))
            .collect();
        let count = kept.iter().flatten().count();
        let outliers = kept.len() - self.unmeasured.len() - count;
        let measurements = (kept.len() - self.unmeasured.len()).saturating_sub(self.relations);
        let degrees = count.saturating_sub(self.unknowns);
        let length = kept.iter().flatten().map(|value| value * value).sum::<f64>().sqrt();
        // what the computation adds is no error of a measurement
        let rest = length - coherent * (count as f64).sqrt();
        let taken = self.loss.taken();
        let own = degrees as f64 + (1.0 - taken) * self.unknowns.min(count) as f64;
        let large = match rest {
            rest if rest <= 0.0 => 1.0,
            rest if normal > 0.0 => exceeded((rest / normal).powi(2), own),
            _ => 0.0,
        };
        let alike = self.slopes.filter(|slopes| normal > 0.0 && slopes.nrows() == kept.len()).map(|slopes| {
            let (residuals, outputs, relations) = (&kept[..], self.outputs, self.relations);
            let unmeasured = self.unmeasured;
            Neighbours { residuals, unmeasured, outputs, relations, slopes, taken, sigma, coherent }
                .probability()
        });
        let alike = alike.flatten();
        let drift = self.slopes.filter(|slopes| normal > 0.0 && slopes.nrows() == kept.len());
        let drift = drift.and_then(|slopes| self.drift(&kept, slopes, sigma, coherent));
        let probability = least_of([Some(large), alike, drift.map(|own| own.probability)]);
        let chi_square = (length / sigma).powi(2);
        let from = NoiseFrom::Stated;
        let fit = Fit {
            chi_square,
            degrees,
            probability,
            outliers,
            measurements,
            squares: Some(large),
            neighbours: alike,
            drift,
            sigma,
            from,
            fits: false,
        };
        Fit { fits: degrees > 0 && !fit.has_outliers() && probability >= self.alarm, ..fit }
    }

    /// How far residuals drift of which those that count are given, with their derivatives.
    fn drift(&self, kept: &[Option<f64>], slopes: &DMatrix<f64>, sigma: f64, coherent: f64) -> Option<Drift> {
        let residuals = DVector::from_fn(kept.len(), |i, _| kept[i].unwrap_or(0.0) / sigma);
        let mut slopes = slopes.clone();
        (0..kept.len()).filter(|i| kept[*i].is_none()).for_each(|i| slopes.row_mut(i).fill(0.0));
        let (followed, outputs) = (&slopes.qr().q(), self.outputs);
        let samples = kept.len().saturating_sub(self.relations).div_ceil(outputs.max(1));
        let coherent = coherent / sigma * (samples as f64).sqrt();
        let trend = Trend { residuals: &residuals, followed, outputs, coherent };
        let counts = |place: usize| kept[place].is_some();
        trend.drift(|output| slow_curves(kept.len(), (outputs, output, self.relations), counts))
    }

    /// By the residuals themselves: independent errors differ from their neighbours by twice their variance in the mean, the residuals
    /// of a wrong model by less. Under independent normal errors the ratio of J. von Neumann (Distribution of the ratio of the
    /// mean square successive difference to the variance, 1941) has the mean 2 and nearly the variance `4 (n - 2)/(n^2 - 1)`; for as
    /// few as eight differences the tail of the normal distribution is the larger one on this side.
    fn by_itself(&self) -> Fit {
        let (degrees, rms) = (self.degrees(), self.rms());
        let sigma = rms.max(self.least);
        let chi_square = self.differences.norm_squared() / (sigma * sigma);
        let computed = rms <= self.computed().max(self.least);
        let tested = if computed { Some(1.0) } else { self.independent() };
        let from = match tested {
            _ if rms <= self.least => NoiseFrom::Computation,
            Some(_) => NoiseFrom::Residual,
            None => NoiseFrom::Untested,
        };
        let probability = tested.unwrap_or(1.0);
        let fits = degrees > 0 && probability >= self.alarm && rms.is_finite();
        let measurements = (self.differences.len() - self.unmeasured.len()).saturating_sub(self.relations);
        Fit {
            chi_square,
            degrees,
            probability,
            outliers: 0,
            measurements,
            squares: None,
            neighbours: None,
            drift: None,
            sigma,
            from,
            fits,
        }
    }

    /// The probability of neighbours so alike, the least over the outputs that can be tested times their number; none where no output can be, since a test
    /// that was not made is no evidence.
    fn independent(&self) -> Option<f64> {
        let column = |output: usize| -> Vec<f64> {
            let places = (self.relations + output..self.differences.len()).step_by(self.outputs.max(1));
            places.filter(|place| self.is_measured(*place)).map(|place| self.differences[place]).collect()
        };
        let tail = |column: Vec<f64>| {
            let n = column.len() as f64;
            let square: f64 = column.iter().map(|value| value * value).sum();
            if column.len() < FEWEST || square <= 0.0 {
                return None;
            }
            let steps: f64 = column.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
            let below = (2.0 - n / (n - 1.0) * steps / square) / (4.0 * (n - 2.0) / (n * n - 1.0)).sqrt();
            Some(if below <= 0.0 { 1.0 } else { exceeded(below * below, 1.0) / 2.0 })
        };
        let tails: Vec<f64> = (0..self.outputs).filter_map(|output| tail(column(output))).collect();
        let least = tails.iter().copied().reduce(f64::min)?;
        Some((least * tails.len() as f64).min(1.0))
    }
}

/// The probability that the least of some independent probabilities is no larger (L. H. C. Tippett, The Methods of Statistics, 1931).
pub(super) fn least_of<const N: usize>(all: [Option<f64>; N]) -> f64 {
    let count = all.iter().flatten().count();
    if count == 0 {
        return 1.0;
    }
    // one that is no number is of residuals that are none
    let least = all.into_iter().flatten().map(|one| if one.is_nan() { 0.0 } else { one }).fold(1.0, f64::min);
    -(count as f64 * (-least).ln_1p()).exp_m1()
}

/// Whether stated errors explain differences of two outputs in turn, after so many unknowns were fitted: `size` is the root mean square
/// of the measurements, and the only test of a run may have all of its false alarms.
pub fn explains(differences: &DVector<f64>, unknowns: usize, size: f64, noise: Noise) -> Fit {
    let alarm = FALSE_ALARMS;
    let (slopes, loss) = (None, Loss::Squares);
    Residuals {
        differences,
        unmeasured: &[],
        slopes,
        loss,
        outputs: 2,
        relations: 0,
        unknowns,
        size,
        alarm,
        least: 0.0,
        timing: 0.0,
    }
    .fit(noise)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn normal(random: &mut ChaCha8Rng) -> f64 {
        let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
        radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
    }

    fn rms_residual(differences: &DVector<f64>, alarm: f64) -> Residuals<'_> {
        Residuals {
            differences,
            unmeasured: &[],
            slopes: None,
            loss: Loss::Squares,
            outputs: 2,
            relations: 0,
            unknowns: 0,
            size: 1.0,
            alarm,
            least: 1e-9,
            timing: 0.0,
        }
    }

    /// Normal errors are called so, whether their size was stated or not: over 20,000 draws no more alarms than are allowed, five
    /// deviations of their number added.
    #[test]
    fn noise_is_called_noise() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        const DRAWS: usize = 20_000;
        for alarm in [1e-3, 1e-2] {
            let most = alarm * DRAWS as f64 + 5.0 * (alarm * DRAWS as f64).sqrt();
            let mut alarms = [0; 2];
            for _ in 0..DRAWS {
                let differences = DVector::from_fn(160, |_, _| 1e-4 * normal(&mut random));
                for (noise, count) in [Noise::Stated { normal: 1e-4, rounding: 0.0 }, Noise::Unstated]
                    .into_iter()
                    .zip(&mut alarms)
                {
                    *count += usize::from(!rms_residual(&differences, alarm).fit(noise).fits);
                }
            }
            assert!(alarms.iter().all(|count| *count as f64 <= most), "{alarms:?} at {alarm}");
            // and the first is a test and not a nod
            assert!(alarms[0] as f64 > alarm * DRAWS as f64 / 2.0, "{alarms:?} at {alarm}");
        }
    }

    #[test]
    fn what_is_no_noise_is_not_called_so() {
        let mut random = ChaCha8Rng::seed_from_u64(8);
        let wave = DVector::from_fn(160, |i, _| 1e-4 * (0.05 * i as f64).sin() + 1e-5 * normal(&mut random));
        assert!(!rms_residual(&wave, 1e-4).fit(Noise::Unstated).fits);
        assert!(!rms_residual(&wave, 1e-4).fit(Noise::Stated { normal: 1e-5, rounding: 0.0 }).fits);
        assert!(rms_residual(&wave, 1e-4).fit(Noise::Stated { normal: 1e-4, rounding: 0.0 }).fits);
        let unknown = DVector::from_element(160, f64::NAN);
        for noise in [Noise::Unstated, Noise::Stated { normal: 1.0, rounding: 1.0 }] {
            assert!(!rms_residual(&unknown, 1e-4).fit(noise).fits, "{noise:?}");
        }
    }

    /// As many unknowns as measurements: any model goes through them, and nothing bears it out.
    #[test]
    fn nothing_fits_that_nothing_is_left_to_check() {
        let differences = DVector::from_element(160, 0.0);
        for noise in [Noise::Stated { normal: 1e-4, rounding: 0.0 }, Noise::Unstated] {
            let fits = |unknowns| Residuals { unknowns, ..rms_residual(&differences, 1e-4) }.fit(noise).fits;
            assert!(fits(159) && !fits(160) && !fits(161), "{noise:?}");
        }
    }

    /// Seven measurements of each of two outputs are too few to tell noise from a curve; eight are enough, also where the other output has fewer. A residual that the
    /// computation explains needs no test.
    #[test]
    fn a_test_that_was_not_made_is_no_evidence() {
        let curve = |count: usize| DVector::from_fn(count, |i, _| 1e-3 * (i / 2) as f64 - 3e-3);
        let fit = |count: usize| rms_residual(&curve(count), 1e-2).fit(Noise::Unstated);
        let few = fit(14);
        assert!(few.fits && !few.is_tested() && few.from == NoiseFrom::Untested);
        assert!(fit(15).from == NoiseFrom::Residual && fit(15).is_tested() && !fit(15).fits);
        let none = rms_residual(&DVector::zeros(14), 1e-2).fit(Noise::Unstated);
        assert!(none.fits && none.from == NoiseFrom::Computation);
        let stated = rms_residual(&curve(14), 1e-2).fit(Noise::Stated { normal: 1e-3, rounding: 0.0 });
        assert!(stated.is_tested());
    }

    /// By hand: of three independent probabilities the least is at most 0.1 with probability 1 - 0.9^3 = 0.271; what is no number is the least of all, and
    /// of none there is nothing to be surprised at.
    #[test]
    fn the_least_of_some_probabilities() {
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} {b}");
        close(least_of([Some(0.1), Some(0.7), Some(1.0)]), 0.271);
        close(least_of([Some(0.1), None, Some(1.0)]), 0.19);
        close(least_of([None, Some(0.1)]), 0.1);
        close(least_of([Some(0.5), Some(f64::NAN)]), 0.0);
        close(least_of([None, None]), 1.0);
        // where 1 - (1 - p)^2 would round to nothing
        assert_eq!(least_of([Some(1e-30), Some(1.0)]), 2e-30);
    }

    /// What is named is the least of the three, however close all of them are to nothing.
    #[test]
    fn the_cause_of_a_misfit_is_its_least_probability() {
        let fit = Fit {
            chi_square: 0.0,
            degrees: 100,
            probability: 0.0,
            outliers: 0,
            measurements: 100,
            squares: Some(1.0e-200),
            neighbours: Some(1.5e-200),
            drift: None,
            sigma: 1.0,
            from: NoiseFrom::Stated,
            fits: false,
        };
        let drift = |probability: f64| Fit { drift: Some(Drift { probability, output: 0 }), ..fit };
        assert!(!fit.is_by_neighbours() && fit.by_drift().is_none());
        assert!(!drift(1.2e-200).is_by_neighbours() && drift(1.2e-200).by_drift().is_none());
        assert!(drift(0.9e-200).by_drift().is_some());
        let alike = Fit { neighbours: Some(0.9e-200), ..fit };
        assert!(alike.is_by_neighbours() && alike.by_drift().is_none());
    }

    /// A contact that rests is rounded by the same amount at each sample: that is no error of the model, and more than half a
    /// resolution is one.
    #[test]
    fn roundings_may_hang_together() {
        let rounding = |rounding: f64| Noise::Stated { normal: 0.0, rounding };
        let rest = DVector::from_element(160, 0.49e-3);
        assert!(rms_residual(&rest, 1e-4).fit(rounding(1e-3)).fits);
        assert!(!rms_residual(&rest, 1e-4).fit(rounding(0.9e-3)).fits);
    }
}
