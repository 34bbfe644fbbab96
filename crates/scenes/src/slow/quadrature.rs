//! Shape and motion by integrals of the measurements: everything from one constant, with no derivative of a measurement and no division by a quantity that may vanish.
//!
//! Contact forces do no work on a body that does not move along them, so that the height of the centre of mass changes by the lift of the palms' own motion: by `A/sin phi2`
//! times the lever `s1` at palm 1, `B/sin phi2` times `s2` at palm 2, relative to the weight. The centre of mass lies on the vertical through the centre of rotation
//! (3.27). Height and side give both radii. The turn remains: `r_i' + d_i (w_i - phi0') = 0` is linear in `phi0'`, weighted by `d_i` at palm `i`, and nothing is divided by
//! it: about every sample a polynomial is fitted to all equations of its neighbours, in which those with a large `d_i` count most.

use super::local::{derivative, integral};
use super::measurements::{Sampled, SlowMeasurements};
use nalgebra::{DMatrix, DVector, Dyn, SVD};
use palmistry_math::number::MOST_ITERATIONS;

/// The number of points of polynomials through exact samples.
const POINTS: usize = 14;

/// Samples about one, and the degree, of the fit of the rate: exact measurements, and noisy ones.
const EXACT: [usize; 2] = [15, 10];
const NOISY_DEGREE: usize = 2;

/// This many samples smooth errors of this fraction of the mean contact. The truncation error of a polynomial grows with the cube of their number, and the noise falls with its power 3/2.
const NOISY_SAMPLES: f64 = 9.0;
const NOISE: f64 = 7e-4;
const NOISE_POWER: f64 = 0.22;
const MOST_SAMPLES: f64 = 41.0;

/// Noise above this fraction of the mean contact is smoothed by a polynomial.
const IS_NOISY: f64 = 1e-7;

/// Shape at the contacts and motion, sample by sample. SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct SlowTrack {
    /// The support radii at both contacts.
    pub radii: Vec<[f64; 2]>,
    /// The body's orientation, zero at the first sample.
    pub phi0: Vec<f64>,
    /// The height of the centre of mass.
    pub height: Vec<f64>,
}

/// The part of the quadrature that does not depend on the constant.
#[derive(Clone, Debug)]
pub(super) struct Quadrature {
    sampled: Vec<Sampled>,
    /// The height of the centre of mass above that at the first sample.
    pub lifted: Vec<f64>,
    pub fit: [usize; 2],
}

impl Quadrature {
    pub fn of(measurements: &SlowMeasurements) -> Quadrature {
        let sampled: Vec<Sampled> = (0..measurements.rows()).map(|row| measurements.sampled(row)).collect();
        let lift: Vec<f64> = sampled.iter().map(Sampled::lift).collect();
        let noise = measurements.sigma / measurements.scale();
        let noisy = noise > IS_NOISY;
        let samples = NOISY_SAMPLES * (noise / NOISE).powf(NOISE_POWER);
        let samples = 2 * (samples.clamp(5.0, MOST_SAMPLES) / 2.0) as usize + 1;
        let lifted = integral(&measurements.times, &lift, if noisy { 2 } else { POINTS });
        Quadrature { sampled, lifted, fit: if noisy { [samples, NOISY_DEGREE] } else { EXACT } }
    }

    /// The least and the greatest height at the first sample at which no radius is negative; the second may be infinite.
    pub fn heights(&self) -> [f64; 2] {
        let mut range = [f64::NEG_INFINITY, f64::INFINITY];
        for (at, lifted) in self.sampled.iter().zip(&self.lifted) {
            let (low, unit) = (at.radii(*lifted), [at.first[1], -at.second[1]]);
            for i in 0..2 {
                let limit = -low[i] / unit[i];
                if unit[i] > 0.0 {
                    range[0] = range[0].max(limit);
                } else if unit[i] < 0.0 {
                    range[1] = range[1].min(limit);
                }
            }
        }
        range
    }

    /// Everything from the height at the first sample.
    pub fn track(&self, times: &[f64], height: f64) -> SlowTrack {
        let height: Vec<f64> = self.lifted.iter().map(|lifted| height + lifted).collect();
        let radii: Vec<[f64; 2]> =
            self.sampled.iter().zip(&height).map(|(at, height)| at.radii(*height)).collect();
        let d: Vec<[f64; 2]> = self.sampled.iter().zip(&radii).map(|(at, r)| at.tangential(*r)).collect();
        let rate = self.rate(times, &radii, &d);
        let points = if self.fit[1] < 4 { 2 } else { POINTS };
        SlowTrack { phi0: integral(times, &rate, points), radii, height }
    }

    /// The body's rate: about each sample the polynomial `p` that fits best `d_i p = r_i' + d_i w_i` of the samples about it.
    fn rate(&self, times: &[f64], radii: &[[f64; 2]], d: &[[f64; 2]]) -> Vec<f64> {
        let n = times.len();
        let [window, degree] = [self.fit[0].min(n), self.fit[1].min(n.saturating_sub(1))];
        // where measurements are noisy a radius is differentiated by a polynomial of low degree over as many samples
        let slopes = [0, 1].map(|i: usize| {
            let column: Vec<f64> = radii.iter().map(|r| r[i]).collect();
            if self.fit[1] < 4 {
                smoothed_slopes(times, &column, window)
            } else {
                derivative(times, &column, POINTS)
            }
        });
        (0..n)
            .map(|row| {
                let first = row.max(window / 2) - window / 2;
                let first = first.min(n - window);
                let unit = (times[first + window - 1] - times[first]).max(f64::MIN_POSITIVE);
                let mut matrix = DMatrix::zeros(2 * window, degree + 1);
                let mut side = DVector::zeros(2 * window);
                for k in 0..window {
                    let at = first + k;
                    let u = (times[at] - times[row]) / unit;
                    // neighbours count less the farther they are
                    let near = (1.0 - (1.4 * u).powi(2).min(0.96)).powi(2);
                    for i in 0..2 {
                        let weight = near * d[at][i];
                        side[2 * k + i] = near * slopes[i][at] + weight * self.sampled[at].w[i];
                        let mut power = weight;
                        for column in 0..=degree {
                            matrix[(2 * k + i, column)] = power;
                            power *= u;
                        }
                    }
                }
                let svd = decomposed(matrix)?;
                let small = svd.singular_values.max() * 1e-11;
                svd.solve(&side, small).ok().map(|found| found[0])
            })
            .map(|rate| rate.unwrap_or(0.0))
            .collect()
    }
}

/// The singular values of a matrix, unless a number in it is not finite.
fn decomposed(matrix: DMatrix<f64>) -> Option<SVD<f64, Dyn, Dyn>> {
    let is_finite = matrix.iter().all(|entry| entry.is_finite());
    is_finite.then(|| matrix.try_svd(true, true, f64::EPSILON, MOST_ITERATIONS))?
}

/// Slopes of a noisy column: of the best-fitting parabola over so many samples.
fn smoothed_slopes(times: &[f64], column: &[f64], window: usize) -> Vec<f64> {
    let n = times.len();
    (0..n)
        .map(|row| {
            let first = (row.max(window / 2) - window / 2).min(n - window);
            let unit = (times[first + window - 1] - times[first]).max(f64::MIN_POSITIVE);
            let u = |k: usize| (times[first + k] - times[row]) / unit;
            let matrix = DMatrix::from_fn(window, 3.min(window), |k, power| u(k).powi(power as i32));
            let side = DVector::from_fn(window, |k, _| column[first + k]);
            let found = decomposed(matrix).and_then(|svd| svd.solve(&side, 1e-12).ok());
            found.and_then(|found| found.get(1).copied()).unwrap_or(0.0) / unit
        })
        .collect()
}

/// Shape and motion by quadrature, from the height of the centre of mass at the first sample.
pub fn by_quadrature(measurements: &SlowMeasurements, height: f64) -> SlowTrack {
    Quadrature::of(measurements).track(&measurements.times, height)
}
